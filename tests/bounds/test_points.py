"""The points of a sweep as columns: the same points, one by one or all at once, as the list of them."""

from __future__ import annotations

import pickle
from fractions import Fraction

import numpy as np
import pytest

from gks import catalogue
from gks.bounds.curve import Curve, curve
from gks.bounds.point import CurvePoint, weakest
from gks.bounds.points import Columns, Points, lam_max_of, rows_of, tier_of, undecided
from gks.bounds.sweep import of_values

SCHEME = catalogue.find("traditional-1")
VALUES = [Fraction(v) for v in ("1/2", "1", "0", "3", "31/9", "1e300", "1e400")]
"""0 has no scheme; 3 (closure and interior meet) and what leaves the doubles go to the exact route."""


@pytest.fixture(scope="module")
def found() -> Curve:
    return curve(SCHEME, SCHEME.values({}), of_values("alpha", VALUES))


def test_a_point_is_the_same_however_it_is_reached(found: Curve) -> None:
    points = found.points
    every = list(points)
    assert len(points) == len(every) == len(VALUES)
    assert [points[k] for k in range(len(points))] == every
    assert [points[k - len(points)] for k in range(len(points))] == every
    assert points[1:6:2] == every[1:6:2]
    assert isinstance(points[2:], list)
    with pytest.raises(IndexError):
        points[len(points)]


def test_points_equal_any_sequence_of_the_same_points(found: Curve) -> None:
    points, every = found.points, list(found.points)
    assert points == every
    assert every == points
    assert points != every[:-1]
    assert points != [*every[:-1], every[0]]
    assert pickle.loads(pickle.dumps(points)) == points


def test_what_is_read_off_the_columns_is_what_the_points_say(found: Curve) -> None:
    every = list(found.points)
    assert list(rows_of(found.points)) == [(p.value, p.lam_max, p.limited_by, p.error_bound) for p in every]
    assert undecided(found.points) == sum(not p.resolved for p in every) == 1
    assert tier_of(found.points) == weakest(every) == "certified"
    np.testing.assert_array_equal(lam_max_of(found.points), lam_max_of(every))
    assert np.isnan(found.lam_max[2])


def test_blocks_in_a_row_are_one_sequence(found: Curve) -> None:
    (block,) = found.points.blocks if isinstance(found.points, Points) else ()
    assert isinstance(block, Columns)
    plain = [CurvePoint(7.0, None, None, (), 0.0, False, "left open")]
    both = Points((block, plain, block))
    assert list(both) == [*block, *plain, *block]
    assert [both[k] for k in range(len(both))] == list(both)
    assert undecided(both) == 3
    assert list(Points(())) == []
