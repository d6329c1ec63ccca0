"""Exact algebraic numbers as isolated roots, and where they lie relative to the unit circle.

A ``Root`` is a square-free integer polynomial together with a ball that holds exactly one of its roots. Balls come
from FLINT (``arb_fmpz_poly_complex_roots``, which proves them disjoint) and shrink on demand, so every strict
inequality about a root is decided by refining. Equalities never are: overlapping balls prove nothing. Algebra decides
those.

*On the unit circle.* Let p be a real polynomial and S = gcd(p, p*), p*(x) = x**n p(1/x). The inversion x -> 1/conj(x)
permutes the roots of S and fixes exactly those with abs(x) = 1; a root of p outside S is never on the circle. With the
roots of S in disjoint balls, the image of one ball either meets its own ball alone, and then the root is its own image,
or the root is off the circle and refining shows on which side. No tolerance enters. The same with x -> -conj(x) and
S = gcd(p(x), p(-x)) decides the imaginary axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cached_property, lru_cache, total_ordering
from typing import TypeVar, cast

from flint import acb, arb, ctx, fmpq, fmpz_poly

#: First working precision. Only speed depends on it: whatever 64 bits leave open is refined.
START_BITS = 64

#: Bits added to the working precision over those asked of a ball, so that a handful of operations on it keep them.
GUARD_BITS = 32


#: Coefficients longer than this may put roots so close together that FLINT's isolation, which approaches a cluster one
#: bit a step, takes seconds (3.6 s for a pair at distance 1e-300, against 5 ms). Both are proved; only speed differs.
LARGE_BITS = 256


class Position(Enum):
    """Where a number lies relative to the unit circle, exactly."""

    INSIDE = -1
    ON = 0
    OUTSIDE = 1


class Side(Enum):
    """Where a number lies relative to the imaginary axis, exactly."""

    LEFT = -1
    AXIS = 0
    RIGHT = 1


_Sided = TypeVar("_Sided", Position, Side)


def primitive(poly: fmpz_poly) -> fmpz_poly:
    """``poly`` without its integer content and with a positive leading coefficient; the zero polynomial stays zero."""
    if not poly:
        return poly
    content = poly.content()
    return poly // (content if poly.leading_coefficient() > 0 else -content)


def square_free(poly: fmpz_poly) -> fmpz_poly:
    """The product of the distinct irreducible factors of a nonzero ``poly``, primitive."""
    return primitive(poly // poly.gcd(poly.derivative()))


def reciprocal(poly: fmpz_poly) -> fmpz_poly:
    """``x**n poly(1/x)``, n the degree: the roots are the inverses of those of ``poly`` (a root 0 is lost)."""
    return fmpz_poly(list(poly)[::-1])


def reflected(poly: fmpz_poly) -> fmpz_poly:
    """``poly(-x)``."""
    return fmpz_poly([-c if k % 2 else c for k, c in enumerate(list(poly))])


class Isolation:
    """All roots of one square-free polynomial: refined together, kept in one order.

    Real roots come first, ascending, with an imaginary part that is exactly zero; then the others, a root of the upper
    half-plane followed by its conjugate. Balls are disjoint.
    """

    def __init__(self, poly: fmpz_poly) -> None:
        self.poly = poly
        self._balls: dict[int, Sequence[acb]] = {START_BITS: _root_balls(poly, START_BITS)}
        self._fine: dict[tuple[int, int], acb] = {}
        self._derivative = poly.derivative()

    def balls(self, bits: int) -> Sequence[acb]:
        """Disjoint balls in fixed order, radius at most ``2**-bits`` times the larger of the two components.

        They depend on the polynomial and ``bits`` alone: an isolation is shared by all who ask for it, and no printed
        digit may tell what was asked before.
        """
        # Doubling keeps the total cost of many small requests at that of the last one.
        level = START_BITS
        while level < bits:
            level *= 2
        if level not in self._balls:
            wanted, matched = level, None
            while matched is None:
                matched = _in_the_order_of(self._balls[START_BITS], _root_balls(self.poly, wanted))
                wanted *= 2
            self._balls[level] = matched
        return self._balls[level]

    def ball(self, index: int, bits: int) -> acb:
        """One of the balls as sharp as that: past the first precision it is refined by itself."""
        if bits <= START_BITS:
            return self._balls[START_BITS][index]
        fine = self._fine.get((index, bits))
        if fine is None:
            fine = self._refined(self._balls[START_BITS][index], bits)
            if fine is None:
                return self.balls(bits)[index]
            self._fine[index, bits] = fine
        return fine

    def _refined(self, ball: acb, bits: int) -> acb | None:
        return newton_refined(ball, bits, lambda x: (self.poly(x), self._derivative(x)))

    def __len__(self) -> int:
        return len(self._balls[START_BITS])


def newton_refined(ball: acb, bits: int, values: Callable[[acb], tuple[acb, acb]]) -> acb | None:
    """A part of ``ball`` that holds its root, to ``bits`` relative bits, by the interval Newton method.

    ``ball`` holds exactly one root of a function f; ``values`` encloses f and f' over a ball at the precision in force.
    For any m in the ball the root lies in m - f(m)/f'(ball) as well. None where these do not contract.
    """
    known, spare = ball.rel_accuracy_bits(), GUARD_BITS
    if known < -bits:  # a ball around 0 far wider than its root: nothing to double
        return None
    while known < bits:
        with ctx.workprec(min(2 * known, bits) + spare):
            middle = ball.mid()
            value, slope = values(middle)[0], values(ball)[1]
            if slope.contains(0):
                return None
            step = middle - value / slope
        found = step.rel_accuracy_bits()
        if found > known and ball.contains(step):
            ball, known = step, found
        else:  # what rounding f(m) loses: the logarithm of its terms' size over its own
            spare *= 2
            if spare > LOST_BITS * (bits + GUARD_BITS):
                return None
    return ball


LOST_BITS = 4
"""Bits lost to rounding, over those asked for, at which refining by itself is given up; only speed depends on it."""


def _root_balls(poly: fmpz_poly, bits: int) -> list[acb]:
    if poly.degree() > 1 and poly.height_bits() > LARGE_BITS:
        # Loaded where it is needed: it brings numpy, which most verdicts can do without.
        from gks.modes import clusters

        proved = clusters.isolate(poly, bits)
        if proved is not None:
            return proved
    working = bits
    while True:
        with ctx.workprec(working + GUARD_BITS):
            found = cast("list[tuple[acb, int]]", poly.complex_roots())
        balls = [ball for ball, _ in found]
        if all(ball.rel_accuracy_bits() >= bits for ball in balls):
            return balls
        working *= 2


def _in_the_order_of(old: Sequence[acb], fresh: Sequence[acb]) -> list[acb] | None:
    """``fresh`` balls arranged like the ``old`` ones of the same roots, None where an overlap leaves a doubt.

    Each old ball holds one root, whose fresh ball therefore overlaps it; a unique overlap is that root's.
    """
    arranged: list[acb] = []
    for ball in old:
        hits = [new for new in fresh if new.overlaps(ball)]
        if len(hits) != 1:
            return None
        arranged.append(hits[0])
    return arranged


@lru_cache(maxsize=4096)
def _isolation_of(coefficients: tuple[int, ...]) -> Isolation:
    return Isolation(fmpz_poly(list(coefficients)))


def isolation(poly: fmpz_poly) -> Isolation:
    """The shared, refinable isolation of a square-free polynomial's roots."""
    return _isolation_of(tuple(int(c) for c in list(poly)))


@dataclass(frozen=True, slots=True)
class _Fold:
    """An antiholomorphic involution of the plane, and the real function whose zero set it fixes."""

    mirror: Callable[[fmpz_poly], fmpz_poly]  # polynomial whose roots are the images
    image: Callable[[acb], acb]
    measure: Callable[[acb], arb]  # its sign names the side


_CIRCLE = _Fold(reciprocal, lambda x: 1 / x.conjugate(), lambda x: abs(x) - 1)
_AXIS = _Fold(reflected, lambda x: -x.conjugate(), lambda x: x.real)


@total_ordering
class Root:
    """One root of a square-free integer polynomial: an exact real or complex algebraic number.

    ``poly`` need not be irreducible (``minimal`` is). Equality and hashing are those of the number; real roots are
    ordered. Instances are cheap and share their isolation.
    """

    def __init__(self, poly: fmpz_poly, index: int) -> None:
        """``poly`` primitive and square-free; ``index`` counts in the order of its ``Isolation``."""
        self.poly = poly
        self.index = index
        self._isolation = isolation(poly)

    @staticmethod
    def of(value: Fraction | int) -> Root:
        """The rational number ``value``."""
        exact = Fraction(value)
        return Root(fmpz_poly([-exact.numerator, exact.denominator]), 0)

    def ball(self, bits: int = START_BITS) -> acb:
        """A ball with this root and no other root of ``poly``, relative radius at most ``2**-bits``."""
        return self._isolation.ball(self.index, bits)

    @cached_property
    def is_real(self) -> bool:
        # FLINT certifies real roots of a real polynomial and gives them an exact zero imaginary part.
        return self.ball().imag == 0

    @property
    def is_zero(self) -> bool:
        return self.rational == 0

    @cached_property
    def rational(self) -> Fraction | None:
        """The number as a fraction, None where it is irrational.

        With leading coefficient c the number c*x is an algebraic integer, so x is rational only if c*x is an integer.
        """
        if not self.is_real:
            return None
        leading = self.poly.leading_coefficient()
        bits = START_BITS
        while True:
            with ctx.workprec(bits + GUARD_BITS):
                scaled = (self.ball(bits) * leading).real
                nearest = scaled.unique_fmpz()
                if nearest is not None:
                    exact = self.poly(fmpq(nearest, leading)) == 0
                    return Fraction(int(nearest), int(leading)) if exact else None
                if not scaled.contains_integer():
                    return None
            bits *= 2

    @cached_property
    def position(self) -> Position:
        """Inside, on or outside the unit circle, decided exactly."""
        return self._relative_to(_CIRCLE, Position)

    @cached_property
    def side(self) -> Side:
        """Left of, on or right of the imaginary axis, decided exactly."""
        return self._relative_to(_AXIS, Side)

    @cached_property
    def minimal(self) -> Root:
        """The same number as a root of its irreducible polynomial."""
        factors = [factor for factor, _ in self.poly.factor()[1]]
        if len(factors) == 1:
            return self
        bits = START_BITS
        while True:
            with ctx.workprec(bits + GUARD_BITS):
                ball = self.ball(bits)
                mine = [p for p in factors if p(ball).contains(0)]
                if len(mine) == 1:
                    poly = primitive(mine[0])
                    hits = [k for k, other in enumerate(isolation(poly).balls(bits)) if other.overlaps(ball)]
                    if len(hits) == 1:
                        return Root(poly, hits[0])
            bits *= 2

    def _relative_to(self, fold: _Fold, answer: type[_Sided]) -> _Sided:
        mirrored = primitive(fold.mirror(self.poly))
        shared = primitive(self.poly.gcd(mirrored))
        rest = self.poly // shared
        bits = START_BITS
        while True:
            with ctx.workprec(bits + GUARD_BITS):
                ball = self.ball(bits)
                measure = fold.measure(ball)
                if measure > 0:
                    return answer(1)
                if measure < 0:
                    return answer(-1)
                # A root of p is one of the shared factor S exactly when it is none of p/S, p being square-free.
                if shared.degree() > 0 and not rest(ball).contains(0) and _own_image(shared, ball, fold, bits):
                    return answer(0)
            bits *= 2

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Root):
            return NotImplemented
        mine, theirs = self.minimal, other.minimal
        return mine.index == theirs.index and mine.poly == theirs.poly

    def __hash__(self) -> int:
        mine = self.minimal
        return hash((tuple(int(c) for c in list(mine.poly)), mine.index))

    def __lt__(self, other: Root) -> bool:
        if not (self.is_real and other.is_real):
            raise ValueError(f"only real numbers are ordered, got {self!r} and {other!r}")
        if self == other:
            return False
        bits = START_BITS
        while True:
            with ctx.workprec(bits + GUARD_BITS):
                gap = self.ball(bits).real - other.ball(bits).real
                if gap < 0 or gap > 0:
                    return gap < 0
            bits *= 2

    def __complex__(self) -> complex:
        return complex(self.ball())

    def __repr__(self) -> str:
        return f"Root({self.poly.str()}, near {self.ball().str(10, radius=False)})"


def _own_image(shared: fmpz_poly, ball: acb, fold: _Fold, bits: int) -> bool:
    """True if the one root of ``shared`` in ``ball`` is proved to be its own image under the fold; False: not yet."""
    balls = isolation(shared).balls(bits)
    here = [k for k, other in enumerate(balls) if other.overlaps(ball)]
    image = fold.image(ball)
    if len(here) != 1 or not image.is_finite():
        return False
    return [k for k, other in enumerate(balls) if other.overlaps(image)] == here


def isolated_roots(poly: fmpz_poly, *, is_square_free: bool = False) -> list[Root]:
    """The distinct roots of a nonzero polynomial, as roots of its square-free part; real ones first, ascending.

    ``is_square_free`` is the caller's promise that there are no repeated roots; it saves a gcd.
    """
    if not poly:
        raise ValueError("the zero polynomial has every number as a root")
    poly = primitive(poly) if is_square_free else square_free(poly)
    return [Root(poly, k) for k in range(poly.degree())]


def factored_roots(poly: fmpz_poly) -> list[tuple[Root, int]]:
    """All roots of a nonzero polynomial with their multiplicities, each as a root of its irreducible factor."""
    if not poly:
        raise ValueError("the zero polynomial has every number as a root")
    return [
        (root, multiplicity)
        for factor, multiplicity in poly.factor()[1]
        for root in isolated_roots(factor, is_square_free=True)
    ]
