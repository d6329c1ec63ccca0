"""The newest level of the finite problem from the levels below it, or w' from w (see `problem`).

Explicitly by array slices where the newest level stands only at the cell itself, otherwise by a sparse LU
factorisation made once. Both refuse a closure that does not determine the newest level.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

from gks.errors import NotAnalysable
from gks.solvers.matrices import Layout, level_matrices
from gks.solvers.problem import Problem, Side, Slot

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]


class Relation(Protocol):
    """The newest level of the finite problem from the `depth` levels below it (oldest first)."""

    def newest(self, levels: Sequence[Array], out: Array, source: Array | None = None) -> Array:
        """Fill `out`; `source` is added to the cells before, and to the boundary unknowns after the closure."""
        ...


def undetermined() -> NotAnalysable:
    """The error of a closure that does not determine the newest level at these parameters (a mode at z = oo)."""
    return NotAnalysable(
        message="at these parameters the closure and the interior do not determine the next level",
        expected="a closure that gives every boundary unknown (it is unstable, with z = oo)",
        mend="march at other parameter values",
    )


def relation(grid: Layout, dtype: type = float) -> Relation:
    """Explicit where the newest level stands only at the cell itself, implicit otherwise."""
    return Explicit(grid, dtype) if is_local(grid.problem) else Implicit(grid, dtype)


def is_local(problem: Problem) -> bool:
    """Whether the interior's newest level stands only at the cell itself."""
    return all(
        slot.place == 0
        for side in problem.sides
        for row in side.rows
        for level, slot, value in row.terms
        if level == problem.depth and value != 0.0
    )


class Implicit:
    """A_depth factorised once (SuperLU), a sparse product for each older level."""

    def __init__(self, grid: Layout, dtype: type = float) -> None:
        import numpy
        from scipy.sparse.linalg import splu

        *self.lower, top = level_matrices(grid)
        # Rows are scaled by powers of two to one size: formulas may differ by hundreds of orders of magnitude.
        largest = abs(top).max(axis=1).toarray().ravel()
        if not largest.all():
            raise undetermined()
        self.scale = numpy.exp2(-numpy.rint(numpy.log2(largest)))
        top = top.multiply(self.scale[:, None]).tocsc()
        try:
            self.factors = splu(top.astype(dtype))
        except RuntimeError as cause:
            raise undetermined() from cause
        # A matrix singular to rounding returns the vector of ones with errors of order one, a regular one within cond
        # * eps.
        ones: Array = numpy.ones(grid.size, dtype=dtype)
        if not numpy.abs(self.factors.solve(top @ ones) - ones).max() < 1e-3:
            raise undetermined()

    def newest(self, levels: Sequence[Array], out: Array, source: Array | None = None) -> Array:
        """Solve A_depth w = -sum A_k w_k + source."""
        right = -(self.lower[0] @ levels[0])
        for matrix, level in zip(self.lower[1:], levels[1:], strict=True):
            right -= matrix @ level
        if source is not None:
            right += source
        out[:] = self.factors.solve(self.scale * right)
        return out


class Explicit:
    """Interior by slices, then the boundary unknowns by one small dense map of the values their equations hold."""

    def __init__(self, grid: Layout, dtype: type = float) -> None:
        self.grid = grid
        self.sweeps = [_sweep(grid, number) for number in range(len(grid.problem.sides))]
        self.scratch = [_scratch(grid, number, dtype) for number in range(len(grid.problem.sides))]
        self.ghosts, self.reads = _closure_map(grid)
        if dtype is complex:  # so that no product converts at every step
            self.reads = [(level, columns, matrix.astype(complex)) for level, columns, matrix in self.reads]

    def newest(self, levels: Sequence[Array], out: Array, source: Array | None = None) -> Array:
        """Cells first (each from older levels only), then the boundary unknowns."""
        import numpy

        grid, depth = self.grid, self.grid.problem.depth
        for number, (sweep, scratch) in enumerate(zip(self.sweeps, self.scratch, strict=True)):
            first = grid.problem.sides[number].first - grid.low[number]
            length = grid.cells[number] - grid.problem.sides[number].first
            old = [grid.block(level, number) for level in levels]
            new = grid.block(out, number)[:, first : first + length]
            for unknown, terms in enumerate(sweep):
                target = new[unknown]
                if not terms:
                    target[:] = 0.0
                for count, (level, column, shift, value) in enumerate(terms):
                    read = old[level][column, first + shift : first + shift + length]
                    if count == 0:
                        numpy.multiply(read, value, out=target)
                    else:
                        numpy.multiply(read, value, out=scratch)
                        numpy.add(target, scratch, out=target)
        if source is not None:
            out += source
        if len(self.ghosts):
            values = sum(matrix @ (out if level == depth else levels[level])[at] for level, at, matrix in self.reads)
            out[self.ghosts] = values if source is None else values + source[self.ghosts]
        return out


def _scratch(grid: Layout, number: int, dtype: type) -> Array:
    import numpy

    return numpy.empty(grid.cells[number] - grid.problem.sides[number].first, dtype=dtype)


def _sweep(grid: Layout, number: int) -> list[list[tuple[int, int, int, float]]]:
    """For each unknown of a side its terms (level, unknown read, offset, coefficient), solved for the newest level."""
    import numpy

    side: Side = grid.problem.sides[number]
    depth, size = grid.problem.depth, len(side.unknowns)
    blocks: dict[tuple[int, int], Array] = {}
    for equation, row in enumerate(side.rows):
        for level, slot, value in row.terms:
            block = blocks.setdefault((level, slot.place), numpy.zeros((size, size)))
            block[equation, slot.unknown] += value
    top = blocks.pop((depth, 0))
    if not _regular(top):
        raise undetermined()
    solved = {key: numpy.linalg.solve(top, -block) for key, block in blocks.items() if key[0] < depth}
    return [
        [
            (level, column, shift, float(block[unknown, column]))
            for (level, shift), block in sorted(solved.items())
            for column in range(size)
            if block[unknown, column] != 0.0
        ]
        for unknown in range(size)
    ]


def _closure_map(grid: Layout) -> tuple[Array, list[tuple[int, Array, Array]]]:
    """(ghost entries, [(level, entries, matrix)]): ghosts = sum over levels of matrix @ state[entries]."""
    import numpy

    problem = grid.problem
    position = {ghost: number for number, ghost in enumerate(problem.ghosts)}
    count = len(position)
    unknown = numpy.zeros((count, count))
    known: dict[int, dict[Slot, Array]] = {}
    for number, row in enumerate(problem.closure):
        for level, slot, value in row.terms:
            if level == problem.depth and slot in position:
                unknown[number, position[slot]] += value
            else:
                known.setdefault(level, {}).setdefault(slot, numpy.zeros(count))[number] += value
    if count and not _regular(unknown):
        raise undetermined()
    reads = []
    for level, columns in sorted(known.items()):
        entries = numpy.array([grid.index(slot) for slot in columns])
        reads.append((level, entries, numpy.linalg.solve(unknown, -numpy.stack(list(columns.values()), axis=1))))
    return numpy.array([grid.index(ghost) for ghost in problem.ghosts], dtype=int), reads


def _regular(matrix: Array) -> bool:
    """Whether a small matrix is regular beyond rounding, after its rows and columns are scaled by powers of two."""
    import numpy

    scaled = matrix.copy()
    for axis in (1, 0, 1, 0):
        size = numpy.abs(scaled).max(axis=axis, keepdims=True)
        if not size.all():
            return False
        scaled = scaled * numpy.exp2(-numpy.rint(numpy.log2(size)))
    values = numpy.linalg.svd(scaled, compute_uv=False)
    return bool(values[-1] > 8 * len(matrix) * numpy.finfo(float).eps * values[0])
