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
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.errors import NotAnalysable
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
class MarchResult:
    """Predicted against observed growth per step.

    predicted : largest modulus of an admissible mode, None where there is none (nothing is claimed then).
    observed, uncertainty : growth per step and the half-width of its 99 % interval.
    agrees : see `_agrees`; remark : what the march could not tell, or how it disagrees.
    method : which march was observed; cells, steps : the sizes of the one from random data.
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
    from gks.modes import analyse

    began = time.perf_counter()
    problem = build(scheme, values)
    free = random_march(problem, cells, steps, seed)
    result = analyse(scheme, dict(values))
    leading = _leading(result)
    interior = result.reason == "interior"
    if leading is None:
        predicted, chosen, method = None, free.growth, "random data"
        agrees, remark = _nothing_claimed(free, interior)
    else:
        predicted = _in_doubles(leading)
        chosen, method, seen = _observation(problem, leading.z_complex, leading.kind.value, free.growth, interior, seed)
        agrees, remark = _agrees(predicted, chosen, None if interior else free)
        remark = "; ".join(part for part in (remark, seen) if part)
    elapsed = time.perf_counter() - began
    return MarchResult(
        predicted, chosen.rate, chosen.uncertainty, agrees, method, remark, free.cells, free.steps, elapsed
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
        raise NotAnalysable(
            message="the predicted growth per step is beyond double precision",
            expected="a march computes in doubles",
            mend="march at milder values",
        ) from cause


def _outgrows(free: March, bound: float) -> bool:
    """Whether random data grow faster than `bound` a step.

    Growth by less than a factor e over the whole march may be a transient as slow as the march is long, whatever the
    scatter: with lam = 1e-4 a thousand steps are a tenth of the time in which a wave crosses a cell.
    """
    return free.growth.exceeds(bound * math.exp(1.0 / max(1, free.steps)))


def _nothing_claimed(free: March, interior: bool) -> tuple[bool, str]:
    """Without an admissible mode random data must not grow, unless it is the interior scheme that is said to."""
    if not _outgrows(free, 1.0):
        return True, "growth this slow may be a transient" if free.growth.exceeds(1.0) else ""
    if interior:
        return True, "the interior scheme is unstable by itself, and its waves grow"
    seen = f"{free.growth.rate:.6g} ± {free.growth.uncertainty:.2g}"
    return False, f"random data grow by {seen} a step, and no mode was predicted"


def _observation(
    problem: Problem, z: complex, kind: str, free: Growth, interior: bool, seed: int
) -> tuple[Growth, str, str]:
    """The march that can speak about this mode (growth, name, remark): random data, the mode itself, or forcing."""
    if kind == "growing" and not interior and free.exceeds(1.0) and free.uncertainty < AGREEMENT * free.rate:
        return free, "random data", ""
    if kind == "generalized":
        forced = forced_march(problem, z / abs(z), seed=seed)
        seen = f"forced at z the response grows as n**({forced.exponent:.2f} ± {forced.uncertainty:.2g})"
        return free, "random data", seen
    unknown = Growth(free.rate, math.inf, free.how)
    try:
        found = mode_march(problem, z, seed)
    except (OutOfReach, NotAnalysable):
        return unknown, "random data", "the mode reaches too far, or decays too fast, to be marched by itself"
    if found is not None:
        return found[2], "from the mode", ""
    if interior:
        return unknown, "random data", "growing waves of the interior hide the mode"
    return free, "random data", "the finite problem has no such mode near the boundary"


def _agrees(predicted: float, seen: Growth, free: March | None) -> tuple[bool, str]:
    """Whether observation and prediction are compatible, and what to say about it.

    They agree if they differ by no more than the uncertainty or AGREEMENT, are not on different sides of abs(z) = 1
    beyond the uncertainty (but for rounding of a predicted 1), and random data, if given, do not outgrow both the
    prediction and 1.
    """
    if seen.uncertainty == math.inf:
        return True, "the march cannot tell"
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
