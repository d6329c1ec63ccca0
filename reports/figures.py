"""Pictures of stable-CFL curves: functions that take data and an Axes, and files written whole or not at all.

The same curve gives the same bytes (see `canvas`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import inf, isfinite, isnan, log10, nan
from typing import TYPE_CHECKING, Any

from gks.files import write_bytes
from gks.modes.printing import latex_name
from gks.reports.canvas import DOUBLE_DECADES, format_of, image, label_of, mark_decades, new_figure, plain, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gks.bounds.curve import Curve
    from gks.bounds.point import CurvePoint, Number

CLOSURE: dict[str, Any] = {"color": "#0072B2", "linestyle": "-", "linewidth": 1.8}
INTERIOR: dict[str, Any] = {"color": "#222222", "linestyle": (0, (4, 1.6)), "linewidth": 1.8}
FURTHER: dict[str, Any] = {"color": "#0072B2", "linestyle": "-", "linewidth": 0.8}
STABLE: dict[str, Any] = {"facecolor": "#dfe9f0", "edgecolor": "none"}
UNBOUNDED: dict[str, Any] = {"color": "#222222", "linestyle": "-", "linewidth": 4, "solid_capstyle": "butt"}
NOWHERE: dict[str, Any] = {**UNBOUNDED, "color": "#0072B2"}
OPEN: dict[str, Any] = {"color": "#D55E00", "marker": "x", "linestyle": "none"}

DECADES = 100.0
"""lam_max has a logarithmic axis over a logarithmic sweep when it spans more than this factor."""

POINT_HEIGHT = 0.45
"""Height of the picture of a single point against that of a curve."""

MOST_VERTICES = 4000
"""Vertices of one side of a filled region: several for every pixel of a wide figure; lines keep every point."""


@dataclass(frozen=True, slots=True)
class _Spot:
    """A point of a curve as doubles: nan where a number is unknown or beyond the doubles, inf where it is unbounded."""

    x: float
    lam_max: float
    spans: tuple[tuple[float, float], ...]
    limited_by: str | None
    resolved: bool

    @property
    def shape(self) -> tuple[bool, int, bool, bool]:
        """What neighbours must share for their stable intervals to be joined: the same number of the same kind."""
        first = bool(self.spans) and self.spans[0][0] == 0
        return self.resolved, len(self.spans), first, bool(self.spans) and self.spans[-1][1] == inf


@dataclass(frozen=True, slots=True)
class _Run:
    """Neighbours of one shape, with the ends of the stretch they stand for: half-way to the next run."""

    spots: tuple[_Spot, ...]
    left: float
    right: float

    def xs(self) -> list[float]:
        return [self.left, *(spot.x for spot in self.spots), self.right]

    def ends(self, k: int, side: int) -> list[float]:
        inner = [spot.spans[k][side] for spot in self.spots]
        return [inner[0], *inner, inner[-1]]


def save_curve(curve: Curve, path: str) -> None:
    """Draw the curve into a .png, .svg or .pdf file, written whole or not at all; ValueError for another ending."""
    write_bytes(path, curve_image(curve, format_of(path)))


def curve_svg(curve: Curve) -> str:
    """The curve as the text of an SVG file."""
    return curve_image(curve, "svg").decode("utf-8")


def curve_png(curve: Curve) -> bytes:
    """The curve as the bytes of a PNG file."""
    return curve_image(curve, "png")


def curve_image(curve: Curve, kind: str) -> bytes:
    """The curve as the content of a file ("png", "svg" or "pdf")."""
    with styled():
        figure, axes = new_figure()
        if _is_point(curve):
            figure.set_figheight(figure.get_figheight() * POINT_HEIGHT)
        draw_curve(curve, axes)
        return image(figure, kind, curve.scheme.title)


# A curve on an Axes ---------------------------------------------------------------------------------------------------


def draw_curve(curve: Curve, axes: Axes) -> None:
    """lam_max over the swept parameter, and every stable interval as a filled region.

    The part that the interior scheme limits is dashed, the part that the closure limits is solid. Undecided points are
    crosses on the lower axis, an unbounded lam_max is a bar along the upper edge. A curve of a single point is drawn as
    its stable set on a lam axis.
    """
    axes.set_title(plain(curve.scheme.title), loc="left", wrap=True)
    sweep = curve.sweep
    if sweep is None or _is_point(curve):
        _draw_point(curve, axes)
        return
    on_axis = (s for s in map(_spot, curve.points) if isfinite(s.x) and (s.x > 0 or not sweep.logarithmic))
    spots = sorted(on_axis, key=lambda s: s.x)
    if sweep.logarithmic:
        axes.set_xscale("log")
    logarithmic = _set_lam_axis(axes, spots, logarithmic=sweep.logarithmic)
    runs = _runs(spots, logarithmic=sweep.logarithmic)
    if spots:
        axes.set_xlim(spots[0].x, spots[-1].x)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if axis.get_scale() == "log":
            mark_decades(axis, low, high)
    for run in runs:
        _draw_run(run, axes)
    _draw_edges(runs, axes, logarithmic=logarithmic)
    _explain(axes, spots, len(curve.points) - len(spots), curve)


def _draw_run(run: _Run, axes: Axes) -> None:
    top, bottom = axes.get_ylim()[1], axes.get_ylim()[0]
    for k in range(len(run.spots[0].spans)):
        lows, highs = run.ends(k, 0), run.ends(k, 1)
        keep = _thinned(len(lows))
        axes.fill_between(
            [run.xs()[i] for i in keep],
            [max(lows[i], bottom) if not isnan(lows[i]) else nan for i in keep],
            [min(highs[i], top) if not isnan(highs[i]) else nan for i in keep],
            **STABLE,
        )
        begins_at_zero = lows[0] == 0
        if not begins_at_zero:
            axes.plot(run.xs(), lows, **FURTHER)
        if not (k == 0 and begins_at_zero) and isfinite(highs[0]):
            axes.plot(run.xs(), highs, **FURTHER)
    _draw_limit(run, axes)


def _draw_limit(run: _Run, axes: Axes) -> None:
    """The line of lam_max, in the style of what limits it; where that changes, the joining piece is the closure's."""
    if not run.spots[0].resolved:
        return
    xs = run.xs()
    heights = [run.spots[0].lam_max, *(spot.lam_max for spot in run.spots), run.spots[-1].lam_max]
    by = [run.spots[0].limited_by, *(spot.limited_by for spot in run.spots), run.spots[-1].limited_by]
    pieces = ["interior" if a == b == "interior" else "closure" for a, b in pairwise(by)]
    start = 0
    for kind, group in groupby(pieces):
        stop = start + len(list(group))
        style = INTERIOR if kind == "interior" else CLOSURE
        axes.plot(xs[start : stop + 1], heights[start : stop + 1], zorder=3, solid_capstyle="butt", **style)
        start = stop


def _draw_edges(runs: Sequence[_Run], axes: Axes, *, logarithmic: bool) -> None:
    """What has no place between the axes: lam_max unbounded, or 0 on a logarithmic axis; undecided points."""
    across = axes.get_xaxis_transform()
    for run in runs:
        ends, first = [run.left, run.right], run.spots[0]
        if not first.resolved:
            xs = [spot.x for spot in run.spots]
            axes.plot(xs, [0.0] * len(xs), transform=across, clip_on=False, zorder=5, **OPEN)
        elif first.lam_max == inf:
            axes.plot(ends, [1, 1], transform=across, clip_on=False, **UNBOUNDED)
        elif first.lam_max == 0 and logarithmic:
            axes.plot(ends, [0, 0], transform=across, clip_on=False, **NOWHERE)


def _explain(axes: Axes, spots: Sequence[_Spot], left_out: int, curve: Curve) -> None:
    """Axis labels, and a legend of what occurs."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    assert curve.sweep is not None
    scheme, name = curve.scheme, curve.sweep.name
    axes.set_xlabel(label_of(scheme, name))
    axes.set_ylabel(f"largest stable ${latex_name(scheme.cfl)}$")
    limits = {spot.limited_by for spot in spots if spot.lam_max != inf}
    handles: list[Line2D | Patch] = []
    if "closure" in limits:
        handles.append(Line2D([], [], label="limited by the closure", **CLOSURE))
    if "interior" in limits:
        handles.append(Line2D([], [], label="limited by the interior scheme", **INTERIOR))
    if any(spot.spans for spot in spots):
        handles.append(Patch(label="stable", **{**STABLE, "edgecolor": "#8fa9b8"}))
    if any(spot.lam_max == inf for spot in spots):
        handles.append(Line2D([], [], label="unbounded", **UNBOUNDED))
    if axes.get_yscale() == "log" and any(spot.lam_max == 0 for spot in spots):
        handles.append(Line2D([], [], label=f"no stable ${latex_name(scheme.cfl)}$ next to 0", **NOWHERE))
    if any(not spot.resolved for spot in spots):
        handles.append(Line2D([], [], label="undecided", **OPEN))
    if left_out:
        handles.append(Line2D([], [], label=f"{left_out} points beyond doubles not drawn", linestyle="none"))
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=min(3, max(1, len(handles))))


def _set_lam_axis(axes: Axes, spots: Sequence[_Spot], *, logarithmic: bool) -> bool:
    """Scale and limits of the lam axis; returns whether it is logarithmic."""
    tops = [spot.lam_max for spot in spots if isfinite(spot.lam_max) and spot.lam_max > 0]
    ends = [end for spot in spots for span in spot.spans for end in span if isfinite(end) and end > 0] + tops
    if not ends:
        axes.set_ylim(0, 1)
        axes.set_yticks([0], ["0"])  # there is no number to show
        return False
    logarithmic = logarithmic and bool(tops) and max(tops) > DECADES * min(tops)
    if logarithmic:
        axes.set_yscale("log")
        low, high = log10(min(ends)), log10(max(ends))
        margin = max(0.2, 0.04 * (high - low))
        axes.set_ylim(10.0 ** max(low - margin, -DOUBLE_DECADES), 10.0 ** min(high + margin, DOUBLE_DECADES))
    else:
        axes.set_ylim(0, 1.08 * max(ends))
    return logarithmic


def _is_point(curve: Curve) -> bool:
    return curve.sweep is None or len(set(curve.sweep.values)) == 1


# Several curves -------------------------------------------------------------------------------------------------------


def save_comparison(curves: Mapping[str, Curve], path: str, title: str) -> None:
    """Draw several curves over one sweep into a file, as `save_curve` does."""
    kind = format_of(path)
    with styled():
        figure, axes = new_figure()
        draw_comparison(curves, axes)
        axes.set_title(plain(title))
        write_bytes(path, image(figure, kind, title))


def draw_comparison(curves: Mapping[str, Curve], axes: Axes) -> None:
    """lam_max of several schemes, named by the mapping's keys, over the parameter that all of them sweep.

    Undecided points and unbounded ones are gaps. ValueError unless all curves sweep the same parameter.
    """
    sweeps = {curve.sweep.name: curve.sweep for curve in curves.values() if curve.sweep is not None}
    if len(sweeps) != 1:
        raise ValueError(f"the curves sweep {sorted(sweeps) or 'nothing'}, and one parameter is to be the axis")
    ((name, sweep),) = sweeps.items()
    spots = {label: sorted(map(_spot, curve.points), key=lambda s: s.x) for label, curve in curves.items()}
    if sweep.logarithmic:
        axes.set_xscale("log")
    _set_lam_axis(axes, [spot for each in spots.values() for spot in each], logarithmic=sweep.logarithmic)
    for label, each in spots.items():
        heights = [spot.lam_max if isfinite(spot.lam_max) else nan for spot in each]
        axes.plot([spot.x for spot in each], heights, label=label)
    scheme = next(iter(curves.values())).scheme
    axes.set_xlabel(label_of(scheme, name))
    axes.set_ylabel(f"largest stable ${latex_name(scheme.cfl)}$")
    axes.margins(x=0)
    axes.figure.legend(loc="outside lower center", ncols=min(3, len(curves)))


# One point ------------------------------------------------------------------------------------------------------------


def _draw_point(curve: Curve, axes: Axes) -> None:
    """The stable set of a single point as bars on a lam axis, with the ends written at them."""
    spot = _spot(curve.points[0])
    name = latex_name(curve.scheme.cfl)
    axes.set_xlabel(f"${name}$")
    axes.set_yticks([])
    axes.grid(visible=False)
    axes.spines["left"].set_visible(False)
    axes.set_ylim(-1, 1)
    ends = [end for span in spot.spans for end in span if isfinite(end) and end > 0]
    right = 1.25 * max(ends, default=1.0)
    axes.set_xlim(0, right)
    for low, high in spot.spans:
        axes.barh(0, min(high, right) - low, left=low, height=0.7, **{**STABLE, "edgecolor": "#0072B2"})
        for end in (low, high):
            if 0 < end < inf:
                axes.annotate(f"{end:.6g}", (end, 0.35), (0, 4), textcoords="offset points", ha="center", fontsize=8)
    words = "stable, ends excluded" if spot.spans else f"stable for no ${name}$"
    if spot.spans and spot.spans[-1][1] == inf:
        words = "stable, without an upper end"
    axes.text(0.0, -0.85, words if spot.resolved else f"undecided: {plain(curve.points[0].because)}", fontsize=8)


# Numbers, runs, words -------------------------------------------------------------------------------------------------


def _spot(point: CurvePoint) -> _Spot:
    spans = tuple((_double(low), _double(high)) for low, high in point.stable_set)
    return _Spot(_double(point.value), _double(point.lam_max), spans, point.limited_by, point.resolved)


def _double(number: Number | None) -> float:
    if number is None:
        return nan
    if number == "oo":
        return inf
    double = float(number)
    # A decimal string is a number that no double holds: neither 0 nor infinity is what it means.
    return nan if isinstance(number, str) and (double == 0 or not isfinite(double)) else double


def _runs(spots: Sequence[_Spot], *, logarithmic: bool) -> list[_Run]:
    groups = [tuple(group) for _, group in groupby(spots, key=lambda spot: spot.shape)]
    cuts = [_middle(a[-1].x, b[0].x, logarithmic=logarithmic) for a, b in pairwise(groups)]
    lefts = [spots[0].x, *cuts] if spots else []
    rights = [*cuts, spots[-1].x] if spots else []
    return [_Run(group, left, right) for group, left, right in zip(groups, lefts, rights, strict=True)]


def _middle(a: float, b: float, *, logarithmic: bool) -> float:
    return float(a**0.5 * b**0.5) if logarithmic else a / 2 + b / 2


def _thinned(count: int) -> list[int]:
    """Indices of at most about MOST_VERTICES of so many points, both ends among them."""
    step = max(1, count // MOST_VERTICES)
    return sorted({*range(0, count, step), count - 1})
