"""The checker's own ring: polynomials in p, lam, s, z, x and the spatial roots, and their quotients."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isqrt, prod

from flint import Ordering, acb, fmpq_mpoly_ctx, fmpz_mpoly, fmpz_mpoly_ctx

from gks.bounds.checkformula import Rejected, read

MOST_ROOTS = 6
RING = fmpz_mpoly_ctx.get(("p", "lam", "s", "z", "x", *(f"k{i}" for i in range(MOST_ROOTS))), Ordering.lex)
RATIONAL = fmpq_mpoly_ctx.get(RING.names(), Ordering.lex)
GEN = dict(zip(RING.names(), RING.gens(), strict=True))
ONE, ZERO = RING.constant(1), RING.constant(0)


class Unsupported(Exception):
    """A scheme beyond this checker."""


@dataclass(frozen=True, slots=True)
class Fr:
    """A rational function; the denominator is not zero."""

    num: fmpz_mpoly
    den: fmpz_mpoly

    @staticmethod
    def of(num: fmpz_mpoly, den: fmpz_mpoly = ONE) -> Fr:
        if den.is_zero():
            raise Unsupported("a formula divides by zero")
        common = num.gcd(den)
        return Fr(num / common, den / common)

    def __add__(self, other: Fr) -> Fr:
        return Fr.of(self.num * other.den + other.num * self.den, self.den * other.den)

    def __sub__(self, other: Fr) -> Fr:
        return self + Fr(-other.num, other.den)

    def __neg__(self) -> Fr:
        return Fr(-self.num, self.den)

    def __mul__(self, other: Fr) -> Fr:
        return Fr.of(self.num * other.num, self.den * other.den)

    def __truediv__(self, other: Fr) -> Fr:
        return Fr.of(self.num * other.den, self.den * other.num)

    def __pow__(self, exponent: int) -> Fr:
        return (
            Fr(self.num**exponent, self.den**exponent)
            if exponent >= 0
            else Fr.of(self.den**-exponent, self.num**-exponent)
        )

    @property
    def zero(self) -> bool:
        return bool(self.num.is_zero())


def constant(value: Fraction | int) -> Fr:
    """A rational number in the ring's quotients."""
    exact = Fraction(value)
    return Fr(RING.constant(exact.numerator), RING.constant(exact.denominator))


class Values:
    """The algebra of the scheme's formulas: p and lam stay symbols; divisors are recorded."""

    def __init__(self, names: Mapping[str, Fr]) -> None:
        self.names = names
        self.divisors: list[fmpz_mpoly] = []

    def number(self, value: Fraction) -> Fr:
        return constant(value)

    def symbol(self, name: str) -> Fr:
        return self.names[name]

    def add(self, terms: Sequence[Fr]) -> Fr:
        return sum(terms, constant(0))

    def mul(self, factors: Sequence[Fr]) -> Fr:
        return prod(factors, start=constant(1))

    def power(self, base: Fr, exponent: int) -> Fr:
        if exponent < 0:
            self.divisors.append(base.num)
        return base**exponent

    def sqrt(self, radicand: Fr) -> Fr:
        parts = [radicand.num, radicand.den]
        if all(part.is_constant() for part in parts):
            numbers = [int(part.leading_coefficient()) if not part.is_zero() else 0 for part in parts]
            if all(isqrt(abs(n)) ** 2 == n for n in numbers):
                return constant(Fraction(isqrt(numbers[0]), isqrt(numbers[1])))
        raise Unsupported("irrational numbers")


def degree(polynomial: fmpz_mpoly, name: str) -> int:
    """The degree in one variable."""
    return max(0, int(polynomial.degrees()[RING.variable_to_index(name)]))


def parts_of(polynomial: fmpz_mpoly, name: str) -> list[fmpz_mpoly]:
    """Coefficients of name**0, name**1, ..."""
    k = RING.variable_to_index(name)
    parts: list[dict[tuple[int, ...], int]] = [{} for _ in range(degree(polynomial, name) + 1)]
    for powers, c in polynomial.to_dict().items():
        parts[int(powers[k])][(*powers[:k], 0, *powers[k + 1 :])] = int(c)
    return [RING.from_dict(part) for part in parts]


def put(polynomial: fmpz_mpoly, name: str, value: Fraction) -> fmpz_mpoly:
    """A rational put in for one variable, denominators cleared."""
    parts = parts_of(polynomial, name)
    top = len(parts) - 1
    return sum((c * (value.numerator**k * value.denominator ** (top - k)) for k, c in enumerate(parts)), ZERO)


def mirror(polynomial: fmpz_mpoly, *names: str) -> fmpz_mpoly:
    """Each named variable replaced by its inverse, cleared."""
    for name in names:
        parts = parts_of(polynomial, name)
        polynomial = sum((c * GEN[name] ** (len(parts) - 1 - k) for k, c in enumerate(parts)), ZERO)
    return polynomial


def factors(polynomial: fmpz_mpoly) -> list[tuple[fmpz_mpoly, int]]:
    """Irreducible factors, leading coefficient positive."""
    if polynomial.is_zero():
        return []
    # Over the rationals: python-flint sorts integer factors by coefficients that have to fit into a machine word.
    twins = RATIONAL.from_dict(polynomial.to_dict()).factor()[1]
    found = [(RING.from_dict({powers: int(c.p) for powers, c in f.to_dict().items()}), int(m)) for f, m in twins]
    return [(-f if f.leading_coefficient() < 0 else f, m) for f, m in found]


def enclose(polynomial: fmpz_mpoly, at: Mapping[str, acb]) -> acb:
    """A ball around the value at balls for every variable that occurs."""
    total = acb(0)
    names = RING.names()
    for powers, c in polynomial.to_dict().items():
        term = acb(int(c))
        for name, power in zip(names, powers, strict=True):
            if power:
                term *= at[name] ** int(power)
        total += term
    return total


def determinant(matrix: list[list[Fr]]) -> Fr:
    """By the first row."""
    if not matrix:
        return constant(1)
    total = constant(0)
    for j, entry in enumerate(matrix[0]):
        if not entry.zero:
            minor = determinant([[v for k, v in enumerate(row) if k != j] for row in matrix[1:]])
            total = total + entry * minor * constant((-1) ** j)
    return total


def polynomial(text: object, names: Mapping[str, str]) -> fmpz_mpoly:
    """A polynomial of a certificate; ``names`` maps what it calls its variables to those of the ring."""
    value: Fr = read(text, _Integers(), {name: Fr(GEN[own], ONE) for name, own in names.items()})
    if not value.den.is_one():
        raise Rejected(f"{text!r} is no polynomial with integer coefficients")
    return value.num


def irreducible(text: object, names: Mapping[str, str]) -> fmpz_mpoly:
    """An irreducible polynomial in lowest terms, leading coefficient positive."""
    found = polynomial(text, names)
    if factors(found) != [(found, 1)]:
        raise Rejected(f"{text!r} is not irreducible, or not in lowest terms")
    return found


class _Integers:
    def integer(self, value: int) -> Fr:
        return constant(value)

    def sqrt(self, value: object) -> object:
        raise Rejected("a square root in a polynomial")
