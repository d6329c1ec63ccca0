"""The pieces of a certificate, formulas and numbers, held against its cells and cuts. Part of the checker."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, cast

from flint import acb, arb, ctx

from gks.bounds.checkcells import CellCheck, Owner
from gks.bounds.checkcuts import CutCheck
from gks.bounds.checkformula import Rejected, read
from gks.bounds.checknumbers import BITS, Real, ball_of, complex_of, exact, positive, real_roots, univariate
from gks.bounds.checkring import polynomial

_ROOT = re.compile(r"(-?)root\((.*), (\d+)\)")

AGREE = 2.0**-200
"""Relative distance of a formula from the number it stands for: what rounding nested roots costs is far less."""
SHARPEST = 1 << 12
"""Precision in bits beyond which a formula that still cancels is rejected."""

SHARES = (Fraction(1, 3), Fraction(1, 2), Fraction(5, 7))
"""Places in a cell, besides its sample, at which formulas are evaluated."""

KEYS = {"from", "to", "from_value", "to_value", "bound", "at_bound", "at_bound_except", "stable_set", "closed_form"}


class _Balls:
    def integer(self, value: int) -> acb:
        return acb(value)

    def sqrt(self, value: acb) -> acb:
        return acb(value.real.sqrt())


def verify_pieces(pieces: Sequence[Mapping[str, Any]], owner: Owner) -> None:
    """Every piece covers whole cells, its edges are cuts, and what it states is what the cells state."""
    cell = 0
    edge: Real | Fraction | None = owner.domain[0]
    waiting: CutCheck | None = None
    for piece in pieces:
        _shape(piece)
        own = waiting is not None and waiting.spans is not None
        if own is not (piece["from"] == piece["to"]):
            raise Rejected("a cut with a stable set of its own is stated nowhere, or one without is stated")
        if waiting is not None and own:
            _single_cut(piece, waiting, owner)
            waiting = None
            continue
        _edge(piece, "from", edge, owner, "-oo")
        cell, waiting = _covered(piece, cell, owner)
        edge = owner.domain[1] if waiting is None else waiting.root
        _edge(piece, "to", edge, owner, "oo")
    if cell != len(owner.cells) or waiting is not None:
        raise Rejected("the pieces do not cover the domain")


def _single_cut(piece: Mapping[str, Any], cut: CutCheck, owner: Owner) -> None:
    _edge(piece, "from", cut.root, owner)
    _edge(piece, "to", cut.root, owner)
    assert cut.spans is not None
    verify_single(piece, cut.spans, owner.scheme.cfl)
    _bound(piece, cut.at_bound)


def _covered(piece: Mapping[str, Any], cell: int, owner: Owner) -> tuple[int, CutCheck | None]:
    """Holds a piece against its cells, from ``cell`` on; the first cell after it, and the cut it ends at."""
    start = cell
    while cell < len(owner.cells):
        _stated(piece, owner.cells[cell], owner)
        cell += 1
        if cell == len(owner.cells):
            _exceptions(piece, owner.cuts[max(start - 1, 0) :], owner)
            return cell, None
        cut = owner.cuts[cell - 1]
        if _is_edge(piece, cut.root, owner):
            _exceptions(piece, owner.cuts[max(start - 1, 0) : cell], owner)
            return cell, cut
        if cut.spans is not None:
            raise Rejected("a piece passes over a cut with a stable set of its own")
    raise Rejected("the pieces go beyond the cells")


def _exceptions(piece: Mapping[str, Any], cuts: Sequence[CutCheck], owner: Owner) -> None:
    """The exceptions on the bound are the cuts, in the piece and at its ends, that share its formulas and differ."""
    other = [c for c in cuts if c.spans is None and c.at_bound is not None and c.at_bound != piece["at_bound"]]
    stated = piece["at_bound_except"]
    if len(stated) != len(other):
        raise Rejected("the exceptions on the bound are not those of the cuts")
    for (text, verdict), cut in zip(stated, other, strict=True):
        if verdict != cut.at_bound or not _agree(_constant(text, str(owner.parameter)), cut.root.ball):
            raise Rejected(f"{text!r} is no exception on the bound that was verified")


def verify_single(piece: Mapping[str, Any], spans: Sequence[tuple[Real | None, Real | None]], lam: str) -> None:
    """A piece at one value: its ends are numbers."""
    _shape(piece)
    if piece["at_bound_except"] != []:
        raise Rejected("exceptions on the bound of a single value")
    stated = piece["stable_set"]
    if len(stated) != len(spans):
        raise Rejected("the number of stable intervals is not what was verified")
    for (low, high), (below, above) in zip(stated, spans, strict=True):
        _number(low, below, "0", lam)
        _number(high, above, "oo", lam)
    first = stated[0] if stated and stated[0][0] == "0" else None
    if piece["bound"] != (first[1] if first else "0"):
        raise Rejected("the bound is not the end of the first stable interval")


def _shape(piece: Mapping[str, Any]) -> None:
    if set(piece) != KEYS:
        raise Rejected("a piece has not the entries it should have")
    texts = [piece["bound"], *(end for span in piece["stable_set"] for end in span)]
    if piece["closed_form"] is not (not any("root(" in text for text in texts)):
        raise Rejected("a piece is not in the closed form it claims")


def _number(text: str, value: Real | None, otherwise: str, name: str) -> None:
    if value is None:
        if text != otherwise:
            raise Rejected(f"{text!r} should be {otherwise}")
        return
    if not _agree(_constant(text, name), value.ball):
        raise Rejected(f"{text!r} is not the number that was verified")


Number = Callable[[int], arb]
"""A ball around a number, at a precision in bits that is in force."""


def _constant(text: str, name: str) -> Number:
    """A number written as a formula, or as a root of a polynomial in ``name``."""
    match = _ROOT.fullmatch(text)
    if match is None:
        return lambda _: cast(acb, read(text, _Balls(), {})).real
    poly = univariate(polynomial(match[2], {name: "x"}), "x")
    sign, place = -1 if match[1] else 1, int(match[3]) - 1
    return lambda _: sign * [r for r in real_roots(poly) if r > 0][place]


def _agree(one: Number, other: Number) -> bool:
    """Whether two numbers are the same for all that is asked of them; a formula that cancels is computed anew."""
    bits = BITS
    while bits <= SHARPEST:
        with ctx.workprec(bits):
            mine, theirs = one(bits), other(bits)
            gap, most = abs(mine - theirs), AGREE * (abs(mine) + abs(theirs))
            if gap <= most or gap > most:
                return bool(gap <= most)
        bits *= 2
    return False


# Edges --------------------------------------------------------------------------------------------------------------


def _number_of(edge: Real | Fraction) -> Number:
    return edge.ball if isinstance(edge, Real) else lambda _: ball_of(edge)


def _is_edge(piece: Mapping[str, Any], root: Real, owner: Owner) -> bool:
    text = piece["to"]
    return text != "oo" and _agree(_constant(text, str(owner.parameter)), root.ball)


def _edge(piece: Mapping[str, Any], side: str, edge: Real | Fraction | None, owner: Owner, infinite: str = "") -> None:
    text, value = piece[side], piece[f"{side}_value"]
    if edge is None:
        if text != infinite or value != infinite:
            raise Rejected(f"a piece should reach to {infinite}")
        return
    if not _agree(_constant(text, str(owner.parameter)), _number_of(edge)) and not (text == "0" and edge == 0):
        raise Rejected(f"{text!r} is not the edge of its piece")
    if isinstance(value, bool) or not isinstance(value, float | str):
        raise Rejected(f"{value!r} is not the number that {text!r} is")
    true = exact(_number_of(edge)(BITS))
    if isinstance(value, float):
        if float(true) != value:
            raise Rejected(f"{value!r} is not the double nearest to {text!r}")
    elif abs(Fraction(value) - true) > abs(true) / 10**16:
        raise Rejected(f"{value!r} is not the number that {text!r} is")


# Formulas -----------------------------------------------------------------------------------------------------------


def _stated(piece: Mapping[str, Any], cell: CellCheck, owner: Owner) -> None:
    if len(piece["stable_set"]) != len(cell.spans):
        raise Rejected("a piece and its cell have different numbers of stable intervals")
    _bound(piece, cell.at_bound)
    for p in _places(cell, owner):
        for (low, high), (below, above) in zip(piece["stable_set"], cell.spans, strict=True):
            _formula(low, below, "0", p, owner)
            _formula(high, above, "oo", p, owner)
    first = piece["stable_set"][0] if piece["stable_set"] and piece["stable_set"][0][0] == "0" else None
    if piece["bound"] != (first[1] if first else "0"):
        raise Rejected("the bound is not the end of the first stable interval")


def _bound(piece: Mapping[str, Any], at_bound: str | None) -> None:
    if piece["at_bound"] != at_bound:
        raise Rejected("the verdict on the bound is not that of the cell")


def _places(cell: CellCheck, owner: Owner) -> list[Fraction]:
    low, high = cell.ends
    bottom = exact(low.ball()) if low else owner.domain[0]
    top = exact(high.ball()) if high else owner.domain[1]
    if bottom is None:
        bottom = (cell.sample if top is None else min(cell.sample, top)) - 7
    if top is None:
        top = max(cell.sample, bottom) + 7
    inside = [(bottom + (top - bottom) * share).limit_denominator(10**6) for share in SHARES]
    clear = [
        p
        for p in inside
        if bottom < p < top and (not low or ball_of(p) > low.ball()) and (not high or ball_of(p) < high.ball())
    ]
    return [cell.sample, *clear]


def _formula(text: str, branch: tuple[int, int] | None, otherwise: str, p: Fraction, owner: Owner) -> None:
    if branch is None:
        if text != otherwise:
            raise Rejected(f"{text!r} should be {otherwise}")
        return
    curve, place = owner.curves[branch[0]], branch[1]
    match = _ROOT.fullmatch(text)
    if match is not None:
        given = polynomial(match[2], {str(owner.parameter): "p", owner.scheme.cfl: "lam"})
        if given not in (curve, -curve) or match[1] or int(match[3]) != place:
            raise Rejected(f"{text!r} is not the curve that was verified")
        return

    def stated(_: int) -> arb:
        value: acb = read(text, _Balls(), {str(owner.parameter): complex_of(p)})
        return value.real

    if not _agree(stated, lambda _: positive(curve, p)[place - 1]):
        raise Rejected(f"{text!r} is not the bound at {owner.parameter} = {p}")
