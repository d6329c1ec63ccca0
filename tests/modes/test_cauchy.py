"""Cauchy stability at given parameters: the classical verdicts, the reasons, and 300 digits on either side."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, fmpz_mpoly, fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.algebraic import Position, Root, isolated_roots
from gks.modes.cauchy import (
    Instability,
    cauchy_stable,
    reciprocal_in,
    schur_stable,
    semi_discrete_stable,
    stable_as_limit,
)
from gks.modes.fibre import VanishesIdentically, fibre, specialise
from tests.examples import examples
from tests.modes.schemes import CONTEXT, discrete, kappa, lam, lines, s, symbol, z
from tests.oracle.wave_numbers import largest_modulus

TINY = Fraction(1, 10**300)


def verdict(poly: fmpz_mpoly, number: Fraction | int) -> Instability | None:
    result = cauchy_stable(poly, {"lam": Root.of(Fraction(number))})
    assert result.stable is (result.reason is None)
    return result.reason


class TestClassicalVerdicts:
    def test_leapfrog_loses_its_limit_to_a_double_root(self) -> None:
        poly = lines("central2", "leapfrog")
        assert verdict(poly, 1 - TINY) is None
        assert verdict(poly, 1) is Instability.DOUBLE_ROOT
        assert verdict(poly, 1 + TINY) is Instability.GROWING
        witness = cauchy_stable(poly, {"lam": Root.of(1)})
        assert witness.kappa == isolated_roots(fmpz_poly([1, 0, 1]))[0]

    @pytest.mark.parametrize("name", ["lax-wendroff", "lax-friedrichs", "fromm"])
    def test_one_step_schemes_keep_theirs(self, name: str) -> None:
        poly = discrete(name)
        assert verdict(poly, TINY) is None
        assert verdict(poly, 1) is None
        assert verdict(poly, 1 + TINY) is Instability.GROWING

    def test_beam_warming_reaches_two(self) -> None:
        assert verdict(discrete("beam-warming"), 2) is None
        assert verdict(discrete("beam-warming"), 2 + TINY) is Instability.GROWING

    @pytest.mark.parametrize("time", ["backward-euler", "crank-nicolson", "bdf2"])
    @pytest.mark.parametrize("number", [TINY, 1, 1 / TINY])
    def test_a_stable_methods_are_unconditional(self, time: str, number: Fraction) -> None:
        assert verdict(lines("central2", time), number) is None

    @pytest.mark.parametrize("time", ["forward-euler", "rk2", "ab2"])
    def test_central_differences_with_no_imaginary_axis_never(self, time: str) -> None:
        assert verdict(lines("central2", time), Fraction(1, 10**6)) is Instability.GROWING

    def test_an_irrational_limit_belongs_to_rk4(self) -> None:
        edge = isolated_roots(fmpz_poly([-8, 0, 1]))[1]
        assert cauchy_stable(lines("central2", "rk4"), {"lam": edge}).stable
        just_above = isolated_roots(fmpz_poly([-8 * 10**100 - 1, 0, 10**100]))[1]
        assert not cauchy_stable(lines("central2", "rk4"), {"lam": just_above}).stable

    def test_a_field_of_speed_zero_stands_still(self) -> None:
        assert cauchy_stable(z - 1).stable
        assert cauchy_stable(z**2 - 1).stable
        assert cauchy_stable((z - 1) ** 2).reason is Instability.DOUBLE_ROOT


class TestReasons:
    def test_an_unsolvable_implicit_scheme(self) -> None:
        # (kappa + 1/kappa)/2 * u(n+1) = u(n): the left side is zero for kappa = i.
        result = cauchy_stable(z * (kappa**2 + 1) - 2 * kappa)
        assert result.reason in {Instability.LEADING_COEFFICIENT, Instability.GROWING}
        vanishing = cauchy_stable((kappa + 1) * (2 * z - 1))
        assert vanishing.reason is Instability.LEADING_COEFFICIENT
        assert vanishing.kappa == Root.of(-1)

    def test_the_newest_level_drops_out_at_one_lam(self) -> None:
        poly = (lam - 1) * z**2 + 2 * z - 1
        assert verdict(poly, 1) is Instability.LEADING_COEFFICIENT

    def test_two_factors_that_meet_on_the_circle(self) -> None:
        assert cauchy_stable((z - kappa) * (z - 1)).reason is Instability.DOUBLE_ROOT
        assert cauchy_stable((2 * z - 1) ** 3 * (z - 1)).stable

    def test_a_double_root_at_one_wave_number_only(self) -> None:
        # Roots 1 and (1 + kappa)/2 meet at kappa = 1.
        result = cauchy_stable((z - 1) * (2 * z - 1 - kappa))
        assert result.reason is Instability.DOUBLE_ROOT
        assert result.kappa == Root.of(1)

    def test_factors_without_z_or_zero_at_the_point(self) -> None:
        with pytest.raises(ValueError, match="polynomial in z"):
            cauchy_stable(kappa - 2)
        with pytest.raises(VanishesIdentically):
            cauchy_stable((lam - 1) * (z - kappa), {"lam": Root.of(1)})
        assert cauchy_stable((kappa - 2) * (z - kappa)).stable

    def test_the_witness_is_a_root(self) -> None:
        poly = lines("upwind3", "ab3")
        result = cauchy_stable(poly, {"lam": Root.of(1)})
        assert result.kappa is not None
        assert result.z is not None
        assert result.kappa.position is Position.ON
        assert result.z.position is Position.OUTSIDE
        at_one = specialise(poly, {"lam": Fraction(1)})
        assert result.z in [each.root for each in fibre({"kappa": result.kappa}, at_one, "z")]


class TestIrrationalCoefficients:
    def test_a_speed_of_sqrt_two(self) -> None:
        # The generator s serves as the speed; Lax-Wendroff and leapfrog reach lam = 1/sqrt(2), which only one keeps.
        root_two = isolated_roots(fmpz_poly([-2, 0, 1]))[1]
        edge = isolated_roots(fmpz_poly([-1, 0, 2]))[1]
        lax_wendroff = 2 * z * kappa - 2 * kappa + lam * s * (kappa**2 - 1) - lam**2 * s**2 * (kappa - 1) ** 2
        leapfrog = kappa * z**2 + lam * s * (kappa**2 - 1) * z - kappa
        for number in (Fraction(7071, 10**4), Fraction(7072, 10**4)):
            point = {"s": root_two, "lam": Root.of(number)}
            assert cauchy_stable(lax_wendroff, point).stable is (2 * number**2 <= 1)
            assert cauchy_stable(leapfrog, point).stable is (2 * number**2 <= 1)
        assert cauchy_stable(lax_wendroff, {"s": root_two, "lam": edge}).stable
        assert cauchy_stable(leapfrog, {"s": root_two, "lam": edge}).reason is Instability.DOUBLE_ROOT

    def test_a_limit_of_stable_schemes(self) -> None:
        edge = isolated_roots(fmpz_poly([-1, 0, 3]))[1]
        assert stable_as_limit(lines("compact4", "leapfrog"), {"lam": edge}).reason is Instability.DOUBLE_ROOT
        assert stable_as_limit(lines("central4", "crank-nicolson"), {"lam": edge}).stable


class TestSemiDiscrete:
    @pytest.mark.parametrize(
        "space", ["upwind1", "upwind2", "upwind3", "fromm", "central2", "central4", "central6", "compact4"]
    )
    def test_named_operators_do_not_grow(self, space: str) -> None:
        assert semi_discrete_stable(symbol(space)).stable

    def test_the_wrong_side_does(self) -> None:
        assert semi_discrete_stable(s - (kappa - 1)).reason is None
        assert semi_discrete_stable(s - (1 - kappa)).reason is Instability.GROWING

    def test_a_singular_mass(self) -> None:
        # The mean (q[i+1] + 2 q[i] + q[i-1])/4 loses the sawtooth.
        assert semi_discrete_stable(s * (kappa + 1) ** 2 + 2 * (kappa**2 - 1)).reason is Instability.LEADING_COEFFICIENT


coefficients = st.lists(st.integers(-6, 6), min_size=2, max_size=4)


class TestAgainstWaveNumbers:
    @given(coefficients, st.integers(1, 7))
    @examples(60)
    def test_random_one_step_schemes(self, row: list[int], scale: int) -> None:
        self.check(scale * z * kappa - sum((c * kappa**j for j, c in enumerate(row)), CONTEXT.constant(0)))

    @given(coefficients, coefficients, st.integers(1, 7))
    @examples(60)
    def test_random_two_step_schemes(self, one: list[int], two: list[int], scale: int) -> None:
        middle = sum((c * kappa**j for j, c in enumerate(one)), CONTEXT.constant(0))
        oldest = sum((c * kappa**j for j, c in enumerate(two)), CONTEXT.constant(0))
        self.check(scale * z**2 * kappa - z * middle - oldest)

    def check(self, poly: fmpz_mpoly) -> None:
        """A scan sees one wave number in many, and nothing within its own errors of the circle."""
        seen = largest_modulus(poly, {})
        if seen > 1 + 1e-6:
            assert cauchy_stable(poly).reason is Instability.GROWING
        if seen < 1 - 1e-3:
            assert cauchy_stable(poly).stable


def test_reciprocal_inverts_both_variables() -> None:
    assert reciprocal_in(2 * z**2 * kappa + 3 * z - kappa**2, ("z", "kappa")) == 2 * kappa + 3 * z * kappa**2 - z**2


def test_schur_recursion_proves_only_what_is_inside() -> None:
    assert schur_stable([acb(1), acb(0), acb(4)])
    assert schur_stable([acb(1), acb(-4), acb(4)])
    assert not schur_stable([acb(4), acb(0), acb(1)])
    assert not schur_stable([acb(1), acb(1)])
