"""Simplified inverse Lax-Wendroff closures for u_t + u_x = 0 entering at x = 0, data 0.

Cells at x_i = (i + sigma) dx. A ghost value is the Taylor polynomial at the boundary: its first ``known`` terms come
from the boundary data and the equation (0 here), the others from the polynomial of degree ``order - 1`` through the
first ``order`` cells (Li, Shu & Zhang, J. Comput. Appl. Math. 299 (2016), for upwind-biased interiors; Boutin, Le
Barbenchon & Seguin on totally upwind schemes, for Beam-Warming).
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import numpy as np

from gks.scheme.model import Scheme
from tests.literature.closures import half_line

BEAM_WARMING = "u[i, n+1] = u[i] - lam/2*(3*u[i] - 4*u[i-1] + u[i-2]) + lam**2/2*(u[i] - 2*u[i-1] + u[i-2])"


def lagrange(node: int, order: int, sigma: Fraction) -> list[Fraction]:
    """Ascending coefficients in x/dx of the polynomial that is 1 at x_node and 0 at the other first ``order`` cells."""
    powers = [Fraction(1)]
    for other in range(order):
        if other == node:
            continue
        root, scale = other + sigma, Fraction(1, node - other)
        shifted = [Fraction(0), *powers]
        powers = [scale * (a - root * b) for a, b in zip(shifted, [*powers, Fraction(0)], strict=True)]
    return powers


@cache
def ghost_weights(ghost: int, order: int, known: int, sigma: Fraction) -> list[Fraction]:
    """u[ghost] = sum_k weights[k] u[k], ghost = -1, -2."""
    x = ghost + sigma
    return [
        sum((c * x**power for power, c in enumerate(lagrange(k, order, sigma)) if power >= known), Fraction(0))
        for k in range(order)
    ]


def beam_warming(order: int, known: int, sigma: Fraction) -> Scheme:
    equations = []
    for ghost in (-1, -2):
        weights = ghost_weights(ghost, order, known, sigma)
        equations.append(f"u[{ghost}] = " + " + ".join(f"({w})*u[{k}]" for k, w in enumerate(weights)))
    return half_line(BEAM_WARMING, *equations, first=0)


def growth(order: int, known: int, sigma: Fraction, lam: float) -> float:
    """max abs(z) over the normal modes, with numpy alone.

    Both spatial roots decay, so any two ghost values start a solution: v_i = (b v_(i-1) + c v_(i-2))/(z - a). With
    w = v_i (z - a)**(i+1) everything is a polynomial in y = z - a, and the closure's 2x2 determinant has the modes as
    its roots (the powers of y that were multiplied in lie at z = a, inside for 0 < lam < 2).
    """
    a, b, c = (1 - lam) * (2 - lam) / 2, lam * (2 - lam), -lam * (1 - lam) / 2
    y = np.polynomial.Polynomial([0.0, 1.0])
    columns = []
    for start in ((1.0, 0.0), (0.0, 1.0)):
        v = [np.polynomial.Polynomial([s]) for s in start]  # v_(-2), v_(-1), each times its power of y
        for i in range(order):
            v.append(b * v[-1] + c * v[-2] * (y if i else 1))
        columns.append(v)
    rows = []
    for place, ghost in ((1, -1), (0, -2)):
        weights = [float(w) for w in ghost_weights(ghost, order, known, sigma)]
        row = []
        for v in columns:
            inside = sum((w * v[2 + k] * y ** (order - 1 - k) for k, w in enumerate(weights)), 0 * y)
            row.append(v[place] * y**order - inside)
        rows.append(row)
    determinant = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    return max(abs(complex(root) + a) for root in determinant.roots())
