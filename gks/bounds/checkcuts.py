"""Cuts of a certificate, held against the checker's own verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import acb, arb, fmpz_mpoly, fmpz_poly

from gks.bounds.checkballs import Open, deflated, solved
from gks.bounds.checkcells import CellCheck, Owner
from gks.bounds.checkformula import Rejected
from gks.bounds.checkline import bound_on, line, verdict_on, verify_line
from gks.bounds.checknumbers import Real, ball_of, close, near_positive, over, real_roots, univariate
from gks.bounds.checknumbers import exact as _exact
from gks.bounds.checkpoint import Judge
from gks.bounds.checkring import Unsupported, degree, enclose, parts_of, put

NEARBY = Fraction(1, 1 << 160)
"""How far beside a cut the curves are looked at, relatively: a meeting of m curves is apart by its m-th root there."""

MEETING = Fraction(1, 1 << 20)
"""Relative distance of curves so near a cut below which they are taken to meet on it."""

MEETING_RADIUS = 2.0**-30
"""Relative radius of the balls around such points; a fifth root of NEARBY is less."""

Ends = list[tuple[Real | None, Real | None]]
"""Intervals of lam."""


class CutCheck:
    """One cut: an algebraic number, and its own stable set where it has one."""

    def __init__(self, owner: Owner, entry: Mapping[str, Any]) -> None:
        self.owner = owner
        self.root = owner.root(entry["at"], str(owner.parameter))
        self.spans: list[tuple[Real | None, Real | None]] | None = None
        if entry["stable_set"] is not None:
            self.spans = owner.intervals(entry["stable_set"])
        self.at_bound: str | None = entry["at_bound"]

    def verify(self, left: CellCheck, right: CellCheck) -> None:
        """The stable set here: on a wall by the checker's own means, elsewhere by the points where curves meet."""
        wall = next((w for w in self.owner.walls if _same(univariate(w, "p"), self.root.poly)), None)
        judge, exact = left.judge, self.root.rational
        if left.changes or right.changes:
            self._changing(exact, left, right)
            return
        if self.spans is None:
            self._shared_bound(left, right, judge)
        if wall is None and self.spans is None:
            self._same_limits(left, right)
            self._points(left, judge)
        elif wall is not None and judge.loses_root(wall):
            self._undetermined(left, right)
        elif exact is not None:
            self._line(exact, left, right)
        elif not self.spans and self.at_bound is None:
            self._gaps(left, right, judge)
        elif wall is None:
            self._split(left, judge)
        else:
            raise Unsupported("a stable set on a cut at an irrational value")

    def _changing(self, exact: Fraction | None, left: CellCheck, right: CellCheck) -> None:
        """Where the scheme is another at another lam, only a rational cut is verified: by its own stable set."""
        if exact is None:
            raise Unsupported("a scheme that changes with lam, on a cut at an irrational value")
        self._line(exact, left, right)
        if self.spans is None:
            fixed = {**self.owner.fixed, str(self.owner.parameter): exact}
            if self.at_bound not in ("undecided", bound_on(line(self.owner.scheme, fixed))):
                raise Rejected(f"the verdict on the bound at {exact} is not {self.at_bound}")

    def _same_limits(self, left: CellCheck, right: CellCheck) -> None:
        """The intervals of both sides tend to the same ones, none infinite or touching: each side's formulas hold."""
        sides = [cell.limits(p, joined=False) for cell, p in zip((left, right), self._beside(), strict=True)]
        if any(cell.diverges(p) for cell, p in zip((left, right), self._beside(), strict=True)) or not _agree(*sides):
            raise Rejected(f"the stable sets beside {self.root.ball().str(10)} do not go over into each other")
        for (_, high), (low, _) in pairwise(sides[0]):
            if high is not None and low is not None and close(high, low):
                raise Rejected(f"stable intervals touch at {self.root.ball().str(10)}")

    def _shared_bound(self, left: CellCheck, right: CellCheck, judge: Judge) -> None:
        """The verdict on the bound that both sides tend to; that it is not decided says nothing, and is let be."""
        if self.at_bound == "undecided":
            return
        beside = self._beside()
        levels = [cell.first_level(p) for cell, p in zip((left, right), beside, strict=True)]
        exact = self.root.rational
        free = [each for each in levels if each is not None and not degree(each[0], "p")]
        level = free[0] if free else levels[0]
        verdict: str | None = None
        if level is not None and (exact is not None or free):
            bound = self._real_limit(*level, beside[0] if exact is None else exact)
            verdict = self._verdict(judge, bound)
        elif level is not None:
            short = self._short_limit(*level)
            if short is not None:
                verdict = self._verdict(judge, short)
            else:
                verdict = judge.at_point(lambda bits: self._ball_limit(*level, bits))
        if verdict != self.at_bound:
            raise Rejected(f"on the bound at {self.root.ball().str(10)} the scheme is {verdict}, not {self.at_bound}")

    def _real_limit(self, curve: fmpz_mpoly, level: arb, p: Fraction) -> Real:
        """The root of a curve over p that ``level``, beside p, tends to."""
        found = [
            Real(g, k + 1)
            for g, _ in over(curve, p).factor()[1]
            for k, root in enumerate(real_roots(g))
            if close(level, root)
        ]
        if len(found) != 1:
            raise Rejected("the limit of the bound at a cut is not told from its neighbours")
        return found[0]

    def _short_limit(self, curve: fmpz_mpoly, level: arb) -> Real | None:
        """The same over an irrational p, where it is a short rational number: that number is put into the curve."""
        short = _exact(level).limit_denominator(SHORTEST)
        if not close(level, ball_of(short)) or univariate(put(curve, "lam", short), "p") % self.root.poly:
            return None
        return Real(fmpz_poly([-short.numerator, short.denominator]), 1)

    def _ball_limit(self, curve: fmpz_mpoly, level: arb, bits: int) -> dict[str, acb]:
        """The same over this cut, in balls."""
        p = acb(self.root.ball(bits))
        parts = [enclose(c, {"p": p}) for c in parts_of(curve, "lam")]
        try:
            roots = solved(parts)
        except Open:
            roots = [root for found in deflated(parts) for root in found]
        near = [root for root in roots if root.imag.contains(0) and close(level, root.real)]
        if len(near) != 1:
            raise Open
        return {"p": p, "lam": acb(near[0].real)}

    def _undetermined(self, left: CellCheck, right: CellCheck) -> None:
        """The next time level is not determined here: nothing is stable."""
        if self.spans is None:
            for cell, p in zip((left, right), self._beside(), strict=True):
                if any(cell.stated(p, lam) for lam in cell.gaps(p)):
                    raise Rejected("a cut on which the next time level is not determined is said to be stable")
        elif self.spans or self.at_bound is not None:
            raise Rejected("a cut on which the next time level is not determined has a stable set")

    def _line(self, exact: Fraction, left: CellCheck, right: CellCheck) -> None:
        fixed = {**self.owner.fixed, str(self.owner.parameter): exact}
        if self.spans is not None:
            verify_line(self.owner.scheme, fixed, self.spans, self.at_bound)
            return
        found = line(self.owner.scheme, fixed).spans
        for cell, p in zip((left, right), self._beside(), strict=True):
            self._limits(cell, p, found)

    def _gaps(self, left: CellCheck, right: CellCheck, judge: Judge) -> None:
        """Between the curves the verdict is what is said on the cut: what both sides say, or that nothing is stable."""
        beside = self._beside()
        levels = [level for level, _ in left.levels(beside[0])]
        apart = [Fraction(0), *(_exact(level) for level in levels)]
        gaps = left.gaps(beside[0])
        for lam, (low, high) in zip(gaps, pairwise([*apart, apart[-1] + 1]), strict=True):
            if high - low <= high * MEETING:
                continue  # curves that meet on the cut leave nothing between them there
            said = {left.stated(beside[0], lam), right.stated(beside[1], lam)} if self.spans is None else {False}
            if said != {judge.stable_near(left.sample, lam, lambda bits: acb(self.root.ball(bits)))}:
                raise Rejected(f"the verdict at a cut, lam = {lam}, is not what the certificate says")

    def _beside(self) -> tuple[Fraction, Fraction]:
        here = self.root.nearest
        step = NEARBY * max(abs(here), Fraction(1))
        return here - step, here + step

    def _limits(self, cell: CellCheck, p: Fraction, found: Sequence[tuple[Real | None, Real | None]]) -> None:
        """The stable set on a wall is the limit of the stable sets beside it."""
        here = [tuple(None if end is None else end.ball() for end in span) for span in found]
        if not _agree(cell.limits(p), here):
            raise Rejected(f"the stable set on the wall at {p} is not that of its neighbours")

    def _split(self, left: CellCheck, judge: Judge) -> None:
        """The limit of the stable set beside, split by single values of lam that are not stable."""
        assert self.spans is not None
        splits: list[Real] = []
        whole: Ends = []
        for low, high in self.spans:
            if whole and low is not None and whole[-1][1] is not None and _is(low, whole[-1][1]):
                splits.append(low)
                whole[-1] = (whole[-1][0], high)
            else:
                whole.append((low, high))
        limits = [tuple(None if end is None else end.ball() for end in span) for span in whole]
        if not _agree(left.limits(self._beside()[0]), limits):
            raise Rejected(f"the stable set at {self.root.ball().str(10)} is not that of its neighbours")
        for each in splits:
            if self._verdict(judge, each) == "stable":
                raise Rejected(f"lam = {each.ball().str(10)} is stable at {self.root.ball().str(10)}")
        self._points(left, judge, [each.ball() for each in splits])
        top = self.spans[0][1] if self.spans and self.spans[0][0] is None else None
        if (None if top is None else self._verdict(judge, top)) != self.at_bound:
            raise Rejected(f"the verdict on the bound at {self.root.ball().str(10)} is not {self.at_bound}")

    def _verdict(self, judge: Judge, lam: Real) -> str:
        """At a point over this cut."""
        p, exact = self.root.rational, lam.rational
        if p is not None:
            return verdict_on(judge, p, lam)
        return judge.at_point(
            lambda bits: {"p": acb(self.root.ball(bits)), "lam": acb(lam.ball(bits))},
            None if exact is None else {"lam": exact},
        )

    def _points(self, left: CellCheck, judge: Judge, known: Sequence[arb] = ()) -> None:
        """No curve point over the cut, inside the stable set, carries a mode: curves may meet or touch here.

        The points are those over a rational value so near that what meets at the cut is together; balls around them
        hold the true ones.
        """
        p = self._beside()[0]
        for curve, level in [(c, r) for c in self.owner.curves for r in near_positive(c, p)]:
            radius = abs(level) * 2.0**-20
            below, above = (_exact(level.mid() + sign * radius) for sign in (-1, 1))
            if any(close(each, level) for each in known):
                continue
            if below > 0 and left.stated(p, below) and left.stated(p, above):
                self._point(judge, curve, level)

    def _point(self, judge: Judge, curve: fmpz_mpoly, level: arb) -> None:
        exact = self.root.rational
        near = acb(arb(level.mid(), abs(float(level.mid())) * MEETING_RADIUS))
        if not degree(curve, "p"):
            verdict = self._verdict(judge, self._real_limit(curve, level, Fraction(0)))
        else:
            verdict = judge.at_point(
                lambda bits: {"p": acb(self.root.ball(bits)), "lam": near}, None if exact is None else {"p": exact}
            )
        if verdict != "stable":
            raise Rejected(f"a mode on the circle at {self.owner.parameter} = {self.root.ball().str(10)} is not stated")


SHORTEST = 1000
"""Denominator up to which the bound on a cut is tried as a rational number."""


def _is(one: Real, other: Real) -> bool:
    return one.poly == other.poly and one.place == other.place


def _agree(beside: Sequence[tuple[arb | None, ...]], here: Sequence[tuple[arb | None, ...]]) -> bool:
    """Whether intervals beside a cut tend to those on it."""
    return len(beside) == len(here) and all(
        (a is None) == (b is None) and (a is None or b is None or close(a, b))
        for one, other in zip(beside, here, strict=True)
        for a, b in zip(one, other, strict=True)
    )


def _same(one: fmpz_poly, other: fmpz_poly) -> bool:
    return one in (other, -other)
