"""Branches as formulas: right at points that they were not chosen by, exact, and as simple as they can be."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, ctx, fmpq, fmpz_mpoly
from hypothesis import assume, given
from hypothesis import strategies as st

from gks.bounds.boundary import PLANE, curve_at
from gks.bounds.closedform import ball, closed_form, number_form
from gks.bounds.criticality import ascending_roots
from gks.bounds.formulalatex import latex
from gks.modes.algebraic import Root, isolated_roots
from gks.scheme.expression import sqrt, symbol

p, lam = PLANE.gens()


@pytest.mark.parametrize(
    ("curve", "at", "k", "text"),
    [
        (p * lam + lam - 4, 5, 1, "4/(alpha + 1)"),
        (lam**2 - p, 2, 1, "sqrt(alpha)"),
        (lam**2 - 4 * p**3, 2, 1, "2*alpha*sqrt(alpha)"),
        (lam**2 - 2 * lam + p, Fraction(1, 2), 1, "1 - sqrt(-alpha + 1)"),
        (lam**2 - 2 * lam + p, Fraction(1, 2), 2, "1 + sqrt(-alpha + 1)"),
        (lam**4 - 10 * lam**2 + 1, 1, 2, "sqrt(3) + sqrt(2)"),
    ],
)
def test_known_formulas(curve: fmpz_mpoly, at: Fraction, k: int, text: str) -> None:
    at = Fraction(at)
    form = closed_form(curve, at, ascending_roots(curve_at(curve, at))[k - 1], "alpha")
    assert str(form) == text


def test_a_quintic_stays_a_root() -> None:
    curve = lam**5 - lam - p
    assert closed_form(curve, Fraction(1), ascending_roots(curve_at(curve, Fraction(1)))[0], "alpha") is None


small = st.integers(-4, 4)


@given(st.lists(st.tuples(small, small), min_size=2, max_size=3), st.fractions(Fraction(1, 4), 4, max_denominator=9))
def test_a_formula_is_a_root_of_its_curve_where_it_was_chosen(parts: list[tuple[int, int]], at: Fraction) -> None:
    curve = sum(((a * p + b) * lam**k for k, (a, b) in enumerate(parts)), PLANE.constant(0))
    assume(not curve.is_zero())
    factors = [f for f, _ in curve.factor()[1] if f.degrees()[1]]
    for factor in factors:
        poly = curve_at(factor, at)
        for value in ascending_roots(poly) if poly.degree() > 0 else []:
            form = closed_form(factor, at, value, "q")
            if form is not None:
                with ctx.workprec(200):
                    found = ball(form, {"q": acb(fmpq(at.numerator, at.denominator))})
                    assert found is not None
                    assert found.overlaps(value.ball(200))


@pytest.mark.parametrize(
    ("coefficients", "text"),
    [
        ([-1, 8, 1], ["-4 - sqrt(17)", "sqrt(17) - 4"]),
        ([-3, 2], ["3/2"]),
        ([-1, -1, 4], ["(1 - sqrt(17))/8", "(1 + sqrt(17))/8"]),
    ],
)
def test_numbers(coefficients: list[int], text: list[str]) -> None:
    from flint import fmpz_poly

    found = [number_form(root) for root in isolated_roots(fmpz_poly(coefficients))]
    for form, root, expected in zip(found, isolated_roots(fmpz_poly(coefficients)), text, strict=True):
        assert form is not None
        if root.ball().real > 0:
            assert str(form) == expected
        value = ball(form, {})
        assert value is not None
        assert value.overlaps(root.ball())


def test_latex_has_fractions_and_no_needless_parentheses() -> None:
    alpha = symbol("alpha")
    assert latex(4 / (alpha + 1)) == r"\frac{4}{\alpha + 1}"
    assert latex((3 - 2 * sqrt(alpha)) / 2) == r"\frac{3 - 2 \sqrt{\alpha}}{2}"
    assert latex(-sqrt(alpha) / (2 * (alpha + 1))) == r"-\frac{\sqrt{\alpha}}{2 \left(\alpha + 1\right)}"


def test_a_rational_number_is_its_own_form() -> None:
    assert str(number_form(Root.of(Fraction(-3, 7)))) == "-3/7"
