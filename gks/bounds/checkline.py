"""The checker's stable set in lam alone, at fixed values of everything else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import acb, ctx

from gks.bounds.checkcurves import curves
from gks.bounds.checkderive import derive
from gks.bounds.checkformula import Rejected
from gks.bounds.checknumbers import Real, complex_of, gaps_between, real_roots, univariate
from gks.bounds.checkpoint import Judge
from gks.bounds.checkring import Unsupported, degree
from gks.errors import GksError
from gks.scheme.model import Scheme

Spans = list[tuple[Real | None, Real | None]]

NOWHERE = Fraction(0)
"""The parameter's place where there is no parameter."""


def line(scheme: Scheme, fixed: Mapping[str, Fraction]) -> tuple[Spans, Judge]:
    """The stable intervals, derived anew."""
    judge = _judge(scheme, fixed, Fraction(1, 64))
    levels: list[Real] = []
    for curve in curves(judge.problem).values():
        if degree(curve, "lam"):
            poly = univariate(curve, "lam")
            levels += [Real(poly, k + 1) for k, root in enumerate(real_roots(poly)) if root > 0]
    levels.sort(key=lambda each: each.ball().mid())
    stable = [judge.stable(NOWHERE, lam) for lam in gaps_between([each.ball() for each in levels])]
    spans: Spans = []
    ends: list[Real | None] = [None, *levels, None]
    for k, is_stable in enumerate(stable):
        if not is_stable:
            continue
        low, high = ends[k], ends[k + 1]
        if low is not None and spans and spans[-1][1] is low and verdict_on(judge, NOWHERE, low) == "stable":
            spans[-1] = (spans[-1][0], high)
        else:
            spans.append((low, high))
    return spans, judge


def _judge(scheme: Scheme, fixed: Mapping[str, Fraction], lam: Fraction) -> Judge:
    return Judge(derive(scheme, fixed, None, NOWHERE, lam))


def verdict_on(judge: Judge, p: Fraction, lam: Real) -> str:
    """The verdict at a point of a curve; where lam is irrational the interior is taken for the limit of stable ones."""
    exact = lam.rational
    if exact is not None:
        return judge.on_curve(p, exact)

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
        found, judge = line(scheme, fixed)
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
    top = found[0][1] if found and found[0][0] is None else None
    if (None if top is None else verdict_on(judge, NOWHERE, top)) != at_bound:
        raise Rejected("the verdict on the bound is not what the certificate says")
