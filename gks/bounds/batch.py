"""The stable set over a whole sweep at once, where the closure modes do not depend on lam.

Under the method of lines with a one-level closure the modes are the roots s of a polynomial N(s; p) whose coefficients
are
polynomials in the swept parameter p. Where every field has its decaying solutions on one sheet (the first-order upwind
family: no spatial root has to be chosen), N is Delta itself. Then for a lam that is Cauchy-stable every root s with a z
outside the circle is a normal mode, since all decaying roots decay there; so the stable set is

    Cauchy set of the interior  intersected with  {lam: all z of pi(z, lam s) = 0 are inside} over the roots s,

both known in closed form or as roots of small real polynomials. All of it runs over arrays in double-double arithmetic
with
proved error bounds; a point that they do not settle is left to the exact route.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import fmpz_mpoly
from numpy.typing import NDArray

from gks.bounds.located import close_to
from gks.bounds.rays import Intervals, everything, intersect, stable_intervals
from gks.bounds.signs import field_symbols, holds_lam
from gks.bounds.sweep import Point
from gks.errors import InputError
from gks.modes.algebraic import Root
from gks.modes.cauchy import degree_in
from gks.modes.cauchy_set import CauchySet, cauchy_set
from gks.modes.characteristic import unit_lines
from gks.modes.coefficients import Coefficients, Ratio
from gks.modes.doubledouble import UNIT, Array, Real
from gks.modes.fibre import coefficients as powers_of
from gks.modes.field import Field
from gks.modes.interior import amplification, field_symbol
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.numerals import to_double
from gks.modes.polynomial import Degenerate, TooWide, characteristic_factors
from gks.modes.rootbatch import MAX_DEGREE, roots
from gks.scheme.model import NamedLines, Scheme

SAFE_BITS = 900
"""Products of powers of p and coefficients are kept below 2**900, where double-double arithmetic neither over- nor
underflows.
"""


@dataclass(frozen=True, slots=True)
class BatchSet:
    """Stable intervals of every point, and the interior's own first limit (inf where it sets none)."""

    stable: Intervals
    interior_limit: Array

    def open_points(self) -> list[int]:
        """Those that the batch did not resolve."""
        return [int(k) for k in np.flatnonzero(~self.stable.resolved)]


def samples(points: Sequence[Point]) -> tuple[Point, Point]:
    """The points of a sweep at one of which the signs of its speeds are looked up."""
    return points[len(points) // 2], points[len(points) // 3]


@dataclass(frozen=True, slots=True)
class _Interior:
    """A Cauchy set, in lam, or in lam times the modulus of a speed that the swept parameter moves."""

    limits: CauchySet
    speed: Ratio | None


@dataclass(frozen=True, slots=True)
class Batch:
    """A scheme ready for many values of a parameter: what is derived once.

    factors : of the characteristic polynomial, in s; exceptional : polynomials at a zero of which there is no scheme.
    """

    problem: NormalModeProblem
    swept: str
    factors: tuple[fmpz_mpoly, ...]
    exceptional: tuple[fmpz_mpoly, ...]
    interiors: tuple[_Interior, ...]

    def at(self, points: Sequence[Point]) -> BatchSet:
        """The stable sets at the points: what is found at one depends on it alone.

        Points at which a speed has another sign than where the scheme was derived are not resolved.
        """
        parameter = _double_double(points)
        with np.errstate(all="ignore"):  # what overflows is flagged and goes to the exact route
            interior = everything(len(points))
            for each in self.interiors:
                interior = intersect(interior, _in_lam(each, self.swept, parameter))
            result = interior
            for factor in self.factors:
                result = intersect(result, _closure(self.problem, factor, self.swept, parameter))
            result.resolved[:] &= _same_signs(self.problem, self.swept, parameter)
            for polynomial in self.exceptional:
                # A degenerate closure or a division by zero: the exact route says which.
                value, error = _at(polynomial, self.swept, parameter)
                result.resolved[:] &= np.abs(value.hi) > 2 * error
        first = np.where((interior.count > 0) & (interior.lo[:, 0] == 0), interior.hi[:, 0], 0.0)
        return BatchSet(result, first)


def prepared(scheme: Scheme, values: Mapping[str, Fraction], name: str, at: Sequence[Point]) -> Batch | None:
    """The scheme derived at the first of some values of the parameter where there is one; None where it is not of the
    kind this route is for.
    """
    problem = _at_some_point(scheme, values, name, at)
    if problem is None or not _applies(problem):
        return None
    try:
        elimination = characteristic_factors(problem)
    except (Degenerate, TooWide):
        return None
    factors = tuple(factor.polynomial for factor in elimination.factors)
    lam, swept = (problem.coefficients.variable(symbol) for symbol in (scheme.cfl, name))
    if elimination.lost_sheet or any(degree_in(f, lam) or degree_in(f, "s") > MAX_DEGREE for f in factors):
        return None
    exceptional = (*elimination.idle, *problem.coefficients.inverted.values())
    if any(degree_in(f, lam) for f in exceptional):
        return None
    interiors = _interiors(problem, swept)
    return None if interiors is None else Batch(problem, swept, factors, exceptional, interiors)


def batch(scheme: Scheme, values: Mapping[str, Fraction], name: str, points: Sequence[Point]) -> BatchSet | None:
    """The stable sets at the points of a sweep, None where the scheme is not of the kind this route is for."""
    ready = prepared(scheme, values, name, samples(points))
    return None if ready is None else ready.at(points)


def _at_some_point(
    scheme: Scheme, values: Mapping[str, Fraction], name: str, points: Sequence[Point]
) -> NormalModeProblem | None:
    """The problem with the parameter and lam as symbols; None where no point gives a scheme."""
    for value in points:
        try:
            return normal_mode_problem(scheme, {**values, name: Fraction(value)}, (name, scheme.cfl))
        except InputError:
            continue
    return None


def _applies(problem: NormalModeProblem) -> bool:
    """One clock, separate fields without lam, all spatial sheets on the decaying side, nothing irrational."""
    method = problem.resolvent.integrator
    if problem.variable != "s" or method is None or method.kind == "exact" or problem.coefficients.generators:
        return False
    if problem.coupled:
        return False
    if holds_lam(field_symbols(problem), problem):
        return False  # upwinding, and the Cauchy set at unit speed, take a speed that stands
    return all(family.decaying in (0, family.degree) for family in problem.families)


def _double_double(points: Sequence[Point]) -> Real:
    """The values as double-double: nan where a double cannot hold them."""
    exact = [k for k, p in enumerate(points) if type(p) is not float]
    high, low = np.empty(len(points)), np.zeros(len(points))
    if len(exact) < len(points):
        high[:] = np.fromiter((p if type(p) is float else 0.0 for p in points), float, len(points))
    for k in exact:
        value = Fraction(points[k])
        double = to_double(value)
        if double is None:
            high[k] = np.nan
        else:
            above, below = double.as_integer_ratio()
            rest = value.numerator * below - above * value.denominator
            high[k], low[k] = double, rest / (value.denominator * below)
    return Real(high, low)


# Closure --------------------------------------------------------------------------------------------------------------


def _closure(problem: NormalModeProblem, factor: fmpz_mpoly, swept: str, parameter: Real) -> Intervals:
    """The lam at which every z of every root s of one irreducible factor is inside the circle."""
    method = problem.resolvent.integrator
    assert method is not None
    parts = [_at(part, swept, parameter) for part in powers_of(factor, "s")]
    found = roots(
        np.stack([value.hi for value, _ in parts], axis=1),
        np.stack([value.lo for value, _ in parts], axis=1),
        error=np.stack([error for _, error in parts], axis=1),
    )
    result = everything(len(parameter.hi))
    # Coefficients are real: a disk that meets the real axis holds its root's conjugate, so its root is real; the others
    # come in conjugate pairs with the same limits, and those below the axis at every point are passed over.
    real = np.abs(found.hi.imag + found.lo.imag) <= found.radius * np.abs(found.hi)
    height = np.where(real, 0.0, found.hi.imag)
    order = np.argsort(-height, axis=1, kind="stable")
    height, hi, lo, radius, on_axis = (
        np.take_along_axis(each, order, axis=1) for each in (height, found.hi, found.lo, found.radius, real)
    )
    # Where one lies below the axis, the highest root stands for it: what is found at a point is its own alone.
    below = height < 0
    hi, lo, radius, on_axis = (np.where(below, each[:, :1], each) for each in (hi, lo, radius, on_axis))
    for k in range(hi.shape[1]):
        if below[:, k].all():
            break
        imaginary = Real(np.where(on_axis[:, k], 0.0, hi[:, k].imag), np.where(on_axis[:, k], 0.0, lo[:, k].imag))
        mine = stable_intervals(method, Real(hi[:, k].real.copy(), lo[:, k].real.copy()), imaginary, radius[:, k])
        result = intersect(result, mine)
    result.resolved[:] &= found.resolved
    return result


def _at(polynomial: fmpz_mpoly, swept: str, parameter: Real) -> tuple[Real, Array]:
    """A polynomial in the swept parameter, at all points, with a bound of the absolute error.

    Horner's rule in double-double: every step adds at most 16 u**2 of the sum of absolute values, which is run beside
    it.
    """
    zero = np.zeros_like(parameter.hi)
    total, size = Real(zero, zero), zero
    parts = powers_of(polynomial, swept)
    for part in reversed(parts):
        constant = int(part.leading_coefficient()) if not part.is_zero() else 0
        high = _nearest(constant)
        total = total * parameter + Real(zero + high, zero + _nearest(constant - int(high) if np.isfinite(high) else 0))
        size = size * np.abs(parameter.hi) + abs(high)
    unsafe = (size > 2.0**SAFE_BITS) | ((size < 2.0**-SAFE_BITS) & (size > 0))
    error = size * (16.0 * UNIT**2 * (2 * len(parts) + 1))
    return Real(np.where(unsafe, np.nan, total.hi), total.lo), error


def _nearest(value: int) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf")


# Interior -------------------------------------------------------------------------------------------------------------


def _interiors(problem: NormalModeProblem, swept: str) -> tuple[_Interior, ...] | None:
    """The Cauchy sets of all fields; None where one depends on the parameter in more than its speed."""
    found: list[_Interior] = []
    seen: set[str] = set()
    for block in problem.blocks:
        symbol = field_symbol(block.field, problem.coefficients)
        if str(symbol) in seen:
            continue
        seen.add(str(symbol))
        if not degree_in(symbol, swept):
            found.append(_Interior(_cauchy(problem, symbol), None))
            continue
        unit = _unit_symbol(problem, block.field)
        if unit is None:
            return None
        found.append(_Interior(_cauchy(problem, unit), block.field.speed))
    return tuple(found)


def _in_lam(interior: _Interior, swept: str, parameter: Real) -> Intervals:
    """The Cauchy-stable lam of one field."""
    if interior.speed is None:
        one = np.ones_like(parameter.hi)
        return _scaled(interior.limits, Real(one, 0 * one))
    top, top_error = _at(interior.speed.num, swept, parameter)
    bottom, bottom_error = _at(interior.speed.den, swept, parameter)
    result = _scaled(interior.limits, Real(np.abs(top.hi / bottom.hi), np.zeros_like(top.hi)))
    result.resolved[:] &= top_error + np.abs(top.hi) * UNIT <= 4 * UNIT * np.abs(top.hi)
    result.resolved[:] &= bottom_error <= UNIT * np.abs(bottom.hi)
    return result


def _cauchy(problem: NormalModeProblem, symbol: fmpz_mpoly) -> CauchySet:
    polynomial = amplification(symbol, problem.coefficients, problem.resolvent)
    return cauchy_set(polynomial, kappa="x", lam=problem.coefficients.variable(problem.resolvent.cfl))


def _unit_symbol(problem: NormalModeProblem, field: Field) -> fmpz_mpoly | None:
    """The symbol of a named operator at speed 1 or -1: lam enters only as lam times the speed."""
    half_line = problem.scheme.half_line(field.domain)
    if not isinstance(half_line.interior, NamedLines) or field.speed is None:
        return None
    sign = problem.coefficients.sign(field.speed)
    unit = unit_lines(half_line, problem.coefficients, sign, problem.resolvent)
    return field_symbol(unit, problem.coefficients)


def _scaled(limits: CauchySet, speed: Real) -> Intervals:
    """The set in lam = nu / speed. Ends carry the rounding of the end itself, of the speed and of the quotient."""
    points = len(speed.hi)
    width = max(len(limits.intervals), 1)
    shape = (points, width)
    result = Intervals(
        np.full(shape, np.nan), np.full(shape, np.nan), np.zeros(shape), np.zeros(shape),
        np.full(points, len(limits.intervals), np.int64), np.ones(points, bool),
    )  # fmt: skip
    for k, interval in enumerate(limits.intervals):
        for ends, errors, end in (
            (result.lo, result.lo_error, interval.low),
            (result.hi, result.hi_error, interval.high),
        ):
            value = _double(end)
            exact = np.full(points, value in (0.0, float("inf")))
            if end is not None and not exact.any() and end.rational == Fraction(value):
                exact = speed.hi == 1.0
            ends[:, k] = value / speed.hi
            errors[:, k] = np.where(exact, 0.0, 8 * UNIT)
    return result


def _double(end: Root | None) -> float:
    return float("inf") if end is None else float(close_to(end))


def _same_signs(problem: NormalModeProblem, swept: str, parameter: Real) -> NDArray[np.bool_]:
    """Where every speed has the sign it has at the sample: elsewhere the upwinding is another one."""
    good = np.ones(len(parameter.hi), bool)
    coefficients: Coefficients = problem.coefficients
    for block in problem.blocks:
        speed = block.field.speed
        if speed is None or not (degree_in(speed.num, swept) or degree_in(speed.den, swept)):
            continue
        top, top_error = _at(speed.num, swept, parameter)
        bottom, bottom_error = _at(speed.den, swept, parameter)
        certain = (np.abs(top.hi) > 2 * top_error) & (np.abs(bottom.hi) > 2 * bottom_error)
        good &= certain & (np.sign(top.hi) * np.sign(bottom.hi) == coefficients.sign(speed))
    return good
