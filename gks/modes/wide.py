"""The normal modes of schemes too wide for elimination: zeros of Delta counted, found and proved one by one.

The number of zeros in abs(w) < 1 and in pockets across the unit circle (`gks.modes.pockets`) is proved by walks that
leave nothing between their steps. Moments along the same walks say roughly where the zeros are; Newton's method in
balls polishes each and proves it (`gks.modes.polish`). Zeros at z = 1 and z = -1 are judged exactly (`exactpoint`).
When the zeros that were proved make up the numbers counted, there are no others and the verdict is certified.

What does not close is said: a zero whose ball meets the circle, a number that is not made up. Such a doubt forbids
every verdict but ``unstable``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

from flint import acb, ctx

from gks.modes.admissible import Candidate
from gks.modes.algebraic import GUARD_BITS, Root
from gks.modes.candidates import conjugate
from gks.modes.chart import Chart, chart_of
from gks.modes.decoupling import decoupled
from gks.modes.exactpoint import ExactPoint, exact_point, rational_candidate
from gks.modes.glancing import GlancingPocket, GlancingPoints
from gks.modes.inner import just_inside, outside
from gks.modes.judgement import judged_zero
from gks.modes.kreiss import NormalModeProblem
from gks.modes.numerals import ComplexNumber, midpoint, modulus_of, radius_of, text_real
from gks.modes.pockets import Circle, Pocket, circled
from gks.modes.polish import PRECISIONS, Found, Polisher
from gks.modes.recognised import candidate_at, holds
from gks.modes.reversal import reversible
from gks.modes.tables import DiscTables, disc_tables
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode, ModeKind
from gks.modes.winding import seeds

OUTPUT_BITS = 80
"""Relative precision of the spatial factors printed at exactly judged points."""
DEGENERATE = 2.0**-40
"""abs(Delta) relative to the lengths of its rows, everywhere on the circle, below which it is not told from zero: a
thousand times the rounding error of a determinant of moderate size."""
MOST_DOUBTS = 3
"""Open places on the circle that are named one by one; an interior that is not Cauchy-stable has thousands."""


@dataclass(slots=True)
class WideModes:
    """The modes with abs(z) >= 1 and those found just inside, whether that is proved, and what stayed open.

    ``places`` says where each of the modes was found: a polished zero, or a point that was judged exactly.
    """

    modes: list[Mode] = field(default_factory=list)
    places: list[Found | Candidate] = field(default_factory=list)
    certified: bool = True
    doubts: list[str] = field(default_factory=list)

    def join(self, other: WideModes) -> None:
        """Those of an independent part as well; one that no digit tells from a known one is counted with that."""
        known = range(len(self.modes))
        for mode, place in zip(other.modes, other.places, strict=True):
            twin = next((k for k in known if self.modes[k].meets(mode)), None)
            if twin is not None:
                self.modes[twin] = _both(self.modes[twin], mode)
            else:
                self.modes.append(mode)
                self.places.append(place)
        self.doubts += other.doubts
        self.certified &= other.certified


class VanishingDeterminant(ArithmeticError):
    """Delta is zero to rounding all along the circle."""


def wide_modes(problem: NormalModeProblem, *, inner: bool = False) -> WideModes:
    """Counts, finds and proves the normal modes; VanishingDeterminant where Delta seems to be identically zero.

    With ``inner`` those just inside the circle are looked for as well, which has no part in the proof.
    """
    first, *others = (modes_of_part(part, inner=inner) for part in decoupled(problem))
    for found in others:
        first.join(found)
    return first


def modes_of_part(problem: NormalModeProblem, *, inner: bool) -> WideModes:
    """The same of a problem that does not fall apart, or as if it did not."""
    tables, chart = disc_tables(problem), chart_of(problem)
    circle = circled(tables, chart, GlancingPoints(problem, tables, chart))
    if circle.walk.relative.max(initial=0.0) < DEGENERATE:
        raise VanishingDeterminant
    search = _Search(problem, tables, chart, Polisher(problem, chart, tables), circle)
    search.inside()
    for pocket in circle.pockets:
        search.pocket(pocket)
    for point in circle.glancing:
        search.glancing(point)
    open_ = list(_unsettled(circle))
    for w in open_[:MOST_DOUBTS]:
        search.doubt(f"whether a mode lies near z = {1 / w:.6g} is open: spatial roots meet there")
    if len(open_) > MOST_DOUBTS:
        search.doubt(f"the same at {len(open_) - MOST_DOUBTS} more places")
    if search.result.doubts:
        search.listed(outside(search.polisher), ModeKind.GROWING)
    if inner:
        search.listed(just_inside(search.polisher), ModeKind.DECAYING)
    return search.result


def _unsettled(circle: Circle) -> Iterator[complex]:
    """One point for each stretch of the circle that no step settled."""
    last = None
    for w in circle.walk.stuck:
        if last is None or abs(w - last) > 2.0**-20:
            yield w
        last = w


@dataclass
class _Search:
    """Takes the zeros of one region after the other."""

    problem: NormalModeProblem
    tables: DiscTables
    chart: Chart
    polisher: Polisher
    circle: Circle
    result: WideModes = field(default_factory=WideModes)

    def doubt(self, text: str) -> None:
        self.result.doubts.append(text)
        self.result.certified = False

    def inside(self) -> None:
        """The zeros with abs(w) < 1 outside all pockets."""
        count = self.circle.count
        if count < 0:
            self.doubt("the number of modes with abs(z) > 1 was not found")
            return
        found = [
            each
            for each in self.polisher.polish(seeds(self.circle.walk, 0j, 1.0, count), None)
            if abs(each.w) < 1 and not any(_within(each.w, pocket) for pocket in self.circle.pockets)
        ]
        self._take(_with_mirrors(found), count, "with abs(z) > 1", across=False)

    def listed(self, zeros: Sequence[Found], kind: ModeKind) -> None:
        """Modes that were found and not counted, and are not known yet."""
        known = [place.z for place in self.result.places if isinstance(place, Found)]
        for each in _with_mirrors(zeros):
            if not any(each.z.overlaps(other) for other in known):
                self._note(_mode(self.problem, each, kind), each)

    def pocket(self, pocket: Pocket) -> None:
        """The zeros in a pocket, and for one off the real axis those in its mirror image."""
        count = pocket.count
        if count < 0:
            self.doubt(f"the number of modes near z = {1 / pocket.centre:.6g} was not found")
            return
        exact = None if pocket.centre.imag or not count else self._exact(round(pocket.centre.real), count)
        where = f"near z = {1 / pocket.centre:.6g}"
        if exact is not None:
            self._note(_exact_mode(self.problem, exact, round(pocket.centre.real)), exact.candidate)
        # The moments about the centre of a pocket do not see the zeros that are the centre.
        left = count - (exact.order if exact is not None else 0)
        near = seeds(pocket.walk, pocket.centre, pocket.radius, count) if left else []
        near = sorted(near, key=lambda w: abs(w - pocket.centre))[count - left :]
        found = [
            each
            for each in self.polisher.polish(near, pocket.region, pocket.radius)
            if _within(each.w, pocket) and not (exact is not None and each.z.contains(round(pocket.centre.real)))
        ]
        if pocket.centre.imag:
            self._take(found, left, where)
            self._take([_mirrored(each) for each in found], left, where)
        else:
            self._take(_with_mirrors(found), left, where)

    def _symmetric(self, zero: Found, all_found: Sequence[Found]) -> bool:
        """Whether a simple zero is its own mirror image in the circle, as one that has no other beside it is in a
        problem that is its own time reversal; its mode is noted.

        Its image is as deep in the pocket as itself, and among the zeros counted there: in no other ball than its own,
        or the count is not made up.
        """
        with ctx.workprec(PRECISIONS[-1] + GUARD_BITS):
            image = 1 / zero.z.conjugate()
            alone = not any(other is not zero and other.z.overlaps(image) for other in all_found)
        if not (zero.proved and zero.clear and zero.multiplicity == 1 and alone and self._reversible):
            return False
        self._note(replace(_mode(self.problem, zero, ModeKind.EIGENVALUE), modulus=Fraction(1)), zero)
        return True

    @cached_property
    def _reversible(self) -> bool:
        return reversible(self.problem)

    def _on_circle(self, zero: Found) -> bool:
        """Whether a simple zero that balls do not tell from the circle is proved to lie on it; its mode is noted."""
        sigma = zero.sigma(self.problem) if zero.proved and zero.multiplicity == 1 else None
        if sigma is None:
            return False
        for mode, place in zip(self.result.modes, self.result.places, strict=True):
            if isinstance(place, Candidate) and holds(sigma.conjugate(), place.sigma):
                self._note(mode.conjugate(), conjugate(place))
                return True
        candidate = candidate_at(self.problem, sigma, zero.z)
        if candidate is None:
            return False
        try:
            mode, dimension = judged_zero(self.problem, candidate)
        except Undecided:
            return False
        if dimension:
            self._note(mode, candidate)
        return bool(dimension)

    def _note(self, mode: Mode, place: Found | Candidate) -> None:
        self.result.modes.append(mode)
        self.result.places.append(place)

    def glancing(self, pocket: GlancingPocket) -> None:
        """The mode at a glancing point, where there is one, and its conjugate."""
        if pocket.mode is not None:
            self._note(pocket.mode, pocket.candidate)
            self._note(pocket.mode.conjugate(), conjugate(pocket.candidate))

    def _exact(self, z: int, most: int) -> ExactPoint | None:
        """The judgement of z = 1 or z = -1; None where Delta does not vanish there, or that is left open."""
        candidate = rational_candidate(self.problem, z)
        if candidate is None:
            return None
        try:
            point = exact_point(self.problem, candidate, most)
        except Undecided as reason:
            self.doubt(f"{reason} (at z = {z})")
            return None
        return None if point.kind is ModeKind.INADMISSIBLE else point

    def _take(self, found: Sequence[Found], count: int, where: str, *, across: bool = True) -> None:
        """Notes the zeros of a region that was found to have so many; ``across`` the circle if it is a pocket."""
        for each in found:
            kind = _kind(each.z)
            if kind is None and ((across and self._symmetric(each, found)) or self._on_circle(each)):
                continue
            if kind is None:
                distance = text_real(radius_of(each.z)) if each.z.is_finite() else "any distance"
                self.doubt(f"a mode {where} is not told from abs(z) = 1, to within {distance}")
                continue
            if kind is ModeKind.GROWING and not each.proved:
                self.doubt(f"a growing mode {where}, z = {complex(each.z):.6g}, was seen and not proved")
                continue
            self.result.certified &= each.proved
            if kind is ModeKind.DECAYING and not all(abs(x) < 1 for roots in each.roots for x in roots):
                continue  # a zero across the circle whose spatial part has ceased to decay is no mode
            self._note(_mode(self.problem, each, kind), each)
        number = sum(each.multiplicity for each in found)
        if number != count:
            self.doubt(f"{count} zeros of the determinant were counted {where} and {number} found")


def _within(w: complex, pocket: Pocket) -> bool:
    return min(abs(w - pocket.centre), abs(w.conjugate() - pocket.centre)) < pocket.radius


def _kind(z: acb) -> ModeKind | None:
    with ctx.workprec(PRECISIONS[-1] + GUARD_BITS):
        size = abs(z)
        if size > 1:
            return ModeKind.GROWING
        return ModeKind.DECAYING if size < 1 else None


def _with_mirrors(found: Sequence[Found]) -> list[Found]:
    """The zeros with their conjugates, which are zeros as well, whether or not both of a pair were found."""
    every = list(found)
    for each in found:
        mirror = _mirrored(each)
        if not any(mirror.z.overlaps(other.z) for other in every):
            every.append(mirror)
    return every


def _mirrored(found: Found) -> Found:
    """The conjugate zero."""
    with ctx.workprec(PRECISIONS[-1]):
        roots = tuple(tuple(x.conjugate() for x in family) for family in found.roots)
        mu = None if found.mu is None else found.mu.conjugate()
        return replace(found, w=found.w.conjugate(), z=found.z.conjugate(), roots=roots, mu=mu)


def _both(one: Mode, other: Mode) -> Mode:
    """Two modes whose discs overlap as one, of a disc round the first that holds the other's too."""
    return replace(
        one,
        multiplicity=one.multiplicity + other.multiplicity,
        radius=one.radius + 2 * other.radius,
        kappa={name: tuple(dict.fromkeys(one.kappa[name] + other.kappa[name])) for name in one.kappa},
    )


# Output ---------------------------------------------------------------------------------------------------------------


def _mode(problem: NormalModeProblem, found: Found, kind: ModeKind) -> Mode:
    with ctx.workprec(PRECISIONS[-1]):
        kappa = _kappa(problem, found.roots)
        (real, imaginary), radius = midpoint(found.z), radius_of(found.z)
        if found.z.imag.contains(0):
            # It may be real: the wider disc round the real midpoint holds it all the same.
            imaginary, radius = Fraction(0), radius + abs(imaginary)
        return Mode((real, imaginary), modulus_of(found.z), radius, found.multiplicity, kind, kappa)


def _exact_mode(problem: NormalModeProblem, point: ExactPoint, z: int) -> Mode:
    with ctx.workprec(OUTPUT_BITS + GUARD_BITS):
        roots = [tuple(_ball(r) for r in family.strictly() + family.on_circle()) for family in point.families]
        kappa = _kappa(problem, roots)
    return Mode((Fraction(z), Fraction(0)), Fraction(1), Fraction(0), point.order, point.kind, kappa)


def _ball(root: Root) -> acb:
    return root.ball(OUTPUT_BITS)


def _kappa(problem: NormalModeProblem, roots: Sequence[Sequence[acb]]) -> dict[str, tuple[ComplexNumber, ...]]:
    """The spatial factors kappa of every domain, equal ones of several fields once."""
    found: dict[str, tuple[ComplexNumber, ...]] = {}
    for half_line in problem.scheme.domains:
        families = dict.fromkeys(b.family for b in problem.blocks if b.field.domain == half_line.name)
        mine = [x if half_line.side == "right" else 1 / x for family in families for x in roots[family]]
        found[half_line.name] = tuple(dict.fromkeys(midpoint(x) for x in mine if x.is_finite()))
    return found
