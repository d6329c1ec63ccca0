"""Cells of a certificate, held against the checker's own verdicts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Protocol

from flint import arb, fmpz_mpoly

from gks.bounds.checkformula import Rejected
from gks.bounds.checkjudges import Judges
from gks.bounds.checkline import verdict_on
from gks.bounds.checknumbers import (
    Real,
    ball_of,
    close,
    fraction,
    gaps_between,
    positive,
    real_root_of,
    simplest,
)
from gks.bounds.checknumbers import exact as _exact
from gks.bounds.checkpoint import Judge, stable_between
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    from gks.bounds.checkcuts import CutCheck

VANISHING = 2.0**-30
"""Bounds beside a cut below this tend to 0 there, above its inverse to infinity: NEARBY's fifth root is less."""


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
        self.gap_judges: list[Judge | None] = []

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

    def diverges(self, p: Fraction) -> bool:
        """Whether an end of a stated interval tends to infinity, seen over ``p`` beside a cut."""
        return any(end is not None and self.value(end, p) > 1 / VANISHING for span in self.spans for end in span)

    def limits(self, p: Fraction, *, joined: bool = True) -> list[tuple[arb | None, arb | None]]:
        """The stated intervals over ``p`` beside a cut as they are on it.

        Those that shrink to a point or go to infinity are left out, those that come to touch are one if ``joined``,
        ends that tend to 0 or infinity are there.
        """
        found: list[tuple[arb | None, arb | None]] = []
        for span in self.spans:
            low, high = (None if end is None else self.value(end, p) for end in span)
            low = None if low is None or low < VANISHING else low
            if (low is not None and low > 1 / VANISHING) or (high is not None and high < VANISHING):
                continue
            high = None if high is None or high > 1 / VANISHING else high
            if low is not None and high is not None and close(low, high):
                continue
            last = found[-1][1] if found else None
            if joined and last is not None and low is not None and close(last, low):
                found[-1] = (found[-1][0], high)
            else:
                found.append((low, high))
        return found

    def first_level(self, p: Fraction) -> tuple[fmpz_mpoly, arb] | None:
        """The curve and the place of the bound over ``p`` beside a cut; None where it tends to 0 or infinity there."""
        for low, high in self.spans:
            if low is not None and self.value(low, p) > VANISHING:
                return None
            if high is None:
                return None
            level = self.value(high, p)
            if level > VANISHING:
                return (self.owner.curves[high[0]], level) if level < 1 / VANISHING else None
        return None

    def gaps(self, p: Fraction) -> list[Fraction]:
        return gaps_between([level for level, _ in self.levels(p)])

    def stated(self, p: Fraction, lam: Fraction) -> bool:
        """What the certificate says about a point on no curve."""
        here = ball_of(lam)
        return any(
            (low is None or self.value(low, p) < here) and (high is None or here < self.value(high, p))
            for low, high in self.spans
        )

    def call(self, judges: Judges) -> None:
        """A judge for every gap between the curves over the sample; None where the interior is not stable there."""
        self.gap_judges = [judges.at(self.sample, lam) for lam in self.gaps(self.sample)]
        if not any(self.gap_judges):
            self.fallback = judges.somewhere(self.sample, self.gaps(self.sample)[0])

    @property
    def judge(self) -> Judge:
        """The one judge of this cell, of the lowest gap that has one where there are several."""
        return next((judge for judge in self.gap_judges if judge is not None), None) or self.fallback

    @property
    def changes(self) -> bool:
        """Whether the scheme is another at another lam."""
        return len({id(judge) for judge in self.gap_judges if judge is not None}) > 1

    def verdicts(self) -> None:
        p = self.sample
        levels, gaps = self.levels(p), self.gaps(p)
        said = [self.stated(p, lam) for lam in gaps]
        bottoms = [Fraction(0), *(_exact(level) for level, _ in levels)]
        for low, lam, stable, judge in zip(bottoms, gaps, said, self.gap_judges, strict=True):
            if (judge is not None and stable_between(judge, p, low, lam)) is not stable:
                raise Rejected(
                    f"at {self.owner.parameter} = {p}, lam = {lam} the verdict is not what the certificate says"
                )
        self.structure([(level, stable) for (level, _), stable in zip(levels, pairwise(said), strict=True)])
        for k, ((_, curve), (below, above)) in enumerate(zip(levels, pairwise(said), strict=True)):
            judge = self.gap_judges[k]
            if below and above and judge is not None:
                stands = any(end == (curve, self.place(curve, k)) for span in self.spans for end in span)
                verdict = verdict_on(judge, p, real_root_of(self.owner.curves[curve], p, self.place(curve, k)))
                if (verdict == "stable") == stands:
                    raise Rejected(f"at {self.owner.parameter} = {p} a curve inside the stable set is not as stated")
        self.bound()

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

    def bound(self) -> None:
        """The verdict on the bound."""
        top = self.spans[0][1] if self.spans and self.spans[0][0] is None else None
        if (top is None) != (self.at_bound is None):
            raise Rejected("a verdict on the bound without a bound, or a bound without one")
        if top is not None:
            p = self.sample
            curve, place = self.owner.curves[top[0]], top[1]
            level = real_root_of(curve, p, place)
            below = self.gap_judges[sum(1 for each, _ in self.levels(p) if each < level.ball())]
            verdict = None if below is None else verdict_on(below, p, level)
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
