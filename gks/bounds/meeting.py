"""Where boundary curves meet over an algebraic value of the parameter.

Over p0, a root of the irreducible g, two curves meet at the common roots of their specialisations. These are the
roots of a gcd over the number field Q[p]/(g), usually of degree 1 although the curves have high degree: so a meeting
point is known exactly without ever forming a norm of the curves themselves.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import lcm

from flint import fmpq_poly, fmpz_mpoly, fmpz_poly

from gks.bounds.boundary import PLANE, in_parameter
from gks.modes.algebraic import Root
from gks.modes.fibre import fibre

Element = fmpq_poly
"""An element of Q[p]/(g), reduced."""


def meeting_points(
    curves: Sequence[fmpz_mpoly], root: Root, pairs: Iterable[tuple[int, int]]
) -> dict[Root, dict[int, int]]:
    """The positive lam over ``root`` at which curves meet, with the multiplicity of each curve there.

    ``pairs`` name the curves whose resultant vanishes at ``root``; (i, i) stands for the discriminant of curve i.
    """
    field = _Field(root.minimal.poly)
    found: dict[Root, dict[int, int]] = {}
    for i, j in pairs:
        first = field.reduced(curves[i])
        second = field.derivative(first) if i == j else field.reduced(curves[j])
        common = field.gcd(first, second)
        for lam, multiplicity in _positive(field, common, root):
            known = found.setdefault(lam, {})
            for k in (i, j):
                known[k] = max(known.get(k, 1), multiplicity + 1 if i == j else 1)
    return found


def _positive(field: _Field, common: Sequence[Element], root: Root) -> list[tuple[Root, int]]:
    if len(common) < 2:
        return []
    each = fibre({"p": root}, field.cleared(common), "lam")
    return [(r.root.minimal, r.multiplicity) for r in each if r.root.is_real and r.root.ball().real > 0]


class _Field:
    """Polynomials in lam over Q[p]/(g), as lists of coefficients, the last one not zero."""

    def __init__(self, modulus: fmpz_poly) -> None:
        self.modulus = fmpq_poly(modulus)

    def reduced(self, curve: fmpz_mpoly) -> list[Element]:
        return self._trimmed([fmpq_poly(part) % self.modulus for part in in_parameter(curve)])

    def derivative(self, poly: Sequence[Element]) -> list[Element]:
        return self._trimmed([k * c for k, c in enumerate(poly)][1:])

    def gcd(self, a: list[Element], b: list[Element]) -> list[Element]:
        """The monic greatest common divisor."""
        while b:
            a, b = b, self._remainder(a, self._monic(b))
        return self._monic(a)

    def cleared(self, poly: Sequence[Element]) -> fmpz_mpoly:
        """With integer coefficients, in the plane."""
        clear = lcm(*(int(c.denom()) for c in poly))
        terms: dict[tuple[int, ...], int] = {}
        for k, c in enumerate(poly):
            for power, value in enumerate(list(c)):
                scaled = value * clear
                if scaled != 0:
                    terms[power, k] = int(scaled.p)
        return PLANE.from_dict(terms)

    def _monic(self, poly: Sequence[Element]) -> list[Element]:
        _, inverse, _ = poly[-1].xgcd(self.modulus)
        return [c * inverse % self.modulus for c in poly]

    def _remainder(self, a: Sequence[Element], monic: Sequence[Element]) -> list[Element]:
        rest = list(a)
        while len(rest) >= len(monic):
            lead, shift = rest.pop(), len(rest) + 1 - len(monic)
            for k, c in enumerate(monic[:-1]):
                rest[k + shift] = (rest[k + shift] - lead * c) % self.modulus
        return self._trimmed(rest)

    def _trimmed(self, poly: list[Element]) -> list[Element]:
        while poly and not poly[-1]:
            poly.pop()
        return poly
