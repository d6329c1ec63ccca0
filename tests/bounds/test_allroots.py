"""Many polynomials' roots in doubles: by iteration, and by companion matrices where that does not settle."""

from __future__ import annotations

import numpy as np
import pytest

from gks.bounds import allroots
from gks.bounds.allroots import ComplexArray, all_roots


def residual(coefficients: np.ndarray, roots: np.ndarray) -> float:
    """The largest |p(x)| over the sum of the moduli of its terms."""
    value, size = np.zeros_like(roots), np.zeros(roots.shape)
    for c in coefficients.T[::-1]:
        value, size = value * roots + c[:, None], size * np.abs(roots) + np.abs(c)[:, None]
    return float((np.abs(value) / size).max())


@pytest.mark.parametrize("degree", range(4, 10))
def test_residuals_of_rounding_size_whatever_the_order(degree: int) -> None:
    source = np.random.default_rng(degree)
    unlike = source.normal(size=(300, degree + 1)) + 1j * source.normal(size=(300, degree + 1))
    alike = unlike[:1] + 0.01 * np.arange(300)[:, None] * unlike[1:2]
    for coefficients in (unlike, alike):
        roots = all_roots(coefficients)
        assert residual(coefficients, roots) < 1e-12
        distances = np.abs(roots[:, :, None] - roots[:, None, :]) + np.eye(degree)
        assert distances.min() > 1e-6  # no root twice


def test_a_multiple_root_and_ends_that_vanish_are_companion_matrices_work(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    companion = allroots._companion

    def counted(rows: ComplexArray) -> ComplexArray:
        seen.append(len(rows))
        return companion(rows)

    monkeypatch.setattr(allroots, "_companion", counted)
    rows = np.array([np.polynomial.polynomial.polyfromroots(r) for r in ([1, 2, 3, 4j], [1, 1, 1, 2], [0, 1, 2, 3])])
    rows = np.concatenate([rows, [[1, 2, 3, 4, 0]]]).astype(complex)
    roots = all_roots(rows)
    assert seen == [3]
    assert np.isfinite(roots[:3]).all()
    assert residual(rows[:2], roots[:2]) < 1e-12
    assert np.sort(np.abs(roots[2])) == pytest.approx([0, 1, 2, 3], abs=1e-9)
    assert np.isinf(np.abs(roots[3])).sum() == 1
