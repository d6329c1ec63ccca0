"""A claimed formula against a derived number: equality is algebra, digits are digits."""

from fractions import Fraction

import pytest
from flint import fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.bounds.claimvalue import (
    both_sides,
    compare,
    compare_modulus,
    conjugate,
    difference,
    printed_decimal,
    rounds_to,
    value_of,
)
from gks.errors import ParameterError
from gks.modes.algebraic import Root, isolated_roots
from gks.scheme.expression import Expr, extremum, number, sqrt, symbol

X = symbol("x")
NOTHING: dict[str, Fraction] = {}


def root(*coefficients: int, nth: int = -1) -> Root:
    """The nth root (in the order of isolated_roots) of the polynomial with these coefficients, constant first."""
    return isolated_roots(fmpz_poly(list(coefficients)))[nth]


SQRT2 = root(-2, 0, 1)
NEST = root(1, 0, -10, 0, 1)  # sqrt(2) + sqrt(3)


# --- formulas


def test_equal_by_algebra_and_not_by_digits() -> None:
    nested = sqrt(number(2)) + sqrt(number(3))
    assert compare(nested, NOTHING, NEST) == 0
    assert compare(sqrt(number(5) + 2 * sqrt(number(6))), NOTHING, NEST) == 0
    assert compare(nested + Fraction(1, 10**200), NOTHING, NEST) == 1
    assert compare(nested - Fraction(1, 10**200), NOTHING, NEST) == -1


def test_min_and_max_take_the_exactly_smaller_and_larger() -> None:
    sides: list[Expr] = [sqrt(X), X]
    assert [difference(extremum("min", sides), X, {"x": Fraction(v)}) for v in ("1/4", "1", "4")] == [0, 0, -1]
    assert [difference(extremum("max", sides), X, {"x": Fraction(v)}) for v in ("1/4", "1", "4")] == [1, 0, 0]


@given(st.fractions(max_denominator=1000), st.fractions(min_value=0, max_denominator=1000))
def test_rational_formulas_compare_as_their_values_do(x: Fraction, number: Fraction) -> None:
    value = x * x - 3
    assert compare(X * X - 3, {"x": x}, Root.of(number)) == (value > number) - (value < number)


def test_a_value_is_as_accurate_as_asked_and_exact_where_rational() -> None:
    assert value_of(X / 3, {"x": Fraction(1)}) == Fraction(1, 3)
    assert value_of(sqrt(X) - sqrt(X), {"x": Fraction(2)}) == 0
    assert abs(value_of(sqrt(X), {"x": Fraction(2)}, 400) ** 2 - 2) < Fraction(1, 2**390)


def test_two_numbers_are_told_apart_however_close() -> None:
    claimed, derived = both_sides(sqrt(number(2)) + Fraction(1, 10**90), NOTHING, SQRT2)
    assert claimed > derived
    assert claimed - derived < Fraction(2, 10**90)


def test_a_formula_without_a_value_says_so() -> None:
    with pytest.raises(ParameterError, match="negative"):
        compare(sqrt(X), {"x": Fraction(-1)}, SQRT2)
    with pytest.raises(ParameterError, match="zero"):
        compare(1 / X, {"x": Fraction(0)}, SQRT2)


# --- moduli


@pytest.mark.parametrize("nth", [0, 1])
def test_the_modulus_of_a_complex_root(nth: int) -> None:
    z = root(3, -2, 2, nth=nth)  # modulus sqrt(3/2)
    assert compare_modulus(sqrt(number(Fraction(3, 2))), NOTHING, z) == 0
    assert compare_modulus(number(Fraction(5, 4)), NOTHING, z) == 1
    assert compare_modulus(-sqrt(number(Fraction(3, 2))), NOTHING, z) == -1


def test_the_modulus_of_a_negative_root_is_positive() -> None:
    z = root(-2, 0, 1, nth=0)
    assert z.ball().real < 0
    assert compare_modulus(sqrt(number(2)), NOTHING, z) == 0


def test_conjugates_come_in_pairs_and_reals_are_their_own() -> None:
    z = root(1, 1, 1, 1, 1)
    assert conjugate(z) != z
    assert conjugate(conjugate(z)) == z
    assert conjugate(SQRT2) == SQRT2


# --- decimals


@pytest.mark.parametrize(
    ("text", "value", "half"),
    [
        ("0.4397", "0.4397", "0.00005"),
        ("0.9989870", "0.998987", "0.00000005"),
        (" 1.0 ", "1", "0.05"),
        ("7.4e-11", "7.4e-11", "5e-13"),
        ("2E3", "2000", "500"),
    ],
)
def test_a_decimal_stands_for_all_that_rounds_to_it(text: str, value: str, half: str) -> None:
    assert printed_decimal(text) == (Fraction(value), Fraction(half))


@pytest.mark.parametrize("text", ["1", "1/2", "0.5*2", "sqrt(0.5)", "alpha", "min(0.5, 1)"])
def test_a_formula_is_no_decimal(text: str) -> None:
    assert printed_decimal(text) is None


def test_rounding_is_judged_exactly() -> None:
    printed = printed_decimal("1.4142")
    assert printed is not None
    assert rounds_to(SQRT2, printed) == 0
    assert [rounds_to(Root.of(Fraction(x)), printed) for x in ("1.41415", "1.41425")] == [0, 0]
    assert [rounds_to(Root.of(Fraction(x)), printed) for x in ("1.41414999", "1.41425001")] == [1, -1]
