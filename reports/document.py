"""A report as data: sections of text, formulas, tables and figures, and the results that every number comes from.

Each renderer (`page`, `markdown`, `tex`, `record`) writes this one object in its own form. A number is never typed
in: it is taken out of a result by its place there (`Results.number`), and carries that place along.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from gks.reports.formulas import Node, formula, slashed

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, slots=True)
class Maths:
    """A formula in a line of text."""

    node: Node


@dataclass(frozen=True, slots=True)
class Number:
    """A number on the page: as shown, in full, and where it stands in the record ("/results/modes/result/margin")."""

    text: str
    value: float | int | str
    place: str


@dataclass(frozen=True, slots=True)
class Code:
    """A command, a file name, a formula too long to lay out."""

    text: str


@dataclass(frozen=True, slots=True)
class Link:
    """A file beside the page, or a place on it ("#modes")."""

    text: str
    target: str


@dataclass(frozen=True, slots=True)
class Strong:
    """A word to be seen first; `tone` is "good", "bad", "open" or ""."""

    text: str
    tone: str = ""


@dataclass(frozen=True, slots=True)
class Seconds:
    """A time that was measured, or a date: the one thing that differs between two runs."""

    text: str


Inline = str | Maths | Number | Code | Link | Strong | Seconds
Text = tuple[Inline, ...]


@dataclass(frozen=True, slots=True)
class Paragraph:
    """A paragraph."""

    text: Text


@dataclass(frozen=True, slots=True)
class Formula:
    """A formula on a line of its own; `label` says what it is, to whoever does not see it, `place` where it is from."""

    node: Node
    label: str
    place: str = ""


@dataclass(frozen=True, slots=True)
class Listing:
    """Points in a list."""

    items: tuple[Text, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """Rows under headings. `numeric` are the columns aligned to the right; `wide` ones scroll on a narrow screen."""

    caption: Text
    columns: tuple[Text, ...]
    rows: tuple[tuple[Text, ...], ...]
    numeric: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class Panel:
    """One picture: what draws it on an Axes, its title among others ("" where it is alone), height over width.

    `draw` can be pickled (a function of a module, or a `partial` of one on plain data), so that any process can draw.
    """

    draw: Callable[[Axes], None]
    title: str = ""
    aspect: float = 0.68


@dataclass(frozen=True, slots=True)
class Data:
    """The data behind a figure: columns of equal length, written as CSV beside the page."""

    columns: Mapping[str, Sequence[object]]

    def to_csv(self) -> str:
        """A header and a line a row; floats with all their digits, None left empty."""
        import csv
        import io

        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(["" if v is None else v for v in row] for row in zip(*self.columns.values(), strict=True))
        return text.getvalue()


@dataclass(frozen=True, slots=True)
class Figure:
    """Pictures side by side with one caption.

    name         of its files: NAME.csv, NAME.pdf
    caption      what it shows and how to read it
    description  its text equivalent: what one sees in it
    data         the tables behind it, by the ending of their file's name ("" for the only one)
    """

    name: str
    caption: Text
    description: str
    panels: tuple[Panel, ...]
    data: Mapping[str, Data]

    def files(self) -> tuple[str, ...]:
        """The name of each panel's picture file, without its ending."""
        if len(self.panels) == 1:
            return (self.name,)
        return tuple(f"{self.name}-{k + 1}" for k in range(len(self.panels)))


Block = Paragraph | Formula | Listing | Table | Figure


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page under its own heading; `anchor` names it in links."""

    anchor: str
    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """The whole: what is at the top, the sections, the results by name, the schemes' texts, files to go with it."""

    name: str
    title: str
    summary: tuple[Block, ...]
    sections: tuple[Section, ...]
    results: Mapping[str, Mapping[str, Any]]
    schemes: Mapping[str, str]
    attachments: Mapping[str, str]

    def figures(self) -> tuple[Figure, ...]:
        """All figures in their order."""
        return tuple(b for s in self.sections for b in s.blocks if isinstance(b, Figure))


def prose(text: str) -> Text:
    """Text in which $...$ stands for a formula."""
    parts = text.split("$")
    return tuple(Maths(slashed(formula(part))) if k % 2 else part for k, part in enumerate(parts) if part)


# Taking numbers out of results ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Result:
    """What one step gave, as the record has it; `get` and `number` address it by keys and indices."""

    name: str
    record: Mapping[str, Any]

    @property
    def refused(self) -> str | None:
        """Why there is no result, or None."""
        found = self.record.get("refused")
        return None if found is None else str(found)

    def get(self, *path: str | int) -> Any:
        """The value at that place."""
        value: Any = self.record["result"]
        for key in path:
            value = value[key]
        return value

    def number(self, *path: str | int, digits: int = 6) -> Number:
        """The number at that place, shown to so many digits."""
        value = self.get(*path)
        return Number(shown(value, digits), value, self._place(path))

    def quote(self, *path: str | int) -> Number:
        """The words at that place, numbers and all."""
        value = str(self.get(*path))
        return Number(value, value, self._place(path))

    def _place(self, path: tuple[str | int, ...]) -> str:
        """A JSON pointer (RFC 6901) into the record."""
        keys = (str(key).replace("~", "~0").replace("/", "~1") for key in path)
        return "/".join(["", "results", self.name, "result", *keys])


def counted(count: int, noun: str) -> str:
    """So many of them: "1 root", "2 roots"."""
    return f"{count} {noun}{'s' * (count != 1)}"


def signed(number: Number) -> Number:
    """The number as what is added to another: with its sign and a space before it."""
    text = number.text
    return Number(f"− {text[1:]}" if text.startswith("−") else f"+ {text}", number.value, number.place)


def shown(value: object, digits: int = 6) -> str:
    """A number as text: so many significant digits, "∞" for oo, "–" for None."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str):
        return {"oo": "∞", "inf": "∞", "-oo": "−∞"}.get(value, value.replace("-", "−"))
    if isinstance(value, int):
        return str(value).replace("-", "−")
    text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    if not exponent:
        return text.replace("-", "−")
    power = "".join(_RAISED[c] for c in str(int(exponent)))
    return f"{mantissa} × 10{power}".replace("-", "−").removeprefix("1 × ")


_RAISED = dict(zip("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹", strict=True))
