"""The stable-CFL curve: lam_max and all stable intervals over a sweep, or at one point.

Sweeps take the batched route where it applies, in blocks; every point that the batch leaves open, and every point of
another scheme, is found by itself (`gks.bounds.point`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING, cast

from gks.bounds.point import CurvePoint, Number, Tier, flagged, point_at
from gks.bounds.points import Columns, Points, lam_max_of, rows_of, tier_of, undecided, values_of
from gks.bounds.sweep import Point, Sweep
from gks.bounds.timelimit import OverTime, limited
from gks.errors import InputError, ParameterError, quoted
from gks.modes.numerals import text_exact
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gks.bounds.batch import Batch

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
        return tier_of(self.points)

    def json_text(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)

    def to_csv(self) -> str:
        """Columns: the swept parameter, lam_max, limited_by, error_bound; `inf` for unbounded, empty where
        undecided.
        """
        head = [self.sweep.name] if self.sweep else []
        rows = [",".join([*head, "lam_max", "limited_by", "error_bound"])]
        for value, lam, limit, error in rows_of(self.points):
            first = f"{value}," if head else ""
            top = "" if lam is None else "inf" if lam == "oo" else lam
            rows.append(f"{first}{top},{limit or ''},{error}")
        return "\n".join(rows) + "\n"

    @property
    def values(self) -> NDArray[np.float64]:
        """The swept parameter, as doubles (nan where there is none)."""
        return values_of(self.points)

    @property
    def lam_max(self) -> NDArray[np.float64]:
        """lam_max as doubles: inf where unbounded, nan where undecided."""
        return lam_max_of(self.points)

    def __str__(self) -> str:
        lines = [self.scheme.title]
        fixed = {
            k: v
            for k, v in self.parameters.items()
            if k != self.scheme.cfl and (not self.sweep or k != self.sweep.name)
        }
        if fixed:
            lines.append("  at " + ", ".join(f"{name} = {text_exact(value)}" for name, value in fixed.items()))
        name = self.sweep.name if self.sweep else ""
        lines.append(f"  {name:<22} {self.scheme.cfl + '_max':<22} limited by  stable set")
        shown = (
            list(self.points)
            if len(self.points) <= SHOWN
            else [*self.points[: SHOWN // 2], None, *self.points[-SHOWN // 2 :]]
        )
        lines += [self._line(point) if point is not None else "  ..." for point in shown]
        open_points = undecided(self.points)
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
) -> tuple[Sequence[CurvePoint], list[InputError]]:
    """The points of a sweep or of a piece of one, and the faults at those where there is no scheme.

    A function of its arguments alone, which all pickle: a piece of two points or more with the whole sweep's
    ``samples`` (`gks.bounds.batch.samples`) gives the same points as the whole sweep, so that a campaign
    (`gks.campaigns.sweeps`) may compute pieces anywhere.
    """
    faults: list[InputError] = []
    blocks: list[Sequence[CurvePoint]] = []
    total, done = len(over.values), 0
    batched = _batched(scheme, values, over, samples) if total > 1 else None
    for start in range(0, total, BLOCK):
        block = over.values[start : start + BLOCK]
        found = None if batched is None else batched.at(block)
        open_ = range(len(block)) if found is None else found.open_points()
        done += len(block) - len(open_)
        left = [block[k] for k in open_]
        others: list[CurvePoint] = []
        rest = one_by_one(scheme, values, over.name, left, limit=limit, certify=certify)
        for value, one in zip(left, rest, strict=True):
            if isinstance(one, InputError):
                faults.append(one)
                one = flagged(value, str(one))
            others.append(one)
            done += 1
            if progress is not None:
                progress(done, total)
        blocks.append(others if found is None else Columns(block, found, dict(zip(open_, others, strict=True))))
        if progress is not None and not left:
            progress(done, total)
    return Points(tuple(blocks)), faults


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


def _batched(scheme: Scheme, values: Mapping[str, Fraction], over: Sweep, at: Sequence[Point] | None) -> Batch | None:
    from gks.bounds.batch import prepared, samples

    return prepared(scheme, values, over.name, samples(over.values) if at is None else at)
