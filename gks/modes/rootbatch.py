"""All simple roots of many polynomials of one degree at once, each with a disk that is proved to hold it.

1. *Scaling.* The Newton polygon of the coefficients gives the modulus of every root to within a factor of about the
   degree (Bini, Numer. Algorithms 13 (1996) 179-200), and with it a scaling of the polynomial for each root by powers
   of two: roots 1e300 apart overflow nothing.
2. *Ehrlich-Aberth* iteration in double precision, from Bini's starting points.
3. *Polish and inclusion* with double-double residuals (`gks.modes.inclusion`).

Real polynomials of degree 1 and 2 have formulas (`gks.modes.quadratics`); what these leave open goes the same way.

A point where the disks meet (a multiple root, or a pair closer than double-double arithmetic tells), where the leading
coefficient is zero or where anything is not finite comes back with `resolved` False: it is never guessed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.modes.doubledouble import UNIT, Array, Complex, ComplexArray, Real, two_sum
from gks.modes.inclusion import (
    FAR,
    ROUNDED_UP,
    Leading,
    Mask,
    Polynomials,
    Scaled,
    polish,
    reciprocal,
    scale,
    size_above,
    size_below,
)
from gks.modes.quadratics import quadratic_roots

MAX_DEGREE = 16

_CHUNK = 8192
"""Elements of one working array, 64 kB of doubles: small enough to stay in the cache, large enough for numpy."""

_ABERTH_STEPS = 60
"""Ehrlich-Aberth takes 6 to 15 steps from Bini's points at degrees up to 16; what takes longer has a cluster, where the
polish does better. (The limit costs time only: the inclusion decides.)"""

_ABERTH_DONE = 2.0**-20
"""A relative correction below this leaves, as convergence is cubic, less than the rounding error of doubles."""

_ZERO_LOG = -1e7
"""log2 of a vanishing coefficient: so low that it never touches the Newton polygon, finite so that slopes are."""


@dataclass(frozen=True, slots=True)
class Roots:
    """Roots of `points` polynomials of one degree n.

    hi, lo : complex, (points, n): the root is hi + lo. Order is by the Newton polygon, moduli roughly ascending.
    radius : (points, n), relative: the root, and no other, lies within radius * |hi| of hi + lo.
    resolved : (points,) whether that is proved; elsewhere hi, lo and radius mean nothing.
    """

    hi: ComplexArray
    lo: ComplexArray
    radius: Array
    resolved: Mask

    def real(self) -> tuple[Mask, Mask]:
        """Which roots are real, if the polynomials are, (points, n); and for which points that is proved, (points,).

        A disk that misses the real axis holds no real root. One that meets it holds a real root if its mirror image
        meets no other disk: the conjugate of its root would have to lie in one of those.
        """
        disks = self.radius * np.abs(self.hi)
        real = np.abs(self.hi.imag + self.lo.imag) <= disks
        mirrored = np.abs(self.hi[:, :, None] - np.conj(self.hi[:, None, :]))
        reached = (disks[:, :, None] + disks[:, None, :]) * ROUNDED_UP + 8 * UNIT * np.abs(self.hi)[:, :, None]
        meets = mirrored <= reached
        i = np.arange(self.hi.shape[1])
        meets[:, i, i] = False
        return real, self.resolved & ~np.any(real & meets.any(axis=2), axis=1)


def roots(
    hi: NDArray[np.complex128] | Array,
    lo: NDArray[np.complex128] | Array | None = None,
    exponent: NDArray[np.int64] | None = None,
    error: Array | None = None,
) -> Roots:
    """All roots of sum_k (hi + lo)[:, k] * 2**exponent[:, k] * x**k, ascending, shape (points, degree + 1).

    lo, exponent, error : zero if left out.
    error : the true coefficients are within error * 2**exponent of those given; the disks then hold the true roots.

    Raises ValueError for a degree outside 1..16 or shapes that differ.
    """
    points, degree = hi.shape[0], hi.shape[1] - 1
    if not 1 <= degree <= MAX_DEGREE:
        raise ValueError(f"degree {degree} is outside 1..{MAX_DEGREE}")
    low = np.zeros_like(hi) if lo is None else lo
    power = np.zeros(hi.shape, np.int64) if exponent is None else exponent
    blur = np.zeros(hi.shape) if error is None else error
    if not hi.shape == low.shape == power.shape == blur.shape:
        raise ValueError(f"coefficient shapes differ: {hi.shape}, {low.shape}, {power.shape}, {blur.shape}")
    result = Roots(
        np.full((points, degree), np.nan, complex), np.zeros((points, degree), complex),
        np.full((points, degree), np.inf), np.zeros(points, bool),
    )  # fmt: skip
    zero = (hi[:, 0] == 0) & (low[:, 0] == 0)
    if zero.any():
        _with_root_zero(result, np.flatnonzero(zero & (blur[:, 0] == 0)), hi, low, power, blur)
    size = max(_CHUNK // degree, 1)
    rest = np.flatnonzero(~zero)
    with np.errstate(all="ignore"):  # what overflows becomes nan and is flagged
        if degree <= 2 and exponent is None and not (np.iscomplexobj(hi) or np.iscomplexobj(low)):
            for start in range(0, len(rest), size):
                index = rest[start : start + size]
                _by_formula(result, index, hi[index].real, low[index].real, blur[index])
            rest = rest[~result.resolved[rest]]
        for start in range(0, len(rest), size):
            index = rest[start : start + size]
            _chunk(result, index, hi[index].T, low[index].T, power[index].T, blur[index].T)
    return result


def _with_root_zero(
    result: Roots, index: NDArray[np.intp], hi: ComplexArray | Array, lo: ComplexArray | Array,
    power: NDArray[np.int64], error: Array,
) -> None:  # fmt: skip
    """A constant term of exactly zero is the root 0, simple where the next coefficient is not zero: divide by x."""
    result.hi[index, 0], result.radius[index, 0] = 0.0, 0.0
    linear = np.abs(hi[index, 1] + lo[index, 1]) > error[index, 1]
    if hi.shape[1] == 2:
        result.resolved[index] = linear & np.isfinite(hi[index, 1])
        return
    index = index[linear]
    if len(index):
        other = roots(hi[index, 1:], lo[index, 1:], power[index, 1:], error[index, 1:])
        result.hi[index, 1:], result.lo[index, 1:] = other.hi, other.lo
        result.radius[index, 1:], result.resolved[index] = other.radius, other.resolved


def _by_formula(result: Roots, index: NDArray[np.intp], hi: Array, lo: Array, error: Array) -> None:
    """Those of degree 1 or 2, where the formulas prove their errors."""
    terms = [Real(*two_sum(high, low)) for high, low in zip(hi.T, lo.T, strict=True)]
    found = quadratic_roots(terms, list(error.T))
    good = found.good & np.isfinite(found.hi + found.lo + found.radius).all(axis=0)
    place = index[good]
    result.hi[place], result.lo[place] = found.hi[:, good].T, found.lo[:, good].T
    result.radius[place], result.resolved[place] = found.radius[:, good].T, True


def _chunk(
    result: Roots, index: NDArray[np.intp], hi: ComplexArray | Array, lo: ComplexArray | Array,
    power: NDArray[np.int64], error: Array,
) -> None:  # fmt: skip
    """Solve for one chunk, coefficients (k, point), and write what is resolved into `result`."""
    given = _normalised(hi, lo, power, error)
    finite = np.isfinite(given.mantissa.re.hi + given.mantissa.im.hi).all(axis=0)
    finite &= (given.mantissa.hi[-1] != 0) & (given.mantissa.hi[0] != 0)
    given, index = given.take(finite), index[finite]
    if not len(index):
        return
    modulus = np.abs(given.mantissa.hi)
    logs = np.where(modulus == 0, _ZERO_LOG, np.log2(modulus) + given.exponent)
    radii = _newton_polygon(logs)
    whole = np.rint(radii).astype(np.int64)
    x = _aberth(scale(given, whole), _starting_points(radii, whole))
    # the roots may have moved: scale anew, so that every mantissa is between 1/2 and 1 in the polish
    _, shift = np.frexp(size_below(x))
    usable = np.isfinite(x).all(axis=0) & (x != 0).all(axis=0)
    x = np.where(usable, x * np.ldexp(1.0, -shift), 1.0)
    scaled = scale(given, whole + np.where(usable, shift, 0))
    polished, radius, separate = polish(scaled, Leading.of(given), x)
    _store(result, index, polished, scaled.exponent, radius, separate & usable)


def _normalised(
    hi: ComplexArray | Array, lo: ComplexArray | Array, power: NDArray[np.int64], error: Array
) -> Polynomials:
    """Coefficients as double-double mantissas of size about 1 and integer exponents."""
    _, shift = np.frexp(np.maximum(np.abs(np.real(hi)), np.abs(np.imag(hi))))
    half, rest = np.ldexp(1.0, -(shift // 2)), np.ldexp(1.0, -(shift - shift // 2))  # 2**-shift itself may overflow
    blur = error * half * rest if error.any() else None
    return Polynomials(Complex.of(hi * half * rest, lo * half * rest), blur, power + shift)


def _newton_polygon(logs: Array) -> Array:
    """log2 of the moduli of the roots, ascending, (n, points), from log2 of those of the coefficients, (n + 1, points).

    Minus the slopes of the least concave majorant, each by the min-max formula: its slope over [m - 1, m] is
    min_{i < m} max_{j >= m} (L_j - L_i) / (j - i).
    """
    count = len(logs)
    slopes = []
    for m in range(1, count):
        best = None
        for i in range(m):
            steepest = (logs[m] - logs[i]) / (m - i)
            for j in range(m + 1, count):
                np.maximum(steepest, (logs[j] - logs[i]) / (j - i), out=steepest)
            best = steepest if best is None else np.minimum(best, steepest)
        slopes.append(best)
    return -np.stack([s for s in slopes if s is not None])


def _starting_points(radii: Array, whole: NDArray[np.int64]) -> ComplexArray:
    """Bini's points over 2**whole: the roots of one side of the polygon evenly on a circle, the sides turned."""
    degree = len(radii)
    same = 2.0**-20  # equal slopes come out equal to rounding; nearly equal ones may as well share a circle
    first = np.zeros(radii.shape)
    size = np.zeros(radii.shape)
    for other in radii:
        first += other < radii - same
        size += np.abs(other - radii) <= same
    place = np.arange(degree)[:, None] - first
    angle = 2 * np.pi * (place / size + first / degree) + 0.7  # Bini's sigma: no symmetry about the real axis
    return np.asarray(np.exp2(radii - whole) * np.exp(1j * angle))


def _horner(terms: ComplexArray, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """p(x) and p'(x) in double precision; terms (k, root, point)."""
    value, slope = terms[-1], np.zeros_like(x)
    for term in terms[-2::-1]:
        slope = slope * x + value
        value = value * x + term
    return value, slope


def _aberth(scaled: Scaled, start: ComplexArray) -> ComplexArray:
    """Ehrlich-Aberth from the starting points, in units of 2**exponent, to about double precision.

    A point's roots are those of the step at which it is done, however long others take: they depend on it alone.
    """
    result = start.copy()
    terms, x = scaled.terms.hi, start
    first, second = np.triu_indices(len(start), 1)
    distance = np.clip(scaled.exponent[second] - scaled.exponent[first], -FAR, FAR)
    ratio = np.ldexp(1.0, distance)  # x_j in the units of root i, for the pairs i < j
    active = np.arange(start.shape[1])
    open_ = np.ones(start.shape[1], bool)
    for _ in range(_ABERTH_STEPS):
        value, slope = _horner(terms, x)
        inverse = reciprocal(x[first] - x[second] * ratio)
        attraction = np.zeros_like(x)
        for pair, (i, j) in enumerate(zip(first, second, strict=True)):
            attraction[i] += inverse[pair]
            attraction[j] -= inverse[pair] * ratio[pair]
        correction = value / (slope - value * attraction)
        x = x - correction
        going = (size_above(correction) > _ABERTH_DONE * size_above(x)).any(axis=0)  # nan compares false: it stops
        done = open_ & ~going
        result[:, active[done]] = x[:, done]
        open_ = open_ & going
        left = np.count_nonzero(open_)
        if not left:
            return result
        if 2 * left < len(active):
            active, x, terms, ratio = active[open_], x[:, open_], terms[..., open_], ratio[..., open_]
            open_ = np.ones(left, bool)
    result[:, active[open_]] = x[:, open_]
    return result


def _store(
    result: Roots, index: NDArray[np.intp], x: Complex, exponent: NDArray[np.int64], radius: Array,
    separate: Mask,
) -> None:  # fmt: skip
    """Back to plain numbers, where these have room for hi and for lo (53 bits below it)."""
    room = (np.abs(exponent) <= 900).all(axis=0)
    good = separate & room & np.isfinite(radius).all(axis=0)
    factor = np.ldexp(1.0, np.clip(exponent, -900, 900))
    result.hi[index], result.lo[index] = (x.hi * factor).T, (x.lo * factor).T
    result.radius[index], result.resolved[index] = radius.T, good
