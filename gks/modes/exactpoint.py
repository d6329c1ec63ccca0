"""Delta at a rational point of the unit circle, by exact arithmetic on the part of it that is rational.

At z = 1 or z = -1 a scheme often has rational spatial roots (kappa = 1 or -1, and the ghost values' roots 0) beside
irrational ones, and the kernel of the Kreiss matrix, where there is one, often lies in their columns. For simple
rational roots x_j the branches x_j(sigma) are power series with rational coefficients, and so are their columns in the
Newton basis, which may begin with them. Then

- the kernel of these columns at the point is a kernel of the whole matrix, and all of it if balls prove the rank of the
  whole matrix to be no smaller;
- Delta vanishes at the point at least to the order to which all maximal minors of these columns vanish (expand along
  the other columns). An upper bound of the order is another module's matter: a count of zeros close by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, ctx, fmpq, fmpq_mat, fmpq_poly, fmpz_mpoly

from gks.modes.admissible import Admissible, Candidate, admissible, point_of
from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root
from gks.modes.fibre import FibreRoot, coefficients, univariate
from gks.modes.kreiss import Family, NormalModeProblem, closure_matrix
from gks.modes.undecided import Undecided
from gks.modes.verdict import ModeKind

KERNEL_BITS = 4 * START_BITS
"""Precision at which the rank of the whole matrix is bounded from below."""


@dataclass(frozen=True, slots=True)
class ExactPoint:
    """What Delta is at a candidate on the circle: ``order`` is a lower bound of its order of vanishing."""

    candidate: Candidate
    kind: ModeKind
    order: int
    families: tuple[Admissible, ...]


def exact_point(problem: NormalModeProblem, candidate: Candidate, most: int) -> ExactPoint:
    """Judges a candidate with a rational value of the variable on the unit circle; orders are counted up to ``most``.

    The kind is INADMISSIBLE where Delta is not zero. Raises Undecided where the kernel is not the rational columns'.
    """
    families = tuple(admissible(problem, family, candidate) for family in problem.families)
    certain = _certain_pivots(_ball_matrix(problem, candidate, families))
    if certain == problem.size:
        return ExactPoint(candidate, ModeKind.INADMISSIBLE, 0, families)
    series = [_Series(problem, family, candidate, most + 1) for family in problem.families]
    all_columns, strict = _columns(problem, candidate, families, series)
    kernel = _nullity(all_columns)
    if kernel < problem.size - certain or not kernel:
        raise Undecided("a determinant that vanishes to all digits was not proved to vanish")
    kind = ModeKind.EIGENVALUE if _nullity(strict) == kernel else ModeKind.GENERALIZED
    return ExactPoint(candidate, kind, _order(all_columns, most + 1), families)


# The whole matrix, in balls -------------------------------------------------------------------------------------------


def _ball_matrix(problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible]) -> list[list[acb]]:
    roots = []
    for block in problem.blocks:
        family = families[block.family]
        roots.append([Root.of(0)] * block.zeros + family.strictly() + family.on_circle())
    with ctx.workprec(KERNEL_BITS + GUARD_BITS):
        return closure_matrix(problem, point_of(problem, candidate), roots, KERNEL_BITS)


def _certain_pivots(matrix: list[list[acb]]) -> int:
    """How many pivots balls keep away from 0."""
    with ctx.workprec(KERNEL_BITS + GUARD_BITS):
        rows = [list(row) for row in matrix]
        rank = 0
        while rows and rows[0]:
            live = [(i, j) for i, row in enumerate(rows) for j, entry in enumerate(row) if not entry.contains(0)]
            if not live:
                break
            i, j = max(live, key=lambda p: float(abs(rows[p[0]][p[1]]).mid()))
            pivot = rows.pop(i)
            rows = [
                [a - row[j] / pivot[j] * b for k, (a, b) in enumerate(zip(row, pivot, strict=True)) if k != j]
                for row in rows
            ]
            rank += 1
        return rank


# The rational columns -------------------------------------------------------------------------------------------------

Power = fmpq_poly
"""A power series in t = sigma - sigma_0, cut off."""


class _Series:
    """The branches of a family through rational roots, as series up to t**(length - 1)."""

    def __init__(self, problem: NormalModeProblem, family: Family, candidate: Candidate, length: int) -> None:
        self.length = length
        at = candidate.sigma.rational
        assert at is not None
        self.rational = not any(
            family.polynomial.degrees()[family.polynomial.context().variable_to_index(g.name)]
            for g in problem.coefficients.generators
        )
        self.parts = [
            _shifted(c, problem.variable, at, length) if self.rational else fmpq_poly([])
            for c in coefficients(family.polynomial, "x")
        ]

    def through(self, root: FibreRoot) -> Power | None:
        """The branch that begins at a simple rational root; None for other roots."""
        start = root.root.rational
        if start is None or root.multiplicity > 1 or not self.rational:
            return None
        x = fmpq_poly([fmpq(start.numerator, start.denominator)])
        for _ in range(self.length.bit_length() + 1):  # Newton's iteration doubles the number of correct terms
            value, slope = fmpq_poly([]), fmpq_poly([])
            for c in reversed(self.parts):
                slope = (slope * x + value).truncate(self.length)
                value = (value * x + c).truncate(self.length)
            x = (x - value * _inverse(slope, self.length)).truncate(self.length)
        return x


def _shifted(polynomial: fmpz_mpoly, variable: str, at: Fraction, length: int) -> Power:
    """A polynomial in the variable as a polynomial in t; Undecided where it holds irrational numbers."""
    try:
        direct = fmpq_poly(univariate(polynomial, variable))
    except ValueError:
        raise Undecided("the closure holds irrational numbers at a point where its determinant may vanish") from None
    return direct(fmpq_poly([fmpq(at.numerator, at.denominator), 1])).truncate(length)


def _inverse(series: Power, length: int) -> Power:
    """1/series, whose constant term is not 0."""
    found = [1 / series[0]]
    for n in range(1, length):
        found.append(-sum((series[k] * found[n - k] for k in range(1, n + 1)), fmpq(0)) / series[0])
    return fmpq_poly(found)


def _columns(
    problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible], series: Sequence[_Series]
) -> tuple[list[list[Power]], list[list[Power]]]:
    """The closure applied to the rational part of each block's Newton basis: all of it, and what decays strictly."""
    length = series[0].length
    every: list[list[Power]] = []
    strict: list[list[Power]] = []
    for k, block in enumerate(problem.blocks):
        found = families[block.family]
        mine = series[block.family]
        zero = fmpq_poly([])
        inside = [zero] * block.zeros + [
            s for r in found.inside if r.multiplicity == 1 and (s := mine.through(r)) is not None
        ]
        limiting = [s for r, _ in found.limiting if (s := mine.through(r)) is not None]
        for number, column in enumerate(_newton(inside + limiting, _reach(problem, k), length)):
            applied = _applied(problem, candidate, k, column, length)
            every.append(applied)
            if number < len(inside):
                strict.append(applied)
    return every, strict


def _reach(problem: NormalModeProblem, block: int) -> int:
    return 1 + max((t.n for row in problem.rows for t in row if t.block == block), default=-1)


def _newton(roots: Sequence[Power], count: int, length: int) -> list[list[Power]]:
    """Divided differences of x**n, as in `gks.modes.kreiss.newton_columns`, cut off."""
    columns: list[list[Power]] = []
    previous = [fmpq_poly([])] * count
    for j, root in enumerate(roots):
        column: list[Power] = []
        for n in range(count):
            if n == 0:
                column.append(fmpq_poly([0 if j else 1]))
            else:
                column.append(((previous[n - 1] if j else 0) + root * column[n - 1]).truncate(length))
        columns.append(column)
        previous = column
    return columns


def _applied(
    problem: NormalModeProblem, candidate: Candidate, block: int, column: Sequence[Power], length: int
) -> list[Power]:
    at = candidate.sigma.rational
    assert at is not None
    values = []
    for row in problem.rows:
        total = fmpq_poly([])
        for term in row:
            if term.block == block:
                weight = _shifted(term.coefficient, problem.variable, at, length)
                total += (weight * column[term.n]).truncate(length)
        values.append(total)
    return values


def _nullity(columns: Sequence[Sequence[Power]]) -> int:
    """The dimension of the kernel at t = 0."""
    if not columns:
        return 0
    matrix = fmpq_mat([[entry[0] for entry in column] for column in columns])
    return len(columns) - int(matrix.rank())


def _order(columns: Sequence[Sequence[Power]], length: int) -> int:
    """The lowest order to which a maximal minor vanishes (at most ``length``), by pivots of lowest order."""
    rows = [list(column) for column in columns]
    total = 0
    while rows:
        orders = [(_valuation(e, length), i, j) for i, row in enumerate(rows) for j, e in enumerate(row)]
        order, i, j = min(orders)
        total += order
        if total >= length:
            return length
        pivot = rows.pop(i)
        unit = _inverse(fmpq_poly(list(pivot[j])[order:]), length)
        rows = [_reduced(row, pivot, j, order, unit, length) for row in rows]
    return total


def _reduced(row: list[Power], pivot: list[Power], j: int, order: int, unit: Power, length: int) -> list[Power]:
    factor = (fmpq_poly(list(row[j])[order:]) * unit).truncate(length)
    return [(a - factor * b).truncate(length) for k, (a, b) in enumerate(zip(row, pivot, strict=True)) if k != j]


def _valuation(series: Power, length: int) -> int:
    return next((k for k, c in enumerate(list(series)) if c), length)


def rational_candidate(problem: NormalModeProblem, z: int) -> Candidate | None:
    """The candidate z = 1 or z = -1 with a rational value of the variable; None where there is none."""
    if problem.variable == "z":
        return Candidate(Root.of(z), Root.of(z), 1, Position.ON)
    if z == 1:
        one = None if problem.time_map is None else Root.of(1)
        return Candidate(Root.of(0), one, 1, Position.ON)
    return None
