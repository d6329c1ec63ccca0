"""Double-double numbers on numpy arrays: an unevaluated sum hi + lo of two doubles, about 31 digits.

What the batched root finder and the ray maps need and no more: sums, products, quotients, real and complex. The
algorithms are the classical error-free transformations (Dekker, Numer. Math. 18 (1971) 224-242; Knuth's two-sum) and
the double-word operations analysed by Joldes, Muller & Popescu, ACM Trans. Math. Softw. 44 (2017) 15res. numpy has no
fused multiply-add, so products are split by Dekker's constant, and operands must stay below 2**995: callers scale by
powers of two. Errors, with u = 2**-53 and in absolute value:

- add, sub: at most 3 u**2 (|a| + |b|)
- mul: at most 8 u**2 |a b|
- div: at most 16 u**2 |a / b|
- sqrt: at most 16 u**2 of the root

as long as nothing underflows (a product below 2**-968 loses its low part).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

UNIT = 2.0**-53
"""u, half the spacing of the doubles at 1."""

_SPLITTER = 2.0**27 + 1.0


def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """s + e = a + b exactly, s = fl(a + b)."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


def _fast_two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """The same where |a| >= |b|, or a = 0."""
    s = a + b
    return s, b - (s - a)


def split(a: Array) -> tuple[Array, Array]:
    """a = head + tail exactly, each of at most 26 bits."""
    t = _SPLITTER * a
    head = t - (t - a)
    return head, a - head


def two_prod(a: Array, b: Array) -> tuple[Array, Array]:
    """p + e = a b exactly, p = fl(a b)."""
    return _product(a, b, split(a), split(b))


def _product(a: Array, b: Array, a_split: tuple[Array, Array], b_split: tuple[Array, Array]) -> tuple[Array, Array]:
    (a_head, a_tail), (b_head, b_tail), p = a_split, b_split, a * b
    return p, ((a_head * b_head - p) + a_head * b_tail + a_tail * b_head) + a_tail * b_tail


@dataclass(frozen=True, slots=True)
class Real:
    """hi + lo, |lo| <= u |hi|; arrays that broadcast."""

    hi: Array
    lo: Array

    def __add__(self, other: Real) -> Real:
        s, e = two_sum(self.hi, other.hi)
        return Real(*_fast_two_sum(s, e + (self.lo + other.lo)))

    def __sub__(self, other: Real) -> Real:
        return self + (-other)

    def __neg__(self) -> Real:
        return Real(-self.hi, -self.lo)

    def __mul__(self, other: Real) -> Real:
        p, e = two_prod(self.hi, other.hi)
        return Real(*_fast_two_sum(p, e + (self.hi * other.lo + self.lo * other.hi)))

    def __truediv__(self, other: Real) -> Real:
        first = self.hi / other.hi
        rest = self - other * Real(first, np.zeros_like(first))
        return Real(*_fast_two_sum(first, (rest.hi + rest.lo) / other.hi))

    def sqrt(self) -> Real:
        """Of a positive number: one Newton step from the root in doubles, with the exact residual."""
        root = np.sqrt(self.hi)
        square, low = two_prod(root, root)
        return Real(*_fast_two_sum(root, ((self.hi - square) - low + self.lo) / (2 * root)))

    def times(self, power_of_two: Array) -> Real:
        """Exact scaling (short of under- and overflow)."""
        return Real(self.hi * power_of_two, self.lo * power_of_two)

    def take(self, index: Any) -> Real:
        return Real(self.hi[index], self.lo[index])


@dataclass(frozen=True, slots=True)
class Complex:
    """re + i im. A product of complex numbers errs by at most 20 u**2 |a b|, a quotient by at most 64 u**2 |a / b|."""

    re: Real
    im: Real

    @classmethod
    def of(cls, hi: NDArray[Any], lo: NDArray[Any] | None = None) -> Complex:
        """From complex (or real) arrays hi + lo; the parts are normalised."""
        low = np.zeros_like(hi) if lo is None else lo
        return cls(
            Real(*two_sum(np.asarray(hi.real, float), np.asarray(low.real, float))),
            Real(*two_sum(np.asarray(hi.imag, float), np.asarray(low.imag, float))),
        )

    @property
    def hi(self) -> ComplexArray:
        """Rounded to double."""
        return _join(self.re.hi, self.im.hi)

    @property
    def lo(self) -> ComplexArray:
        """What rounding to double leaves."""
        return _join(self.re.lo, self.im.lo)

    def __add__(self, other: Complex) -> Complex:
        return Complex(self.re + other.re, self.im + other.im)

    def __sub__(self, other: Complex) -> Complex:
        return Complex(self.re - other.re, self.im - other.im)

    def __mul__(self, other: Complex) -> Complex:
        """Each part is two exact products, one exact sum, and all that is small added up at the end."""
        a, b, c, d = self.re, self.im, other.re, other.im
        splits = split(a.hi), split(b.hi), split(c.hi), split(d.hi)
        ac, ac_low = _product(a.hi, c.hi, splits[0], splits[2])
        bd, bd_low = _product(b.hi, d.hi, splits[1], splits[3])
        ad, ad_low = _product(a.hi, d.hi, splits[0], splits[3])
        bc, bc_low = _product(b.hi, c.hi, splits[1], splits[2])
        re, re_low = two_sum(ac, -bd)
        im, im_low = two_sum(ad, bc)
        re_low += ac_low - bd_low
        re_low += (a.hi * c.lo + a.lo * c.hi) - (b.hi * d.lo + b.lo * d.hi)
        im_low += ad_low + bc_low
        im_low += (a.hi * d.lo + a.lo * d.hi) + (b.hi * c.lo + b.lo * c.hi)
        return Complex(Real(*_fast_two_sum(re, re_low)), Real(*_fast_two_sum(im, im_low)))

    def __truediv__(self, other: Complex) -> Complex:
        """self conj(other) / |other|**2: operands must be of moderate size (their squares are formed)."""
        product = self * other.conjugate()
        square = other.norm()
        return Complex(product.re / square, product.im / square)

    def conjugate(self) -> Complex:
        return Complex(self.re, -self.im)

    def norm(self) -> Real:
        """re**2 + im**2."""
        return self.re * self.re + self.im * self.im

    def times(self, power_of_two: Array) -> Complex:
        """Exact scaling (short of under- and overflow)."""
        return Complex(self.re.times(power_of_two), self.im.times(power_of_two))

    def take(self, index: Any) -> Complex:
        return Complex(self.re.take(index), self.im.take(index))


def _join(re: Array, im: Array) -> ComplexArray:
    result = np.empty(np.broadcast_shapes(re.shape, im.shape), complex)
    result.real, result.imag = re, im
    return result
