"""A report as Markdown, with LaTeX mathematics as most viewers of Markdown set it, and pictures beside it."""

from __future__ import annotations

import re

from gks.reports.document import (
    Block,
    Code,
    Figure,
    Formula,
    Inline,
    Link,
    Listing,
    Maths,
    Paragraph,
    Report,
    Strong,
    Table,
    Text,
)
from gks.reports.latex import latex


def markdown(report: Report) -> str:
    """The whole report; pictures are NAME.svg beside it."""
    parts = [f"# {_escaped(' '.join(report.title.split()))}", *map(_block, report.summary)]
    for section in report.sections:
        parts += [f"## {_escaped(section.title)}", *map(_block, section.blocks)]
    return "\n\n".join(part for part in parts if part) + "\n"


def _block(block: Block) -> str:
    if isinstance(block, Paragraph):
        return text_markdown(block.text)
    if isinstance(block, Formula):
        return f"$$\n{latex(block.node)}\n$$"
    if isinstance(block, Listing):
        return "\n".join(f"- {text_markdown(item)}" for item in block.items)
    return _table(block) if isinstance(block, Table) else _figure(block)


def _table(table: Table) -> str:
    rules = ("---:" if k in table.numeric else ":---" for k in range(len(table.columns)))
    rows = [map(text_markdown, table.columns), rules, *(map(text_markdown, row) for row in table.rows)]
    lines = "\n".join("| " + " | ".join(_cell(cell) for cell in row) + " |" for row in rows)
    return f"{text_markdown(table.caption)}\n\n{lines}" if table.caption else lines


def _cell(text: str) -> str:
    """A bar ends a cell, also inside mathematics."""
    return text.replace("|", r"\|").replace("\n", " ")


def _figure(figure: Figure) -> str:
    images = "\n".join(f"![{_escaped(figure.description)}]({name}.svg)" for name in figure.files())
    files = ", ".join(f"[{figure.name}{ending}.csv]({figure.name}{ending}.csv)" for ending in figure.data)
    return f"{images}\n\n*{text_markdown(figure.caption)}* {_escaped(figure.description)} Data: {files}."


def text_markdown(text: Text) -> str:
    """A line of text with what stands in it."""
    return "".join(map(_inline, text))


def _inline(piece: Inline) -> str:
    if isinstance(piece, str):
        return _escaped(piece)
    if isinstance(piece, Maths):
        return f"${latex(piece.node)}$"
    if isinstance(piece, Code):
        fence = "`" * (1 + max((len(run) for run in re.findall("`+", piece.text)), default=0))
        return f"{fence}{piece.text}{fence}"
    if isinstance(piece, Link):
        return f"[{_escaped(piece.text)}]({piece.target})"
    return _strong(piece.text) if isinstance(piece, Strong) else _escaped(piece.text)


def _strong(text: str) -> str:
    """White space stays outside: asterisks next to it on the inside are asterisks."""
    inner = text.strip()
    before, _, after = text.partition(inner)
    return f"{before}**{_escaped(inner)}**{after}"


def _escaped(text: str) -> str:
    return re.sub(r"([\\`*_\[\]<>$#])", r"\\\1", text)
