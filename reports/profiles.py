"""Pictures of normal modes in space: their values on both sides of the boundary, and how they fall."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Any

from gks.files import write_bytes
from gks.modes.numerals import text_complex, text_real
from gks.reports.canvas import format_of, image, plain, styled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from gks.modes.numerals import ComplexNumber
    from gks.modes.profile import Profile
    from gks.scheme.model import HalfLine

STYLES: tuple[dict[str, Any], ...] = (
    {"color": "#0072B2", "marker": "o", "markersize": 5.0, "linestyle": "-"},
    {"color": "#D55E00", "marker": "s", "markersize": 3.2, "linestyle": "--"},
    {"color": "#009E73", "marker": "^", "markersize": 2.6, "linestyle": "-."},
    {"color": "#222222", "marker": "D", "markersize": 1.8, "linestyle": ":"},
)
"""Of the unknowns in turn: colours that the colour-blind tell apart, markers and dashes for grey, smaller markers on
top of larger ones where values coincide."""

SMALLEST = 1e-16
"""Moduli below are left out of the logarithmic panel: against the largest value 1 they are a double's rounding."""

HEIGHT = 1.3
"""Height of the picture, two panels, against that of a curve."""


def save_profile(profile: Profile, path: str, shape: int = 0) -> None:
    """Draw a mode into a .png, .svg or .pdf file, written whole or not at all; ValueError for another ending."""
    write_bytes(path, profile_image(profile, format_of(path), shape))


def profile_image(profile: Profile, kind: str, shape: int = 0) -> bytes:
    """The picture of one shape as the content of a file ("png", "svg" or "pdf")."""
    from matplotlib.figure import Figure

    with styled():
        figure = Figure()
        figure.set_figheight(figure.get_figheight() * HEIGHT)
        draw_profile(profile, figure, shape)
        return image(figure, kind, profile.scheme.title)


def draw_profile(profile: Profile, figure: Figure, shape: int = 0) -> None:
    """One column a half-line, the left one first: real parts with their envelope above, moduli on a log axis below.

    Boundary points are open markers, cells filled ones; scaled so that the largest value is 1.
    """
    domains = sorted(profile.scheme.domains, key=lambda half_line: half_line.side != "left")
    panels = figure.subplots(2, len(domains), sharex="col", sharey="row", squeeze=False)
    for column, half_line in enumerate(domains):
        indices = list(profile.indices[half_line.name])
        values = profile.shapes[shape].values[half_line.name]
        for k, unknown in enumerate(half_line.unknowns):
            style = STYLES[k % len(STYLES)]
            name = f"{half_line.name}.{unknown}" if len(domains) > 1 else unknown
            _draw_unknown(panels[0, column], panels[1, column], half_line, indices, values[unknown], name, style)
        panels[1, column].set_xlabel(f"grid index in {half_line.name}" if len(domains) > 1 else "grid index")
    panels[0, 0].set_ylabel("real part, envelope")
    panels[1, 0].set_ylabel("modulus")
    panels[1, 0].set_yscale("log")
    _explain(profile, figure, panels[0, 0], shape)


def _draw_unknown(
    above: Axes, below: Axes, half_line: HalfLine, indices: Sequence[int], values: Sequence[ComplexNumber], name: str,
    style: dict[str, Any],
) -> None:  # fmt: skip
    real = [float(value[0]) for value in values]
    size = [abs(complex(float(value[0]), float(value[1]))) for value in values]
    filled = [not half_line.is_boundary(i) for i in indices]
    above.fill_between(indices, [-v for v in size], size, color=style["color"], alpha=0.12, linewidth=0)
    logarithmic = [v if v > SMALLEST else nan for v in size]
    for axes, heights in ((above, real), (below, logarithmic)):
        axes.plot(indices, heights, label=name, linewidth=0.9, **style)
        open_at = [k for k, cell in enumerate(filled) if not cell]
        axes.plot(
            [indices[k] for k in open_at], [heights[k] for k in open_at],
            **{**style, "markerfacecolor": "white", "linestyle": "none"},
        )  # fmt: skip


def _explain(profile: Profile, figure: Figure, corner: Axes, shape: int) -> None:
    """What mode it is, and a legend of the unknowns."""
    mode = profile.mode
    title = f"{mode.kind.value} mode, z = {text_complex(mode.z)}, |z| = {text_real(mode.modulus)}"
    if len(profile.shapes) > 1:
        title += f" ({shape + 1} of {len(profile.shapes)})"
    figure.suptitle(f"{plain(profile.scheme.title)}\n{plain(title)}", fontsize=9.5, x=0.02, ha="left")
    handles, labels = [], []
    for axes in figure.axes[: len(profile.scheme.domains)]:
        mine, names = axes.get_legend_handles_labels()
        handles += mine
        labels += names
    figure.legend(handles, labels, loc="outside lower center", ncols=min(4, len(labels)))
    corner.margins(y=0.08)
