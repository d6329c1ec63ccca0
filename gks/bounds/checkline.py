"""The checker's stable set in lam alone, at fixed values of everything else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, ctx

from gks.bounds.checkcurves import curves
from gks.bounds.checkderive import derive
from gks.bounds.checkformula import Rejected
from gks.bounds.checkjudges import Judges
from gks.bounds.checknumbers import Real, complex_of, exact, gaps_between, real_roots, univariate
from gks.bounds.checkpoint import Judge, stable_between
from gks.bounds.checkring import Unsupported, degree
from gks.errors import GksError
from gks.scheme.model import Scheme

Spans = list[tuple[Real | None, Real | None]]

NOWHERE = Fraction(0)
"""The parameter's place where there is no parameter."""

UNDECIDED = "undecided"
"""A verdict on the bound that says nothing, and is let be."""

FIRST = Fraction(1, 64)
"""The lam whose signs of wave speeds give the first curves: those of the interior say where else to look."""


@dataclass(frozen=True, slots=True)
class Line:
    """The stable intervals, and the judge below each of their upper ends."""

    spans: Spans
    judges: list[Judge]


def line(scheme: Scheme, fixed: Mapping[str, Fraction]) -> Line:
    """The stable intervals, derived anew."""
    judges, levels = _levels(scheme, fixed)
    gaps = gaps_between([each.ball() for each in levels])
    here = [judges.at(NOWHERE, lam) for lam in gaps]
    spans: Spans = []
    below: list[Judge] = []
    ends: list[Real | None] = [None, *levels, None]
    bottoms = [Fraction(0), *(exact(level.ball()) for level in levels)]
    for k, (lam, judge) in enumerate(zip(gaps, here, strict=True)):
        if judge is None or not stable_between(judge, NOWHERE, bottoms[k], lam):
            continue
        low, high = ends[k], ends[k + 1]
        if low is not None and spans and spans[-1][1] is low and verdict_on(below[-1], NOWHERE, low) == "stable":
            spans[-1], below[-1] = (spans[-1][0], high), judge
        else:
            spans.append((low, high))
            below.append(judge)
    return Line(spans, below)


def _levels(scheme: Scheme, fixed: Mapping[str, Fraction]) -> tuple[Judges, list[Real]]:
    """All positive lam at which anything may change, for whichever signs and counts there are between them."""
    judges = Judges(scheme, fixed, None)
    own = curves(derive(scheme, fixed, None, NOWHERE, FIRST, counted=False), closure=False)
    while True:
        levels = [
            Real(poly, k + 1)
            for poly in (univariate(curve, "lam") for curve in own.values() if degree(curve, "lam"))
            for k, root in enumerate(real_roots(poly))
            if root > 0
        ]
        levels.sort(key=lambda each: each.ball().mid())
        for lam in gaps_between([each.ball() for each in levels]):
            judges.at(NOWHERE, lam)
        found = judges.curves()
        if found.keys() <= own.keys():
            return judges, levels
        own |= found


def bound_on(found: Line) -> str | None:
    """The verdict on the bound; None where it is 0 or infinite."""
    top = found.spans[0][1] if found.spans and found.spans[0][0] is None else None
    return None if top is None else verdict_on(found.judges[0], NOWHERE, top)


def verdict_on(judge: Judge, p: Fraction, lam: Real) -> str:
    """The verdict at a point of a curve; where lam is irrational the interior is taken for the limit of stable ones."""
    whole = lam.rational
    if whole is not None:
        return judge.on_curve(p, whole)

    def ends(bits: int) -> dict[str, acb]:
        with ctx.workprec(bits):
            return {"p": complex_of(p), "lam": acb(lam.ball(bits))}

    return judge.at_point(ends, {"p": p})


def verify_line(
    scheme: Scheme,
    fixed: Mapping[str, Fraction],
    spans: Sequence[tuple[Real | None, Real | None]],
    at_bound: str | None,
) -> None:
    """Holds stated intervals and the verdict on the bound against the checker's own."""
    try:
        whole = line(scheme, fixed)
        found = whole.spans
    except (GksError, Unsupported):
        if not spans and at_bound is None:
            return  # there is no scheme at these values, and none is said to be stable
        raise
    if len(found) != len(spans) or not all(
        (a is None and b is None) or (a is not None and b is not None and a.ball().overlaps(b.ball()))
        for one, other in zip(found, spans, strict=True)
        for a, b in zip(one, other, strict=True)
    ):
        raise Rejected("the stable set is not what the certificate says")
    if at_bound != UNDECIDED and bound_on(whole) != at_bound:
        raise Rejected("the verdict on the bound is not what the certificate says")
