"""A proved stable region as data: pieces of the parameter axis, each with its bound as a formula and as a number.

Nothing here analyses: the pieces come from ``proof``, are plain text and integers, and print, become JSON or LaTeX, and
are evaluated over arrays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.modes.printing import latex_name
from gks.scheme.model import Scheme
from gks.scheme.numbers import fraction_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gks.bounds.curve import Curve

Number = float | str
"""As in JSON: a double, a decimal string beyond the doubles, "oo" or "-oo"."""

INFINITE = "oo"

WIDEST = 120
"""Characters of a stable set up to which the conditions beside it are aligned."""

COMMA = r",\; "

SHORT = 40
"""Characters of a bound that a statement repeats to say what happens on it."""


@dataclass(frozen=True, slots=True)
class Formula:
    """An end of a stable interval as a function of the parameter.

    ``closed`` False means ``root(polynomial, k)``, the k-th positive root in lam. ``curve`` holds the terms of the
    polynomial (exponents of the parameter and of lam) whose ``k``-th positive root it is on the whole piece, or on
    ``k``'s entry for each of the cells that the piece was merged from; empty for 0 and "oo".
    """

    text: str
    latex: str
    closed: bool
    curve: tuple[tuple[int, int, int], ...] = ()


@dataclass(frozen=True, slots=True)
class Cellwise:
    """Which positive root of ``Formula.curve`` the bound is, from ``start`` to ``end`` of the parameter."""

    start: float
    end: float
    k: int


GENERALIZED = "generalized"
"""That verdict, without loading the analysis for its name."""


@dataclass(frozen=True, slots=True)
class Edge:
    """An end of a piece; ``included`` where the piece's formulas hold there as well."""

    text: str
    latex: str
    value: Number
    included: bool


@dataclass(frozen=True, slots=True)
class Piece:
    """An interval of the parameter, or a single value where both edges are the same.

    ``at_bound`` is the verdict at lam = bound, decided at a sample of every cell; None for a bound of 0 or infinity.
    Stable and neutral hold all over a cell: a decaying kappa meets the circle on a curve only, and the curves' meetings
    are cuts. Generalized is a rank at the sample: where the amplitude of the kappa on the circle has isolated zeros,
    the scheme is neutral there, which the statement allows for.
    ``exceptions`` are the values of the parameter, between cells and at included ends, with another verdict there.
    ``start`` and ``end`` are None where there is no parameter.
    """

    start: Edge | None
    end: Edge | None
    bound: Formula
    at_bound: str | None
    stable_set: tuple[tuple[Formula, Formula], ...]
    cells: tuple[Cellwise, ...] = ()
    exceptions: tuple[tuple[Edge, str], ...] = ()

    @property
    def is_point(self) -> bool:
        return self.start is not None and self.end is not None and self.start.text == self.end.text

    @property
    def reserve(self) -> str:
        """What the statement allows for beside ``at_bound``."""
        everywhere = self.is_point or self.start is None or self.at_bound != GENERALIZED
        return "" if everywhere else " (at isolated values perhaps neutral)"

    @property
    def closed_form(self) -> bool:
        return self.bound.closed and all(end.closed for span in self.stable_set for end in span)

    def to_json(self) -> dict[str, object]:
        return {
            "from": None if self.start is None else self.start.text,
            "to": None if self.end is None else self.end.text,
            "from_value": None if self.start is None else self.start.value,
            "to_value": None if self.end is None else self.end.value,
            "bound": self.bound.text,
            "at_bound": self.at_bound,
            "at_bound_except": [[edge.text, verdict] for edge, verdict in self.exceptions],
            "stable_set": [[low.text, high.text] for low, high in self.stable_set],
            "closed_form": self.closed_form,
        }


@dataclass(frozen=True, slots=True)
class Theorem:
    """The stable region of a scheme over one parameter, or why it is not proved, with the certified curve instead.

    ``limits`` are pairs of an end of the parameter axis and what the bound tends to there, as text and as LaTeX.
    ``fixed`` are the values of the other parameters.
    """

    scheme: Scheme
    parameter: str | None
    pieces: tuple[Piece, ...]
    limits: tuple[tuple[str, str], ...]
    certificate: Mapping[str, object]
    reason: str | None
    curve: Curve | None
    time_s: float = field(compare=False)
    fixed: Mapping[str, Fraction] = field(default_factory=dict)

    @property
    def proved(self) -> bool:
        return self.reason is None

    @property
    def status(self) -> str:
        return "proved" if self.proved else "not-proved"

    @property
    def statement(self) -> str:
        if not self.proved:
            return f"Not proved: {self.reason}."
        lam = self.scheme.cfl
        at = ", ".join(f"{name} = {fraction_text(value)}" for name, value in self.fixed.items())
        lines = [f"{self.scheme.title}{f', {at}' if at else ''}: stable exactly for"]
        shown = _joined(self.pieces)
        name = self.parameter
        rows = [(_sets(piece, lam), _where(piece, name), _on_bound(piece, lam, name)) for piece in shown]
        width = max((len(row[0]) for row in rows if len(row[0]) <= WIDEST), default=0)
        for what, where, bound in rows:
            line = f"  {what:<{width}}  if {where}" if where else f"  {what}"
            lines.append(f"{line}; {bound}" if bound else line)
        lines += [f"  {text}" for text, _ in self.limits]
        return "\n".join(lines)

    @property
    def latex(self) -> str:
        if not self.proved:
            return rf"\text{{{self.statement}}}"
        lam = latex_name(self.scheme.cfl)
        rows = []
        for piece in _joined(self.pieces):
            told = [_where_latex(piece, self.parameter), _on_bound_latex(piece, self.parameter)]
            rows.append(rf"{_sets_latex(piece, lam)}, & {COMMA.join(filter(None, told))}")
        body = r"\begin{cases} " + r" \\ ".join(rows) + r" \end{cases}"
        tails = "".join(rf", \quad {latex}" for _, latex in self.limits)
        return rf"\text{{stable}} \iff {body}{tails}"

    def to_json(self) -> dict[str, object]:
        result: dict[str, object] = {
            "schema": "gks.theorem/1",
            "status": self.status,
            "statement": self.statement,
            "latex": self.latex,
            "parameter": self.parameter,
            "pieces": [piece.to_json() for piece in self.pieces],
            "certificate": dict(self.certificate),
            "time_s": self.time_s,
        }
        if not self.proved:
            result["reason"] = self.reason
            result["curve"] = None if self.curve is None else self.curve.to_json()
        return result

    def bound(self, values: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """lam_max at an array of parameter values, to 1e-15 relative; inf where unbounded, nan outside the pieces.

        ValueError where nothing is proved or there is no parameter.
        """
        import numpy as np

        if not self.proved or self.parameter is None:
            raise ValueError("there is no proved bound over a parameter to evaluate")
        points = np.asarray(values, dtype=float)
        flat = np.atleast_1d(points).ravel()
        result = np.full(flat.shape, np.nan)
        # Single values last: they take precedence over the intervals they stand between.
        for piece in sorted(self.pieces, key=lambda each: each.is_point):
            for cell in piece.cells:
                inside = flat == cell.start if piece.is_point else (flat >= cell.start) & (flat <= cell.end)
                if piece.is_point or inside.any():
                    result[inside] = _evaluated(piece, cell.k, flat[inside])
        return result.reshape(points.shape)

    def __str__(self) -> str:
        head = self.statement if self.proved else f"{self.scheme.title}\n  {self.statement}"
        if self.curve is not None:
            head += "\n" + str(self.curve)
        return f"{head}\n  ({self.status}, {self.time_s:.3g} s)"

    def _repr_latex_(self) -> str:
        return f"${self.latex}$"


def _evaluated(piece: Piece, k: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    import numpy as np

    if not piece.bound.curve:
        return np.full(points.shape, np.inf if piece.bound.text == INFINITE else 0.0)
    from gks.bounds.branch import branch_values

    return branch_values({(i, j): c for i, j, c in piece.bound.curve}, k, points)


# Words --------------------------------------------------------------------------------------------------------------


def _joined(pieces: Sequence[Piece]) -> list[Piece]:
    """The pieces as they are stated: neighbours with the same answer are one where the value between has it too."""
    shown: list[Piece] = []
    for piece in pieces:
        last = shown[-1] if shown else None
        if last is not None and last.end is not None and piece.start is not None and _same(last, piece):
            if last.is_point:
                shown[-1] = replace(piece, start=replace(piece.start, included=True))
                continue
            if piece.is_point:
                shown[-1] = replace(last, end=replace(last.end, included=True))
                continue
            if last.end.included:
                others = tuple(dict.fromkeys((*last.exceptions, *piece.exceptions)))
                shown[-1] = replace(last, end=piece.end, cells=(), exceptions=others)
                continue
        shown.append(piece)
    return shown


def _same(one: Piece, other: Piece) -> bool:
    """The same constant answer, word for word."""
    return (one.stable_set, one.at_bound) == (other.stable_set, other.at_bound)


def _sets(piece: Piece, lam: str) -> str:
    spans = [
        f"{low.text} < {lam}" if high.text == INFINITE else f"{low.text} < {lam} < {high.text}"
        for low, high in piece.stable_set
    ]
    return " or ".join(spans) if spans else f"no {lam}"


def _where(piece: Piece, name: str | None) -> str:
    if piece.start is None or piece.end is None or name is None:
        return ""
    if piece.is_point:
        return f"{name} = {piece.start.text}"
    low = "" if piece.start.text == "-oo" else f"{piece.start.text} {'<=' if piece.start.included else '<'} "
    high = "" if piece.end.text == INFINITE else f" {'<=' if piece.end.included else '<'} {piece.end.text}"
    return f"{low}{name}{high}"


def _on_bound(piece: Piece, lam: str, name: str | None) -> str:
    if piece.at_bound is None:
        return ""
    place = f"at {lam} = {piece.bound.text}" if len(piece.bound.text) <= SHORT else "on the bound"
    others = [
        f"{verdict} at {name} = {' and '.join(edge.text for edge in edges)}"
        for verdict, edges in _exceptions(piece).items()
    ]
    return f"{place}: {', '.join([piece.at_bound + piece.reserve, *others])}"


def _exceptions(piece: Piece) -> dict[str, list[Edge]]:
    """The exceptions of a piece by their verdict."""
    found: dict[str, list[Edge]] = {}
    for edge, verdict in piece.exceptions:
        found.setdefault(verdict, []).append(edge)
    return found


def _on_bound_latex(piece: Piece, name: str | None) -> str:
    if piece.at_bound is None:
        return ""
    others = []
    for verdict, edges in _exceptions(piece).items():
        places = r" \text{ and } ".join(edge.latex for edge in edges)
        others.append(rf"\text{{{verdict} at }} {latex_name(name or '')} = {places}")
    return COMMA.join([rf"\text{{on the bound {piece.at_bound}{piece.reserve}}}", *others])


def _sets_latex(piece: Piece, lam: str) -> str:
    spans = [
        f"{low.latex} < {lam}" if high.text == INFINITE else f"{low.latex} < {lam} < {high.latex}"
        for low, high in piece.stable_set
    ]
    return r" \text{ or } ".join(spans) if spans else r"\text{never}"


def _where_latex(piece: Piece, name: str | None) -> str:
    if piece.start is None or piece.end is None or name is None:
        return ""
    symbol = latex_name(name)
    if piece.is_point:
        return f"{symbol} = {piece.start.latex}"
    first, last = (r"\le" if edge.included else "<" for edge in (piece.start, piece.end))
    low = "" if piece.start.text == "-oo" else f"{piece.start.latex} {first} "
    high = "" if piece.end.text == INFINITE else f" {last} {piece.end.latex}"
    return f"{low}{symbol}{high}"
