"""A report as one HTML file: nothing is fetched, the mathematics is MathML, the figures are SVG inside the page."""

from __future__ import annotations

import os
from collections.abc import Callable
from datetime import UTC, datetime

import gks
from gks.reports.document import (
    Block,
    Code,
    Figure,
    Formula,
    Inline,
    Link,
    Listing,
    Maths,
    Number,
    Panel,
    Paragraph,
    Report,
    Section,
    Strong,
    Table,
    Text,
)
from gks.reports.formulas import plain
from gks.reports.inline_svg import inline_svg
from gks.reports.mathml import escaped, mathml

_STYLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "page.css")


Drawer = Callable[[Panel, str, str, str], str]
"""Gives the `svg` element of a panel, from a key for its identifiers, its title and its text equivalent."""


def html(report: Report, draw: Drawer = inline_svg) -> str:
    """The page. Its links lead to the files that are written beside it, and to places on it."""
    with open(_STYLE, encoding="utf-8") as file:
        style = file.read()
    contents = "".join(f'<li><a href="#{s.anchor}">{escaped(s.title)}</a></li>' for s in report.sections)
    body = "".join(_section(section, draw) for section in report.sections)
    now = datetime.now(UTC)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="generator" content="gks {gks.__version__}">
<link rel="icon" href="data:,">
<title>{escaped(report.title)}</title>
<style>
{style}</style>
</head>
<body>
<a class="skip" href="#content">Skip to the content</a>
<header>
<h1>{escaped(report.title)}</h1>
</header>
<nav aria-label="Contents"><ul>{contents}</ul></nav>
<main id="content" tabindex="-1">
{"".join(_block(block, draw) for block in report.summary)}{body}</main>
<footer><p>Made by gks {gks.__version__} on <time datetime="{now:%Y-%m-%dT%H:%MZ}">{now:%Y-%m-%d}</time>; every number
with all its digits: <a href="{report.name}.json">{report.name}.json</a>.</p></footer>
</body>
</html>
"""


def _section(section: Section, draw: Drawer) -> str:
    head = f'<section id="{section.anchor}" aria-labelledby="{section.anchor}-title">\n'
    title = f'<h2 id="{section.anchor}-title">{escaped(section.title)}</h2>\n'
    return head + title + "".join(_block(block, draw) for block in section.blocks) + "</section>\n"


def _block(block: Block, draw: Drawer) -> str:
    if isinstance(block, Paragraph):
        return f"<p>{text_html(block.text)}</p>\n"
    if isinstance(block, Formula):
        place = f' data-place="{_quoted(block.place)}"' if block.place else ""
        return (
            f'<div class="formula scroll" role="region" tabindex="0" aria-label="{_quoted(block.label)}"{place}>'
            f"{mathml(block.node, block=True)}</div>\n"
        )
    if isinstance(block, Listing):
        return "<ul>" + "".join(f"<li>{text_html(item)}</li>" for item in block.items) + "</ul>\n"
    return _table(block) if isinstance(block, Table) else _figure(block, draw)


def text_html(text: Text) -> str:
    """A line of text with what stands in it."""
    return "".join(map(_inline, text))


def _inline(piece: Inline) -> str:
    if isinstance(piece, str):
        return escaped(piece)
    if isinstance(piece, Maths):
        return mathml(piece.node)
    if isinstance(piece, Number):
        place = f'value="{_quoted(str(piece.value))}" data-place="{_quoted(piece.place)}"'
        return f"<data {place}>{escaped(piece.text)}</data>"
    if isinstance(piece, Code):
        return f"<code>{escaped(piece.text)}</code>"
    if isinstance(piece, Link):
        return f'<a href="{_quoted(piece.target)}">{escaped(piece.text)}</a>'
    if isinstance(piece, Strong):
        tone = f' class="{piece.tone}"' if piece.tone else ""
        return f"<strong{tone}>{escaped(piece.text)}</strong>"
    return f"<time>{escaped(piece.text)}</time>"


def _quoted(text: str) -> str:
    return escaped(text).replace('"', "&quot;")


def _called(ending: str) -> str:
    """What a link to one of several data files is called."""
    word = ending.strip("-")
    return f"line {word}" if word.isdigit() else word or "CSV"


def _table(table: Table) -> str:
    labels = [_words(column) for column in table.columns]
    head = ""
    if any(labels):
        cells = (
            f'<th scope="col"{_right(k, table)}>{text_html(column)}</th>' if labels[k] else "<td></td>"
            for k, column in enumerate(table.columns)
        )
        head = f"<thead><tr>{''.join(cells)}</tr></thead>"
    rows = "".join(f"<tr>{''.join(_cells(row, labels, table))}</tr>\n" for row in table.rows)
    caption = f"<caption>{text_html(table.caption)}</caption>" if table.caption else ""
    name = _quoted(_words(table.caption)) or "Table"
    return (
        f'<div class="scroll" role="region" tabindex="0" aria-label="{name}"><table class="stack">{caption}{head}'
        f"<tbody>\n{rows}</tbody></table></div>\n"
    )


def _cells(row: tuple[Text, ...], labels: list[str], table: Table) -> list[str]:
    """The cells of a row; where no column has a heading the first cell is the row's."""
    found = []
    for k, cell in enumerate(row):
        if k == 0 and not any(labels):
            found.append(f'<th scope="row">{text_html(cell)}</th>')
        else:
            label = f' data-label="{_quoted(labels[k])}"' if labels[k] else ""
            found.append(f"<td{_right(k, table)}{label}>{text_html(cell)}</td>")
    return found


def _right(column: int, table: Table) -> str:
    return ' class="n"' if column in table.numeric else ""


def _words(text: Text) -> str:
    """The text without its markup, for labels."""
    return "".join(p if isinstance(p, str) else plain(p.node) if isinstance(p, Maths) else p.text for p in text)


def drawings(figure: Figure) -> list[tuple[Panel, str, str, str]]:
    """What a `Drawer` is given for each panel of a figure."""
    titles = [panel.title or _words(figure.caption) for panel in figure.panels]
    keys = [f"{figure.name}-{k}" for k in range(len(titles))] if len(titles) > 1 else [figure.name]
    return [
        (panel, key, title, figure.description) for panel, key, title in zip(figure.panels, keys, titles, strict=True)
    ]


def _figure(figure: Figure, draw: Drawer) -> str:
    panels = [draw(*drawing) for drawing in drawings(figure)]
    files = [(figure.name + ending, ending) for ending in figure.data]
    links = ", ".join(f'<a href="{name}.csv" download>{_called(ending)}</a>' for name, ending in files)
    return (
        f'<figure id="fig-{figure.name}"><div class="panels">{"".join(panels)}</div>'
        f'<figcaption>{text_html(figure.caption)} <span class="seen">{escaped(figure.description)} '
        f"Data: {links}.</span></figcaption></figure>\n"
    )


