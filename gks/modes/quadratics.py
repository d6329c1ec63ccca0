"""The roots of many real polynomials of degree 1 or 2 at once, by their formulas, each in a disk proved to hold it.

In double-double arithmetic, with the sign of the root of the discriminant that nothing cancels under and the other root
from their product (Goldberg, ACM Comput. Surv. 23 (1991) 5-48, section 1.4). The errors of coefficients and of rounding
are carried forward to first order, with a factor for the rest. Where a coefficient or the discriminant is not known to
a quarter of its size, or where squares could leave the doubles, nothing is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.modes.doubledouble import UNIT, Array, ComplexArray, Real

Mask = NDArray[np.bool_]

_KNOWN = 0.25
"""Relative error of an operand below which the bounds of first order hold with the factor _REST: of a quotient of two
such operands, (1 + e) / (1 - f) - 1 <= (e + f) / (1 - f) <= 4/3 (e + f), and a half more for rounding."""

_REST = 1.5

_ROUNDING = 16 * UNIT**2
"""Relative error of a double-double product, quotient or square root, rounded up."""

_DISCRIMINANT = 12 * UNIT**2
"""Rounding error of b**2 - 4 a c relative to b**2 + 4 |a c|: 8 u**2 of the products, 3 u**2 of their difference."""

_ROOT = 0.625
"""sqrt(1 + e) - 1 is below 0.54 e for abs(e) <= 1/4."""

_RANGE = 2.0**300
"""Coefficients between its inverse and this have squares and quotients of squares in double-double."""


@dataclass(frozen=True, slots=True)
class Disks:
    """Roots hi + lo (n, points) and their relative radii; good (points,): where all of that is proved."""

    hi: ComplexArray
    lo: ComplexArray
    radius: Array
    good: Mask


def quadratic_roots(terms: Sequence[Real], errors: Sequence[Array]) -> Disks:
    """The roots of sum_k terms[k] x**k, of degree 1 or 2, ascending moduli; errors bound those of the terms."""
    sizes = [np.abs(each.hi) for each in terms]
    relative = [error / size for error, size in zip(errors, sizes, strict=True)]
    if len(terms) == 2:
        return _linear(terms, sizes, relative)
    discriminant, blur = _discriminant(terms, errors, sizes)
    known = (blur < _KNOWN) & (relative[0] < _KNOWN) & (relative[2] < _KNOWN)
    for size in (sizes[0], np.where(sizes[1] == 0, 1.0, sizes[1]), sizes[2]):
        known &= (size < _RANGE) & (size > 1 / _RANGE)
    shape = (2, len(known))
    zero = np.zeros(shape, complex)
    found = Disks(zero, zero.copy(), np.full(shape, np.inf), np.zeros(len(known), bool))
    for apart, formula in ((discriminant.hi > 0, _real_pair), (discriminant.hi < 0, _conjugate_pair)):
        index = np.flatnonzero(known & apart)
        if len(index):
            formula(
                found, index, [each.take(index) for each in terms], discriminant.take(index), blur[index],
                [error[index] for error in errors],
            )  # fmt: skip
    return found


def _linear(terms: Sequence[Real], sizes: Sequence[Array], relative: Sequence[Array]) -> Disks:
    root = -terms[0] / terms[1]
    radius = _REST * (relative[0] + relative[1]) + _ROUNDING
    good = (relative[0] < _KNOWN) & (relative[1] < _KNOWN)
    for size in sizes:
        good &= (size < _RANGE) & (size > 1 / _RANGE)
    return Disks(root.hi[None].astype(complex), root.lo[None].astype(complex), radius[None], good)


def _discriminant(terms: Sequence[Real], errors: Sequence[Array], sizes: Sequence[Array]) -> tuple[Real, Array]:
    """b**2 - 4 a c and its relative error."""
    c, b, a = terms
    c_error, b_error, a_error = errors
    found = b * b - (a * c).times(np.asarray(4.0))
    rounding = _DISCRIMINANT * (sizes[1] ** 2 + 4 * sizes[2] * sizes[0])
    given = b_error * (2 * sizes[1] + b_error) + 4 * (sizes[2] * c_error + a_error * (sizes[0] + c_error))
    return found, (rounding + given) * (1 + 2.0**-40) / np.abs(found.hi)


def _real_pair(
    found: Disks, index: NDArray[np.intp], terms: Sequence[Real], discriminant: Real, blur: Array,
    errors: Sequence[Array],
) -> None:  # fmt: skip
    """t = -(b ± q) / 2, where b and ± q have one sign; the roots are c / t and t / a."""
    c, b, a = terms
    q = discriminant.sqrt()
    q_error = _ROOT * blur + _ROUNDING
    sign = np.where(b.hi < 0, 1.0, -1.0)
    t = (q + b.times(-sign)).times(sign / 2)
    size = np.abs(b.hi) + q.hi
    t_error = (errors[1] + q_error * q.hi) / size + _ROUNDING
    small, large = c / t, t / a
    radii = (
        _REST * (errors[0] / np.abs(c.hi) + t_error) + _ROUNDING,
        _REST * (t_error + errors[2] / np.abs(a.hi)) + _ROUNDING,
    )
    found.hi[:, index], found.lo[:, index] = (small.hi, large.hi), (small.lo, large.lo)
    found.radius[:, index] = radii
    # Their distance is q / |a|; half of it is left for the errors of q and a.
    disks = radii[0] * np.abs(small.hi) + radii[1] * np.abs(large.hi)
    found.good[index] = (t_error < _KNOWN) & (2 * disks < q.hi / np.abs(a.hi))


def _conjugate_pair(
    found: Disks, index: NDArray[np.intp], terms: Sequence[Real], discriminant: Real, blur: Array,
    errors: Sequence[Array],
) -> None:  # fmt: skip
    """-b / 2a ± i q / 2a."""
    _, b, a = terms
    double = a.times(np.asarray(2.0))
    q = (-discriminant).sqrt()
    re, im = -b / double, q / double
    im = im.times(np.sign(im.hi))
    leading = errors[2] / np.abs(a.hi)
    re_error = np.abs(re.hi) * (_REST * leading + _ROUNDING) + _REST * errors[1] / np.abs(double.hi)
    im_error = im.hi * (_REST * (_ROOT * blur + _ROUNDING + leading) + _ROUNDING)
    disk = re_error + im_error
    for k, sign in enumerate((1.0, -1.0)):
        found.hi[k, index], found.lo[k, index] = re.hi + 1j * (sign * im.hi), re.lo + 1j * (sign * im.lo)
        found.radius[k, index] = disk / np.maximum(np.abs(re.hi), im.hi) * (1 + 2.0**-40)
    found.good[index] = disk < im.hi / 2
