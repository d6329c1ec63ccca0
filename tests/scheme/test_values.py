"""Parameter values: exact however they are given, and refused with a reason."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.errors import ParameterError, TooLarge
from gks.scheme.numbers import decimal, decimal_text, rational
from tests.scheme.examples import INTERFACE, read

SCHEME = read(INTERFACE)


def test_defaults_in_file_order_and_overrides() -> None:
    assert list(SCHEME.values().items()) == [("lam", Fraction(9, 10)), ("alpha", Fraction(1))]
    assert SCHEME.values({"alpha": 5}) == {"lam": Fraction(9, 10), "alpha": Fraction(5)}
    assert SCHEME.values({"alpha": 5}, free={"lam"}) == {"alpha": Fraction(5)}
    assert (SCHEME.cfl, SCHEME.half_line("R").side) == ("lam", "right")


@pytest.mark.parametrize(
    ("given_as", "value"),
    [
        ("9/10", Fraction(9, 10)),
        (" -31 / 9 ", Fraction(-31, 9)),
        ("1e-10", Fraction(1, 10**10)),
        ("0.1/1e3", Fraction(1, 10**4)),
        (0.1, Fraction(1, 10)),
        (1e300, Fraction(10**300)),
        (5e-324, Fraction(5, 10**324)),
        (Decimal("0.10"), Fraction(1, 10)),
        (7, Fraction(7)),
        (Fraction(1, 3), Fraction(1, 3)),
    ],
)
def test_values_are_exact(given_as: Fraction | int | str | float | Decimal, value: Fraction) -> None:
    assert SCHEME.values({"alpha": given_as})["alpha"] == value


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        ({"alfa": 1}, 'the scheme has no parameter "alfa"; it has lam, alpha; did you mean "alpha"?'),
        ({"alpha": "one"}, 'alpha: "one" is not a number; expected a number such as 9/10, 0.9 or 1e-10'),
        ({"alpha": "nan"}, 'alpha: "nan" is not a number'),
        ({"alpha": float("inf")}, 'alpha: "inf" is not a number'),
        ({"alpha": True}, 'alpha: "True" is not a number'),
        ({"alpha": ""}, 'alpha: "" is not a number'),
        ({"alpha": "1/2/3"}, 'alpha: "2/3" is not a number'),
        ({"alpha": "1/0"}, 'alpha: "1/0" divides by zero'),
        ({"alpha": "1e10001"}, 'alpha: the decimal exponent "10001" is over the limit 10000'),
        ({"alpha": "1" * 4001}, "alpha: a number of 4001 digits is over the limit 4000"),
        ({"alpha": "١"}, 'alpha: "١" is not a number'),
        ({"lam": 0}, "lam: 0 is not positive; dt/dx is positive"),
        ({"lam": "-1e-5"}, "lam: -1/100000 is not positive"),
    ],
)
def test_refused_values(overrides: dict[str, str | float], message: str) -> None:
    with pytest.raises(ParameterError) as caught:
        SCHEME.values(overrides)
    assert str(caught.value).startswith(message)


def test_a_parameter_without_default_has_to_be_given() -> None:
    scheme = read(INTERFACE, ("default = 1, ", ""))
    with pytest.raises(
        ParameterError, match=r"alpha: it has no default and no value is given; set it with -p alpha=\.\.\."
    ):
        scheme.values()
    assert scheme.values({"alpha": 2})["alpha"] == scheme.values(free={"lam"}, overrides={"alpha": 2})["alpha"] == 2


@given(st.decimals(allow_nan=False, allow_infinity=False))
def test_decimals_are_the_rationals_they_spell(value: Decimal) -> None:
    try:
        assert decimal(str(value)) == Fraction(value)
    except TooLarge:
        assert abs(value.as_tuple().exponent) > 9000  # type: ignore[arg-type]


@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(1, 9))
def test_short_texts_are_rounded_correctly(value: float, digits: int) -> None:
    assert float(decimal_text(Fraction(value), digits)) == float(f"{value:.{digits - 1}e}")


@pytest.mark.parametrize("exponent", [-9999, -400, 400, 9999])
def test_short_texts_of_any_size(exponent: int) -> None:
    assert decimal_text(rational(f"-1.2345678e{exponent}")) == f"-1.23457e{exponent}"
    assert decimal_text(rational(f"9.9999999e{exponent}")) == f"1e{exponent + 1}"
