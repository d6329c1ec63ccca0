"""Disks that are proved to hold one root each, around the approximations of a batch of root finders.

For distinct approximations x_i of the roots of p, of degree n, let w_i = p(x_i) / (a_n prod_{j != i} (x_i - x_j)).

- The disks of radius n |w_i| around x_i hold all roots, and each connected component as many as it has disks (Smith,
  J. ACM 17 (1970) 661-674). Where they are disjoint, each holds exactly one.
- x_i - w_i / (1 + sum_{j != i} w_j / (x_i - x_j)) is a better approximation (Börsch-Supan, Numer. Math. 5 (1963)
  113-116): the convergence is cubic, and no derivative is needed, which cancels near a close pair.

With p(x_i) in double-double arithmetic w_i is right even where p nearly vanishes. |w_i| is bounded from above: the
rounding of the double-double Horner scheme, underflow and the stated errors of the coefficients are in the radius.

Every root x_i is held as m_i 2**e_i and the polynomial scaled for it alone, coefficients b_k = a_k 2**(k e_i - M_i) of
at most 2, so that nothing overflows however far the roots are apart. The last axis of all arrays is the points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.modes.doubledouble import UNIT, Array, Complex, ComplexArray

Mask = NDArray[np.bool_]

_POLISH_STEPS = 40
"""A pair at relative distance 2**-45, started 2**-25 away, halves its error at each of some 20 steps before convergence
is cubic. (The limit costs time only: the disks decide.)"""

_POLISH_DONE = 2.0**-88
"""Relative radius at which polishing stops: 26 digits, within double-double accuracy for well-conditioned roots."""

_HORNER_STEP = 32 * UNIT**2
"""Error of one double-double Horner step b x + a relative to |b x| + |a|: 20 u**2 of the product, 4.3 u**2 of the
sum, rounded up."""

ROUNDED_UP = 1.0 + 2.0**-40
"""Covers the rounding of the double-precision bounds themselves: a few hundred operations, u each."""

_TINY = 2.0**-900
"""Covers underflow in the scaled polynomial, whose largest coefficient is between 1/2 and 2, and the coefficients below
2**-1000 of it, which are taken as that large."""

_SEPARATION = 2.0**-48
"""Relative distance of two approximations above which their computed difference is right to 2**-48."""

FAR = 400
"""Powers of two beyond which two roots do not see each other: differences are clipped there, far below rounding."""


@dataclass(slots=True)
class Polynomials:
    """The polynomials of a chunk, axes (k, point): a_k = mantissa 2**exponent, known within blur 2**exponent."""

    mantissa: Complex
    blur: Array | None
    exponent: NDArray[np.int64]

    def take(self, points: Mask) -> Polynomials:
        blur = None if self.blur is None else self.blur[:, points]
        return Polynomials(self.mantissa.take((..., points)), blur, self.exponent[:, points])


@dataclass(slots=True)
class Scaled:
    """The polynomials of a chunk, scaled for each root: axes (k, root, point) or (root, point).

    terms : b_k = a_k 2**(k e_i - M_i);  blur : its error, None if there is none at all
    exponent : e_i;  scale : M_i
    """

    terms: Complex
    blur: Array | None
    exponent: NDArray[np.int64]
    scale: NDArray[np.int64]

    def take(self, points: Mask) -> Scaled:
        blur = None if self.blur is None else self.blur[..., points]
        return Scaled(self.terms.take((..., points)), blur, self.exponent[:, points], self.scale[:, points])


def scale(given: Polynomials, whole: NDArray[np.int64]) -> Scaled:
    """The polynomials scaled for roots of size 2**whole."""
    k = np.arange(len(given.exponent))[:, None, None]
    powers = given.exponent[:, None, :] + k * whole[None]
    present = (given.mantissa.hi != 0)[:, None, :]
    largest = np.max(np.where(present, powers, np.iinfo(np.int64).min), axis=0)
    factors = np.ldexp(1.0, np.maximum(powers - largest, -1000))  # never 0: the errors must not underflow
    terms = given.mantissa.take((slice(None), None)).times(factors)
    blur = None if given.blur is None else given.blur[:, None] * factors
    return Scaled(terms, blur, whole, largest)


@dataclass(slots=True)
class Leading:
    """The leading coefficients (point,) of a chunk: mantissa (double), a lower bound of its true modulus, exponent."""

    mantissa: ComplexArray
    least: Array
    exponent: NDArray[np.int64]

    @classmethod
    def of(cls, given: Polynomials) -> Leading:
        mantissa = given.mantissa.hi[-1]
        least = np.abs(mantissa) if given.blur is None else np.maximum(np.abs(mantissa) - given.blur[-1], 0)
        return cls(mantissa, least, given.exponent[-1])

    def take(self, points: Mask) -> Leading:
        return Leading(self.mantissa[points], self.least[points], self.exponent[points])


@dataclass(slots=True)
class _Pairs:
    """How two roots of a point compare: x_i - x_j = (x_i own - x_j other) 2**max(e_i, e_j), axes (pair i < j, point).

    to_unit : (root, point), the power of two that brings p(x_i) / (a_n prod of the mantissas) to the unit 2**e_i.
    """

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    own: Array
    other: Array
    to_unit: Array

    @classmethod
    def of(cls, scaled: Scaled, leading_exponent: NDArray[np.int64]) -> _Pairs:
        e = scaled.exponent
        first, second = np.triu_indices(len(e), 1)
        distance = e[second] - e[first]
        own = np.ldexp(1.0, np.clip(-distance, -FAR, 0))
        other = np.ldexp(1.0, np.clip(distance, -FAR, 0))
        beyond = np.maximum(e[None], e[:, None]).sum(axis=1) - e  # over j != i
        # clipped from below only, which can but enlarge the radius; a power beyond the doubles is inf: unresolved
        to_unit = np.ldexp(1.0, np.maximum(scaled.scale - leading_exponent - beyond - e, -1000))
        return cls(first, second, own, other, to_unit)

    def take(self, points: Mask) -> _Pairs:
        own, other = self.own[:, points], self.other[:, points]
        return _Pairs(self.first, self.second, own, other, self.to_unit[:, points])

    def differences(self, x: Complex) -> ComplexArray:
        """Mantissas of x_i - x_j; relative error 2**-48 where `_SEPARATION` holds."""
        hi, lo = x.hi, x.lo
        i, j = self.first, self.second
        return (hi[i] * self.own - hi[j] * self.other) + (lo[i] * self.own - lo[j] * self.other)

    def products(self, differences: ComplexArray) -> ComplexArray:
        """prod_{j != i} of the mantissas of x_i - x_j."""
        result = np.ones(self.to_unit.shape, complex)
        for pair, (i, j) in enumerate(zip(self.first, self.second, strict=True)):
            result[i] *= differences[pair]
            result[j] *= -differences[pair]
        return result

    def interactions(self, differences: ComplexArray, w: ComplexArray) -> ComplexArray:
        """1 + sum_{j != i} w_j / (x_i - x_j), w_j in units of 2**e_j."""
        inverse = reciprocal(differences)
        result = np.ones_like(w)
        for pair, (i, j) in enumerate(zip(self.first, self.second, strict=True)):
            result[i] += w[j] * (inverse[pair] * self.other[pair])
            result[j] -= w[i] * (inverse[pair] * self.own[pair])
        return result

    def apart(self, differences: ComplexArray, modulus: Array, bound: Array) -> Mask:
        """(point,) whether all approximations are well separated and the disks of radius `bound` are disjoint."""
        i, j = self.first, self.second
        needed = np.maximum(_SEPARATION * modulus, bound * ROUNDED_UP)
        apart = size_below(differences) > needed[i] * self.own + needed[j] * self.other
        return np.asarray(apart.all(axis=0))


def _residual(scaled: Scaled, x: Complex) -> tuple[ComplexArray, Array]:
    """p(x_i) by the double-double Horner scheme, and a bound of its error (rounding, coefficients, underflow)."""
    count = len(scaled.terms.re.hi)
    value = scaled.terms.take(-1)
    size, modulus = size_above(value.hi), size_above(x.hi)
    blur = None if scaled.blur is None else scaled.blur[-1]
    for k in range(count - 2, -1, -1):
        term = scaled.terms.take(k)
        value = value * x + term
        size = size * modulus + size_above(term.hi)
        if blur is not None and scaled.blur is not None:
            blur = blur * modulus + scaled.blur[k]
    error = count * _HORNER_STEP * size + _TINY
    return value.hi, error if blur is None else error + blur


def _weierstrass(
    scaled: Scaled, pairs: _Pairs, leading: Leading, x: Complex
) -> tuple[ComplexArray, Array, Mask, Mask]:
    """Börsch-Supan's corrections and relative radii (root, point); whether disks are disjoint, and small (point,)."""
    residual, error = _residual(scaled, x)
    difference = pairs.differences(x)
    product = pairs.products(difference)
    w = residual / (leading.mantissa * product) * pairs.to_unit
    bound = (np.abs(residual) + error) / (leading.least * np.abs(product)) * pairs.to_unit
    bound *= len(bound) * ROUNDED_UP
    separate = pairs.apart(difference, size_above(x.hi), bound)
    correction = w / pairs.interactions(difference, w)
    radius = bound / size_below(x.hi) * ROUNDED_UP
    at_rounding = (np.abs(residual) <= error).all(axis=0)
    finished = separate & ((radius <= _POLISH_DONE).all(axis=0) | at_rounding)
    return correction, radius, separate, finished


def polish(
    scaled: Scaled, leading: Leading, start: ComplexArray
) -> tuple[Complex, Array, Mask]:
    """Börsch-Supan steps with double-double residuals until the disks are as small as the arithmetic makes them."""
    shape = start.shape
    hi, lo = start.copy(), np.zeros(shape, complex)
    radii, disjoint = np.full(shape, np.inf), np.zeros(shape[1], bool)
    active = np.arange(shape[1])
    x = Complex.of(start)
    pairs = _Pairs.of(scaled, leading.exponent)
    for _ in range(_POLISH_STEPS):
        correction, radius, separate, finished = _weierstrass(scaled, pairs, leading, x)
        hi[:, active], lo[:, active], radii[:, active], disjoint[active] = x.hi, x.lo, radius, separate
        going = ~finished & np.isfinite(correction).all(axis=0)
        if not going.any():
            break
        if not going.all():
            active, x, correction = active[going], x.take((..., going)), correction[:, going]
            scaled, pairs, leading = scaled.take(going), pairs.take(going), leading.take(going)
        x = x - Complex.of(correction)
    return Complex.of(hi, lo), radii, disjoint


def reciprocal(z: ComplexArray) -> ComplexArray:
    """1 / z for moduli within 2**±500, without the guards against overflow that make numpy's division slow."""
    re, im = z.real, z.imag
    square = re * re + im * im
    result = np.empty_like(z)
    np.divide(re, square, out=result.real)
    np.divide(-im, square, out=result.imag)
    return result


def size_above(z: ComplexArray) -> Array:
    """|re| + |im|: the modulus, or up to sqrt(2) more, at a third of the time."""
    return np.abs(z.real) + np.abs(z.imag)


def size_below(z: ComplexArray) -> Array:
    """max(|re|, |im|): the modulus, or down to sqrt(1/2) of it."""
    return np.maximum(np.abs(z.real), np.abs(z.imag))
