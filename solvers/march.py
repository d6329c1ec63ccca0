"""Predicted against observed growth per step.

What is compared, and why:

- a predicted mode with abs(z) > 1 must show in random data, which excite everything: their growth is the observation;
- where random data cannot tell (the mode decays and the waves that leave hide it, or it grows too slowly to stand out),
  the march starts from the eigenvector next to the predicted z (see `seeds`), and random data must not outgrow it;
- a generalized eigenvalue shows only when it is forced at z, and then in a power of n: see `forced_response`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.errors import NotAnalysable
from gks.solvers.coefficients import beyond_doubles
from gks.solvers.growth import CONFIDENCE, Growth
from gks.solvers.problem import Problem, build
from gks.solvers.runs import (
    AGREEMENT,
    Forced,
    March,
    forced_march,
    forced_response,
    march_growth,
    mode_march,
    random_march,
    run,
)
from gks.solvers.seeds import OutOfReach

if TYPE_CHECKING:
    from gks.modes import Mode, ModesResult
    from gks.scheme.model import Scheme

__all__ = ["Forced", "March", "MarchResult", "forced_response", "march", "march_growth", "mode_march", "run"]


@dataclass(frozen=True, slots=True)
class History:
    """How one march went: plain numbers, to be drawn.

    name : what it started from. log_sizes : natural logarithm of the Euclidean norm of the values near the boundary
    after 0, 1, ... steps, -inf where all are zero. growth : the rate fitted, and the window of steps that it was
    fitted to.
    """

    name: str
    log_sizes: tuple[float, ...]
    growth: Growth

    @property
    def line(self) -> tuple[float, float] | None:
        """(c, s) of the fitted line log size = c + s n, laid through the mean of its window; None where it has no slope
        or no window.
        """
        first, last = self.growth.window
        window = self.log_sizes[first : last + 1]
        if last <= first or self.growth.rate <= 0 or not all(map(math.isfinite, window)):
            return None
        slope = math.log(self.growth.rate)
        return sum(window) / len(window) - slope * (first + last) / 2, slope


@dataclass(frozen=True, slots=True)
class MarchResult:
    """Predicted against observed growth per step.

    predicted : largest modulus of an admissible mode, None where there is none (nothing is claimed then).
    observed, uncertainty : growth per step and the half-width of its 99 % interval.
    agrees : see `_agrees`; remark : what the march could not tell, or how it disagrees.
    told : whether the march could have said no: False where `agrees` only means that nothing contradicts (`_told`).
    interior : why the interior scheme alone decides the verdict, empty where it does not. What is compared is the
    boundary's mode all the same, and its agreement says nothing of the interior's waves.
    method : which march was observed; cells, steps : the sizes of the one from random data.
    histories : the marches as they went, the observed one first.
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
    histories: tuple[History, ...] = ()
    told: bool = True
    interior: str = ""

    @property
    def history(self) -> History:
        """The march that the growth was observed in."""
        return self.histories[0]

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
            "told": self.told,
            "because": self.because,
        }

    @property
    def because(self) -> str:
        """What `agrees` rests on, in words."""
        return "; ".join(part for part in (self.remark or self._plainly(), self.interior) if part)

    def _plainly(self) -> str:
        if not self.told:
            return NOT_RESOLVED
        if self.predicted is None:
            return "no mode was predicted, and random data do not grow"
        return "observed and predicted are the same within the uncertainty"

    def __str__(self) -> str:
        predicted = "no admissible mode" if self.predicted is None else f"{self.predicted:.10g}"
        lines = [
            f"predicted  {predicted}",
            f"observed   {self.observed:.10g} ± {self.uncertainty:.2g} ({CONFIDENCE:.0%} confidence, {self.method})",
            f"{'agrees' if self.agrees else 'DISAGREES'}" + (f": {self._aside()}" if self._aside() else ""),
            *([f"interior   {self.interior}"] if self.interior else []),
            f"{' and '.join(map(str, self.cells))} cells, {self.steps} steps, {self.time_s:.2f} s",
        ]
        return "\n".join(lines)

    def _aside(self) -> str:
        """What stands beside the answer: the remark, or that the march resolves too little to tell."""
        return self.remark or ("" if self.told else NOT_RESOLVED)


def march(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    cells: int | None = None,
    steps: int | None = None,
    seed: int = 0,
) -> MarchResult:
    """Predicted against observed growth per step at the parameter values.

    Raises NotAnalysable where nothing can be marched: the next level is not determined, coefficients or growth are
    beyond doubles, or far ends out of reach.
    """
    import numpy

    try:
        with numpy.errstate(over="raise", divide="raise", invalid="raise"):
            return _marched(scheme, values, cells, steps, seed)
    except FloatingPointError as cause:
        raise beyond_doubles("a number on the way is beyond double precision") from cause


def _marched(
    scheme: Scheme, values: Mapping[str, Fraction], cells: int | None, steps: int | None, seed: int
) -> MarchResult:
    from gks.modes import analyse

    began = time.perf_counter()
    problem = build(scheme, values)
    free = random_march(problem, cells, steps, seed)
    result = analyse(scheme, dict(values))
    leading = _leading(result)
    interior = result.reason == "interior"
    predicted: float | None = None
    histories: tuple[History, ...] = (_from_random(free),)
    if leading is None:
        agrees, remark = _nothing_claimed(free, interior)
    else:
        predicted = _in_doubles(leading)
        histories, seen = _observation(problem, leading.z_complex, leading.kind.value, free, interior, seed)
        agrees, remark = _agrees(predicted, histories[0].growth, None if interior else free)
        remark = "; ".join(part for part in (remark, seen) if part)
    growth, method = histories[0].growth, histories[0].name
    return MarchResult(
        predicted=predicted,
        observed=growth.rate,
        uncertainty=growth.uncertainty,
        agrees=agrees,
        method=method,
        remark=remark,
        cells=free.cells,
        steps=free.steps,
        time_s=time.perf_counter() - began,
        histories=histories,
        told=not agrees or _told(predicted, growth, free.steps, interior),
        interior=result.because if interior else "",
    )


def _leading(result: ModesResult) -> Mode | None:
    """The admissible mode of largest modulus."""
    admissible = [mode for mode in result.modes if mode.kind.value != "inadmissible"]
    return max(admissible, key=lambda mode: mode.modulus, default=None)


def _in_doubles(mode: Mode) -> float:
    """The modulus as a double. Raises NotAnalysable beyond their range."""
    try:
        return float(mode.modulus)
    except OverflowError as cause:
        raise beyond_doubles("the predicted growth per step is beyond double precision") from cause


def _outgrows(free: March, bound: float) -> bool:
    """Whether random data grow faster than `bound` a step.

    Growth by less than a factor e over the whole march may be a transient as slow as the march is long, whatever the
    scatter: with lam = 1e-4 a thousand steps are a tenth of the time in which a wave crosses a cell.
    """
    return free.growth.exceeds(bound * math.exp(1.0 / max(1, free.steps)))


def _nothing_claimed(free: March, interior: bool) -> tuple[bool, str]:
    """Without an admissible mode random data must not grow, unless it is the interior scheme that is said to."""
    if free.growth.uncertainty == math.inf:
        return True, CANNOT_TELL
    if not _outgrows(free, 1.0):
        return True, "growth this slow may be a transient" if free.growth.exceeds(1.0) else ""
    if interior:
        return True, "the interior scheme is unstable by itself, and its waves grow"
    seen = f"{free.growth.rate:.6g} ± {free.growth.uncertainty:.2g}"
    return False, f"random data grow by {seen} a step, and no mode was predicted"


def _from_random(free: March) -> History:
    return History(RANDOM, tuple(map(float, free.trace.log_sizes())), free.growth)


def _observation(
    problem: Problem, z: complex, kind: str, free: March, interior: bool, seed: int
) -> tuple[tuple[History, ...], str]:
    """(histories, remark), first the march that can speak about this mode: random data, or the mode itself.

    A generalized eigenvalue is forced besides. Where no march can speak, the uncertainty of the first is inf.
    """
    random = _from_random(free)
    if kind == "growing" and not interior and _tells(free):
        return (random,), ""
    if kind == "generalized":
        # One random forcing may happen to leave the mode out.
        tries = (forced_march(problem, z / abs(z), seed=number) for number in (seed, seed + 1))
        forced = max(tries, key=lambda each: each.exponent)
        seen = f"forced at z the response grows as n**({forced.exponent:.2f} ± {forced.uncertainty:.2g})"
        # Random data need not show it, and fall as the waves leave: only their growth would contradict, beyond a factor
        # e over the march, which a power of n may make.
        known = max(free.growth.uncertainty, math.expm1(1.0 / free.steps), 1.0 - free.growth.rate)
        leaving = replace(random, growth=replace(free.growth, uncertainty=known))
        return (leaving, History(FORCED, forced.log_sizes, Growth(1.0, 0.0, "forced"))), seen
    unknown = replace(random, growth=replace(free.growth, uncertainty=math.inf))
    try:
        found = mode_march(problem, z, seed)
    except (OutOfReach, NotAnalysable):
        return (unknown,), "the mode reaches too far, or decays too fast, to be marched by itself"
    except FloatingPointError:
        return (unknown,), "the equations of the mode are beyond double precision"
    if found is not None:
        return (History(OWN, tuple(map(float, found.trace.log_sizes())), found.growth), random), ""
    if interior:
        return (unknown,), "growing waves of the interior hide the mode"
    return (random,), "the finite problem has no such mode near the boundary"


CANNOT_TELL = "the march cannot tell"

NOT_RESOLVED = "nothing contradicts, but this march cannot tell"

RANDOM, OWN, FORCED = "random data", "from the mode", "forced at z"


def _tells(free: March) -> bool:
    """Whether random data grow, by more than a power of n may make, and fast enough for a rate known to AGREEMENT."""
    return _outgrows(free, 1.0) and free.growth.uncertainty < AGREEMENT * free.growth.rate


def _agrees(predicted: float, seen: Growth, free: March | None) -> tuple[bool, str]:
    """Whether observation and prediction are compatible, and what to say about it.

    They agree if they differ by no more than the uncertainty or AGREEMENT, are not on different sides of abs(z) = 1
    beyond the uncertainty (but for rounding of a predicted 1), and random data, if given, do not outgrow both the
    prediction and 1.
    """
    if seen.uncertainty == math.inf:
        return True, CANNOT_TELL
    difference = abs(seen.rate - predicted)
    if difference > max(seen.uncertainty, AGREEMENT * predicted):
        return False, f"observed and predicted differ by {difference:.3g}, beyond the uncertainty"
    rounding = 2.0**-40
    if (seen.exceeds(1.0) and predicted < 1 - rounding) or (seen.below(1.0) and predicted > 1 + rounding):
        return False, "observed and predicted are on different sides of the unit circle"
    if free is not None and _outgrows(free, max(predicted, 1.0) * (1 + AGREEMENT)):
        growth = f"{free.growth.rate:.6g} ± {free.growth.uncertainty:.2g}"
        return False, f"random data grow by {growth} a step, faster than any mode"
    if abs(predicted - 1.0) <= seen.uncertainty:
        return True, "the march cannot tell this modulus from 1"
    return True, ""


def _told(predicted: float | None, seen: Growth, steps: int, interior: bool) -> bool:
    """Whether an agreement was observed, and is not only the lack of a contradiction.

    A predicted modulus must be resolved to AGREEMENT. Without one, the whole interval must lie below what `_outgrows`
    calls growth, and not above 1; or, where it is the interior that is said to grow, above both.
    """
    if seen.uncertainty == math.inf:
        return False
    if predicted is not None:
        return seen.uncertainty <= AGREEMENT * max(predicted, seen.rate)
    slack = math.exp(1.0 / max(1, steps))
    return seen.exceeds(slack) if interior else seen.below(slack) and not seen.exceeds(1.0)
