"""Double-double arithmetic against exact rationals, within the stated multiples of u**2."""

from __future__ import annotations

from fractions import Fraction as F

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.doubledouble import UNIT, Complex, Real, two_prod, two_sum

doubles = st.floats(min_value=-1e60, max_value=1e60).filter(lambda x: x == 0 or abs(x) > 1e-60)
U2 = F(UNIT) ** 2


@st.composite
def numbers(draw: st.DrawFn) -> Real:
    hi = draw(doubles)
    lo = hi * UNIT * draw(st.floats(min_value=-0.999, max_value=0.999))
    return Real(*two_sum(np.array([hi]), np.array([lo])))


def exact(x: Real) -> F:
    return F(float(x.hi[0])) + F(float(x.lo[0]))


@given(doubles, doubles)
def test_sums_and_products_of_doubles_lose_nothing(a: float, b: float) -> None:
    s, e = two_sum(np.array([a]), np.array([b]))
    assert F(float(s[0])) + F(float(e[0])) == F(a) + F(b)
    p, e = two_prod(np.array([a]), np.array([b]))
    assert F(float(p[0])) + F(float(e[0])) == F(a) * F(b)


@given(numbers(), numbers())
def test_real_operations_keep_their_bounds(a: Real, b: Real) -> None:
    x, y = exact(a), exact(b)
    assert abs(exact(a + b) - (x + y)) <= 3 * U2 * (abs(x) + abs(y))
    assert abs(exact(a - b) - (x - y)) <= 3 * U2 * (abs(x) + abs(y))
    assert abs(exact(a * b) - x * y) <= 8 * U2 * abs(x * y)
    if y:
        assert abs(exact(a / b) - x / y) <= 16 * U2 * abs(x / y)


@given(numbers(), numbers(), numbers(), numbers())
def test_complex_operations_keep_their_bounds(a: Real, b: Real, c: Real, d: Real) -> None:
    """(a + i b)(c + i d), also where the two products of a part cancel; bounds are on moduli, compared squared."""
    x, y = (exact(a), exact(b)), (exact(c), exact(d))
    square = (x[0] ** 2 + x[1] ** 2) * (y[0] ** 2 + y[1] ** 2)

    def within(found: Complex, re: F, im: F, bound: int, scale: F) -> bool:
        return (exact(found.re) - re) ** 2 + (exact(found.im) - im) ** 2 <= (bound * U2) ** 2 * scale

    product = Complex(a, b) * Complex(c, d)
    assert within(product, x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0], 20, square)
    norm = y[0] ** 2 + y[1] ** 2
    if norm:
        quotient = Complex(a, b) / Complex(c, d)
        re, im = (x[0] * y[0] + x[1] * y[1]) / norm, (x[1] * y[0] - x[0] * y[1]) / norm
        assert within(quotient, re, im, 64, square / norm**2)


def test_adding_one_exactly_shows_what_double_precision_loses() -> None:
    """r = 1 + 1e-20, s = r - 1: nothing is left of s in doubles."""
    one = Complex.of(np.array([1.0 + 0j]))
    r = Complex.of(np.array([1.0 + 0j]), np.array([1e-20 + 0j]))
    assert (r - one).hi[0] == 1e-20
    assert (1.0 + 1e-20) - 1.0 == 0.0
