"""The spatial roots over a point off the unit circle, in balls: what needs no algebraic number of its own.

With abs(z) != 1 a spatial root counts when abs(x) < 1, a strict inequality, and a simple one can be enclosed at any
precision from the polynomial P(sigma, x) alone. So nothing exact has to be known of it: no norm over the conjugates of
sigma, whose degree is that of sigma times that of P. Where roots collide, or come too close to the circle to be told,
there is no answer here, and exact algebra has to give it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product

from flint import acb, acb_poly, ctx, fmpz_mpoly

from gks.modes.admissible import Candidate, point_of
from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root, newton_refined
from gks.modes.conjugates import vanishes
from gks.modes.coupled import CoupledField
from gks.modes.fibre import at_balls
from gks.modes.fibre import coefficients as powers_of
from gks.modes.height import zero_exponent
from gks.modes.kreiss import Enclosed, NormalModeProblem, closure_matrix
from gks.modes.rank import certain_rank, exact_rank

TELLING_BITS = 4 * START_BITS
"""Precision up to which roots are told from each other and from the circle; beyond it exact algebra is cheaper."""
SHEET_BITS = 1 << 10
"""Precision beyond which a second choice that still may vanish is taken to do so."""


class BallRoot:
    """One simple root of P(point, x), known by a ball that shrinks on demand."""

    def __init__(self, symbol: _Symbol, ball: acb) -> None:
        self._symbol = symbol
        self._first = ball
        self._fine: dict[int, acb] = {}

    def ball(self, bits: int = START_BITS) -> acb:
        """A ball with this root alone, relative radius at most ``2**-bits``; NotTold where it would not shrink.

        It depends on ``bits`` alone, not on what was asked before.
        """
        if self._first.rel_accuracy_bits() >= bits:
            return self._first
        if bits not in self._fine:
            refined = newton_refined(self._first, bits, self._symbol.values)
            if refined is None:
                raise NotTold
            self._fine[bits] = refined
        return self._fine[bits]

    def position(self) -> Position:
        """Inside or outside the circle; NotTold where balls do not say."""
        bits, ball = START_BITS, self._first
        while bits <= TELLING_BITS:
            with ctx.workprec(bits + GUARD_BITS):
                size = abs(ball)
                if size < 1:
                    return Position.INSIDE
                if size > 1:
                    return Position.OUTSIDE
                ball = self.ball(bits)
            bits *= 2
        raise NotTold


class NotTold(ArithmeticError):
    """Balls leave open what exact algebra has to decide."""


class _Symbol:
    """P(point, .) with its coefficients in balls at any precision."""

    def __init__(self, point: Mapping[str, Root], polynomial: fmpz_mpoly) -> None:
        self._point = point
        self._powers = powers_of(polynomial, "x")
        self._known: dict[int, tuple[acb_poly, acb_poly]] = {}

    def at(self, bits: int) -> acb_poly:
        """The polynomial from coordinates to that many bits, at the precision in force."""
        balls = {name: root.ball(bits) for name, root in self._point.items()}
        return acb_poly([at_balls(c, balls) for c in self._powers])

    def values(self, x: acb) -> tuple[acb, acb]:
        """P and its derivative in x over a ball, the coefficients as sharp as the precision in force."""
        if ctx.prec not in self._known:
            polynomial = self.at(ctx.prec)
            self._known[ctx.prec] = polynomial, polynomial.derivative()
        polynomial, derivative = self._known[ctx.prec]
        return polynomial(x), derivative(x)

    def roots(self) -> list[BallRoot]:
        """All roots; NotTold where they are not simple, or not all finite, as far as balls tell."""
        degree = len(self._powers) - 1
        if degree < 1:
            return []
        bits = START_BITS
        while bits <= TELLING_BITS:
            with ctx.workprec(bits + GUARD_BITS):
                polynomial = self.at(bits)
                if not polynomial[degree].contains(0) and not polynomial[0].contains(0):
                    try:
                        return _sorted(self, polynomial)
                    except ValueError:  # FLINT did not isolate them
                        pass
            bits *= 2
        raise NotTold


def _sorted(symbol: _Symbol, polynomial: acb_poly) -> list[BallRoot]:
    """Real roots first, ascending, with no imaginary part; then the others."""
    balls = polynomial.roots()
    if all(c.imag == 0 for c in polynomial):
        balls = [acb(ball.real) if _is_real(ball, balls) else ball for ball in balls]
    order = sorted(balls, key=lambda ball: (bool(ball.imag != 0), float(ball.real.mid()), -float(ball.imag.mid())))
    return [BallRoot(symbol, ball) for ball in order]


def _is_real(ball: acb, balls: Sequence[acb]) -> bool:
    """Whether the root in one of the balls around the roots of a real polynomial is its own conjugate."""
    image = ball.conjugate()
    return not any(other is not ball and other.overlaps(image) for other in balls)


Roots = tuple[tuple[BallRoot, ...], ...]
"""Spatial roots, a family each."""


@dataclass(frozen=True, slots=True)
class BallSpace:
    """The spatial roots at a candidate off the circle, a family each: those inside, and all of them.

    ``choices`` are the places in ``all`` that a choice of the elimination may take: the roots of the family's part.
    """

    inside: Roots
    all: Roots
    choices: tuple[int, ...]


def ball_space(problem: NormalModeProblem, candidate: Candidate) -> BallSpace:
    """Splits the spatial roots of all families; NotTold where balls do not."""
    point = point_of(problem, candidate)
    inside, every, choices = [], [], []
    for family in problem.families:
        roots = _Symbol(point, family.part).roots()
        choices.append(len(roots))
        rest = family.polynomial / family.part
        if not rest.is_constant():
            roots += _Symbol(point, rest).roots()
        every.append(tuple(roots))
        inside.append(tuple(root for root in roots if root.position() is Position.INSIDE))
    return BallSpace(tuple(inside), tuple(every), tuple(choices))


def has_kernel(
    problem: NormalModeProblem, candidate: Candidate, space: BallSpace, order: Callable[[], int | None] = lambda: None
) -> bool:
    """Whether the closure annihilates a solution made of the roots inside, exactly.

    Balls that leave no doubt; else that no other choice of roots makes the determinant vanish, where one must (as in
    ``sheets``); else the ``order`` of the determinant's zero, where that is known; else the exact rank with its bound
    on algebraic numbers. NotTold where the field of a coupled system may miss a solution.
    """
    point = point_of(problem, candidate)
    _require_regular(problem, point, space)
    columns = sum(block.zeros + len(space.inside[block.family]) for block in problem.blocks)
    if columns > problem.size:
        return True
    certain = certain_rank(_matrices(problem, point, space.inside), TELLING_BITS)
    if certain is not None:
        return columns > certain
    if columns == problem.size and not problem.coefficients.generators and _is_a_choice(problem, space):
        for families in candidate.sheets:
            if all(_never_vanishes(problem, point, choice) for choice in _other_choices(problem, space, families)):
                return True
    known = order() if columns == problem.size else None
    if known is not None:
        return known > 0
    if columns == problem.size:
        zero = vanishes(problem, candidate.sigma, by_block(problem, space.inside))
        if zero is not None:
            return zero
    return columns > exact_rank(
        _matrices(problem, point, space.inside), lambda: zero_exponent(problem, candidate.sigma)
    )


def _matrices(problem: NormalModeProblem, point: Mapping[str, Root], choice: Roots) -> Callable[[int], list[list[acb]]]:
    """The Kreiss matrix over a choice of roots, at any precision."""
    roots = by_block(problem, choice)
    return lambda bits: closure_matrix(problem, point, roots, bits)


def by_block(problem: NormalModeProblem, choice: Roots) -> list[list[Enclosed]]:
    """The roots 0 and the chosen ones of every block."""
    return [[*([Root.of(0)] * b.zeros), *choice[b.family]] for b in problem.blocks]


def _never_vanishes(problem: NormalModeProblem, point: Mapping[str, Root], choice: Roots) -> bool:
    return certain_rank(_matrices(problem, point, choice), SHEET_BITS) == problem.size


def _require_regular(problem: NormalModeProblem, point: Mapping[str, Root], space: BallSpace) -> None:
    """NotTold where c(x) of a coupled block may vanish at one of its roots."""
    with ctx.workprec(START_BITS + GUARD_BITS):
        at = {name: root.ball(START_BITS) for name, root in point.items()}
        for block in problem.blocks:
            if isinstance(block.field, CoupledField):
                places = [root.ball() for root in space.inside[block.family]] + [acb(0)] * bool(block.zeros)
                for x in places:
                    if all(at_balls(c, {**at, "x": x}).contains(0) for c in block.field.column):
                        raise NotTold


def _is_a_choice(problem: NormalModeProblem, space: BallSpace) -> bool:
    """Whether the roots inside are one of the choices that the elimination runs over."""
    return all(
        len(mine) == family.decaying and all(root in roots[:count] for root in mine)
        for family, mine, roots, count in zip(problem.families, space.inside, space.all, space.choices, strict=True)
    )


def _other_choices(problem: NormalModeProblem, space: BallSpace, families: Collection[int]) -> Iterator[Roots]:
    """Every choice that differs from the roots inside in some of the families given."""
    options = [
        combinations(space.all[k][: space.choices[k]], family.decaying) if k in families else [space.inside[k]]
        for k, family in enumerate(problem.families)
    ]
    return (choice for choice in product(*options) if choice != space.inside)
