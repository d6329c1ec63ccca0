"""Pictures of two parameters: what is known, what is unbounded and what is open can be told apart."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gks import catalogue
from gks.bounds.curvemap import CurveMap
from gks.bounds.point import flagged
from gks.bounds.radius import RadiusMap
from gks.bounds.sweep import parse_sweep
from gks.bounds.sweeping import swept
from gks.reports import maps

SCHEME = catalogue.find("weighted-1-unequal")
SWEEPS = [parse_sweep("alpha=1e-2:1e2:5:log"), parse_sweep(f"{SCHEME.parameters[-1].name}=0.5:2:4")]


def lam_max() -> CurveMap:
    found = swept(SCHEME, SCHEME.values({}), SWEEPS)
    assert isinstance(found, CurveMap)
    return found


def moduli(*specs: str) -> RadiusMap:
    scheme = catalogue.find("traditional-2")
    found = swept(scheme, scheme.values({}), [parse_sweep(spec) for spec in specs])
    assert isinstance(found, RadiusMap)
    return found


def axes_of(draw: object, result: object) -> Axes:
    axes = Figure().add_subplot()
    draw(result, axes)  # type: ignore[operator]
    return axes


class TestLamMax:
    def test_axes_follow_the_sweeps(self) -> None:
        axes = axes_of(maps.draw_map, lam_max())
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")
        assert "alpha" in axes.get_xlabel()
        assert SWEEPS[1].name in axes.get_ylabel()

    def test_undecided_points_are_crosses(self) -> None:
        found = lam_max()
        rows = [list(row) for row in found.rows]
        rows[2][1] = flagged(SWEEPS[1].values[1], "as a test wants it")
        axes = axes_of(maps.draw_map, replace(found, rows=rows))
        (line,) = (line for line in axes.lines if line.get_label() == "undecided")
        assert np.asarray(line.get_xydata()).tolist() == [[1.0, 1.0]]

    def test_contours_lie_inside(self) -> None:
        ranges = ((0.2, 0.9, False), (1e-6, 1.0, True), (0.1, 0.30001, True), (0.5, 0.50001, False))
        for low, high, logarithmic in ranges:
            levels = maps._levels(np.array([low, high]), logarithmic=logarithmic)
            assert levels
            assert all(low < level < high for level in levels)

    @pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
    def test_files(self, tmp_path: Path, ending: str) -> None:
        path = tmp_path / f"map.{ending}"
        maps.save(lam_max(), str(path))
        again = tmp_path / f"again.{ending}"
        maps.save(lam_max(), str(again))
        assert path.read_bytes() == again.read_bytes()
        assert len(path.read_bytes()) > 1000


class TestModuli:
    def test_the_unit_circle_and_the_interior_are_marked(self) -> None:
        found = moduli("alpha=0.1:10:9:log", "lam=0.1:1.3:7")
        axes = axes_of(maps.draw_radius_map, found)
        assert axes.get_xscale() == "log"
        assert len(axes.collections) >= 3  # the surface, abs(z) = 1, the hatching

    def test_over_lam_alone_it_is_a_line(self) -> None:
        axes = axes_of(maps.draw_moduli, moduli("lam=0.1:1.3:7"))
        heights = np.asarray(axes.lines[0].get_ydata())
        assert np.isfinite(heights).tolist() == [True] * 5 + [False] * 2  # unstable inside from lam = 1 on
