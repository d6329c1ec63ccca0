"""The exact rank of a matrix of algebraic numbers given by balls at any precision.

A pivot that a ball keeps away from 0 is nonzero. What elimination leaves when no pivot is certain is a quotient of
minors; each minor is an algebraic number whose conjugates and denominators are bounded (``zero_exponent``), so it is
either 0 or larger than 2**-zero_exponent: once the balls lie below that, the rest is 0 exactly.
"""

from __future__ import annotations

from collections.abc import Callable

from flint import acb, arb, ctx, fmpq

from gks.modes.algebraic import GUARD_BITS, START_BITS
from gks.modes.undecided import Undecided

Matrix = list[list[acb]]

RANK_BITS = 1 << 16
"""Precision beyond which a zero test is given up: a few seconds for the small matrices met here."""


def ball_rank(matrix: Matrix) -> int | None:
    """The rank where certain pivots use up all rows or columns, at the precision in force; None where some are left."""
    rank, rest = _eliminate(matrix)
    return rank if rest is None else None


def pivots(matrix: Matrix) -> int:
    """How many pivots balls keep away from 0, at the precision in force: the rank is no smaller."""
    return _eliminate(matrix)[0]


def certain_rank(matrix_at: Callable[[int], Matrix], most: int) -> int | None:
    """The rank where pivots that ``most`` bits keep away from 0 use up all rows or columns; None where some are
    left.
    """
    bits = START_BITS
    while bits <= most:
        with ctx.workprec(bits + GUARD_BITS):
            rank = ball_rank(matrix_at(bits))
        if rank is not None:
            return rank
        bits *= 2
    return None


def exact_rank(
    matrix_at: Callable[[int], Matrix], zero_exponent: Callable[[], float], *, ceiling: int | None = None
) -> int:
    """The rank of the matrix that ``matrix_at(bits)`` encloses ever more sharply; Undecided beyond RANK_BITS.

    ``ceiling`` is a rank known not to be exceeded: pivots that reach it are the proof.
    """
    bits = START_BITS
    exponent: float | None = None
    while bits <= RANK_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            rank, rest = _eliminate(matrix_at(bits))
            if rest is None or rank == ceiling:
                return rank
            if bits > START_BITS:
                exponent = zero_exponent() if exponent is None else exponent
                if rest < arb(fmpq(1, 2)) ** int(exponent + 1):
                    return rank
        bits *= 2
        if exponent is not None and exponent <= RANK_BITS:
            bits = max(bits, int(exponent) + 2 * START_BITS)
    raise Undecided(f"whether a determinant vanishes needs more than {RANK_BITS} bits")


def _eliminate(matrix: Matrix) -> tuple[int, arb | None]:
    """Certain pivots taken, and the size of what is left (None where nothing is): full pivoting by magnitude."""
    rows = [list(row) for row in matrix]
    columns = len(rows[0]) if rows else 0
    free = list(range(columns))
    done = 0
    while free and done < len(rows):
        best: tuple[arb, int, int] | None = None
        for i in range(done, len(rows)):
            for j in free:
                if not rows[i][j].contains(0):
                    size = rows[i][j].abs_lower()
                    if best is None or size > best[0]:
                        best = (size, i, j)
        if best is None:
            left = [rows[i][j].abs_upper() for i in range(done, len(rows)) for j in free]
            return done, _largest(left)
        _, i, j = best
        rows[done], rows[i] = rows[i], rows[done]
        free.remove(j)
        pivot = rows[done]
        for i in range(done + 1, len(rows)):
            factor = rows[i][j] / pivot[j]
            rows[i] = [a - factor * b if k in free else a for k, (a, b) in enumerate(zip(rows[i], pivot, strict=True))]
        done += 1
    return done, None


def _largest(values: list[arb]) -> arb | None:
    top = values[0]
    for value in values[1:]:
        top = top.max(value)
    return top
