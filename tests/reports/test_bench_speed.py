"""The speed table: its baselines answer the same questions, and a row says whether its target is met."""

from __future__ import annotations

from fractions import Fraction

import pytest

from gks.api import load
from gks.bounds.curve import curve
from gks.modes.analysis import quick_verdict
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import ModeKind, Verdict
from gks.modes.wide import wide_modes
from gks.reports import bench_speed
from gks.reports.bench_speed import COLUMNS, DISTANCE, LAX_WENDROFF_NEUTRAL, interface, row, timed

SCHEME = load("traditional-1").scheme


def test_the_loop_over_numpy_roots_has_the_same_lam_max() -> None:
    for alpha in ("1/2", "9", "1000"):
        point = curve(SCHEME, SCHEME.values({"alpha": alpha})).points[0]
        assert bench_speed._looped(float(Fraction(alpha))) == pytest.approx(point.lam_max, rel=1e-12)


def test_bisecting_the_finite_matrix_has_it_roughly() -> None:
    values = SCHEME.values({"alpha": 9})
    point = curve(SCHEME, values).points[0]
    assert bench_speed._scanned(SCHEME, values) == pytest.approx(point.lam_max, rel=1e-2)


@pytest.mark.parametrize("lam", ["1/20", "1/2", "19/20"])
def test_the_lax_wendroff_interface_is_neutral_where_the_table_says(lam: str) -> None:
    scheme = interface("lax-wendroff")
    values = {"lam": Fraction(lam), "alpha": LAX_WENDROFF_NEUTRAL}
    assert quick_verdict(scheme, values) is Verdict.NEUTRAL


def test_a_certified_count_on_either_side_of_neutral() -> None:
    scheme = interface("lax-wendroff")
    for side, growing in ((1, 2), (-1, 0)):
        values = {"lam": Fraction(1, 2), "alpha": LAX_WENDROFF_NEUTRAL * (1 + side * DISTANCE)}
        found = wide_modes(normal_mode_problem(scheme, values))
        assert found.certified
        assert sum(mode.kind is ModeKind.GROWING for mode in found.modes) == growing


def test_the_neutral_value_that_is_searched_for() -> None:
    found = bench_speed.neutral(interface("lax-wendroff"), Fraction(1, 2))
    assert found is not None and abs(found / LAX_WENDROFF_NEUTRAL - 1) < DISTANCE / 1000


def test_the_wide_scheme_has_a_weight_to_run_along() -> None:
    scheme = bench_speed.weighted_order_8()
    assert [p.name for p in scheme.parameters] == ["a", "lam"]
    assert quick_verdict(scheme, scheme.values()) is Verdict.STABLE
    assert quick_verdict(scheme, scheme.values({"a": 3})) is Verdict.UNSTABLE


def test_a_row_says_whether_the_target_is_met() -> None:
    mine = timed(10, lambda: None, 1)
    assert len(row("x", mine)) == len(COLUMNS)
    slow = type(mine)(points=10, seconds=1.0)
    fast = type(mine)(points=1000, seconds=1.0)
    assert row("x", slow, "loop", fast, rate=100)[-3:] == (0.01, "1e+02 points/s", False)
    assert row("x", fast, rate=100)[-1] is True
    assert row("x", slow, limit=0.1)[-1] is True and row("x", slow, limit=0.01)[-1] is False
    assert row("x", slow)[-1] is None
