"""The leading term c p**e of a branch of a boundary curve, as the parameter tends to 0 or to infinity.

Along a branch lam ~ c p**e the terms of the curve with the largest size balance: e is the slope of an edge of the
Newton polygon of its exponents, c a positive root of the polynomial on that edge. The branch itself, exact at a
parameter far out, tells which edge and which root.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from flint import arb, ctx, fmpq, fmpz_mpoly, fmpz_poly

from gks.bounds.boundary import curve_at
from gks.bounds.closedform import number_form
from gks.bounds.criticality import ascending_roots
from gks.bounds.region import Cell
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.scheme.expression import Expr, mul, number, power, sqrt, symbol

FAR = 10**40
"""How far out the branch is compared with its leading term."""

NEAR = Fraction(1, 100)
"""Relative distance below which the branch at FAR is told to follow a term: the next term is off by a power of FAR."""


def leading_term(curve: fmpz_mpoly, k: int, cell: Cell, end: str, name: str) -> Expr | None:
    """c p**e for the k-th positive root over ``cell``, which reaches ``end`` ("0", "oo" or "-oo"); None without a
    formula.

    Exponents other than whole and half ones have no formula here. On negative p it is a term in -p.
    """
    p = _far(cell, end)
    if (cell.low is not None and not cell.low < Root.of(p)) or (cell.high is not None and not Root.of(p) < cell.high):
        return None
    lam = ascending_roots(curve_at(curve, p))[k - 1]
    sign = 1 if p > 0 else -1
    terms = {(int(i), int(j)): int(c) * sign**i for (i, j), c in curve.to_dict().items()}
    for exponent, poly in _edges(terms, end != "0"):
        for c in ascending_roots(poly):
            if _follows(lam, c, abs(p), exponent):
                return _term(c, exponent, name, sign)
    return None


def _far(cell: Cell, end: str) -> Fraction:
    if end == "0":
        return Fraction(1, FAR) if cell.sample > 0 else Fraction(-1, FAR)
    return Fraction(FAR) if end == "oo" else Fraction(-FAR)


def _edges(terms: Mapping[tuple[int, int], int], upper: bool) -> Iterator[tuple[Fraction, fmpz_poly]]:
    """Exponent e and polynomial in c of every edge: terms a p**i lam**j with i + e j extreme."""
    extreme: dict[int, int] = {}
    for i, j in terms:
        extreme[j] = max(i, extreme.get(j, i)) if upper else min(i, extreme.get(j, i))
    slopes = {Fraction(i - other, k - j) for j, i in extreme.items() for k, other in extreme.items() if k > j}
    for e in sorted(slopes):
        sizes = {j: i + e * j for j, i in extreme.items()}
        top = max(sizes.values()) if upper else min(sizes.values())
        on_edge = [j for j, size in sizes.items() if size == top]
        if len(on_edge) > 1:
            lowest = min(on_edge)
            poly = [0] * (max(on_edge) - lowest + 1)
            for j in on_edge:
                poly[j - lowest] = terms[extreme[j], j]
            yield e, fmpz_poly(poly)


def _follows(lam: Root, c: Root, p: Fraction, exponent: Fraction) -> bool:
    with ctx.workprec(START_BITS + GUARD_BITS):
        size = arb(fmpq(p.numerator, p.denominator)) ** arb(fmpq(exponent.numerator, exponent.denominator))
        ratio = lam.ball().real / (c.ball().real * size)
        return bool(abs(ratio - 1) < arb(fmpq(NEAR.numerator, NEAR.denominator)))


def _term(c: Root, exponent: Fraction, name: str, sign: int) -> Expr | None:
    """c (sign p)**e."""
    constant = number_form(c)
    if constant is None or exponent.denominator > 2:
        return None
    p = symbol(name)
    whole = exponent.numerator // exponent.denominator
    if sign**whole < 0:
        constant = -constant
    factors = [constant] if exponent.denominator == 1 else [constant, sqrt(p if sign > 0 else -p)]
    if constant.op == "num" and whole < 0:
        top, bottom = constant.value.numerator, constant.value.denominator
        below = mul([number(bottom), power(p, -whole)])
        return mul([number(top), *factors[1:]]) / below
    return mul([*factors, power(p, whole)])
