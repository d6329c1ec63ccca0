"""Discs around the computed roots of polynomials whose coefficients are rounded: how far off each root may be.

Around a computed root x the polynomial is the sum of t_j (y - x)**j, and where abs(t_k) r**k is more than the other
abs(t_j) r**j together exactly k roots are within r (Rouché). The sums are computed with bounds of their rounding: the
rounding unit times the number of operations times the sum of the moduli of the terms. A disc counts if as many computed
roots are in it as there are roots; where none does a root is as good as anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

from gks.bounds.sampled import Array, Coefficients, ComplexArray, horner
from gks.modes.doubledouble import UNIT

COMPLEX_STEP = 4
"""Rounding units of one step of Horner's scheme: sqrt(5) of a complex product (Brent, Percival & Zimmermann, Math.
Comp. 76 (2007) 1469-1481), 1 of the sum."""
LARGEST_CLUSTER = 4
"""Roots that a disc may hold together: k of them are known to the k-th root of the rounding, 1e-4 for 4."""


@dataclass(frozen=True, slots=True)
class RoundedPolynomials:
    """Polynomials (N, n + 1), ascending, with the sums of the moduli of their coefficients' terms, and the rounding of
    their values relative to those.
    """

    coefficients: ComplexArray
    sizes: Array
    rounding: float

    def discs(self, roots: ComplexArray) -> Array:
        """Radii (N, n) of discs around the roots, infinite where none is found or the root is not finite."""
        radii = np.full(roots.shape, np.inf)
        for cluster in range(1, min(LARGEST_CLUSTER, roots.shape[1]) + 1):
            rows = np.flatnonzero((np.isinf(radii) & np.isfinite(roots)).any(axis=1))
            if not len(rows):
                break
            mine = roots[rows]
            with np.errstate(all="ignore"):
                found = self._of_cluster(rows, mine, cluster)
                held = (np.abs(mine[:, :, None] - mine[:, None, :]) <= found[:, :, None]).sum(axis=2)
            better = np.isinf(radii[rows]) & np.isfinite(found) & (held == cluster)
            radii[rows] = np.where(better, found, radii[rows])
        return radii

    def _of_cluster(self, rows: NDArray[np.intp], x: ComplexArray, count: int) -> Array:
        """Radii of discs that hold so many roots, nan where the one tried does not."""
        degree = x.shape[1]
        coefficients, sizes, moduli = self.coefficients[rows], self.sizes[rows], np.abs(x)
        shares: list[Array] = []
        for j in range(degree + 1):
            binomials = np.array([comb(k, j) for k in range(j, degree + 1)], float)
            value = np.abs(horner(coefficients[:, j:] * binomials, x))
            blur = self.rounding * horner(sizes[:, j:] * binomials, moduli)
            shares.append(value - blur if j == count else value + blur)
        # Twice Fujiwara's bound for the lower terms alone: what these leave of t_k r**k is at least half of it.
        below = [(shares[j] / shares[count]) ** (1 / (count - j)) for j in range(count)]
        radius = 2 * np.max(below, axis=0)
        others = sum(shares[j] * radius**j for j in range(degree + 1) if j != count)
        holds = (shares[count] * radius**count > others) | (radius == 0)  # at 0 all terms may vanish
        return np.where((shares[count] > 0) & holds, radius, np.nan)


def gaps(roots: ComplexArray, radii: Array) -> Array:
    """The distance (N, n) of every root from the nearest disc that does not meet its own; 0 where any disc is missing.

    Discs that meet are a cluster's, or those of factors that share the root.
    """
    least = np.full(roots.shape, np.inf)
    with np.errstate(all="ignore"):
        for i in range(roots.shape[1]):
            distance = np.abs(roots - roots[:, i : i + 1])
            other = np.isfinite(roots) & ~(distance <= radii + radii[:, i : i + 1])
            other |= np.isfinite(roots) & np.isinf(radii)
            other[:, i] = False
            away = np.where(other, np.maximum(distance - radii, 0), np.inf)
            least[:, i] = away.min(axis=1)
    return np.where(np.isnan(least), 0, least)


def separations(roots: ComplexArray, radii: Array) -> Array:
    """The distance (n,) of every one of n roots from the nearest other disc; 0 where another meets its own."""
    away = np.abs(roots[:, None] - roots) - radii
    away[away <= radii[:, None]] = 0
    np.fill_diagonal(away, np.inf)
    return np.asarray(away.min(axis=1, initial=np.inf))


def rounded(polynomial: Coefficients, *symbols: Array) -> RoundedPolynomials:
    """The polynomials at values of the symbols, themselves rounded."""
    coefficients = polynomial.at(*symbols)
    operations = polynomial.operations + COMPLEX_STEP * (coefficients.shape[1] - 1)
    return RoundedPolynomials(coefficients, polynomial.sizes(*symbols), operations * UNIT)
