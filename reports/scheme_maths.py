"""A scheme file back as mathematics: what was read, so that a slip in the file is seen at once.

Everything here is laid out from the scheme as the reader understood it (stencils, coefficients, ghost values), never
from the file's text.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from gks.modes.derivation import root_map
from gks.reports.document import Block, Code, Formula, Maths, Paragraph, Section, Table, Text
from gks.reports.formulas import (
    Node,
    NotAFormula,
    formula,
    indexed,
    joined,
    laid_out,
    matrix,
    name,
    number,
    operator,
    plain,
    relation,
    row,
)
from gks.scheme.expression import Expr
from gks.scheme.integrators import integrator
from gks.scheme.model import GridValue, HalfLine, LinearForm, NamedLines, NamedScheme, Parameter, Scheme, WrittenLines
from gks.scheme.operators import DISCRETE_SCHEMES, SPACE_OPERATORS

MOST_EQUATIONS = 40
"""Equations of a closure or an interior that a page lists; of more it says how many there are."""


def scheme_section(scheme: Scheme) -> Section:
    """The section that shows the scheme."""
    blocks: list[Block] = []
    if scheme.notes.strip():
        blocks.append(Paragraph((" ".join(scheme.notes.split()),)))
    alike = len({repr(half_line.interior) for half_line in scheme.domains}) == 1
    named = alike and isinstance(scheme.domains[0].interior, NamedLines | NamedScheme)
    for half_line in scheme.domains:
        blocks += _half_line(scheme, half_line)
        if not named:
            blocks += _interior(scheme, half_line)
    if named:
        blocks += _interior(scheme, scheme.domains[0])
    blocks += _closure(scheme)
    blocks.append(_parameters(scheme))
    return Section("scheme", "The scheme, as read from the file", tuple(blocks))


# Half-lines -----------------------------------------------------------------------------------------------------------


def _half_line(scheme: Scheme, half_line: HalfLine) -> list[Block]:
    cells = f"cells i = {half_line.first}, {half_line.first + 1}, {half_line.first + 2}, …"
    where = "x > 0"
    if half_line.side == "left":
        first = -half_line.first
        cells, where = f"cells i = {first}, {first - 1}, {first - 2}, …".replace("-", "−"), "x < 0"
    head = f"Half-line {half_line.name}, " if len(scheme.domains) > 1 else "Half-line "
    blocks: list[Block] = [Paragraph((f"{head}{where}: {cells} are advanced by the interior scheme.",))]
    if half_line.flux is not None:
        blocks.append(Formula(_system(half_line), f"The system on {where}"))
    return blocks


def _system(half_line: HalfLine) -> Node:
    assert half_line.flux is not None
    unknowns = [name(unknown) for unknown in half_line.unknowns]
    if len(unknowns) == 1:
        negative, factor = _signed(half_line.flux[0][0])
        slope = _derivative(unknowns[0], "x")
        term = slope if factor is None else row(factor, operator("\u2062"), slope)
        return relation(row(_derivative(unknowns[0], "t"), operator("−" if negative else "+"), term), "=", ZERO)
    vector = matrix([[unknown] for unknown in unknowns])
    flux = matrix([[_entry(entry) for entry in each] for each in half_line.flux])
    left = row(indexed(vector, name("t")), operator("+"), flux, indexed(vector, name("x")))
    return relation(left, "=", ZERO)


ZERO = number(0)


def _derivative(unknown: Node, variable: str) -> Node:
    return indexed(unknown, name(variable))


def _interior(scheme: Scheme, half_line: HalfLine) -> list[Block]:
    interior = half_line.interior
    if isinstance(interior, NamedLines):
        return [*_named_lines(interior, scheme.cfl)]
    if isinstance(interior, NamedScheme):
        return [*_named_scheme(interior, scheme.cfl)]
    equations = [_equation(form, scheme, inside=True) for form in interior.equations]
    blocks = _equations(equations, "Interior equation")
    if isinstance(interior, WrittenLines):
        blocks += _time(interior.time, scheme.cfl)
    return blocks


def _named_lines(interior: NamedLines, cfl: str) -> list[Block]:
    stencil = SPACE_OPERATORS[interior.space]
    slope = _weighted({offset: weight for offset, weight in stencil.derivative.items() if weight})
    left = row(number("Δ"), name("x"), _derivative(name("q"), "x"))
    if stencil.mass != {0: Fraction(1)}:
        mass = {offset: weight for offset, weight in stencil.mass.items() if weight}
        left = row(number("Δ"), name("x"), Node("fence", parts=(_weighted(mass, derivative=True),)))
    label = f"The space operator {interior.space}"
    what: Text = ("In space ", Code(interior.space), f" (order {stencil.order}; {stencil.source})")
    if stencil.upwinded:
        what = (*what, ", for the waves that run to the right; mirrored for those to the left:")
    else:
        what = (*what, ":")
    return [Paragraph(what), Formula(relation(left, "≈", slope), label), *_time(interior.time, cfl)]


def _named_scheme(interior: NamedScheme, cfl: str) -> list[Block]:
    scheme = DISCRETE_SCHEMES[interior.scheme]
    terms = []
    for offset, coefficients in scheme.coefficients.items():
        text = " + ".join(f"{c}*nu**{k}" if k else str(c) for k, c in enumerate(coefficients) if c)
        terms.append((_tidied(text), _value("q", offset, 0)))
    right = joined([row(_fenced(weight), operator("\u2062"), value) for weight, value in terms], "+")
    label = f"The scheme {interior.scheme}"
    side = ", for ν > 0; mirrored for ν < 0" if scheme.upwinded else ""
    what: Text = ("In space and time ", Code(interior.scheme), f" (order {scheme.order}; {scheme.source}), with ")
    speed = relation(name("nu"), "=", row(name(cfl), operator("\u2062"), name("a")))
    return [
        Paragraph((*what, Maths(speed), f" and a the speed of a field{side}:")),
        Formula(relation(_value("q", 0, 1), "=", right), label),
    ]


def _tidied(text: str) -> Node:
    text = text.replace("+ -", "- ").replace("nu**1", "nu")
    for times in ("1*", "-1*"):
        text = " ".join(w.replace("1*", "", 1) if w.startswith(times) else w for w in text.split(" "))
    return formula(text)


def _time(time: str, cfl: str) -> list[Block]:
    method = integrator(time)
    text, _ = root_map(method, cfl, "s", "s")
    order = f" (order {method.order}; {method.source})" if method.order is not None else " (no error in time)"
    how: Text = ("In time ", Code(time), order, ", which takes an eigenvalue s of the space operator to z by")
    return [Paragraph(how), Formula(formula(text), f"The integrator {time}")]


def _weighted(weights: Mapping[int, Fraction], *, derivative: bool = False) -> Node:
    parts: list[Node] = []
    for offset, weight in weights.items():
        size = abs(weight)
        value = _value("q", offset, None)
        if derivative:
            value = Node("power", parts=(value, operator("′")))
        term = value if size == 1 else row(formula(str(size)), operator("\u2062"), value)
        if weight < 0 or parts:
            parts.append(operator("−" if weight < 0 else "+"))
        parts.append(term)
    return row(*parts)


def _value(unknown: str, offset: int, level: int | None) -> Node:
    return indexed(name(unknown), _place("i", offset), None if level is None else _place("n", level))


def _place(letter: str, offset: int) -> Node:
    if not offset:
        return name(letter)
    return row(name(letter), operator("+" if offset > 0 else "−"), number(abs(offset)))


# Equations ------------------------------------------------------------------------------------------------------------


def _closure(scheme: Scheme) -> list[Block]:
    ghosts = [_grid(value, scheme, inside=False, level=False) for value in scheme.boundary_unknowns]
    count = len(ghosts)
    text: Text = (
        f"The closure: {count} equation{'s' * (count != 1)} for "
        + ("the value" if count == 1 else f"the {count} values")
        + " that the interior scheme reads, or the closure itself, and does not give: ",
    )
    for k, ghost in enumerate(ghosts[:MOST_EQUATIONS]):
        text = (*text, ", " if k else "", Maths(ghost))
    text = (*text, ", …" if count > MOST_EQUATIONS else ".")
    equations = [_equation(each.form, scheme, inside=False) for each in scheme.closure.equations]
    return [Paragraph(text), *_equations(equations, "Closure")]


def _equations(equations: Sequence[Node], label: str) -> list[Block]:
    shown = equations[:MOST_EQUATIONS]
    blocks: list[Block] = [Formula(each, f"{label} {k + 1}") for k, each in enumerate(shown)]
    if len(equations) > len(shown):
        blocks.append(Paragraph((f"and {len(equations) - len(shown)} more equations.",)))
    return blocks


def _equation(form: LinearForm, scheme: Scheme, *, inside: bool) -> Node:
    """The equation solved for what it gives, where that has a number in front, else set to 0."""
    lines = any(value.derivative for value, _ in form.terms)
    level = len({value.level for value, _ in form.terms}) > 1 or not (lines or all(d.lines for d in scheme.domains))
    terms = [(_grid(value, scheme, inside=inside, level=level), coefficient) for value, coefficient in form.terms]
    given = _given(form, scheme, inside=inside)
    if given is None:
        return relation(_sum(terms), "=", ZERO)
    factor = form.terms[given][1].value
    others = [(node, -1 * c if factor > 0 else c) for k, (node, c) in enumerate(terms) if k != given]
    left = terms[given][0] if abs(factor) == 1 else row(formula(str(abs(factor))), operator("\u2062"), terms[given][0])
    return relation(left, "=", _sum(others) if others else ZERO)


def _given(form: LinearForm, scheme: Scheme, *, inside: bool) -> int | None:
    """Which term the equation gives: the newest at the cell itself inside, the first boundary value in a closure."""
    newest = form.levels[1]
    sides = {half_line.name: half_line for half_line in scheme.domains}
    for k, (value, coefficient) in enumerate(form.terms):
        if coefficient.op != "num":
            continue
        new = value.derivative if form.holds_dt else value.level == newest
        if new and (not value.index if inside else sides[value.domain].is_boundary(value.index)):
            return k
    return None


def _sum(terms: Sequence[tuple[Node, Expr]]) -> Node:
    parts: list[Node] = []
    for value, coefficient in terms:
        negative, factor = _signed(coefficient)
        if parts or negative:
            parts.append(operator("−" if negative else "+"))
        parts.append(value if factor is None else row(factor, operator("\u2062"), value))
    return row(*parts)


def _signed(coefficient: Expr) -> tuple[bool, Node | None]:
    """(whether it is subtracted, the factor, None for 1)."""
    text = str(coefficient)
    if coefficient.op == "add":
        return False, _fenced(laid_out(text))
    negative = text.startswith("-")
    text = text.removeprefix("-")
    return negative, None if text == "1" else laid_out(text)


def _entry(expr: Expr) -> Node:
    return laid_out(str(expr))


def _fenced(node: Node) -> Node:
    return Node("fence", parts=(node,)) if any(part.kind == "operator" for part in node.parts) else node


def _grid(value: GridValue, scheme: Scheme, *, inside: bool, level: bool) -> Node:
    place = _place("i", value.index) if inside else _whole(value.index)
    if len(scheme.domains) > 1:
        place = row(name(value.domain), operator(","), place)
    node = indexed(name(value.unknown), place, _place("n", value.level) if level else None)
    if not value.derivative:
        return node
    return row(Node("fraction", parts=(number("d"), row(number("d"), name("t")))), node)


def _whole(index: int) -> Node:
    return number(index) if index >= 0 else row(operator("−"), number(-index))


# Parameters -----------------------------------------------------------------------------------------------------------


def _parameters(scheme: Scheme) -> Table:
    rows = tuple(
        (
            (Maths(name(p.name)), " (the CFL number)" if p.role == "cfl" else ""),
            ("–" if p.default is None else str(p.default).replace("-", "−"),),
            (_range(p),),
            (_formula_or_text(p.doc),),
        )
        for p in scheme.parameters
    )
    columns: tuple[Text, ...] = (("parameter",), ("default",), ("range",), ("meaning",))
    return Table(("Parameters.",), columns, rows)


def _range(parameter: Parameter) -> str:
    low = "−∞" if parameter.low is None else str(parameter.low)
    high = "∞" if parameter.high is None else str(parameter.high)
    return f"({low}, {high})".replace("-", "−")


def _formula_or_text(text: str) -> str | Maths:
    """A description such as `rho_R/rho_L` as the mathematics that it is."""
    if " " in text and "=" not in text and "/" not in text:
        return text
    try:
        tree = formula(text)
    except NotAFormula:
        return text
    return Maths(tree)


def stencil_text(scheme: Scheme) -> str:
    """The closure in one line, for the text equivalent of a picture of the grid."""
    return "; ".join(plain(_equation(e.form, scheme, inside=False)) for e in scheme.closure.equations)


