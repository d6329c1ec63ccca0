"""Scalar fields: sequences v_n with sum_j c_j(sigma) v[i + j] = 0 that a half-line's unknowns are made of.

An index n counts the grid points of the mirrored half-line from the lowest one that anything reads; the first cell that
the interior scheme gives stands ``ghosts`` points above it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flint import fmpz_mpoly

from gks.modes.coefficients import Coefficients, Ratio, common_denominator
from gks.modes.fibre import coefficients as powers_of
from gks.scheme.model import HalfLine

Stencil = dict[int, Ratio]
"""Offset on the mirrored half-line -> coefficient."""


@dataclass(frozen=True, slots=True)
class Field:
    """One scalar field of a half-line.

    ``vector`` has one entry an unknown: the unknowns are the sum of vector * v over the fields. ``stencil`` is the
    scalar scheme on the mirrored half-line; ``speed`` the eigenvalue of the flux where the file gives one.
    """

    domain: str
    vector: tuple[Ratio, ...]
    stencil: Mapping[int, Ratio]
    speed: Ratio | None

    def polynomial(self, coefficients: Coefficients, ghosts: int) -> fmpz_mpoly:
        """P(sigma, x) = x**ghosts * sum_j c_j x**j, denominators and common factors in sigma alone cleared."""
        one = coefficients.context.constant(1)
        clear = common_denominator(list(self.stencil.values()), one)
        x = coefficients.gens["x"]
        total = coefficients.context.constant(0)
        for offset, value in self.stencil.items():
            total += (value.num * (clear / value.den)) * x ** (offset + ghosts)
        return without_content(total)

    def share(self, component: int, n: int, ghosts: int) -> list[tuple[int, Ratio]]:
        """What this field contributes to an unknown at the n-th grid point: indices of v with their coefficients."""
        value = self.vector[component]
        return [] if value.is_zero() else [(n, value)]


def without_content(polynomial: fmpz_mpoly) -> fmpz_mpoly:
    """Divided by the greatest common factor that does not hold x (zero stays zero)."""
    content = polynomial.context().constant(0)
    for power in powers_of(polynomial, "x"):
        content = content.gcd(power)
    return polynomial if content.is_zero() else polynomial / content


def mirrored(half_line: HalfLine, index: int) -> int:
    """An index, or an offset, as the mirrored half-line counts it."""
    return index if half_line.side == "right" else -index
