"""The parameter axis cut into cells in which the stable set of a scheme has one description.

The boundary curves of ``boundary`` are, over an open interval of p in which none of them meets another or itself, lam
= 0 or lam = infinity, graphs of continuous functions that keep their order: the k-th positive root in lam. Between
neighbouring graphs the verdict is constant. So one exact stable set at a rational p describes the whole cell, each of
its ends being the k-th positive root of one curve.

*On a cut* p0 that no curve contains, every (p0, lam) off the curves has a neighbourhood of one verdict, so that the
stable set is the limit of those of either side, up to finitely many lam. These are the points where curves meet; only a
meeting point between two stable stretches is of interest, and there an exact verdict decides. On a wall (a curve
p = p0) nothing follows from the sides: an exact stable set decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise

from flint import ctx, fmpz_mpoly, fmpz_poly

from gks.bounds.boundary import Boundary, boundary, curve_at
from gks.bounds.cfl import StableSet, stable_set
from gks.bounds.clearpoint import Eliminated, clear_at, decays_at, eliminated
from gks.bounds.criticality import (
    Critical,
    Report,
    ascending_roots,
    between,
    critical_parameters,
    distinct,
    gates,
    hull,
    key_of,
    shown,
)
from gks.bounds.meeting import meeting_points
from gks.bounds.pointverdict import NotProved, interior_holds, verdict_at
from gks.bounds.region import Branch, Cell, Cut, Decomposition, End, Span, split_at, value_of
from gks.bounds.signs import interior_sets
from gks.errors import NotAnalysable, ParameterError, SchemeError
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root, isolated_roots, primitive
from gks.modes.cauchy import degree_in
from gks.modes.fibre import at_balls, fibre, specialise, univariate
from gks.modes.kreiss import normal_mode_problem
from gks.modes.unimodular import by_real_part, rational_ends
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme

MEETING_BITS = 1 << 13
"""Precision at which telling a meeting point from its neighbours is given up."""

SAMPLES = 8
"""Values of the parameter at which curves are tried, before it is said why they can't be had."""

WIDEST_FIELD = 16
"""Degree of the numbers p and lam together up to which an exact verdict on a cut is a matter of seconds."""


def decompose(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    parameter: str,
    low: Fraction | None,
    high: Fraction | None,
    report: Report,
) -> Decomposition:
    """The cells of ``parameter`` over (low, high) (None: infinite). Raises NotProved, and InputError as the analyses
    do.
    """
    return _Decomposer(scheme, values, parameter, low, high, report).run()


Kind = tuple[tuple[str, int], ...]
"""The symbols of a scheme's interior, each with the number of its decaying roots."""


class _OtherScheme(Exception):
    """At (p, lam) the signs of wave speeds, or the numbers of decaying roots, are others than the curves are for."""

    def __init__(self, p: Fraction, lam: Fraction) -> None:
        super().__init__(p, lam)
        self.p, self.lam = p, lam


class _Decomposer:
    def __init__(
        self,
        scheme: Scheme,
        values: Mapping[str, Fraction],
        parameter: str,
        low: Fraction | None,
        high: Fraction | None,
        report: Report,
    ) -> None:
        self.scheme, self.parameter, self.report = scheme, parameter, report
        self.low = None if low is None else Root.of(low)
        self.high = None if high is None else Root.of(high)
        self.values = {**values, scheme.cfl: values.get(scheme.cfl, Fraction(1))}
        self.boundary = Boundary((), ())
        self.kinds: set[Kind] = set()
        self.places: dict[Fraction, Fraction] = {}
        self.eliminations: dict[Fraction, Eliminated | None] = {}

    def run(self) -> Decomposition:
        self.report("boundary curves")
        self.boundary = self._first_boundary()
        while True:
            try:
                return self._decomposed()
            except _OtherScheme as other:
                self._extend(other.p, other.lam)

    def _decomposed(self) -> Decomposition:
        """Over the curves known so far. Raises _OtherScheme where they are not all."""
        critical = critical_parameters(self.boundary, self.report)
        roots = self._inside(list(critical))
        places = by_real_part([root for root, _ in roots])
        cause = {id(root): critical[key] for root, key in roots}
        cells = []
        for k, (low, high) in enumerate(pairwise([self.low, *places, self.high])):
            self.report(f"cell {k + 1} of {len(places) + 1}")
            cells.append(self._cell(low, high))
        cuts = []
        for k, place in enumerate(places):
            self.report(f"cut {k + 1} of {len(places)}")
            cuts.append(self._cut(place, cause[id(place)], cells[k], cells[k + 1]))
        return Decomposition(self.boundary, tuple(cells), tuple(cuts))

    def at(self, p: Fraction | Root) -> dict[str, Fraction | Root]:
        exact = p.rational if isinstance(p, Root) else p
        return {**self.values, self.parameter: p if exact is None else exact}

    # Curves ---------------------------------------------------------------------------------------------------------

    def _first_boundary(self) -> Boundary:
        """At a sample where no wave speed vanishes: they do so at few values of the parameter."""
        p = between(self.low, self.high)
        for _ in range(SAMPLES - 1):
            try:
                return self._boundary(p, self._stable_places(p)[0])
            except (NotAnalysable, ParameterError):
                p = between(Root.of(p), self.high)
        return self._boundary(p, self._stable_places(p)[0])

    def _boundary(self, p: Fraction, lam: Fraction) -> Boundary:
        found = boundary(self.scheme, {**self.values, self.parameter: p, self.scheme.cfl: lam}, self.parameter)
        self.kinds.add(self._kind(p, lam))
        return found

    def _extend(self, p: Fraction, lam: Fraction) -> None:
        """The curves for the signs and counts at a point besides those known."""
        found, other = self.boundary, self._boundary(p, lam)
        known = {str(each) for each in (*found.curves, *found.walls)}
        curves = [curve for curve in other.curves if str(curve) not in known]
        walls = [wall for wall in other.walls if str(wall) not in known]
        self.boundary = Boundary((*found.curves, *curves), (*found.walls, *walls))

    def _kind(self, p: Fraction, lam: Fraction) -> Kind:
        """What the curves depend on, besides the formulas: the stencils that the signs of speeds choose, the counts."""
        values = {**self.values, self.parameter: p, self.scheme.cfl: lam}
        problem = normal_mode_problem(self.scheme, values, (self.parameter, self.scheme.cfl))
        return tuple((str(family.polynomial), family.decaying) for family in problem.families)

    def _known_kinds(self, p: Fraction) -> None:
        """Raises _OtherScheme for a Cauchy-stable piece of the line over p whose curves are not known."""
        places = self._stable_places(p)
        for lam in places:
            if self._kind(p, lam) not in self.kinds:
                raise _OtherScheme(p, lam)
        self.places[p] = places[0]

    def _stable_places(self, p: Fraction) -> list[Fraction]:
        """A lam in every Cauchy-stable piece of the line over p; where there is none, any."""
        interior, signs = interior_sets(self.scheme, {**self.values, self.parameter: p})
        ends = [end for each in interior for i in each.intervals for end in (i.low, i.high)]
        cuts = distinct(iter([*signs, *(end for end in ends if end is not None and not end.is_zero)]))
        places = gates(by_real_part(cuts))
        return [lam for lam in places if all(each.contains(Root.of(lam)) for each in interior)] or places[:1]

    def _inside(self, keys: Sequence[tuple[int, ...]]) -> list[tuple[Root, tuple[int, ...]]]:
        """The real roots of the polynomials that lie in the domain."""
        found = []
        for key in keys:
            for root in isolated_roots(fmpz_poly(list(key)), is_square_free=True):
                if root.is_real and (self.low is None or self.low < root) and (self.high is None or root < self.high):
                    found.append((root, key))
        return found

    # Cells ----------------------------------------------------------------------------------------------------------

    def _cell(self, low: Root | None, high: Root | None) -> Cell:
        sample = between(low, high)
        self._known_kinds(sample)
        found = self._stable_set(sample)
        spans = tuple(Span(self._branch(i.low, sample), self._branch(i.high, sample)) for i in found.intervals)
        at_bound = self._at_bound(sample, sample, found.lam_max, ends_stability=found.limited_by == "closure")
        return Cell(low, high, sample, spans, found.limited_by, at_bound)

    def _stable_set(self, p: Fraction | Root) -> StableSet:
        found = stable_set(self.scheme, self.at(p))  # type: ignore[arg-type]
        if found.undecided is not None:
            raise NotProved(f"at {self.parameter} = {shown(p)} {found.undecided}")
        return found

    def _branch(self, end: Root | None, p: Fraction) -> Branch | None:
        if end is None:
            return None
        mine = end.minimal
        for index, curve in enumerate(self.boundary.curves):
            poly = curve_at(curve, p)
            if not poly % mine.poly:
                return Branch(index, 1 + ascending_roots(poly).index(mine))
        place = f"{self.parameter} = {shown(p)}"
        raise NotProved(f"an end of the stable set at {place} lies on none of the boundary curves")

    def _at_bound(
        self, sample: Fraction, p: Fraction | Root, bound: Root | None, *, ends_stability: bool
    ) -> Verdict | None:
        """The verdict on the bound over p, in a cell or at an end of the cell with that sample.

        Modes with abs(z) >= 1 are a closed set where the interior is Cauchy-stable: so one is here if the bound is
        where they begin (``ends_stability``), and none grows, as none does below. It is neutral if it decays strictly.
        """
        if bound is None or bound.is_zero:
            return None
        if ends_stability:
            here = p if isinstance(p, Root) else Root.of(p)
            found = self._elimination(sample)
            decays = found is not None and decays_at(found, {self.parameter: here, self.scheme.cfl: bound})
            if decays and interior_holds(self.scheme, {**self.at(p), self.scheme.cfl: bound}):
                return Verdict.NEUTRAL
        if isinstance(p, Root) and p.minimal.poly.degree() * bound.minimal.poly.degree() > WIDEST_FIELD:
            return Verdict.UNDECIDED
        return self.verdict(p, bound)

    def verdict(self, p: Fraction | Root, lam: Root) -> Verdict:
        return verdict_at(self.scheme, {**self.at(p), self.scheme.cfl: lam})

    def contains(self, cell: Cell, lam: Fraction, p: Fraction) -> bool:
        """Whether (p, lam), on no curve, is stable."""
        here = Root.of(lam)
        for span in cell.spans:
            low, high = (None if end is None else value_of(self.boundary, end, p) for end in (span.low, span.high))
            if (low is None or low < here) and (high is None or here < high):
                return True
        return False

    # Cuts -----------------------------------------------------------------------------------------------------------

    def _cut(self, root: Root, cause: Critical, left: Cell, right: Cell) -> Cut:
        if not cause.wall:
            return self._crossing(root, cause, left, right)
        try:
            here = self._stable_set(root)
        except (SchemeError, ParameterError):
            return Cut(root, (), None)  # no scheme at this value
        except NotAnalysable as reason:
            raise NotProved(f"at {self.parameter} = {shown(root)}: {reason.message}") from None
        limits = self.limit(left, root), self.limit(right, root)
        intervals = [(i.low, i.high) for i in here.intervals]
        at_bound = self._at_bound(left.sample, root, here.lam_max, ends_stability=False)
        if intervals == limits[0] == limits[1]:
            return Cut(root, None, at_bound)
        return Cut(root, tuple(Span(*i) for i in intervals), at_bound)

    def _crossing(self, root: Root, cause: Critical, left: Cell, right: Cell) -> Cut:
        """A cut that no curve contains: the limit of the stable set, split where a meeting point is not stable."""
        limits, other = self.limit(left, root), self.limit(right, root)
        isolated = [lam for lam in self._meetings_inside(root, cause, left) if self._unstable(root, lam, left, right)]
        goes_over = limits == other and all(a[1] != b[0] for a, b in pairwise(limits))
        shared = goes_over and not isolated and not any(self._diverges(cell, root) for cell in (left, right))
        limits = split_at(limits, isolated)
        bound = limits[0][1] if limits and limits[0][0] is None else None
        closure = bound in isolated or "closure" in (left.limited_by, right.limited_by)
        at_bound = self._at_bound(left.sample, root, bound, ends_stability=closure)
        return Cut(root, None if shared else tuple(Span(*i) for i in limits), at_bound)

    def _diverges(self, cell: Cell, root: Root) -> bool:
        """Whether an end of a stable interval tends to infinity at an end of its cell."""
        ends = [end for span in cell.spans for end in (span.low, span.high) if end is not None]
        return any(self.limit_of(cell, end, root) == "oo" for end in ends)

    def _elimination(self, sample: Fraction) -> Eliminated | None:
        """With both symbols, for the signs and counts at a cell's sample; None where these are not the same on it."""
        if len(self.kinds) > 1:
            return None
        if sample not in self.eliminations:
            values = {**self.values, self.parameter: sample, self.scheme.cfl: self.places[sample]}
            self.eliminations[sample] = eliminated(self.scheme, values, (self.parameter, self.scheme.cfl))
        return self.eliminations[sample]

    def _unstable(self, root: Root, lam: Root, left: Cell, right: Cell) -> bool:
        """Whether a meeting point between stable stretches is not stable: by balls, by what closes in on it, exactly.

        Modes with abs(z) >= 1 are a closed set where the interior is Cauchy-stable: a gap between two stable intervals
        beside the cut that shrinks to the point leaves one there.
        """
        found = self._elimination(left.sample)
        if found is not None and clear_at(found, {self.parameter: root, self.scheme.cfl: lam}):
            return not interior_holds(self.scheme, {**self.at(root), self.scheme.cfl: lam})
        if any(self._gap_closes(cell, root, lam) for cell in (left, right)):
            return True
        verdict = self.verdict(root, lam)
        if verdict is Verdict.UNDECIDED:
            raise NotProved(f"{self.parameter} = {shown(root)}, {self.scheme.cfl} = {shown(lam)} is undecided")
        return verdict is not Verdict.STABLE

    def _gap_closes(self, cell: Cell, root: Root, lam: Root) -> bool:
        if len(self.kinds) > 1:
            return False
        for below, above in pairwise(cell.spans):
            ends = below.high, above.low
            if any(end is None or self.limit_of(cell, end, root) != lam for end in ends):
                continue
            low, high = (value_of(self.boundary, end, cell.sample) for end in ends if end is not None)
            within = Fraction(0) if low == high else between(low, high)
            here: dict[str, Fraction | Root] = {**self.at(cell.sample), self.scheme.cfl: within}
            if low != high and interior_holds(self.scheme, here):
                return True
        return False

    def _meetings_inside(self, root: Root, cause: Critical, left: Cell) -> Iterator[Root]:
        """The meeting points with stable lam on either side, next to them on the cut."""
        points = meeting_points(self.boundary.curves, root, sorted(cause.pairs))
        for lam, multiplicity in points.items():
            below, above = self._isolated(root, lam, multiplicity)
            p = self.beside(
                left, root, [specialise(c, {"lam": e}) for c in self.boundary.curves for e in (below, above)]
            )
            if self.contains(left, below, p) and self.contains(left, above, p):
                yield lam

    def _isolated(self, root: Root, lam: Root, multiplicity: Mapping[int, int]) -> tuple[Fraction, Fraction]:
        """Rational ends around a meeting point with no other point of a curve over ``root`` between them.

        Where the m-th derivative in lam has no zero there, a curve has m points at most, and m are at ``lam`` already.
        """
        derivatives = []
        for index, curve in enumerate(self.boundary.curves):
            for _ in range(multiplicity.get(index, 0)):
                curve = curve.derivative("lam")
            derivatives.append(curve)
        bits = START_BITS
        while bits <= MEETING_BITS:
            with ctx.workprec(bits + GUARD_BITS):
                below, above = rational_ends(lam.ball(bits // 2).real)
                below, above = below - (above - below), above + (above - below)
                box = {"p": root.ball(bits), "lam": hull(below, above)}
                if below == above:
                    below, above = (below * (1 + Fraction(sign, 1 << (bits // 2))) for sign in (-1, 1))
                    box["lam"] = hull(below, above)
                if not any(at_balls(each, box).contains(0) for each in derivatives):
                    return below, above
            bits *= 2
        raise NotProved(f"curves meet at {self.parameter} = {shown(root)} in a way that is not resolved")

    def beside(self, cell: Cell, root: Root, walls: Sequence[fmpz_mpoly]) -> Fraction:
        """A p of the cell so close to its end ``root`` that no zero of the polynomials in p lies between."""
        mine = [univariate(w, "p") for w in walls if not w.is_zero() and degree_in(w, "p")]
        factors = {key_of(primitive(f)): primitive(f) for w in mine for f, _ in w.factor()[1]}
        zeros = [r for f in factors.values() for r in isolated_roots(f, is_square_free=True) if r.is_real]
        if cell.high is root:
            below = [z for z in zeros if z < root and (cell.low is None or cell.low < z)]
            return between(max(below) if below else cell.low, root)
        above = [z for z in zeros if root < z and (cell.high is None or z < cell.high)]
        return between(root, min(above) if above else cell.high)

    def limit(self, cell: Cell, root: Root) -> list[tuple[Root | None, Root | None]]:
        """The stable intervals over the cell as p tends to its end ``root``; those that shrink to a point are left
        out.
        """
        limits = []
        for span in cell.spans:
            low = None if span.low is None else self.limit_of(cell, span.low, root)
            high = None if span.high is None else self.limit_of(cell, span.high, root)
            if low == "oo" or high == 0 or (low is not None and low == high):
                continue
            limits.append((None if low == 0 else low, None if high == "oo" else high))
        return limits  # type: ignore[return-value]

    def limit_of(self, cell: Cell, branch: End, root: Root) -> Root | int | str:
        """Where a branch tends: a positive number, 0, or "oo"."""
        assert isinstance(branch, Branch)
        curve = self.boundary.curves[branch.curve]
        ends = by_real_part(
            distinct(r.root for r in fibre({"p": root}, curve, "lam") if r.root.is_real and r.root.ball().real > 0)
        )
        walls = gates(ends)
        p = self.beside(cell, root, [specialise(curve, {"lam": gate}) for gate in walls])
        here = value_of(self.boundary, branch, p)
        place = sum(Root.of(gate) < here for gate in walls)
        return 0 if place == 0 else "oo" if place == len(walls) else ends[place - 1]
