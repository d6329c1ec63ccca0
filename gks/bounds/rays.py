"""Method of lines: all lam > 0 for which a closure mode with resolvent s is stable under a time integrator, in batches.

Along the ray mu = lam s every root z of pi(z, mu) must satisfy abs(z) < 1. That set is a finite union of open
intervals, not always one, and need not begin at 0 (RK4 along 0.02 + i: 1.279 < lam < 2.780). Its ends are positive
roots of one real polynomial with exact coefficients in Re s and |s|**2 (`gks.bounds.raypolynomial`); forward Euler's is
linear, lam = -2 Re(s) / |s|**2. They are found here for many modes at once, in double-double arithmetic, with bounds
that carry the error of s into the ends. A point that this arithmetic does not decide is flagged; `gks.bounds.rayballs`
has the same in ball arithmetic for a single point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from gks.bounds.raypolynomial import RayPolynomial, ray_polynomial
from gks.modes.doubledouble import UNIT, Array, Complex, ComplexArray, Real
from gks.modes.rootbatch import roots
from gks.scheme.integrators import Integrator

Mask = NDArray[np.bool_]

_COARSE = 2.0**-20
"""Relative error of s above which nothing is said: the bounds below are of first order with a factor for the rest."""

_SECOND_ORDER = 1.0 + 2.0**-10
"""That factor: (1 + 2**-20)**16 - 1 is below 16 * 2**-20 * this, and 16 exceeds every power that occurs."""

_MONOMIAL = 256 * UNIT**2
"""Relative rounding error of a double-double monomial q x**j n**m, j + 2 m <= 8: at most 8 products of 8 u**2, 11 u**2
for each factor n, 3 u**2 for each of at most 20 sums, rounded up."""

_CHUNK = 4096
"""Points worked on at a time, so that the many small arrays of double-double arithmetic stay in the cache."""

_TABLE_BITS = 256
"""Precision of the tables for the axes: their ends are right to the last bit of a double-double."""


@dataclass(frozen=True, slots=True)
class Intervals:
    """Open intervals (lo, hi) of lam for each point, ascending and disjoint.

    lo, hi : (points, K), the first count[p] columns are used (the others nan); hi may be inf.
    lo_error, hi_error : (points, K), relative, 0 where the end is exactly 0 or infinite.
    count : (points,) number of intervals; 0 says: never stable.
    resolved : (points,) whether the set is proved to be as given within the errors; elsewhere nothing is said.
    """

    lo: Array
    hi: Array
    lo_error: Array
    hi_error: Array
    count: NDArray[np.int64]
    resolved: Mask

    def error(self) -> Array:
        """(points,) the largest relative error among the ends."""
        both = np.fmax(self.lo_error, self.hi_error)
        used = np.arange(both.shape[1]) < self.count[:, None]
        return np.asarray(np.max(np.where(used, both, 0.0), axis=1, initial=0.0))


def stable_intervals(method: Integrator, s_re: Real | Array, s_im: Real | Array, s_error: Array | float) -> Intervals:
    """The stable lam of each mode s = s_re + i s_im, arrays (points,), double or double-double.

    s_error : bound of the error of s relative to |s|. A part of s that is exactly 0 is taken as known to be 0 (a real
        mode, or one on the imaginary axis; the error is then that of the other part). s = 0 is never stable if exact
        (s_error = 0), and unresolved otherwise.
    """
    s = Complex(_as_real(s_re), _as_real(s_im))
    error = np.broadcast_to(np.asarray(s_error, float), s.re.hi.shape)
    with np.errstate(all="ignore"):  # what is not finite ends as unresolved
        s, exponent = _unit_size(s)
        finite = np.isfinite(s.re.hi + s.im.hi + s.re.lo + s.im.lo + error) & (error >= 0)
        zero = (s.re.hi == 0) & (s.im.hi == 0)
        usable = finite & ~zero & (error <= _COARSE)
        result = _empty(len(zero), _most_intervals(method))
        result.resolved[:] = finite & zero & (error == 0)
        if method.kind == "exact":
            _by_sign_of_real_part(result, usable, s, error)
        elif ray_polynomial(method.name) is None:
            result.resolved[usable] = True
        else:
            _along_rays(result, method, usable, s, error)
        return _in_lam(result, exponent)


def everything(points: int) -> Intervals:
    """(0, inf) at every point: what no mode limits."""
    zero = np.zeros((points, 1))
    return Intervals(zero, zero + np.inf, zero, zero, np.ones(points, np.int64), np.ones(points, bool))


def intersect(a: Intervals, b: Intervals) -> Intervals:
    """The intersection, point by point.

    Where an end of one and an end of the other agree within their errors, whether an interval is left between them is
    not known: the point is unresolved.
    """
    low, low_error = _pairwise(a.lo, a.lo_error, b.lo, b.lo_error, np.greater)
    high, high_error = _pairwise(a.hi, a.hi_error, b.hi, b.hi_error, np.less)
    a_used, b_used = (np.arange(each.lo.shape[1]) < each.count[:, None] for each in (a, b))
    used = (a_used[:, :, None] & b_used[:, None, :]).reshape(low.shape)
    with np.errstate(invalid="ignore"):  # nan where a column is not used, inf - inf where two ends are infinite
        close = np.abs(high - low) <= low_error * low + high_error * np.where(np.isinf(high), 0.0, high)
        kept = used & (low < high)
    close &= (low > 0) & np.isfinite(high)
    resolved = a.resolved & b.resolved & ~(used & close).any(axis=1)
    return _gathered(kept, (low, high, low_error, high_error), resolved)


def _pairwise(a: Array, a_error: Array, b: Array, b_error: Array, first: np.ufunc) -> tuple[Array, Array]:
    """For every pair of columns the end of a where first(a, b), else that of b, with its error: (points, Ka * Kb).

    Where the two agree within their errors either may be the right one, and the larger error holds.
    """
    x, x_error, y, y_error = a[:, :, None], a_error[:, :, None], b[:, None, :], b_error[:, None, :]
    ends = np.where(first(x, y), x, y)
    errors = np.where(first(x, y), x_error, y_error)
    with np.errstate(invalid="ignore"):  # inf - inf, inf * 0, nan in unused columns: compare false
        close = np.abs(x - y) <= x_error * x + y_error * y
    errors = np.where(close, np.maximum(x_error, y_error), errors)
    return ends.reshape(len(a), -1), errors.reshape(len(a), -1)


def _gathered(kept: Mask, columns: tuple[Array, Array, Array, Array], resolved: Mask) -> Intervals:
    """The columns that are kept, in their order, moved to the left."""
    place = np.argsort(~kept, axis=1, kind="stable")
    chosen = np.take_along_axis(kept, place, axis=1)
    count = chosen.sum(axis=1)
    width = max(int(count.max(initial=0)), 1)
    low, high, low_error, high_error = (
        np.where(chosen, np.take_along_axis(each, place, axis=1), np.nan)[:, :width] for each in columns
    )
    return Intervals(low, high, low_error, high_error, count, resolved)


def _as_real(value: Real | Array) -> Real:
    if isinstance(value, Real):
        return value
    array = np.asarray(value, float)
    return Real(array, np.zeros_like(array))


def _unit_size(s: Complex) -> tuple[Complex, NDArray[np.int64]]:
    """s = (returned) * 2**exponent, the larger part between 1/2 and 1."""
    _, exponent = np.frexp(np.maximum(np.abs(s.re.hi), np.abs(s.im.hi)))
    half = exponent // 2  # two factors: 2**-exponent may itself overflow
    return s.times(np.ldexp(1.0, -half)).times(np.ldexp(1.0, half - exponent)), exponent


def _most_intervals(method: Integrator) -> int:
    """d cuts leave d + 1 pieces; on an axis there may be as many cuts as the table says, never more."""
    if method.kind == "exact":
        return 1
    polynomial = ray_polynomial(method.name)
    return 1 if polynomial is None else polynomial.degree + 1


def _empty(points: int, width: int) -> Intervals:
    ends = [np.full((points, width), np.nan) for _ in range(4)]
    return Intervals(ends[0], ends[1], ends[2], ends[3], np.zeros(points, np.int64), np.zeros(points, bool))


def _by_sign_of_real_part(result: Intervals, usable: Mask, s: Complex, error: Array) -> None:
    """z = exp(lam s): all lam where Re s < 0, none where Re s >= 0."""
    margin = error * (np.abs(s.re.hi) + np.abs(s.im.hi)) * _SECOND_ORDER
    decided = (np.abs(s.re.hi) > margin) | (s.re.hi == 0)
    stable = usable & decided & (s.re.hi < 0)
    result.resolved[usable & decided] = True
    result.lo[stable, 0], result.hi[stable, 0], result.count[stable] = 0.0, np.inf, 1
    result.lo_error[stable, 0], result.hi_error[stable, 0] = 0.0, 0.0


def _along_rays(result: Intervals, method: Integrator, usable: Mask, s: Complex, error: Array) -> None:
    """The axes by their tables, everything else by its ray polynomial."""
    real, imaginary = s.im.hi == 0, s.re.hi == 0
    for direction, on_axis, part in (
        (1, real & (s.re.hi > 0), s.re), (-1, real & (s.re.hi < 0), s.re),
        (1j, imaginary & (s.im.hi > 0), s.im), (1j, imaginary & (s.im.hi < 0), s.im),
    ):  # fmt: skip
        _from_table(result, axis_table(method, direction), np.flatnonzero(usable & on_axis), part, error)
    rest = np.flatnonzero(usable & ~real & ~imaginary)
    polynomial = ray_polynomial(method.name)
    if polynomial is not None:
        for start in range(0, len(rest), _CHUNK):
            index = rest[start : start + _CHUNK]
            _from_polynomial(result, method, polynomial, index, s.take(index), error[index])


def _in_lam(result: Intervals, exponent: NDArray[np.int64]) -> Intervals:
    """From t = lam 2**exponent to lam; where a finite end leaves the doubles, the point is unresolved."""
    lo, hi = np.ldexp(result.lo, -exponent[:, None]), np.ldexp(result.hi, -exponent[:, None])
    normal = np.finfo(float).tiny  # below it a double has fewer digits
    kept = ((lo >= normal) | (result.lo == 0)) & (hi >= normal) & (np.isfinite(hi) | np.isinf(result.hi))
    count = result.count
    resolved = result.resolved & (kept | np.isnan(lo)).all(axis=1)
    width = max(int(count.max(initial=0)), 1)
    ends = [each[:, :width] for each in (lo, hi, result.lo_error, result.hi_error)]
    return Intervals(ends[0], ends[1], ends[2], ends[3], count, resolved)


# --- the axes -----------------------------------------------------------------------------------------------------


@lru_cache(maxsize=64)
def axis_table(method: Integrator, direction: complex) -> tuple[tuple[Fraction, Fraction | None], ...]:
    """The stable intervals of |mu| along one of the directions 1, -1, 1j (which serves -1j too), to 200 bits."""
    from flint import acb

    from gks.bounds.rayballs import stable_intervals_ball

    found = stable_intervals_ball(method, acb(direction.real, direction.imag), _TABLE_BITS)
    if found is None:
        raise ArithmeticError(f"{method.name}: no table along {direction} at {_TABLE_BITS} bits")
    return tuple((_midpoint(low), None if high is None else _midpoint(high)) for low, high in found)


def _midpoint(ball: object) -> Fraction:
    mantissa, exponent = ball.mid().man_exp()  # type: ignore[attr-defined]
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _from_table(
    result: Intervals, table: Sequence[tuple[Fraction, Fraction | None]], index: NDArray[np.intp],
    part: Real, error: Array,
) -> None:  # fmt: skip
    """On an axis mu = ± lam |s|: the tabled ends divided by |s|."""
    size = part.take(index)
    size = size.times(np.sign(size.hi))
    for column, (low, high) in enumerate(table):
        for end, ends, errors in ((low, result.lo, result.lo_error), (high, result.hi, result.hi_error)):
            exact = end is None or end == 0
            quotient = _constant(Fraction(1) if end is None else end) / size
            ends[index, column] = np.inf if end is None else quotient.hi
            errors[index, column] = 0.0 if exact else error[index] * _SECOND_ORDER + 2 * UNIT
    result.count[index], result.resolved[index] = len(table), True


# --- off the axes -------------------------------------------------------------------------------------------------


def _from_polynomial(
    result: Intervals, method: Integrator, polynomial: RayPolynomial, index: NDArray[np.intp],
    s: Complex, error: Array,
) -> None:  # fmt: skip
    """Cut the ray at the positive roots and judge each piece."""
    value, blur = _coefficients(polynomial, s, error)
    cuts, radius, resolved = _positive_roots(value, blur)
    if polynomial.first_sign_decides:
        # simple roots: the sign alternates, beginning with that of the constant term (no disk around a root holds 0)
        pieces = np.arange(cuts.shape[1] + 1)[None]
        stable = (value[0].hi > 0)[:, None] ^ (pieces % 2 == 1)
        known = np.ones_like(stable)
    else:
        stable, known = _judge(method, _samples(cuts), s)
    present = np.concatenate([np.ones((len(index), 1), bool), np.isfinite(cuts)], axis=1)
    stable &= present
    resolved &= (known | ~present).all(axis=1)
    low, high = np.pad(cuts, ((0, 0), (1, 0))), np.pad(cuts, ((0, 0), (0, 1)), constant_values=np.inf)
    low_error, high_error = np.pad(radius, ((0, 0), (1, 0))), np.pad(radius, ((0, 0), (0, 1)))
    pieces_kept = _gathered(stable, (low, high, low_error, high_error), resolved)
    width = pieces_kept.lo.shape[1]
    result.lo[index, :width], result.lo_error[index, :width] = pieces_kept.lo, pieces_kept.lo_error
    result.hi[index, :width], result.hi_error[index, :width] = pieces_kept.hi, pieces_kept.hi_error
    result.count[index], result.resolved[index] = pieces_kept.count, resolved


def _coefficients(polynomial: RayPolynomial, s: Complex, error: Array) -> tuple[list[Real], list[Array]]:
    """The coefficients of t**0, t**1, … in double-double, and bounds of their errors from s and from rounding.

    With |Re s| = X, |s| = A and an error of at most D, a monomial X**j A**(2m) moves by at most
    D (j X**(j-1) A**(2m) + 2m X**j A**(2m-1)) to first order.
    """
    square = s.norm()
    size = np.sqrt(square.hi) * (1 + 4 * UNIT)
    shift = error * size
    modulus = np.abs(s.re.hi) + shift
    size = size + shift
    values, blurs = [], []
    for row in polynomial.terms:
        value, blur = _constant(Fraction(0)), np.zeros_like(size)
        for j, m, q in row:
            value = value + _constant(q) * _power(s.re, j) * _power(square, m)
            weight = abs(float(q))
            rest = size ** (2 * m)
            blur = blur + weight * modulus**j * rest * _MONOMIAL
            if j:
                blur = blur + weight * j * modulus ** (j - 1) * rest * shift * _SECOND_ORDER
            if m:
                blur = blur + weight * 2 * m * modulus**j * size ** (2 * m - 1) * shift * _SECOND_ORDER
        values.append(Real(value.hi + np.zeros_like(size), value.lo + np.zeros_like(size)))
        blurs.append(blur)
    return values, blurs


def _positive_roots(value: Sequence[Real], blur: Sequence[Array]) -> tuple[Array, Array, Mask]:
    """Ascending positive roots (points, degree), inf beyond the last; their relative errors; whether that is proved."""
    if len(value) == 1:
        none = np.zeros((len(blur[0]), 0))
        return none, none, np.abs(value[0].hi) > blur[0]
    if len(value) == 2:
        return _linear_root(value, blur)
    found = roots(np.stack([v.hi for v in value], 1), np.stack([v.lo for v in value], 1), error=np.stack(blur, 1))
    real, decided = found.real()
    positive = real & (found.hi.real > 0)
    resolved = found.resolved & decided & (found.radius < 0.5).all(axis=1)  # no disk holds 0
    cuts = np.where(positive, found.hi.real, np.inf)
    errors = np.where(positive, found.radius + 2 * UNIT, 0.0)
    order = np.argsort(cuts, axis=1)
    return np.take_along_axis(cuts, order, axis=1), np.take_along_axis(errors, order, axis=1), resolved


def _linear_root(value: Sequence[Real], blur: Sequence[Array]) -> tuple[Array, Array, Mask]:
    """-value[0] / value[1]; each relative error is at most 1/4, so the quotient's is below 2 (e_0 + e_1)."""
    errors = [b / np.abs(v.hi) for v, b in zip(value, blur, strict=True)]
    resolved = (errors[0] < 0.25) & (errors[1] < 0.25)
    root = (-value[0] / value[1]).hi
    positive = root > 0
    relative = (errors[0] + errors[1]) / (1 - np.fmin(errors[1], 0.25)) + 2 * UNIT
    return np.where(positive, root, np.inf)[:, None], np.where(positive, relative, 0.0)[:, None], resolved


def _samples(cuts: Array) -> Array:
    """A point in every piece: halfway between cuts, 2 t + 1 beyond the last; nan where there is no piece."""
    low, high = np.pad(cuts, ((0, 0), (1, 0))), np.pad(cuts, ((0, 0), (0, 1)), constant_values=np.inf)
    return np.where(np.isinf(high), 2 * low + 1, (low + high) / 2) + np.where(np.isinf(low), np.nan, 0.0)


def _judge(method: Integrator, samples: Array, s: Complex) -> tuple[Mask, Mask]:
    """(stable, known) at mu = sample * s by the Schur-Cohn recursion, with a running bound of the rounding error.

    a_0 + … + a_k z**k has all roots inside the circle iff |a_0| < |a_k| and the same holds for
    (conj(a_k) p - a_0 p*) / z, of one degree less. Judging s itself serves every s within its error: the cuts are real,
    simple and disjoint for all of them, so no z meets the circle inside a piece while s moves.
    """
    mu = s.hi[:, None] * samples
    p: list[ComplexArray] = [
        sum((float(c) * mu**k for k, c in enumerate(row)), np.zeros_like(mu)) for row in method.characteristic()
    ]
    rows = method.characteristic()
    size = sum((abs(float(c)) * np.abs(mu) ** k for row in rows for k, c in enumerate(row)), np.zeros(mu.shape))
    rounding = np.full(mu.shape, 32 * UNIT)  # relative to `size`: mu rounded, its powers, a sum of few terms
    p = [c / size for c in p]
    stable, known = np.ones(mu.shape, bool), np.ones(mu.shape, bool)
    while len(p) > 1:
        gap = np.abs(p[-1]) ** 2 - np.abs(p[0]) ** 2
        known &= (np.abs(gap) > 8 * rounding) | ~stable
        stable &= gap > 0
        reverse = [np.conj(c) for c in reversed(p)]
        p = [np.conj(p[-1]) * a - p[0] * b for a, b in zip(p, reverse, strict=True)][1:]
        rounding = 4 * rounding + 8 * UNIT  # all coefficients are at most 1 before, and at most 2 after
        largest = np.max([np.abs(c) for c in p], axis=0)
        p, rounding = [c / largest for c in p], rounding / largest
    return stable, known & np.isfinite(mu)


def _power(base: Real, exponent: int) -> Real:
    result = _constant(Fraction(1))
    for _ in range(exponent):
        result = result * base
    return result


def _constant(value: Fraction) -> Real:
    """A rational as double-double, relative error u**2."""
    hi = float(value)
    return Real(np.asarray(hi), np.asarray(float(value - Fraction(hi))))
