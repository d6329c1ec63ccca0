"""``prove``: the exact stable region of a scheme over one parameter, as a theorem.

The work is done in a process of its own: FLINT cannot be interrupted from within, so only ending the process honours a
time limit, or Ctrl-C, at once. What is not proved says at which stage it stopped, and carries a certified curve instead.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from time import perf_counter

from flint import fmpz_mpoly

from gks.bounds.asymptotics import leading_term
from gks.bounds.boundary import PLANE
from gks.bounds.cells import Branch, Cell, Cut, Decomposition, End, NotProved, Span, decompose, value_of
from gks.bounds.cfl import stable_set
from gks.bounds.certificate import certificate, constant_certificate
from gks.bounds.closedform import closed_form, number_form
from gks.bounds.formulalatex import latex
from gks.bounds.theorem import INFINITE, Cellwise, Edge, Formula, Number, Piece, Theorem
from gks.errors import NotAnalysable
from gks.modes.algebraic import Root
from gks.modes.fibre import VanishesIdentically, embed
from gks.modes.numerals import exact_fraction, json_real
from gks.modes.printing import latex_name, polynomial_latex, polynomial_text
from gks.modes.undecided import Undecided
from gks.scheme.model import Parameter, Scheme

Report = Callable[[str], None]

ZERO, INFINITY = Formula("0", "0", True), Formula(INFINITE, r"\infty", True)

ROUNDING_BITS = 80


def prove_here(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Theorem:
    """``prove`` in this process, without a limit; the certified curve of what is not proved is left to the caller."""
    start = perf_counter()
    free = [p for p in scheme.parameters if p.ranged and p.role is None and p.name not in values]
    if len(free) > 1:
        names = ", ".join(p.name for p in free)
        return _open(scheme, None, f"{len(free)} parameters are free ({names}); a theorem has one, set the others", start)
    fixed = scheme.values(values, free=[p.name for p in free])
    name = free[0].name if free else None
    try:
        if name is None:
            return _constant(scheme, fixed, start)
        return _over_parameter(scheme, fixed, free[0], report, start)
    except (NotProved, Undecided) as reason:
        return _open(scheme, name, str(reason), start)
    except NotAnalysable as reason:
        return _open(scheme, name, reason.message, start)
    except VanishesIdentically:
        return _open(scheme, name, "a boundary polynomial vanishes identically", start)


def _open(scheme: Scheme, parameter: str | None, reason: str, start: float) -> Theorem:
    return Theorem(scheme, parameter, (), (), {}, reason, None, perf_counter() - start)


def _over_parameter(
    scheme: Scheme, fixed: Mapping[str, Fraction], parameter: Parameter, report: Report, start: float
) -> Theorem:
    low, high = domain_of(parameter)
    found = decompose(scheme, fixed, parameter.name, low, high, report)
    report("formulas")
    writer = _Writer(found, parameter.name, scheme.cfl)
    pieces = writer.pieces(low, high)
    limits = writer.limits(low, high)
    theorem = Theorem(scheme, parameter.name, pieces, limits, {}, None, None, 0.0)
    proof = certificate(theorem, found, fixed, low, high)
    return replace(theorem, certificate=proof, time_s=perf_counter() - start)


def domain_of(parameter: Parameter) -> tuple[Fraction | None, Fraction | None]:
    """The interval a theorem is about; None is infinite.

    The parameter's range; but a range with two positive finite ends is a window on a positive quantity, like that of a
    plot, and the theorem is then about the whole of (0, oo), in which it lies.
    """
    low, high = parameter.low, parameter.high
    if low is not None and high is not None and low > 0:
        return Fraction(0), None
    return low, high


# One point: no parameter ----------------------------------------------------------------------------------------------


def _constant(scheme: Scheme, fixed: Mapping[str, Fraction], start: float) -> Theorem:
    """The exact stable set in lam."""
    from gks.bounds.cells import verdict_at

    found = stable_set(scheme, fixed)
    if found.undecided is not None:
        raise NotProved(found.undecided)
    spans = tuple(
        (ZERO if i.low is None else _number(i.low, scheme.cfl), INFINITY if i.high is None else _number(i.high, scheme.cfl))
        for i in found.intervals
    )
    bound, at_bound = spans[0][1] if spans and spans[0][0] is ZERO else ZERO, None
    if bound not in (ZERO, INFINITY):
        top = found.lam_max
        assert top is not None
        at_bound = verdict_at(scheme, {**fixed, scheme.cfl: top}).value
    piece = Piece(None, None, bound, at_bound, spans)
    theorem = Theorem(scheme, None, (piece,), (), {}, None, None, 0.0)
    proof = constant_certificate(theorem, found, fixed)
    return replace(theorem, certificate=proof, time_s=perf_counter() - start)


def _number(value: Root, lam: str) -> Formula:
    """A positive algebraic number."""
    form = number_form(value)
    curve = embed(value.minimal.poly, PLANE, "lam")
    terms = _terms(curve)
    if form is not None:
        return Formula(str(form), latex(form), True, terms)
    k = 1 + _ascending(value)
    names = {"lam": lam}
    return Formula(
        f"root({polynomial_text(curve, names, 'lam')}, {k})", _root_latex(curve, names, k), False, terms
    )


def _ascending(value: Root) -> int:
    from gks.bounds.cells import ascending_roots

    return ascending_roots(value.minimal.poly).index(value.minimal)


def _root_latex(curve: fmpz_mpoly, names: Mapping[str, str], k: int) -> str:
    return rf"\operatorname{{root}}_{{{k}}}\left({polynomial_latex(curve, names, 'lam')}\right)"


def _terms(curve: fmpz_mpoly) -> tuple[tuple[int, int, int], ...]:
    return tuple((int(i), int(j), int(c)) for (i, j), c in curve.to_dict().items())


# Formulas over the cells ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Described:
    """A cell with its formulas."""

    cell: Cell
    spans: tuple[tuple[Formula, Formula], ...]

    @property
    def key(self) -> tuple[object, ...]:
        return tuple((low.text, high.text) for low, high in self.spans), self.cell.at_bound


class _Writer:
    def __init__(self, found: Decomposition, parameter: str, lam: str) -> None:
        self.found, self.parameter, self.lam = found, parameter, lam
        self.names = {"p": parameter, "lam": lam}

    def pieces(self, low: Fraction | None, high: Fraction | None) -> tuple[Piece, ...]:
        """Cells merged where the same formulas go on through a cut; a cut with an answer of its own is a piece."""
        described = [self._described(cell) for cell in self.found.cells]
        first = Edge("-oo", r"-\infty", "-oo", False) if low is None else self._edge(Root.of(low), False)
        last = Edge(INFINITE, r"\infty", INFINITE, False) if high is None else self._edge(Root.of(high), False)
        pieces: list[Piece] = []
        group = [described[0]]
        start = first
        for cut, following in zip(self.found.cuts, described[1:], strict=True):
            if cut.spans is None and following.key == group[0].key:
                group.append(following)
                continue
            edge = self._edge(cut.root, cut.spans is None)
            pieces.append(self._piece(group, start, edge))
            if cut.spans is not None:
                pieces.append(self._point(cut, edge))
            start, group = edge, [following]
        pieces.append(self._piece(group, start, last))
        return tuple(pieces)

    def _described(self, cell: Cell) -> _Described:
        spans = tuple((self._formula(s.low, cell, ZERO), self._formula(s.high, cell, INFINITY)) for s in cell.spans)
        return _Described(cell, spans)

    def _formula(self, end: End, cell: Cell, otherwise: Formula) -> Formula:
        if end is None:
            return otherwise
        assert isinstance(end, Branch)
        curve = self.found.boundary.curves[end.curve]
        form = closed_form(curve, cell.sample, value_of(self.found.boundary, end, cell.sample), self.parameter)
        terms = _terms(curve)
        if form is not None:
            return Formula(str(form), latex(form), True, terms)
        text = f"root({polynomial_text(curve, self.names, 'lam')}, {end.k})"
        return Formula(text, _root_latex(curve, self.names, end.k), False, terms)

    def _piece(self, group: Sequence[_Described], start: Edge, end: Edge) -> Piece:
        first = group[0]
        cells = []
        for each in group:
            spans = each.cell.spans
            top = spans[0].high if spans and spans[0].low is None else None
            edges = (_double(each.cell.low, float("-inf")), _double(each.cell.high, float("inf")))
            cells.append(Cellwise(*edges, top.k if isinstance(top, Branch) else 0))
        bound = first.spans[0][1] if first.spans and first.spans[0][0] == ZERO else ZERO
        at_bound = first.cell.at_bound
        return Piece(start, end, bound, at_bound.value if at_bound else None, first.spans, tuple(cells))

    def _point(self, cut: Cut, edge: Edge) -> Piece:
        assert cut.spans is not None
        spans = tuple((self._constant(s, low=True), self._constant(s, low=False)) for s in cut.spans)
        bound = spans[0][1] if spans and spans[0][0] == ZERO else ZERO
        k = 0
        if bound.curve:
            top = cut.spans[0].high
            assert isinstance(top, Root)
            k = 1 + _ascending(top)
        here = _double(cut.root, 0.0)
        edge = replace(edge, included=True)
        return Piece(edge, edge, bound, cut.at_bound.value if cut.at_bound else None, spans, (Cellwise(here, here, k),))

    def _constant(self, span: Span, *, low: bool) -> Formula:
        end = span.low if low else span.high
        assert not isinstance(end, Branch)
        return (ZERO if low else INFINITY) if end is None else _number(end, self.lam)

    def _edge(self, root: Root, included: bool) -> Edge:
        form = number_form(root)
        value = _json_number(root)
        if form is not None:
            return Edge(str(form), latex(form), value, included)
        names = {"lam": self.parameter}
        negative = root.ball().real < 0
        mine = root.minimal if not negative else _opposite(root).minimal
        curve = embed(mine.poly, PLANE, "lam")
        k = 1 + _ascending(mine)
        sign = "-" if negative else ""
        text = f"{sign}root({polynomial_text(curve, names, 'lam')}, {k})"
        return Edge(text, sign + _root_latex(curve, names, k), value, included)

    def limits(self, low: Fraction | None, high: Fraction | None) -> tuple[tuple[str, str], ...]:
        """What the bound tends to at an end of the axis that is 0 or infinite."""
        ends = [(self.found.cells[0], low, "0" if low == 0 else "-oo" if low is None else None)]
        ends.append((self.found.cells[-1], high, "0" if high == 0 else "oo" if high is None else None))
        found = []
        name, lam = latex_name(self.parameter), latex_name(self.lam)
        for cell, _, end in ends:
            top = cell.spans[0].high if cell.spans and cell.spans[0].low is None else None
            if end is None or not isinstance(top, Branch):
                continue
            term = leading_term(self.found.boundary.curves[top.curve], top.k, cell, end, self.parameter)
            if term is not None and self.parameter in term.symbols:
                arrow = end.replace("oo", r"\infty")
                text = f"the bound ~ {term} as {self.parameter} -> {end}"
                found.append((text, rf"{lam}_{{\max}} \sim {latex(term)} \; ({name} \to {arrow})"))
        return tuple(found)


def _opposite(root: Root) -> Root:
    from flint import fmpz_poly

    from gks.modes.algebraic import isolated_roots, primitive, reflected

    target = -exact_fraction(root.ball(ROUNDING_BITS).real)
    mirrored = primitive(fmpz_poly(reflected(root.minimal.poly)))
    candidates = [r for r in isolated_roots(mirrored, is_square_free=True) if r.is_real]
    return min(candidates, key=lambda r: abs(exact_fraction(r.ball(ROUNDING_BITS).real) - target))


def _json_number(root: Root) -> Number:
    exact = root.rational
    return json_real(exact_fraction(root.ball(ROUNDING_BITS).real) if exact is None else exact)


def _double(root: Root | None, otherwise: float) -> float:
    return otherwise if root is None else float(_json_number(root))
