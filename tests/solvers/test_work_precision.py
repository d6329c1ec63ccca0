"""Work-precision: what is measured is measured against the right answer. No time is asserted."""

from __future__ import annotations

import csv
import io
from fractions import Fraction

import pytest

from gks.solvers.work_precision import (
    ANALYSER_NORM,
    SOLVER_NORM,
    Row,
    WorkPrecision,
    _bisected,
    machine,
    marching_speed,
    work_precision,
)


@pytest.fixture(scope="module")
def measured() -> WorkPrecision:
    return work_precision((25, 50), (16, 64), (4,), (1, 50), (53, 128), (1, 50), repeats=1)


def test_every_route_is_there(measured: WorkPrecision) -> None:
    methods = {(row.subject, row.method) for row in measured.rows}
    solver = {f"{name}, order {order}" for name in ("traditional", "weighted", "characteristic") for order in (1, 2)}
    assert {method for subject, method in methods if subject == "solver"} == solver
    analyser = {"march, bisected", "finite matrix, bisected", "numeric, a point of a sweep", "certified"}
    analyser |= {"proof, for all alpha", "proved, a point of many"}
    assert {method for subject, method in methods if subject == "analyser"} == analyser
    assert all(row.fastest <= row.seconds <= row.slowest and row.repeats == 1 for row in measured.rows)


def errors(measured: WorkPrecision, method: str) -> list[float]:
    return [row.error for row in measured.rows if row.method == method]


def test_more_work_is_more_precise(measured: WorkPrecision) -> None:
    for condition in ("traditional", "weighted", "characteristic"):
        for order in (1, 2):
            coarse, fine = errors(measured, f"{condition}, order {order}")
            assert fine < (0.7 if order == 1 else 0.4) * coarse
    short, long = errors(measured, "march, bisected")
    assert long < 1e-6 < short < 0.1


def test_the_routes_meet_at_the_exact_answer(measured: WorkPrecision) -> None:
    assert errors(measured, "finite matrix, bisected")[0] < 1e-13
    assert max(errors(measured, "numeric, a point of a sweep")) < 2.0**-52
    assert errors(measured, "certified")[0] < 2.0**-53 and errors(measured, "certified")[1] < 2.0**-128
    assert max(*errors(measured, "proof, for all alpha"), *errors(measured, "proved, a point of many")) < 2.0**-50
    assert {row.norm for row in measured.rows} == {SOLVER_NORM, ANALYSER_NORM}


def test_the_table_as_csv(measured: WorkPrecision) -> None:
    head, *lines = measured.to_csv().splitlines()
    assert head == f"# {measured.machine}"
    rows = list(csv.DictReader(io.StringIO("\n".join(lines))))
    assert len(rows) == len(measured.rows)
    for read, row in zip(rows, measured.rows, strict=True):
        assert (read["method"], float(read["error"]), float(read["seconds"])) == (row.method, row.error, row.seconds)


def test_the_table_as_text(measured: WorkPrecision) -> None:
    assert len(str(measured).splitlines()) == 2 + len(measured.rows)
    assert "numpy" in str(measured)


def test_routes_that_are_not_asked_for_are_not_run() -> None:
    told: list[Row] = []
    found = work_precision((), (), (), (), (53,), (), repeats=1, progress=told.append)
    assert tuple(told) == found.rows and [row.method for row in told] == ["certified"]


def test_the_march_is_timed_by_the_cells_it_advances() -> None:
    assert marching_speed(cells=200, steps=5, repeats=1) > 0


def test_bisection_halves_the_interval() -> None:
    found, _ = _bisected(lambda lam: lam < Fraction(1, 3), 30)
    assert abs(found - Fraction(1, 3)) < Fraction(1, 2**30)
    assert abs(_bisected(lambda lam: lam < Fraction(1, 3), 3)[0] - Fraction(1, 3)) > Fraction(1, 2**10)


def test_the_machine_is_named() -> None:
    found = machine()
    assert found.cores >= 1 and found.processor
    assert {name for name, _ in found.versions} == {"Python", "numpy", "scipy", "python-flint"}
