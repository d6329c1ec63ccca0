"""A branch of a boundary curve over an array of parameter values, in double-double arithmetic.

A printed formula loses digits where it subtracts nearly equal numbers (a bound that tends to 0 does, as the parameter
grows). The curve itself does not: its coefficients are evaluated with a bound of their error, and all its roots are
found with disks proved to hold them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import lcm

import numpy as np
from flint import fmpz_poly
from numpy.typing import NDArray

from gks.modes.critical import positive_roots
from gks.modes.doubledouble import UNIT, Array, Real
from gks.modes.numerals import exact_fraction
from gks.modes.rootbatch import MAX_DEGREE, roots
from gks.modes.unimodular import by_real_part

Terms = Mapping[tuple[int, int], int]
"""A polynomial: exponents of p and lam -> coefficient."""

SAFE_BITS = 900
"""Sizes in between 2**-900 and 2**900 neither over- nor underflow in double-double arithmetic; others are left to
exact roots.
"""

ACCURACY = 2.0**-50
"""Relative radius up to which a double-double disk gives its double: a few units in the last place, below 1e-15."""

ROUNDING_BITS = 80
"""Bits of an enclosure that is then rounded to a double."""


def branch_values(curve: Terms, k: int, p: Sequence[float] | NDArray[np.float64]) -> Array:
    """The k-th positive root in lam at each p, to 1e-15 relative; nan where p is, or where there are fewer roots."""
    points = np.asarray(p, dtype=float)
    degree = max(power for _, power in curve)
    result = np.full(points.shape, np.nan)
    done = np.zeros(points.shape, bool)
    if degree <= MAX_DEGREE:
        with np.errstate(all="ignore"):  # what overflows is not resolved and goes to exact roots
            result, done = _batched(curve, degree, k, points)
    for index in np.flatnonzero(~done & np.isfinite(points)):
        result[index] = _exact(curve, degree, k, Fraction(float(points[index])))
    return result


def _batched(curve: Terms, degree: int, k: int, points: Array) -> tuple[Array, NDArray[np.bool_]]:
    parts = [_horner({i: c for (i, j), c in curve.items() if j == power}, points) for power in range(degree + 1)]
    found = roots(
        np.stack([value.hi for value, _ in parts], axis=1),
        np.stack([value.lo for value, _ in parts], axis=1),
        error=np.stack([error for _, error in parts], axis=1),
    )
    real, proved = found.real()
    lam = np.sort(np.where(real & (found.hi.real > 0), found.hi.real, np.inf), axis=1)
    chosen = lam[:, k - 1] if k <= degree else np.full(points.shape, np.inf)
    sharp = np.all(np.where(real, found.radius, 0.0) <= ACCURACY, axis=1)
    good = found.resolved & proved & sharp & np.isfinite(points)
    return np.where(good & np.isfinite(chosen), chosen, np.nan), good


def _horner(coefficients: Mapping[int, int], points: Array) -> tuple[Real, Array]:
    """A polynomial at all points, with a bound of the absolute error: 16 u**2 of the sum of absolute values a step."""
    zero = np.zeros_like(points)
    x = Real(points, zero)
    total, size = Real(zero, zero), zero
    top = max(coefficients, default=0)
    for power in range(top, -1, -1):
        constant = coefficients.get(power, 0)
        high = float(constant) if abs(constant) < 1 << SAFE_BITS else float("inf")
        low = float(constant - int(high)) if np.isfinite(high) else 0.0
        total = total * x + Real(zero + high, zero + low)
        size = size * np.abs(points) + abs(high)
    unsafe = (size > 2.0**SAFE_BITS) | ((size < 2.0**-SAFE_BITS) & (size > 0))
    return Real(np.where(unsafe, np.nan, total.hi), total.lo), size * (16.0 * UNIT**2 * (2 * top + 3))


def _exact(curve: Terms, degree: int, k: int, p: Fraction) -> float:
    parts = [sum((c * p**i for (i, j), c in curve.items() if j == power), Fraction(0)) for power in range(degree + 1)]
    clear = lcm(*(part.denominator for part in parts))
    poly = fmpz_poly([int(part * clear) for part in parts])
    if not poly:
        return float("nan")
    ends = by_real_part(positive_roots([poly]))
    return float(exact_fraction(ends[k - 1].ball(ROUNDING_BITS).real)) if k <= len(ends) else float("nan")
