"""Names that a scheme file gives to its parameters, shorthands, domains and unknowns, and the exact numbers in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from typing import Protocol

from gks.errors import IrrationalValue, ParameterError, SchemeError, TooLarge, quoted
from gks.scheme.document import Node
from gks.scheme.evaluation import value_work
from gks.scheme.formula import RESERVED, Context, parse_expression
from gks.scheme.tokens import NAME, FormulaError, character


class _Error(Protocol):
    def __call__(self, message: str, expected: str = "", mend: str = "") -> SchemeError: ...


def check_name(name: str, taken: Mapping[str, str], error: _Error) -> None:
    """Raise `error(found, expected, mend)` unless it is an identifier that stands for nothing yet.

    `taken` says of each name in use what it is: "a parameter".
    """
    if not NAME.fullmatch(name):
        wrong = [char for char in name if not (char.isascii() and (char.isalnum() or char == "_"))]
        found = f"{quoted(name)} is no name" + (f": it has {character(wrong[0])}" if wrong else "")
        raise error(found, "a name has letters a-z, A-Z, digits and _, and no digit first")
    if name in RESERVED:
        raise error(f"{quoted(name)} is a word of the formula language", mend="take another name")
    if name in taken:
        raise error(f"{quoted(name)} is {taken[name]} already", "a name stands for one thing", "rename one of them")


def exact_number(node: Node, context: Context) -> Fraction | float:
    """A number, exact or infinite, or a formula without names in quotes: 0.9, 3, inf, "31/9"."""
    if not isinstance(node.value, str):
        return node.number()
    try:
        formula = parse_expression(node.value, replace(context, names={}, place="a number in quotes"))
        context.work.spend(value_work(formula))
        return formula.at({})
    except TooLarge as error:
        raise node.error(str(error)) from None
    except FormulaError as fault:
        raise node.formula_error(fault) from None
    except IrrationalValue:
        raise node.error("an irrational number", "values are rational") from None
    except ParameterError as error:
        raise node.error(error.message) from None


def finite_number(node: Node, context: Context) -> Fraction:
    """`exact_number` where an infinite one will not do."""
    number = exact_number(node, context)
    if isinstance(number, float):
        raise node.error(f"found {node.kind}", "expected a finite number")
    return number
