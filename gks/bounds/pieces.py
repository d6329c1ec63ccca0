"""From cells to the pieces of a theorem: ends as formulas, neighbours joined, what happens at the ends of the axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import fmpz_mpoly

from gks.bounds.asymptotics import leading_term
from gks.bounds.boundary import PLANE
from gks.bounds.cfl import StableSet
from gks.bounds.closedform import closed_form, number_form
from gks.bounds.criticality import ascending_roots
from gks.bounds.formulalatex import latex
from gks.bounds.region import Branch, Cell, Cut, Decomposition, End, Span, value_of
from gks.bounds.theorem import INFINITE, Cellwise, Edge, Formula, Number, Piece
from gks.modes.algebraic import Root, isolated_roots, primitive, reflected
from gks.modes.fibre import embed
from gks.modes.numerals import exact_fraction, json_real
from gks.modes.printing import latex_name, polynomial_latex, polynomial_text
from gks.modes.verdict import Verdict

ZERO, INFINITY = Formula("0", "0", True), Formula(INFINITE, r"\infty", True)

ROUNDING_BITS = 80
"""Bits of an enclosure that is then rounded to a double."""


def constant_piece(found: StableSet, at_bound: Verdict | None, lam: str) -> Piece:
    """The one piece of a theorem without a parameter."""
    spans = tuple(
        (ZERO if i.low is None else _number(i.low, lam), INFINITY if i.high is None else _number(i.high, lam))
        for i in found.intervals
    )
    return Piece(None, None, _bound(spans), None if at_bound is None else at_bound.value, spans)


def pieces(
    found: Decomposition, parameter: str, lam: str, low: Fraction | None, high: Fraction | None
) -> tuple[Piece, ...]:
    """The pieces over the domain (low, high), ascending."""
    return _Writer(found, parameter, lam).pieces(low, high)


def limits(
    found: Decomposition, parameter: str, lam: str, low: Fraction | None, high: Fraction | None
) -> tuple[tuple[str, str], ...]:
    """How the bound tends to the ends of the axis, as text and as LaTeX."""
    return _Writer(found, parameter, lam).limits(low, high)


def _bound(spans: Sequence[tuple[Formula, Formula]]) -> Formula:
    return spans[0][1] if spans and spans[0][0] == ZERO else ZERO


def _number(value: Root, lam: str) -> Formula:
    """A positive algebraic number."""
    form = number_form(value)
    curve = embed(value.minimal.poly, PLANE, "lam")
    terms = _terms(curve)
    if form is not None:
        return Formula(str(form), latex(form), True, terms)
    k = 1 + _ascending(value)
    names = {"lam": lam}
    return Formula(f"root({polynomial_text(curve, names, 'lam')}, {k})", _root_latex(curve, names, k), False, terms)


def _ascending(value: Root) -> int:
    return ascending_roots(value.minimal.poly).index(value.minimal)


def _root_latex(curve: fmpz_mpoly, names: Mapping[str, str], k: int) -> str:
    return rf"\operatorname{{root}}_{{{k}}}\left({polynomial_latex(curve, names, 'lam')}\right)"


def _terms(curve: fmpz_mpoly) -> tuple[tuple[int, int, int], ...]:
    return tuple((int(i), int(j), int(c)) for (i, j), c in curve.to_dict().items())


# Formulas over the cells --------------------------------------------------------------------------------------------


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
        group, shared = [described[0]], list[Cut]()
        start = first
        for cut, following in zip(self.found.cuts, described[1:], strict=True):
            own = cut.spans is not None
            shared += [] if own else [cut]
            if not own and following.key == group[0].key:
                group.append(following)
                continue
            edge = self._edge(cut.root, not own)
            pieces.append(self._piece(group, start, edge, shared))
            if own:
                pieces.append(self._point(cut, edge))
            start, group, shared = edge, [following], [] if own else [cut]
        pieces.append(self._piece(group, start, last, shared))
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

    def _piece(self, group: Sequence[_Described], start: Edge, end: Edge, shared: Sequence[Cut]) -> Piece:
        """``shared``: the cuts in it and at its ends where its formulas hold."""
        first = group[0]
        cells = []
        for each in group:
            spans = each.cell.spans
            top = spans[0].high if spans and spans[0].low is None else None
            edges = (_double(each.cell.low, float("-inf")), _double(each.cell.high, float("inf")))
            cells.append(Cellwise(*edges, top.k if isinstance(top, Branch) else 0))
        bound = _bound(first.spans)
        at_bound = first.cell.at_bound
        other = tuple(
            (self._edge(cut.root, True), cut.at_bound.value)
            for cut in shared
            if cut.at_bound is not None and cut.at_bound is not at_bound
        )
        return Piece(start, end, bound, None if at_bound is None else at_bound.value, first.spans, tuple(cells), other)

    def _point(self, cut: Cut, edge: Edge) -> Piece:
        assert cut.spans is not None
        spans = tuple((self._constant(s, low=True), self._constant(s, low=False)) for s in cut.spans)
        bound = _bound(spans)
        k = 0
        if bound.curve:
            top = cut.spans[0].high
            assert isinstance(top, Root)
            k = 1 + _ascending(top)
        here = _double(cut.root, 0.0)
        edge = replace(edge, included=True)
        return Piece(
            edge, edge, bound, None if cut.at_bound is None else cut.at_bound.value, spans, (Cellwise(here, here, k),)
        )

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
        """What the bound tends to at an end of the domain that is 0 or infinite."""
        left = "0" if low == 0 else "-oo" if low is None else None
        right = "0" if high == 0 else "oo" if high is None else None
        name, lam = latex_name(self.parameter), latex_name(self.lam)
        found = []
        for cell, end in ((self.found.cells[0], left), (self.found.cells[-1], right)):
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
    target = -exact_fraction(root.ball(ROUNDING_BITS).real)
    candidates = [r for r in isolated_roots(primitive(reflected(root.minimal.poly)), is_square_free=True) if r.is_real]
    return min(candidates, key=lambda r: abs(exact_fraction(r.ball(ROUNDING_BITS).real) - target))


def _json_number(root: Root) -> Number:
    exact = root.rational
    return json_real(exact_fraction(root.ball(ROUNDING_BITS).real) if exact is None else exact)


def _double(root: Root | None, otherwise: float) -> float:
    return otherwise if root is None else float(_json_number(root))
