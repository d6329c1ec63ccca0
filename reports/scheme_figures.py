"""The figures of a scheme's report, drawn from its results: each takes plain data and an Axes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import cycle
from math import cos, hypot, log10, pi, sin
from typing import TYPE_CHECKING, Any

from gks.modes.printing import latex_name
from gks.reports.canvas import label_of
from gks.reports.formulas import NotAFormula, formula
from gks.reports.latex import latex

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gks.bounds.curve import Curve
    from gks.bounds.rootpaths import RootMap
    from gks.scheme.model import Scheme

BLUE, RED, GREEN, GREY, BLACK = "#0072B2", "#D55E00", "#009E73", "#777777", "#222222"

KINDS: Mapping[str, dict[str, Any]] = {
    "growing": {"color": RED, "marker": "^", "markersize": 8},
    "eigenvalue": {"color": BLACK, "marker": "D", "markersize": 6.5},
    "generalized": {"color": BLACK, "marker": "D", "markersize": 6.5, "fillstyle": "none", "markeredgewidth": 1.4},
    "decaying": {"color": BLUE, "marker": "o", "markersize": 6.5},
    "inadmissible": {"color": GREY, "marker": "x", "markersize": 7, "markeredgewidth": 1.6},
}
"""Marks by what a root is: told apart by shape as well as by colour."""

FARTHEST = 20.0
"""Roots beyond this modulus are not drawn; the picture says how many they are."""


def draw_roots(modes: Sequence[Mapping[str, Any]], axes: Axes) -> None:
    """The roots in the z-plane with the unit circle; multiplicities beside them."""
    angles = [2 * pi * k / 240 for k in range(241)]
    axes.plot([cos(t) for t in angles], [sin(t) for t in angles], color=BLACK, linewidth=1.1, linestyle="-")
    axes.annotate("$|z| = 1$", (cos(0.62 * pi), sin(0.62 * pi)), (-3, 5), textcoords="offset points", ha="right")
    drawn, away = [], 0
    for mode in modes:
        place = _place(mode)
        if place is None or hypot(*place) > FARTHEST:
            away += 1
            continue
        drawn.append((place, mode))
    for kind, style in KINDS.items():
        places = [place for place, mode in drawn if mode["kind"] == kind]
        if places:
            axes.plot([x for x, _ in places], [y for _, y in places], linestyle="none", label=kind, **style)
    for (x, y), mode in drawn:
        if mode["multiplicity"] > 1:
            axes.annotate(f"×{mode['multiplicity']}", (x, y), (7, 5), textcoords="offset points", fontsize=8)
    reach = 1.12 * max([1.0, *(max(abs(x), abs(y)) for (x, y), _ in drawn)])
    axes.set_xlim(-reach, reach)
    axes.set_ylim(-reach, reach)
    axes.set_aspect("equal")
    axes.set_xlabel(r"Re $z$")
    axes.set_ylabel(r"Im $z$")
    if away:
        axes.set_title(f"{away} root{'s' * (away != 1)} beyond this picture", fontsize=8)
    if drawn:
        axes.figure.legend(loc="outside lower center", ncols=3)


def _place(mode: Mapping[str, Any]) -> tuple[float, float] | None:
    """z as two doubles, None where it is beyond them."""
    if mode["z"] == "oo":
        return None
    x, y = (float(part) for part in mode["z"])
    return (x, y) if hypot(x, y) < float("inf") else None


HISTORY = ((BLUE, "-"), (GREY, (0, (1.5, 1.5))), (GREEN, "-."))


def draw_history(march: Mapping[str, Any], axes: Axes) -> None:
    """The size next to the boundary over the steps of each march, and a line of the predicted slope."""
    heights: list[float] = []
    for history, (colour, dashes) in zip(march["histories"], HISTORY, strict=False):
        seen = known(history)
        axes.plot([n for n, _ in seen], [v for _, v in seen], color=colour, linestyle=dashes, label=history["name"])
        heights += [v for _, v in seen]
    line = slope_line(march)
    if line is not None:
        axes.plot(*line, color=BLACK, linewidth=1.2, linestyle=(0, (4, 2)), label="predicted slope")
    low, high = min(heights, default=0.0), max(heights, default=1.0)
    axes.set_ylim(low - 0.06 * (high - low or 1), high + 0.08 * (high - low or 1))
    axes.set_xlabel("step $n$")
    axes.set_ylabel(r"$\log_{10}$ size")
    axes.figure.legend(loc="outside lower center", ncols=2)


def known(history: Mapping[str, Any]) -> list[tuple[int, float]]:
    """The steps at which a march's size has a logarithm, with it."""
    return [(n, v) for n, v in zip(history["steps"], history["log10_size"], strict=True) if v is not None]


def slope_line(march: Mapping[str, Any]) -> tuple[list[float], list[float]] | None:
    """The two ends (steps, heights) of a line of the predicted slope through the observed march's last quarter."""
    slope, seen = march["predicted"], known(march["histories"][0])
    if not slope or not seen:
        return None
    rate, last = log10(slope), seen[-1][0]
    late = [(n, v) for n, v in seen if n >= 0.75 * last]
    offset = sum(v - rate * n for n, v in late) / len(late)
    return [seen[0][0], last], [offset + rate * seen[0][0], offset + rate * last]


def curve_of(scheme: Scheme, data: Mapping[str, Any], sweep: str | None) -> Curve:
    """A curve from its JSON object, as `reports.figures` draws it."""
    from gks.bounds.curve import Curve
    from gks.bounds.point import CurvePoint
    from gks.bounds.sweep import parse_sweep

    points = [
        CurvePoint(
            point.get(data["sweep"]) if data["sweep"] else None,
            point["lam_max"],
            point["limited_by"],
            tuple((low, high) for low, high in point["stable_set"]),
            point["error_bound"],
            point["status"] == "resolved",
            point.get("because", ""),
        )
        for point in data["points"]
    ]
    return Curve(scheme, {}, parse_sweep(sweep) if sweep else None, points, 0.0)


def draw_bound(scheme: Scheme, data: Mapping[str, Any], sweep: str | None, axes: Axes) -> None:
    """The stable-CFL curve, under a caption that names the scheme."""
    from gks.reports.figures import draw_curve

    draw_curve(curve_of(scheme, data, sweep), axes)
    axes.set_title("")
    if sweep:
        axes.set_xlabel(quantity(scheme, data["sweep"]))
    for legend in axes.figure.legends[:]:  # in rows that are no wider than the panel
        handles = [handle for handle in legend.legend_handles if handle is not None]
        labels = [text.get_text() for text in legend.get_texts()]
        legend.remove()
        axes.figure.legend(handles, labels, loc="outside lower center", ncols=2)


def quantity(scheme: Scheme, parameter: str) -> str:
    """A parameter as an axis has it, its description as mathematics where it is."""
    symbol = latex_name(parameter)
    try:
        meaning = latex(formula(scheme.parameter(parameter).doc))
    except NotAFormula:
        return label_of(scheme, parameter)
    flat = FRACTION.sub(r"\1/\2", meaning)  # a fraction under an axis is too small to read
    return f"${symbol} = {flat}$"


SINGLE = r"\{((?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*)\}"
FRACTION = re.compile(rf"\\frac{SINGLE}{SINGLE}")
"""A fraction in LaTeX, its two parts nested no deeper than an index."""


def draw_profile(scheme: Scheme, data: Mapping[str, Any], domain: str, axes: Axes) -> None:
    """A mode's values next to the boundary in one half-line: real parts, with the moduli as a band around 0."""
    values = data["shapes"][0]["values"][domain]
    half_line = scheme.half_line(domain)
    for unknown, (colour, mark) in zip(half_line.unknowns, cycle(PROFILE), strict=False):
        pairs = [complex(float(x), float(y)) for x, y in values[unknown]]
        axes.fill_between(values["index"], [-abs(v) for v in pairs], [abs(v) for v in pairs], color=colour, alpha=0.13)
        axes.plot(
            values["index"], [v.real for v in pairs], color=colour, marker=mark, markersize=4, linewidth=0.9,
            linestyle="-", label=f"${latex_name(unknown)}$",
        )  # fmt: skip
    axes.set_ylim(-1.08, 1.08)
    axes.set_xlabel(f"grid index in {domain}" if len(scheme.domains) > 1 else "grid index")
    axes.set_ylabel("real part (band: modulus)")
    axes.figure.legend(loc="outside lower center", ncols=4)


PROFILE = ((BLUE, "o"), (RED, "s"), (GREEN, "^"), (BLACK, "D"), (GREY, "v"), ("#CC79A7", "P"))


def draw_rootmap(scheme: Scheme, data: Mapping[str, Any], sweep: str, plane: str, axes: Axes) -> None:
    """The paths of the roots in the plane of z or of r."""
    from matplotlib.lines import Line2D

    from gks.reports.rootmaps import KINDS as PATHS
    from gks.reports.rootmaps import START, WORDS, draw_plane

    found = rootmap_of(scheme, data, sweep)
    draw_plane(found, axes, lambda point: point.z if plane == "z" else point.r)
    axes.set_xlabel(f"Re ${plane}$")
    axes.set_ylabel(f"Im ${plane}$")
    kinds = {point.kind for track in found.tracks for point in track.points if point is not None}
    handles = [Line2D([], [], label=WORDS[kind], **style) for kind, style in PATHS.items() if kind in kinds]
    handles.append(Line2D([], [], label=f"first ${latex_name(data['sweep'])}$", linestyle="none", **START))
    axes.figure.legend(handles=handles, loc="outside lower center", ncols=2)


def rootmap_of(scheme: Scheme, data: Mapping[str, Any], sweep: str) -> RootMap:
    """A root map from its JSON object, as `reports.rootmaps` draws it."""
    from gks.bounds.rootpaths import RootMap, RootPoint, Track
    from gks.bounds.sweep import parse_sweep
    from gks.modes.verdict import ModeKind

    def point(z: Sequence[float] | None, kind: str | None, r: Sequence[float] | None) -> RootPoint | None:
        if z is None:
            return None
        sort = None if kind in (None, "open") else ModeKind(kind)
        return RootPoint(complex(*z), sort, None if r is None else complex(*r))

    tracks = [
        Track(track["multiplicity"], tuple(map(point, track["z"], track["kind"], track["r"])))
        for track in data["tracks"]
    ]
    return RootMap(scheme, {}, parse_sweep(sweep), tuple(tracks), {}, 0.0)


def draw_radius(scheme: Scheme, data: Mapping[str, Any], curve: Mapping[str, Any] | None, axes: Axes) -> None:
    """The map of the largest modulus with the bound on it, or the modulus over lam alone."""
    import numpy as np

    from gks.bounds.radius import RadiusMap
    from gks.bounds.sweep import parse_sweep
    from gks.reports.maps import draw_moduli, draw_radius_map

    over = parse_sweep(data["sweep"]) if data["sweep"] else None
    values, lams, radius, known, interior = (
        np.array(data[key]) for key in ("values", "lams", "radius", "known", "interior")
    )
    found = RadiusMap(scheme, {}, over, values, lams, radius, known, interior, 0.0)
    (draw_radius_map if over else draw_moduli)(found, axes)
    axes.set_title("")
    axes.set_ylabel(f"${latex_name(scheme.cfl)}$" if over else "largest modulus of a mode")
    if over is None:
        axes.set_xlabel(f"${latex_name(scheme.cfl)}$")
        return
    axes.set_xlabel(quantity(scheme, over.name))
    if curve is not None:
        xs = [float(point[over.name]) for point in curve["points"]]
        tops = [_height(point["lam_max"]) for point in curve["points"]]
        axes.plot(xs, tops, color="#FFFFFF", linewidth=2.6, linestyle="-", zorder=4)
        axes.plot(xs, tops, color="#D55E00", linewidth=1.4, linestyle=(0, (4, 1.5)), zorder=5, label="largest stable")
        axes.set_ylim(0, max(data["lams"]))
        axes.set_xlim(min(data["values"]), max(data["values"]))
        axes.figure.legend(loc="outside lower center")


def _height(value: object) -> float:
    return float("nan") if value is None or value == "oo" else float(str(value))


def draw_grid(scheme: Scheme, axes: Axes) -> None:
    """Cells and boundary points of both half-lines in a row each, indices below them."""
    axes.set_axis_off()
    rows = len(scheme.domains)
    for k, half_line in enumerate(scheme.domains):
        height = float(rows - 1 - k)
        outward = 1 if half_line.side == "right" else -1
        boundary = sorted({v.index for v in scheme.boundary_unknowns if v.domain == half_line.name})
        cells = [outward * (half_line.first + n) for n in range(4)]
        places = sorted({*boundary, *cells})
        ends = [min(places) - 0.6, max(places) + 0.6]
        axes.plot(ends, [height, height], color=GREY, linewidth=0.8, linestyle="-", zorder=1)
        axes.plot(cells, [height] * len(cells), color=BLUE, marker="o", markersize=9, linestyle="none", zorder=3)
        axes.plot(
            boundary, [height] * len(boundary), color=RED, marker="s", markersize=9, linestyle="none", zorder=3,
            markerfacecolor="none", markeredgewidth=1.6,
        )  # fmt: skip
        for place in places:
            axes.annotate(
                f"${place}$", (place, height), (0, -16), textcoords="offset points", ha="center", va="top", fontsize=8
            )
        side = "$x > 0$" if outward > 0 else "$x < 0$"
        unknowns = ", ".join(f"${latex_name(u)}$" for u in half_line.unknowns)
        title = f"{half_line.name}:  {side},  {unknowns}" if rows > 1 else f"{side},  {unknowns}"
        axes.annotate(title, (places[0], height), (0, 12), textcoords="offset points", fontsize=8.5)
    axes.plot([], [], color=BLUE, marker="o", markersize=8, linestyle="none", label="cell")
    axes.plot(
        [], [], color=RED, marker="s", markersize=8, linestyle="none", markerfacecolor="none", markeredgewidth=1.6,
        label="value from the closure",
    )  # fmt: skip
    axes.set_ylim(-0.8, rows - 0.35)
    axes.figure.legend(loc="outside lower center", ncols=2)
