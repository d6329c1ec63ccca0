"""The finite problem: the half-lines cut at given numbers of cells, as sparse level matrices.

State vectors are flat; `Layout` says which entry is which grid value. Past its last cell a half-line is held at zero,
an end that is right as long as nothing has reached it (see `farends`). Entries for grid values that no equation reads
or gives are held at zero too, so every matrix is square.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from gks.solvers.problem import Problem, Row, Slot, build

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    from gks.scheme.model import Scheme

    Array = NDArray[Any]
    Matrix = NDArray[numpy.float64]


@dataclass(frozen=True, slots=True)
class Layout:
    """Where grid values stand in a flat state: one block (unknowns, width) a side, places from low[side] outward.

    cells : places first..cells-1 of each side are advanced by the interior; those from `cells` on are held at zero.
    """

    problem: Problem
    cells: tuple[int, ...]
    low: tuple[int, ...]
    width: tuple[int, ...]
    base: tuple[int, ...]
    size: int

    def index(self, slot: Slot) -> int:
        """The entry of a grid value. Raises IndexError for one outside the blocks."""
        column = slot.place - self.low[slot.side]
        if not 0 <= column < self.width[slot.side]:
            raise IndexError(f"{slot} lies outside the {self.cells[slot.side]} cells")
        return self.base[slot.side] + slot.unknown * self.width[slot.side] + column

    def block(self, state: Array, side: int) -> Array:
        """The view (unknowns, width) of one side in a flat state."""
        unknowns = len(self.problem.sides[side].unknowns)
        start, width = self.base[side], self.width[side]
        return state[start : start + unknowns * width].reshape(unknowns, width)

    def near(self, depth: int) -> list[Slot]:
        """The boundary unknowns and the first `depth` cells of every unknown."""
        cells = [
            Slot(number, unknown, place)
            for number, side in enumerate(self.problem.sides)
            for unknown in range(len(side.unknowns))
            for place in range(side.first, min(side.first + depth, self.cells[number]))
        ]
        return [*self.problem.ghosts, *cells]


def layout(problem: Problem, cells: Sequence[int]) -> Layout:
    """The layout for so many cells a side, at least as many as the closure involves."""
    low, width, base, size = [], [], [], 0
    counts = tuple(max(count, problem.near + 1) for count in cells)
    ghosts = problem.ghosts
    for number, side in enumerate(problem.sides):
        lowest = [ghost.place for ghost in ghosts if ghost.side == number]
        low.append(min([side.first - side.inward_reach, *lowest]))
        width.append(counts[number] + side.outward_reach - low[-1])
        base.append(size)
        size += len(side.unknowns) * width[-1]
    return Layout(problem, counts, tuple(low), tuple(width), tuple(base), size)


def level_matrices(grid: Layout) -> list[Any]:
    """Sparse A_0..A_depth (csr) with  sum_k A_k w[n+k] = 0,  one row for each entry of the state."""
    import numpy
    from scipy import sparse

    problem = grid.problem
    entries: list[tuple[list[Array], list[Array], list[Array]]] = [([], [], []) for _ in range(problem.depth + 1)]
    given = numpy.zeros(grid.size, dtype=bool)

    def put(level: int, rows: Array, columns: Array, value: float) -> None:
        entries[level][0].append(rows)
        entries[level][1].append(columns)
        entries[level][2].append(numpy.full(len(rows), value))

    for number, side in enumerate(problem.sides):
        span = numpy.arange(side.first, grid.cells[number])
        for unknown, row in enumerate(side.rows):
            rows = grid.index(Slot(number, unknown, side.first)) + span - side.first
            given[rows] = True
            for level, slot, value in row.terms:
                start = grid.index(Slot(number, slot.unknown, side.first)) - side.first + slot.place
                put(level, rows, start + span, value)
    for ghost, row in zip(problem.ghosts, problem.closure, strict=True):
        at = numpy.array([grid.index(ghost)])
        given[at] = True
        for level, slot, value in row.terms:
            put(level, at, numpy.array([grid.index(slot)]), value)
    idle = numpy.flatnonzero(~given)
    put(problem.depth, idle, idle, 1.0)
    shape = (grid.size, grid.size)
    matrices = []
    for rows_, columns_, values_ in entries:
        if rows_:
            triple = (numpy.concatenate(values_), (numpy.concatenate(rows_), numpy.concatenate(columns_)))
            matrices.append(sparse.csr_matrix(triple, shape=shape))
        else:
            matrices.append(sparse.csr_matrix(shape))
    return matrices


def constraints(grid: Layout) -> tuple[Array, Array]:
    """(columns, C): under stages every state must satisfy C state[columns] = 0; C has no rows otherwise."""
    import numpy

    rows: list[Row] = [row for row in grid.problem.closure if row.constraint]
    columns = sorted({grid.index(slot) for row in rows for _, slot, _ in row.terms})
    matrix = numpy.zeros((len(rows), len(columns)))
    for number, row in enumerate(rows):
        for _, slot, value in row.terms:
            matrix[number, columns.index(grid.index(slot))] += value
    return numpy.array(columns, dtype=int), matrix


def onto_constraints(grid: Layout, state: Array) -> Array:
    """The nearest state that satisfies the closure's equations without dt(...), and is zero where nothing is given."""
    import numpy

    result = state.copy()
    columns, matrix = constraints(grid)
    if len(matrix):
        correction = numpy.linalg.lstsq(matrix, matrix @ result[columns], rcond=None)[0]
        result[columns] -= correction
    return result


def update_matrix(scheme: Scheme, values: Mapping[str, Fraction], cells: int | Sequence[int]) -> Matrix:
    """The dense matrix of one step on `cells` cells a side, ends held at zero: companion form for several levels.

    Shape (depth * size, depth * size); entries that are always zero or follow from the closure add eigenvalues 0. Its
    eigenvalues with abs(z) > 1 tend to the admissible modes as cells grow, as kappa**(2 cells); those inside the circle
    also show the finite matrix's own, which are no modes. The slow second way for tests: O(size**3).
    """
    import numpy

    problem = build(scheme, values)
    counts = [cells] * len(problem.sides) if isinstance(cells, int) else list(cells)
    grid = layout(problem, counts)
    dense = [matrix.toarray() for matrix in level_matrices(grid)]
    lower = [numpy.linalg.solve(dense[-1], -matrix) for matrix in dense[:-1]]
    if problem.stages is not None:
        return _one_step(grid, lower[0])
    companion = numpy.zeros((grid.size * problem.depth, grid.size * problem.depth))
    companion[: -grid.size, grid.size :] = numpy.eye(grid.size * (problem.depth - 1))
    companion[-grid.size :] = numpy.hstack(lower)
    return companion


def _one_step(grid: Layout, rate: Matrix) -> Matrix:
    """R(lam F) or exp(lam F), on the states that satisfy the closure; 0 on the rest."""
    import numpy
    from scipy.linalg import expm

    stages, lam = grid.problem.stages, grid.problem.lam
    if stages is None:
        raise ValueError("one step without stages")
    if stages.kind == "exact":
        step = expm(lam * rate)
    else:
        step, power = numpy.zeros_like(rate), numpy.eye(grid.size)
        for coefficient in stages.stability:
            step += float(coefficient) * power
            power = power @ (lam * rate)
    allowed = numpy.eye(grid.size)
    columns, matrix = constraints(grid)
    if len(matrix):
        allowed[numpy.ix_(columns, columns)] -= numpy.linalg.pinv(matrix) @ matrix
    for number, side in enumerate(grid.problem.sides):
        for unknown in range(len(side.unknowns)):
            for place in range(grid.low[number], grid.low[number] + grid.width[number]):
                slot = Slot(number, unknown, place)
                idle = place >= grid.cells[number] or (place < side.first and slot not in grid.problem.ghosts)
                if idle:
                    allowed[:, grid.index(slot)] = 0.0
    result: Matrix = step @ allowed
    return result
