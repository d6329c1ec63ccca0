"""TOML -> Scheme: the tables of a scheme file, read in the order in which they need each other.

    parameters -> definitions -> domains (flux, interior) -> closure -> boundary unknowns -> claims

Every fault is a SchemeError with file, line and column.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import PurePath

from gks.scheme.claims import read_claims
from gks.scheme.closure import counted_unknowns, read_closure
from gks.scheme.document import Document, Node, read_text
from gks.scheme.domains import read_domains
from gks.scheme.expression import symbol
from gks.scheme.forms import ZeroTest
from gks.scheme.formula import Context
from gks.scheme.limits import Work
from gks.scheme.model import Scheme
from gks.scheme.names import check_name
from gks.scheme.parameters import read_parameters
from gks.scheme.shorthands import resolved

_TABLES = ("title", "source", "notes", "parameters", "definitions", "interior", "domains", "closure", "claims")


def read_scheme(path: str | os.PathLike[str]) -> Scheme:
    """Read a scheme file. SchemeError if it can't be read or is at fault."""
    return parse_scheme(read_text(path), PurePath(path).stem, os.fspath(path))


def parse_scheme(text: str, name: str, path: str | None = None) -> Scheme:
    """Read the text of a scheme file; `name` is its short name. SchemeError if it is at fault."""
    document = Document(text, path if path is not None else name)
    tables = document.root.table(_TABLES)
    title = _title(document.root, tables)
    work = Work()
    parameters = read_parameters(tables, document.root, Context({}, ZeroTest({}, work), work))
    ranges = {p.name: (p.low, p.high) for p in parameters}
    taken = {p.name: "a parameter" for p in parameters}
    context = Context({p.name: symbol(p.name) for p in parameters}, ZeroTest(ranges, work), work)
    if "definitions" in tables:
        context, taken = _with_definitions(tables["definitions"], context, taken)
    domains = read_domains(tables, context, taken)
    closure, nodes = read_closure(tables, domains, context, taken)
    return Scheme(
        title=title,
        source=_text(tables, "source"),
        notes=_text(tables, "notes"),
        parameters=parameters,
        domains=domains,
        closure=closure,
        claims=read_claims(tables["claims"], context, parameters) if "claims" in tables else (),
        boundary_unknowns=counted_unknowns(tables, domains, parameters, closure, nodes),
        name=name,
        text=text,
        path=path,
    )


def _title(root: Node, tables: Mapping[str, Node]) -> str:
    if "title" not in tables:
        raise root.error("the file has no title", 'expected title = "..."')
    title = tables["title"].string()
    if not title.strip():
        raise tables["title"].error("the title is empty", 'expected title = "..."')
    return title


def _text(tables: Mapping[str, Node], key: str) -> str:
    return tables[key].string() if key in tables else ""


def _with_definitions(node: Node, context: Context, taken: Mapping[str, str]) -> tuple[Context, dict[str, str]]:
    """The context with what [definitions] adds to it."""
    shorthands = node.table()
    for name, entry in shorthands.items():
        check_name(name, taken, entry.key_error)
    names = {**context.names, **resolved(shorthands, replace(context, place="a definition"))}
    taken = {**taken, **dict.fromkeys(shorthands, "a definition")}
    return replace(context, names=names), taken
