"""Cells and cuts of a certificate, held against the checker's own verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any, Protocol

from flint import acb, arb, fmpz_mpoly, fmpz_poly

from gks.bounds.checkformula import Rejected
from gks.bounds.checkline import line, verdict_on, verify_line
from gks.bounds.checknumbers import (
    Real,
    ball_of,
    close,
    fraction,
    gaps_between,
    near_positive,
    positive,
    real_root_of,
    simplest,
    univariate,
)
from gks.bounds.checknumbers import exact as _exact
from gks.bounds.checkpoint import Judge
from gks.bounds.checkring import Unsupported
from gks.scheme.model import Scheme

NEARBY = Fraction(1, 1 << 160)
"""How far beside a cut the curves are looked at, relatively: a meeting of m curves is apart by its m-th root there."""

MEETING = Fraction(1, 1 << 20)
"""Relative distance of curves so near a cut below which they are taken to meet on it."""

MEETING_RADIUS = 2.0**-30
"""Relative radius of the balls around such points; a fifth root of NEARBY is less."""


class Owner(Protocol):
    """What cells and cuts ask of the certificate they belong to."""

    scheme: Scheme
    parameter: str | None
    fixed: dict[str, Fraction]
    domain: tuple[Fraction | None, Fraction | None]
    curves: list[fmpz_mpoly]
    walls: list[fmpz_mpoly]
    cells: list[CellCheck]
    cuts: list[CutCheck]

    def in_domain(self, value: arb) -> bool: ...
    def root(self, entry: Sequence[Any], name: str) -> Real: ...
    def intervals(self, entries: Sequence[Any]) -> list[tuple[Real | None, Real | None]]: ...


class CellCheck:
    """One cell: its sample, and what is said to be stable over it."""

    def __init__(self, owner: Owner, index: int, entry: Mapping[str, Any]) -> None:
        self.owner, self.index = owner, index
        self.sample = fraction(entry["sample"])
        self.spans: list[tuple[tuple[int, int] | None, tuple[int, int] | None]] = [
            (_branch(low), _branch(high)) for low, high in entry["stable_set"]
        ]
        self.at_bound: str | None = entry["at_bound"]
        self.judge: Judge | None = None

    @property
    def ends(self) -> tuple[Real | None, Real | None]:
        cuts = self.owner.cuts
        return (cuts[self.index - 1].root if self.index else None), (
            cuts[self.index].root if self.index < len(cuts) else None
        )

    def inside(self) -> None:
        """The sample is the rational of least denominator in the cell."""
        low, high = self.ends
        here = ball_of(self.sample)
        if not self.owner.in_domain(here) or (low and not here > low.ball()) or (high and not here < high.ball()):
            raise Rejected(f"the sample {self.sample} is not in its cell")
        bottom, top = self.owner.domain
        ends = (low.nearest if low else bottom), (high.nearest if high else top)
        if self.sample != simplest(*ends):
            raise Rejected(f"the sample {self.sample} is not the simplest in its cell")

    def value(self, branch: tuple[int, int], p: Fraction) -> arb:
        return positive(self.owner.curves[branch[0]], p)[branch[1] - 1]

    def levels(self, p: Fraction) -> list[tuple[arb, int]]:
        """All positive lam on curves over p, ascending, with the curve."""
        found = [(r, k) for k, curve in enumerate(self.owner.curves) for r in positive(curve, p)]
        found.sort(key=lambda each: _exact(each[0]))
        for (one, _), (other, _) in pairwise(found):
            if not one < other:
                raise Rejected(f"two curves meet at the sample {p}")
        return found

    def gaps(self, p: Fraction) -> list[Fraction]:
        return gaps_between([level for level, _ in self.levels(p)])

    def stated(self, p: Fraction, lam: Fraction) -> bool:
        """What the certificate says about a point on no curve."""
        here = ball_of(lam)
        return any(
            (low is None or self.value(low, p) < here) and (high is None or here < self.value(high, p))
            for low, high in self.spans
        )

    def stable_sample(self) -> Fraction:
        """A lam that is said to be stable, where counts of decaying roots are meant to be taken; else a small one."""
        for lam in self.gaps(self.sample):
            if self.stated(self.sample, lam):
                return lam
        return self.gaps(self.sample)[0]

    def verdicts(self) -> None:
        judge = self.judge
        assert judge is not None
        p = self.sample
        levels, gaps = self.levels(p), self.gaps(p)
        said = [self.stated(p, lam) for lam in gaps]
        for lam, stable in zip(gaps, said, strict=True):
            if judge.stable(p, lam) is not stable:
                raise Rejected(
                    f"at {self.owner.parameter} = {p}, lam = {lam} the verdict is not what the certificate says"
                )
        self.structure([(level, stable) for (level, _), stable in zip(levels, pairwise(said), strict=True)])
        for k, ((_, curve), (below, above)) in enumerate(zip(levels, pairwise(said), strict=True)):
            if below and above:
                stands = any(end == (curve, self.place(curve, k)) for span in self.spans for end in span)
                verdict = verdict_on(judge, p, real_root_of(self.owner.curves[curve], p, self.place(curve, k)))
                if (verdict == "stable") == stands:
                    raise Rejected(f"at {self.owner.parameter} = {p} a curve inside the stable set is not as stated")
        self.bound(judge)

    def structure(self, levels: Sequence[tuple[arb, tuple[bool, bool]]]) -> None:
        """Every end of a stated interval is a level at which the statement changes, or splits."""
        ends = [self.value(end, self.sample) for span in self.spans for end in span if end is not None]
        flat = [
            (
                None if low is None else self.value(low, self.sample),
                None if high is None else self.value(high, self.sample),
            )
            for low, high in self.spans
        ]
        for k, (low, high) in enumerate(flat):
            following = flat[k + 1] if k + 1 < len(flat) else None
            if low is not None and high is not None and not low < high:
                raise Rejected("an interval of the stable set is empty")
            if following is not None and (high is None or following[0] is None or following[0] < high):
                raise Rejected("the intervals of the stable set are not in order")
        for end in ends:
            if not any(level.overlaps(end) for level, _ in levels):
                raise Rejected("an end of the stable set is on no curve")

    def place(self, curve: int, level: int) -> int:
        return 1 + sum(1 for _, k in self.levels(self.sample)[:level] if k == curve)

    def bound(self, judge: Judge) -> None:
        """The verdict on the bound."""
        top = self.spans[0][1] if self.spans and self.spans[0][0] is None else None
        if (top is None) != (self.at_bound is None):
            raise Rejected("a verdict on the bound without a bound, or a bound without one")
        if top is not None:
            p = self.sample
            curve, place = self.owner.curves[top[0]], top[1]
            verdict = verdict_on(judge, p, real_root_of(curve, p, place))
            if verdict != self.at_bound:
                raise Rejected(
                    f"on the bound at {self.owner.parameter} = {p} the scheme is {verdict}, not {self.at_bound}"
                )


def _branch(entry: Any) -> tuple[int, int] | None:
    if entry is None:
        return None
    curve, place = entry
    if not (isinstance(curve, int) and isinstance(place, int) and curve >= 0 and place >= 1):
        raise Rejected(f"{entry!r} names no root of a curve")
    return curve, place


class CutCheck:
    """One cut: an algebraic number, and its own stable set where it has one."""

    def __init__(self, owner: Owner, entry: Mapping[str, Any]) -> None:
        self.owner = owner
        self.root = owner.root(entry["at"], str(owner.parameter))
        self.spans: list[tuple[Real | None, Real | None]] | None = None
        if entry["stable_set"] is not None:
            self.spans = owner.intervals(entry["stable_set"])
        self.at_bound: str | None = entry["at_bound"]
        if self.spans is None and self.at_bound is not None:
            raise Rejected("a verdict on the bound of a cut that has no bound of its own")

    def verify(self, left: CellCheck, right: CellCheck) -> None:
        """The stable set here: on a wall by the checker's own means, elsewhere by the points where curves meet."""
        wall = next((w for w in self.owner.walls if _same(univariate(w, "p"), self.root.poly)), None)
        judge = left.judge
        assert judge is not None
        exact = self.root.rational
        if wall is None and self.spans is None:
            self._points(left, judge)
        elif wall is not None and judge.loses_root(wall):
            self._undetermined(left, right)
        elif exact is not None:
            self._line(exact, left, right)
        elif not self.spans and self.at_bound is None:
            self._gaps(left, right, judge)
        else:
            raise Unsupported("a stable set on a cut at an irrational value")

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
        found = line(self.owner.scheme, fixed)[0]
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
        beside = [tuple(None if end is None else cell.value(end, p) for end in span) for span in cell.spans]
        here = [tuple(None if end is None else end.ball() for end in span) for span in found]
        if len(beside) != len(here) or not all(
            (a is None) == (b is None) and (a is None or b is None or close(a, b))
            for one, other in zip(beside, here, strict=True)
            for a, b in zip(one, other, strict=True)
        ):
            raise Rejected(f"the stable set on the wall at {p} is not that of its neighbours")

    def _points(self, left: CellCheck, judge: Judge) -> None:
        """No curve point over the cut, inside the stable set, carries a mode: curves may meet or touch here.

        The points are those over a rational value so near that what meets at the cut is together; balls around them
        hold the true ones.
        """
        p = self._beside()[0]
        for level in (r for curve in self.owner.curves for r in near_positive(curve, p)):
            radius = abs(level) * 2.0**-20
            below, above = (_exact(level.mid() + sign * radius) for sign in (-1, 1))
            if below > 0 and left.stated(p, below) and left.stated(p, above):
                self._point(judge, level)

    def _point(self, judge: Judge, level: arb) -> None:
        root = self.root

        def ends(bits: int) -> dict[str, acb]:
            return {"p": acb(root.ball(bits)), "lam": acb(arb(level.mid(), abs(float(level.mid())) * MEETING_RADIUS))}

        if judge.at_point(ends) != "stable":
            raise Rejected(f"a mode on the circle at {self.owner.parameter} = {root.ball().str(10)} is not stated")


def _same(one: fmpz_poly, other: fmpz_poly) -> bool:
    return one in (other, -other)
