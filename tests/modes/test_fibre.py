"""Polynomials at algebraic points: zero tests, signs, values, and fibres with exact multiplicities."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import fmpz_mpoly_ctx, fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.algebraic import Position, Root, isolated_roots
from gks.modes.fibre import VanishesIdentically, coefficients, fibre, is_zero, norm, sign, specialise, value, vanishes
from tests.examples import examples

context = fmpz_mpoly_ctx.get(("s", "t", "x"), "lex")
s, t, x = context.gens()
u = fmpz_poly([0, 1])


def root(poly: fmpz_poly, near: complex) -> Root:
    return min(isolated_roots(poly), key=lambda each: abs(complex(each) - near))


SQRT2, SQRT3 = root(u**2 - 2, 1.414), root(u**2 - 3, 1.732)
BOTH = {"s": SQRT2, "t": SQRT3}


class TestZero:
    def test_relations_between_the_coordinates(self) -> None:
        assert is_zero(BOTH, s**2 * t**2 - 6)
        assert not is_zero(BOTH, s * t + 6)
        assert is_zero({"s": SQRT2, "t": SQRT2}, s - t)
        assert not is_zero({"s": SQRT2, "t": root(u**2 - 2, -1.414)}, s - t)

    def test_almost_zero_is_not_zero(self) -> None:
        # The convergents of sqrt(2) satisfy p**2 - 2 q**2 = +-1, so this value is about 1e-306.
        p, q = 1, 1
        while q < 10**153:
            p, q = p + 2 * q, p + q
        assert not is_zero({"s": SQRT2}, q * s - p)
        assert sign({"s": SQRT2}, q * s - p) == (1 if 2 * q * q > p * p else -1)
        assert sign(BOTH, (q * s - p) * t) == sign({"s": SQRT2}, q * s - p)

    def test_vanishing_for_all_values_of_the_rest(self) -> None:
        assert vanishes({"s": SQRT2}, (s**2 - 2) * (t + x))
        assert not vanishes({"s": SQRT2}, (s**2 - 2) * t + (s - 1) * x)

    def test_a_sign_needs_real_coordinates(self) -> None:
        with pytest.raises(ValueError, match="real"):
            sign({"s": root(u**2 + 1, 1j)}, s)

    @given(st.fractions(max_denominator=50), st.fractions(max_denominator=50))
    def test_rational_points(self, a: Fraction, b: Fraction) -> None:
        point = {"s": Root.of(a), "t": Root.of(b)}
        exact = a * a * b - b + 3 * a
        assert sign(point, s**2 * t - t + 3 * s) == (exact > 0) - (exact < 0)
        assert value(point, s**2 * t - t + 3 * s).rational == exact


class TestValue:
    def test_sums_and_quotients(self) -> None:
        assert value(BOTH, s + t) == root(u**4 - 10 * u**2 + 1, 3.146)
        assert value(BOTH, s, t) == root(3 * u**2 - 2, 0.816)
        assert value(BOTH, s * t, s * t).rational == 1

    def test_division_by_a_hidden_zero(self) -> None:
        with pytest.raises(ZeroDivisionError):
            value(BOTH, s, s**2 * t**2 - 6)


class TestFibre:
    def test_multiplicities_at_irrational_points(self) -> None:
        found = fibre(BOTH, (x - s) ** 2 * (x - t) * (x + s * t) * x**3, "x")
        assert sorted((round(complex(each.root).real, 3), each.multiplicity) for each in found) == [
            (-2.449, 1),
            (0.0, 3),
            (1.414, 2),
            (1.732, 1),
        ]

    def test_the_degree_may_drop_at_the_point(self) -> None:
        (only,) = fibre(BOTH, (s**2 - 2) * x**3 + (x - s) ** 2, "x")
        assert (only.root, only.multiplicity) == (SQRT2, 2)
        assert fibre(BOTH, (s**2 - 2) * x + 1, "x") == []

    def test_conjugate_points_do_not_interfere(self) -> None:
        # At s = -sqrt(2) the first factor is zero for every x; at s = sqrt(2) it is 2 sqrt(2) x.
        twin = {"s": SQRT2, "t": SQRT2}
        (only,) = fibre(twin, (s + t) * x - 1, "x")
        assert only.root == root(8 * u**2 - 1, 0.354)

    def test_zero_for_every_x(self) -> None:
        with pytest.raises(VanishesIdentically):
            fibre({"s": SQRT2, "t": SQRT2}, (s - t) * x**2 + (s**2 - 2) * x, "x")
        with pytest.raises(VanishesIdentically):
            fibre({"s": Root.of(2), "t": Root.of(0)}, (s - 2) * x + t, "x")

    def test_exact_position_on_the_circle(self) -> None:
        # x**2 - sqrt(2) x + 1 has the eighth roots of unity exp(+-i pi/4).
        positions = [each.position for each in fibre({"s": SQRT2}, x**2 - s * x + 1, "x")]
        assert positions == [Position.ON, Position.ON]
        shifted = [each.position for each in fibre({"s": SQRT2}, 10**300 * (x**2 - s * x + 1) + 1, "x")]
        assert shifted == [Position.OUTSIDE, Position.OUTSIDE]

    @given(
        st.lists(
            st.tuples(st.fractions(max_denominator=6), st.integers(1, 3)),
            min_size=1,
            max_size=3,
            unique_by=lambda p: p[0],
        )
    )
    @examples(30)
    def test_prescribed_roots_shifted_by_an_irrational(self, prescribed: list[tuple[Fraction, int]]) -> None:
        poly = context.constant(1)
        for number, multiplicity in prescribed:
            poly *= (number.denominator * (x - s) - number.numerator) ** multiplicity
        found = fibre({"s": SQRT2}, poly, "x")
        expected = {
            value({"s": SQRT2}, n.denominator * s + n.numerator, context.constant(n.denominator)): m
            for n, m in prescribed
        }
        assert {each.root: each.multiplicity for each in found} == expected


def test_norms_hold_the_polynomial_and_are_never_zero() -> None:
    point = {"s": SQRT2, "t": SQRT2}
    assert norm(point, (s + t) * x - 1) == 1 - 8 * x**2
    # Two of the four conjugate points make s + t zero; what is left is still a multiple of 2 sqrt(2) x.
    assert norm(point, (s + t) * x) == x**4
    assert norm({"s": SQRT2}, x - s) == x**2 - 2


@given(st.fractions(max_denominator=50))
def test_specialising_keeps_sign_and_drops_the_variable(a: Fraction) -> None:
    poly = specialise(s**2 * x - 3 * s + t, {"s": a})
    scale = a.denominator**2
    assert poly == int(scale * a * a) * x - int(3 * scale * a) + scale * t
    assert [str(c) for c in coefficients(poly, "t")][1] == str(scale)
