"""The paper's Figures 2 to 11, drawn so that they can be laid beside the paper's: same axes, same quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import log
from typing import TYPE_CHECKING, Any

from gks.reports.scheme_figures import BLACK, BLUE, GREEN, RED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LABELS = {"velocity": "velocity $u$", "stress": r"stress $\sigma$"}

SETTLED = 1.5
"""The pulses have left; from here on the reference lines are laid through the data."""


def draw_riemann(data: Mapping[str, Any], quantity: str, axes: Axes) -> None:
    """Figures 2, 10, 11: solid x, fluid o, the exact solution as a line."""
    for k, side in enumerate(("exact_solid", "exact_gas")):
        label = "exact" if k else None
        axes.plot(data[side]["x"], data[side][quantity], color=BLACK, linestyle="-", linewidth=1.1, label=label)
    axes.plot(data["solid"]["x"], data["solid"][quantity], "x", color=RED, markersize=3.4, label="solid")
    axes.plot(
        data["gas"]["x"], data["gas"][quantity], "o", color=BLUE, markersize=3.2, markerfacecolor="none", label="fluid"
    )
    axes.set_xlabel("$x$")
    axes.set_ylabel(LABELS[quantity])
    axes.figure.legend(loc="outside lower center", ncols=3)


def draw_exact(data: Mapping[str, Any], k: int, axes: Axes) -> None:
    """Figure 4: velocity and stress at one time."""
    axes.plot(data["x"], data["velocity"][k], color=BLUE, linestyle="-", label="velocity $u$")
    axes.plot(data["x"], data["stress"][k], color=RED, linestyle="--", label=r"stress $\sigma$")
    axes.axvline(0, color=BLACK, linewidth=0.7, linestyle=":")
    axes.set_xlabel("$x$")
    axes.set_ylim(-6.5, 6.5)
    axes.figure.legend(loc="outside lower center", ncols=2)


def draw_errors(lines: Sequence[Mapping[str, Any]], quantity: str, labels: Sequence[str], axes: Axes) -> None:
    """Figures 5 to 8: the largest error over time, with a black line of the theoretical slope through each."""
    for line, label, style in zip(lines, labels, ((BLUE, "-"), (RED, (0, (5, 1.5)))), strict=False):
        times, errors = line["times"], logarithmic(line[f"{quantity}_error"])
        axes.plot(times, errors, color=style[0], linestyle=style[1], linewidth=1.3, label=label)
        reference = _reference(line, errors)
        if reference is not None:
            axes.plot(*reference, color=BLACK, linewidth=1.2, linestyle=(0, (1.5, 1.5)), zorder=5)
    axes.plot([], [], color=BLACK, linewidth=1.0, linestyle=(0, (1.5, 1.5)), label="theory")
    axes.set_yscale("log")
    axes.set_xlabel("time $t$")
    axes.set_ylabel(f"largest error of the {quantity}")
    axes.figure.legend(loc="outside lower center", ncols=3)


def logarithmic(values: Sequence[float | None]) -> list[float]:
    """Values for a logarithmic axis: what has no logarithm is a gap."""
    return [value or float("nan") for value in values]


def _reference(line: Mapping[str, Any], errors: Sequence[float]) -> tuple[list[float], list[float]] | None:
    """Two ends of the line of slope log(root)/dt through the settled part of the errors; None without either."""
    root = line["root"]
    late = [(t, log(e)) for t, e in zip(line["times"], errors, strict=True) if e > 0 and t >= SETTLED]
    if root is None or not root > 0 or len(late) < 2:
        return None
    slope = log(root) / line["dt"]
    # Through the median of what the errors are above the line: they oscillate around it.
    offsets = sorted(value - slope * t for t, value in late)
    offset = offsets[len(offsets) // 2]
    ends = [SETTLED, late[-1][0]]
    return ends, [_exp(offset + slope * t) for t in ends]


def _exp(value: float) -> float:
    from math import exp

    return exp(max(value, -700.0))


SHADES = ((RED, "-"), (BLUE, "--"), (GREEN, "-."), ("#CC79A7", ":"), (BLACK, "-"))


def draw_resolutions(lines: Sequence[Mapping[str, Any]], axes: Axes) -> None:
    """Figure 9, above: the velocity error over time for each resolution, in the paper's order of colours."""
    for line, (colour, dashes) in zip(lines, SHADES, strict=True):
        label = rf"$\Delta x = 1/{line['cells']}$"
        errors = logarithmic(line["velocity_error"])
        axes.plot(line["times"], errors, color=colour, linestyle=dashes, linewidth=1.2, label=label)
    axes.set_yscale("log")
    axes.set_xlabel("time $t$")
    axes.set_ylabel("largest error of the velocity")
    axes.figure.legend(loc="outside lower center", ncols=3)


def draw_convergence(studies: Mapping[str, Mapping[str, Any]], axes: Axes) -> None:
    """Figure 9, below: the error at t = 0.5 over dx, with the slope of second order."""
    for (label, study), (colour, mark) in zip(studies.items(), ((RED, "s"), (BLUE, "o")), strict=True):
        axes.plot(study["dx"], study["errors"], color=colour, marker=mark, linestyle="-", label=label)
    dx, errors = studies["weighted"]["dx"], studies["weighted"]["errors"]
    guide = [0.5 * errors[-1] * (h / dx[-1]) ** 2 for h in dx]
    axes.plot(dx, guide, color=BLACK, linewidth=1.0, linestyle=(0, (1.5, 1.5)), label="second order")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(dx, [f"1/{round(1 / h)}" for h in dx])
    axes.minorticks_off()
    axes.set_xlabel(r"$\Delta x$")
    axes.set_ylabel("velocity error at $t = 0.5$")
    axes.figure.legend(loc="outside lower center", ncols=3)


def draw_bounds(curves: Mapping[str, Mapping[str, Any]], axes: Axes) -> None:
    """Figure 3, with first order and the weighted condition beside it: the largest stable lam over the ratio."""
    styles = ((BLACK, "-"), (BLUE, "--"), (RED, "-."))
    for (label, curve), (colour, dashes) in zip(curves.items(), styles, strict=True):
        xs = [point["alpha"] for point in curve["points"]]
        axes.plot(xs, [point["lam_max"] for point in curve["points"]], color=colour, linestyle=dashes, label=label)
    axes.set_xscale("log")
    axes.set_ylim(0, 1.08)
    axes.set_xlabel(r"$\alpha = \rho_R/\rho_L$")
    axes.set_ylabel(r"largest stable $\lambda$")
    axes.margins(x=0)
    axes.figure.legend(loc="outside lower center", ncols=2)


MARKS = ("o", "s", "^", "D", "v", "x")


def draw_work(rows: Sequence[Mapping[str, Any]], axes: Axes) -> None:
    """Error over median seconds, a line a method."""
    methods = list(dict.fromkeys(row["method"] for row in rows))
    colours = (BLUE, RED, GREEN, BLACK, "#CC79A7", "#E69F00")
    for k, method in enumerate(methods):
        mine = [row for row in rows if row["method"] == method]
        seconds = [row["seconds"] for row in mine]
        errors = [max(row["error"], SMALLEST) for row in mine]
        spread = (
            [row["seconds"] - row["fastest_s"] for row in mine],
            [row["slowest_s"] - row["seconds"] for row in mine],
        )
        axes.errorbar(
            seconds, errors, xerr=spread, color=colours[k % 6], marker=MARKS[k % 6], linestyle="-" if k % 2 else "--",
            linewidth=1.0, elinewidth=0.7, markersize=4.5, label=method,
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("seconds (median; bars: fastest to slowest)")
    axes.set_ylabel("error")
    axes.figure.legend(loc="outside lower center", ncols=2)


SMALLEST = 1e-20
"""Certified errors reach 1e-100; they are drawn here."""
