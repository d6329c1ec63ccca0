"""Beam-Warming entering at x = 0 with simplified inverse Lax-Wendroff closures: stable sets of several intervals.

The second way knows nothing of elimination or of the unit circle: numpy's roots of the 2x2 determinant at one lam after
the other (all spatial roots decay, so every root outside the circle is a mode), its sign changes refined by bisection.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from gks.bounds.cfl import StableSet, stable_set
from gks.modes import Verdict, analyse
from tests.literature.inverse_lax_wendroff import beam_warming, growth

CASES = [
    # (order, known, sigma), number of stable intervals below the interior's limit 2
    ((2, 1, Fraction(0)), 2),
    ((2, 1, Fraction(-1, 2)), 2),
    ((3, 1, Fraction(1, 2)), 2),
    ((3, 1, Fraction(-1, 4)), 1),
    ((3, 2, Fraction(-1, 4)), 2),
    ((4, 2, Fraction(1, 2)), 2),
    ((5, 2, Fraction(1, 2)), 2),
    ((5, 3, Fraction(1, 2)), 3),
    ((5, 3, Fraction(1, 3)), 2),
]


def ends(found: StableSet) -> list[float]:
    """Both ends of all intervals as doubles."""
    every = [end for interval in found.intervals for end in (interval.low, interval.high)]
    return [0.0 if end is None else float(end.ball().real.mid()) for end in every]


def thresholds(order: int, known: int, sigma: Fraction) -> list[float]:
    """Where the largest modulus passes 1, from 400 values of lam and bisection."""
    lams = np.linspace(1e-3, 2 - 1e-3, 400)
    stable = [growth(order, known, sigma, lam) < 1 for lam in lams]
    found = [0.0] if stable[0] else []
    for (low, before), (high, after) in pairwise(zip(lams, stable, strict=True)):
        if before != after:
            while high - low > 1e-12:
                middle = (low + high) / 2
                inside = growth(order, known, sigma, middle) < 1
                low, high = (middle, high) if inside == before else (low, middle)
            found.append(float(low))
    return [*found, 2.0] if stable[-1] else found


@pytest.mark.parametrize(("case", "count"), CASES)
def test_thresholds_to_eight_digits(case: tuple[int, int, Fraction], count: int) -> None:
    found = stable_set(beam_warming(*case), {})
    assert found.undecided is None
    assert len(found.intervals) == count
    np.testing.assert_allclose(ends(found), thresholds(*case), rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    ("sigma", "expected"),
    [
        (Fraction(0), [0, 1, 1.5, 2]),
        (Fraction(-1, 2), [0, 1 - 2**-0.5, 1 + 2**-0.5, 2]),
        (Fraction(-1, 4), [0, (9 - 17**0.5) / 8, (9 + 17**0.5) / 8, 2]),
    ],
)
def test_thresholds_in_closed_form(sigma: Fraction, expected: list[float]) -> None:
    found = stable_set(beam_warming(2, 1, sigma), {})
    np.testing.assert_allclose(ends(found), expected, rtol=1e-15)
    assert found.limited_by == "closure"


def test_bisection_between_a_stable_and_an_unstable_lam_finds_one_edge_of_three() -> None:
    """The naive way: 0.1 is stable and 1.9 unstable, and bisection returns some edge; the first one is another."""
    case = (5, 3, Fraction(1, 2))
    low, high = 0.1, 1.9
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (middle, high) if growth(*case, middle) < 1 else (low, middle)
    edges = ends(stable_set(beam_warming(*case), {}))
    assert min(abs(low - edge) for edge in edges) < 1e-8
    assert abs(low - edges[1]) > 0.1


def test_the_edges_themselves_are_decided_exactly() -> None:
    """u[-1] = u[0] - u[1]. At lam = 1 the scheme is the shift, kappa = 1/z with 1 = kappa - kappa**2: sixth roots of 1,
    which do not decay. At lam = 3/2 both spatial roots of the mode do."""
    scheme = beam_warming(2, 1, Fraction(0))
    tiny = Fraction(1, 10**100)
    verdicts = {
        1 - tiny: Verdict.STABLE,
        Fraction(1): Verdict.GENERALIZED,
        1 + tiny: Verdict.UNSTABLE,
        Fraction(3, 2) - tiny: Verdict.UNSTABLE,
        Fraction(3, 2): Verdict.NEUTRAL,
        Fraction(3, 2) + tiny: Verdict.STABLE,
    }
    assert {lam: analyse(scheme, {"lam": lam}).verdict for lam in verdicts} == verdicts
