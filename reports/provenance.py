"""What was run for a report, with which versions, and how long it took."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from functools import cache
from importlib import metadata
from typing import Any

import gks
from gks.reports.document import Code, Paragraph, Seconds, Section, Table, Text

PACKAGES = ("python-flint", "numpy", "scipy", "sympy", "matplotlib")


@cache
def _installed(package: str) -> str:
    return metadata.version(package)


def versions() -> tuple[tuple[str, str], ...]:
    """The program's version and those of what it stands on."""
    found = [("gks", gks.__version__), ("Python", platform.python_version())]
    return (*found, *((package, _installed(package)) for package in PACKAGES))


def provenance(records: Mapping[str, Mapping[str, Any]]) -> Section:
    """The section at the end of every report."""
    rows: list[tuple[Text, ...]] = []
    for name, record in records.items():
        command = record.get("command") or call_of(record)
        rows.append(((name,), (Code(command),), (Seconds(f"{record['seconds']:.2f}"),)))
    columns: tuple[Text, ...] = (("result",), ("command",), ("seconds",))
    stated = ", ".join(f"{name} {version}" for name, version in versions())
    return Section(
        "provenance",
        "What was run",
        (
            Table(("Each result, what gives it, and the time it took.",), columns, tuple(rows), frozenset({2})),
            Paragraph((f"With {stated}.",)),
        ),
    )


def call_of(record: Mapping[str, Any]) -> str:
    """The call that gives a result which no command gives."""
    given = [f"{key}={value!r}" for key, value in record["arguments"].items()]
    return f"gks.reports.{record['kind']}({', '.join(['scheme', *given] if record.get('scheme') else given)})"
