"""Starting data: random near the boundary, or the one mode that a prediction speaks of.

The mode is not taken from the prediction: inverse iteration on the finite problem's own matrices, shifted to the
predicted z, finds the eigenvector that is really there. If the prediction is wrong, the vector found marches
with another z, or does not live near the boundary at all.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gks.solvers.exponential import generator
from gks.solvers.farends import interior_blocks
from gks.solvers.matrices import Layout, layout, level_matrices
from gks.solvers.problem import Problem, Slot

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    Array = NDArray[Any]

SUPPORT = 6
"""How many cells a side the random data fill: enough to excite every short mode, few enough to leave quickly."""


def random_levels(grid: Layout, seed: int, support: int = SUPPORT) -> list[Array]:
    """Normal random values on the first cells of every unknown, at each of the starting levels; zero elsewhere."""
    import numpy

    source = numpy.random.default_rng(seed)
    places = numpy.array([grid.index(slot) for slot in grid.near(support)])
    levels = []
    for _ in range(grid.problem.depth):
        level = numpy.zeros(grid.size)
        level[places] = source.standard_normal(len(places))
        levels.append(level)
    return levels


@dataclass(frozen=True, slots=True)
class Seed:
    """Starting levels that should march as z**n; outside: the share of the norm in the outer halves of the cells."""

    grid: Layout
    levels: list[Array]
    z: complex
    outside: float


LOCALISED = 1e-3
"""A vector with a larger share in the outer halves is no mode of the boundary."""

SHIFT = 1e-7
"""Distance of the shift from the predicted z: off the eigenvalue by more than rounding, nearer than the next one."""

ITERATIONS = 4
"""Each multiplies the rest by SHIFT over the distance of the next eigenvalue: two would do where that is 0.01."""

MOST_CELLS = 20_000
"""Cells a side up to which a mode is set up: its slowest kappa is then within 2e-3 of the unit circle."""


class OutOfReach(Exception):
    """The mode decays too slowly, or z is zero: it cannot be set up on the cells that a march affords."""


def modes(problem: Problem, z: complex, seed: int = 0) -> Iterator[Seed]:
    """Vectors that may be the mode of the finite problem at z, the likeliest first, each found when it is asked for.

    As many cells as the kappas of z need to decay. Outside the unit circle inverse iteration is quick and safe. Inside
    the curve that the interior's waves trace every z is an eigenvalue of a truncated matrix but for rounding, so there
    the least residual, which the far end has no part in, comes first. Raises OutOfReach, once there is no more that can
    be set up, where one takes more than MOST_CELLS, or z is zero: the mode may be that one.
    """
    searches = (_inverse_iteration, _least_residual) if abs(z) >= 1 else (_least_residual, _inverse_iteration)
    resolvents = _resolvents(problem, z)
    beyond = not resolvents
    for resolvent in resolvents:
        counts = [_length(problem, side, resolvent) for side in range(len(problem.sides))]
        if max(counts) > MOST_CELLS:
            beyond = True
            continue
        found = (search(problem, counts, resolvent, z, seed) for search in searches)
        yield from (start for start in found if start is not None)
    if beyond:
        raise OutOfReach


def _resolvents(problem: Problem, z: complex) -> list[complex]:
    """The numbers at which the level matrices are singular for a mode z: z itself, or every s with R(lam s) = z."""
    import numpy

    if z == 0 or not cmath.isfinite(z):
        return []
    if problem.stages is None:
        return [z]
    if problem.stages.kind == "exact":
        return _logarithms(problem, z)
    *high, constant = [float(c) for c in problem.stages.stability[::-1]]
    return [complex(mu) / problem.lam for mu in numpy.roots([*high, constant - z])]


def _logarithms(problem: Problem, z: complex) -> list[complex]:
    """The s with exp(lam s) = z that the finite problem knows, of infinitely many: fast modes lie on far branches.

    The principal one, and the branch nearest to each eigenvalue of a problem of few cells whose exponential is near z.
    """
    import numpy

    grid = layout(problem, [problem.near + 24] * len(problem.sides))
    mu = problem.lam * numpy.linalg.eigvals(generator(grid))
    principal = cmath.log(z)
    close = mu[numpy.abs(mu.real - principal.real) < 0.1]
    turns = numpy.unique(numpy.rint((close.imag - principal.imag) / (2 * math.pi)))
    branches = {0.0, *turns[numpy.argsort(numpy.abs(turns))[:12]].tolist()}
    return [(principal + 2j * math.pi * turn) / problem.lam for turn in sorted(branches, key=abs)]


def _length(problem: Problem, side: int, resolvent: complex) -> int:
    """Cells until the slowest decaying wave has fallen to rounding; MOST_CELLS + 1 if it takes more.

    Waves nearer to the unit circle than their computed kappas are accurate (a double root: sqrt(eps)) do not decay.
    """
    moduli = [abs(kappa) for kappa in _kappas(problem, side, resolvent)]
    slowest = max((modulus for modulus in moduli if modulus < 1 - 2.0**-26), default=0.0)
    needed = problem.near + 12
    if slowest > 0:
        needed += math.ceil(math.log(2.0**-56) / math.log(slowest))
    return min(needed, MOST_CELLS + 1)


def _kappas(problem: Problem, side: int, resolvent: complex) -> list[complex]:
    """The kappas of the interior's waves at this resolvent: roots of a determinant, interpolated on the unit circle."""
    import numpy

    half = problem.sides[side]
    reach = len(half.unknowns) * max(half.inward_reach, half.outward_reach)
    count = 2 * reach + 1
    circle = numpy.exp(2j * math.pi * numpy.arange(count) / count)
    symbol = sum(block * resolvent**level for level, block in enumerate(interior_blocks(problem, half, circle)))
    laurent = numpy.fft.fftshift(numpy.fft.fft(numpy.linalg.det(symbol))) / count
    laurent[numpy.abs(laurent) < 64 * count * numpy.finfo(float).eps * numpy.abs(laurent).max()] = 0.0
    return [complex(root) for root in numpy.roots(laurent[::-1]) if root != 0]


def _inverse_iteration(
    problem: Problem, counts: Sequence[int], resolvent: complex, z: complex, seed: int
) -> Seed | None:
    """Inverse iteration on the companion form of sum_k A_k w[n+k] = 0 at a shift next to the resolvent."""
    import numpy
    from scipy.sparse.linalg import splu

    grid = layout(problem, counts)
    matrices = level_matrices(grid)
    # Under stages the resolvent is s, in units of a cell's own rate, and may be 0; z is relative to itself.
    shift = resolvent + SHIFT * (abs(resolvent) if problem.stages is None else max(abs(resolvent), 1.0))
    pencil = sum(matrix * shift**power for power, matrix in enumerate(matrices))
    size = numpy.asarray(abs(pencil).max(axis=1).todense()).ravel()
    scale = numpy.exp2(-numpy.rint(numpy.log2(numpy.where(size > 0, size, 1.0))))
    try:
        factors = splu(pencil.multiply(scale[:, None]).tocsc().astype(complex))
    except RuntimeError:
        return None
    state = [level.astype(complex) for level in random_levels(grid, seed)]
    for _ in range(ITERATIONS):
        # x_{k+1} - shift x_k = y_k and sum_k A_k x_k = 0: x_k = shift**k x_0 + particular_k.
        particular = [numpy.zeros(grid.size, dtype=complex)]
        for level in state:
            particular.append(shift * particular[-1] + level)
        right = -sum(matrix @ part for matrix, part in zip(matrices, particular, strict=True))
        newest = factors.solve(scale * right)
        if not numpy.isfinite(newest).all():
            return None
        state = [shift**power * newest + part for power, part in enumerate(particular[:-1])]
        norm = max(float(numpy.linalg.norm(level)) for level in state)
        if not 0 < norm < math.inf:
            return None
        state = [level / norm for level in state]
    return Seed(grid, state, z, _outside(grid, state))


NEARLY_NULL = 1e-9
"""What leaves less than this of itself, row by row, is found; what leaves more is damped by the square of the ratio."""


def _least_residual(problem: Problem, counts: Sequence[int], resolvent: complex, z: complex, seed: int) -> Seed | None:
    """The vector that lives on `counts` cells and leaves the least residual of all equations, those beyond included.

    Inside the curve that the interior's waves trace in the z plane every z is an eigenvalue of a truncated matrix but
    for rounding, by waves that lean on the far end. Those are no candidates here; a mode of the boundary still is.
    It is the last right singular vector of the equations B, by inverse iteration with B* B + tau**2 in its augmented
    form [[tau, B], [B*, -tau]], which does not square the condition (Björck, BIT 7 (1967) 1-21).
    """
    import numpy
    from scipy import sparse
    from scipy.sparse.linalg import splu

    grid = layout(problem, [2 * count for count in counts])
    columns = numpy.concatenate(
        [
            (grid.base[side] + unknown * grid.width[side] + numpy.arange(counts[side] - grid.low[side]))
            for side, half in enumerate(problem.sides)
            for unknown in range(len(half.unknowns))
        ]
    )
    pencil = sum(matrix * resolvent**power for power, matrix in enumerate(level_matrices(grid)))
    block = pencil.tocsc()[:, columns].tocsr()
    size = abs(block).max(axis=1).toarray().ravel()
    kept = block[size > 0].multiply(1.0 / size[size > 0, None])
    tau, (rows, width) = NEARLY_NULL, kept.shape
    augmented = sparse.bmat([[tau * sparse.eye(rows), kept], [kept.conj().T, -tau * sparse.eye(width)]], format="csc")
    try:
        factors = splu(augmented.astype(complex))
    except RuntimeError:
        return None
    vector = numpy.random.default_rng(seed).standard_normal(width).astype(complex)
    for _ in range(ITERATIONS):
        vector = factors.solve(numpy.concatenate([numpy.zeros(rows), vector]))[rows:]
        norm = float(numpy.linalg.norm(vector))
        if not 0 < norm < math.inf:
            return None
        vector /= norm
    newest = numpy.zeros(grid.size, dtype=complex)
    newest[columns] = vector
    state = [resolvent**power * newest for power in range(problem.depth)]
    return Seed(grid, state, z, _outside(grid, state))


def _outside(grid: Layout, levels: Sequence[Array]) -> float:
    """The largest share, over the unknowns, of the norm in the outer half of the cells.

    Unknowns near rounding size against the whole are left out: what they hold far out is noise.
    """
    import numpy

    worst = 0.0
    for level in levels:
        largest = float(numpy.linalg.norm(level))
        for number, side in enumerate(grid.problem.sides):
            block = grid.block(level, number)
            middle = (side.first + grid.cells[number]) // 2 - grid.low[number]
            for unknown in range(len(side.unknowns)):
                whole = float(numpy.linalg.norm(block[unknown]))
                if whole > largest * 2.0**-40:
                    worst = max(worst, float(numpy.linalg.norm(block[unknown, middle:])) / whole)
    return worst


def near_slots(grid: Layout) -> list[Slot]:
    """What a march records: the boundary unknowns and two cells of every unknown."""
    return grid.near(2)
