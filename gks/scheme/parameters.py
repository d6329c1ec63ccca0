"""[parameters]: every symbol that a formula may use."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Literal

from gks.errors import counted, quoted
from gks.scheme.document import Node
from gks.scheme.formula import Context
from gks.scheme.limits import MAX_PARAMETERS
from gks.scheme.model import Parameter
from gks.scheme.names import check_name, exact_number, finite_number

_MEND = '{ role = "cfl" } marks the number whose stable bound is sought'


def read_parameters(tables: Mapping[str, Node], root: Node, context: Context) -> tuple[Parameter, ...]:
    """The parameters in file order, exactly one of them the CFL number."""
    if "parameters" not in tables:
        raise root.error("no [parameters]", 'expected a table [parameters] with lam = { role = "cfl" }')
    nodes = tables["parameters"].table()
    if len(nodes) > MAX_PARAMETERS:
        raise tables["parameters"].key_error(f"found {len(nodes)} parameters", f"the limit is {MAX_PARAMETERS}")
    for name, node in nodes.items():
        check_name(name, {}, node.key_error)
    parameters = tuple(_parameter(name, node, context) for name, node in nodes.items())
    cfl = [p.name for p in parameters if p.role == "cfl"]
    if not cfl:
        raise tables["parameters"].key_error("no parameter is the CFL number", "expected exactly one", _MEND)
    if len(cfl) > 1:
        raise nodes[cfl[1]].key_error(f"{cfl[0]} and {cfl[1]} are both CFL numbers", "expected exactly one", _MEND)
    return parameters


def _parameter(name: str, node: Node, context: Context) -> Parameter:
    if not isinstance(node.value, dict):  # a bare number is a default
        return Parameter(name, None, finite_number(node, context), Fraction(0), None, False, "")
    entries = node.table(("role", "default", "range", "doc"))
    role: Literal["cfl"] | None = None
    if "role" in entries:
        if entries["role"].string() != "cfl":
            raise entries["role"].error(f"found {entries['role'].kind}", 'the only role is "cfl"')
        role = "cfl"
    default = finite_number(entries["default"], context) if "default" in entries else None
    if role == "cfl" and default is not None and default <= 0:
        raise entries["default"].error(f"found {entries['default'].kind}", "dt/dx is positive")
    low, high = _range(entries["range"], context) if "range" in entries else (Fraction(0), None)
    doc = entries["doc"].string() if "doc" in entries else ""
    return Parameter(name, role, default, low, high, "range" in entries, doc)


def _range(node: Node, context: Context) -> tuple[Fraction | None, Fraction | None]:
    """[lo, hi] with lo < hi; None for an infinite end."""
    ends = node.array()
    if len(ends) != 2:
        raise node.error(f"found {counted(len(ends), 'end')}", "expected [lo, hi]")
    low, high = (exact_number(end, context) for end in ends)
    if not low < high:
        raise node.error(f"found {quoted(node.document.positions.raw(node.path))[1:-1]}", "expected lo < hi")
    return (None if isinstance(low, float) else low), (None if isinstance(high, float) else high)
