"""What is said of a scheme: distances that fifteen digits hide, values as they were given, places of faults."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from gks.errors import ParameterError, SchemeError
from gks.modes.analysis import analyse
from gks.modes.numerals import text_exact
from gks.modes.verdict import Mode, ModeKind, text_modulus
from gks.scheme.schemefile import parse_scheme

HEAD = """title = "t"
[parameters]
lam = { role = "cfl", default = 0.5 }
[domains.R]
side = "right"
unknowns = ["u"]
first = 1
"""
LEAPFROG = 'interior = ["u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"]\n'


def mode(z: Fraction, kind: ModeKind, radius: Fraction = Fraction(0)) -> Mode:
    return Mode((z, Fraction(0)), abs(z), radius, 1, kind, {})


@pytest.mark.parametrize("sign", [1, -1])
def test_a_root_near_the_circle_says_how_near(sign: int) -> None:
    tiny = Fraction(2, 10**25)
    assert text_modulus(mode(sign * (1 + tiny), ModeKind.GROWING)) == "1 + 2e-25"
    assert text_modulus(mode(sign * (1 - tiny), ModeKind.DECAYING)) == "1 - 2e-25"
    assert text_modulus(mode(sign * (1 + tiny), ModeKind.INADMISSIBLE)) == "1 + 2e-25"


def test_a_distance_below_the_radius_is_bounded() -> None:
    near = mode(Fraction(1), ModeKind.GROWING, Fraction(1, 10**38))
    assert text_modulus(near) == "1 + less than 2e-38"
    assert text_modulus(replace(near, kind=ModeKind.DECAYING)) == "1 - less than 2e-38"


def test_on_the_circle_is_one_and_elsewhere_fifteen_digits_say_it() -> None:
    assert text_modulus(mode(Fraction(1) + Fraction(1, 10**30), ModeKind.EIGENVALUE)) == "1"
    assert text_modulus(mode(Fraction(1), ModeKind.INADMISSIBLE)) == "1"
    assert text_modulus(mode(Fraction(3, 2), ModeKind.GROWING)) == "1.5"


@pytest.mark.parametrize("text", ["0.9", "1/3", "1e+700", "1.5000000000000000000000001", "-31/9"])
def test_a_parameter_is_printed_as_the_number_it_is(text: str) -> None:
    assert text_exact(Fraction(text)) == text


def test_a_number_of_thousands_of_digits_is_not_printed_in_full() -> None:
    assert text_exact(Fraction(1, 3) + Fraction(1, 10**5000)) == "about 0.333333333333333"


@pytest.mark.parametrize(
    "rest",
    [
        LEAPFROG + '[closure]\nequations = ["(lam-1/2)*u[0, n+1] = (2*lam-1)*u[1, n+1]"]\n',
        'flux = [["-1"]]\nscheme = "lax-wendroff"\n[closure]\nequations = ["u[1] = u[2]"]\n',
    ],
)
def test_a_closure_that_fails_as_a_whole_is_placed_at_its_first_equation(rest: str) -> None:
    scheme = parse_scheme(HEAD + rest, "told")
    first = scheme.closure.equations[0]
    with pytest.raises(SchemeError) as found:
        analyse(scheme, scheme.values())
    assert str(found.value).startswith(f"told:{first.line}:{first.column}: closure.equations: ")


@pytest.mark.parametrize(
    ("factor", "words"),
    [("1/(2*lam - 1)", "division by zero"), ("sqrt(lam - 1)", "the square root of a negative number")],
)
def test_a_formula_without_a_value_is_named_with_its_place(factor: str, words: str) -> None:
    equation = f"u[0, n+1] = {factor}*u[1, n+1]"
    closed = parse_scheme(HEAD + LEAPFROG + f'[closure]\nequations = ["{equation}"]\n', "told")
    with pytest.raises(ParameterError) as found:
        analyse(closed, closed.values())
    assert str(found.value) == f'told:10:14: {words} at lam = 1/2 in "{equation}"; take other values'


def test_an_interior_formula_without_a_value_names_the_file_and_the_half_line() -> None:
    interior = 'interior = ["u[i, n+1] = u[i] + lam/(2*lam - 1)*(u[i+1] - u[i])"]\n[closure]\n'
    scheme = parse_scheme(HEAD + interior + 'equations = ["u[0] = u[1]"]\n', "told")
    with pytest.raises(ParameterError, match=r'^told: division by zero at lam = 1/2 in the interior of "R"; '):
        analyse(scheme, scheme.values())
