"""A table of measurements: text for people, CSV and JSON for programs."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Cell = str | int | float | bool | None
"""What a column holds; a number's unit stands in the column's name."""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows under named columns, with what was measured above and where it was measured below."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        texts = [self.columns, *(tuple(shown(cell) for cell in row) for row in self.rows)]
        widths = [max(len(row[k]) for row in texts) for k in range(len(self.columns))]
        numeric = [all(isinstance(row[k], int | float | None) for row in self.rows) for k in range(len(self.columns))]
        lines = ["  ".join(_aligned(row, widths, numeric)).rstrip() for row in texts]
        return "\n".join([self.title, "", *lines, *([""] if self.notes else []), *self.notes])

    def to_csv(self) -> str:
        """The notes as lines behind #, a header, and one line a row; floats with all their digits."""
        text = io.StringIO()
        text.writelines(f"# {note}\n" for note in self.notes)
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(["" if cell is None else cell for cell in row] for row in self.rows)
        return text.getvalue()

    def to_json(self) -> Mapping[str, object]:
        """The JSON object: one object a row, keyed by the columns."""
        rows = [dict(zip(self.columns, row, strict=True)) for row in self.rows]
        return {"schema": "gks.table/1", "title": self.title, "rows": rows, "notes": list(self.notes)}


def shown(cell: Cell) -> str:
    """A cell as text: floats to three digits, an empty one as a dash."""
    if cell is None:
        return "-"
    if isinstance(cell, bool):
        return "yes" if cell else "no"
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)


def _aligned(row: Sequence[str], widths: Sequence[int], numeric: Sequence[bool]) -> list[str]:
    """Numbers to the right, text to the left."""
    padded = zip(row, widths, numeric, strict=True)
    return [cell.rjust(width) if right else cell.ljust(width) for cell, width, right in padded]
