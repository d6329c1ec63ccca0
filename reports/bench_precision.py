"""Error against run time, as a table and as a picture: `gks bench precision`.

What is measured, and how, is said in `gks.solvers.work_precision`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import groupby
from typing import TYPE_CHECKING

from gks.files import write_bytes
from gks.reports.canvas import format_of, image, styled
from gks.reports.tables import Table
from gks.solvers.work_precision import Row, machine, marching_speed, work_precision

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TITLE = "Error against run time"

COLUMNS = ("subject", "method", "setting", "error", "seconds", "fastest_s", "slowest_s", "repeats", "norm")

SMALLEST = 1e-18
"""Errors below this are drawn here, with a mark of their own: certified ones reach 1e-100."""

WIDTH = 9.6
"""Inches, of two panels side by side."""


def measure(progress: Callable[[str], None]) -> Table:
    """Every route of `work_precision` at its default sizes, with the speed of a march below."""

    def told(row: Row) -> None:
        progress(f"{row.subject}: {row.method}, {row.setting}")

    rows = work_precision(progress=told).rows
    progress("solver: cells advanced a second")
    return table_of(rows, marching_speed())


def table_of(rows: tuple[Row, ...], cells_a_second: float) -> Table:
    """The rows as a table; its notes name the machine, the norms' reference and the speed of a march."""
    cells = tuple(
        (r.subject, r.method, r.setting, r.error, r.seconds, r.fastest, r.slowest, r.repeats, r.norm) for r in rows
    )
    notes = (
        str(machine()),
        "seconds: median of the repetitions, wall clock; solver: against the exact solution by characteristics; "
        "analyser: lam_max of traditional-2 near alpha = 1, against its algebraic number",
        f"a march of the upwind scheme advances {cells_a_second:.2g} cells of two unknowns a second on one core "
        "(8000 cells a side, numpy)",
    )
    return Table(TITLE, COLUMNS, cells, notes)


def save(table: Table, path: str) -> None:
    """Draw the table into a .png, .svg or .pdf file, written whole or not at all; ValueError for another ending."""
    from matplotlib.figure import Figure

    kind = format_of(path)
    with styled():
        figure = Figure()
        figure.set_figwidth(WIDTH)
        solver, analyser = figure.subplots(1, 2)
        draw(table, "solver", solver)
        draw(table, "analyser", analyser)
        write_bytes(path, image(figure, kind, table.title))


MARKS = "osD^vP"


def draw(table: Table, subject: str, axes: Axes) -> None:
    """Error over seconds, a line for each method of the subject ("solver" or "analyser").

    Errors of SMALLEST or less, zero among them, stand at SMALLEST with hollow marks.
    """
    norm = next((str(row["norm"]) for row in _rows(table) if row["subject"] == subject), "")
    methods = groupby((row for row in _rows(table) if row["subject"] == subject), lambda row: row["method"])
    tiny = False
    for mark, (method, group) in zip(MARKS * 4, methods, strict=False):
        points = [(float(row["seconds"]), float(row["error"])) for row in group]  # type: ignore[arg-type]
        seconds, errors = [s for s, _ in points], [max(e, SMALLEST) for _, e in points]
        (line,) = axes.plot(seconds, errors, marker=mark, label=str(method))
        below = [s for s, e in points if e <= SMALLEST]
        axes.plot(below, [SMALLEST] * len(below), linestyle="none", marker=mark, color=line.get_color(), mfc="white")
        tiny = tiny or bool(below)
    axes.set(xscale="log", yscale="log", xlabel="seconds")
    axes.set_ylabel(norm + (f"\n(hollow: {SMALLEST:g} or less)" if tiny else ""))
    axes.set_title(f"reference {subject}" if subject == "solver" else subject)
    axes.legend()


def _rows(table: Table) -> Iterator[dict[str, object]]:
    return (dict(zip(table.columns, row, strict=True)) for row in table.rows)
