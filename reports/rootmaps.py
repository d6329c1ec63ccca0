"""Pictures of root maps: the roots' paths in the plane of z, and of r where the scheme has one."""

from __future__ import annotations

from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

from gks.files import write_bytes
from gks.modes.printing import latex_name
from gks.modes.verdict import ModeKind
from gks.reports.canvas import format_of, image, plain, styled

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gks.bounds.rootpaths import RootMap, RootPoint, Track

KINDS: dict[ModeKind | None, dict[str, Any]] = {
    ModeKind.GROWING: {"color": "#D55E00", "linestyle": "-", "linewidth": 2.4, "marker": "s"},
    ModeKind.GENERALIZED: {"color": "#CC79A7", "linestyle": "-", "linewidth": 2.4, "marker": "P"},
    ModeKind.EIGENVALUE: {"color": "#000000", "linestyle": "-", "linewidth": 2.4, "marker": "D"},
    ModeKind.DECAYING: {"color": "#0072B2", "linestyle": "-", "linewidth": 1.2, "marker": "."},
    ModeKind.INADMISSIBLE: {"color": "#777777", "linestyle": (0, (1, 1.6)), "linewidth": 1.2, "marker": "x"},
    None: {"color": "#E69F00", "linestyle": (0, (4, 2)), "linewidth": 1.2, "marker": "+"},
}
"""Line and marker of each kind: told apart by marker, dashes and width without colour. None: open."""

WORDS = {
    ModeKind.GROWING: "grows",
    ModeKind.GENERALIZED: "generalized",
    ModeKind.EIGENVALUE: "eigenvalue on the circle",
    ModeKind.DECAYING: "decays in time",
    ModeKind.INADMISSIBLE: "no mode",
    None: "open",
}
START: dict[str, Any] = {"marker": "o", "markersize": 7, "markerfacecolor": "none", "color": "#222222"}
"""Where a path begins."""
SPAN = 3.0
"""Farthest real or imaginary part shown, unless every root lies farther out: what leaves goes on outside."""
ARROWS = 3
"""Arrowheads on a path."""
SHORTEST = 0.02
"""Length of a path, against the width of the picture, below which it is a point without arrows."""
WIDE, HIGH = 1.5, 1.15
"""Width of a picture of two planes against that of a curve, and the height of either."""


def save_rootmap(found: RootMap, path: str) -> None:
    """Draw the paths into a .png, .svg or .pdf file, written whole or not at all; ValueError for another ending."""
    write_bytes(path, rootmap_image(found, format_of(path)))


def rootmap_image(found: RootMap, kind: str) -> bytes:
    """The picture as the content of a file ("png", "svg" or "pdf")."""
    from matplotlib.figure import Figure

    with styled():
        figure = Figure()
        figure.set_figheight(figure.get_figheight() * HIGH)
        if found.has_r:
            figure.set_figwidth(figure.get_figwidth() * WIDE)
        draw_rootmap(found, figure)
        return image(figure, kind, found.scheme.title)


def draw_rootmap(found: RootMap, figure: Figure) -> None:
    """The plane of z, beside it that of r where the scheme has one, each with its unit circle.

    A path begins at an open circle, arrowheads along it say in which direction the parameter runs.
    """
    planes: list[tuple[str, Callable[[RootPoint], complex | None]]] = [("z", lambda p: p.z)]
    if found.has_r:
        planes.append(("r", lambda p: p.r))
    panels = figure.subplots(1, len(planes), squeeze=False)[0]
    for axes, (name, place) in zip(panels, planes, strict=True):
        draw_plane(found, axes, place)
        axes.set_xlabel(rf"$\mathrm{{Re}}\,{name}$")
        axes.set_ylabel(rf"$\mathrm{{Im}}\,{name}$")
    low, high = (float(found.sweep.values[k]) for k in (0, -1))
    title = plain(found.scheme.title)
    swept = f"${latex_name(found.sweep.name)}$ from {low:.6g} to {high:.6g}"
    figure.suptitle(f"{title}\n{swept}", fontsize=9.5, x=0.02, ha="left")
    _explain(found, figure)


def draw_plane(found: RootMap, axes: Axes, place: Callable[[RootPoint], complex | None]) -> None:
    """The paths in one plane; ``place`` gives a root's point there, None where it has none."""
    from matplotlib.patches import Circle

    axes.add_patch(Circle((0, 0), 1, fill=False, edgecolor="#444444", linewidth=0.8))
    spots = [z for track in found.tracks for p in track.points if p is not None and (z := place(p)) is not None]
    near = [max(abs(z.real), abs(z.imag)) for z in spots]
    span = min(max([1.25, *(1.08 * v for v in near)]), max(SPAN, 1.25 * min(near, default=0.0)))
    axes.set_xlim(-span, span)
    axes.set_ylim(-span, span)
    axes.set_aspect("equal")
    for track in found.tracks:
        _draw_track(track, axes, place, span)


def _draw_track(track: Track, axes: Axes, place: Callable[[RootPoint], complex | None], span: float) -> None:
    path = [(p.kind, place(p)) for p in track.points if p is not None]
    steps = [(kind, z) for kind, z in path if z is not None]
    if not steps:
        return
    for kind, group in groupby(range(len(steps)), key=lambda k: steps[k][0]):
        stretch = list(group)
        # Joined to the next stretch, so that a path has no gaps where its kind changes.
        ends = [steps[k][1] for k in [*stretch, min(stretch[-1] + 1, len(steps) - 1)]]
        style = {key: value for key, value in KINDS[kind].items() if key != "marker"}
        axes.plot([z.real for z in ends], [z.imag for z in ends], zorder=3, **style)
        middle = steps[stretch[len(stretch) // 2]][1]
        mark = {"color": style["color"], "marker": KINDS[kind]["marker"], "linestyle": "none"}
        axes.plot([middle.real], [middle.imag], zorder=4, **mark)
    first = steps[0][1]
    axes.plot([first.real], [first.imag], zorder=5, **START)
    _draw_arrows([z for _, z in steps], axes, span)


def _draw_arrows(path: Sequence[complex], axes: Axes, span: float) -> None:
    """Arrowheads at equal distances along a path, within the picture."""
    inside = [k for k, z in enumerate(path) if max(abs(z.real), abs(z.imag)) < span]
    lengths = [0.0]
    for i, j in pairwise(inside):
        lengths.append(lengths[-1] + abs(path[j] - path[i]))
    if lengths[-1] < SHORTEST * span:
        return
    for k in range(ARROWS):
        goal = lengths[-1] * (k + 1) / (ARROWS + 1)
        at = next(i for i, length in enumerate(lengths) if length >= goal)
        a, b = path[inside[at - 1]], path[inside[at]]
        axes.annotate(
            "", (b.real, b.imag), (a.real, a.imag),
            arrowprops={"arrowstyle": "-|>", "color": "#222222", "linewidth": 0, "mutation_scale": 9},
        )  # fmt: skip


def _explain(found: RootMap, figure: Figure) -> None:
    """A legend of the kinds that occur."""
    from matplotlib.lines import Line2D

    kinds = {p.kind for track in found.tracks for p in track.points if p is not None}
    handles = [Line2D([], [], label=WORDS[kind], **style) for kind, style in KINDS.items() if kind in kinds]
    label = f"at the first ${latex_name(found.sweep.name)}$"
    handles.append(Line2D([], [], label=label, linestyle="none", **START))
    handles.append(Line2D([], [], label="unit circle", color="#444444", linewidth=0.8))
    figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)))
