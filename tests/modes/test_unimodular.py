"""Cutting the unit circle at algebraic points."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.algebraic import Position
from gks.modes.unimodular import arc_samples, by_real_part, circle_point, simplest_between, unimodular_roots

x = fmpz_poly([0, 1])
N = 10**300


def test_the_upper_half_of_the_roots_of_unity_by_angle() -> None:
    found = unimodular_roots((x**6 - 1) * (x - 2) * (x**2 - 3 * x + 1))
    assert [round(complex(root).real, 6) for root in found] == [1, 0.5, -0.5, -1]
    assert all(complex(root).imag >= 0 for root in found)


def test_reciprocal_pairs_off_the_circle_are_not_listed() -> None:
    assert unimodular_roots((x**2 - 3 * x + 1) * (2 * x - 1) * (x - 2)) == []


def test_each_arc_has_its_sample() -> None:
    cuts = unimodular_roots((x**6 - 1) * (5 * x**2 - 6 * x + 5))
    samples = arc_samples(cuts)
    inner = sorted(complex(root).real for root in cuts if not root.is_real)
    assert len(samples) == len(inner) + 1
    assert all(sample.position is Position.ON for sample in samples)
    reals = [complex(sample).real for sample in samples]
    bounds = [-1.0, *inner, 1.0]
    assert sorted(reals) == reals[::-1]
    assert all(low < real < high for low, real, high in zip(bounds, sorted(reals), bounds[1:], strict=False))


def test_an_arc_of_length_1e_minus_300_has_one_too() -> None:
    # Real parts 0 and 1/N: the half-angle tangents differ by about 1/N.
    cuts = unimodular_roots((x**2 + 1) * (N * x**2 - 2 * x + N))
    middle = arc_samples(cuts)[1]
    assert by_real_part([*cuts, middle])[1] == middle


@given(st.fractions(min_value=Fraction(1, 50), max_value=50, max_denominator=50))
def test_circle_points_are_where_the_half_angle_says(t: Fraction) -> None:
    point = complex(circle_point(t))
    assert abs(point - (1 + 1j * float(t)) / (1 - 1j * float(t))) < 1e-12
    assert point.imag > 0


@given(
    st.fractions(min_value=0, max_value=20, max_denominator=300),
    st.fractions(min_value=Fraction(1, 9000), max_value=3, max_denominator=9000),
)
def test_no_fraction_between_is_simpler(low: Fraction, width: Fraction) -> None:
    found = simplest_between(low, low + width)
    assert low < found < low + width
    for denominator in range(1, found.denominator):
        above = Fraction(low.numerator * denominator // low.denominator + 1, denominator)
        assert above >= low + width


@pytest.mark.parametrize(("low", "expected"), [(Fraction(0), 1), (Fraction(5, 2), 3), (Fraction(3), 4)])
def test_up_to_infinity(low: Fraction, expected: int) -> None:
    assert simplest_between(low, None) == expected


def test_a_long_continued_fraction_is_no_recursion() -> None:
    a, b = 1, 1
    for _ in range(3000):
        a, b = a + b, a
    assert (
        simplest_between(Fraction(a, b), Fraction(a + b, a)) > 1
        or simplest_between(Fraction(a + b, a), Fraction(a, b)) > 1
    )
