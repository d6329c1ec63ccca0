"""A picture of a curve shows what the curve holds: every stable interval, what limits lam_max, what stayed open."""

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import gks
from gks.bounds.curve import Curve, curve
from gks.bounds.point import CurvePoint
from gks.bounds.sweep import Sweep, parse_sweep
from gks.catalogue import find
from gks.modes.numerals import json_real
from gks.reports import canvas, figures
from gks.reports.figures import curve_png, curve_svg, draw_comparison, draw_curve, save_curve

SCHEME = find("traditional-2")
ROOT = Path(__file__).parents[2]

TWO = ((0.0, 0.25), (0.5, 1.0))
ONE = ((0.0, 1.0),)


def point(value: float, spans: Sequence[tuple[Any, Any]], limited_by: Any = "closure") -> CurvePoint:
    first = spans[0][1] if spans and spans[0][0] == 0 else 0.0
    return CurvePoint(value, first, None if first == "oo" else limited_by, tuple(spans), 0.0, True)


def made(points: Sequence[CurvePoint], *, logarithmic: bool = True) -> Curve:
    """A curve of given points over alpha."""
    sweep = Sweep("alpha", parse_sweep(f"alpha=1:{len(points)}:{len(points)}").values, logarithmic)
    return Curve(SCHEME, SCHEME.values(), sweep, points, 0.0)


def drawn(curve: Curve) -> Axes:
    with canvas.styled():
        axes = Figure().add_subplot()
        draw_curve(curve, axes)
    return axes


def numbers(data: Any) -> list[float]:
    return [float(each) for each in data]


def legend(axes: Axes) -> set[str]:
    (box,) = axes.figure.legends
    return {text.get_text() for text in box.get_texts()}


def covered(axes: Axes, x: float, lam: float) -> bool:
    """Whether the filled region holds a point."""
    return any(path.contains_point((x, lam)) for region in axes.collections for path in region.get_paths())


# --- what is drawn


def test_the_filled_region_is_the_stable_set_also_where_it_is_no_interval() -> None:
    axes = drawn(made([point(1, ONE), point(2, TWO), point(3, TWO), point(4, ())], logarithmic=False))
    for x, lam, stable in [(1.2, 0.4, True), (2.5, 0.2, True), (2.5, 0.4, False), (2.5, 0.7, True), (3.9, 0.2, False)]:
        assert covered(axes, x, lam) is stable, (x, lam)


def test_neighbours_of_different_shape_are_not_joined() -> None:
    """From one interval to two, lam_max jumps from 1 to 1/4: no line may suggest the values between."""
    axes = drawn(made([point(1, ONE), point(2, ONE), point(3, TWO), point(4, TWO)]))
    thick = [line for line in axes.lines if line.get_linewidth() > 1]
    heights = {float(y) for line in thick for y in numbers(line.get_ydata())}
    assert heights == {1.0, 0.25}
    assert all(len(set(numbers(line.get_ydata()))) == 1 for line in thick)


def test_what_limits_differs_in_line_style_and_not_only_in_colour() -> None:
    axes = drawn(made([point(1, ONE, "interior"), point(2, ONE, "interior"), point(3, ((0.0, 0.5),)), point(4, ())]))
    styles = {line.get_linestyle() for line in axes.lines if line.get_linewidth() == figures.CLOSURE["linewidth"]}
    assert len(styles) == 2
    assert {"limited by the closure", "limited by the interior scheme", "stable"} <= legend(axes)


def test_undecided_points_are_marked_where_they_are() -> None:
    open_point = CurvePoint(2.0, None, None, (), 0.0, False, "the precision")
    axes = drawn(made([point(1, ONE), open_point, point(3, ONE)]))
    (marks,) = [line for line in axes.lines if line.get_marker() == "x"]
    assert numbers(marks.get_xdata()) == [2.0]
    assert "undecided" in legend(axes)
    assert not covered(axes, 2.0, 0.5)


def test_without_a_bound_the_upper_edge_says_so() -> None:
    axes = drawn(made([point(1, ((0.0, "oo"),)), point(2, ((0.0, "oo"),))]))
    (bar,) = [line for line in axes.lines if line.get_transform() == axes.get_xaxis_transform()]
    assert numbers(bar.get_ydata()) == [1, 1]
    assert "unbounded" in legend(axes)
    assert [tick.get_text() for tick in axes.get_yticklabels()] == ["0"]  # no number stands for infinity


def test_numbers_beyond_the_doubles_are_counted_and_not_drawn_as_zero() -> None:
    axes = drawn(made([point(1, ONE), point(2, ONE)._replace(value="1e400"), point(3, ONE)]))
    assert "1 points beyond doubles not drawn" in legend(axes)
    tiny = CurvePoint(2.0, "1e-400", "closure", ((0.0, "1e-400"),), 0.0, True)
    axes = drawn(made([point(1, ONE), tiny, point(3, ((0.0, 1e-5),))]))
    assert not any("next to 0" in text for text in legend(axes))


@pytest.mark.parametrize(
    ("sweep", "scales"),
    [
        ("alpha=1e-4:1e4:9:log", ("log", "log")),
        ("alpha=1:2:3:log", ("log", "linear")),
        ("alpha=1:1e4:9", ("linear", "linear")),
    ],
)
def test_axes_are_logarithmic_where_the_sweep_is_and_lam_max_spans_decades(sweep: str, scales: tuple[str, str]) -> None:
    scheme = find("traditional-1")
    axes = drawn(curve(scheme, scheme.values({}), parse_sweep(sweep)))
    assert (axes.get_xscale(), axes.get_yscale()) == scales


def test_the_axes_say_in_mathematics_what_they_are() -> None:
    axes = drawn(made([point(1, ONE), point(2, ONE)]))
    assert axes.get_xlabel() == r"$\alpha$  (kappa_R/kappa_L = rho_R/rho_L)"
    assert axes.get_ylabel() == r"largest stable $\lambda$"
    assert axes.get_title(loc="left") == SCHEME.title


def test_a_single_point_is_drawn_as_its_stable_set() -> None:
    axes = drawn(Curve(SCHEME, SCHEME.values(), None, [point(1, TWO)], 0.0))
    bars = [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in axes.patches]  # type: ignore[attr-defined]
    assert bars == [(0.0, 0.25), (0.5, 1.0)]
    assert axes.get_xlabel() == r"$\lambda$"


def test_several_schemes_share_the_axes() -> None:
    with canvas.styled():
        axes = Figure().add_subplot()
        draw_comparison({"a": made([point(1, ONE), point(2, ONE)]), "b": made([point(1, TWO), point(2, TWO)])}, axes)
    assert [numbers(line.get_ydata()) for line in axes.lines] == [[1.0, 1.0], [0.25, 0.25]]
    assert len({line.get_linestyle() for line in axes.lines}) == 2
    assert legend(axes) == {"a", "b"}
    with pytest.raises(ValueError, match="one parameter"):
        draw_comparison({"a": replace(made([point(1, ONE)]), sweep=None)}, axes)


# --- hostile and extreme


@pytest.mark.parametrize("title", ["costs $5 and $x_{", "a\nb\x00c\x1b[0m", "Sjögreen 界 \\frac", "t" * 400])
def test_any_title_is_text(title: str) -> None:
    scheme = replace(SCHEME, title=title)
    drawn = ElementTree.fromstring(curve_svg(replace(made([point(1, ONE), point(2, ONE)]), scheme=scheme)))
    assert drawn.tag.endswith("svg")


@pytest.mark.parametrize(
    "sweep", ["alpha=1e-300:1e300:5:log", "alpha=1e-400:1e400:5:log", "alpha=-3:3:3", "alpha=2:2:3"]
)
def test_extreme_sweeps_are_drawn(sweep: str) -> None:
    over = parse_sweep(sweep)
    points = [
        point(0, ((0.0, 10.0**-k),))._replace(value=json_real(Fraction(value))) for k, value in enumerate(over.values)
    ]
    assert curve_png(Curve(SCHEME, SCHEME.values(), over, points, 0.0)).startswith(b"\x89PNG")


# --- files


@pytest.mark.parametrize(("ending", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_a_file_is_what_its_ending_says_and_the_same_every_time(tmp_path: Path, ending: str, magic: bytes) -> None:
    curve = made([point(1, ONE), point(2, TWO)])
    contents = []
    for name in ("one", "two"):
        save_curve(curve, str(tmp_path / f"{name}.{ending}"))
        contents.append((tmp_path / f"{name}.{ending}").read_bytes())
    assert contents[0].startswith(magic)
    assert contents[0] == contents[1]
    assert not re.search(rb"20[2-9]\d-\d\d-\d\d|/CreationDate", contents[0])


def test_another_ending_is_refused_and_nothing_is_left(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="png, svg, pdf"):
        save_curve(made([point(1, ONE)]), str(tmp_path / "curve.doc"))
    assert os.listdir(tmp_path) == []


def test_a_failure_leaves_the_old_file_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "curve.svg"
    path.write_text("yesterday's")

    def fails(*_: object) -> None:
        raise OSError("no space left on device")

    monkeypatch.setattr("gks.files.os.replace", fails)
    with pytest.raises(OSError, match="no space"):
        save_curve(made([point(1, ONE), point(2, ONE)]), str(path))
    assert path.read_text() == "yesterday's"
    assert os.listdir(tmp_path) == ["curve.svg"]


def test_the_users_own_settings_do_not_matter() -> None:
    import matplotlib

    curve = made([point(1, ONE), point(2, TWO)])
    plain = curve_svg(curve)
    with matplotlib.rc_context({"font.size": 30, "axes.grid": False, "svg.hashsalt": "mine"}):
        assert curve_svg(curve) == plain
        assert matplotlib.rcParams["font.size"] == 30


def test_drawing_opens_no_window_system() -> None:
    code = (
        "import sys, gks; gks.load('traditional-1').curve(alpha='1:9:3')._repr_png_();"
        "print('matplotlib.pyplot' in sys.modules, 'matplotlib.figure' in sys.modules)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ended.stdout.split() == ["False", "True"]


# --- notebooks


def test_a_curve_shows_itself_in_a_notebook_and_is_a_curve() -> None:
    curve = gks.load("traditional-2").curve(alpha="1e-2:1e2:5:log")
    assert isinstance(curve, Curve)
    assert curve._repr_svg_() == curve_svg(curve)
    assert curve._repr_png_() == curve_png(curve)
