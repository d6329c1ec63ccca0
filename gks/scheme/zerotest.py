"""Whether an expression vanishes as a formula: (lam + 1)**2 - lam**2 - 2*lam - 1 does, lam - 1/2 does not.

Without square roots an expression is N/D with integer polynomials N, D whose degrees and coefficients `Size` bounds,
for every part of it too. So one evaluation decides:

- Kronecker's substitution, a proof. With abs(coefficients) summing to at most 2**b and degrees at most d, put
  x_k = 2**((b + 1) (d + 1)**k). Different monomials fall on different powers of 2**(b + 1), and the highest one
  outweighs all others together, so a polynomial that vanishes there vanishes identically.
- Where those numbers grow too long, one random point modulo a Mersenne prime above 2**b, which no coefficient is
  divisible by. A polynomial of degree d that is not zero vanishes there with probability at most d/p (Schwartz and
  Zippel), less than 10000/2**127. The point is drawn from a digest of the formula, so it cannot be aimed at.

With square roots it is a function of the parameters on their ranges, evaluated in complex balls at random rational
points: a ball without 0 proves that it does not vanish. If every ball holds 0, at 400 bits and more, it counts as
zero; only a formula that vanishes to 120 digits at three random points and not identically would be misjudged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from itertools import islice
from math import ceil
from typing import TYPE_CHECKING

from gks.scheme.expression import Expr
from gks.scheme.limits import MAX_BITS

if TYPE_CHECKING:
    from flint import acb, arb

Range = tuple[Fraction | None, Fraction | None]

# Exponents of Mersenne primes 2**q - 1, from well above 61 bits to past every coefficient an expression may have.
_MERSENNE = (
    127, 521, 607, 1279, 2203, 2281, 3217, 4253, 4423, 9689, 9941, 11213, 19937, 21701, 23209, 44497, 86243, 110503,
    132049, 216091,
)  # fmt: skip
assert _MERSENNE[-1] > MAX_BITS

# Longest integers of the Kronecker point: a product of two takes about 10 microseconds.
_KRONECKER_BITS = 4_096

_BALL_BITS = 400  # to which a formula with square roots must vanish at each point
_MOST_BALL_BITS = 40_000  # spent on cancellation between long coefficients or high powers
_POINTS = 3


def identically_zero(expr: Expr, ranges: Mapping[str, Range]) -> bool:
    """See the module. `ranges` are the open ranges of the symbols, (0, oo) where missing; None is an infinite end.

    Raises ZeroDivisionError if a denominator is identically zero.
    """
    return any(_vanishes(part, ranges) for part in _factors(expr))


def test_work(expr: Expr) -> float:
    """About how long `identically_zero` takes, in nanoseconds; where there are few powers an overestimate.

    A power takes up to 40 products. Long integers multiply in time b**1.6 (Karatsuba), measured 4 ns times (b/30)**1.6;
    balls multiply faster, square roots and conversions take their share.
    """
    work = 0.0
    for part in _factors(expr):
        written = part.size.written
        if part.op == "num":
            work += 1_000
        elif not part.rational:
            work += 300_000 + written * _POINTS * (3_000 + 100 * pow(_ball_precision(part) / 64, 1.3))
        elif _kronecker_bits(part) <= _KRONECKER_BITS:
            work += 30_000 + 8_000 * written
        else:
            work += 60_000 + 40 * written * (200 + 4 * pow((part.size.bits + 128) / 30, 1.6))
    return work


def _kronecker_bits(expr: Expr) -> int:
    """How long Kronecker's integers are; too long in any case with over 12 symbols."""
    spread: int = (expr.size.degree + 1) ** min(len(expr.symbols), 12)
    return (ceil(expr.size.bits) + 1) * spread


def _ball_precision(expr: Expr) -> int:
    """In bits: a drawn coordinate has about 128, and as many may cancel in each of its powers."""
    return _BALL_BITS + min(ceil(expr.size.bits) + 128 * expr.size.degree, _MOST_BALL_BITS)


def _factors(expr: Expr) -> Iterator[Expr]:
    """Numbers and sums one of which must vanish for the expression to vanish."""
    stack = [expr]
    seen: set[int] = set()
    while stack:
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if node.op in ("mul", "sqrt") or (node.op == "pow" and node.exponent > 0):
            stack.extend(node.args)
        elif node.op not in ("sym", "pow"):
            yield node


def _vanishes(part: Expr, ranges: Mapping[str, Range]) -> bool:
    if part.op == "num":
        return not part.value
    if part.rational:
        return _rational_vanishes(part)
    return _ball_vanishes(part, ranges)


# --- without square roots ------------------------------------------------------------------------------------------


def _rational_vanishes(part: Expr) -> bool:
    names = sorted(part.symbols)
    bits, spread = ceil(part.size.bits) + 1, part.size.degree + 1
    if _kronecker_bits(part) <= _KRONECKER_BITS:
        point = {name: 1 << bits * spread**k for k, name in enumerate(names)}
        numerator, denominator = part.fold(_Quotients(point, lambda value: value))
    else:
        q = next(q for q in _MERSENNE if q > bits)
        point = _point_of_the_formula(part, names, q - 1)
        numerator, denominator = part.fold(_Quotients(point, _modulo_mersenne(q)))
    if not denominator:
        raise ZeroDivisionError("division by zero")
    return not numerator


def _point_of_the_formula(part: Expr, names: Sequence[str], bits: int) -> dict[str, int]:
    """Coordinates of that many bits from a digest of the formula: the same in every run, and not to be aimed at."""
    from random import Random  # imported late: seldom needed

    source = Random(part.fold(_Digest()))
    return {name: source.getrandbits(bits) for name in names}


class _Digest:
    """A digest of the whole formula, with every number and name in it."""

    def number(self, value: Fraction) -> bytes:
        return self._of(f"number {value.numerator:x}/{value.denominator:x}".encode())

    def symbol(self, name: str) -> bytes:
        return self._of(b"symbol " + name.encode())

    def add(self, terms: Sequence[bytes]) -> bytes:
        return self._of(b"add", *terms)

    def mul(self, factors: Sequence[bytes]) -> bytes:
        return self._of(b"mul", *factors)

    def power(self, base: bytes, exponent: int) -> bytes:
        return self._of(b"power %d" % exponent, base)

    def sqrt(self, radicand: bytes) -> bytes:
        return self._of(b"sqrt", radicand)

    def _of(self, *parts: bytes) -> bytes:
        from hashlib import blake2b

        return blake2b(b"".join(parts)).digest()


def _modulo_mersenne(q: int) -> Callable[[int], int]:
    prime = (1 << q) - 1

    def reduce(value: int) -> int:
        """value modulo 2**q - 1, by adding up its q-bit digits: linear where % is quadratic."""
        sign = -1 if value < 0 else 1
        value = abs(value)
        while value > prime:
            value = (value & prime) + (value >> q)
        return 0 if value == prime else sign * value

    return reduce


Quotient = tuple[int, int]


class _Quotients:
    """Numerator and denominator apart and never cancelled, in the integers or modulo a prime."""

    def __init__(self, point: Mapping[str, int], reduce: Callable[[int], int]) -> None:
        self.point = point
        self.reduce = reduce

    def number(self, value: Fraction) -> Quotient:
        return self.reduce(value.numerator), self.reduce(value.denominator)

    def symbol(self, name: str) -> Quotient:
        return self.point[name], 1

    def add(self, terms: Sequence[Quotient]) -> Quotient:
        return _balanced(terms, self._sum)

    def mul(self, factors: Sequence[Quotient]) -> Quotient:
        return _balanced(factors, self._product)

    def power(self, base: Quotient, exponent: int) -> Quotient:
        result: Quotient = (1, 1)
        for bit in bin(abs(exponent))[2:]:
            result = self._product(result, result)
            if bit == "1":
                result = self._product(result, base)
        return result if exponent > 0 else (result[1], result[0])

    def sqrt(self, radicand: Quotient) -> Quotient:
        raise TypeError("a square root has no value here")

    def _sum(self, a: Quotient, b: Quotient) -> Quotient:
        if a[1] == b[1] == 1:
            return self.reduce(a[0] + b[0]), 1
        return self.reduce(a[0] * b[1] + b[0] * a[1]), self.reduce(a[1] * b[1])

    def _product(self, a: Quotient, b: Quotient) -> Quotient:
        if a[1] == b[1] == 1:
            return self.reduce(a[0] * b[0]), 1
        return self.reduce(a[0] * b[0]), self.reduce(a[1] * b[1])


def _balanced(parts: Sequence[Quotient], combine: Callable[[Quotient, Quotient], Quotient]) -> Quotient:
    """Combine neighbours pairwise, then the results, and so on: long operands meet only at the end."""
    row = list(parts)
    while len(row) > 1:
        paired = [combine(row[k], row[k + 1]) for k in range(0, len(row) - 1, 2)]
        row = paired + row[2 * len(paired) :]
    return row[0]


# --- with square roots ---------------------------------------------------------------------------------------------


def _ball_vanishes(part: Expr, ranges: Mapping[str, Range]) -> bool:
    import flint

    finite = 0
    with flint.ctx.workprec(_ball_precision(part)):
        for values in _points(part.symbols, ranges):
            ball = part.fold(_Balls(values))
            if not ball.is_finite():
                continue
            if not ball.contains(0):
                return False
            finite += 1
            if finite == _POINTS:
                break
    if not finite:
        raise ZeroDivisionError("division by zero")
    return True


def _points(names: frozenset[str], ranges: Mapping[str, Range]) -> Iterator[dict[str, Fraction]]:
    from gks.scheme.generic import generic_points
    from gks.scheme.model import Parameter

    whole = (Fraction(0), None)
    drawn = [Parameter(name, None, None, *ranges.get(name, whole), True, "") for name in sorted(names)]
    return islice(generic_points(drawn), 4 * _POINTS)


class _Balls:
    """Complex balls at rational values; square roots are principal."""

    def __init__(self, values: Mapping[str, Fraction]) -> None:
        self.values = values

    def number(self, value: Fraction) -> acb:
        import flint

        return flint.acb(flint.arb(flint.fmpq(value.numerator, value.denominator)))

    def symbol(self, name: str) -> acb:
        return self.number(self.values[name])

    def add(self, terms: Sequence[acb]) -> acb:
        return sum(terms[1:], terms[0])

    def mul(self, factors: Sequence[acb]) -> acb:
        product = factors[0]
        for factor in factors[1:]:
            product = product * factor
        return product

    def power(self, base: acb, exponent: int) -> acb:
        return base**exponent

    def sqrt(self, radicand: acb) -> acb:
        return radicand.sqrt()

    def minimum(self, values: Sequence[acb]) -> acb:
        """Of real numbers; of anything else, not a number."""
        return self._extremum(values, lambda a, b: a.min(b))

    def maximum(self, values: Sequence[acb]) -> acb:
        """Of real numbers; of anything else, not a number."""
        return self._extremum(values, lambda a, b: a.max(b))

    def _extremum(self, values: Sequence[acb], choose: Callable[[arb, arb], arb]) -> acb:
        import flint

        if any(value.imag != 0 for value in values):
            return flint.acb("nan")
        return flint.acb(reduce(choose, (value.real for value in values)))
