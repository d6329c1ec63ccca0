"""Determinants of small polynomial matrices, without fractions."""

from __future__ import annotations

from collections.abc import Sequence

from flint import fmpz_mpoly


def determinant(matrix: Sequence[Sequence[fmpz_mpoly]], one: fmpz_mpoly) -> fmpz_mpoly:
    """Bareiss elimination, exact division at every step; the smallest entry of the first live column is the pivot.

    Closure matrices are sparse: rows with a single entry come off first by expansion, which keeps the polynomials
    small.
    """
    rows = [list(row) for row in matrix]
    factor = one
    while rows:
        single = next((i for i, row in enumerate(rows) if sum(not e.is_zero() for e in row) <= 1), None)
        if single is None:
            break
        column = next((j for j, e in enumerate(rows[single]) if not e.is_zero()), None)
        if column is None:
            return one * 0
        factor = factor * rows[single][column] * (-1) ** (single + column)
        rows = [[e for j, e in enumerate(row) if j != column] for i, row in enumerate(rows) if i != single]
    return factor * _bareiss(rows, one)


def _bareiss(rows: list[list[fmpz_mpoly]], one: fmpz_mpoly) -> fmpz_mpoly:
    size = len(rows)
    previous, sign = one, 1
    for k in range(size):
        live = [i for i in range(k, size) if not rows[i][k].is_zero()]
        if not live:
            return one * 0
        pivot = min(live, key=lambda i: len(rows[i][k]))
        if pivot != k:
            rows[k], rows[pivot] = rows[pivot], rows[k]
            sign = -sign
        for i in range(k + 1, size):
            for j in range(k + 1, size):
                rows[i][j] = (rows[i][j] * rows[k][k] - rows[i][k] * rows[k][j]) / previous
        previous = rows[k][k]
    return sign * previous
