"""Roots by formula: every root in its disk, also of any polynomial within the errors stated; double roots are left."""

from __future__ import annotations

import mpmath
import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from gks.modes.doubledouble import Real
from gks.modes.quadratics import Disks, quadratic_roots
from tests.examples import examples

mpmath.mp.dps = 80


def solved(coefficients: list[float], errors: list[float]) -> Disks:
    zero = np.zeros(1)
    with np.errstate(all="ignore"):
        return quadratic_roots([Real(np.array([c]), zero) for c in coefficients], [np.array([e]) for e in errors])


def true_roots(coefficients: list[mpmath.mpf]) -> list[mpmath.mpc]:
    if len(coefficients) == 2:
        return [-coefficients[0] / coefficients[1]]
    c, b, a = coefficients
    with mpmath.workdps(700):
        root = mpmath.sqrt(mpmath.mpc(b * b - 4 * a * c))
        return [(-b - root) / (2 * a), (-b + root) / (2 * a)]


def assert_holds(found: Disks, truth: list[mpmath.mpc]) -> None:
    """Each true root in exactly one disk, each disk one root."""
    homes = []
    for t in truth:
        apart = [
            abs(mpmath.mpc(complex(hi)) + mpmath.mpc(complex(lo)) - t) - mpmath.mpf(radius) * abs(complex(hi))
            for hi, lo, radius in zip(found.hi[:, 0], found.lo[:, 0], found.radius[:, 0], strict=True)
        ]
        homes += [k for k, excess in enumerate(apart) if excess <= 0]
    assert sorted(homes) == list(range(len(truth)))


number = st.builds(lambda m, e: m * 2.0**e, st.floats(-1, 1).filter(lambda x: abs(x) > 1e-3), st.integers(-120, 120))


@given(st.lists(number, min_size=2, max_size=3))
@examples(200)
def test_exact_coefficients(coefficients: list[float]) -> None:
    found = solved(coefficients, [0.0] * len(coefficients))
    assume(found.good[0])  # were it never so, hypothesis would find no example, which fails
    assert_holds(found, true_roots([mpmath.mpf(c) for c in coefficients]))
    assert found.radius.max() < 1e-20


@given(
    st.lists(st.floats(-2, 2).filter(lambda x: abs(x) > 1e-2), min_size=2, max_size=3),
    st.floats(-14, -1),
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
)
@examples(200)
def test_coefficients_within_their_errors(coefficients: list[float], digits: float, moves: list[float]) -> None:
    errors = [10.0**digits] * len(coefficients)
    found = solved(coefficients, errors)
    assume(found.good[0])
    moved = [mpmath.mpf(c) + mpmath.mpf(m) * e for c, m, e in zip(coefficients, moves, errors, strict=False)]
    assert_holds(found, true_roots(moved))


def test_most_are_good_and_a_double_root_is_not() -> None:
    assert solved([2.0, -3.0, 1.0], [0.0] * 3).good[0]
    assert solved([1.0, 0.0, 4.0], [0.0] * 3).good[0]
    assert not solved([1.0, -2.0, 1.0], [0.0] * 3).good[0]
    assert not solved([1.0, -2.0, 1.0 - 2.0**-40], [2.0**-39] * 3).good[0]
    assert not solved([1.0, 1e-120, 1e120], [0.0] * 3).good[0]
    assert not solved([1.0, 1.0, np.nan], [0.0] * 3).good[0]


def test_nothing_cancels_in_the_small_root() -> None:
    """x**2 + 1e8 x + 1: the textbook formula leaves its small root four digits."""
    found = solved([1.0, 1e8, 1.0], [0.0] * 3)
    naive = (-1e8 + np.sqrt(1e16 - 4)) / 2
    truth = -1e-8 * (1 + 1e-16)
    assert abs(naive - truth) > 1e-4 * abs(truth)
    assert abs(found.hi[0, 0] - truth) < 1e-15 * abs(truth)
