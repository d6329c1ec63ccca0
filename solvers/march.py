"""March a scheme as its file states it, and set the growth that is seen beside the growth that was predicted.

What is compared, and why:

- a predicted mode with abs(z) > 1 must show up in random data, which excite everything: their growth is the observation;
- where random data cannot tell (the mode decays and the waves that leave hide it, or it grows too slowly to stand out),
  the march starts from the eigenvector next to the predicted z (see `seeds`), and random data must still not outgrow it;
- a generalized eigenvalue needs forcing at z: `forced_response`.

The half-lines are long enough that their far ends cannot be felt: `farends` computes how long.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from gks.errors import NotAnalysable
from gks.solvers.exponential import LARGEST_DENSE
from gks.solvers.farends import cells_needed, steps_allowed
from gks.solvers.growth import CONFIDENCE, Growth, Trace, exponent, observe, observe_mode
from gks.solvers.matrices import Layout, layout, onto_constraints
from gks.solvers.problem import Problem, build
from gks.solvers.seeds import LOCALISED, OutOfReach, Seed, mode, near_slots, random_levels
from gks.solvers.update import Marcher, cost_per_value

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gks.scheme.model import Scheme

    Array = NDArray[Any]

STEPS = 1024
"""Steps of a march that is not told how many: an algebraic tail n**-1/2 then leaves 5e-4 in a raw rate, and far less once fitted."""

LARGEST_WORK = 16_000_000
"""Grid values times steps of a march that is not told how many: about a second."""

AGREEMENT = 1e-3
"""Relative difference that counts as agreement even where the uncertainty is smaller."""

FLOOR = 1e-120
"""A signal that has fallen by this factor against the largest value on the grid is left: the rest of the march would add nothing."""


@dataclass(frozen=True, slots=True)
class March:
    """A march without a prediction: the trace near the boundary, its growth, and the sizes it took."""

    growth: Growth
    trace: Trace
    cells: tuple[int, ...]
    steps: int


@dataclass(frozen=True, slots=True)
class Forced:
    """Response to z**n forcing: size ~ n**exponent (bounded 0, a simple pole at z 1); uncertainty its 99 % half-width."""

    exponent: float
    uncertainty: float
    sizes: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class MarchResult:
    """Predicted against observed growth per step.

    predicted : largest modulus of an admissible mode, None where there is none (nothing is claimed then).
    observed, uncertainty : growth per step and the half-width of its 99 % interval.
    agrees : see `_agrees`; remark : what the march could not tell, or how it disagrees; method : which march was observed.
    """

    predicted: float | None
    observed: float
    uncertainty: float
    agrees: bool
    method: str
    remark: str
    cells: tuple[int, ...]
    steps: int
    time_s: float

    @property
    def relative_difference(self) -> float | None:
        """abs(observed - predicted)/predicted (absolute at 0); None without a prediction."""
        if self.predicted is None:
            return None
        return abs(self.observed - self.predicted) / (self.predicted or 1.0)

    def to_json(self) -> dict[str, object]:
        """The object of `gks.march/1`."""
        return {
            "schema": "gks.march/1",
            "predicted": self.predicted,
            "observed": self.observed,
            "uncertainty": self.uncertainty if math.isfinite(self.uncertainty) else "oo",
            "relative_difference": self.relative_difference,
            "agrees": self.agrees,
            "time_s": self.time_s,
        }

    def __str__(self) -> str:
        predicted = "no admissible mode" if self.predicted is None else f"{self.predicted:.10g}"
        lines = [
            f"predicted  {predicted}",
            f"observed   {self.observed:.10g} ± {self.uncertainty:.2g} ({CONFIDENCE:.0%} confidence, {self.method})",
            f"{'agrees' if self.agrees else 'DISAGREES'}" + (f": {self.remark}" if self.remark else ""),
            f"{' and '.join(map(str, self.cells))} cells, {self.steps} steps, {self.time_s:.2f} s",
        ]
        return "\n".join(lines)


def run(grid: Layout, levels: Sequence[Array], steps: int, source: Array | None = None, z: complex = 1.0) -> Trace:
    """March so many steps from the starting levels and record the values near the boundary.

    With a `source` the state is forced by source * z**n. Stops early when the recorded values have fallen to FLOOR of the largest
    value on the grid, or are all zero. Raises NotAnalysable when a step overflows.
    """
    import numpy

    marcher = Marcher(grid, levels)
    places = numpy.array([grid.index(slot) for slot in near_slots(grid)])
    values, exponents = [marcher.state[places]], [0]
    recent = math.inf
    for number in range(steps):
        marcher.step(None if source is None else source * z**number)
        seen = marcher.state[places]
        size = float(numpy.abs(seen).max(initial=0.0))
        if not math.isfinite(size):
            raise NotAnalysable(
                message=f"step {number + 1} of the march passes the largest double",
                expected="growth by less than 1e100 a step",
                mend="march at milder values",
            )
        values.append(seen)
        exponents.append(marcher.exponent)
        if size > Marcher.CEILING:
            marcher.rescale(size)
        recent = max(recent, size)
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

    cells, steps : as many as asked for, or what `farends` computes for STEPS steps. Where the cells asked for would let the far ends be
    felt, the march is cut short at the last step that they cannot reach.
    """
    return random_march(build(scheme, values), cells, steps, seed)


def random_march(problem: Problem, cells: int | None, steps: int | None, seed: int) -> March:
    """`march_growth` for a problem already built."""
    counts, steps = _sizes(problem, cells, steps)
    grid = layout(problem, counts)
    trace = run(grid, random_levels(grid, seed), steps)
    return March(observe(trace), trace, grid.cells, len(trace) - 1)


def _sizes(problem: Problem, cells: int | None, steps: int | None) -> tuple[tuple[int, ...], int]:
    """Cells a side and steps: as asked, computed where not, and steps cut to what the far ends allow."""
    if cells is not None:
        counts = tuple(max(cells, problem.near + 1) for _ in problem.sides)
        allowed = steps_allowed(problem, counts, steps or STEPS)
        if allowed < 1:
            raise NotAnalysable(
                message=f"with {cells} cells the far ends are felt within one step",
                expected=f"{max(cells_needed(problem, steps or 8))} cells for {steps or 8} steps",
                mend="ask for more cells, or leave --cells out",
            )
        return counts, allowed
    if steps is not None:
        return _affordable(problem, steps), steps
    steps = STEPS
    while True:
        needed = cells_needed(problem, steps)
        unknowns = sum(count * len(side.unknowns) for count, side in zip(needed, problem.sides, strict=True))
        exact = problem.stages is not None and problem.stages.kind == "exact"
        fits = unknowns <= LARGEST_DENSE if exact else unknowns * steps * cost_per_value(problem) <= LARGEST_WORK
        if fits or steps <= 16:
            return _affordable(problem, steps), steps
        steps //= 2


MOST_CELLS = 200_000


def _affordable(problem: Problem, steps: int) -> tuple[int, ...]:
    counts = cells_needed(problem, steps)
    if max(counts) > MOST_CELLS:
        raise NotAnalysable(
            message=f"in {steps} steps signals reach farther than {MOST_CELLS} cells",
            expected="a CFL number at which a step carries signals over fewer cells",
            mend="march fewer steps (--steps), or with a smaller CFL number",
        )
    return counts


def mode_march(problem: Problem, z: complex, seed: int = 0) -> tuple[Seed, complex, Growth, int] | None:
    """March the finite problem's own eigenvector next to z: (start, z seen, growth, steps); None where there is none near z.

    The window ends where the mode has decayed to 1e-7 of its start, while rounding errors, which other modes carry on at
    their own slower rate, are still 1e-8 of it.
    """
    start = mode(problem, z, seed=seed)
    if start is None or not start.outside < LOCALISED:
        return None
    steps = 240
    if abs(z) < 1:
        steps = max(2, min(steps, int(math.log(1e-7) / math.log(abs(z)))))
    trace = run(start.grid, start.levels, steps)
    if len(trace) < 3 or not math.isfinite(float(trace.log_sizes()[-1])):
        return None
    seen, growth = observe_mode(trace)
    if steps >= 4 and growth.uncertainty > AGREEMENT * growth.rate:
        return None  # it does not march as one mode
    return start, seen, growth, steps


def forced_response(
    scheme: Scheme, values: Mapping[str, Fraction], z: complex, steps: int | None = None, seed: int = 0
) -> Forced:
    """How the scheme answers z**n forcing of every equation near the boundary, starting from rest.

    Bounded (exponent 0) where z is no eigenvalue, linear (1) at a simple eigenvalue or generalized eigenvalue, between for
    glancing waves (1/2). abs(z) = 1 is meant.
    """
    return forced_march(build(scheme, values), z, steps, seed)


def forced_march(problem: Problem, z: complex, steps: int | None = None, seed: int = 0) -> Forced:
    """`forced_response` for a problem already built."""
    import numpy

    counts, steps = _sizes(problem, None, steps)
    grid = layout(problem, counts)
    source = onto_constraints(grid, random_levels(grid, seed, support=2)[0])
    if abs(z.imag) > 1e-12 * abs(z):
        source = source.astype(complex)
    factor: complex = z if numpy.iscomplexobj(source) else z.real
    levels = [numpy.zeros_like(source) for _ in range(problem.depth)]
    sizes = numpy.exp(run(grid, levels, steps, source, factor).log_sizes())
    power, uncertainty = exponent(sizes)
    return Forced(power, uncertainty, tuple(map(float, sizes)))


def march(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    cells: int | None = None,
    steps: int | None = None,
    seed: int = 0,
) -> MarchResult:
    """Predicted against observed growth per step at the parameter values.

    Raises NotAnalysable where nothing can be marched: the next level is not determined, coefficients or growth are beyond
    doubles, or far ends out of reach.
    """
    from gks.modes import analyse

    began = time.perf_counter()
    problem = build(scheme, values)
    free = random_march(problem, cells, steps, seed)
    result = analyse(scheme, dict(values))
    admissible = [each for each in result.modes if each.kind.value != "inadmissible" and math.isfinite(each.modulus)]
    chosen, method, remark = free.growth, "random data", ""
    if not admissible:
        agrees = not free.growth.exceeds(1.0)
        if not agrees and getattr(result, "reason", None) == "interior":
            agrees, remark = True, "the interior scheme itself is unstable, and grows"
        predicted = None
    else:
        leading = max(admissible, key=lambda each: each.modulus)
        predicted = float(leading.modulus)
        chosen, method, remark = _observation(problem, leading.z_complex, leading.kind.value, free.growth, seed)
        agrees, why = _agrees(predicted, chosen, free.growth)
        remark = "; ".join(part for part in (why, remark) if part)
    return MarchResult(
        predicted, chosen.rate, chosen.uncertainty, agrees, method, remark, free.cells, free.steps,
        time.perf_counter() - began,
    )  # fmt: skip


def _observation(problem: Problem, z: complex, kind: str, free: Growth, seed: int) -> tuple[Growth, str, str]:
    """The march that can speak about this mode: random data, its own eigenvector, or forcing at z."""
    if kind == "growing" and free.exceeds(1.0) and free.uncertainty < AGREEMENT * free.rate:
        return free, "random data", ""
    if kind == "generalized":
        forced = forced_march(problem, z / abs(z), seed=seed)
        seen = f"forced at z the response grows as n**({forced.exponent:.2f} ± {forced.uncertainty:.2g})"
        return free, "random data", seen
    try:
        found = mode_march(problem, z, seed)
    except (OutOfReach, NotAnalysable):
        unknown = Growth(free.rate, math.inf, free.how)
        return unknown, "random data", "the mode decays too slowly in space, or too fast in time, to be marched by itself"
    if found is None:
        return free, "random data", "the finite problem has no such mode near the boundary"
    return found[2], "from the mode", ""


def _agrees(predicted: float, seen: Growth, free: Growth) -> tuple[bool, str]:
    """Whether observation and prediction are compatible, and what to say about it.

    They agree if they differ by no more than the uncertainty or AGREEMENT, are not on different sides of abs(z) = 1 beyond the
    uncertainty, and random data do not outgrow both the prediction and 1.
    """
    difference = abs(seen.rate - predicted)
    if difference > max(seen.uncertainty, AGREEMENT * predicted):
        return False, f"observed and predicted differ by {difference:.3g}, beyond the uncertainty"
    if (seen.exceeds(1.0) and predicted < 1 - AGREEMENT**2) or (seen.below(1.0) and predicted > 1 + AGREEMENT**2):
        return False, "observed and predicted are on different sides of the unit circle"
    ceiling = max(predicted, 1.0)
    if free.rate - free.uncertainty > ceiling * (1 + AGREEMENT):
        return False, f"random data grow by {free.rate:.6g} ± {free.uncertainty:.2g} a step, faster than any mode predicted"
    if abs(predicted - 1.0) <= seen.uncertainty:
        return True, "the march cannot tell this modulus from 1"
    return True, ""


__all__ = [
    "Forced", "March", "MarchResult", "forced_response", "march", "march_growth", "mode_march", "random_march", "run",
]  # fmt: skip
