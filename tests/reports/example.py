"""A scheme whose report has every section, small enough to be computed in seconds; and what takes a page apart."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from gks.reports.report import scheme_report
from gks.reports.steps import Step
from gks.scheme.schemefile import parse_scheme

TEXT = """
title  = "Coupling <b>&</b> \\"quotes\\", 100 % λ_x $1$"
source = "Banks & Sjögreen, eq. (3.6)"
notes  = "An example; its title holds what HTML, LaTeX and Markdown have to escape."

[parameters]
lam   = { role = "cfl", default = 0.9 }
alpha = { default = 4, range = [0, inf], doc = "rho_R/rho_L" }

[interior]
space = "upwind1"
time  = "forward-euler"

[domains.L]
side     = "left"
unknowns = ["u", "s"]
flux     = [["0", "-1"], ["-1", "0"]]

[domains.R]
side     = "right"
unknowns = ["u", "s"]
flux     = [["0", "-1/alpha"], ["-alpha", "0"]]

[closure]
let = { u_I = "L.u[0]", s_I = "R.s[0]" }
equations = ["L.u[1] = u_I", "L.s[1] = s_I", "R.u[-1] = u_I", "R.s[-1] = s_I"]

[[claims]]
source = "true"
bound  = "4/5"
at     = { alpha = 4 }

[[claims]]
source = "false"
stable = true
at     = { alpha = 4, lam = "9/10" }
"""

EXAMPLE = parse_scheme(TEXT, "example")


class Silent:
    """A watcher that remembers which steps were computed and which were kept."""

    def __init__(self) -> None:
        self.computed: list[str] = []
        self.kept: list[str] = []

    def started(self, step: Step) -> None:
        self.computed.append(step.name)

    def finished(self, step: Step, seconds: float, found: str) -> None:
        if found == "kept from an earlier run":
            self.kept.append(step.name)

    def tick(self) -> None:
        return


def written(folder: Path, *formats: str) -> tuple[dict[str, str], dict[str, Any]]:
    """The example's report in a folder: its pages by format, and its record."""
    pages = scheme_report(EXAMPLE, str(folder), Silent(), formats or ("html",))
    texts = {Path(page).suffix[1:]: Path(page).read_text(encoding="utf-8") for page in pages}
    return texts, json.loads((folder / "example.json").read_text(encoding="utf-8"))


class Page(HTMLParser):
    """The elements of a page with their attributes, and the text of those that are asked for."""

    VOID = frozenset({"meta", "link", "br", "img"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.texts: dict[int, str] = {}
        self.open: list[int] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {key: value or "" for key, value in attrs}))
        if tag not in self.VOID:
            self.open.append(len(self.elements) - 1)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {key: value or "" for key, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.elements[self.open[-1]][0] == tag, f"</{tag}> closes <{self.elements[self.open[-1]][0]}>"
        self.open.pop()

    def handle_data(self, data: str) -> None:
        for k in self.open:
            self.texts[k] = self.texts.get(k, "") + data

    def all(self, tag: str) -> list[tuple[dict[str, str], str]]:
        """(attributes, text) of every element of that name."""
        return [(attrs, self.texts.get(k, "")) for k, (name, attrs) in enumerate(self.elements) if name == tag]


def at(record: Any, pointer: str) -> Any:
    """The value that a JSON pointer names (RFC 6901)."""
    for key in pointer.split("/")[1:]:
        key = key.replace("~1", "/").replace("~0", "~")
        record = record[int(key)] if isinstance(record, list) else record[key]
    return record
