"""The exact set of Cauchy-stable lam: classical limits, ends in or out, and a scan over wave numbers beside."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import inf, sqrt

import pytest
from flint import fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.algebraic import Root, isolated_roots
from gks.modes.cauchy import cauchy_stable
from gks.modes.cauchy_set import CauchySet, cauchy_set, in_cosine
from tests.examples import examples
from tests.modes.schemes import CONTEXT, discrete, kappa, lam, lines, s, z
from tests.oracle.wave_numbers import largest_modulus

SPACES = ["upwind1", "upwind2", "upwind3", "fromm", "central2", "central4", "central6", "compact4"]
TIMES = [
    "forward-euler", "backward-euler", "crank-nicolson", "leapfrog", "ab2", "ab3", "bdf2", "rk2", "ssprk3", "rk4",
]  # fmt: skip


def limit(found: CauchySet) -> float:
    edge = found.first_limit
    return inf if edge is None else complex(edge).real


def shape(found: CauchySet) -> list[tuple[float, float, bool, bool]]:
    return [
        (complex(i.low).real, inf if i.high is None else complex(i.high).real, i.low_stable, i.high_stable)
        for i in found.intervals
    ]


# Under central differences the limit is the extent of the stability region along the imaginary axis (leapfrog 1, ssprk3
# sqrt(3), rk4 2 sqrt(2), ab3 0.7236) over the largest frequency of the operator (central2 1, compact4 sqrt(3), central4
# 1.3722); Durran, Numerical Methods for Fluid Dynamics, sections 2.2-2.4 and 4.1.
@pytest.mark.parametrize(
    ("space", "time", "expected", "belongs"),
    [
        ("upwind1", "forward-euler", 1, True),
        ("upwind1", "rk2", 1, True),
        ("upwind1", "ab2", 0.5, True),
        ("upwind1", "ssprk3", 1.25637, True),
        ("upwind1", "rk4", 1.39265, True),
        ("central2", "leapfrog", 1, False),
        ("central2", "ab3", 0.723627, True),
        ("central2", "ssprk3", sqrt(3), True),
        ("central2", "rk4", 2 * sqrt(2), True),
        ("compact4", "leapfrog", 1 / sqrt(3), False),
        ("compact4", "rk4", 2 * sqrt(2) / sqrt(3), True),
        ("compact4", "ssprk3", 1, True),
        ("central4", "leapfrog", 0.728745, False),
        ("upwind2", "rk2", 0.5, True),
        ("fromm", "rk2", 1, True),
    ],
)
def test_known_limits_and_whether_they_belong(space: str, time: str, expected: float, belongs: bool) -> None:
    ((low, high, *ends),) = shape(cauchy_set(lines(space, time)))
    assert (low, ends) == (0, [False, belongs])
    assert high == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(
    ("name", "expected"), [("lax-friedrichs", 1), ("lax-wendroff", 1), ("beam-warming", 2), ("fromm", 1)]
)
def test_fully_discrete_schemes(name: str, expected: int) -> None:
    found = cauchy_set(discrete(name))
    assert shape(found) == [(0, expected, False, True)]
    assert found.first_limit == Root.of(expected)


@pytest.mark.parametrize(("space", "time"), list(product(SPACES, ["backward-euler", "crank-nicolson", "bdf2"])))
def test_a_stable_integrators_have_no_limit(space: str, time: str) -> None:
    assert shape(cauchy_set(lines(space, time))) == [(0, inf, False, False)]


@pytest.mark.parametrize(
    ("space", "time"), list(product(["central2", "central4", "central6"], ["forward-euler", "ab2", "rk2"]))
)
def test_never(space: str, time: str) -> None:
    found = cauchy_set(lines(space, time))
    assert found.intervals == ()
    assert found.first_limit == Root.of(0)


@pytest.mark.parametrize(("space", "time"), list(product(SPACES, TIMES)))
def test_a_scan_over_wave_numbers_sees_the_same(space: str, time: str) -> None:
    """Growth just above the limit may be as weak as the distance to some power, hence the step of a tenth."""
    poly = lines(space, time)
    edge = limit(cauchy_set(poly))
    below = (0.3, 0.7, 0.97)
    if edge == inf:
        assert all(largest_modulus(poly, {"lam": f * 10}, 90) <= 1 + 1e-9 for f in below)
    else:
        assert all(largest_modulus(poly, {"lam": f * edge}, 90) <= 1 + 1e-9 for f in below if edge)
        assert largest_modulus(poly, {"lam": 1.1 * edge if edge else 0.2}, 720) > 1 + 1e-9


class TestShapes:
    def test_an_isolated_unstable_value_splits_an_interval(self) -> None:
        # The roots 1 and 2/(2 + (lam - 1)**2) meet at lam = 1 only.
        poly = (z - 1) * ((2 + (lam - 1) ** 2) * z - 2)
        assert shape(cauchy_set(poly)) == [(0, 1, False, False), (1, inf, False, False)]

    def test_an_equation_that_says_nothing_at_one_value(self) -> None:
        assert shape(cauchy_set((lam - 1) * (2 * z - 1))) == [(0, 1, False, False), (1, inf, False, False)]

    def test_an_isolated_stable_value_is_left_out(self) -> None:
        found = cauchy_set(z - 1 - (lam - 1) ** 2)
        assert found.intervals == ()
        assert cauchy_stable(z - 1 - (lam - 1) ** 2, {"lam": Root.of(1)}).stable

    def test_two_intervals_with_their_ends(self) -> None:
        # abs(z) <= 1 for (lam - 3)**2 <= 4 in the first two, for 1 <= (lam - 3)**2 <= 5 in the third.
        poly = 2 * z - ((lam - 3) ** 2 - 2) * kappa
        assert shape(cauchy_set(poly)) == [(1, 5, True, True)]
        both = 4 * z - ((lam - 3) ** 2 - 2) ** 2
        assert shape(cauchy_set(both)) == [(1, 5, True, True)]
        shell = 2 * z - ((lam - 3) ** 2 - 3)
        assert [round(a, 4) for a, *_ in shape(cauchy_set(shell))] == [round(3 - sqrt(5), 4), 4.0]

    def test_membership(self) -> None:
        found = cauchy_set(2 * z - ((lam - 3) ** 2 - 2) * kappa)
        assert [found.contains(Root.of(Fraction(n, 2))) for n in (1, 2, 3, 10, 11)] == [False, True, True, True, False]
        assert not cauchy_set(lines("central2", "leapfrog")).contains(Root.of(1))

    def test_an_irrational_speed(self) -> None:
        root_two = isolated_roots(fmpz_poly([-2, 0, 1]))[1]
        poly = kappa * z**2 + lam * s * (kappa**2 - 1) * z - kappa
        (only,) = cauchy_set(poly, {"s": root_two}).intervals
        assert only.high == isolated_roots(fmpz_poly([-1, 0, 2]))[1]
        assert not only.high_stable


@given(st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=2, max_size=3))
@examples(25)
def test_membership_is_the_verdict_at_that_value(rows: list[tuple[int, int]]) -> None:
    poly = 3 * z * kappa - sum(((a + b * lam) * kappa**j for j, (a, b) in enumerate(rows)), CONTEXT.constant(0))
    found = cauchy_set(poly)
    for number in (Fraction(1, 7), Fraction(3, 5), Fraction(11, 10), Fraction(17, 4)):
        assert found.contains(Root.of(number)) is cauchy_stable(poly, {"lam": Root.of(number)}).stable


def test_cosine_substitution() -> None:
    palindrome = kappa**4 + 3 * lam * kappa**3 + 5 * kappa**2 + 3 * lam * kappa + 1
    assert in_cosine(palindrome, "kappa") == kappa**2 + 3 * lam * kappa + 3
