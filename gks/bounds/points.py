"""The points of a sweep, held as columns: a point becomes an object when it is looked at.

A block of the batched route is arrays and the few points found by themselves; blocks in a row are one sequence of
`CurvePoint`, and what is asked of all points at once (lam_max, the tier, the rows of a table) is read off the arrays.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, overload

from gks.bounds.cfl import Limit
from gks.bounds.point import DOUBLE_ERROR, CurvePoint, Number, Tier, number, weakest
from gks.bounds.sweep import Point

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gks.bounds.batch import BatchSet

Row = tuple[Number | None, Number | None, Limit | None, float]
"""The swept parameter, lam_max, limited_by, error_bound: None as in `CurvePoint`."""

INFINITE = float("inf")


class PointSequence(Sequence[CurvePoint]):
    """What the two kinds of sequence here share: slices are lists, and any sequence of the same points is equal."""

    __slots__ = ()

    def _at(self, index: int) -> CurvePoint:
        raise NotImplementedError

    @overload
    def __getitem__(self, index: int) -> CurvePoint: ...
    @overload
    def __getitem__(self, index: slice) -> list[CurvePoint]: ...
    def __getitem__(self, index: int | slice) -> CurvePoint | list[CurvePoint]:
        if isinstance(index, slice):
            return [self._at(k) for k in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"point {index} of {len(self)}")
        return self._at(index % len(self))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Sequence):
            return NotImplemented
        return len(self) == len(other) and all(a == b for a, b in zip(self, other, strict=True))

    __hash__ = None  # type: ignore[assignment]  # as a list: equal sequences are of several kinds


@dataclass(frozen=True, eq=False)
class Columns(PointSequence):
    """The points of one batch, and those of them that it left open, which were found by themselves."""

    parameter: Sequence[Point]
    found: BatchSet
    others: Mapping[int, CurvePoint]

    def __len__(self) -> int:
        return len(self.parameter)

    def _at(self, index: int) -> CurvePoint:
        if index in self.others:
            return self.others[index]
        stable = self.found.stable
        tops, bys, errors = self._columns
        ends = zip(stable.lo[index].tolist(), stable.hi[index].tolist(), strict=True)
        spans = list(ends)[: int(stable.count[index])]
        return _point(self.parameter[index], tops[index], bys[index], spans, errors[index])

    def __iter__(self) -> Iterator[CurvePoint]:
        stable = self.found.stable
        ends = zip(stable.lo.tolist(), stable.hi.tolist(), stable.count.tolist(), strict=True)
        rows = zip(self.parameter, *self._columns, ends, strict=True)
        for k, (value, top, by, error, (low, high, count)) in enumerate(rows):
            if k in self.others:
                yield self.others[k]
            else:
                yield _point(value, top, by, list(zip(low, high, strict=True))[:count], error)

    @cached_property
    def _columns(self) -> tuple[list[Number], list[Limit | None], list[float]]:
        """lam_max, limited_by and error_bound of the points of the batch."""
        import numpy as np

        limits: list[Limit | None] = [None, "interior", "closure"]
        error = self.found.stable.error()
        tops = self._top
        which = np.where(tops == INFINITE, 0, np.where(tops == self.found.interior_limit, 1, 2))
        shown: list[Number] = tops.tolist()
        for k in np.flatnonzero(tops == INFINITE).tolist():
            shown[k] = "oo"
        return shown, [limits[k] for k in which.tolist()], np.where(error > 0, error + DOUBLE_ERROR, 0.0).tolist()

    @property
    def _top(self) -> NDArray[np.float64]:
        """The end of the first interval where that begins at 0, else 0."""
        import numpy as np

        stable = self.found.stable
        return np.where((stable.count > 0) & (stable.lo[:, 0] == 0), stable.hi[:, 0], 0.0)

    def rows(self) -> Iterator[Row]:
        """As `Points.rows`."""
        for k, (value, top, by, error) in enumerate(zip(self.parameter, *self._columns, strict=True)):
            yield _row(self.others[k]) if k in self.others else (number(value), top, by, error)

    def lam_max(self) -> NDArray[np.float64]:
        """As `Points.lam_max`."""
        found = self._top
        for k, point in self.others.items():
            found[k] = to_double(point.lam_max)
        return found


def _point(
    value: Point, top: Number, by: Limit | None, spans: Sequence[tuple[float, float]], error: float
) -> CurvePoint:
    shown = tuple((low, "oo" if high == INFINITE else high) for low, high in spans)
    return CurvePoint(number(value), top, by, shown, error, True, "", "certified")


def _row(point: CurvePoint) -> Row:
    return point.value, point.lam_max, point.limited_by, point.error_bound


@dataclass(frozen=True, eq=False)
class Points(PointSequence):
    """Blocks of points in a row."""

    blocks: tuple[Sequence[CurvePoint], ...]

    @cached_property
    def _ends(self) -> list[int]:
        """How many points there are up to the end of each block."""
        total, ends = 0, []
        for block in self.blocks:
            total += len(block)
            ends.append(total)
        return ends

    def __len__(self) -> int:
        return self._ends[-1] if self.blocks else 0

    def _at(self, index: int) -> CurvePoint:
        place = bisect_right(self._ends, index)
        return self.blocks[place][index - self._ends[place] + len(self.blocks[place])]

    def __iter__(self) -> Iterator[CurvePoint]:
        for block in self.blocks:
            yield from block


def in_blocks(points: Sequence[CurvePoint]) -> Iterable[Sequence[CurvePoint]]:
    """The blocks of which some points are made."""
    return points.blocks if isinstance(points, Points) else (points,)


def rows_of(points: Sequence[CurvePoint]) -> Iterator[Row]:
    """What a table shows of every point."""
    for block in in_blocks(points):
        yield from block.rows() if isinstance(block, Columns) else map(_row, block)


def undecided(points: Sequence[CurvePoint]) -> int:
    """How many of the points are not resolved."""
    return sum(
        not point.resolved
        for block in in_blocks(points)
        for point in (block.others.values() if isinstance(block, Columns) else block)
    )


def tier_of(points: Sequence[CurvePoint]) -> Tier:
    """The weakest tier among the points that are resolved."""
    few: list[CurvePoint] = []
    for block in in_blocks(points):
        if isinstance(block, Columns):
            few += block.others.values()
            few += next(([block[k]] for k in range(len(block)) if k not in block.others), [])
        else:
            few += block
    return weakest(few)


def values_of(points: Sequence[CurvePoint]) -> NDArray[np.float64]:
    """The swept parameter, as doubles: nan where there is none, infinite beyond the doubles."""
    return to_array(value for value, *_ in rows_of(points))


def lam_max_of(points: Sequence[CurvePoint]) -> NDArray[np.float64]:
    """lam_max as doubles: inf where unbounded, nan where undecided."""
    import numpy as np

    columns = [
        block.lam_max() if isinstance(block, Columns) else to_array(point.lam_max for point in block)
        for block in in_blocks(points)
    ]
    return np.concatenate([np.empty(0), *columns])


def to_array(numbers: Iterable[Number | None]) -> NDArray[np.float64]:
    """Doubles: inf where unbounded, nan where there is no number."""
    import numpy as np

    return np.array([to_double(n) for n in numbers])


def to_double(value: Number | None) -> float:
    """The number as a double, infinite where it is "oo", nan where there is none."""
    return float("nan") if value is None else INFINITE if value == "oo" else float(value)
