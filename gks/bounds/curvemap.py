"""lam_max over two parameters: a curve over the second for every value of the first."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING

from gks.bounds.curve import Progress, check_sweep, shown_number, sweep_points
from gks.bounds.point import CurvePoint, Number, Tier, number, weakest
from gks.bounds.points import lam_max_of
from gks.bounds.sweep import MAX_POINTS, Sweep
from gks.errors import InputError, ParameterError, quoted
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class CurveMap:
    """A map: its scheme, the two parameters swept, and a row of points for each value of the first."""

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    sweeps: tuple[Sweep, Sweep]
    rows: Sequence[Sequence[CurvePoint]]
    time_s: float | None = field(compare=False)

    @property
    def names(self) -> tuple[str, str]:
        """The two parameters."""
        return self.sweeps[0].name, self.sweeps[1].name

    @property
    def values(self) -> tuple[list[Number], list[Number]]:
        """What they run through."""
        first, second = ([number(v) for v in each.values] for each in self.sweeps)
        return first, second

    @property
    def lam_max(self) -> NDArray[np.float64]:
        """lam_max as doubles, a row for each value of the first parameter: inf where unbounded, nan where undecided."""
        import numpy as np

        return np.stack([lam_max_of(row) for row in self.rows])

    @property
    def tier(self) -> Tier:
        """As `Curve.tier`."""
        return weakest(point for row in self.rows for point in row)

    def to_json(self) -> dict[str, object]:
        first, second = self.names
        points = [
            {first: value, **point.to_json(second)}
            for value, row in zip(self.values[0], self.rows, strict=True)
            for point in row
        ]
        return {
            "schema": "gks.curve/1",
            "sweep": [first, second],
            "points": points,
            "tier": self.tier,
            "time_s": self.time_s,
        }

    def json_text(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)

    def to_csv(self) -> str:
        """Columns: both parameters, lam_max, limited_by, error_bound; `inf` for unbounded, empty where undecided."""
        lines = [",".join([*self.names, "lam_max", "limited_by", "error_bound"])]
        for value, row in zip(self.values[0], self.rows, strict=True):
            for point in row:
                top = "" if point.lam_max is None else "inf" if point.lam_max == "oo" else point.lam_max
                lines.append(f"{value},{point.value},{top},{point.limited_by or ''},{point.error_bound}")
        return "\n".join(lines) + "\n"

    def __str__(self) -> str:
        every = [point for row in self.rows for point in row]
        known = [point for point in every if point.resolved]
        order = sorted(known, key=lambda p: float("inf") if p.lam_max == "oo" else float(p.lam_max or 0))
        lines = [self.scheme.title, f"  {self.scheme.cfl}_max over {' and '.join(self.names)}"]
        if order:
            low, high = order[0].lam_max, order[-1].lam_max
            lines.append(f"  from {shown_number(low)} to {shown_number(high)}")
        open_ = len(every) - len(known)
        tail = f", {open_} undecided" if open_ else ""
        time = "" if self.time_s is None else f", {self.time_s:.3g} s"
        shape = " x ".join(str(len(each.values)) for each in self.sweeps)
        lines.append(f"  ({shape} points{tail}{time}; -o writes them, --json prints them)")
        return "\n".join(lines)


def curve_map(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    sweeps: Sequence[Sweep],
    progress: Progress | None = None,
    *,
    limit: float | None = None,
    certify: bool = False,
) -> CurveMap:
    """The map over two sweeps; points are flagged and faults raised as by `curve`."""
    start = perf_counter()
    first, second = checked_pair(scheme, sweeps)
    rows: list[Sequence[CurvePoint]] = []
    faults: list[InputError] = []
    across, down = len(second.values), len(first.values)
    for k, value in enumerate(first.values):
        told = None if progress is None else _shifted(progress, k * across, across * down)
        at = {**values, first.name: Fraction(value)}
        row, mine = sweep_points(scheme, at, second, told, limit=limit, certify=certify)
        rows.append(row)
        faults += mine
    if len(faults) == across * down:
        raise faults[0]
    return CurveMap(scheme, dict(values), (first, second), rows, perf_counter() - start)


def checked_pair(scheme: Scheme, sweeps: Sequence[Sweep]) -> tuple[Sweep, Sweep]:
    """The two sweeps, both of parameters that can run; ParameterError otherwise."""
    if len(sweeps) != 2:
        raise ParameterError(f"{len(sweeps)} parameters run", expected="two at most", mend="set the others")
    first, second = sweeps
    for each in sweeps:
        check_sweep(scheme, each)
    if first.name == second.name:
        raise ParameterError(f"{quoted(first.name)} runs twice", path="--sweep", expected="two parameters")
    total = len(first.values) * len(second.values)
    if total > MAX_POINTS:
        raise ParameterError(f"a map of {total} points", path="--sweep", expected=f"{MAX_POINTS} at most")
    return first, second


def _shifted(progress: Progress, done: int, total: int) -> Progress:
    return lambda k, _: progress(done + k, total)
