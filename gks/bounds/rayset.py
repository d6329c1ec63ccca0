"""Method of lines: the stable set in lam from the zeros s of Delta, each found once and followed along its ray.

With U(lam) the set of s for which the integrator has a root with abs(z) >= 1, the modes at lam are the zeros of Delta
in U(lam). For every named integrator the stable mu = lam s of a direction with Re mu <= 0 are an interval from 0 on
(held by a test), so that

    U(lam) is contained in U(top) and {Re s >= 0}    for 0 < lam < top,

where a top at which the interior is Cauchy-stable keeps the number of decaying solutions on all of it. The zeros in
U(top) and in the half-plane are counted and proved by balls (`gks.modes.wide`), a top next to the interior's own limit
leaves nothing below it uncovered, and what each zero allows along its ray is exact (`gks.bounds.rayballs`). A wave
trapped without loss has its zero on the imaginary axis itself: whether it is damped is a question of the integrator.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

from flint import acb, arb

from gks.bounds.cfl import Limit
from gks.bounds.located import Located, Span, nothing_said
from gks.bounds.rayballs import stable_intervals_ball
from gks.modes.admissible import Candidate
from gks.modes.algebraic import Root
from gks.modes.cauchy_set import CauchySet
from gks.modes.kreiss import NormalModeProblem
from gks.modes.numerals import exact_fraction
from gks.modes.reversal import reverses_time
from gks.modes.unimodular import rational_ends
from gks.modes.verdict import ModeKind
from gks.modes.wide import VanishingDeterminant, wide_modes
from gks.scheme.integrators import Integrator, integrator

NEXT_TO_LIMIT = (34, 26, 18)
"""The top is (1 - 2**-k) times the interior's limit, for the first k at which the count closes: at the limit itself a
spatial root of the interior is on the circle for good."""
RAY_BITS = 160
"""The zeros come at 96 bits or more; the rest is for cancellation along the ray."""

ProblemAt = Callable[[Fraction], NormalModeProblem]


def ray_set(problem_at: ProblemAt, interior: Sequence[CauchySet]) -> Located:
    """The stable set; ``problem_at`` gives the problem at a lam, its variable being s under one named integrator."""
    limit = _limit(interior)
    if limit is not None and limit.is_zero:
        return Located((), "interior", 0.0, True)
    least = Fraction(1) if limit is None else rational_ends(limit.ball().real)[0]
    inside = least / 2
    sample = problem_at(inside)
    method = sample.resolvent.integrator
    assert method is not None and method.kind != "exact"
    half_plane = _zeros(_semi_discrete(sample))
    if isinstance(half_plane, str):
        return nothing_said(half_plane)
    allowed = _along(method, half_plane, limit, 0.0)
    if limit is None or (allowed.undecided is None and not allowed.intervals):
        return allowed  # more zeros allow no more
    why = ""
    for k in NEXT_TO_LIMIT:
        beyond = _zeros(problem_at(least * (1 - Fraction(1, 2**k))))
        if not isinstance(beyond, str):
            # A zero on the axis was the only one in its pocket: what meets its ball is itself, less sharply.
            others = [s for s in beyond if not any(s.overlaps(t) for t in half_plane)]
            return _along(method, half_plane + others, limit, 2.0 ** (1 - k))
        why = beyond
    return nothing_said(why)


def _limit(interior: Sequence[CauchySet]) -> Root | None:
    """The end of the interior's stable interval, which begins at 0 if there is one; None is infinity."""
    limits = [each.first_limit for each in interior]
    finite = [limit for limit in limits if limit is not None]
    return min(finite) if finite else None


def _semi_discrete(problem: NormalModeProblem) -> NormalModeProblem:
    """The same closure with time left continuous: its modes with Re s >= 0."""
    resolvent = replace(problem.resolvent, integrator=integrator("exact"))
    return replace(problem, resolvent=resolvent, time_map=None)


def _zeros(problem: NormalModeProblem) -> list[acb] | str:
    """s of every mode, all of them proved; or why they are not.

    Where abs(z) = 1 belongs to Re s = 0 the real part of such a mode is exactly 0: what becomes of it is a question of
    the ray, which may leave the circle at once.
    """
    try:
        found = wide_modes(problem)
    except VanishingDeterminant:
        return "the closure is degenerate to rounding"
    if found.doubts:
        return found.doubts[0]
    if not found.certified:
        return "the modes were found and not proved"
    zeros = []
    for mode, place in zip(found.modes, found.places, strict=True):
        if mode.kind is ModeKind.DECAYING:
            continue
        s = place.sigma.ball(RAY_BITS) if isinstance(place, Candidate) else place.sigma(problem)
        if s is None:
            return "a multiple mode was enclosed and not resolved"
        on_axis = mode.modulus == 1 and reverses_time(problem.resolvent.integrator)
        zeros.append(acb(0, s.imag) if on_axis else s)
    return zeros


def _along(method: Integrator, zeros: Sequence[acb], limit: Root | None, gap: float) -> Located:
    """The intersection of what the zeros allow with the interior's interval, of which ``gap`` was not looked at."""
    error = 0.0
    spans: list[Span] = [(Fraction(0), None if limit is None else _middle(limit.ball().real))]
    for s in zeros:
        # Balls that meet the real axis hold a zero and its conjugate, of which there is only one.
        real = acb(s.real) if s.imag.contains(0) else s
        mine = stable_intervals_ball(method, real, RAY_BITS)
        if mine is None:
            return nothing_said(f"where a mode with s = {complex(s):.6g} is stable was not resolved")
        error = max([error, *(_relative(end) for span in mine for end in span if end is not None)])
        spans = _met(spans, [(_middle(low), None if high is None else _middle(high)) for low, high in mine])
    own = None if limit is None else _middle(limit.ball().real)
    if own is not None and any(high is not None and high > own * (1 - Fraction(gap)) for _, high in spans):
        error = max(error, gap)  # what lies between the top and the limit was not looked at
    if any(high is not None and high - low <= 4 * Fraction(error) * high for low, high in spans):
        return nothing_said("two ends of stable intervals are not told apart")
    return Located(tuple(spans), _limited(spans, own, error), error, True)


def _met(one: Sequence[Span], other: Sequence[Span]) -> list[Span]:
    """The intersection of two ascending lists of intervals."""
    met = []
    for a, b in one:
        for c, d in other:
            low, high = max(a, c), min((end for end in (b, d) if end is not None), default=None)
            if high is None or low < high:
                met.append((low, high))
    return met


def _limited(spans: Sequence[Span], own: Fraction | None, error: float) -> Limit | None:
    top = spans[0][1] if spans and spans[0][0] == 0 else Fraction(0)
    if top is None:
        return None
    return "interior" if own is not None and abs(top - own) <= Fraction(error) * own else "closure"


def _middle(number: arb) -> Fraction:
    """The midpoint itself: the ends would be rounded outwards, by more than a sharp ball's radius."""
    return exact_fraction(number)


def _relative(number: arb) -> float:
    if number.contains(0):
        return 0.0
    return float((number.rad() / abs(number.mid())).abs_upper())
