"""A formula on a page is the formula that was derived: its tree says what its text says, in each form."""

import re
import xml.etree.ElementTree as ET
from fractions import Fraction

import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from gks.reports.formulas import (
    LONGEST,
    NotAFormula,
    cases,
    formula,
    indexed,
    laid_out,
    matrix,
    name,
    number,
    plain,
    slashed,
    split_name,
)
from gks.reports.latex import latex, latex_text
from gks.reports.mathml import mathml

SQUARE = "18*alpha**2 + 4*alpha - 14 + 2*(alpha + 1)*sqrt(81*alpha**2 + 130*alpha + 49)"
THEOREM_3_4 = f"3/2 - sqrt({SQUARE})/(4*(alpha + 1))"


def value(element: ET.Element) -> sympy.Expr:
    """What a presentation means, read back from its MathML by someone who did not write it."""
    parts = list(element)
    match element.tag:
        case "mn":
            return sympy.Rational(Fraction(element.text or ""))
        case "mi":
            return sympy.Symbol(element.text or "")
        case "mfrac":
            return value(parts[0]) / value(parts[1])
        case "msup":
            return value(parts[0]) ** value(parts[1])
        case "msub":
            return sympy.Symbol(f"{parts[0].text}_{parts[1].text}")
        case "msqrt":
            return sympy.sqrt(row(parts))
        case _:
            return row(parts)


def row(parts: list[ET.Element]) -> sympy.Expr:
    parts = [part for part in parts if not (part.tag == "mo" and part.text in ("(", ")"))]
    total, sign, product = sympy.Integer(0), 1, sympy.Integer(1)
    for part in parts:
        if part.tag == "mo" and part.text in ("+", "−"):
            total += sign * product if part is not parts[0] else 0
            sign, product = (1 if part.text == "+" else -1), sympy.Integer(1)
        elif part.tag != "mo":
            product *= value(part)
    return total + sign * product


def meant(text: str) -> sympy.Expr:
    return value(ET.fromstring(mathml(formula(text))))


GREEK = {"alpha": "α", "lam": "λ", "kappa_R": "κ_R", "kappa_L": "κ_L"}


def said(text: str) -> sympy.Expr:
    return sympy.sympify(text, {key: sympy.Symbol(letter) for key, letter in GREEK.items()})


@pytest.mark.parametrize("text", [THEOREM_3_4, "4/(alpha + 1)", "-2*alpha**2 + 3", "kappa_R/kappa_L/2", "(1 - lam)**3"])
def test_the_mathematics_on_a_page_is_the_formula(text: str) -> None:
    assert sympy.simplify(meant(text) - said(text)) == 0


ATOMS = st.sampled_from(["alpha", "lam", "2", "7", "3/2"])
FORMULAS = st.recursive(
    ATOMS,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/"]), inner).map(lambda t: f"({t[0]}) {t[1]} ({t[2]})"),
        inner.map(lambda t: f"sqrt({t})"),
        inner.map(lambda t: f"({t})**2"),
    ),
    max_leaves=6,
)
AT = {sympy.Symbol("α"): sympy.Rational(11, 7), sympy.Symbol("λ"): sympy.Rational(5, 9)}


@given(FORMULAS)
def test_so_is_every_other(text: str) -> None:
    expected = complex(sympy.N(said(text).subs(AT), 20)) if not said(text).has(sympy.zoo, sympy.nan) else None
    if expected is None or not abs(expected) < 1e12:
        return
    assert abs(complex(sympy.N(meant(text).subs(AT), 20)) - expected) <= 1e-9 * max(1.0, abs(expected))


@given(FORMULAS)
def test_braces_of_the_latex_are_balanced(text: str) -> None:
    found = latex(formula(text))
    assert found.count("{") == found.count("}")
    assert found.count(r"\left(") == found.count(r"\right)")


def test_relations_and_functions() -> None:
    assert plain(formula("0 < lam <= 1")) == "0 < λ ≤ 1"
    assert plain(formula("z = exp(lam*s)")) == "z = e^(λ s)"
    assert plain(formula("min(1, 4/alpha)")) == "min(1, 4/α)"
    assert plain(formula("root(x**2 - alpha, 1)")) == "root(x^2 − α, 1)"


def test_names_have_their_indices() -> None:
    assert split_name("kappa_R") == ("κ", "R")
    assert split_name("rho1") == ("ρ", "1")
    assert split_name("lam") == ("λ", "")
    assert split_name("width") == ("width", "")
    assert split_name("lam_max") == ("λ", "max")


@pytest.mark.parametrize("text", ["1 +", "a b", "(", "2 $ 3", "x[0]", "", "*", "a = = b", "(" * 200 + "x" + ")" * 200])
def test_what_is_no_formula_is_refused(text: str) -> None:
    with pytest.raises(NotAFormula):
        formula(text)


def test_what_is_too_long_is_shown_as_its_beginning() -> None:
    with pytest.raises(NotAFormula):
        formula("x + " * LONGEST + "x")
    assert plain(laid_out("x + " * LONGEST + "x")).endswith("…")


def test_text_cannot_break_out_of_the_markup() -> None:
    shown = mathml(laid_out("<script>alert(1)</script>"))
    assert "<script" not in shown
    ET.fromstring(shown)


def test_matrices_and_cases() -> None:
    table = ET.fromstring(mathml(matrix([[number(0), name("alpha")], [number(1), number(2)]])))
    assert len(table.findall(".//mtr")) == 2
    assert len(table.findall(".//mtd")) == 4
    assert r"\begin{cases}" in latex(cases([(name("x"), name("y")), (name("y"), name("x"))]))
    assert plain(cases([(formula("0 < x"), formula("y < 1"))])) == "0 < x   y < 1"


def test_an_index_of_what_has_one_is_no_double_subscript() -> None:
    assert latex(indexed(name("u_x"), number(0), name("n"))).startswith("{{u_{")


def test_in_a_line_of_text_a_quotient_of_names_has_a_slash() -> None:
    assert "mfrac" not in mathml(slashed(formula("alpha = rho_R/rho_L")))
    assert "mfrac" in mathml(slashed(formula("1/(alpha + 1)")))


def test_any_text_is_latex_of_plain_letters() -> None:
    found = latex_text("Sjögreen & Söderström: 50% of $x_1$ → ∞ \\ {ž} 漢")
    assert found.isascii()
    assert found.endswith("?")
    assert not re.search(r"(?<!\\)[&%$_]", found)
