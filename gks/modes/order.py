"""The multiplicity of a normal mode: the order to which Delta itself vanishes, where the norm vanishes to a higher one.

The norm is the product of Delta over all choices of spatial roots, and counts the zeros of every choice. Where the
choice of the admissible roots is analytic near the point, the zeros of its own determinant in a small disc are counted;
and the only one in there is the mode, where the disc keeps clear of the other roots of the norm.

*Analytic.* Over the disc the spatial roots lie in Smith's discs (`gks.modes.rootdiscs`), as many in each group of
overlapping ones as the group has discs. Groups that hold admissible roots alone, or none, at the centre keep the choice
apart: it continues analytically, through collisions within a group too, since Delta depends on a group's roots
symmetrically.

*Counted.* With B a bound of Delta in abs(t) < R and q = r/R, N values on abs(t) = r give by Fourier's sum

    a_j = c_j r**j,     j < N,     up to B q**(j + N) / (1 - q**N),

c_j the coefficients of Taylor's series (Cauchy's estimate of what is folded back). By Rouché's theorem there are k
zeros in abs(t) < s r, s < 1, where abs(a_k) s**k exceeds the other terms and B (q s)**N / (1 - q s), what is left.

A count of 0 says that the choice of the admissible roots is not the one that vanishes: there is no mode. A multiplicity
that is not told is the norm's count, an upper bound.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from flint import acb, acb_mat, acb_poly, arb, ctx, fmpz_mpoly, fmpz_poly

from gks.modes.admissible import Candidate, admissible, point_of
from gks.modes.algebraic import GUARD_BITS, START_BITS, isolation
from gks.modes.coupled import CoupledField
from gks.modes.fibre import at_balls, fibre
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import Family, NormalModeProblem, kreiss_matrix, longest, newton_columns
from gks.modes.spatialballs import NotTold, ball_space
from gks.modes.undecided import Undecided

DISCS = 24
"""Discs tried, each a quarter of the one before: down to 1e-14 of the distance to the next root of the norm."""
VALUES, MOST_VALUES = 16, 256
"""Values of Delta on a circle, doubled until what folds back of the bound is small: 16**-16 = 5e-20 of it is, unless
Delta is what is left of large numbers."""
INNER = 16
"""R/r."""
HELD = 2
"""How many radii of its ball a disc round the middle of the candidate's ball has at least: more than one."""
ISOLATED_BITS = 24
"""What an isolated root has at least in practice; fewer only make the discs round it larger."""


class _Open(ArithmeticError):
    """The choice of the admissible roots is not kept apart, or Delta not from 0."""


def multiplicity(problem: NormalModeProblem, candidate: Candidate) -> int:
    """How many times a normal mode counts; the norm's multiplicity where that is not told."""
    if candidate.multiplicity == 1:
        return 1
    order = vanishing_order(problem, candidate)
    return order * candidate.images if order else candidate.multiplicity


def vanishing_order(problem: NormalModeProblem, candidate: Candidate) -> int | None:
    """The order of Delta at a zero of the norm as a function of the problem's variable, 0 where it is none of Delta.

    None where that is not told.
    """
    if not candidate.rivals:
        return None
    try:
        return _order(problem, candidate)
    except (_Open, NotTold, Undecided):
        return None


def _order(problem: NormalModeProblem, candidate: Candidate) -> int:
    _require_finite(problem, candidate)
    labels = _labelled(problem, candidate)
    clear = _distance(candidate)
    for _ in range(DISCS):
        clear = (clear / 4).mid()
        # Delta is as small as a power of the radius, and the balls have to be sharp enough to show it.
        small = max(0, _exponent(abs(candidate.sigma.ball()).mid() / clear))
        bits = 4 * START_BITS + (candidate.multiplicity + 1) * small
        with ctx.workprec(bits + GUARD_BITS):
            try:
                return _Disc(problem, candidate, clear, bits, labels).zeros()
            except _Open:
                pass
    raise _Open


def _require_finite(problem: NormalModeProblem, candidate: Candidate) -> None:
    """_Open where a spatial root may be infinite at the candidate: no disc holds it then."""
    with ctx.workprec(START_BITS + GUARD_BITS):
        at = {name: root.ball() for name, root in point_of(problem, candidate).items()}
        if any(at_balls(powers_of(f.polynomial, "x")[-1], at).contains(0) for f in problem.families):
            raise _Open


def _exponent(value: arb) -> int:
    """log2 of a positive number, rounded up; 0 for 0."""
    mantissa, exponent = value.mid().man_exp()
    return int(exponent) + int(mantissa).bit_length()


def _distance(candidate: Candidate) -> arb:
    """A positive number at most the distance to the next zero of the norm, and at most abs(sigma), or 1 for 0."""
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            here = candidate.sigma.ball(bits)
            near = abs(here).abs_lower() if here != 0 else arb(1)
            for polynomial in candidate.rivals:
                balls = isolation(polynomial).balls(bits)
                meeting = [k for k, ball in enumerate(balls) if ball.overlaps(here)]
                mine = meeting[0] if len(meeting) == 1 and _shares(polynomial, candidate) else -1
                near = min([near, *((ball - here).abs_lower() for k, ball in enumerate(balls) if k != mine)])
            if near > 0:
                return near
        bits *= 2


def _shares(polynomial: fmpz_poly, candidate: Candidate) -> bool:
    """Whether the candidate is a root of the polynomial: its irreducible one divides that."""
    return not polynomial % candidate.sigma.minimal.poly


# The spatial roots at the centre --------------------------------------------------------------------------------------

_Labels = Sequence[tuple[acb, bool]]
"""Balls around all spatial roots of a family, and whether each is admissible."""


def _labelled(problem: NormalModeProblem, candidate: Candidate) -> list[_Labels]:
    """_Open where not as many are admissible as decay outside the circle, or only some of the branches at a root."""
    try:
        space = ball_space(problem, candidate)
    except NotTold:
        return [_exactly_labelled(problem, candidate, family) for family in problem.families]
    if any(len(mine) != family.decaying for mine, family in zip(space.inside, problem.families, strict=True)):
        raise _Open
    return [[(r.ball(), r in mine) for r in each] for each, mine in zip(space.all, space.inside, strict=True)]


def _exactly_labelled(problem: NormalModeProblem, candidate: Candidate, family: Family) -> _Labels:
    found = admissible(problem, family, candidate)
    if found.count != family.decaying or any(count != root.multiplicity for root, count in found.limiting):
        raise _Open
    mine = [*found.inside, *(root for root, _ in found.limiting)]
    return [(each.ball(), each in mine) for each in fibre(point_of(problem, candidate), family.polynomial, "x")]


# The disc -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Group:
    """A ball with exactly ``size`` spatial roots over a set of the variable; whether they are the admissible ones."""

    ball: acb
    size: int
    admissible: bool


class _Disc:
    """Delta over the disc of a given radius round a candidate."""

    def __init__(
        self, problem: NormalModeProblem, candidate: Candidate, radius: arb, bits: int, labels: Sequence[_Labels]
    ) -> None:
        self.problem, self.radius = problem, radius
        candidate_ball = candidate.sigma.ball(bits)
        self.centre, self._blur = candidate_ball.mid(), candidate_ball.rad()
        self._at = {name: root.ball(bits) for name, root in problem.coefficients.point().items()}
        self._symbols = [[self._polynomial(c) for c in powers_of(f.polynomial, "x")] for f in problem.families]
        self._weights = {id(t.coefficient): self._polynomial(t.coefficient) for row in problem.rows for t in row}
        self._everywhere, aside = radius * acb(arb(0, 1), arb(0, 1)), radius * acb(0.375, 0.25)
        self._regions = [
            _joined(_inclusions(symbol, self._everywhere, aside), known)
            for symbol, known in zip(self._symbols, labels, strict=True)
        ]
        self._require_columns(self.centre + self._everywhere)

    def _polynomial(self, poly: fmpz_mpoly) -> acb_poly:
        """A coefficient as a polynomial in what the problem's variable is off the centre."""
        name = self.problem.variable
        return acb_poly([at_balls(c, {**self._at, name: acb(0)}) for c in powers_of(poly, name)])(
            acb_poly([self.centre, 1])
        )

    def _require_columns(self, everywhere: acb) -> None:
        """_Open where a coupled field may miss a solution somewhere in the disc."""
        at: Mapping[str, acb] = {**self._at, self.problem.variable: everywhere}
        for block in self.problem.blocks:
            if isinstance(block.field, CoupledField):
                roots = [g.ball for g in self._regions[block.family] if g.admissible] + [acb(0)] * bool(block.zeros)
                if any(all(at_balls(c, {**at, "x": x}).contains(0) for c in block.field.column) for x in roots):
                    raise _Open

    def zeros(self) -> int:
        """The number of zeros of Delta in a smaller disc that holds the candidate."""
        q = arb(1) / INNER
        bound, count = self._bound(), VALUES
        first = self._delta(acb(self.radius * q))
        if first.contains(0):  # no other zero is in the disc: this choice has Delta = 0 throughout, or it is too small
            raise _Open
        enough = first.abs_lower() / 2**START_BITS
        while count < MOST_VALUES and not bound * q**count < enough:
            count *= 2
        sums = acb.dft([self._delta(self.radius * q * (acb(2 * k) / count).exp_pi_i()) for k in range(count)])
        folded = bound * q**count / (1 - q**count)
        sizes = [abs(total / count) + folded * q**j * arb(0, 1) for j, total in enumerate(sums)]
        s = arb(1)
        while (s := s / 2) * q * self.radius > HELD * self._blur and s > arb(2) ** -START_BITS:
            terms = [size * s**j for j, size in enumerate(sizes)]
            rest = sum(terms, bound * (q * s) ** count / (1 - q * s))
            for k, term in enumerate(terms):
                if term > rest - term:
                    return k
        raise _Open

    def _bound(self) -> arb:
        """Hadamard's bound of Delta in the disc."""
        product = arb(1)
        for row in self._matrix(self._everywhere, self._regions):
            product *= sum((entry.abs_upper() ** 2 for entry in row), arb(0)).sqrt().upper()
        if not product.is_finite():
            raise _Open
        return product

    def _delta(self, point: acb) -> acb:
        """Delta at a point of the disc."""
        return acb_mat(self._matrix_at(point)).det() if self.problem.size else acb(1)

    def _matrix_at(self, point: acb) -> list[list[acb]]:
        groups = [
            _joined(_inclusions(symbol, point, point), [(g.ball, g.admissible) for g in regions])
            for symbol, regions in zip(self._symbols, self._regions, strict=True)
        ]
        return self._matrix(point, groups)

    def _matrix(self, where: acb, groups: Sequence[Sequence[_Group]]) -> list[list[acb]]:
        """The Kreiss matrix over a ball, from the groups of spatial roots over it, a family each."""
        roots = [[g.ball for g in mine if g.admissible for _ in range(g.size)] for mine in groups]
        columns = [
            newton_columns([acb(0)] * b.zeros + roots[b.family], longest(self.problem.rows, k), acb(0), acb(1))
            for k, b in enumerate(self.problem.blocks)
        ]
        return kreiss_matrix(self.problem.rows, columns, lambda c: self._weights[id(c)](where), acb(0))


def _inclusions(symbol: Sequence[acb_poly], where: acb, point: acb) -> list[acb]:
    """Smith's discs for the spatial roots over a ball of the variable, round those at one of its points."""
    polynomial = acb_poly([c(where) for c in symbol])
    exact = acb_poly([c(point).mid() for c in symbol])
    try:
        centres = [_polished(exact, root.mid()) for root in exact.roots()]
    except ValueError:  # FLINT did not isolate them
        raise _Open from None
    degree = len(symbol) - 1
    found = []
    for k, x in enumerate(centres):
        apart = acb(1)
        for other in centres[:k] + centres[k + 1 :]:
            apart *= x - other
        radius = (degree * abs(polynomial(x) / (polynomial[degree] * apart))).upper()
        if len(centres) != degree or not radius.is_finite():
            raise _Open
        found.append(x + radius * acb(arb(0, 1), arb(0, 1)))
    return found


def _polished(polynomial: acb_poly, x: acb) -> acb:
    """A simple root to the precision in force, by Newton's method; isolated roots have some 30 bits to begin with."""
    slope = polynomial.derivative()
    known = ISOLATED_BITS
    while known < ctx.prec:
        x = (x - polynomial(x) / slope(x)).mid()
        known *= 2
    return x


def _joined(discs: Sequence[acb], known: _Labels) -> list[_Group]:
    """Overlapping discs as one group each, labelled by the known balls that they meet; _Open where these differ."""
    groups: list[_Group] = []
    for disc in discs:
        joined = _Group(disc, 1, admissible=False)
        while near := [g for g in groups if g.ball.overlaps(joined.ball)]:
            groups = [g for g in groups if g not in near]
            for each in near:
                joined = _Group(joined.ball.union(each.ball), joined.size + each.size, admissible=False)
        groups.append(joined)
    return [replace(group, admissible=_label(group.ball, known)) for group in groups]


def _label(ball: acb, known: Collection[tuple[acb, bool]]) -> bool:
    labels = {label for other, label in known if other.overlaps(ball)}
    if len(labels) != 1:
        raise _Open
    return labels.pop()
