"""A branch of a boundary curve as a formula: rational, with square roots, or with nested ones.

With y = n a_n lam + a_(n-1) the curve becomes y**n + c_(n-2) y**(n-2) + ... over Z[p]. It is solved where it is
linear, or quadratic in y or in y**2 (a curve in lam**2 is its own special case). Squares are taken out of every
radicand, and sqrt(A + B sqrt(C)) is split into two single roots where A**2 - B**2 C is a square. Each curve gives as
many formulas as it has roots; balls at a sample tell which of them is the branch. Over a cell the formulas' values
never meet, so it is the branch over the whole cell.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from math import isqrt

from flint import acb, ctx, fmpq, fmpz_mpoly, fmpz_poly

from gks.bounds.boundary import PLANE
from gks.errors import TooLarge
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.factoring import factored
from gks.modes.fibre import coefficients as powers_of
from gks.modes.fibre import embed, univariate
from gks.scheme.expression import Expr, add, mul, number, power, sqrt, symbol

MODEST = 400
"""Characters that a closed form may have; beyond, the root with its polynomial says more."""

TELL_BITS = 1 << 12
"""Precision up to which the formulas of one curve are told apart at a sample: distinct roots need far less."""


def closed_form(curve: fmpz_mpoly, p: Fraction, lam: Root, name: str) -> Expr | None:
    """The formula in the parameter ``name`` of the branch of ``curve`` through (p, lam); None where there is none."""
    try:
        formulas = [f for f in _solutions(curve, name) if len(str(f)) <= MODEST]
    except TooLarge:
        return None
    bits = START_BITS
    while bits <= TELL_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            target = lam.ball(bits)
            hits = [
                f
                for f in formulas
                if (value := ball(f, {name: acb(fmpq(p.numerator, p.denominator))})) is not None
                and value.overlaps(target)
            ]
        if len(hits) <= 1:
            return hits[0] if hits else None
        bits *= 2
    return None


def number_form(value: Root) -> Expr | None:
    """An algebraic number as a formula."""
    exact = value.rational
    if exact is not None:
        return number(exact)
    mirrored = value.ball().real < 0
    poly = value.minimal.poly
    if mirrored:
        poly = fmpz_poly([-c if k % 2 else c for k, c in enumerate(list(poly))])
    with ctx.workprec(START_BITS + GUARD_BITS):
        target = -value.ball() if mirrored else value.ball()
        hits = [
            f
            for f in _solutions(embed(poly, PLANE, "lam"), "p")
            if (b := ball(f, {})) is not None and b.overlaps(target)
        ]
    if len(hits) != 1 or len(str(hits[0])) > MODEST:
        return None
    return -hits[0] if mirrored else hits[0]


def ball(formula: Expr, values: Mapping[str, acb]) -> acb | None:
    """Encloses a formula at the working precision; None where a radicand is negative."""
    try:
        return formula.fold(_Balls(values))
    except ValueError:
        return None


class _Balls:
    def __init__(self, values: Mapping[str, acb]) -> None:
        self.values = values

    def number(self, value: Fraction) -> acb:
        return acb(fmpq(value.numerator, value.denominator))

    def symbol(self, name: str) -> acb:
        return self.values[name]

    def add(self, terms: Sequence[acb]) -> acb:
        return reduce(lambda a, b: a + b, terms)

    def mul(self, factors: Sequence[acb]) -> acb:
        return reduce(lambda a, b: a * b, factors)

    def power(self, base: acb, exponent: int) -> acb:
        return base**exponent

    def sqrt(self, radicand: acb) -> acb:
        if radicand.real < 0:
            raise ValueError("the square root of a negative number")
        return acb(radicand.real.sqrt())  # not a number, which overlaps everything, where the ball holds negative ones


# Solving ------------------------------------------------------------------------------------------------------------


def _solutions(curve: fmpz_mpoly, name: str) -> Iterator[Expr]:
    parts = powers_of(curve, "lam")
    degree = len(parts) - 1
    if degree == 1:
        yield _quotient(-parts[0], parts[1], name)
        return
    lam = PLANE.gens()[1]
    lead, next_to = parts[-1], parts[-2]
    shifted = sum(
        (part * (lam - next_to) ** k * (degree * lead) ** (degree - k) for k, part in enumerate(parts)),
        PLANE.constant(0),
    )
    depressed = powers_of(shifted / lead, "lam")
    if degree == 2:
        for y in _roots_of(-depressed[0]):
            yield _back(y, next_to, degree * lead, name)
    elif degree == 4 and depressed[1].is_zero():
        for y in _biquadratic(depressed[2], depressed[0]):
            yield _back(y, next_to, degree * lead, name)


class _Surd:
    """outer * sqrt(a + b sqrt(c)) / divisor, or a sum of two single roots; polynomials in p."""

    def __init__(
        self, outer: fmpz_mpoly, terms: Sequence[tuple[int, fmpz_mpoly, fmpz_mpoly, fmpz_mpoly]], divisor: int
    ) -> None:
        self.outer, self.terms, self.divisor = outer, terms, divisor

    @property
    def positive(self) -> bool:
        """Whether the first root comes with a plus."""
        return self.terms[0][0] > 0

    def formula(self, outer: fmpz_mpoly, name: str) -> Expr:
        summands = []
        for sign, a, b, c in self.terms:
            inside = _expanded(a, name)
            if not b.is_zero():
                inside = _sum(inside, mul([_factored(b, name), sqrt(_expanded(c, name))]))
            summands.append(mul([number(sign), sqrt(inside)]))
        return mul([_factored(outer, name), add(summands)])


def _roots_of(square: fmpz_mpoly) -> list[_Surd]:
    """y**2 = square."""
    outside, inside = _without_squares(square)
    zero = PLANE.constant(0)
    return [_Surd(outside, [(sign, inside, zero, zero)], 1) for sign in (1, -1)]


def _biquadratic(middle: fmpz_mpoly, last: fmpz_mpoly) -> Iterator[_Surd]:
    """y**4 + middle y**2 + last = 0."""
    zero, one = PLANE.constant(0), PLANE.constant(1)
    root = _square_root(last)
    if root is not None:
        # y = (+-sqrt(2 root - middle) +- sqrt(-2 root - middle)) / 2
        pair = [_without_squares(2 * root - middle), _without_squares(-2 * root - middle)]
        common = pair[0][0].gcd(pair[1][0])
        for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            terms = [
                (sign, inside * (outside / common) ** 2, zero, zero)
                for sign, (outside, inside) in zip(signs, pair, strict=True)
            ]
            yield _Surd(common, terms, 2)
        return
    outside, inside = _without_squares(middle * middle - 4 * last)
    # y = +-sqrt(2 (-middle +- outside sqrt(inside))) / 2
    shared = (2 * middle).gcd(2 * outside)
    common, _ = _without_squares(shared)
    a, b = (2 * middle) / (common * common), (2 * outside) / (common * common)
    for inner in (1, -1):
        for sign in (1, -1):
            if inside == one:
                yield _Surd(common, [(sign, -a + inner * b, zero, zero)], 2)
            else:
                yield _Surd(common, [(sign, -a, inner * b, inside)], 2)


def _back(y: _Surd, shift: fmpz_mpoly, scale: fmpz_mpoly, name: str) -> Expr:
    """(y - shift) / scale."""
    outer, divisor = y.outer, y.divisor * scale
    shift = y.divisor * shift
    if shift.is_zero():
        common = outer.gcd(divisor)
        return _over(y.formula(outer / common, name), divisor / common, name)
    common = outer.gcd(shift).gcd(divisor)
    outer, shift, divisor = outer / common, shift / common, divisor / common
    if divisor.leading_coefficient() < 0:
        outer, shift, divisor = -outer, -shift, -divisor
    whole, rest = shift.gcd(divisor), outer.gcd(divisor)
    above, below = shift / whole, divisor / whole
    if below.is_one() or (above.is_constant() and below.is_constant() and not divisor.is_constant()):
        # What is rational in it is a polynomial or a number, which stands better alone: 3/2 - sqrt(...)/(...).
        rational = _expanded(-above, name) / number(int(below.leading_coefficient()))
        surd = _over(y.formula(outer / rest, name), divisor / rest, name)
        return _sum(surd, rational) if y.positive and _starts_negative(-above) else _sum(rational, surd)
    both = [_expanded(-shift, name), y.formula(outer, name)]
    return _over(_sum(*(both[::-1] if y.positive and _starts_negative(-shift) else both)), divisor, name)


def _sum(*parts: Expr) -> Expr:
    """One sum, without sums among its terms."""
    return add([term for part in parts for term in (part.args if part.op == "add" else (part,))])


def _starts_negative(value: fmpz_mpoly) -> bool:
    return bool(value.leading_coefficient() < 0)


def _over(top: Expr, divisor: fmpz_mpoly, name: str) -> Expr:
    if divisor.is_one():
        return top
    return top / _factored(divisor, name)


def _quotient(top: fmpz_mpoly, bottom: fmpz_mpoly, name: str) -> Expr:
    common = top.gcd(bottom)
    top, bottom = top / common, bottom / common
    if bottom.leading_coefficient() < 0:
        top, bottom = -top, -bottom
    return _over(_factored(top, name), bottom, name)


# Squares ------------------------------------------------------------------------------------------------------------


def _without_squares(value: fmpz_mpoly) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """(s, r) with value = s**2 r and r square-free."""
    if value.is_zero():
        return PLANE.constant(0), PLANE.constant(1)
    content, factors = factored(value)
    outside, inside = _integer_square(content)
    s, r = PLANE.constant(outside), PLANE.constant(inside)
    for factor, multiplicity in factors:
        s *= factor ** (multiplicity // 2)
        r *= factor ** (multiplicity % 2)
    return s, r


def _integer_square(value: int) -> tuple[int, int]:
    """(s, r) with value = s**2 r, squares of primes up to 1000 taken out."""
    s, r = 1, abs(value)
    root = isqrt(r)
    if root * root == r:
        return root, 1 if value > 0 else -1
    for prime in range(2, 1000):
        while r % (prime * prime) == 0:
            s, r = s * prime, r // (prime * prime)
    return s, r if value > 0 else -r


def _square_root(value: fmpz_mpoly) -> fmpz_mpoly | None:
    outside, inside = _without_squares(value)
    return outside if inside.is_one() else None


# Polynomials as formulas --------------------------------------------------------------------------------------------


def _expanded(value: fmpz_mpoly, name: str) -> Expr:
    """Descending in p."""
    parts = list(univariate(value, "p"))
    x = symbol(name)
    terms = [mul([number(int(c)), power(x, k)]) for k, c in reversed(list(enumerate(parts))) if c]
    return add(terms) if terms else number(0)


def _factored(value: fmpz_mpoly, name: str) -> Expr:
    """A constant times powers of irreducible polynomials."""
    if value.is_zero():
        return number(0)
    content, factors = factored(value)
    return mul([number(content), *(power(_expanded(factor, name), m) for factor, m in factors)])
