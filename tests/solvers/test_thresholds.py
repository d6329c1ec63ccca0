"""Every shipped scheme's derived lam_max stands between a march that is quiet and one that is not."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import pytest

from gks.bounds.cfl import stable_set
from gks.catalogue import find, names
from gks.errors import NotAnalysable
from gks.modes import Verdict, analyse
from gks.scheme.model import Scheme
from gks.solvers.thresholds import Bracket, bracket
from tests.oracle.scheme_texts import LEAPFROG, half_line

WIDE = ("lax-wendroff-order-6-oblique", "lax-wendroff-order-8-oblique")
"""Too wide for an elimination with lam as a symbol in a few seconds: bracketed by certified verdicts instead."""

FAR = Fraction(4)
"""Where a scheme without a limit is marched."""


def limits(name: str, scheme: Scheme, values: Mapping[str, Fraction]) -> tuple[Fraction, Fraction | None]:
    """(stable below, unstable from), the same number where lam_max is known; (FAR, None) where there is no limit."""
    try:
        if name in WIDE:
            raise NotAnalysable("wide")
        root = stable_set(scheme, values).lam_max
    except NotAnalysable:
        return between_verdicts(scheme, values)
    if root is None:
        return FAR, None
    limit = Fraction(float(root.ball(64).real.mid()))
    return limit, limit


def between_verdicts(scheme: Scheme, values: Mapping[str, Fraction]) -> tuple[Fraction, Fraction]:
    low, high = values[scheme.cfl], 3 * values[scheme.cfl]
    assert analyse(scheme, {**values, scheme.cfl: high}).verdict is Verdict.UNSTABLE
    while high > low * Fraction(9, 8):
        middle = (low + high) / 2
        stable = analyse(scheme, {**values, scheme.cfl: middle}).verdict is Verdict.STABLE
        low, high = (middle, high) if stable else (low, middle)
    return low, high


@pytest.mark.parametrize("name", names())
def test_marches_bracket_the_limit(name: str) -> None:
    scheme = find(name)
    values = scheme.values({})
    stable, unstable = limits(name, scheme, values)
    found = bracket(scheme, values, stable, unstable)
    if unstable is None:
        assert found.means == "none" and found.reason == "no limit", found
        assert found.below is not None and found.below.lam == FAR
    else:
        assert found.holds, found


def traditional(stable: str, unstable: str | None) -> Bracket:
    """The second-order traditional coupling at alpha = 1: lam_max is 0.4397."""
    scheme = find("traditional-2")
    values = scheme.values({"alpha": 1})
    return bracket(scheme, values, Fraction(stable), None if unstable is None else Fraction(unstable))


class TestAWrongLimit:
    def test_too_high(self) -> None:
        found = traditional("0.7", "0.7")
        assert found.holds is False and "below the limit" in found.reason

    def test_too_low(self) -> None:
        """Nothing happens just above: what is seen to grow is far from the limit, or nothing is."""
        found = traditional("0.1", "0.1")
        assert not found.holds and "nothing grows above" in found.reason

    def test_none_where_there_is_one(self) -> None:
        found = traditional("0.7", None)
        assert found.holds is False and "below the limit" in found.reason

    def test_one_for_a_scheme_that_is_never_stable(self) -> None:
        scheme = half_line(LEAPFROG, '"u[0, n+1] = u[1, n+1]"', 1)
        found = bracket(scheme, scheme.values({}), Fraction(1, 2), Fraction(1, 2))
        assert found.holds is False and found.means == "forcing" and "below" in found.reason

    def test_zero_for_a_scheme_that_is_stable(self) -> None:
        found = traditional("0", "0")
        assert found.means == "growth" and found.above is not None  # at lam = 0.9 it does grow
        scheme = find("weighted-1")
        found = bracket(scheme, scheme.values({}), Fraction(0), Fraction(0))
        assert found.holds is None and "nothing grows" in found.reason
