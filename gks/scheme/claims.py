"""[[claims]]: what a publication states, kept with the digits it prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from gks.scheme.document import Node
from gks.scheme.domains import read_formula
from gks.scheme.expression import Expr
from gks.scheme.formula import Context
from gks.scheme.model import Claim, Parameter
from gks.scheme.names import finite_number


def read_claims(node: Node, context: Context, parameters: Sequence[Parameter]) -> tuple[Claim, ...]:
    """The claims of the file; each states a bound on the CFL number, or what happens at given parameters."""
    return tuple(_claim(entry, context, parameters) for entry in node.array())


def _claim(node: Node, context: Context, parameters: Sequence[Parameter]) -> Claim:
    entries = node.table(("source", "bound", "stable", "modulus", "at"))
    if "source" not in entries:
        raise node.key_error("the claim has no source", 'expected source = "..."')
    stated = [key for key in ("bound", "stable", "modulus") if key in entries]
    if not stated:
        raise node.key_error("the claim states nothing", "expected bound, stable or modulus")
    if "bound" in stated and len(stated) > 1:
        raise entries["bound"].key_error(f"both bound and {stated[1]}", "a claim states one thing", "split it in two")
    if "bound" not in stated and "at" not in entries:
        raise entries[stated[0]].key_error(f"{stated[0]} without parameter values", "expected at = {...} beside it")
    at = _values(entries["at"], context, parameters) if "at" in entries else {}
    line, column = node.document.positions.line_column(node.document.positions.key_offset(node.path))
    return Claim(
        source=entries["source"].string(),
        bound=_bound(entries["bound"], context, parameters) if "bound" in entries else None,
        stable=entries["stable"].boolean() if "stable" in entries else None,
        modulus=_formula(entries["modulus"], context) if "modulus" in entries else None,
        at=at,
        texts={key: entries[key].formula() for key in ("bound", "modulus") if key in entries},
        line=line,
        column=column,
    )


def _values(node: Node, context: Context, parameters: Sequence[Parameter]) -> Mapping[str, Fraction]:
    entries = node.table([p.name for p in parameters])
    values = {name: finite_number(entry, context) for name, entry in entries.items()}
    for parameter in parameters:
        if parameter.role == "cfl" and values.get(parameter.name, 1) <= 0:
            raise entries[parameter.name].error(f"found {entries[parameter.name].kind}", "dt/dx is positive")
    return values


def _bound(node: Node, context: Context, parameters: Sequence[Parameter]) -> Expr:
    bound = _formula(node, context)
    cfl = next(p.name for p in parameters if p.role == "cfl")
    if cfl in bound.symbols:
        raise node.error(f"a bound on {cfl} that holds {cfl}", "a bound is a formula in the other parameters")
    return bound


def _formula(node: Node, context: Context) -> Expr:
    return read_formula(node, replace(context, extrema=True), "a claim")
