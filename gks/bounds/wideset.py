"""The stable set in lam of schemes beyond the elimination.

Under the method of lines it follows from the zeros s of Delta (`gks.bounds.rayset`), and is proved. Where z itself is
the variable, or lam enters the equations and the zeros s move with it, the critical lam are traced numerically
(`gks.bounds.crossings`), every piece between them is decided by a certified verdict at one point, and every end by
certified verdicts on either side of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING

from gks.bounds.cfl import Limit
from gks.bounds.located import Located, Span, close_to, nothing_said
from gks.bounds.rayset import ray_set
from gks.bounds.signs import interior_sets, space_holds_lam, with_signs
from gks.errors import InputError
from gks.modes.algebraic import Root
from gks.modes.analysis import quick_verdict
from gks.modes.cauchy_set import CauchySet
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.unimodular import simplest_between
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    from gks.bounds.crossings import Crossings

BESIDE = (40, 34, 30)
"""An end is held between verdicts at (1 - 2**-k) and (1 + 2**-k) times it, for the first k at which both are had."""


def wide_stable_set(scheme: Scheme, values: Mapping[str, Fraction]) -> Located:
    """The stable set at the values given; InputError where the scheme is at fault."""
    sample = {**values, scheme.cfl: values.get(scheme.cfl, Fraction(1))}
    interior, signs = interior_sets(scheme, sample)
    problem = with_signs(scheme, sample)
    moving = space_holds_lam(problem)

    def problem_at(lam: Fraction) -> NormalModeProblem:
        return normal_mode_problem(scheme, {**values, scheme.cfl: lam})

    method = problem.resolvent.integrator
    if method is not None and method.kind == "exact":
        if moving:
            return nothing_said(f"time is exact and {scheme.cfl} enters the equations")
        return _whole_axis(scheme, sample)
    if method is not None and not moving:
        return ray_set(problem_at, interior)
    spans: list[Span] = []
    proved_to = 0.0
    for low, high in _without(_pieces(interior), signs):
        found = _traced(scheme, values, low, high)
        if isinstance(found, str):
            return nothing_said(found)
        inner, error = found
        if spans and inner and spans[-1][1] == inner[0][0]:
            # Both sides of a speed's change of sign are stable, of two different schemes: the lam between is a third.
            at_sign = _verdict(scheme, values, low.rational) if low.rational is not None else None
            if at_sign is None:
                return nothing_said(f"undecided at lam = {float(inner[0][0]):.12g}, where a wave speed changes sign")
            if at_sign:
                inner[0] = (spans.pop()[0], inner[0][1])
        spans += inner
        proved_to = max(proved_to, error)
    return Located(tuple(spans), _limited(spans, interior), proved_to, False)


def _whole_axis(scheme: Scheme, values: Mapping[str, Fraction]) -> Located:
    """The semi-discrete problem: lam plays no part."""
    verdict = quick_verdict(scheme, values)
    if verdict is Verdict.UNDECIDED:
        return nothing_said("the semi-discrete problem is undecided")
    whole: tuple[Span, ...] = ((Fraction(0), None),)
    return Located(whole if verdict is Verdict.STABLE else (), None, 0.0, True)


def _pieces(interior: Sequence[CauchySet]) -> list[tuple[Root, Root | None]]:
    """The open intervals on which every field is Cauchy-stable."""
    pieces: list[tuple[Root, Root | None]] = [(Root.of(0), None)]
    for each in interior:
        met: list[tuple[Root, Root | None]] = []
        for low, high in pieces:
            for other in each.intervals:
                start = max(low, other.low)
                ends = [end for end in (high, other.high) if end is not None]
                if not ends or start < min(ends):
                    met.append((start, min(ends) if ends else None))
        pieces = met
    return pieces


def _without(pieces: Sequence[tuple[Root, Root | None]], points: Sequence[Root]) -> Iterator[tuple[Root, Root | None]]:
    """The pieces, cut at the points (ascending) that lie inside one."""
    for low, high in pieces:
        inner = [point for point in points if low < point and (high is None or point < high)]
        yield from zip([low, *inner], [*inner, high], strict=True)


def _traced(
    scheme: Scheme, values: Mapping[str, Fraction], low: Root, high: Root | None
) -> tuple[list[Span], float] | str:
    """The stable intervals of a Cauchy-stable piece and the error of their ends; or what stayed open."""
    from gks.bounds.crossings import crossings
    from gks.bounds.sampled import sampled

    bottom, top = close_to(low), None if high is None else close_to(high)
    middle = 2 * bottom + 1 if top is None else (bottom + top) / 2
    compiled = sampled(normal_mode_problem(scheme, {**values, scheme.cfl: middle}, (scheme.cfl,)))
    found = crossings(
        lambda z, lam: compiled.at(z, lam).determinant, float(bottom), float("inf") if top is None else float(top)
    )
    if found.open_ is not None:
        return found.open_
    if found.always is not None:
        return _never(scheme, values, middle, found.always)
    cuts = [Fraction(lam) for lam in found.lams]
    verdicts = _decided(scheme, values, found, [bottom, *cuts, top])
    if isinstance(verdicts, str):
        return verdicts
    spans: list[Span] = []
    error = 0.0
    for k, (a, b) in enumerate(pairwise([bottom, *cuts, top])):
        if verdicts[k] and a is not None:
            if spans and verdicts[k - 1]:
                return f"stable on either side of lam = {float(a):.12g}, where a mode is on the unit circle"
            spans.append((a, b))
    for k, cut in enumerate(cuts):
        if verdicts[k] != verdicts[k + 1]:
            held = _held(scheme, values, cut, bool(verdicts[k]))
            if held is None:
                return f"the end of a stable interval near lam = {float(cut):.12g} was not confirmed"
            error = max(error, held)
    return spans, error


def _decided(
    scheme: Scheme, values: Mapping[str, Fraction], found: Crossings, ends: Sequence[Fraction | None]
) -> list[bool] | str:
    """The verdict in every interval between the crossings, which has to hold where none could be seen as well."""
    verdicts: list[bool] = []
    for a, b in pairwise(ends):
        verdict = _verdict(scheme, values, _between(a, b))
        if verdict is None:
            return "the verdict between two crossings is undecided"
        for lam in found.unseen_between(float(a or 0), float("inf") if b is None else float(b)):
            if _verdict(scheme, values, Fraction(lam), at_length=False) is (not verdict):
                return f"the verdict at lam = {lam:.3g} is not that of its interval: a crossing too small to be traced"
        verdicts.append(verdict)
    return verdicts


def _never(scheme: Scheme, values: Mapping[str, Fraction], lam: Fraction, z: int) -> tuple[list[Span], float] | str:
    """Delta vanishes at z = 1 or -1 for every lam: whether that is a mode is the same for all, if it is one here."""
    verdict = _verdict(scheme, values, lam)
    if verdict is False:
        return [], 0.0
    return f"Delta vanishes at z = {z} for every lam"


def _between(a: Fraction | None, b: Fraction | None) -> Fraction:
    assert a is not None
    return 2 * a + 1 if b is None else simplest_between((2 * a + b) / 3, (a + 2 * b) / 3)


def _verdict(scheme: Scheme, values: Mapping[str, Fraction], lam: Fraction, *, at_length: bool = True) -> bool | None:
    """Stable or not at one lam where the interior is; None where that is undecided. ``at_length`` is that of
    `quick_verdict`.
    """
    try:
        verdict = quick_verdict(scheme, {**values, scheme.cfl: lam}, at_length=at_length)
    except InputError:
        return None
    return None if verdict is Verdict.UNDECIDED else verdict is Verdict.STABLE


def _held(scheme: Scheme, values: Mapping[str, Fraction], cut: Fraction, below: bool) -> float | None:
    """The relative distance at which verdicts on either side of an end confirm it."""
    for k in BESIDE:
        step = Fraction(1, 2**k)
        before, after = (_verdict(scheme, values, cut * (1 + s)) for s in (-step, step))
        if before is below and after is (not below):
            return 2.0**-k
    return None


def _limited(spans: Sequence[Span], interior: Sequence[CauchySet]) -> Limit | None:
    top = spans[0][1] if spans and spans[0][0] == 0 else Fraction(0)
    if top is None:
        return None
    limits = [each.first_limit for each in interior]
    return "interior" if any(limit is not None and close_to(limit) == top for limit in limits) else "closure"
