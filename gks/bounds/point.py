"""One point of a curve, by the cheapest route that is sufficient.

By elimination where its work is within bounds; else from the zeros s along their rays, or traced
(`gks.bounds.wideset`). A point that one route leaves open goes to the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Literal, NamedTuple

from gks.bounds.cfl import Limit, StableSet, stable_set
from gks.bounds.located import Located, close_to
from gks.bounds.sweep import Point
from gks.modes.algebraic import Root
from gks.modes.kreiss import spatial_problem
from gks.modes.numerals import json_real
from gks.modes.polynomial import TooWide
from gks.modes.route import elimination_work
from gks.scheme.model import Scheme

Number = float | str
"""A number as JSON has it: a double, a decimal string beyond the doubles, "oo" for infinity."""

Tier = Literal["exact", "certified", "numeric"]
"""How a point was found: by algebra; by arithmetic with proved error bounds; traced, its ends alone being proved."""

DOUBLE_ERROR = 2.0**-53
"""Relative error of an exact end once it is rounded to a double."""

TIERS: tuple[Tier, ...] = ("exact", "certified", "numeric")
"""The strongest first."""

LAM_WORK = 30
"""`elimination_work` up to which elimination with lam as a symbol is tried first. A Lax-Wendroff scheme of order 4 (24)
takes it a tenth of a second; two second-order fields on both sides of an interface (64) from half a second to minutes,
tracing one or two seconds."""


class CurvePoint(NamedTuple):
    """One point. ``error_bound`` is relative, absolute at 0; where ``resolved`` is False, ``because`` says why."""

    value: Number | None
    lam_max: Number | None
    limited_by: Limit | None
    stable_set: tuple[tuple[Number, Number], ...]
    error_bound: float
    resolved: bool
    because: str = ""
    tier: Tier = "exact"

    def to_json(self, name: str | None) -> dict[str, object]:
        """The point of the contract's JSON; ``name`` is the parameter swept."""
        point: dict[str, object] = {} if name is None else {name: self.value}
        point["lam_max"] = self.lam_max
        point["limited_by"] = self.limited_by
        point["stable_set"] = self.stable_set
        point["error_bound"] = self.error_bound
        point["status"] = "resolved" if self.resolved else "undecided"
        return point


def weakest(points: Iterable[CurvePoint]) -> Tier:
    """The weakest tier among the points that are resolved."""
    used = {point.tier for point in points if point.resolved}
    return next((tier for tier in reversed(TIERS) if tier in used), TIERS[0])


def flagged(value: Point | None, why: str) -> CurvePoint:
    """An undecided point."""
    return CurvePoint(None if value is None else number(value), None, None, (), 0.0, False, why)


def number(value: Point) -> Number:
    """A value of the parameter as JSON has it."""
    return value if isinstance(value, float) else json_real(value)


def point_at(scheme: Scheme, values: Mapping[str, Fraction], value: Point | None, *, certify: bool) -> CurvePoint:
    """The point at the values given, shown at ``value``; InputError as the analyses raise it.

    With ``certify`` a set that was traced numerically counts as undecided.
    """
    shown = None if value is None else number(value)
    sample = {**values, scheme.cfl: values.get(scheme.cfl, Fraction(1))}
    cheap = elimination_work(spatial_problem(scheme, sample, (scheme.cfl,))) <= LAM_WORK
    first, second = (_exact, _wide) if cheap or certify else (_wide, _exact)
    try:
        found = first(scheme, values, certify)
        open_ = found.undecided
    except TooWide as reason:
        found, open_ = None, str(reason)
    if open_ is not None:
        try:
            other = second(scheme, values, certify)
        except TooWide:
            other = None
        if other is not None and (found is None or other.undecided is None):
            found = other
    if found is None:
        return flagged(value, open_ or "")
    if found.undecided is not None:
        return flagged(value, found.undecided)
    return _of_located(scheme, shown, found) if isinstance(found, Located) else _of_exact(scheme, shown, found)


Route = Callable[[Scheme, Mapping[str, Fraction], bool], StableSet | Located]


def _exact(scheme: Scheme, values: Mapping[str, Fraction], _certify: bool) -> StableSet:
    return stable_set(scheme, values)


def _wide(scheme: Scheme, values: Mapping[str, Fraction], certify: bool) -> Located:
    from gks.bounds.located import nothing_said
    from gks.bounds.wideset import wide_stable_set

    found = wide_stable_set(scheme, values)
    if certify and found.undecided is None and not found.proved:
        return nothing_said("the stable set was traced numerically: its ends are proved, what lies between is not")
    return found


def semi_discrete(scheme: Scheme) -> bool:
    """Whether time is exact: then stability does not depend on lam, and there is no lam_max."""
    return any(half_line.time == "exact" for half_line in scheme.domains)


def _of_exact(scheme: Scheme, shown: Number | None, found: StableSet) -> CurvePoint:
    spans = tuple((_end(i.low, 0.0), _end(i.high, "oo")) for i in found.intervals)
    exact = all(_is_printed(end) for i in found.intervals for end in (i.low, i.high))
    top = _end(found.lam_max, "oo") if not semi_discrete(scheme) else None
    return CurvePoint(shown, top, found.limited_by, spans, 0.0 if exact else DOUBLE_ERROR, True)


def _of_located(scheme: Scheme, shown: Number | None, found: Located) -> CurvePoint:
    spans = tuple((json_real(low), "oo" if high is None else json_real(high)) for low, high in found.intervals)
    top = None if semi_discrete(scheme) else "oo" if found.lam_max is None else json_real(found.lam_max)
    tier: Tier = "certified" if found.proved else "numeric"
    return CurvePoint(shown, top, found.limited_by, spans, found.error + DOUBLE_ERROR, True, "", tier)


def _end(end: Root | None, otherwise: Number) -> Number:
    """An end of an interval: its double, rounded from an enclosure with bits to spare."""
    if end is None:
        return otherwise
    return json_real(close_to(end))


def _is_printed(end: Root | None) -> bool:
    """Whether the number shown for an end is the end itself and not its rounding."""
    if end is None:
        return True
    rational = end.rational
    return rational is not None and Fraction(json_real(rational)) == rational

