"""`gks report`: plan the computations, carry them out or find them kept, build the report, write its files.

All files go into one folder and begin with one name: NAME.html, NAME.json, NAME-FIGURE.csv and what else the format
asks for. Each is written whole or not at all, the page last, so that a page never stands without its data.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from gks.errors import InputError, quoted
from gks.files import write_bytes, write_text
from gks.reports.crew import Record, Watcher, run
from gks.reports.document import Panel, Report
from gks.reports.steps import Step
from gks.reports.store import Store
from gks.scheme.model import Scheme

FORMATS = ("html", "md", "tex", "json")

Records = dict[str, dict[str, Any]]


def scheme_report(
    scheme: Scheme, folder: str, watcher: Watcher, formats: Sequence[str] = ("html",), *, fresh: bool = False,
    stem: str | None = None,
) -> list[str]:  # fmt: skip
    """Write the report of a scheme into the folder; the paths of its pages, one a format."""
    from gks.reports.scheme_page import build
    from gks.reports.scheme_plan import plan

    name = stem or stem_of(scheme)
    store = Store(ready(folder), fresh=fresh)
    records = computed(plan(scheme), store, watcher)
    return write(build(scheme, name, records), folder, formats, store, watcher)


def stem_of(scheme: Scheme) -> str:
    """The scheme's name as the beginning of file names and of identifiers on a page."""
    stem = re.sub(r"[^A-Za-z0-9._-]+", "-", scheme.name).strip(".-")[:80]
    return stem if stem[:1].isalpha() else f"scheme-{stem}".rstrip("-")


def ready(folder: str) -> str:
    """The folder, made if it is not there; InputError if it cannot be."""
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError as error:
        raise InputError(f"-o {quoted(folder)}: {error.strerror}", expected="expected a folder") from None
    return folder


def computed(steps: Iterable[Step], store: Store, watcher: Watcher, jobs: int | None = None) -> Records:
    """The record of every step, in the steps' order: kept from an earlier run, or computed and kept."""
    wanted = list(steps)
    found: dict[str, Record] = {}
    for step in wanted:
        kept = store.find(step)
        if kept is not None:
            found[step.name] = kept
            watcher.finished(step, 0.0, "kept from an earlier run")

    def done(step: Step, record: Record) -> None:
        found[step.name] = record
        if not record.get("over_limit"):  # another run may have more luck, or a longer limit
            store.keep(step, record)

    run([step for step in wanted if step.name not in found], jobs or os.cpu_count() or 1, watcher, done)
    described = {step.name: _described(step) for step in wanted}
    return {name: {**described[name], **found[name]} for name in sorted(described)}


def _described(step: Step) -> dict[str, Any]:
    scheme = None if step.source is None else step.source[1]
    return {"kind": step.kind, "arguments": dict(step.arguments), "scheme": scheme, "command": step.command}


def write(report: Report, folder: str, formats: Sequence[str], store: Store, watcher: Watcher) -> list[str]:
    """Write all files of a report; the paths of its pages."""
    from gks.reports.record import record_text

    for figure in report.figures():
        for ending, data in figure.data.items():
            write_text(os.path.join(folder, f"{figure.name}{ending}.csv"), data.to_csv())
    for name, content in report.attachments.items():
        write_text(os.path.join(folder, name), content)
    record = os.path.join(folder, f"{report.name}.json")
    write_text(record, record_text(report))
    pages = []
    for kind in formats:
        path = os.path.join(folder, f"{report.name}.{kind}")
        if kind == "html":
            write_text(path, _page(report, store, watcher))
        elif kind != "json":
            write_text(path, _renderer(kind, report, folder)(report))
        pages.append(path)
    return pages


def _page(report: Report, store: Store, watcher: Watcher) -> str:
    """The page, its pictures drawn by several processes or found as an earlier run drew them."""
    from gks.reports.inline_svg import drawing_step, inline_svg
    from gks.reports.page import drawings, html

    steps = [drawing_step(*drawing) for figure in report.figures() for drawing in drawings(figure)]
    drawn = computed(steps, store, watcher)

    def svg(panel: Panel, key: str, title: str, description: str) -> str:
        record = drawn[f"draw {key}"]
        if "refused" in record:  # only ever for the time it took: here it has as long as it needs
            return inline_svg(panel, key, title, description)
        text: str = record["result"]["svg"]
        return text

    return html(report, svg)


def _renderer(kind: str, report: Report, folder: str) -> Callable[[Report], str]:
    """What writes the page of that format, once the pictures that it refers to are there."""
    from gks.reports.inline_svg import pdf_file, svg_file

    picture = {"md": svg_file, "tex": pdf_file}[kind]
    for figure in report.figures():
        for name, panel in zip(figure.files(), figure.panels, strict=True):
            path = os.path.join(folder, f"{name}.{'svg' if kind == 'md' else 'pdf'}")
            write_bytes(path, picture(panel, panel.title or figure.name))
    if kind == "md":
        from gks.reports.markdown import markdown

        return markdown
    from gks.reports.tex import tex

    return tex


