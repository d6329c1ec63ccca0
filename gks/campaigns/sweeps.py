"""Stable-CFL curves and maps in chunks: the same points as in one piece, on any workers, checkpointed.

A sweep is cut by its number of points alone, so the workers have no say in what a chunk is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from hashlib import sha256
from math import prod
from typing import Any

import gks
from gks.bounds.batch import samples
from gks.bounds.curve import Curve, check_sweep, curve, sweep_points
from gks.bounds.curvemap import CurveMap, checked_pair
from gks.bounds.point import CurvePoint
from gks.bounds.sweep import Point, Sweep
from gks.campaigns.checkpoint import Key
from gks.campaigns.conduct import Conduct, Progress
from gks.errors import ParameterError
from gks.scheme.model import Scheme

CHUNKS = 64
"""Chunks of a sweep, if none is to have over LARGEST points: enough for some workers to finish together, few enough
for what every chunk computes once for its scheme not to weigh."""

LARGEST = 20_000
"""Points of a chunk at most: a tenth of a second on the batched route."""

SMALLEST = 2
"""Points of a piece at least: a lone point takes another route than several, with other last digits."""

Piece = tuple[Mapping[str, Fraction], tuple[Point, ...]]
"""Values that stand and points that the last of the swept parameters runs through."""


def campaign_curve(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    sweeps: Sequence[Sweep],
    conduct: Conduct,
    *,
    limit: float | None = None,
    certify: bool = False,
) -> Curve | CurveMap:
    """The curve over one sweep or the map over two, carried out as ``conduct`` says; its progress is told in points.

    ``limit`` (seconds a point; which points it flags depends on the machine) and ``certify`` are those of `curve`, and
    chunks that were computed with others are another campaign's. The result carries no time: it is the same whatever
    computed it, and a part of it may come from a run that was ended. Raises InputError as `curve` does, and for a
    folder of another sweep.
    """
    if not sweeps:
        raise ParameterError("no parameter runs", expected="a sweep, which is what workers share and folders keep")
    if len(sweeps) > 1:
        sweeps = checked_pair(scheme, sweeps)
    else:
        check_sweep(scheme, sweeps[0])
    over = sweeps[-1]
    total = prod(len(each.values) for each in sweeps)
    pieces = list(_grouped(_pieces(values, sweeps, _size(total)), _size(total)))
    told = None if conduct.progress is None else _in_points(conduct.progress, total)
    at = samples(over.values)
    arguments = [(scheme, over.name, piece, over.logarithmic, limit, certify, at) for piece in pieces]
    key = _key(scheme, values, sweeps, len(pieces), limit, certify)
    results = conduct.results(chunk, arguments, key, told)
    if all(result["faults"] == len(result["points"]) for result in results):
        first, points = pieces[0][0]
        return curve(scheme, first, Sweep(over.name, points[:1], over.logarithmic))  # raises the fault of the first
    return _together(scheme, values, sweeps, [_point(row) for result in results for row in result["points"]])


def chunk(
    scheme: Scheme,
    name: str,
    pieces: Sequence[Piece],
    logarithmic: bool,
    limit: float | None,
    certify: bool,
    at: Sequence[Point],
) -> dict[str, object]:
    """The points of some pieces, as JSON has them, and at how many of them there is no scheme."""
    points: list[list[object]] = []
    faults = 0
    for values, run in pieces:
        piece = Sweep(name, run, logarithmic)
        found, faulty = sweep_points(scheme, values, piece, limit=limit, certify=certify, samples=at)
        points += [list(point) for point in found]
        faults += len(faulty)
    return {"points": points, "faults": faults}


def _size(total: int) -> int:
    """Points of a chunk, about."""
    return max(SMALLEST, min(LARGEST, -(-total // CHUNKS)))


def _pieces(values: Mapping[str, Fraction], sweeps: Sequence[Sweep], size: int) -> Iterator[Piece]:
    """The rows of a map, or the one of a curve, each cut where it is longer than a chunk."""
    for first in sweeps[0].values if len(sweeps) == 2 else [None]:
        at = dict(values) if first is None else {**values, sweeps[0].name: Fraction(first)}
        for piece in cut(sweeps[-1].values, size):
            yield at, piece


def cut(points: Sequence[Point], size: int) -> list[tuple[Point, ...]]:
    """The points in pieces of that size, in order; the last is longer where it would be a lone point."""
    pieces = [tuple(points[k : k + size]) for k in range(0, len(points), size)]
    if len(pieces) > 1 and len(pieces[-1]) < SMALLEST:
        last = pieces.pop()
        pieces[-1] += last
    return pieces


def _grouped(pieces: Iterable[Piece], size: int) -> Iterator[list[Piece]]:
    """Short rows of a map together, so that there are about CHUNKS chunks."""
    group: list[Piece] = []
    points = 0
    for piece in pieces:
        group.append(piece)
        points += len(piece[1])
        if points >= size:
            yield group
            group, points = [], 0
    if group:
        yield group


def _together(
    scheme: Scheme, values: Mapping[str, Fraction], sweeps: Sequence[Sweep], points: list[CurvePoint]
) -> Curve | CurveMap:
    if len(sweeps) == 1:
        return Curve(scheme, dict(values), sweeps[0], points, None)
    across = len(sweeps[1].values)
    rows = [points[k : k + across] for k in range(0, len(points), across)]
    return CurveMap(scheme, dict(values), (sweeps[0], sweeps[1]), rows, None)


def _point(row: Sequence[Any]) -> CurvePoint:
    entries: list[Any] = [tuple(map(tuple, entry)) if isinstance(entry, list) else entry for entry in row]
    return CurvePoint(*entries)


def _key(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    sweeps: Sequence[Sweep],
    chunks: int,
    limit: float | None,
    certify: bool,
) -> Key:
    """What the chunks depend on: scheme, values, sweeps, limit and certify, and the program's version."""
    swept = [f"{each.name}: {len(each.values)} points, {_digest(','.join(map(str, each.values)))}" for each in sweeps]
    return {
        "campaign": "gks.curve/1",
        "version": gks.__version__,
        "scheme": _digest(scheme.text),
        "values": ", ".join(f"{k} = {v}" for k, v in values.items() if k not in [each.name for each in sweeps]),
        "sweep": "; ".join(swept),
        "chunks": chunks,
        "limit": str(limit),
        "certify": str(certify),
    }


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()


def _in_points(progress: Progress, total: int) -> Progress:
    """Progress in points, told in chunks: these finish in any order, so the points are those of an average one."""
    return lambda done, chunks: progress(total * done // chunks, total)
