"""Algebraic numbers as isolated roots: which number it is, and on which side of the circle and of the axis, exactly."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import ctx, fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.algebraic import Isolation, Position, Root, Side, factored_roots, isolated_roots, reciprocal
from gks.modes.numerals import midpoint
from tests.examples import examples

x = fmpz_poly([0, 1])
TINY = 10**300

fractions = st.fractions(min_value=-4, max_value=4, max_denominator=9)


def linear(value: Fraction) -> fmpz_poly:
    return value.denominator * x - value.numerator


def pair(re: Fraction, im: Fraction) -> fmpz_poly:
    """Integer multiple of (x - re - i im)(x - re + i im)."""
    clear = (re.denominator * im.denominator) ** 2
    norm = re * re + im * im
    return fmpz_poly([int(clear * norm), int(-2 * clear * re), clear])


def only(poly: fmpz_poly, near: complex) -> Root:
    return min(isolated_roots(poly), key=lambda root: abs(complex(root) - near))


class TestIsolation:
    @given(st.sets(fractions, min_size=1, max_size=5), st.integers(1, 3))
    def test_rational_roots_are_found_as_fractions_ascending(self, values: set[Fraction], power: int) -> None:
        poly = fmpz_poly([1])
        for value in values:
            poly *= linear(value) ** power
        assert [root.rational for root in isolated_roots(poly)] == sorted(values)
        assert sorted((root.rational, m) for root, m in factored_roots(poly)) == [(v, power) for v in sorted(values)]

    @given(st.lists(st.integers(-9, 9), min_size=3, max_size=9).filter(lambda c: c[-1] != 0))
    @examples(40)
    def test_balls_are_disjoint_shrink_and_keep_their_root(self, coefficients: list[int]) -> None:
        roots = isolated_roots(fmpz_poly(coefficients))
        coarse = [root.ball(30) for root in roots]
        fine = [root.ball(500) for root in roots]
        assert all(ball.rel_accuracy_bits() >= 500 for ball in fine)
        assert all(a.overlaps(b) == (i == j) for i, a in enumerate(coarse) for j, b in enumerate(fine))
        with ctx.workprec(600):
            assert all(root.poly(ball).contains(0) for root, ball in zip(roots, fine, strict=True))

    def test_real_roots_have_no_imaginary_part_at_all(self) -> None:
        assert [root.is_real for root in isolated_roots(x**4 - 2)] == [True, True, False, False]
        assert isolated_roots(x**4 - 2)[0].ball().imag == 0

    def test_the_zero_polynomial_is_refused(self) -> None:
        with pytest.raises(ValueError, match="zero polynomial"):
            isolated_roots(fmpz_poly([]))

    def test_precision_is_restored(self) -> None:
        before = ctx.prec
        isolated_roots(x**5 - x - 1)[0].ball(1000)
        assert ctx.prec == before


class TestPosition:
    @given(st.fractions(min_value=-5, max_value=5, max_denominator=20), st.fractions(max_denominator=9))
    def test_pythagorean_points_are_on_the_circle_and_their_neighbours_are_not(
        self, t: Fraction, other: Fraction
    ) -> None:
        re, im = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        factor = pair(re, im) if im else linear(re)
        poly = factor * linear(other)
        on = {root.position for root in isolated_roots(poly) if abs(complex(root) - complex(re, abs(im))) < 1e-12}
        assert Position.ON in on

    @given(fractions, fractions)
    def test_agrees_with_the_modulus(self, re: Fraction, im: Fraction) -> None:
        poly = pair(re, im) if im else linear(re)
        square = re * re + im * im
        expected = Position.ON if square == 1 else Position.INSIDE if square < 1 else Position.OUTSIDE
        assert {root.position for root in isolated_roots(poly)} == {expected}

    @pytest.mark.parametrize(("offset", "expected"), [(1, Position.OUTSIDE), (0, Position.ON), (-1, Position.INSIDE)])
    def test_a_distance_of_1e_minus_300_counts(self, offset: int, expected: Position) -> None:
        assert Root.of(Fraction(TINY + offset, TINY)).position is expected
        assert Root.of(-Fraction(TINY + offset, TINY)).position is expected

    def test_a_reciprocal_pair_off_the_circle_is_not_on_it(self) -> None:
        # gcd(p, p*) is all of p here, so only the balls of the images tell a pair r, 1/r from a point of the circle.
        golden = x**2 - 3 * x + 1
        assert [root.position for root in isolated_roots(golden)] == [Position.INSIDE, Position.OUTSIDE]
        lehmer = fmpz_poly([1, 1, 0, -1, -1, -1, -1, -1, 0, 1, 1])
        positions = [root.position for root in isolated_roots(lehmer)]
        assert (positions.count(Position.INSIDE), positions.count(Position.OUTSIDE)) == (1, 1)
        assert positions.count(Position.ON) == 8

    @pytest.mark.parametrize("n", [1, 2, 5, 12])
    def test_roots_of_unity(self, n: int) -> None:
        assert {root.position for root in isolated_roots((x**n - 1) * (x - 3))} == {Position.ON, Position.OUTSIDE}
        assert sum(root.position is Position.ON for root in isolated_roots((x**n - 1) * (x - 3))) == n

    @given(st.lists(st.integers(-9, 9), min_size=2, max_size=7).filter(lambda c: c[0] != 0 and c[-1] != 0))
    @examples(40)
    def test_inversion_swaps_inside_and_outside(self, coefficients: list[int]) -> None:
        poly = fmpz_poly(coefficients)
        here = [root.position.value for root in isolated_roots(poly)]
        there = [root.position.value for root in isolated_roots(reciprocal(poly))]
        assert sorted(here) == sorted(-value for value in there)


class TestSide:
    @given(fractions, fractions)
    def test_agrees_with_the_real_part(self, re: Fraction, im: Fraction) -> None:
        poly = pair(re, im) if im else linear(re)
        expected = Side.AXIS if re == 0 else Side.LEFT if re < 0 else Side.RIGHT
        assert {root.side for root in isolated_roots(poly)} == {expected}

    def test_zero_and_opposite_pairs(self) -> None:
        assert Root.of(0).side is Side.AXIS
        assert [root.side for root in isolated_roots(x**2 - 2)] == [Side.LEFT, Side.RIGHT]

    def test_a_real_part_of_1e_minus_300_counts(self) -> None:
        sides = {root.side for root in isolated_roots(pair(Fraction(-1, TINY), Fraction(1)))}
        assert sides == {Side.LEFT}


class TestNumber:
    def test_rational_only_where_it_is(self) -> None:
        assert only(2 * x**2 - 3 * x - 2, 2).rational == 2
        assert only(2 * x**2 - 3 * x - 2, -0.5).rational == Fraction(-1, 2)
        assert only(x**2 - 2, 1.4).rational is None
        assert only(x**2 + 1, 1j).rational is None
        close = (TINY * x - 1) * (TINY * TINY * x**2 - 2)
        assert [root.rational for root in isolated_roots(close)] == [None, Fraction(1, TINY), None]

    def test_the_same_number_from_two_polynomials(self) -> None:
        one, other = only((x**2 - 2) * (x - 7), 1.41), only((x**2 - 2) * (x**2 + 1), 1.41)
        assert one == other
        assert hash(one) == hash(other)
        assert one.minimal.poly == x**2 - 2
        assert one != only(x**2 - 2, -1.41)
        assert one != only(TINY * (x**2 - 2) - 1, 1.41)

    @given(fractions, fractions)
    def test_order_of_rationals(self, a: Fraction, b: Fraction) -> None:
        assert (Root.of(a) < Root.of(b)) == (a < b)
        assert (Root.of(a) >= Root.of(b)) == (a >= b)

    def test_order_of_close_irrationals_and_none_for_complex_numbers(self) -> None:
        root_two = only(x**2 - 2, 1.41)
        assert root_two < only(TINY * (x**2 - 2) - 1, 1.41)
        with pytest.raises(ValueError, match="only real"):
            _ = root_two < only(x**2 + 1, 1j)

    def test_a_ball_of_a_fraction(self) -> None:
        ball = Root.of(Fraction(1, 3)).ball(150)
        with ctx.workprec(200):
            assert (3 * ball).contains(1)
        assert ball.rel_accuracy_bits() >= 150


def test_a_ball_depends_on_the_number_and_the_precision_alone() -> None:
    """Isolations are shared: what was asked before must not show in the digits of what is asked now."""
    poly = fmpz_poly([-7, 3, 0, -2, 0, 5])
    for asked in ([80], [1000, 80], [80, 300, 80], [129, 64, 80]):
        fresh = Isolation(poly)
        for bits in asked:
            found = [fresh.ball(k, bits) for k in range(len(fresh))]
            together = fresh.balls(bits)
        expected = Isolation(poly)
        again = [expected.ball(k, asked[-1]) for k in range(len(expected))]
        assert [midpoint(ball) for ball in found] == [midpoint(ball) for ball in again]
        assert [midpoint(ball) for ball in together] == [midpoint(ball) for ball in expected.balls(asked[-1])]
