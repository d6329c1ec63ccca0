"""Formula text -> exact expression, or linear equation in grid values. Nothing is ever executed.

    equation = sum "=" sum
    sum      = product (("+" | "-") product)*
    product  = factor (("*" | "/") factor)*
    factor   = ("+" | "-")* atom ("**" factor)?           as in Python: -x**2 is -(x**2), 2**3**2 is 2**9
    atom     = number | name | grid value | "(" sum ")" | function "(" sum ("," sum)* ")"
    grid     = (domain ".")? unknown "[" index ("," level)? "]"
    index    = sum of integers, and "i" once in interior equations;  level = "n" and a sum of integers
    function = sqrt; dt in equations; min and max in the bounds of claims

Chains of operators are read in loops; only nesting recurses, two frames a level, and it is limited.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

from gks.errors import TooLarge, quoted
from gks.scheme import expression
from gks.scheme.evaluation import value_work
from gks.scheme.expression import Expr, number
from gks.scheme.forms import Combination, Value, ZeroTest, differentiated, negated, scaled, total
from gks.scheme.gridvalue import Grid, read_grid_value
from gks.scheme.limits import DIGIT_WORK, MAX_EXPONENT, MAX_NESTING, Work
from gks.scheme.model import LinearForm
from gks.scheme.numbers import decimal
from gks.scheme.suggest import nearest
from gks.scheme.tokens import Cursor, FormulaError, Token, listed, tokenize

RESERVED = ("i", "n", "dt", "sqrt", "min", "max")
"""Words of the formula language, which name nothing else."""

_LINEAR = "equations are linear in the grid values"


@dataclass(frozen=True, slots=True)
class Context:
    """What the names of a formula stand for."""

    names: Mapping[str, Value]
    is_zero: ZeroTest
    work: Work
    grid: Grid | None = None  # None: no grid values here
    extrema: bool = False  # whether min and max are allowed
    place: str = "a parameter formula"  # for messages


def parse_value(text: str, context: Context) -> Value:
    """A formula that may hold grid values if the context has a grid. FormulaError with the offset of the fault."""
    parser = _Parser(text, context)
    with _Limits(0):
        value = parser.sum()
    parser.expect_end()
    return value


def parse_expression(text: str, context: Context) -> Expr:
    """A formula in the parameters alone."""
    value = parse_value(text, context)
    if isinstance(value, Expr):
        return value
    raise FormulaError(0, "it holds grid values", f"{context.place} holds parameters only")


def parse_equation(text: str, context: Context) -> LinearForm:
    """`left = right` as the form left - right = 0: linear, homogeneous, without terms that vanish identically."""
    parser = _Parser(text, context)
    with _Limits(0):
        left = parser.sum()
        if parser.take("=") is None:
            raise FormulaError(
                parser.token.offset, f"found {parser.found()} after the left side", 'expected "=" or an operator'
            )
        right = parser.sum()
        parser.expect_end()
        form = total([left, negated(right)], context.work)
        constant = form if isinstance(form, Expr) else form.constant
        if not context.is_zero(constant):
            raise FormulaError(
                [*parser.constants, 0][0], "a constant term, without a grid value",
                "equations are homogeneous in the grid values",
            )  # fmt: skip
        terms = context.is_zero.nonzero(form.terms.items()) if isinstance(form, Combination) else ()
        # whoever analyses the scheme will evaluate the coefficients, at values of some 64 bits
        context.work.spend(sum(value_work(coefficient, 64) for _, coefficient in terms))
    if not terms:
        raise FormulaError(0, "all grid values cancel: the equation says 0 = 0", mend="mend the equation")
    return LinearForm(terms)


def names_in(text: str, work: Work) -> list[Token]:
    """The names that stand for parameters or shorthands (not for functions, domains, unknowns), where they stand."""
    tokens = tokenize(text, work)
    return [token for token, after in pairwise(tokens) if token.kind == "name" and after.kind not in ("(", "[", ".")]


class _Limits:
    """Turns a limit of the expressions, or a denominator that vanishes, into an error at this offset."""

    def __init__(self, offset: int) -> None:
        self.offset = offset

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, traceback: object) -> None:
        if isinstance(error, TooLarge):
            raise FormulaError(self.offset, str(error), mend="write a smaller formula") from None
        if isinstance(error, ZeroDivisionError):
            raise FormulaError(self.offset, "division by zero: the denominator vanishes identically") from None


class _Parser(Cursor):
    """Recursive descent over the tokens of one formula."""

    def __init__(self, text: str, context: Context) -> None:
        super().__init__(tokenize(text, context.work))
        self.context = context
        self.depth = 0
        self.in_dt = False
        self.constants: list[int] = []  # where constant terms stand outside of all parentheses

    def expect_end(self) -> None:
        if self.token.kind == "end":
            return
        mend = {
            "=": "an equation has one =" if self.context.grid else "only equations have an =",
            "name": "a product is written with *",
            "number": "a product is written with *",
            "(": "a product is written with *",
        }
        raise FormulaError(
            self.token.offset, f"found {self.found()} after the formula", "expected an operator or the end",
            mend.get(self.token.kind, ""),
        )  # fmt: skip

    # --- the grammar -----------------------------------------------------------------------------------------------

    def sum(self) -> Value:
        """A sum of products of factors."""
        start = self.token.offset
        terms: list[Value] = []
        sign: Token | None = None
        while not terms or (sign := self.take("+", "-")):
            offset = self.token.offset
            term = self._product(self._factor())
            if self.depth == 0 and isinstance(term, Expr) and not (term.op == "num" and not term.value):
                self.constants.append(offset)
            terms.append(negated(term) if sign and sign.kind == "-" else term)
        with _Limits(start):
            return total(terms, self.context.work)

    def _product(self, first: Value) -> Value:
        """The rest of a product after its first factor (parameters gathered first, so that long products stay flat)."""
        factors: list[Expr] = [first] if isinstance(first, Expr) else []
        form = None if isinstance(first, Expr) else first
        start = self.token.offset
        while operator := self.take("*", "/"):
            factor = self._factor()
            if isinstance(factor, Expr):
                factors.append(self._reciprocal(factor, operator.offset) if operator.kind == "/" else factor)
            elif operator.kind == "/":
                raise FormulaError(operator.offset, "division by a grid value", _LINEAR)
            elif form is not None:
                raise FormulaError(operator.offset, "a product of grid values", _LINEAR)
            else:
                form = factor
        with _Limits(start):
            if form is None:
                return factors[0] if len(factors) == 1 else expression.mul(factors)
            return scaled(form, expression.mul(factors), self.context.work) if factors else form

    def _reciprocal(self, divisor: Expr, offset: int) -> Expr:
        with _Limits(offset):
            if self.context.is_zero(divisor):
                raise ZeroDivisionError
            return expression.power(divisor, -1)

    def _factor(self) -> Value:
        """Signs, an atom or a group, and its power."""
        negative = False
        while sign := self.take("+", "-"):
            negative ^= sign.kind == "-"
        opening = self._opening()
        if opening is None:
            value = self._atom()
        else:
            arguments = [self.sum()]
            while self.take(","):
                arguments.append(self.sum())
            self.expect(")", "inside parentheses")
            self.depth -= 1
            value = self._group(opening, arguments)
        if stars := self.take("**"):
            self._deeper(stars.offset)
            value = self._power(value, self._factor(), stars.offset)
            self.depth -= 1
        return negated(value) if negative else value

    def _deeper(self, offset: int) -> None:
        self.depth += 1
        if self.depth > MAX_NESTING:
            raise FormulaError(offset, f"nesting over {MAX_NESTING} deep", mend="name a part of it as a shorthand")

    # --- groups: parentheses and functions -------------------------------------------------------------------------

    def _opening(self) -> Token | None:
        """Step over "(" or the name of a function and its "("; the token that says what the group is."""
        opening = self.token
        if opening.kind == "name" and self.tokens[self.place + 1].kind == "(":
            self._known_function(opening)
            self.place += 1
        elif opening.kind != "(":
            return None
        self.place += 1
        self._deeper(opening.offset)
        return opening

    def _known_function(self, name: Token) -> None:
        allowed = ["sqrt"]
        if self.context.grid is not None:
            allowed.append("dt")
        if self.context.extrema:
            allowed += ["min", "max"]
        if name.text == "dt" in allowed and self.in_dt:
            raise FormulaError(name.offset, "dt(...) inside dt(...)", "equations are of first order in time")
        if name.text not in allowed:
            mend = "a product is written with *" if name.text in self.context.names else ""
            expected = f"{self.context.place} may use {', '.join(f'{f}(...)' for f in allowed)}"
            raise FormulaError(name.offset, f"{quoted(name.text)} is no function here", expected, mend)
        self.in_dt |= name.text == "dt"

    def _group(self, opening: Token, arguments: list[Value]) -> Value:
        if opening.kind == "(":
            self._single(opening, arguments, "parentheses hold")
            return arguments[0]
        if opening.text == "dt":
            self.in_dt = False
            self._single(opening, arguments, "dt takes")
            return self._derivative(opening, arguments[0])
        parameters = [a for a in arguments if isinstance(a, Expr)]
        if len(parameters) < len(arguments):
            raise FormulaError(opening.offset, f"{opening.text}(...) of a grid value", _LINEAR)
        with _Limits(opening.offset):
            if opening.text != "sqrt":
                return expression.extremum(opening.text, parameters)
            self._single(opening, arguments, "sqrt takes")
            return self._sqrt(opening, parameters[0])

    def _single(self, opening: Token, arguments: list[Value], holder: str) -> None:
        if len(arguments) != 1:
            raise FormulaError(opening.offset, f"found {len(arguments)} formulas", f"{holder} one")

    def _sqrt(self, opening: Token, radicand: Expr) -> Expr:
        if radicand.op == "num" and radicand.value < 0:
            raise FormulaError(opening.offset, "the square root of a negative number", "formulas are real")
        return expression.sqrt(radicand)

    def _derivative(self, opening: Token, value: Value) -> Value:
        if isinstance(value, Expr):
            raise FormulaError(opening.offset, "dt(...) of a parameter formula", "dt(...) is of grid values")
        with _Limits(opening.offset):
            if not self.context.is_zero(value.constant):
                raise FormulaError(opening.offset, "dt(...) with a constant term", "dt(...) is of grid values")
        discrete = self.context.grid.without_dt if self.context.grid else frozenset()
        for grid in value.terms:
            if grid.derivative:
                raise FormulaError(opening.offset, "dt(...) inside dt(...)", "equations are of first order in time")
            if grid.domain in discrete:
                expected = f"{grid.domain} is fully discrete: dt(...) belongs to the method of lines"
                raise FormulaError(opening.offset, f"dt(...) of {grid}", expected)
        return differentiated(value)

    def _power(self, base: Value, exponent: Value, offset: int) -> Value:
        if not isinstance(exponent, Expr) or exponent.op != "num" or exponent.value.denominator != 1:
            raise FormulaError(offset, "the exponent is not an integer", "exponents are integers, roots are sqrt(...)")
        if abs(exponent.value) > MAX_EXPONENT:
            raise FormulaError(offset, f"an exponent over {MAX_EXPONENT}", f"the limit is {MAX_EXPONENT}")
        k = int(exponent.value)
        if not isinstance(base, Expr):
            if k == 1:
                return base
            raise FormulaError(offset, "a power of a grid value", _LINEAR)
        if k < 0:
            base, k = self._reciprocal(base, offset), -k
        with _Limits(offset):
            return expression.power(base, k)

    # --- atoms: numbers, names and grid values ---------------------------------------------------------------------

    def _atom(self) -> Value:
        if literal := self.take("number"):
            return self._number(literal)
        if self.token.kind != "name":
            raise FormulaError(
                self.token.offset, f"found {self.found()} where a value should stand",
                "expected a number, a name, a grid value or a parenthesis",
                "an equation has one =" if self.token.kind == "=" else "",
            )  # fmt: skip
        if self.tokens[self.place + 1].kind in ("[", "."):
            if self.context.grid is None:
                raise FormulaError(self.token.offset, "a grid value", f"{self.context.place} holds parameters only")
            return Combination(number(0), {read_grid_value(self, self.context.grid): number(1)})
        return self._name(self.tokens[self.place])

    def _number(self, literal: Token) -> Expr:
        with _Limits(literal.offset):
            value = decimal(literal.text)
            self.context.work.spend(DIGIT_WORK * (value.numerator.bit_length() + value.denominator.bit_length()))
            return number(value)

    def _name(self, token: Token) -> Value:
        value = self.context.names.get(token.text)
        if value is not None:
            self.place += 1
            return value
        raise FormulaError(token.offset, *self._unknown_name(token.text))

    def _unknown_name(self, name: str) -> tuple[str, str, str]:
        """What is wrong with a name that stands for nothing here: found, expected, mend."""
        context, shown = self.context, quoted(name)
        if name in ("i", "n"):
            return f"{shown} stands alone", f"{shown} belongs inside the brackets of a grid value", ""
        if name in RESERVED:
            return f"{shown} without an argument", f"expected {name}(...)", ""
        if context.grid and any(name in unknowns for unknowns in context.grid.unknowns.values()):
            index = "0" if context.grid.interior is None else "i"
            return f"{shown} is an unknown without an index", f"expected a grid value such as {name}[{index}]", ""
        return f"{shown} is not defined", f"the names here are {listed(context.names)}", nearest(name, context.names)
