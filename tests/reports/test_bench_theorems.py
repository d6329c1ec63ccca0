"""The table of theorems: one row a scheme, with what two processes said."""

from __future__ import annotations

import pytest

from gks.reports.bench_theorems import INTERIORS, PAPER, all_schemes, interface, measure
from gks.scheme.schemefile import parse_scheme


def test_a_row_says_what_was_proved_and_that_it_was_checked() -> None:
    told: list[str] = []
    table = measure(told.append, schemes={"traditional-1": ""})
    (row,) = table.rows
    values = dict(zip(table.columns, row, strict=True))
    assert told == ["traditional-1"]
    assert (values["status"], values["pieces"], values["check"]) == ("proved", 2, "accepted")
    assert values["bound"] == "1; 4/(alpha + 1)"


def test_what_is_not_proved_in_time_says_the_stage() -> None:
    table = measure(lambda name: None, limit=0.01, schemes={"traditional-1": ""})
    values = dict(zip(table.columns, table.rows[0], strict=True))
    assert values["status"] == "not-proved"
    assert "time limit" in str(values["stage"])


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", INTERIORS)
def test_every_interface_is_a_scheme(name: str, order: int) -> None:
    assert parse_scheme(interface(name, order), name).closure.equations


def test_all_rows_are_told_apart() -> None:
    assert len(all_schemes()) == len(PAPER) + 2 * len(INTERIORS)
