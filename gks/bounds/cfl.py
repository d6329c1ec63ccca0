"""The stable set in lam at one set of parameter values, exactly.

The positive lam axis is cut at the finitely many algebraic numbers where the verdict may change (``modes.critical``,
and
the interior's own Cauchy limits). One exact verdict at a rational lam decides each piece; where two stable pieces
meet, an
exact verdict at the algebraic number between them says whether an isolated unstable lam separates them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from gks.bounds.signs import interior_sets
from gks.errors import InputError, NotAnalysable
from gks.modes.algebraic import Root
from gks.modes.analysis import quick_verdict
from gks.modes.cauchy_set import CauchySet, rationals_between
from gks.modes.clear import clear_of_modes
from gks.modes.critical import LamElimination, lam_elimination, positive_roots
from gks.modes.kreiss import normal_mode_problem
from gks.modes.unimodular import by_real_part
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme

Limit = Literal["interior", "closure"]


@dataclass(frozen=True, slots=True)
class Interval:
    """An open interval of stable lam; ``low`` None is 0, ``high`` None is infinity."""

    low: Root | None
    high: Root | None


@dataclass(frozen=True, slots=True)
class StableSet:
    """All stable lam > 0 but for isolated ones, as disjoint open intervals, ascending.

    ``undecided`` says why a piece or a point between two pieces stayed open; the set is then not complete.
    """

    intervals: tuple[Interval, ...]
    limited_by: Limit | None
    undecided: str | None

    @property
    def lam_max(self) -> Root | None:
        """The largest number with every smaller positive lam stable: 0 where there is none, None is infinity."""
        if self.intervals and self.intervals[0].low is None:
            return self.intervals[0].high
        return Root.of(0)


def stable_set(scheme: Scheme, values: Mapping[str, Fraction]) -> StableSet:
    """The stable set at the values given (lam's own value is not used).

    Raises InputError where the scheme is at fault or beyond the exact route.
    """
    sample = {**values, scheme.cfl: values.get(scheme.cfl, Fraction(1))}
    interior, signs = interior_sets(scheme, sample)
    sides = _sides(scheme, sample, interior, signs)
    closure = positive_roots(p for side in sides for p in side.eliminated.polynomials())
    critical = by_real_part(_distinct([*_ends(interior), *signs, *closure]))
    pieces = [_piece(scheme, values, lam, interior) for lam in rationals_between(critical)]
    return _assembled(scheme, values, critical, pieces, interior, sides)


@dataclass(frozen=True, slots=True)
class _Side:
    """A Cauchy-stable piece of the lam axis, with the elimination for its number of decaying solutions."""

    low: Root | None
    high: Root | None
    eliminated: LamElimination

    def holds(self, lam: Root) -> bool:
        return (self.low is None or self.low < lam) and (self.high is None or lam < self.high)


def _sides(
    scheme: Scheme, sample: Mapping[str, Fraction], interior: Sequence[CauchySet], signs: Sequence[Root]
) -> list[_Side]:
    """One for each piece that the interior, and the ``signs`` of its speeds, leave.

    The number of decaying solutions is constant on such a piece, not from one to the next; nor is the scheme where a
    speed changes its sign.
    """
    cuts = by_real_part(_distinct([*_ends(interior), *signs]))
    sides: list[_Side] = []
    known: dict[tuple[tuple[int, str], ...], LamElimination] = {}
    ends: list[Root | None] = [None, *cuts, None]
    for k, lam in enumerate(rationals_between(cuts)):
        if not all(each.contains(Root.of(lam)) for each in interior):
            continue
        problem = normal_mode_problem(scheme, {**sample, scheme.cfl: lam}, (scheme.cfl,))
        counts = tuple((family.decaying, str(family.polynomial) if signs else "") for family in problem.families)
        if counts not in known:
            known[counts] = lam_elimination(problem)
        sides.append(_Side(ends[k], ends[k + 1], known[counts]))
    return sides


def _distinct(roots: Sequence[Root]) -> list[Root]:
    return list(dict.fromkeys(root.minimal for root in roots))


def _ends(sets: Sequence[CauchySet]) -> list[Root]:
    ends = [end for each in sets for interval in each.intervals for end in (interval.low, interval.high)]
    return [end for end in ends if end is not None and not end.is_zero]


def _piece(
    scheme: Scheme, values: Mapping[str, Fraction], lam: Fraction | Root, interior: Sequence[CauchySet]
) -> Verdict:
    exact = lam if isinstance(lam, Root) else Root.of(lam)
    if not all(each.contains(exact) for each in interior):
        return Verdict.UNSTABLE
    return quick_verdict(scheme, {**values, scheme.cfl: lam})


def _assembled(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    critical: Sequence[Root],
    pieces: Sequence[Verdict],
    interior: Sequence[CauchySet],
    sides: Sequence[_Side],
) -> StableSet:
    intervals: list[Interval] = []
    undecided = "a piece of the lam axis is undecided" if Verdict.UNDECIDED in pieces else None
    ends: list[Root | None] = [None, *critical, None]
    for k, verdict in enumerate(pieces):
        if verdict is not Verdict.STABLE:
            continue
        low, high = ends[k], ends[k + 1]
        if low is not None and intervals and intervals[-1].high is low:
            between = _at_point(scheme, values, low, interior, sides)
            if between is Verdict.STABLE:
                intervals[-1] = Interval(intervals[-1].low, high)
                continue
            if between is Verdict.UNDECIDED:
                undecided = f"lam = {low.ball().real.str(15, radius=False)} between two stable pieces is undecided"
        intervals.append(Interval(low, high))
    return StableSet(tuple(intervals), _limited_by(intervals, interior), undecided)


def _at_point(
    scheme: Scheme, values: Mapping[str, Fraction], lam: Root, interior: Sequence[CauchySet], sides: Sequence[_Side]
) -> Verdict:
    """The verdict at a critical lam: by balls where they prove it stable, else exactly."""
    if any(side.holds(lam) and clear_of_modes(side.eliminated, lam) for side in sides):
        return Verdict.STABLE
    rational = lam.rational
    try:
        return _piece(scheme, values, lam if rational is None else rational, interior)
    except NotAnalysable:
        return Verdict.UNDECIDED
    except InputError:
        # No scheme exists at this single value (a division by zero there, a degenerate closure).
        return Verdict.UNSTABLE


def _limited_by(intervals: Sequence[Interval], interior: Sequence[CauchySet]) -> Limit | None:
    top = intervals[0].high if intervals and intervals[0].low is None else Root.of(0)
    if top is None:
        return None
    limits = [each.first_limit for each in interior]
    return "interior" if any(limit is not None and limit == top for limit in limits) else "closure"
