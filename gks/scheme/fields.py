"""The characteristic fields that one unknown carries, decided without computing an eigenvalue.

For a flux matrix A and the unit vector e_k, the annihilator m_k is the monic polynomial of least degree with
m_k(A) e_k = 0. Its roots are exactly the eigenvalues in whose eigenspaces e_k has a component, so for any function
f on the spectrum of a diagonalisable A, column k of f(A) vanishes iff f vanishes at every root of m_k. With
f = max(x, 0) this says which unknowns an upwind scheme reads from the left. Roots need only be counted by sign, which
exact arithmetic does (Sturm, Descartes): no eigenvalue, no tolerance.

Numbers are Fractions, or real balls (`flint.arb`) where an entry of A is irrational; a ball that holds zero counts as
zero, so with balls a nonzero value below the precision would be missed (the callers draw generic points at 1024 bits).
Polynomials are lists, ascending, without trailing zeros.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from flint import arb

Number = Any  # Fraction or arb: the same operators, and no common type that says so
Polynomial = list[Number]
Matrix = Sequence[Sequence[Number]]


def annihilator(matrix: Matrix, column: int) -> Polynomial:
    """The monic polynomial m of least degree with m(A) e_column = 0, from the first dependent Krylov vector.

    Each Krylov vector is reduced by the earlier ones while the combination that was taken is recorded beside it.
    """
    size = len(matrix)
    number = type(matrix[0][0])
    vector: list[Number] = [number(int(row == column)) for row in range(size)]
    basis: list[tuple[int, list[Number], Polynomial]] = []  # pivot row, reduced vector, its polynomial in A
    for degree in range(size + 1):
        reduced, record = list(vector), [number(0)] * degree + [number(1)]
        for pivot, known, combination in basis:
            factor = reduced[pivot] / known[pivot]
            reduced = [a - factor * b for a, b in zip(reduced, known, strict=True)]
            reduced[pivot] = number(0)
            record = _minus(record, factor, combination, 0)
        pivots = [row for row in range(size) if not is_zero(reduced[row])]
        if not pivots:
            return _trimmed(record)
        basis.append((pivots[0], reduced, record))
        vector = [sum((a * b for a, b in zip(row, vector, strict=True)), number(0)) for row in matrix]
    raise ArithmeticError("size + 1 vectors of that size are dependent")


def roots_real_and_simple(polynomial: Polynomial) -> bool:
    """Whether all roots are real and simple: by Sturm, sign changes from -oo to oo equal to the degree."""
    chain = [polynomial, _derivative(polynomial)]
    while len(chain[-1]) > 1:
        chain.append([-c for c in _divide(chain[-2], chain[-1])[1]])
    right = [sign(p[-1]) for p in chain if p]
    left = [s if len(p) % 2 else -s for s, p in zip(right, (p for p in chain if p), strict=True)]
    return _changes(left) - _changes(right) == len(polynomial) - 1


def has_root(polynomial: Polynomial, positive: bool) -> bool:
    """Whether a polynomial with real roots only has a positive (or a negative) one: Descartes' rule is then exact."""
    signs = [sign(c) if positive or power % 2 == 0 else -sign(c) for power, c in enumerate(polynomial)]
    return _changes(signs) > 0


def without_common_roots(polynomial: Polynomial, other: Polynomial) -> Polynomial:
    """A polynomial with simple roots, less those it shares with `other` (none are left if other = 0)."""
    first, second = polynomial, _trimmed(list(other))
    while second:
        first, second = second, _divide(first, second)[1]
    return _divide(polynomial, first)[0]


def is_zero(value: Number) -> bool:
    """Exactly zero, or a ball that holds zero."""
    return value == 0 if isinstance(value, Fraction) else bool(value.contains(0))


def sign(value: Number) -> int:
    """-1, 0 or 1, with zero as `is_zero` has it."""
    return 0 if is_zero(value) else (1 if value > 0 else -1)


class BallAlgebra:
    """Evaluates an expression in balls (see `Expr.fold`) at rational values; nan where a root or quotient has none."""

    def __init__(self, values: Mapping[str, Fraction]) -> None:
        self.values = values

    def number(self, value: Fraction) -> arb:
        import flint

        return flint.arb(flint.fmpq(value.numerator, value.denominator))

    def symbol(self, name: str) -> arb:
        return self.number(self.values[name])

    def add(self, terms: Sequence[arb]) -> arb:
        return sum(terms, self.number(Fraction(0)))

    def mul(self, factors: Sequence[arb]) -> arb:
        return math.prod(factors, start=self.number(Fraction(1)))

    def power(self, base: arb, exponent: int) -> arb:
        return base**exponent

    def sqrt(self, value: arb) -> arb:
        return value.sqrt()


def to_balls(polynomial: Sequence[Number]) -> Polynomial:
    """Fractions as balls at the precision in force."""
    ball = BallAlgebra({})
    return [ball.number(c) for c in polynomial]


def roots_text(polynomial: Polynomial) -> list[str]:
    """The distinct roots to six digits, for a message."""
    import flint

    rational = [c if isinstance(c, Fraction) else _midpoint(c) for c in polynomial]
    exact = flint.fmpq_poly([flint.fmpq(c.numerator, c.denominator) for c in rational])
    found: list[tuple[Any, int]] = exact.complex_roots()  # type: ignore[assignment]  # the stubs leave out the multiplicity
    return [str(root.str(6, radius=False)) for root, _ in found]


def _midpoint(ball: arb) -> Fraction:
    mantissa, exponent = ball.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _changes(signs: Sequence[int]) -> int:
    kept = [s for s in signs if s]
    return sum(a != b for a, b in pairwise(kept))


def _derivative(polynomial: Polynomial) -> Polynomial:
    return [power * c for power, c in enumerate(polynomial)][1:]


def _divide(numerator: Polynomial, denominator: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder."""
    remainder = list(numerator)
    quotient: Polynomial = []
    for shift in range(len(numerator) - len(denominator), -1, -1):
        factor = remainder[-1] / denominator[-1]
        quotient.append(factor)
        remainder = _minus(remainder, factor, denominator, shift)[:-1]
    return quotient[::-1], _trimmed(remainder)


def _minus(polynomial: Polynomial, factor: Number, other: Polynomial, shift: int) -> Polynomial:
    """polynomial - factor * x**shift * other, of the same length as polynomial."""
    result = list(polynomial)
    for power, c in enumerate(other):
        result[power + shift] -= factor * c
    return result


def _trimmed(polynomial: Polynomial) -> Polynomial:
    while polynomial and is_zero(polynomial[-1]):
        polynomial = polynomial[:-1]
    return polynomial
