"""A report's record: the JSON beside the page, from which every number on it is taken, and its plain form."""

from __future__ import annotations

import json
from typing import Any

from gks.reports.document import Block, Figure, Formula, Inline, Listing, Maths, Number, Paragraph, Report, Table, Text
from gks.reports.formulas import plain
from gks.reports.provenance import versions


def record(report: Report) -> dict[str, Any]:
    """The object of gks.report/1: the results by name, and what the page says, section by section."""
    return {
        "schema": "gks.report/1",
        "title": report.title,
        "versions": dict(versions()),
        "schemes": dict(report.schemes),
        "results": {name: dict(result) for name, result in report.results.items()},
        "summary": [_block(block) for block in report.summary],
        "sections": [
            {"anchor": s.anchor, "title": s.title, "blocks": [_block(block) for block in s.blocks]}
            for s in report.sections
        ],
    }


def record_text(report: Report) -> str:
    """The record as the content of a file."""
    return json.dumps(record(report), allow_nan=False, ensure_ascii=False, indent=1) + "\n"


def _block(block: Block) -> dict[str, Any]:
    if isinstance(block, Paragraph):
        return {"paragraph": _text(block.text)}
    if isinstance(block, Formula):
        return {"formula": plain(block.node), "label": block.label}
    if isinstance(block, Listing):
        return {"list": [_text(item) for item in block.items]}
    if isinstance(block, Table):
        rows = [[_text(cell) for cell in row] for row in block.rows]
        return {"table": _text(block.caption), "columns": [_text(c) for c in block.columns], "rows": rows}
    assert isinstance(block, Figure)
    files = [f"{block.name}{ending}.csv" for ending in block.data]
    return {"figure": block.name, "caption": _text(block.caption), "shows": block.description, "data": files}


def _text(text: Text) -> list[Any]:
    return [_inline(piece) for piece in text]


def _inline(piece: Inline) -> Any:
    if isinstance(piece, str):
        return piece
    if isinstance(piece, Maths):
        return {"maths": plain(piece.node)}
    if isinstance(piece, Number):
        return {"number": piece.text, "value": piece.value, "place": piece.place}
    return {type(piece).__name__.lower(): piece.text}
