"""Pictures of two parameters: lam_max as a surface of grey-proof colours with labelled contours, and the modes' moduli.

Dark means small throughout, so a grey print keeps the order. Undecided points are crosses, unbounded ones the lightest
colour.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any

from gks.bounds.curve import Curve
from gks.bounds.curvemap import CurveMap
from gks.bounds.radius import RadiusMap
from gks.files import write_bytes
from gks.modes.printing import latex_name
from gks.reports.canvas import format_of, image, label_of, new_figure, plain, styled

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from gks.bounds.sweep import Sweep
    from gks.scheme.model import Scheme

COLOURS = "cividis"
"""Lightness rises evenly: the same order in grey, and for every kind of colour vision."""
OPEN: dict[str, Any] = {"color": "#D55E00", "marker": "x", "linestyle": "none", "markersize": 4}
CONTOURS: dict[str, Any] = {"colors": "#ffffff", "linewidths": 0.8}
CIRCLE: dict[str, Any] = {"colors": "#D55E00", "linewidths": 2.0}
OUTSIDE: dict[str, Any] = {"colors": "none", "hatches": ["///"]}
DECADES = 100.0
"""lam_max has a logarithmic colour scale where it spans more than this factor."""
MOST_CROSSES = 2000
"""Undecided points drawn at most: more are a surface, not marks."""

FEW = 4
"""Decades up to which a logarithmic scale has contours at 1, 2 and 5."""

Result = Curve | CurveMap | RadiusMap


def save(result: Result, path: str) -> None:
    """Draw a curve or a map into a .png, .svg or .pdf file, written whole or not at all; ValueError otherwise."""
    write_bytes(path, picture(result, format_of(path)))


def picture(result: Result, kind: str) -> bytes:
    """The picture as the content of a file ("png", "svg" or "pdf")."""
    if isinstance(result, Curve):
        from gks.reports.figures import curve_image

        return curve_image(result, kind)
    with styled():
        figure, axes = new_figure()
        if isinstance(result, CurveMap):
            draw_map(result, axes)
        elif result.sweep is None:
            draw_moduli(result, axes)
        else:
            draw_radius_map(result, axes)
        return image(figure, kind, result.scheme.title)


def draw_map(found: CurveMap, axes: Axes) -> None:
    """lam_max over two parameters, the first along the horizontal axis."""
    import numpy as np
    from matplotlib.colors import LogNorm, Normalize

    first, second = found.sweeps
    _set_axes(axes, found.scheme, [first, second])
    height = found.lam_max.T
    finite = height[np.isfinite(height)]
    positive = finite[finite > 0]
    logarithmic = bool(len(positive)) and positive.max() > DECADES * positive.min()
    top = float(finite.max(initial=0.0)) or 1.0
    bottom = float(positive.min()) if logarithmic else 0.0
    norm = LogNorm(bottom, top) if logarithmic else Normalize(bottom, top)
    shown = np.where(np.isinf(height), top, np.where(height == 0, bottom, height))
    x, y = _doubles(first), _doubles(second)
    surface = axes.pcolormesh(*_edges(x, y, found.sweeps), shown, cmap=COLOURS, norm=norm, rasterized=True)
    label = f"largest stable ${latex_name(found.scheme.cfl)}$"
    axes.figure.colorbar(surface, ax=axes, label=label)
    if len(positive) and positive.max() > positive.min() and min(shown.shape) > 1:
        lines = axes.contour(x, y, shown, levels=_levels(positive, logarithmic=logarithmic), **CONTOURS)
        axes.clabel(lines, fmt=lambda v: f"{v:.3g}", fontsize=7)
    _cross_out(axes, x, y, np.isnan(height))
    axes.set_title(plain(found.scheme.title), loc="left", wrap=True)


def draw_radius_map(found: RadiusMap, axes: Axes) -> None:
    """The largest admissible modulus over a parameter and lam.

    The thick contour is abs(z) = 1; hatched is where the interior scheme is unstable by itself.
    """
    import numpy as np
    from matplotlib.colors import Normalize

    assert found.sweep is not None
    name = found.scheme.cfl
    axes.set_xlabel(label_of(found.scheme, found.sweep.name))
    axes.set_ylabel(label_of(found.scheme, name))
    if found.sweep.logarithmic:
        axes.set_xscale("log")
    axes.grid(visible=False)
    usable = (found.known & found.interior).T
    radius = np.where(usable, found.radius.T, np.nan)
    norm = Normalize(0.0, min(2.0, max(1.0, float(np.nanmax(radius, initial=1.0)))), clip=True)
    x, y = found.values, found.lams
    edges = _edge(x, logarithmic=found.sweep.logarithmic), _edge(y, logarithmic=False)
    surface = axes.pcolormesh(*edges, radius, cmap=COLOURS, norm=norm, rasterized=True)
    axes.figure.colorbar(surface, ax=axes, label="largest modulus of a mode", extend="max")
    if min(radius.shape) > 1:
        if np.nanmin(radius, initial=1.0) < 1 < np.nanmax(radius, initial=1.0):
            axes.contour(x, y, radius, levels=[1.0], **CIRCLE)
        if not found.interior.all():
            axes.contourf(x, y, (~found.interior.T).astype(float), levels=[0.5, 1.5], **OUTSIDE)
    _cross_out(axes, x, y, found.interior.T & ~found.known.T)
    axes.set_title(plain(found.scheme.title), loc="left", wrap=True)


def draw_moduli(found: RadiusMap, axes: Axes) -> None:
    """The largest modulus over lam alone."""
    import numpy as np

    usable = (found.known & found.interior)[0]
    axes.plot(found.lams, np.where(usable, found.radius[0], np.nan))
    axes.axhline(1.0, color="#D55E00", linewidth=1.0)
    axes.set_xlabel(label_of(found.scheme, found.scheme.cfl))
    axes.set_ylabel("largest modulus of a mode")
    axes.set_title(plain(found.scheme.title), loc="left", wrap=True)


def _set_axes(axes: Axes, scheme: Scheme, sweeps: Sequence[Sweep]) -> None:
    axes.set_xlabel(label_of(scheme, sweeps[0].name))
    axes.set_ylabel(label_of(scheme, sweeps[1].name))
    if sweeps[0].logarithmic:
        axes.set_xscale("log")
    if sweeps[1].logarithmic:
        axes.set_yscale("log")
    axes.grid(visible=False)


def _doubles(sweep: Sweep) -> NDArray[np.float64]:
    import numpy as np

    return np.array([float(value) for value in sweep.values])


def _edges(
    x: NDArray[np.float64], y: NDArray[np.float64], sweeps: Sequence[Sweep]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return _edge(x, logarithmic=sweeps[0].logarithmic), _edge(y, logarithmic=sweeps[1].logarithmic)


def _edge(values: NDArray[np.float64], *, logarithmic: bool) -> NDArray[np.float64]:
    """The ends of the cells of which the values are the middles."""
    import numpy as np

    at = np.log(values) if logarithmic else values
    if len(at) == 1:
        return np.asarray(np.exp(at[0] + np.array([-0.5, 0.5])) if logarithmic else at[0] + np.array([-0.5, 0.5]))
    inner = (at[1:] + at[:-1]) / 2
    ends = np.concatenate([[2 * at[0] - inner[0]], inner, [2 * at[-1] - inner[-1]]])
    return np.asarray(np.exp(ends) if logarithmic else ends)


def _levels(heights: NDArray[np.float64], *, logarithmic: bool) -> list[float]:
    """Some round values between the smallest and the largest."""
    from matplotlib.ticker import MaxNLocator

    low, high = float(heights.min()), float(heights.max())
    if logarithmic:
        decades = [10.0**k for k in range(floor(log10(low)), ceil(log10(high)) + 1)]
        steps = decades[:: len(decades) // 8 + 1] if len(decades) > FEW else [k * d for d in decades for k in (1, 2, 5)]
        return [level for level in steps if low < level < high] or [(low * high) ** 0.5]
    inner = [float(v) for v in MaxNLocator(7).tick_values(low, high) if low < v < high]
    return inner or [(low + high) / 2]


def _cross_out(axes: Axes, x: NDArray[np.float64], y: NDArray[np.float64], open_: NDArray[np.bool_]) -> None:
    import numpy as np

    down, across = np.nonzero(open_)
    if len(down):
        step = max(1, len(down) // MOST_CROSSES)
        axes.plot(x[across[::step]], y[down[::step]], label="undecided", **OPEN)
        figure: Figure = axes.figure  # type: ignore[assignment]
        figure.legend(loc="outside lower center")
