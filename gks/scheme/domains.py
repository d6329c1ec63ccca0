"""The half-lines of a scheme file: [domains.NAME], with what [interior] says for all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import cast

from gks.errors import TooLarge, counted, quoted
from gks.scheme.document import Node
from gks.scheme.evaluation import value_work
from gks.scheme.expression import Expr
from gks.scheme.formula import Context, parse_equation, parse_expression
from gks.scheme.gridvalue import Grid
from gks.scheme.integrators import INTEGRATORS
from gks.scheme.limits import MAX_OFFSET, MAX_UNKNOWNS, MULTIPLY_WORK
from gks.scheme.model import (
    HalfLine,
    Interior,
    LinearForm,
    NamedLines,
    NamedScheme,
    Side,
    WrittenDiscrete,
    WrittenLines,
)  # fmt: skip
from gks.scheme.names import check_name
from gks.scheme.operators import DISCRETE_SCHEMES, SPACE_OPERATORS
from gks.scheme.suggest import nearest
from gks.scheme.tokens import FormulaError

_KEYS = ("side", "unknowns", "flux", "first", "interior", "space", "time", "scheme")
_NAMED = {"space": tuple(SPACE_OPERATORS), "time": tuple(INTEGRATORS), "scheme": tuple(DISCRETE_SCHEMES)}
_WAYS = 'expected space and time, or scheme, in [interior] or here, or interior = ["..."] here'


def read_domains(tables: Mapping[str, Node], context: Context, taken: Mapping[str, str]) -> tuple[HalfLine, ...]:
    """One or two half-lines, from the tables of the file; `taken` says what other names stand for."""
    common = tables["interior"].table(("space", "time", "scheme")) if "interior" in tables else {}
    for node in common.values():
        _named(node)
    _refuse_both(common)
    if "domains" not in tables:
        raise _root(tables).error("no domains", "expected a table [domains.NAME] with side = and unknowns =")
    nodes = tables["domains"].table()
    if not 1 <= len(nodes) <= 2:
        found = f"found {counted(len(nodes), 'domain')}"
        raise tables["domains"].key_error(found, "expected one half-line, or one on each side")
    domains: list[HalfLine] = []
    for name, node in nodes.items():
        check_name(name, {}, node.key_error)
        domain = _half_line(name, node, common, context, taken)
        if domain.side in [other.side for other in domains]:
            raise node.table()["side"].error(f"both domains are on the {domain.side}", "two half-lines meet at x = 0")
        domains.append(domain)
    return tuple(domains)


def _root(tables: Mapping[str, Node]) -> Node:
    return next(iter(tables.values())).document.root


def _half_line(
    name: str, node: Node, common: Mapping[str, Node], context: Context, taken: Mapping[str, str]
) -> HalfLine:
    entries = node.table(_KEYS)
    for key in ("side", "unknowns"):
        if key not in entries:
            raise node.key_error(f"the domain has no {key}", f"expected {key} = ...")
    side = entries["side"].string()
    if side not in ("left", "right"):
        raise entries["side"].error(f"found {quoted(side)}", 'expected "left" (x < 0) or "right" (x > 0)')
    unknowns = _unknowns(entries["unknowns"], taken)
    first = entries["first"].integer() if "first" in entries else 0
    if abs(first) > MAX_OFFSET:
        raise entries["first"].error(f"found {entries['first'].kind}", f"the limit is {MAX_OFFSET}")
    flux = _flux(entries["flux"], len(unknowns), context) if "flux" in entries else None
    interior = _Interior(name, unknowns, node, entries, common, context).read()
    if flux is None and isinstance(interior, NamedLines | NamedScheme):
        operator = interior.space if isinstance(interior, NamedLines) else interior.scheme
        expected = f"{operator} discretises q_t + flux q_x = 0"
        raise node.key_error("the domain has no flux", expected, "add flux = [[...]]")
    if flux is not None and isinstance(interior, NamedLines | NamedScheme):
        try:
            context.work.spend(_reach_work(flux))
        except TooLarge:
            found = "the flux is too large to be split into its fields"
            raise entries["flux"].error(found, mend="write the scheme out, as interior = [...]") from None
    return HalfLine(name, cast(Side, side), unknowns, first, flux, interior)


def _unknowns(node: Node, taken: Mapping[str, str]) -> tuple[str, ...]:
    here: dict[str, str] = {}
    entries = node.array()
    if not 1 <= len(entries) <= MAX_UNKNOWNS:
        raise node.error(f"found {counted(len(entries), 'unknown')}", f"expected 1 to {MAX_UNKNOWNS}")
    for entry in entries:
        name = entry.string()
        check_name(name, {**taken, **here}, entry.error)
        here[name] = "an unknown"
    return tuple(here)


def _flux(node: Node, size: int, context: Context) -> tuple[tuple[Expr, ...], ...]:
    rows = node.array()
    if len(rows) != size:
        raise node.error(f"found {counted(len(rows), 'row')}", f"expected {size}, one for each unknown")
    flux: list[tuple[Expr, ...]] = []
    for row in rows:
        entries = row.array()
        if len(entries) != size:
            raise row.error(f"found {len(entries)} in a row", f"expected {size}, one for each unknown")
        flux.append(tuple(read_formula(entry, context, "the flux") for entry in entries))
    return tuple(flux)


def _reach_work(flux: tuple[tuple[Expr, ...], ...]) -> float:
    """About how long operators.reach takes, in nanoseconds: some n**4 operations a point, on integers n times as long
    as the entries, whose values have some 64 bits for each degree.

    Most fluxes are done after a point or two; 14 of the 33 points keep the slowest, of 7 unknowns, below two seconds.
    """
    size = len(flux)
    longest = size * max(entry.size.bits + 64 * entry.size.degree for row in flux for entry in row)
    values = sum(value_work(entry, 64) for row in flux for entry in row)
    return 14 * (values + size**4 * (18_000 + 2 * MULTIPLY_WORK * longest**2))


def read_formula(node: Node, context: Context, place: str) -> Expr:
    """A formula in the parameters, at its place in the file."""
    try:
        return parse_expression(node.formula(), replace(context, place=place))
    except FormulaError as fault:
        raise node.formula_error(fault) from None


def _named(node: Node) -> str:
    """The name of a space operator, integrator or scheme, by the key it stands under."""
    key = str(node.path[-1])
    known, name = _NAMED[key], node.string()
    if name not in known:
        expected = f"the named ones are {', '.join(known)}"
        raise node.error(f"there is no {key} {quoted(name)}", expected, nearest(name, known))
    return name


def _refuse_both(entries: Mapping[str, Node]) -> None:
    """scheme is fully discrete, space and time are the method of lines."""
    if "scheme" in entries and (other := entries.get("space") or entries.get("time")):
        raise other.key_error(
            f"both scheme and {other.path[-1]}",
            "a named scheme is fully discrete, space and time are the method of lines",
            "leave one out",
        )


@dataclass(frozen=True, slots=True)
class _Interior:
    """What is needed to read the interior scheme of one domain."""

    name: str
    unknowns: tuple[str, ...]
    node: Node
    entries: Mapping[str, Node]
    common: Mapping[str, Node]
    context: Context

    def read(self) -> Interior:
        own = {key: self.entries[key] for key in ("space", "time", "scheme") if key in self.entries}
        for node in own.values():
            _named(node)
        _refuse_both(own)
        if "interior" in self.entries:
            return self._written(own)
        inherited = {key: node for key, node in self.common.items() if not own or key != "scheme"}
        chosen = own if "scheme" in own else {**inherited, **own}
        if "scheme" in chosen:
            return NamedScheme(_named(chosen["scheme"]))
        for key in ("space", "time"):
            if key not in chosen:
                found = f"the domain has no {key}" if chosen else "the domain has no interior scheme"
                raise self.node.key_error(found, _WAYS)
        return NamedLines(_named(chosen["space"]), _named(chosen["time"]))

    def _written(self, own: Mapping[str, Node]) -> WrittenDiscrete | WrittenLines:
        """interior = [...]; method of lines if any equation holds dt(...)."""
        node = self.entries["interior"]
        for key in ("space", "scheme"):
            if key in own:
                expected = "the scheme is written out or named"
                raise own[key].key_error(f"both interior and {key}", expected, "leave one out")
        nodes = node.array()
        if len(nodes) != len(self.unknowns):
            expected = f"expected {len(self.unknowns)}, one for each of the unknowns {', '.join(self.unknowns)}"
            raise node.error(f"found {counted(len(nodes), 'equation')}", expected)
        grid = Grid({self.name: self.unknowns}, self.name)
        context = replace(self.context, grid=grid, place=f"the interior scheme of {self.name}")
        forms = [read_equation(entry, context) for entry in nodes]
        if any(form.holds_dt for form in forms):
            time = own.get("time") or self.common.get("time")
            if time is None:
                raise node.key_error("dt(...) and no time integrator", 'expected time = "..." here or in [interior]')
            return WrittenLines(tuple(map(one_level, forms, nodes)), _named(time))
        if "time" in own:
            raise own["time"].key_error("a time integrator and no dt(...)", "a scheme written out in full takes none")
        if len({value.level for form in forms for value, _ in form.terms}) == 1:
            raise node.error("all values are at one time level", "expected two levels or more, or dt(...)")
        return WrittenDiscrete(tuple(forms))


def read_equation(node: Node, context: Context) -> LinearForm:
    """An equation of the interior or the closure, at its place in the file."""
    try:
        return parse_equation(node.string(), context)
    except FormulaError as fault:
        raise node.formula_error(fault) from None


def one_level(form: LinearForm, node: Node) -> LinearForm:
    """A method-of-lines equation, whose one level is moved to n."""
    least, greatest = form.levels
    if least != greatest:
        raise node.error(
            "several time levels in a method-of-lines equation", "an equation with dt(...) is an ODE, at one time level"
        )
    return LinearForm(tuple((replace(value, level=0), coefficient) for value, coefficient in form.terms))
