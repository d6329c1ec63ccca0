"""What `gks bench` measures, each table in a module of its own.

A measurement is a ratio taken in one run wherever there is something to compare with: a lone time says little about
another machine. Every table names the machine and the versions under it.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module

from gks.reports.tables import Table

Progress = Callable[[str], None]
"""Told what is being measured."""

TABLES = {
    "speed": "gks.reports.bench_speed",
    "precision": "gks.reports.bench_precision",
    "theorems": "gks.reports.bench_theorems",
    "stress": "gks.reports.bench_stress",
    "scale": "gks.reports.bench_scale",
}
"""The module of each table, loaded when it is asked for; each has `measure(progress) -> Table`."""


PICTURED = ("precision",)
"""Tables that can be drawn; their modules have `save(table, path)` for a .png, .svg or .pdf file."""


def save_picture(name: str, table: Table, path: str) -> None:
    """Draw the table of that name (one of PICTURED) into a file."""
    import_module(TABLES[name]).save(table, path)


def bench(name: str, progress: Progress) -> Table:
    """Measure the table of that name (a key of TABLES)."""
    table: Table = import_module(TABLES[name]).measure(progress)
    return table
