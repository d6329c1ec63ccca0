"""Pockets round glancing points: where the group velocity of a wave on the unit circle is zero.

There a decaying spatial root meets one that does not, and Delta has a branch point; energy-conserving walls and
interfaces often have a generalized eigenvalue at just that point. A walk round it (`gks.modes.kreisspairs`) counts the
zeros in a neighbourhood; exact algebra says to what order, at least, Delta vanishes at the point itself. Where the two
agree there is nothing else in the neighbourhood.

The glancing points are roots of the discriminants of the symbols. That exactly one of them, simple, lies in the
neighbourhood, and the same for all families whose roots meet in it, is what makes the walk's count one of zeros.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import inf

import numpy as np
from flint import acb, ctx, fmpz_mpoly

from gks.modes.admissible import Candidate
from gks.modes.algebraic import GUARD_BITS, START_BITS, Position
from gks.modes.candidates import candidates_of
from gks.modes.cauchy import reciprocal_in
from gks.modes.chart import Chart
from gks.modes.coefficients import value_ball
from gks.modes.discs import Discs
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import VanishesIdentically
from gks.modes.judgement import judged_exactly
from gks.modes.kreiss import NormalModeProblem
from gks.modes.kreisspairs import PairedRegion, paired_region
from gks.modes.polynomial import Factor
from gks.modes.reversal import time_reversed
from gks.modes.tables import DiscTables
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode
from gks.modes.winding import FEW_STEPS, full_circle, walk

WIDEST = 16
"""Degree of a symbol in x up to which its discriminant is taken: tenths of a second."""
SAME = 2.0**-40
"""Distance up to which glancing points of two families are looked at as one; whether they are is decided exactly."""
CROWDED = 16.0
"""How much smaller the next pocket is that is tried where one holds another zero, which lies near its boundary for all
that is known: its own pocket needs a fraction of its distance."""
ROOM = 1 + 2.0**-4 + 0.125
"""How much wider than a pocket its region is: the discs along its boundary lie in it."""


@dataclass(frozen=True, slots=True)
class GlancingPocket:
    """A disc round a glancing point with ``count`` zeros of Delta, all of them at the point; the mode that they are."""

    centre: complex
    radius: float
    count: int
    candidate: Candidate
    mode: Mode | None


@dataclass(frozen=True, slots=True)
class _Meeting:
    """A root of a symbol's discriminant, its multiplicity there, and a ball of its place in the chart."""

    candidate: Candidate
    multiplicity: int
    w: acb


class GlancingPoints:
    """The glancing points of one problem; discriminants are taken and modes judged when they are asked for."""

    def __init__(self, problem: NormalModeProblem, tables: DiscTables, chart: Chart) -> None:
        self._problem, self._tables, self._chart = problem, tables, chart
        self._meetings: dict[int, list[_Meeting] | None] = {}
        self._judged: dict[Candidate, tuple[Mode, int] | None] = {}

    def of_conservative(self) -> list[complex]:
        """Those of the symbols that neither damp nor amplify any wave, as `near` has them: such a one nearly always has
        some, and a walk along the circle takes a thousand steps to find out.
        """
        families = [k for k, each in enumerate(self._problem.families) if self._conserves(each.polynomial)]
        return self._near(families, 0j, 2.0)

    def _conserves(self, symbol: fmpz_mpoly) -> bool:
        """Whether z -> 1/conj(z), x -> 1/conj(x) takes the symbol to itself: s -> -conj(s) does it where s is the
        variable.
        """
        return time_reversed(self._problem, reciprocal_in(symbol, ("x",))) in (symbol, -symbol)

    def near(self, place: complex, reach: float) -> list[complex]:
        """Places of the chart in the upper half-plane where glancing points lie, at most ``reach`` from a point."""
        return self._near(range(len(self._problem.families)), place, reach)

    def _near(self, families: Iterable[int], place: complex, reach: float) -> list[complex]:
        found: list[complex] = []
        for k in families:
            for w in (complex(m.w) for m in self._meetings_of(k) or () if m.candidate.position is Position.ON):
                if w.imag > 0 and abs(w - place) <= reach and all(abs(w - other) > SAME for other in found):
                    found.append(w)
        return found

    def pocket(self, centre: complex, radii: Iterable[float], smallest: float) -> GlancingPocket | None:
        """The first pocket round a glancing point in which all zeros are at that point.

        One that leaves out a zero of a larger pocket leaves room for a pocket of that zero's own.
        """
        crowded = inf
        for radius in radii:
            if radius > crowded / CROWDED:
                continue
            disc = Discs(np.array([centre]), np.array([ROOM * radius]))
            region = paired_region(self._tables, self._chart, disc, centre / abs(centre) * (1 - radius / 2))
            candidate = None if region is None else self._only(region, centre, radius)
            if region is None or candidate is None:
                continue
            around = walk(self._tables, self._chart, full_circle(centre, radius), smallest * radius, region, FEW_STEPS)
            if around.stuck:
                continue
            count = round(around.zeros)
            judged = self._judgement(candidate) if count else None
            if not count:
                return GlancingPocket(centre, radius, 0, candidate, None)
            if judged is not None and judged[1] == count:
                return GlancingPocket(centre, radius, count, candidate, replace(judged[0], multiplicity=count))
            crowded = min(crowded, radius)
        return None

    def _only(self, region: PairedRegion, centre: complex, radius: float) -> Candidate | None:
        """The one point of the unit circle at which all pairs of the region meet; None where that is not known."""
        found: list[Candidate] = []
        for k in region.paired:
            meetings = self._meetings_of(k)
            if meetings is None:
                return None
            with ctx.workprec(START_BITS + GUARD_BITS):
                near = [m for m in meetings if not abs(m.w - acb(centre)) > ROOM * radius]
            if len(near) != 1 or near[0].multiplicity != 1 or near[0].candidate.images != 1:
                return None
            found.append(near[0].candidate)
        first = found[0]
        same = all(other.sigma == first.sigma and other.z == first.z for other in found)
        return first if same and first.position is Position.ON else None

    def _meetings_of(self, family: int) -> list[_Meeting] | None:
        if family not in self._meetings:
            self._meetings[family] = self._all_meetings(family)
        return self._meetings[family]

    def _all_meetings(self, family: int) -> list[_Meeting] | None:
        polynomial = self._problem.families[family].polynomial
        degree = int(polynomial.degrees()[polynomial.context().variable_to_index("x")])
        if self._problem.coefficients.generators or degree > WIDEST:
            return None
        discriminant = polynomial.discriminant("x")
        if discriminant.is_zero():
            return None
        meetings = []
        try:
            for factor, multiplicity in irreducible_factors(discriminant):
                for candidate in candidates_of(self._problem, Factor(factor, 1)):
                    meetings.append(_Meeting(candidate, multiplicity, self._place(candidate)))
        except (Undecided, VanishesIdentically):
            return None
        return meetings

    def _place(self, candidate: Candidate) -> acb:
        with ctx.workprec(START_BITS + GUARD_BITS):
            if candidate.z is not None:
                return 1 / candidate.z.ball()
            lam = self._problem.coefficients.values[self._problem.resolvent.cfl]
            mu = candidate.sigma.ball() * value_ball(lam, START_BITS)
            return (1 - mu) / (1 + mu)

    def _judgement(self, candidate: Candidate) -> tuple[Mode, int] | None:
        if candidate not in self._judged:
            try:
                self._judged[candidate] = judged_exactly(self._problem, candidate)
            except Undecided:
                self._judged[candidate] = None
        return self._judged[candidate]
