"""Coefficients at given values: rounded once, and a flux split by the signs of its speeds."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.errors import NotAnalysable
from gks.scheme.expression import number, sqrt, symbol
from gks.solvers.coefficients import balanced, discrete_blocks, evaluate, matrix_function, space_blocks


def positive_part(speed: float) -> float:
    return max(speed, 0.0)


def negative_part(speed: float) -> float:
    return min(speed, 0.0)


def test_rational_formulas_are_rounded_once() -> None:
    x = symbol("x")
    assert evaluate((x + number(1)) - x, {"x": Fraction(10) ** 30}) == 1.0


def test_irrational_roots_survive_cancellation() -> None:
    """sqrt(x**2 + 1) - x is 1/(2x) at large x, where doubles would give 0."""
    x = symbol("x")
    formula = sqrt(x**2 + number(1)) - x
    assert evaluate(formula, {"x": Fraction(10) ** 12}) == pytest.approx(5e-13, rel=1e-12)


@pytest.mark.parametrize("exponent", [0, 10, -10, 150, -150, 300, -300])
def test_acoustic_flux_is_split_exactly_however_unequal_its_entries(exponent: int) -> None:
    alpha = 10.0**exponent
    flux = np.array([[0.0, -1 / alpha], [-alpha, 0.0]])
    plus, minus = matrix_function(flux, [positive_part, negative_part])
    expected = np.array([[0.5, -0.5 / alpha], [-0.5 * alpha, 0.5]])
    assert plus == pytest.approx(expected, rel=1e-14, abs=0)
    assert minus == pytest.approx(expected - np.eye(2), rel=1e-14, abs=0)


def test_an_unknown_that_no_field_carries_is_not_read_by_a_rounding_error() -> None:
    flux = np.array([[3.0, 1.0, 0.0], [0.0, 0.1, 0.0], [0.7, 0.3, 0.0]])
    plus, minus = matrix_function(flux, [positive_part, negative_part])
    assert (plus[:, 2] == 0).all() and (minus == 0).all()


@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6), st.floats(-4, 4))
def test_splitting_has_the_speeds_signs(entries: list[float], asymmetry: float) -> None:
    """A symmetric matrix, made unsymmetric by a scaling: A+ + A- = A, A+ A- = 0, spectra of the signs."""
    # Entries of one scale: a coupling of 1e-168 beside 1 is below what eigenvectors in doubles can tell from none.
    a, b, c, d, e, f = (x if abs(x) > 2.0**-20 else 0.0 for x in entries)
    scale = np.diag([1.0, math.exp(asymmetry), math.exp(-asymmetry)])
    flux = scale @ np.array([[a, b, c], [b, d, e], [c, e, f]]) @ np.linalg.inv(scale)
    plus, minus = matrix_function(flux, [positive_part, negative_part])
    size = np.abs(flux).max() + 1e-300
    assert plus + minus == pytest.approx(flux, abs=1e-11 * size * math.exp(2 * abs(asymmetry)))
    assert np.linalg.eigvals(plus).real.min() > -1e-9 * size * math.exp(2 * abs(asymmetry))
    assert np.linalg.eigvals(minus).real.max() < 1e-9 * size * math.exp(2 * abs(asymmetry))


@pytest.mark.parametrize("flux", [[[0.0, 1.0], [-1.0, 0.0]], [[1.0, 1.0], [0.0, 1.0]]])
def test_a_flux_without_real_fields_is_refused(flux: list[list[float]]) -> None:
    with pytest.raises(NotAnalysable, match="without a full set of real fields"):
        matrix_function(np.array(flux), [positive_part])


def test_balancing_is_exact() -> None:
    matrix = np.array([[0.1, 1e200, 0.0], [1e-190, 0.3, 7.0], [0.0, 1e-5, 2.0]])
    scale, even = balanced(matrix)
    assert (scale[:, None] * even / scale[None, :] == matrix).all()
    assert np.abs(even).max() < 1e100


def test_upwind_blocks_of_a_scalar_lean_into_the_wind() -> None:
    for speed, offsets in ((2.0, {-1, 0}), (-2.0, {0, 1})):
        _, rate = space_blocks("upwind1", np.array([[speed]]))
        assert {j for j, block in rate.items() if block.any()} == offsets
        assert rate[0][0, 0] == 2.0


@pytest.mark.parametrize("name", ["lax-wendroff", "beam-warming", "fromm", "lax-friedrichs"])
@pytest.mark.parametrize("speed", [1.0, -0.5])
def test_discrete_schemes_transport_a_linear_profile(name: str, speed: float) -> None:
    blocks = discrete_blocks(name, np.array([[speed]]), 0.7)
    assert sum(block[0, 0] for block in blocks.values()) == pytest.approx(1.0)
    assert sum(j * block[0, 0] for j, block in blocks.items()) == pytest.approx(-0.7 * speed)
