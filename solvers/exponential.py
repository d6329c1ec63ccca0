"""The semi-discrete problem itself, `time = "exact"`: one step is exp(lam F), F from the relation w' = F w.

Few grid values: the dense matrix, by scaling and squaring after balancing, right whatever the norm of F. Many: a Taylor
series of its action over substeps of norm one, as long as those are not too many.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from gks.errors import NotAnalysable
from gks.solvers.matrices import Layout, layout, level_matrices
from gks.solvers.relation import Relation, undetermined

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]

LARGEST_DENSE = 800
"""Grid values up to which the exponential is a dense matrix: some 25 products of full matrices, about a second."""

TERMS = 19
"""Taylor terms over a substep of norm at most one: 1/19! is 8e-18."""

MOST_SUBSTEPS = 256
"""Beyond this a step would cost as much as 5000 explicit ones, and the march is refused."""


def generator(grid: Layout) -> Array:
    """The dense F of w' = F w, shape (size, size)."""
    import numpy

    rate, mass = (matrix.toarray() for matrix in level_matrices(grid))
    try:
        result: Array = -numpy.linalg.solve(mass, rate)
    except numpy.linalg.LinAlgError as cause:
        raise undetermined() from cause
    return result


def exponential(grid: Layout, relation: Relation) -> Callable[[Array], Array]:
    """The map of a state over one step. Raises NotAnalysable where it would take more than MOST_SUBSTEPS."""
    if grid.size <= LARGEST_DENSE:
        step = propagator(grid)
        return lambda state: step @ state
    substeps = _substeps(grid)
    return lambda state: _taylor(relation, grid.problem.lam / substeps, substeps, state)


def propagator(grid: Layout) -> Array:
    """exp(lam F), dense: scaling and squaring (Al-Mohy & Higham, SIAM J. Matrix Anal. Appl. 31 (2009) 970-989, as in
    scipy).
    """
    from scipy.linalg import expm, matrix_balance

    even, (scale, _) = matrix_balance(grid.problem.lam * generator(grid), permute=False, separate=True)
    result: Array = scale[:, None] * expm(even) / scale[None, :]
    return result


def _taylor(relation: Relation, time: float, substeps: int, state: Array) -> Array:
    import numpy

    result, rate = state.copy(), numpy.zeros_like(state)
    for _ in range(substeps):
        term = result
        for power in range(1, TERMS):
            term = relation.newest([term], rate) * (time / power)
            result = result + term
    return result


def _substeps(grid: Layout) -> int:
    """How many substeps make lam F at most one in norm: F from the same rows, on few cells that show all of them."""
    import numpy
    from scipy.linalg import matrix_balance

    problem = grid.problem
    reach = max(side.inward_reach + side.outward_reach for side in problem.sides)
    small = generator(layout(problem, [problem.near + 2 * reach + 8] * len(problem.sides)))
    norm = float(numpy.linalg.norm(matrix_balance(small, permute=False)[0], 2)) * problem.lam
    if not norm <= MOST_SUBSTEPS:
        raise NotAnalysable(
            message=f"`exact` would take {norm:.3g} substeps a step on {grid.size} grid values",
            expected=f"at most {MOST_SUBSTEPS}, or at most {LARGEST_DENSE} grid values",
            mend="ask for fewer cells or steps, or a smaller CFL number",
        )
    return max(1, math.ceil(norm))
