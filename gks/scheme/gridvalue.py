"""Grid values in formulas: u[i-1, n+1] in an interior scheme, R.u[-1, n+1] in a closure."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from gks.errors import quoted
from gks.scheme.limits import MAX_OFFSET
from gks.scheme.model import GridValue
from gks.scheme.suggest import nearest
from gks.scheme.tokens import Cursor, FormulaError, Token, listed


@dataclass(frozen=True, slots=True)
class Grid:
    """Which grid values an equation may hold.

    unknowns    of each domain
    interior    the domain whose interior scheme it is; None for a closure
    without_dt  the domains that are no method of lines
    """

    unknowns: Mapping[str, tuple[str, ...]]
    interior: str | None = None
    without_dt: frozenset[str] = frozenset()


def read_grid_value(cursor: Cursor, grid: Grid) -> GridValue:
    """domain.unknown[index, level], or unknown[index, level] where there is one domain."""
    first = cursor.expect("name", "")
    domain, unknown = _unknown(cursor, first, grid)
    cursor.expect("[", "after an unknown")
    index = _offset(cursor, "i" if grid.interior is not None else None)
    level = _offset(cursor, "n") if cursor.take(",") else 0
    cursor.expect("]", "inside the brackets of a grid value")
    return GridValue(domain, unknown, index, level)


def _unknown(cursor: Cursor, first: Token, grid: Grid) -> tuple[str, str]:
    """The domain and unknown that `first`, or `first` "." name, stands for."""
    if cursor.take("."):
        token = cursor.expect("name", "after the domain")
        if first.text not in grid.unknowns:
            expected = f"the domains are {listed(grid.unknowns)}"
            if grid.interior is not None:
                expected = f"the interior scheme of {grid.interior} reads its own unknowns only"
            raise FormulaError(
                first.offset, f"no domain {quoted(first.text)} here", expected, nearest(first.text, grid.unknowns)
            )
        domain = first.text
    else:
        token, domain = first, next(iter(grid.unknowns))
        if len(grid.unknowns) > 1 and any(token.text in unknowns for unknowns in grid.unknowns.values()):
            mend = " or ".join(f"{name}.{token.text}[...]" for name, us in grid.unknowns.items() if token.text in us)
            raise FormulaError(token.offset, f"{quoted(token.text)} without its domain", mend=f"write {mend}")
    if token.text in grid.unknowns[domain]:
        return domain, token.text
    known = grid.unknowns[domain]
    expected = f"the unknowns of {domain} are {listed(known)}"
    if token is first and len(grid.unknowns) > 1:
        known = tuple(f"{name}.{unknown}" for name, us in grid.unknowns.items() for unknown in us)
        expected = f"the unknowns are {listed(known)}"
    raise FormulaError(token.offset, f"{quoted(token.text)} is not an unknown", expected, nearest(token.text, known))


def _offset(cursor: Cursor, base: str | None) -> int:
    """A sum of integers with `base` once in it (None: without), as the integer; within the limit."""
    start = cursor.token
    offset, bases = 0, 0
    sign = cursor.take("+", "-")
    while True:
        minus = sign is not None and sign.kind == "-"
        if literal := cursor.take("number"):
            offset += _integer(literal) * (-1 if minus else 1)
        elif base is not None and cursor.token.text == base and not minus:
            cursor.place += 1
            bases += 1
        else:
            _no_offset(cursor, base)
        sign = cursor.take("+", "-")
        if sign is None:
            break
    if cursor.token.kind not in (",", "]"):
        _no_offset(cursor, base)
    if base is not None and bases != 1:
        found = f"found {'more than one' if bases else 'no'} {quoted(base)}"
        raise FormulaError(start.offset, found, _shape(base))
    if abs(offset) > MAX_OFFSET:
        raise FormulaError(start.offset, f"an offset of {offset}", f"the limit is {MAX_OFFSET}")
    return offset


def _integer(literal: Token) -> int:
    if not literal.text.isdigit():
        raise FormulaError(literal.offset, f"{quoted(literal.text)} in an index", "indices are integers")
    digits = literal.text.lstrip("0")
    if len(digits) > 4:
        raise FormulaError(literal.offset, f"an offset of {len(digits)} digits", f"the limit is {MAX_OFFSET}")
    return int(digits or "0")


def _no_offset(cursor: Cursor, base: str | None) -> None:
    raise FormulaError(cursor.token.offset, f"found {cursor.found()} in an index", _shape(base))


def _shape(base: str | None) -> str:
    """What an index or level looks like."""
    if base is None:
        return "an index in a closure is an integer, as in u[-1] or u[-1, n+1]"
    if base == "i":
        return "an index in an interior equation is i and an integer, as in u[i], u[i-1] or u[i-1, n+1]"
    return "a level is n and an integer, as in u[0, n+1]"
