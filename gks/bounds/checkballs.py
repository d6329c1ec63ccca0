"""Roots of polynomials and determinants of matrices with balls for entries. Part of the checker."""

from __future__ import annotations

from collections.abc import Sequence

from flint import acb, acb_poly


class Open(Exception):
    """Not decided at this precision."""


def solved(coefficients: Sequence[acb]) -> list[acb]:
    """Disjoint balls around the roots of a polynomial with ball coefficients; Open where they are not isolated."""
    if len(coefficients) < 2:
        return []
    if coefficients[-1].contains(0):
        raise Open
    whole = acb_poly(list(coefficients))
    try:
        return [_sharpened(whole, root) for root in whole.roots()]
    except ValueError:
        raise Open from None


def _sharpened(poly: acb_poly, root: acb) -> acb:
    """FLINT isolates roots and no more; interval Newton steps shrink the ball as long as they at least halve it."""
    slope = poly.derivative()
    while True:
        middle = acb(root.real.mid(), root.imag.mid())
        step = middle - poly(middle) / slope(root)
        if not step.is_finite() or not root.contains(step) or not step.rad() * 2 < root.rad():
            return root
        root = step


def deflated(parts: Sequence[acb]) -> tuple[list[acb], list[acb]]:
    """The simple roots, and the double ones: roots of the derivative at which the polynomial may vanish."""
    if len(parts) < 3 or parts[-1].contains(0):
        raise Open
    whole = acb_poly(list(parts))
    hits = [w for w in solved(list(whole.derivative())) if whole(w).contains(0)]
    if not hits or 2 * len(hits) >= len(parts):
        raise Open
    rest = list(parts)
    for root in (w for w in hits for _ in range(2)):
        quotient = [rest[-1]]
        for c in reversed(rest[1:-1]):
            quotient.append(c + root * quotient[-1])
        rest = quotient[::-1]
    return [_sharpened(whole, root) for root in solved(rest)], hits


def ball_determinant(matrix: Sequence[Sequence[acb]]) -> acb:
    """By elimination with the largest pivot; rows that may be zero make the result a ball around 0."""
    rows = [list(row) for row in matrix]
    total = acb(1)
    for k in range(len(rows)):
        places = [i for i in range(k, len(rows)) if not rows[i][k].contains(0)]
        if not places:
            return total * _expanded([row[k:] for row in rows[k:]])
        best = max(places, key=lambda i: float(abs(rows[i][k]).log().mid()))
        if best != k:
            rows[k], rows[best] = rows[best], rows[k]
            total = -total
        total *= rows[k][k]
        for i in range(k + 1, len(rows)):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k], strict=True)]
    return total


def _expanded(matrix: Sequence[Sequence[acb]]) -> acb:
    if not matrix:
        return acb(1)
    total = acb(0)
    for j, entry in enumerate(matrix[0]):
        total += (-1) ** j * entry * _expanded([[v for k, v in enumerate(row) if k != j] for row in matrix[1:]])
    return total
