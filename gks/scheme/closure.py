"""[closure]: its shorthands and equations, and whether they are as many as the boundary unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from gks.errors import InputError, SchemeError, counted
from gks.scheme.boundary import boundary_unknowns, without_equation
from gks.scheme.document import Node
from gks.scheme.domains import one_level, read_equation
from gks.scheme.formula import Context
from gks.scheme.gridvalue import Grid
from gks.scheme.integrators import INTEGRATORS
from gks.scheme.model import Closure, Equation, GridValue, HalfLine, LinearForm, Parameter
from gks.scheme.names import check_name
from gks.scheme.shorthands import resolved


def read_closure(
    tables: Mapping[str, Node], domains: Sequence[HalfLine], context: Context, taken: Mapping[str, str]
) -> tuple[Closure, list[Node]]:
    """The closure and the nodes of its equations; empty if the file has none."""
    entries = tables["closure"].table(("let", "equations")) if "closure" in tables else {}
    grid = Grid(
        {domain.name: domain.unknowns for domain in domains},
        without_dt=frozenset(domain.name for domain in domains if not domain.lines),
    )
    context = replace(context, grid=grid, place="the closure")
    if "let" in entries:
        shorthands = entries["let"].table()
        unknowns = {name: f"an unknown of {domain.name}" for domain in domains for name in domain.unknowns}
        for name, node in shorthands.items():
            check_name(name, {**taken, **unknowns}, node.key_error)
        context = replace(context, names={**context.names, **resolved(shorthands, context)})
    nodes = entries["equations"].array() if "equations" in entries else []
    return Closure(tuple(_equation(node, domains, context) for node in nodes)), nodes


def _equation(node: Node, domains: Sequence[HalfLine], context: Context) -> Equation:
    form = read_equation(node, context)
    if form.holds_dt:
        form = one_level(form, node)
    _check_levels(form, node, domains)
    return Equation(form, node.string(), *node.line_column)


def _check_levels(form: LinearForm, node: Node, domains: Sequence[HalfLine]) -> None:
    """Several time levels mean nothing between the stages of a one-step method, or without steps."""
    least, greatest = form.levels
    involved = {value.domain for value, _ in form.terms}
    for domain in domains:
        if least < greatest and domain.name in involved and domain.time is not None:
            if INTEGRATORS[domain.time].kind == "multistep":
                continue
            multistep = ", ".join(name for name, each in INTEGRATORS.items() if each.kind == "multistep")
            raise node.error(
                f"several time levels under {domain.time}", f"they go with a multistep integrator: {multistep}",
                "write the equation at one level, or as dt(...) = ...",
            )  # fmt: skip


def counted_unknowns(
    tables: Mapping[str, Node], domains: Sequence[HalfLine], parameters: Sequence[Parameter], closure: Closure,
    nodes: Sequence[Node],
) -> tuple[GridValue, ...]:  # fmt: skip
    """The boundary unknowns, if there are as many as equations."""
    try:
        unknowns = boundary_unknowns(domains, closure.equations, parameters)
    except InputError as error:
        if error.where is not None:
            raise
        raise _at_domain(error, tables) from None
    if len(closure.equations) != len(unknowns):
        raise _miscounted(tables, unknowns, closure.equations, nodes)
    return unknowns


def _at_domain(error: InputError, tables: Mapping[str, Node]) -> SchemeError:
    """The operators know the entry (domains.L.flux) but not where it stands."""
    path: tuple[str | int, ...] = tuple(error.path.split("."))
    document = tables["domains"].document
    offset = document.positions.value_offset(path)
    return document.error(offset, path, error.message, error.expected, error.mend)


def _miscounted(
    tables: Mapping[str, Node], unknowns: Sequence[GridValue], equations: Sequence[Equation], nodes: Sequence[Node]
) -> SchemeError:
    given = f"{counted(len(equations), 'equation')} {'was' if len(equations) == 1 else 'were'} given"
    found = f"the scheme reads {counted(len(unknowns), 'boundary value')} and {given}"
    if len(equations) > len(unknowns):
        return nodes[len(unknowns)].error(found, "expected one for each boundary value", "leave out an equation")
    left = without_equation(unknowns, equations)
    names = ", ".join(f'"{value}"' for value in left[:4]) + (", ..." if len(left) > 4 else "")
    mend = f"{names} has none: add an equation for it"
    if len(left) > 1:
        mend = f"{names} have none: add an equation for each"
    if nodes:
        return nodes[-1].error(found, mend)
    if "closure" not in tables:
        return next(iter(tables.values())).document.root.error(found, mend)
    entries = tables["closure"].table()
    if "equations" not in entries:
        return tables["closure"].key_error(found, mend)
    return entries["equations"].error(found, mend)
