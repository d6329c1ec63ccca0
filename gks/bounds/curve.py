"""The stable-CFL curve: lam_max and all stable intervals over a sweep, or at one point.

Sweeps take the batched route where it applies, in blocks, and the exact route for every point that the batch leaves
open; other schemes take the exact route throughout.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

from gks.bounds.cfl import Limit, stable_set
from gks.bounds.sweep import Point, Sweep
from gks.errors import InputError, ParameterError, quoted
from gks.modes.algebraic import Root
from gks.modes.numerals import exact_fraction, json_real, text_real
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gks.bounds.batch import BatchSet

Progress = Callable[[int, int], None]

DOUBLE_ERROR = 2.0**-53
"""Relative error of an exact end once it is rounded to a double."""

BLOCK = 20_000
"""Points of a sweep between two reports of progress."""


Number = float | str
"""A number as JSON has it: a double, a decimal string beyond the doubles, "oo" for infinity."""


class CurvePoint(NamedTuple):
    """One point. ``error_bound`` is relative, absolute at 0; where ``resolved`` is False, ``because`` says why."""

    value: Number | None
    lam_max: Number | None
    limited_by: Limit | None
    stable_set: tuple[tuple[Number, Number], ...]
    error_bound: float
    resolved: bool
    because: str = ""

    def to_json(self, name: str | None) -> dict[str, object]:
        point: dict[str, object] = {} if name is None else {name: self.value}
        point["lam_max"] = self.lam_max
        point["limited_by"] = self.limited_by
        point["stable_set"] = self.stable_set
        point["error_bound"] = self.error_bound
        point["status"] = "resolved" if self.resolved else "undecided"
        return point


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve: its scheme, the parameter swept (None for one point), and the points in order."""

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    sweep: Sweep | None
    points: Sequence[CurvePoint]
    time_s: float = field(compare=False)

    def to_json(self) -> dict[str, object]:
        name = self.sweep.name if self.sweep else None
        return {
            "schema": "gks.curve/1",
            "sweep": name,
            "points": [point.to_json(name) for point in self.points],
            "time_s": self.time_s,
        }

    def json_text(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)

    def to_csv(self) -> str:
        """Columns: the swept parameter, lam_max, limited_by, error_bound; `inf` for unbounded, empty where
        undecided.
        """
        head = [self.sweep.name] if self.sweep else []
        rows = [",".join([*head, "lam_max", "limited_by", "error_bound"])]
        for value, lam, limit, _, error, _, _ in self.points:
            first = f"{value}," if head else ""
            top = "" if lam is None else "inf" if lam == "oo" else lam
            rows.append(f"{first}{top},{limit or ''},{error}")
        return "\n".join(rows) + "\n"

    @property
    def values(self) -> NDArray[np.float64]:
        """The swept parameter, as doubles (nan where there is none)."""
        return _array(point.value for point in self.points)

    @property
    def lam_max(self) -> NDArray[np.float64]:
        """lam_max as doubles: inf where unbounded, nan where undecided."""
        return _array(point.lam_max for point in self.points)

    def __str__(self) -> str:
        lines = [self.scheme.title]
        fixed = {
            k: v
            for k, v in self.parameters.items()
            if k != self.scheme.cfl and (not self.sweep or k != self.sweep.name)
        }
        if fixed:
            lines.append("  at " + ", ".join(f"{name} = {text_real(value)}" for name, value in fixed.items()))
        name = self.sweep.name if self.sweep else ""
        lines.append(f"  {name:<22} {self.scheme.cfl + '_max':<22} limited by  stable set")
        shown = (
            list(self.points)
            if len(self.points) <= SHOWN
            else [*self.points[: SHOWN // 2], None, *self.points[-SHOWN // 2 :]]
        )
        lines += [self._line(point) if point is not None else "  ..." for point in shown]
        open_points = sum(not point.resolved for point in self.points)
        tail = f", {open_points} undecided" if open_points else ""
        lines.append(f"  ({len(self.points)} point{'s' * (len(self.points) != 1)}{tail}, {self.time_s:.3g} s)")
        return "\n".join(lines)

    def _line(self, point: CurvePoint) -> str:
        value = _text(point.value)
        if not point.resolved:
            return f"  {value:<22} undecided: {point.because}"
        spans = " ".join(f"({_text(lo)}, {_text(hi)})" for lo, hi in point.stable_set)
        return f"  {value:<22} {_text(point.lam_max):<22} {point.limited_by or '':<11} {spans or 'empty'}"


def _text(value: Number | None) -> str:
    return "" if value is None else value if isinstance(value, str) else f"{value:.15g}"


def _array(numbers: Iterable[Number | None]) -> NDArray[np.float64]:
    import numpy as np

    return np.array([np.nan if n is None else float("inf") if n == "oo" else float(n) for n in numbers])


SHOWN = 24
"""Points that a printed curve shows: the first and last half of them where there are more."""


def curve(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    over: Sweep | None = None,
    progress: Progress | None = None,
) -> Curve:
    """The curve over a sweep, or the one point at the values given.

    ``progress`` is called with the number of points done and the number there are. Values of the swept parameter at
    which there is no scheme (a division by zero, a degenerate closure) are flagged points. Raises InputError as the
    analyses do, in a sweep where they do at every point.
    """
    start = perf_counter()
    if over is None:
        points: Sequence[CurvePoint] = [_exact_point(scheme, values, None)]
    else:
        scheme.parameter(over.name)
        if over.name == scheme.cfl:
            raise ParameterError(
                f"{quoted(over.name)} is the number whose bound is sought",
                path="--sweep",
                expected="another parameter to sweep over",
            )
        faults: list[InputError] = []
        points = list(_swept(scheme, values, over, progress, faults))
        if len(faults) == len(points):
            raise faults[0]
    return Curve(scheme, dict(values), over, points, perf_counter() - start)


def _swept(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    over: Sweep,
    progress: Progress | None,
    faults: list[InputError],
) -> Iterator[CurvePoint]:
    total = len(over.values)
    batched = total > 1
    done = 0
    while done < total:
        block = over.values[done : done + (BLOCK if batched else 1)]
        found = _batch(scheme, values, over.name, block) if batched else None
        if found is None:
            batched = False
            block = block[:1]
            yield _point_of_sweep(scheme, values, over.name, block[0], faults)
        else:
            yield from _batched_points(scheme, values, over.name, block, found, faults)
        done += len(block)
        if progress is not None:
            progress(done, total)


def _batch(scheme: Scheme, values: Mapping[str, Fraction], name: str, block: Sequence[Point]) -> BatchSet | None:
    from gks.bounds.batch import batch

    return batch(scheme, values, name, block)


def _batched_points(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    name: str,
    block: Sequence[Point],
    found: BatchSet,
    faults: list[InputError],
) -> Iterator[CurvePoint]:
    stable = found.stable
    errors = stable.error().tolist()
    lows, highs, counts = stable.lo.tolist(), stable.hi.tolist(), stable.count.tolist()
    limits, resolved = found.interior_limit.tolist(), stable.resolved.tolist()
    for value, low, high, count, error, limit, good in zip(
        block, lows, highs, counts, errors, limits, resolved, strict=True
    ):
        if not good:
            yield _point_of_sweep(scheme, values, name, value, faults)
            continue
        spans = tuple((low[j], "oo" if high[j] == INFINITE else high[j]) for j in range(count))
        first = high[0] if count and low[0] == 0 else 0.0
        by: Limit | None = None if first == INFINITE else "interior" if first == limit else "closure"
        top = "oo" if first == INFINITE else first
        yield CurvePoint(_number(value), top, by, spans, error + DOUBLE_ERROR if error else 0.0, True)


INFINITE = float("inf")


def _number(value: Point) -> Number:
    return value if isinstance(value, float) else json_real(value)


def _point_of_sweep(
    scheme: Scheme, values: Mapping[str, Fraction], name: str, value: Point, faults: list[InputError]
) -> CurvePoint:
    try:
        return _exact_point(scheme, {**values, name: Fraction(value)}, value)
    except InputError as fault:
        faults.append(fault)
        return CurvePoint(_number(value), None, None, (), 0.0, False, str(fault))


def _exact_point(scheme: Scheme, values: Mapping[str, Fraction], value: Point | None) -> CurvePoint:
    shown = None if value is None else _number(value)
    found = stable_set(scheme, values)
    if found.undecided is not None:
        return CurvePoint(shown, None, None, (), 0.0, False, found.undecided)
    spans = tuple((_end(i.low, 0.0), _end(i.high, "oo")) for i in found.intervals)
    exact = all(_is_printed(end) for i in found.intervals for end in (i.low, i.high))
    top = _end(found.lam_max, "oo") if not semi_discrete(scheme) else None
    return CurvePoint(shown, top, found.limited_by, spans, 0.0 if exact else DOUBLE_ERROR, True)


def semi_discrete(scheme: Scheme) -> bool:
    """Whether time is exact: then stability does not depend on lam, and there is no lam_max."""
    return any(half_line.time == "exact" for half_line in scheme.domains)


def _end(end: Root | None, otherwise: Number) -> Number:
    """An end of an interval: its double, rounded from an enclosure with bits to spare."""
    if end is None:
        return otherwise
    rational = end.rational
    return json_real(exact_fraction(end.ball(_ROUNDING_BITS).real) if rational is None else rational)


def _is_printed(end: Root | None) -> bool:
    """Whether the number shown for an end is the end itself and not its rounding."""
    if end is None:
        return True
    rational = end.rational
    return rational is not None and Fraction(json_real(rational)) == rational


_ROUNDING_BITS = 80
