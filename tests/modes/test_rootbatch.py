"""Batched roots: every root in its disk, the disks small, and what cannot be told apart said to be unresolved."""

from __future__ import annotations

import time
from fractions import Fraction as F

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.rootbatch import Roots, roots
from tests.examples import examples

mpmath.mp.dps = 80


def interface(a: np.ndarray) -> np.ndarray:
    """(2 r**2 - r + 1)**2 + a (3 r - 1)**2: a second-order coupling, roots sqrt(a) apart and a pair 1/sqrt(a) apart."""
    return np.stack([1 + a, -2 - 6 * a, 5 + 9 * a, -4 + 0 * a, 4 + 0 * a], axis=1)


def as_mpc(result: Roots, point: int, k: int) -> mpmath.mpc:
    return mpmath.mpc(complex(result.hi[point, k])) + mpmath.mpc(complex(result.lo[point, k]))


def assert_one_root_a_disk(result: Roots, point: int, truth: list[mpmath.mpc]) -> None:
    """Every true root lies in exactly one disk, and no disk is empty."""
    found = [as_mpc(result, point, k) for k in range(result.hi.shape[1])]
    radii = [mpmath.mpf(r) * abs(complex(h)) for r, h in zip(result.radius[point], result.hi[point], strict=True)]
    homes = [[k for k, x in enumerate(found) if abs(x - t) <= radii[k]] for t in truth]
    assert sorted(k for home in homes for k in home) == list(range(len(truth))), (found, radii)


def expanded(zeros: list[complex | mpmath.mpc]) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[mpmath.mpc]]:
    """prod (x - zero) as one row of double-double coefficients with exponents, and the roots of *that* row."""
    coefficients = [mpmath.mpc(1)]
    for zero in zeros:
        shifted = [mpmath.mpc(0), *coefficients]
        coefficients = [s - mpmath.mpc(zero) * c for s, c in zip(shifted, [*coefficients, mpmath.mpc(0)], strict=True)]
    hi, lo, exponent, used = [], [], [], []
    for c in coefficients:
        e = 0 if c == 0 else int(mpmath.floor(mpmath.log(abs(c), 2)))
        m = c / mpmath.mpf(2) ** e
        hi.append(complex(m))
        lo.append(complex(m - mpmath.mpc(hi[-1])))
        exponent.append(e)
        used.append((mpmath.mpc(hi[-1]) + mpmath.mpc(lo[-1])) * mpmath.mpf(2) ** e)
    truth = []
    with mpmath.workdps(700):  # Newton from the roots asked for: rounding the coefficients has moved them
        for zero in zeros:
            x = mpmath.mpc(zero)
            for _ in range(12):
                value, slope = mpmath.polyval(used[::-1], x, derivative=1)
                x -= value / slope
            truth.append(x)
    return np.array([hi]), np.array([lo]), np.array([exponent]), truth


@pytest.mark.parametrize("ratio", [1e-10, 1e-6, 1e-3, 0.3, 1.0, 17.0, 1e5, 1e10])
def test_a_close_pair_and_a_far_one_at_extreme_ratios(ratio: float) -> None:
    coefficients = interface(np.array([ratio]))
    result = roots(coefficients)
    with mpmath.workdps(120):
        truth = mpmath.polyroots([mpmath.mpf(c) for c in coefficients[0][::-1]], maxsteps=500, extraprec=500)
        assert result.resolved.all()
        assert_one_root_a_disk(result, 0, truth)
    assert result.radius.max() < 1e-22


def test_numpy_roots_loses_what_the_batch_keeps() -> None:
    """The same pair at ratio 1e10: the companion matrix holds about five digits of what distinguishes it from 1/3."""
    exact = 2.9629629629007776e-06  # imaginary part, from 120 digits
    naive = np.roots(interface(np.array([1e10]))[0][::-1])
    naive_pair = min(naive, key=lambda r: abs(r - (1 / 3 + 1j * exact)))
    assert abs(naive_pair.imag - exact) > 1e-9 * exact
    result = roots(interface(np.array([1e10])))
    assert abs(result.hi[0].imag[np.argmin(abs(result.hi[0] - (1 / 3 + 1j * exact)))] - exact) < 1e-15 * exact


@pytest.mark.parametrize(
    "zeros",
    [
        [1e-150, 1e150],
        [1e-150, -1.0, 1e150],
        [2e-150j, 1e-75, 1.0, 1e75, -3e150],
        [1e-150, 1.5e-150, 1e150, 1.1e150],
        [1.0, 1.0 + 1e-9, 1e100],
        [10.0**k for k in range(-120, 121, 24)],
    ],
)
def test_roots_spread_over_three_hundred_decades(zeros: list[complex]) -> None:
    hi, lo, exponent, truth = expanded(zeros)
    result = roots(hi, lo, exponent)
    assert result.resolved.all()
    assert_one_root_a_disk(result, 0, truth)
    assert result.radius.max() < 1e-18


@pytest.mark.parametrize("degree", range(1, 17))
def test_every_degree_on_random_coefficients(degree: int) -> None:
    rng = np.random.default_rng(degree)
    coefficients = rng.normal(size=(40, degree + 1)) + 1j * rng.normal(size=(40, degree + 1))
    result = roots(coefficients)
    assert result.resolved.all()
    assert result.radius.max() < 1e-20
    for row, found in zip(coefficients, result.hi, strict=True):
        truth = np.roots(row[::-1])
        assert max(min(abs(t - f) for f in found) / abs(t) for t in truth) < 1e-9


gaussian = st.tuples(st.integers(-9, 9), st.integers(-9, 9))


@examples(60)
@given(st.lists(gaussian, min_size=1, max_size=8, unique=True), st.integers(-400, 400))
def test_known_roots_lie_in_their_disks(points: list[tuple[int, int]], octaves: int) -> None:
    """Products of (x - g 2**k) over Gaussian integers g: the coefficients are exact doubles."""
    integer = [(1, 0)]
    for re, im in points:
        shifted = [(0, 0), *integer]
        scaled = [(re * a - im * b, re * b + im * a) for a, b in integer] + [(0, 0)]
        integer = [(s[0] - t[0], s[1] - t[1]) for s, t in zip(shifted, scaled, strict=True)]
    hi = np.array([[complex(a, b) for a, b in integer]])
    result = roots(hi, exponent=np.array([[octaves * (len(points) - k) for k in range(len(points) + 1)]]))
    assert result.resolved.all()
    assert_one_root_a_disk(result, 0, [mpmath.mpc(*g) * mpmath.mpf(2) ** octaves for g in points])


def test_what_cannot_be_told_apart_is_unresolved() -> None:
    cases = {
        "double root": [1.0, -2.0, 1.0],
        "double root at zero": [0.0, 0.0, 1.0],
        "degree drop": [1.0, 2.0, 0.0],
        "not a number": [1.0, np.nan, 1.0],
        "infinite": [1.0, np.inf, 1.0],
        "all zero": [0.0, 0.0, 0.0],
    }
    result = roots(np.array(list(cases.values())))
    assert dict(zip(cases, result.resolved, strict=True)) == dict.fromkeys(cases, False)
    assert not roots(np.array([[1e-3, 1.0]]), error=np.array([[0.0, 2.0]])).resolved[0]


def test_rounded_coefficients_decide_nothing_once_their_error_is_stated() -> None:
    """At ratio 1e300 the pair is 1e-150 apart. Rounding 1 + a, -2 - 6 a, … to doubles moves it to 1e-8: a proper answer
    for those coefficients, and none for the scheme, as the error of a unit in the last place shows."""
    coefficients = interface(np.array([1e300]))
    assert roots(coefficients).resolved[0]
    assert not roots(coefficients, error=2.0**-53 * np.abs(coefficients)).resolved[0]


def test_one_bad_point_leaves_the_others_alone() -> None:
    a = np.array([0.5, np.nan, 2.0])
    result = roots(interface(a))
    assert result.resolved.tolist() == [True, False, True]
    assert np.array_equal(result.hi[2], roots(interface(a[2:])).hi[0])


def test_a_root_at_zero_is_exact() -> None:
    result = roots(np.array([[0.0, 2.0, -3.0, 1.0], [0.0, 1.0, 0.0, 0.0], [1.0, 2.0, -3.0, 1.0]]))
    assert result.resolved.tolist() == [True, False, True]
    assert result.hi[0, 0] == 0 and result.radius[0, 0] == 0
    assert sorted(result.hi[0].real) == pytest.approx([0, 1, 2], abs=1e-25)


def test_disks_hold_the_roots_of_every_polynomial_within_the_stated_error() -> None:
    rng = np.random.default_rng(5)
    coefficients = rng.normal(size=(200, 6))
    error = 1e-9 * np.abs(rng.normal(size=(200, 6)))
    result = roots(coefficients, error=error)
    moved = roots(coefficients + error * rng.choice([-1, 1], size=error.shape))
    assert result.resolved.mean() > 0.9
    for p in np.flatnonzero(result.resolved & moved.resolved):
        distance = np.abs(result.hi[p][:, None] - moved.hi[p][None])
        assert ((distance <= result.radius[p] * np.abs(result.hi[p])).sum(axis=0) == 1).all()


def test_real_roots_of_real_polynomials_are_recognised() -> None:
    result = roots(np.array([[-6.0, 11.0, -6.0, 1.0], [-1.0, 1.0, -1.0, 1.0]]))
    real, proved = result.real()
    assert proved.all()
    assert real.sum(axis=1).tolist() == [3, 1]
    near = roots(np.array([[1 + 1e-13, -2.0, 1.0], [1 - 1e-13, -2.0, 1.0]]))  # 1 ± 3e-7 i and 1 ± 3e-7
    assert near.real()[0].sum(axis=1).tolist() == [0, 2]


def test_a_double_double_coefficient_decides_where_doubles_are_equal() -> None:
    """x**2 - 2 x + 1 - 2**-90: the pair 1 ± 2**-45 exists only in the low part."""
    hi, lo = np.array([[1.0, -2.0, 1.0]]), np.array([[-(2.0**-90), 0.0, 0.0]])
    result = roots(hi, lo)
    assert result.resolved[0]
    gap = sorted((result.hi[0] - 1).real + result.lo[0].real)
    assert gap == pytest.approx([-(2.0**-45), 2.0**-45], rel=1e-9)


def test_wrong_shapes_and_degrees_are_refused() -> None:
    with pytest.raises(ValueError, match="degree 17"):
        roots(np.ones((1, 18)))
    with pytest.raises(ValueError, match="shapes differ"):
        roots(np.ones((1, 3)), np.ones((1, 4)))


def test_a_hundred_thousand_quartics_in_seconds() -> None:
    """About 1 s on one core; numpy.roots in a loop takes 60 times as long. The bound leaves room for a busy machine."""
    coefficients = interface(np.logspace(-10, 10, 100_000))
    began = time.process_time()
    result = roots(coefficients)
    assert time.process_time() - began < 5
    assert result.resolved.all()
    assert F(float(result.radius.max())) < F(1, 10**22)
