"""The formula language: Python's precedences, linear equations, and every fault at its character."""

from __future__ import annotations

import ast
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.scheme.expression import symbol
from gks.scheme.forms import ZeroTest
from gks.scheme.formula import Context, parse_equation, parse_expression
from gks.scheme.gridvalue import Grid
from gks.scheme.limits import MAX_NESTING, Work
from gks.scheme.tokens import FormulaError

INTERIOR = Grid({"R": ("u", "s")}, "R")
CLOSURE = Grid({"L": ("u", "s"), "R": ("u", "v")}, without_dt=frozenset({"L"}))
ONE_SIDED = Grid({"R": ("u",)})


def context(grid: Grid | None = None, extrema: bool = False) -> Context:
    work = Work()
    names = {name: symbol(name) for name in ("lam", "alpha")}
    return Context(names, ZeroTest({}, work), work, grid, extrema)


def terms(text: str, grid: Grid) -> dict[str, str]:
    """The terms of left - right, as texts."""
    form = parse_equation(text, context(grid))
    return {str(value): str(coefficient) for value, coefficient in form.terms}


def fault(text: str, grid: Grid | None = None) -> FormulaError:
    with pytest.raises(FormulaError) as caught:
        if grid is None:
            parse_expression(text, context())
        else:
            parse_equation(text, context(grid))
    return caught.value


# --- parameter formulas --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.9", Fraction(9, 10)),
        ("1e-3", Fraction(1, 1000)),
        (".5e1", Fraction(5)),
        ("2.", Fraction(2)),
        ("-2**2", Fraction(-4)),
        ("2**-1", Fraction(1, 2)),
        ("2**3**2", Fraction(512)),
        ("2**(1 + 1)", Fraction(4)),
        ("8/4/2", Fraction(1)),
        ("8/4*2", Fraction(4)),
        ("1 - 2 - 3", Fraction(-4)),
        ("2*-3", Fraction(-6)),
        ("--2", Fraction(2)),
        ("(-2)**2", Fraction(4)),
        ("0**0", Fraction(1)),
        ("sqrt(9/4)", Fraction(3, 2)),
        ("lam/2*(alpha - 1)", Fraction(2)),
        ("-lam**2/alpha", Fraction(-4, 3)),
        ("\tlam\n +\r\n alpha ", Fraction(5)),
        ("1e10000/1e10000", Fraction(1)),
    ],
)
def test_precedence_is_pythons(text: str, value: Fraction) -> None:
    assert parse_expression(text, context()).at({"lam": Fraction(2), "alpha": Fraction(3)}) == value


arithmetic = st.recursive(
    st.one_of(st.integers(0, 9).map(str), st.sampled_from(["lam", "alpha"])),
    lambda inner: st.one_of(
        st.builds("{} {} {}".format, inner, st.sampled_from("+-*/"), inner),
        st.builds("({})".format, inner),
        st.builds("{}{}".format, st.sampled_from("+-"), inner),
        st.builds("{}**{}".format, st.sampled_from(["lam", "alpha", "2", "(lam + 1)"]), st.integers(-3, 3)),
    ),
    max_leaves=15,
)


def pythons_value(node: ast.expr, names: dict[str, Fraction]) -> Fraction:
    """The value of a tree that Python's own parser made of the text."""
    match node:
        case ast.Constant(value=int(digit)):
            return Fraction(digit)
        case ast.Name(id=name):
            return names[name]
        case ast.UnaryOp(op=operator, operand=operand):
            value = pythons_value(operand, names)
            return -value if isinstance(operator, ast.USub) else value
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return Fraction(pythons_value(left, names) ** int(pythons_value(right, names)))
        case ast.BinOp(left=left, op=operator, right=right):
            a, b = pythons_value(left, names), pythons_value(right, names)
            match operator:
                case ast.Add():
                    return a + b
                case ast.Sub():
                    return a - b
                case ast.Mult():
                    return a * b
                case ast.Div():
                    return a / b
    raise AssertionError(ast.dump(node))


@given(arithmetic)
def test_values_are_those_of_the_tree_that_python_reads(text: str) -> None:
    names = {"lam": Fraction(5, 3), "alpha": Fraction(7, 2)}
    try:
        expected = pythons_value(ast.parse(text, mode="eval").body, names)
    except ZeroDivisionError:
        with pytest.raises(FormulaError, match="division by zero"):
            parse_expression(text, context())
        return
    assert parse_expression(text, context()).at(names) == expected


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("", 0, "found the end of the formula where a value should stand"),
        ("1 +", 3, "found the end"),
        ("lam alpha", 4, 'found "alpha" after the formula'),
        ("2lam", 1, 'found "lam" after'),
        ("(1", 2, "inside parentheses"),
        ("1)", 1, 'found ")" after'),
        ("(1, 2)", 0, "found 2 formulas"),
        ("()", 1, 'found ")" where a value'),
        ("1 ^ 2", 2, '"^" has no place'),
        ("alp", 0, '"alp" is not defined'),
        ("1 + n", 4, '"n" stands alone'),
        ("sqrt", 0, '"sqrt" without an argument'),
        ("sqrt(1, 2)", 0, "found 2 formulas"),
        ("sqrt(-2)", 0, "square root of a negative number"),
        ("min(1, 2)", 0, '"min" is no function here'),
        ("dt(1)", 0, '"dt" is no function here'),
        ("lam(2)", 0, '"lam" is no function here'),
        ("1 + u[0]", 4, "a grid value"),
        ("lam = 1", 4, 'found "=" after'),
        ("lam**alpha", 3, "exponent is not an integer"),
        ("lam**(1/2)", 3, "exponent is not an integer"),
        ("2*lam**1001", 5, "exponent over 1000"),
        ("2**1000**2", 1, "exponent over 1000"),
        ("1/(lam - lam)", 1, "division by zero"),
        ("1 + 1/0", 5, "division by zero"),
        ("0**-1", 1, "division by zero"),
        ("1e10001", 0, "decimal exponent"),
        ("2*" + "1" * 4001, 2, "4001 digits"),
        ("1e10000**7", 7, "bits"),
        ("((lam + 1)**1000)**1000", 17, "degree 1000000"),
        ("λ", 0, "U+03BB GREEK SMALL LETTER LAMDA"),
        ("lаm", 1, "U+0430 CYRILLIC SMALL LETTER A"),
        ("1 \u2212 2", 2, "U+2212 MINUS SIGN"),
        ("１", 0, "U+FF11 FULLWIDTH DIGIT ONE"),
        ("lam\0", 3, r"\\x00"),
        ("__import__('os').system('id')", 11, '"\'" has no place'),
        ("lam.__class__", 0, "a grid value"),
        ("[x for x in ()]", 0, 'found "["'),
        ("lambda: 0", 6, '":" has no place'),
        ("1_000", 1, 'found "_000" after'),
    ],
)
def test_faults_of_parameter_formulas(text: str, offset: int, words: str) -> None:
    error = fault(text)
    assert error.offset == offset
    assert words.replace("\\\\", "\\") in error.message


def test_an_unknown_name_suggests_the_nearest() -> None:
    assert fault("alpa + 1").mend == 'did you mean "alpha"?'


def test_min_and_max_belong_to_claims() -> None:
    bound = parse_expression("min(1, max(alpha, lam), 3)", context(extrema=True))
    assert bound.at({"alpha": Fraction(1, 2), "lam": Fraction(1, 3)}) == Fraction(1, 2)


@pytest.mark.parametrize("opening", ["(", "sqrt(", "-("])
def test_nesting_up_to_the_limit(opening: str) -> None:
    parse_expression(opening * MAX_NESTING + "4" + ")" * MAX_NESTING, context())
    error = fault(opening * (MAX_NESTING + 1) + "4" + ")" * (MAX_NESTING + 1))
    assert error.message == "nesting over 200 deep" and error.offset >= MAX_NESTING


def test_towers_of_powers_nest_too() -> None:
    assert "nesting" in fault("2" + "**1" * (MAX_NESTING + 1)).message


@pytest.mark.parametrize("chain", ["+1", "*1", "/1", "-1"])
def test_chains_do_not_nest(chain: str) -> None:
    assert parse_expression("lam" + chain * 10_000, context()) is not None


def test_too_much_work_is_refused_where_it_gets_too_much() -> None:
    error = fault("+".join(["lam"] * 200_000))
    assert "together too long" in error.message and 0 < error.offset < 800_000


# --- equations -----------------------------------------------------------------------------------------------------


def test_a_leapfrog_step() -> None:
    assert terms("u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])", INTERIOR) == {
        "R.u[0, n+1]": "1",
        "R.u[0, n-1]": "-1",
        "R.u[1]": "-lam",
        "R.u[-1]": "lam",
    }


def test_dt_is_linear() -> None:
    assert terms("dt(u[i]) + dt(2*u[i+1] - s[i])/4 = -alpha*(s[i] - s[i-1])", INTERIOR) == {
        "dt(R.u[0])": "1",
        "dt(R.u[1])": "1/2",
        "dt(R.s[0])": "-1/4",
        "R.s[0]": "alpha",
        "R.s[-1]": "-alpha",
    }


def test_indices_are_sums_of_integers() -> None:
    assert terms("u[1 - 3 + i, 2+n-1] = u[i-64]", INTERIOR) == {"R.u[-2, n+1]": "1", "R.u[-64]": "-1"}
    assert terms("R.u[-1, n+1] = u[+2 - 1]", ONE_SIDED) == {"R.u[-1, n+1]": "1", "R.u[1]": "-1"}


def test_terms_are_gathered_and_those_that_vanish_left_out() -> None:
    assert terms("u[i, n+1] + (lam - 1)*u[i] = (lam + 1)*(u[i] - u[i-1]*0) - 2*u[i] + s[i]", INTERIOR) == {
        "R.u[0, n+1]": "1",
        "R.s[0]": "-1",
    }


def test_a_constant_may_cancel() -> None:
    assert terms("u[i, n+1] + 1 = u[i] + alpha/alpha", INTERIOR) == {"R.u[0, n+1]": "1", "R.u[0]": "-1"}


def test_division_and_powers_one_of_grid_values() -> None:
    assert terms("(u[i, n+1]/lam)**1 = u[i]", INTERIOR) == {"R.u[0, n+1]": "1/lam", "R.u[0]": "-1"}


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("u[i] = u[i+1]*u[i]", 13, "a product of grid values"),
        ("u[i] = 1/u[i]", 8, "division by a grid value"),
        ("u[i]**2 = 0", 4, "a power of a grid value"),
        ("u[i]**0 = u[i]", 4, "a power of a grid value"),
        ("sqrt(u[i]) = 0", 0, "sqrt(...) of a grid value"),
        ("u[i, n+1] = u[i] + lam", 19, "a constant term"),
        ("u[i, n+1] = (u[i] + lam)", 0, "a constant term"),
        ("u[i] = u[i]", 0, "all grid values cancel"),
        ("lam = lam", 0, "all grid values cancel"),
        ("u[i]", 4, "found the end of the formula after the left side"),
        ("u[i] == u[i-1]", 6, 'found "=" where a value should stand'),
        ("u[i] = u[i-1] = 0", 14, 'found "=" after the formula'),
        ("dt(dt(u[i])) = u[i]", 3, "dt(...) inside dt(...)"),
        ("dt(lam) = u[i]", 0, "dt(...) of a parameter formula"),
        ("dt(u[i] + lam) = u[i]", 0, "dt(...) with a constant term"),
        ("u = u[i]", 0, '"u" is an unknown without an index'),
        ("w[i] = u[i]", 0, '"w" is not an unknown'),
        ("L.u[i] = u[i]", 0, 'no domain "L" here'),
        ("R.w[i] = u[i]", 2, '"w" is not an unknown'),
        ("u[0] = u[i]", 2, 'found no "i"'),
        ("u[i+i] = u[i]", 2, 'found more than one "i"'),
        ("u[-i] = u[i]", 3, 'found "i" in an index'),
        ("u[2*i] = u[i]", 3, 'found "*" in an index'),
        ("u[i+1.5] = u[i]", 4, '"1.5" in an index'),
        ("u[i+65] = u[i]", 2, "an offset of 65"),
        ("u[i-99999999999] = u[i]", 4, "an offset of 11 digits"),
        ("u[i, m+1] = u[i]", 5, 'found "m" in an index'),
        ("u[i, 1] = u[i]", 5, 'found no "n"'),
        ("u[i, n+65] = u[i]", 5, "an offset of 65"),
        ("u[i, n, n] = u[i]", 6, 'found "," inside the brackets'),
        ("u[i = 0", 4, 'found "=" in an index'),
        ("u[] = 0", 2, 'found "]" in an index'),
    ],
)
def test_faults_of_interior_equations(text: str, offset: int, words: str) -> None:
    error = fault(text, INTERIOR)
    assert (error.offset, words in error.message) == (offset, True), error.message


@pytest.mark.parametrize(
    ("text", "offset", "words"),
    [
        ("R.u[i] = 0", 4, 'found "i" in an index'),
        ("R.u[1, n+1] = u[0]", 14, '"u" without its domain'),
        ("w[0] = R.u[0]", 0, '"w" is not an unknown'),
        ("R.s[0] = 0", 2, '"s" is not an unknown'),
        ("X.u[0] = 0", 0, 'no domain "X" here'),
        ("R.[0] = 0", 2, 'found "[" after the domain'),
        ("R.u(0) = 0", 3, 'found "(" after an unknown'),
        ("dt(R.u[0]) = dt(L.u[0])", 13, "dt(...) of L.u[0]"),
    ],
)
def test_faults_of_closure_equations(text: str, offset: int, words: str) -> None:
    error = fault(text, CLOSURE)
    assert (error.offset, words in error.message) == (offset, True), error.message


def test_the_domain_may_be_left_out_where_there_is_one() -> None:
    assert terms("u[-1] = R.u[0]", ONE_SIDED) == {"R.u[-1]": "1", "R.u[0]": "-1"}
    assert "write L.u[...] or R.u[...]" in fault("u[0] = 0", CLOSURE).mend


@given(st.text(alphabet="uis[]()+-*/.,= nlamdt019R_^'\"é\n", max_size=60))
def test_any_text_is_an_equation_or_a_located_fault(text: str) -> None:
    try:
        parse_equation(text, context(INTERIOR))
    except FormulaError as error:
        assert 0 <= error.offset <= len(text)
