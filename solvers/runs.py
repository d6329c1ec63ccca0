"""The marches that growth is observed in: from random data, from one mode, and forced at one z.

The half-lines are long enough that their far ends cannot be felt: `farends` computes how long.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from gks.errors import NotAnalysable, ParameterError
from gks.solvers.exponential import LARGEST_DENSE
from gks.solvers.farends import cells_needed, steps_allowed
from gks.solvers.growth import Growth, Trace, departure, exponent, observe, observe_mode
from gks.solvers.matrices import Layout, layout, onto_constraints
from gks.solvers.problem import Problem, build
from gks.solvers.seeds import LOCALISED, Seed, modes, near_slots, random_levels
from gks.solvers.update import Marcher, cost_per_value

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gks.scheme.model import Scheme

    Array = NDArray[Any]

STEPS = 1024
"""Steps of a march that is not told how many: a tail n**-1/2 leaves 5e-4 in a raw rate, far less once it is fitted."""

LARGEST_WORK = 16_000_000
"""Grid values times steps of a march that is not told how many: about a second."""

AGREEMENT = 1e-3
"""Relative difference that counts as agreement even where the uncertainty is smaller."""

FLOOR = 1e-120
"""A signal that has fallen by this factor against the largest value on the grid is left; more steps add nothing."""


@dataclass(frozen=True, slots=True)
class March:
    """A march without a prediction: the trace near the boundary, its growth, and the sizes it took."""

    growth: Growth
    trace: Trace
    cells: tuple[int, ...]
    steps: int


@dataclass(frozen=True, slots=True)
class Forced:
    """Response to z**n forcing: size ~ n**exponent (0 if bounded, 1 at a simple pole at z), with its 99 % half-width.

    log_sizes : natural logarithm of the size near the boundary after 0, 1, ... steps.
    """

    exponent: float
    uncertainty: float
    log_sizes: tuple[float, ...]


def run(
    grid: Layout,
    levels: Sequence[Array],
    steps: int,
    source: Array | None = None,
    z: complex = 1.0,
    everywhere: bool = False,
) -> Trace:
    """March so many steps from the starting levels and record the values near the boundary, or the norm `everywhere`.

    With a `source` the state is forced by source * z**n. Stops early when the recorded values have fallen to FLOOR of
    the largest value on the grid, or are all zero. Raises NotAnalysable when a step overflows.
    """
    import numpy

    marcher = Marcher(grid, levels)
    places = numpy.array([grid.index(slot) for slot in near_slots(grid)])

    def recorded() -> Array:
        return numpy.array([numpy.linalg.norm(marcher.state)]) if everywhere else marcher.state[places]

    values, exponents = [recorded()], [0]
    recent = math.inf
    for number in range(steps):
        with numpy.errstate(over="ignore", invalid="ignore"):
            marcher.step(None if source is None else source * z**number)
        seen = recorded()
        size = float(numpy.abs(seen).max(initial=0.0))
        if not math.isfinite(size):
            raise NotAnalysable(
                message=f"step {number + 1} of the march passes the largest double",
                expected="values within the range of doubles (growth by 1e100 a step is)",
                mend="march at milder values",
            )
        values.append(seen)
        exponents.append(marcher.exponent)
        if size > Marcher.CEILING:
            marcher.rescale(size)
        recent = max(recent, size)
        if source is None and size < 1.0 / Marcher.CEILING and marcher.raise_fallen():
            recent = math.inf  # what was seen before is on another scale
        if number % 8 == 7:
            largest = float(numpy.abs(marcher.state).max())
            if largest > Marcher.CEILING:
                marcher.rescale(largest)
            elif source is None and recent <= FLOOR * largest:
                break
            recent = 0.0
    return Trace(numpy.array(values), numpy.array(exponents))


def march_growth(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    cells: int | None = None,
    steps: int | None = None,
    seed: int = 0,
) -> March:
    """The growth of random data near the boundary: no prediction is needed or used.

    cells, steps : as many as asked for, or what `farends` computes for STEPS steps. Where the cells asked for would
    let the far ends be felt, the march is cut short at the last step that they cannot reach.
    """
    return random_march(build(scheme, values), cells, steps, seed)


def random_march(problem: Problem, cells: int | None, steps: int | None, seed: int) -> March:
    """`march_growth` for a problem already built."""
    counts, steps = _sizes(problem, cells, steps)
    grid = layout(problem, counts)
    trace = run(grid, random_levels(grid, seed), steps)
    return March(observe(trace), trace, grid.cells, len(trace) - 1)


def filled_march(problem: Problem, steps: int, seed: int = 0) -> March:
    """The growth of random data that fill the cells, in the norm over all of them.

    It shows waves of an unstable interior that are carried off, and so do not grow near the boundary: beyond the cells
    that `farends` asks for, there are twice as many as an explicit scheme reads in so many steps.
    """
    reach = max(max(side.inward_reach, side.outward_reach) for side in problem.sides)
    support = max(_affordable(problem, steps)) + 2 * reach * steps
    grid = layout(problem, [support + count for count in cells_needed(problem, steps)])
    trace = run(grid, random_levels(grid, seed, support), steps, everywhere=True)
    return March(observe(trace), trace, grid.cells, len(trace) - 1)


def _sizes(problem: Problem, cells: int | None, steps: int | None) -> tuple[tuple[int, ...], int]:
    """Cells a side and steps: as asked, computed where not, and steps cut to what the far ends allow."""
    for name, number in (("cells", cells), ("steps", steps)):
        if number is not None and number < 1:
            raise ParameterError(f"{number} {name}", expected="a march needs at least one")
    if cells is not None:
        if cells > MOST_CELLS:
            raise NotAnalysable(
                message=f"{cells} cells a side are more than a march is given room for",
                expected=f"at most {MOST_CELLS}",
                mend="ask for fewer, or leave --cells out",
            )
        counts = tuple(max(cells, problem.near + 1) for _ in problem.sides)
        allowed = steps_allowed(problem, counts, steps or STEPS)
        if allowed < 1:
            raise NotAnalysable(
                message=f"with {cells} cells the far ends are felt within one step",
                expected=f"{max(cells_needed(problem, steps or 8))} cells for {steps or 8} steps",
                mend="ask for more cells, or leave --cells out",
            )
        return _patient(problem, counts, allowed), allowed
    if steps is not None:
        return _patient(problem, _affordable(problem, steps), steps), steps
    steps = STEPS
    while True:
        needed = cells_needed(problem, steps)
        unknowns = _values(problem, needed)
        exact = problem.stages is not None and problem.stages.kind == "exact"
        fits = unknowns <= LARGEST_DENSE if exact else unknowns * steps * cost_per_value(problem) <= LARGEST_WORK
        if fits or steps <= 16:
            return _affordable(problem, steps), steps
        steps //= 2


MOST_CELLS = 200_000
"""Cells a side beyond which a march is refused: some 10 MB a level and a hundredth of a second a step."""


MOST_WORK = 20_000_000_000
"""Grid values times steps beyond which a march that was told how many is refused: some ten minutes."""


def _patient(problem: Problem, counts: tuple[int, ...], steps: int) -> tuple[int, ...]:
    """The same cells, where so many steps on them take minutes at most."""
    work = _values(problem, counts) * steps * cost_per_value(problem)
    if work > MOST_WORK:
        raise NotAnalysable(
            message=f"{steps} steps on {' and '.join(map(str, counts))} cells take more than ten minutes",
            expected=f"about {int(steps * MOST_WORK / work)} steps on as many cells, at most",
            mend="march fewer steps (--steps)",
        )
    return counts


def _values(problem: Problem, counts: Sequence[int]) -> int:
    return sum(count * len(side.unknowns) for count, side in zip(counts, problem.sides, strict=True))


def _affordable(problem: Problem, steps: int) -> tuple[int, ...]:
    counts = cells_needed(problem, steps)
    if max(counts) > MOST_CELLS:
        raise NotAnalysable(
            message=f"in {steps} steps signals reach farther than {MOST_CELLS} cells",
            expected="a CFL number at which a step carries signals over fewer cells",
            mend="march fewer steps (--steps), or with a smaller CFL number",
        )
    return counts


MODE_STEPS = 240
"""Steps of a march from a mode: so long rounding errors that other modes carry on stay small, or show as scatter."""


@dataclass(frozen=True, slots=True)
class ModeMarch:
    """A march from one mode: what it started from, the z of its first step, its growth, its trace."""

    start: Seed
    z: complex
    growth: Growth
    trace: Trace


def mode_march(problem: Problem, z: complex, seed: int = 0) -> ModeMarch | None:
    """March the finite problem's own eigenvector next to z; None where none lives near the boundary and marches.

    Raises OutOfReach where it takes too many cells, or z is zero.
    """
    for start in modes(problem, z, seed):
        found = _marched(start) if start.outside < LOCALISED else None
        if found is not None:
            return found
    return None


def _marched(start: Seed) -> ModeMarch | None:
    """The march from this vector; None where it changes its rate on the way, and so is not one mode.

    The window ends where the mode has decayed to 1e-7 of its start, while rounding errors, which other modes carry on
    at their own slower rate, are still 1e-8 of it.
    """
    steps = MODE_STEPS
    if abs(start.z) < 1:
        steps = max(2, min(steps, int(math.log(1e-7) / math.log(abs(start.z)))))
    trace = run(start.grid, start.levels, steps)
    if len(trace) < 3 or trace.log_sizes()[-1] == -math.inf:
        return None
    seen, growth = observe_mode(trace)
    # From four steps on the scatter tells; before, whether the first one leads to a multiple of the start.
    if (growth.uncertainty / growth.rate if steps >= 4 else departure(trace)) > AGREEMENT:
        return None
    return ModeMarch(start, seen, growth, trace)


def forced_response(
    scheme: Scheme, values: Mapping[str, Fraction], z: complex, steps: int | None = None, seed: int = 0
) -> Forced:
    """How the scheme answers z**n forcing of every equation near the boundary, starting from rest.

    Bounded (exponent 0) where z is no eigenvalue, linear (1) at a simple eigenvalue or generalized eigenvalue,
    between for glancing waves (1/2). abs(z) = 1 is meant.
    """
    return forced_march(build(scheme, values), z, steps, seed)


def forced_march(problem: Problem, z: complex, steps: int | None = None, seed: int = 0) -> Forced:
    """`forced_response` for a problem already built."""
    import numpy

    counts, steps = _sizes(problem, None, steps)
    grid = layout(problem, counts)
    source = onto_constraints(grid, random_levels(grid, seed, support=2)[0])
    factor: complex = z if z.imag else z.real
    if z.imag:
        source = source.astype(complex)
    levels = [numpy.zeros_like(source) for _ in range(problem.depth)]
    logs = run(grid, levels, steps, source, factor).log_sizes()
    power, uncertainty = exponent(logs)
    return Forced(power, uncertainty, tuple(map(float, logs)))
