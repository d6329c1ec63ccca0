"""Shorthands that may use each other in any order: [definitions] and the `let` of a closure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from gks.errors import SchemeError
from gks.scheme.document import Node
from gks.scheme.forms import Value
from gks.scheme.formula import Context, names_in, parse_value
from gks.scheme.tokens import FormulaError


def resolved(shorthands: Mapping[str, Node], context: Context) -> dict[str, Value]:
    """What each shorthand stands for, given the names of the context. SchemeError for a fault or a circle."""
    uses = {name: _uses(node, shorthands, context) for name, node in shorthands.items()}
    names = dict(context.names)
    growing = replace(context, names=names)  # sees each shorthand as soon as it is read
    for name in _in_order(uses, shorthands):
        try:
            names[name] = parse_value(shorthands[name].formula(), growing)
        except FormulaError as fault:
            raise shorthands[name].formula_error(fault) from None
    return {name: names[name] for name in shorthands}


def _uses(node: Node, shorthands: Mapping[str, Node], context: Context) -> dict[str, int]:
    """The shorthands that a formula uses, and where it does first."""
    try:
        uses: dict[str, int] = {}
        for token in names_in(node.formula(), context.work):
            if token.text in shorthands:
                uses.setdefault(token.text, token.offset)
        return uses
    except FormulaError as fault:
        raise node.formula_error(fault) from None


def _in_order(uses: Mapping[str, Mapping[str, int]], shorthands: Mapping[str, Node]) -> list[str]:
    """The names so that each comes after those it uses: depth first, with a stack of our own."""
    order: dict[str, None] = {}
    for start in uses:
        trail: dict[str, list[str]] = {}  # the names being visited, in order, with what is left to visit below each
        pending = [start] if start not in order else []
        while pending:
            name = pending[-1]
            if name not in trail:
                trail[name] = [used for used in uses[name] if used not in order]
            if trail[name]:
                used = trail[name].pop()
                if used in trail:
                    raise _circle(used, list(trail), uses, shorthands)
                if used not in order:
                    pending.append(used)
            else:
                order[name] = None
                del trail[name]
                pending.pop()
    return list(order)


def _circle(
    used: str, trail: list[str], uses: Mapping[str, Mapping[str, int]], shorthands: Mapping[str, Node]
) -> SchemeError:
    """The error for a circle that closes where the last of the trail uses `used`."""
    circle = [*trail[trail.index(used) :], used]
    shown = circle if len(circle) <= 8 else [*circle[:4], "...", *circle[-3:]]
    fault = FormulaError(uses[trail[-1]][used], f"the shorthands go in a circle: {' -> '.join(shown)}")
    return shorthands[trail[-1]].formula_error(fault)
