"""The work-precision table and its picture, from rows made up here: no time is measured."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from gks.reports import bench_precision
from gks.reports.bench import PICTURED, TABLES, save_picture
from gks.reports.bench_precision import COLUMNS, SMALLEST, draw, table_of
from gks.reports.canvas import new_figure
from gks.reports.tables import Table
from gks.solvers.work_precision import Row, WorkPrecision, machine


def row(subject: str, method: str, error: float, seconds: float) -> Row:
    return Row(subject, method, "a setting", f"error of the {subject}", error, seconds, seconds / 2, 2 * seconds, 3)


ROWS = (
    row("solver", "coarse", 0.5, 0.01),
    row("solver", "coarse", 0.25, 0.1),
    row("solver", "fine", 0.1, 1.0),
    row("analyser", "exact", 1e-100, 0.02),
    row("analyser", "matrix", 0.0, 0.2),
    row("analyser", "matrix", 1e-15, 0.3),
)


@pytest.fixture
def table() -> Table:
    return table_of(ROWS, 6.7e7)


def test_the_table_names_the_machine_and_the_norm(table: Table) -> None:
    assert table.notes[0] == str(machine())
    assert "6.7e+07 cells" in table.notes[-1]
    lines = [line for line in table.to_csv().splitlines() if not line.startswith("#")]
    read = list(csv.DictReader(io.StringIO("\n".join(lines))))
    assert tuple(read[0]) == COLUMNS and len(read) == len(ROWS)
    assert [float(line["error"]) for line in read] == [each.error for each in ROWS]
    assert {line["norm"] for line in read} == {"error of the solver", "error of the analyser"}


def test_error_stands_over_seconds_a_line_for_each_method(table: Table) -> None:
    _, axes = new_figure()
    draw(table, "solver", axes)
    lines = {str(line.get_label()): line for line in axes.get_lines() if len(line.get_xdata())}  # type: ignore[arg-type]
    assert list(lines) == ["coarse", "fine"]
    assert list(lines["coarse"].get_xdata()) == [0.01, 0.1] and list(lines["coarse"].get_ydata()) == [0.5, 0.25]  # type: ignore[arg-type]
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert axes.get_ylabel() == "error of the solver"


def test_errors_too_small_to_draw_are_marked_as_such(table: Table) -> None:
    _, axes = new_figure()
    draw(table, "analyser", axes)
    hollow = [line for line in axes.get_lines() if line.get_markerfacecolor() == "white"]
    assert [list(line.get_xdata()) for line in hollow] == [[0.02], [0.2]]  # type: ignore[arg-type]
    assert "or less" in axes.get_ylabel()
    assert min(float(np.min(line.get_ydata())) for line in axes.get_lines() if line not in hollow) == SMALLEST


def test_a_picture_is_written_whole_in_the_format_its_name_says(table: Table, tmp_path: Path) -> None:
    assert PICTURED == ("precision",) and TABLES["precision"] == bench_precision.__name__
    for ending, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        path = tmp_path / f"precision.{ending}"
        save_picture("precision", table, str(path))
        first = path.read_bytes()
        assert first.startswith(start)
        save_picture("precision", table, str(path))
        assert path.read_bytes() == first
    with pytest.raises(ValueError, match="ends in none of"):
        save_picture("precision", table, str(tmp_path / "precision.txt"))


def test_what_is_measured_becomes_the_table(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[str] = []

    def measured(progress: object) -> WorkPrecision:
        progress(ROWS[0])  # type: ignore[operator]
        return WorkPrecision(ROWS, machine())

    monkeypatch.setattr(bench_precision, "work_precision", measured)
    monkeypatch.setattr(bench_precision, "marching_speed", lambda: 6.7e7)
    assert bench_precision.measure(told.append).rows == table_of(ROWS, 6.7e7).rows
    assert told[0] == "solver: coarse, a setting"
