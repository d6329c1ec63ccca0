"""Exact linear algebra over the coefficient field: small matrices of Ratio.

Entries may hold adjoined irrational numbers, so "is it zero" is asked of the coefficient field (an exact test at the
numbers' values), never of the printed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import fmpz_mpoly

from gks.modes.coefficients import Coefficients, Ratio, common_denominator

Matrix = list[list[Ratio]]


def identity(size: int, coefficients: Coefficients) -> Matrix:
    """The unit matrix."""
    return [[coefficients.number(Fraction(int(i == j))) for j in range(size)] for i in range(size)]


def multiply(a: Matrix, b: Matrix, coefficients: Coefficients) -> Matrix:
    """The product a b."""
    return [
        [
            coefficients.add([a[i][k] * b[k][j] for k in range(len(b)) if not a[i][k].is_zero()])
            for j in range(len(b[0]))
        ]
        for i in range(len(a))
    ]


def characteristic_polynomial(matrix: Matrix, coefficients: Coefficients) -> fmpz_mpoly:
    """det(x - A) up to a factor free of x, by Faddeev-LeVerrier."""
    size = len(matrix)
    powers = [coefficients.number(Fraction(1))]
    auxiliary = identity(size, coefficients)
    for k in range(1, size + 1):
        product = multiply(matrix, auxiliary, coefficients)
        trace = coefficients.add([product[i][i] for i in range(size)])
        powers.append(trace * coefficients.number(Fraction(-1, k)))
        auxiliary = [[e + powers[k] if i == j else e for j, e in enumerate(row)] for i, row in enumerate(product)]
    clear = common_denominator(powers, coefficients.context.constant(1))
    x = coefficients.gens["x"]
    total = coefficients.context.constant(0)
    for k, value in enumerate(powers):
        total += value.num * (clear / value.den) * x ** (size - k)
    return total


def _echelon(rows: Matrix, columns: int, coefficients: Coefficients) -> list[int]:
    """Reduces ``rows`` in place to reduced echelon form over the first ``columns``; returns the pivot columns."""
    pivots: list[int] = []
    for column in range(columns):
        row = len(pivots)
        pivot = next((i for i in range(row, len(rows)) if not coefficients.is_zero(rows[i][column].num)), None)
        if pivot is None:
            continue
        rows[row], rows[pivot] = rows[pivot], rows[row]
        inverse = coefficients.power(rows[row][column], -1)
        rows[row] = [entry * inverse for entry in rows[row]]
        for i in range(len(rows)):
            if i != row and not rows[i][column].is_zero():
                factor = rows[i][column]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[row], strict=True)]
        pivots.append(column)
    return pivots


def kernel(matrix: Matrix, coefficients: Coefficients) -> list[tuple[Ratio, ...]]:
    """A basis of the null space."""
    rows = [list(row) for row in matrix]
    size = len(rows[0])
    pivots = _echelon(rows, size, coefficients)
    basis: list[tuple[Ratio, ...]] = []
    for free in (c for c in range(size) if c not in pivots):
        vector = [coefficients.number(Fraction(int(c == free))) for c in range(size)]
        for row, column in enumerate(pivots):
            vector[column] = -rows[row][free]
        basis.append(tuple(vector))
    return basis


def solve(matrix: Matrix, right: Sequence[Sequence[Ratio]], coefficients: Coefficients) -> Matrix | None:
    """matrix**-1 right, None where the matrix is singular."""
    size = len(matrix)
    rows = [[*a, *b] for a, b in zip(matrix, right, strict=True)]
    if len(_echelon(rows, size, coefficients)) < size:
        return None
    return [row[size:] for row in rows]
