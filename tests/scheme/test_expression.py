"""Exact expressions: what is built is what was meant, no walk recurses, and the size is known before it is paid for."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.errors import IrrationalValue, ParameterError, TooLarge
from gks.scheme.expression import Expr, add, extremum, mul, number, power, sqrt, symbol
from gks.scheme.forms import ZeroTest
from gks.scheme.formula import Context, parse_expression
from gks.scheme.limits import MAX_BITS, MAX_DEGREE, MAX_WRITTEN, Work
from tests.examples import examples

alpha, lam = symbol("alpha"), symbol("lam")
HALF = number(Fraction(1, 2))

numbers = st.fractions(min_value=-9, max_value=9, max_denominator=9).map(number)
leaves = st.one_of(numbers, st.sampled_from([alpha, lam]))


def _combined(parts: st.SearchStrategy[Expr]) -> st.SearchStrategy[Expr]:
    some = st.lists(parts, min_size=1, max_size=3)
    return st.one_of(some.map(add), some.map(mul), st.builds(power, parts, st.integers(0, 3)))


polynomials = st.recursive(leaves, _combined, max_leaves=12)


@st.composite
def quotients(draw: st.DrawFn) -> Expr:
    """Sums of quotients whose denominators are positive for positive parameters."""
    terms = draw(st.lists(polynomials, min_size=1, max_size=3))
    denominators = [draw(st.sampled_from([number(1), alpha, 1 + alpha, lam + 2 * alpha])) for _ in terms]
    return add([term / d for term, d in zip(terms, denominators, strict=True)])


@pytest.mark.parametrize(
    ("expr", "text"),
    [
        ((1 + 1 / alpha) / 2, "(1 + 1/alpha)/2"),
        (lam / 2 * (alpha - 1), "lam*(alpha - 1)/2"),
        (-(alpha + lam), "-(alpha + lam)"),
        (1 - (alpha - 1), "1 - (alpha - 1)"),
        (1 / (alpha * lam), "1/(alpha*lam)"),
        (power(1 / alpha, 2), "1/alpha**2"),
        (power(-alpha, 3), "(-alpha)**3"),
        (power(number(2) ** 1 / alpha, -2), "1/(2/alpha)**2"),
        (3 * alpha / 2, "3*alpha/2"),
        (sqrt(alpha + 1) * -1, "-sqrt(alpha + 1)"),
        (extremum("min", [number(1), alpha]), "min(1, alpha)"),
        (number(0) + 0, "0"),
    ],
)
def test_text_has_as_few_parentheses_as_the_language_allows(expr: Expr, text: str) -> None:
    assert str(expr) == text


def test_constants_fold_zeros_and_ones_vanish() -> None:
    assert add([alpha, number(1), number(-1)]) == alpha
    assert mul([number(2), alpha, HALF]) == alpha
    assert (alpha * 0).value == 0 and (alpha * 0).op == "num"
    assert power(alpha, 0) == number(1)
    assert sqrt(number(Fraction(9, 4))) == number(Fraction(3, 2))
    assert sqrt(number(2)).op == "sqrt"


@given(quotients(), st.fractions(min_value=1, max_value=9), st.fractions(min_value=1, max_value=9))
def test_text_reads_back_with_the_same_value(expr: Expr, a: Fraction, b: Fraction) -> None:
    work = Work()
    context = Context({"alpha": alpha, "lam": lam}, ZeroTest({}, work), work)
    values = {"alpha": a, "lam": b}
    assert parse_expression(str(expr), context).at(values) == expr.at(values)


@examples(40)  # sympy takes its time
@given(quotients(), st.fractions(min_value=1, max_value=9, max_denominator=99))
def test_text_is_valid_sympy(expr: Expr, a: Fraction) -> None:
    import sympy

    read = sympy.sympify(str(expr), locals={"lam": sympy.Symbol("lam")})
    value = read.subs({"alpha": sympy.Rational(a), "lam": sympy.Rational(2, 7)})
    assert Fraction(str(value)) == expr.at({"alpha": a, "lam": Fraction(2, 7)})


Poly = dict[tuple[int, int], Fraction]
"""Coefficients by the exponents of alpha and lam."""


class _Expanded:
    """The slow second way: numerator and denominator multiplied out, never cancelled."""

    def number(self, value: Fraction) -> tuple[Poly, Poly]:
        return {(0, 0): Fraction(value.numerator)} if value else {}, {(0, 0): Fraction(value.denominator)}

    def symbol(self, name: str) -> tuple[Poly, Poly]:
        return {(1, 0) if name == "alpha" else (0, 1): Fraction(1)}, {(0, 0): Fraction(1)}

    def add(self, terms: Sequence[tuple[Poly, Poly]]) -> tuple[Poly, Poly]:
        total = terms[0]
        for other in terms[1:]:
            top = self._times(total[0], other[1])
            for key, c in self._times(other[0], total[1]).items():
                top[key] = top.get(key, Fraction(0)) + c
            total = ({k: c for k, c in top.items() if c}, self._times(total[1], other[1]))
        return total

    def mul(self, factors: Sequence[tuple[Poly, Poly]]) -> tuple[Poly, Poly]:
        total = factors[0]
        for other in factors[1:]:
            total = (self._times(total[0], other[0]), self._times(total[1], other[1]))
        return total

    def power(self, base: tuple[Poly, Poly], exponent: int) -> tuple[Poly, Poly]:
        total = self.mul([base] * abs(exponent))
        return total if exponent > 0 else (total[1], total[0])

    def sqrt(self, radicand: tuple[Poly, Poly]) -> tuple[Poly, Poly]:
        raise NotImplementedError

    @staticmethod
    def _times(a: Poly, b: Poly) -> Poly:
        out: Poly = {}
        for (p, c), (q, d) in product(a.items(), b.items()):
            key = (p[0] + q[0], p[1] + q[1])
            out[key] = out.get(key, Fraction(0)) + c * d
        return {k: c for k, c in out.items() if c}


@given(quotients())
def test_size_bounds_the_expanded_formula(expr: Expr) -> None:
    top, bottom = expr.fold(_Expanded())
    size = expr.size
    for poly, degree, bits in (
        (top, size.numerator_degree, size.numerator_bits),
        (bottom, size.denominator_degree, size.denominator_bits),
    ):
        assert max((sum(key) for key in poly), default=0) <= degree
        assert sum(abs(c) for c in poly.values()) <= 2 ** (bits + 1e-9)
        assert len(poly) <= size.terms(2)


@given(quotients())
def test_identically_zero_agrees_with_multiplying_out(expr: Expr) -> None:
    top, _ = expr.fold(_Expanded())
    assert expr.identically_zero() is (not top)
    assert (expr - expr * number(1)).identically_zero()


def test_long_chains_do_not_recurse() -> None:
    chain = lam
    for _ in range(2000):
        chain = sqrt(power(chain + alpha, 2)) - alpha
    assert chain.at({"lam": Fraction(3), "alpha": Fraction(1, 2)}) == 3
    assert chain == chain + 0 and str(chain).count("sqrt") == 2000 and chain.symbols == {"alpha", "lam"}


def test_a_shared_part_is_visited_once() -> None:
    doubled = alpha + lam
    for _ in range(15):
        doubled = doubled * lam + doubled
    assert doubled.size.written > 2**16 > 100 > sum(1 for _ in doubled.nodes())


def test_limits_are_known_before_they_are_paid_for() -> None:
    power(power(1 + alpha, 1000), MAX_DEGREE // 1000)
    with pytest.raises(TooLarge, match="degree 11000"):
        power(power(1 + alpha, 1000), 11)
    with pytest.raises(TooLarge, match="bits"):
        power(power(number(10) ** 1000, 100), MAX_BITS // 100_000)
    with pytest.raises(TooLarge, match="parts"):
        add([alpha] * (MAX_WRITTEN + 1))


def test_exact_values() -> None:
    assert ((1 + 1 / alpha) / 2).at({"alpha": Fraction(3)}) == Fraction(2, 3)
    assert extremum("max", [number(1), alpha, 2 * alpha]).at({"alpha": Fraction(3)}) == 6
    assert (alpha**40 / alpha**39).at({"alpha": Fraction(10) ** 300}) == Fraction(10) ** 300
    assert sqrt(alpha / 9).at({"alpha": Fraction(4)}) == Fraction(2, 3)


def test_values_that_do_not_exist_say_why() -> None:
    with pytest.raises(ParameterError, match=r"division by zero at alpha = 1; "):
        (1 / (alpha - 1)).at({"alpha": Fraction(1), "lam": Fraction(2)})
    with pytest.raises(ParameterError, match="negative number at alpha = -1e-400"):
        sqrt(alpha).at({"alpha": Fraction(-1, 10**400)})
    with pytest.raises(ParameterError, match=r"alpha: no value is given"):
        (alpha + lam).at({"lam": Fraction(1)})
    with pytest.raises(ParameterError, match=f"over {MAX_BITS} bits"):
        (alpha**1000).at({"alpha": Fraction(10) ** 300})
    with pytest.raises(IrrationalValue):
        sqrt(alpha).at({"alpha": Fraction(2)})


@pytest.mark.parametrize(
    "zero",
    [
        (lam + 1) ** 2 - lam**2 - 2 * lam - 1,
        (9 * lam + alpha) ** 1000 - (alpha + 9 * lam) ** 1000,
        1 / (lam + 1) - 1 / (alpha + lam) + (1 - alpha) / ((lam + 1) * (alpha + lam)),
        sqrt(alpha) * sqrt(lam) - sqrt(alpha * lam),
        sqrt(number(2)) * sqrt(number(3)) - sqrt(number(6)),
        1 / (sqrt(alpha) + sqrt(lam)) - (sqrt(alpha) - sqrt(lam)) / (alpha - lam),
        sqrt(alpha**2) - alpha,
    ],
)
def test_what_vanishes_as_a_formula(zero: Expr) -> None:
    assert zero.identically_zero()
    assert not (zero + number(Fraction(1, 10**50))).identically_zero()
    assert (zero * alpha).identically_zero() and power(zero, 3).identically_zero()


def test_what_vanishes_depends_on_the_range() -> None:
    difference = sqrt(alpha**2) - alpha
    assert not difference.identically_zero({"alpha": (None, Fraction(0))})
    assert (difference + 2 * alpha).identically_zero({"alpha": (None, Fraction(0))})


@pytest.mark.parametrize("prime", [2**61 - 1, 2**127 - 1, (2**61 - 1) * (2**89 - 1) * (2**107 - 1) * (2**127 - 1)])
def test_coefficients_divisible_by_a_prime_are_not_zero(prime: int) -> None:
    assert not (prime * (1 + lam) ** 900 - prime * lam**900).identically_zero()
    assert not (prime * lam - prime).identically_zero()


def test_a_denominator_that_vanishes_identically_is_found() -> None:
    with pytest.raises(ZeroDivisionError):
        (1 / (alpha - lam - (alpha - lam)) + 1).identically_zero()
    with pytest.raises(ZeroDivisionError):
        (1 / (sqrt(alpha) * sqrt(lam) - sqrt(alpha * lam)) + 1).identically_zero()
