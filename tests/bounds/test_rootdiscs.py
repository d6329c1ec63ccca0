"""Discs around computed roots hold the true ones."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from gks.bounds.allroots import all_roots
from gks.bounds.rootdiscs import RoundedPolynomials, gaps, separations
from gks.modes.doubledouble import UNIT


def exactly_expanded(roots: list[Fraction]) -> list[Fraction]:
    """Ascending coefficients."""
    product = [Fraction(1)]
    for root in roots:
        product = [
            (product[k - 1] if k else 0) - root * (product[k] if k < len(product) else 0)
            for k in range(len(product) + 1)
        ]
    return product


@pytest.mark.parametrize("apart", ["1", "1/1000", "1/1000000", "1/100000000", "1/10000000000", "0"])
@pytest.mark.parametrize("middle", ["1/2", "1 + 1/1000000", "30000"])
@pytest.mark.parametrize("others", [[], ["1"], ["-2", "100"], ["1/1000", "-1", "3"]])
def test_every_root_is_in_a_disc_and_every_disc_holds_as_many_as_were_computed(
    apart: str, middle: str, others: list[str]
) -> None:
    centre = sum((Fraction(part) for part in middle.split("+")), Fraction(0))
    true = [centre, centre + Fraction(apart), *map(Fraction, others)]
    coefficients = np.array([[float(c) for c in exactly_expanded(true)]])
    computed = all_roots(coefficients.astype(complex))
    radii = RoundedPolynomials(coefficients.astype(complex), np.abs(coefficients), 16 * UNIT).discs(computed)
    for x, radius in zip(computed[0], radii[0], strict=True):
        if np.isfinite(radius):
            held = sum(abs(x - float(root)) <= radius for root in true)
            assert held == (np.abs(computed[0] - x) <= radius).sum()
    if apart == "1" and not others:
        assert (radii < 1e-9 * np.abs(computed)).all()


def test_gaps_are_to_other_roots_and_not_to_the_same_one_of_another_factor() -> None:
    roots = np.array([[1.0, 1.0 + 1e-15, 3.0, np.inf]], complex)
    radii = np.array([[1e-14, 1e-14, 0.5, np.inf]])
    assert gaps(roots, radii)[0, :3] == pytest.approx([1.5, 1.5, 2.0], abs=1e-13)
    assert gaps(roots, np.array([[1e-14, np.inf, 0.5, np.inf]]))[0, 0] == 0


def test_roots_whose_discs_meet_are_not_separate() -> None:
    roots, radii = np.array([1.0, 1.0 + 1e-15, 3.0], complex), np.array([1e-14, 1e-14, 0.5])
    assert separations(roots, radii) == pytest.approx([0, 0, 2 - 1e-14], abs=1e-13)
    assert separations(roots[:1], radii[:1])[0] == np.inf
