"""The stable-CFL curve: lam_max and all stable intervals over a sweep, or at one point.

Sweeps take the batched route where it applies, in blocks; every point that the batch leaves open, and every point of
another scheme, is found by itself (`gks.bounds.point`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING, cast

from gks.bounds.cfl import Limit
from gks.bounds.point import DOUBLE_ERROR, CurvePoint, Number, Tier, flagged, number, point_at, weakest
from gks.bounds.sweep import Point, Sweep
from gks.bounds.timelimit import OverTime, limited
from gks.errors import InputError, ParameterError, quoted
from gks.modes.numerals import text_real
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gks.bounds.batch import BatchSet

Progress = Callable[[int, int], None]

BLOCK = 20_000
"""Points of a sweep that the batched route takes at once."""


@dataclass(frozen=True, slots=True)
class Curve:
    """A curve: its scheme, the parameter swept (None for one point), and the points in order.

    ``time_s`` is None where the points come from a campaign, which gives the same result however it was computed.
    """

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    sweep: Sweep | None
    points: Sequence[CurvePoint]
    time_s: float | None = field(compare=False)

    def to_json(self) -> dict[str, object]:
        name = self.sweep.name if self.sweep else None
        return {
            "schema": "gks.curve/1",
            "sweep": name,
            "points": [point.to_json(name) for point in self.points],
            "tier": self.tier,
            "time_s": self.time_s,
        }

    @property
    def tier(self) -> Tier:
        """The weakest among the points that are resolved: how all of them are known at least."""
        return weakest(self.points)

    def json_text(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)

    def to_csv(self) -> str:
        """Columns: the swept parameter, lam_max, limited_by, error_bound; `inf` for unbounded, empty where
        undecided.
        """
        head = [self.sweep.name] if self.sweep else []
        rows = [",".join([*head, "lam_max", "limited_by", "error_bound"])]
        for value, lam, limit, _, error, *_ in self.points:
            first = f"{value}," if head else ""
            top = "" if lam is None else "inf" if lam == "oo" else lam
            rows.append(f"{first}{top},{limit or ''},{error}")
        return "\n".join(rows) + "\n"

    @property
    def values(self) -> NDArray[np.float64]:
        """The swept parameter, as doubles (nan where there is none)."""
        return to_array(point.value for point in self.points)

    @property
    def lam_max(self) -> NDArray[np.float64]:
        """lam_max as doubles: inf where unbounded, nan where undecided."""
        return to_array(point.lam_max for point in self.points)

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
        time = "" if self.time_s is None else f", {self.time_s:.3g} s"
        lines.append(f"  ({len(self.points)} point{'s' * (len(self.points) != 1)}{tail}{time})")
        return "\n".join(lines)

    def _line(self, point: CurvePoint) -> str:
        value = shown_number(point.value)
        if not point.resolved:
            return f"  {value:<22} undecided: {point.because}"
        spans = " ".join(f"({shown_number(lo)}, {shown_number(hi)})" for lo, hi in point.stable_set)
        return f"  {value:<22} {shown_number(point.lam_max):<22} {point.limited_by or '':<11} {spans or 'empty'}"


def shown_number(value: Number | None) -> str:
    """A number for people: 15 digits, nothing where there is none."""
    return "" if value is None else value if isinstance(value, str) else f"{value:.15g}"


def to_array(numbers: Iterable[Number | None]) -> NDArray[np.float64]:
    """Doubles: inf where unbounded, nan where there is no number."""
    import numpy as np

    return np.array([np.nan if n is None else float("inf") if n == "oo" else float(n) for n in numbers])


SHOWN = 24
"""Points that a printed curve shows: the first and last half of them where there are more."""


def curve(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    over: Sweep | None = None,
    progress: Progress | None = None,
    *,
    limit: float | None = None,
    certify: bool = False,
) -> Curve:
    """The curve over a sweep, or the one point at the values given.

    ``progress`` is called with the number of points done and the number there are. Values of the swept parameter at
    which there is no scheme (a division by zero, a degenerate closure) are flagged points, and so are points that take
    over ``limit`` seconds; with ``certify`` also those that are not proved throughout. Raises InputError as the
    analyses do, in a sweep where they do at every point.
    """
    start = perf_counter()
    if over is None:
        (found,) = one_by_one(scheme, values, None, [None], limit=limit, certify=certify)
        if isinstance(found, InputError):
            raise found
        points: Sequence[CurvePoint] = [found]
    else:
        check_sweep(scheme, over)
        points, faults = sweep_points(scheme, values, over, progress, limit=limit, certify=certify)
        if len(faults) == len(points):
            raise faults[0]
    return Curve(scheme, dict(values), over, points, perf_counter() - start)


def check_sweep(scheme: Scheme, over: Sweep) -> None:
    """ParameterError where the parameter cannot run: it isn't the scheme's, or is the number whose bound is sought."""
    scheme.parameter(over.name)
    if over.name == scheme.cfl:
        raise ParameterError(
            f"{quoted(over.name)} is the number whose bound is sought",
            path="--sweep",
            expected="another parameter to sweep over",
        )


def sweep_points(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    over: Sweep,
    progress: Progress | None = None,
    *,
    limit: float | None = None,
    certify: bool = False,
    samples: Sequence[Point] | None = None,
) -> tuple[list[CurvePoint], list[InputError]]:
    """The points of a sweep or of a piece of one, and the faults at those where there is no scheme.

    A function of its arguments alone, which all pickle: a piece of two points or more with the whole sweep's
    ``samples`` (`gks.bounds.batch.samples`) gives the same points as the whole sweep, so that a campaign
    (`gks.campaigns.sweeps`) may compute pieces anywhere.
    """
    faults: list[InputError] = []
    points: list[CurvePoint] = []
    total = len(over.values)
    at = _samples(over.values) if samples is None else samples
    for start in range(0, total, BLOCK):
        block = over.values[start : start + BLOCK]
        found = _batch(scheme, values, over.name, block, at) if total > 1 else None
        known = [None] * len(block) if found is None else list(_batched_points(block, found))
        left = [value for value, point in zip(block, known, strict=True) if point is None]
        rest = one_by_one(scheme, values, over.name, left, limit=limit, certify=certify)
        for value, point in zip(block, known, strict=True):
            one = next(rest) if point is None else point
            if isinstance(one, InputError):
                faults.append(one)
                one = flagged(value, str(one))
            points.append(one)
            if progress is not None and (point is None or len(points) % STRIDE == 0):
                progress(len(points), total)
        if progress is not None:
            progress(len(points), total)
    return points, faults


STRIDE = 1000
"""Points of the batched route between two reports of progress."""


def one_by_one(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    name: str | None,
    points: Sequence[Point | None],
    *,
    limit: float | None,
    certify: bool,
) -> Iterator[CurvePoint | InputError]:
    """The points in order, each by itself; an InputError for one at which there is no scheme.

    With a limit they are computed by a process that is ended, and begun anew, where a point takes longer.
    """
    done = 0
    while done < len(points):
        arguments = (scheme, dict(values), name, points[done:], certify)
        if limit is None:
            for one in (_one(scheme, values, name, value, certify) for value in points):
                done += 1
                yield one
            continue
        try:
            for message in limited(report_points, arguments, limit):
                done += 1
                yield cast(CurvePoint | InputError, message)
        except OverTime as late:
            done += 1
            yield flagged(points[done - 1], str(late))


def report_points(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    name: str | None,
    points: Sequence[Point | None],
    certify: bool,
    report: Callable[[object], None],
) -> None:
    """Reports them one after the other, as `one_by_one` gives them."""
    for value in points:
        report(_one(scheme, values, name, value, certify))


def _one(
    scheme: Scheme, values: Mapping[str, Fraction], name: str | None, value: Point | None, certify: bool
) -> CurvePoint | InputError:
    at = values if name is None or value is None else {**values, name: Fraction(value)}
    try:
        return point_at(scheme, at, value, certify=certify)
    except InputError as fault:
        return fault


def _samples(points: Sequence[Point]) -> Sequence[Point]:
    from gks.bounds.batch import samples

    return samples(points)


def _batch(
    scheme: Scheme, values: Mapping[str, Fraction], name: str, block: Sequence[Point], at: Sequence[Point]
) -> BatchSet | None:
    from gks.bounds.batch import batch

    return batch(scheme, values, name, block, at)


def _batched_points(block: Sequence[Point], found: BatchSet) -> Iterator[CurvePoint | None]:
    """Those that the batch resolved; None for the others."""
    stable = found.stable
    errors = stable.error().tolist()
    lows, highs, counts = stable.lo.tolist(), stable.hi.tolist(), stable.count.tolist()
    for value, good, low, high, count, error, limit in zip(
        block, stable.resolved.tolist(), lows, highs, counts, errors, found.interior_limit.tolist(), strict=True
    ):
        if not good:
            yield None
            continue
        spans = tuple((low[j], "oo" if high[j] == INFINITE else high[j]) for j in range(count))
        first = high[0] if count and low[0] == 0 else 0.0
        by: Limit | None = None if first == INFINITE else "interior" if first == limit else "closure"
        top = "oo" if first == INFINITE else first
        bound = error + DOUBLE_ERROR if error else 0.0
        yield CurvePoint(number(value), top, by, spans, bound, True, "", "certified")


INFINITE = float("inf")
