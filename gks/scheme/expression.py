"""Exact parameter expressions: immutable graphs that are never expanded and never evaluated as a program.

An `Expr` is a number (an exact rational), a symbol, a sum, a product, an integer power or a square root; in
the claims of a scheme file also a minimum or maximum. Shared parts stay shared (a definition that is used a
thousand times is one node), every walk over the graph visits each node once and does not recurse, and every
node carries an upper bound of what it would be if it were multiplied out (`Size`), so that whoever expands
it knows the cost before paying it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import isqrt
from typing import Protocol, TypeVar, cast

from gks.scheme.limits import MAX_EXPONENT
from gks.scheme.size import Size, largest_size, number_size, power_size, product_size, sqrt_size, sum_size

T = TypeVar("T")

# Constants are folded while they stay below this; beyond it they remain as written (and are as exact), so that
# building an expression never does long arithmetic.
_FOLD_BITS = 2048


class Algebra(Protocol[T]):
    """Where an expression can be evaluated: exact rationals, polynomials, balls, arrays, text."""

    def number(self, value: Fraction, /) -> T: ...
    def symbol(self, name: str, /) -> T: ...
    def add(self, terms: Sequence[T], /) -> T: ...
    def mul(self, factors: Sequence[T], /) -> T: ...
    def power(self, base: T, exponent: int, /) -> T: ...
    def sqrt(self, radicand: T, /) -> T: ...


class OrderedAlgebra(Algebra[T], Protocol[T]):
    """An algebra with an order: needed only for the formulas of claims, which may hold min and max."""

    def minimum(self, values: Sequence[T], /) -> T: ...
    def maximum(self, values: Sequence[T], /) -> T: ...


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Expr:
    """One node of an exact expression; build it with `number`, `symbol`, `add`, `mul`, `sqrt` and operators.

    op        "num", "sym", "add", "mul", "pow", "sqrt", "min" or "max"
    value     the number of a "num"
    name      the name of a "sym"
    exponent  the exponent of a "pow": any integer but 0 and 1, negative for a division
    args      the parts of the others
    symbols   every name in it
    rational  whether it is free of sqrt, min and max: a quotient of polynomials
    """

    op: str
    value: Fraction
    name: str
    exponent: int
    args: tuple[Expr, ...]
    symbols: frozenset[str]
    rational: bool
    size: Size
    _hash: int

    def fold(self, algebra: Algebra[T]) -> T:
        """Evaluate bottom-up in the algebra, each shared node once, without recursion; intermediate results are
        dropped after their last use.

        A formula with min or max needs an `OrderedAlgebra`.
        """
        order = list(self.nodes())
        uses = Counter(id(arg) for node in order for arg in node.args)
        results: dict[int, T] = {}
        for node in order:
            parts = [results[id(arg)] for arg in node.args]
            results[id(node)] = _combined(node, parts, algebra)
            for arg in node.args:
                uses[id(arg)] -= 1
                if not uses[id(arg)]:
                    del results[id(arg)]
        return results[id(self)]

    def nodes(self) -> Iterable[Expr]:
        """Every distinct node, parts before wholes."""
        seen: set[int] = set()
        stack: list[tuple[Expr, bool]] = [(self, False)]
        while stack:
            node, parts_done = stack.pop()
            if parts_done:
                yield node
            elif id(node) not in seen:
                seen.add(id(node))
                stack.append((node, True))
                stack.extend((arg, False) for arg in reversed(node.args))

    def at(self, values: Mapping[str, Fraction]) -> Fraction:
        """The exact value. Raises ParameterError (division by zero, no value, sqrt of a negative number, a
        number beyond MAX_BITS) or IrrationalValue."""
        from gks.scheme.evaluation import exact_value

        return exact_value(self, values)

    def identically_zero(self, ranges: Mapping[str, tuple[Fraction | None, Fraction | None]] | None = None) -> bool:
        """Whether the expression vanishes as a formula, not merely at some values: see `gks.scheme.zerotest`."""
        from gks.scheme.zerotest import identically_zero

        return identically_zero(self, ranges or {})

    def __str__(self) -> str:
        from gks.scheme.evaluation import formula_text

        return formula_text(self)

    def __repr__(self) -> str:
        return f"Expr({self})"

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        """The same formula, term by term in the same order. (Use identically_zero of a difference for equal values.)"""
        if not isinstance(other, Expr):
            return NotImplemented
        return _same(self, other)

    def __add__(self, other: Expr | Fraction | int) -> Expr:
        return add([self, as_expr(other)])

    def __sub__(self, other: Expr | Fraction | int) -> Expr:
        return add([self, -as_expr(other)])

    def __mul__(self, other: Expr | Fraction | int) -> Expr:
        return mul([self, as_expr(other)])

    def __truediv__(self, other: Expr | Fraction | int) -> Expr:
        return mul([self, power(as_expr(other), -1)])

    def __radd__(self, other: Fraction | int) -> Expr:
        return as_expr(other) + self

    def __rsub__(self, other: Fraction | int) -> Expr:
        return as_expr(other) - self

    def __rmul__(self, other: Fraction | int) -> Expr:
        return as_expr(other) * self

    def __rtruediv__(self, other: Fraction | int) -> Expr:
        return as_expr(other) / self

    def __neg__(self) -> Expr:
        return mul([number(-1), self])

    def __pos__(self) -> Expr:
        return self

    def __pow__(self, exponent: int) -> Expr:
        return power(self, exponent)


_NOTHING: frozenset[str] = frozenset()


def number(value: Fraction | int) -> Expr:
    """An exact rational constant."""
    if isinstance(value, int):
        return _integer(value) if -99 < value < 99 else _number(Fraction(value))
    return _number(value)


@lru_cache(maxsize=200)
def _integer(value: int) -> Expr:
    return _number(Fraction(value))


def _number(value: Fraction) -> Expr:
    top, bottom = value.numerator, value.denominator
    size = number_size(top, bottom).checked()
    return Expr("num", value, "", 0, (), _NOTHING, True, size, hash((top, bottom)))


def symbol(name: str) -> Expr:
    """A parameter."""
    return Expr("sym", _ZERO, name, 0, (), frozenset({name}), True, Size(1, 0, 0.0, 0.0, 1), hash(("sym", name)))


def as_expr(value: Expr | Fraction | int) -> Expr:
    """The expression itself, or a number as one."""
    return value if isinstance(value, Expr) else number(value)


def add(terms: Sequence[Expr]) -> Expr:
    """The sum of any number of terms, constants gathered into one where the first stood and zeros left out."""
    constant, place = _ZERO, 0
    rest: list[Expr] = []
    if len(terms) == 1:
        return terms[0]
    for term in terms:
        if term.op != "num" or _short(constant) + _short(term.value) > _FOLD_BITS:
            rest.append(term)
        else:
            place = place if constant else len(rest)
            constant += term.value
    if constant or not rest:
        rest.insert(place, number(constant))
    if len(rest) == 1:
        return rest[0]
    return _node("add", tuple(rest), sum_size([term.size for term in rest]))


def mul(factors: Sequence[Expr]) -> Expr:
    """The product of any number of factors, constants gathered into one in front and ones left out."""
    if len(factors) == 2:  # by 1, for speed: every grid value is read with the coefficient 1
        first, second = factors
        if first.value == 1:
            return second
        if second.value == 1:
            return first
    constant = _ONE
    rest: list[Expr] = []
    for factor in factors:
        if factor.op == "num" and not factor.value:
            return factor
        if factor.op != "num" or _short(constant) + _short(factor.value) > _FOLD_BITS:
            rest.append(factor)
        else:
            constant *= factor.value
    if constant != 1 or not rest:
        rest.insert(0, number(constant))
    if len(rest) == 1:
        return rest[0]
    if len(rest) == 2 and rest[0].op == "num" and rest[1].op == "mul" and rest[1].args[0].op == "num":
        return mul([*rest[1].args, rest[0]])  # -(2*x) is -2*x
    return _node("mul", tuple(rest), product_size([factor.size for factor in rest]))


def power(base: Expr, exponent: int) -> Expr:
    """An integer power, negative for a reciprocal. ZeroDivisionError for a reciprocal of the number 0."""
    if exponent == 0:
        return number(1)
    if exponent == 1:
        return base
    if base.op == "num":
        if exponent < 0 and not base.value:
            raise ZeroDivisionError("division by zero")
        if _short(base.value) * abs(exponent) <= _FOLD_BITS or abs(base.value) in (0, 1) or exponent == -1:
            return number(base.value**exponent)
    if base.op == "pow" and abs(base.exponent * exponent) <= MAX_EXPONENT:
        return power(base.args[0], base.exponent * exponent)
    return _node("pow", (base,), power_size(base.size, exponent), exponent)


def sqrt(radicand: Expr) -> Expr:
    """The principal square root; that of a small perfect square is folded. ValueError for a negative number."""
    if radicand.op == "num":
        if radicand.value < 0:
            raise ValueError("sqrt of a negative number")
        if _short(radicand.value) <= _FOLD_BITS:
            root = rational_sqrt(radicand.value)
            if root is not None:
                return number(root)
    return _node("sqrt", (radicand,), sqrt_size(radicand.size))


def extremum(op: str, values: Sequence[Expr]) -> Expr:
    """min or max (op "min" or "max") of one or more expressions; for the formulas of claims alone."""
    if len(values) == 1:
        return values[0]
    return _node(op, tuple(values), largest_size([value.size for value in values]))


def rational_sqrt(value: Fraction) -> Fraction | None:
    """The exact square root of a rational number >= 0, or None where it is irrational."""
    top, bottom = isqrt(value.numerator), isqrt(value.denominator)
    if top * top == value.numerator and bottom * bottom == value.denominator:
        return Fraction(top, bottom)
    return None


_ZERO, _ONE = Fraction(0), Fraction(1)


def _combined(node: Expr, parts: Sequence[T], algebra: Algebra[T]) -> T:
    """The node's own operation in an algebra."""
    match node.op:
        case "num":
            return algebra.number(node.value)
        case "sym":
            return algebra.symbol(node.name)
        case "add":
            return algebra.add(parts)
        case "mul":
            return algebra.mul(parts)
        case "pow":
            return algebra.power(parts[0], node.exponent)
        case "sqrt":
            return algebra.sqrt(parts[0])
        case "min":
            return cast("OrderedAlgebra[T]", algebra).minimum(parts)
        case _:
            return cast("OrderedAlgebra[T]", algebra).maximum(parts)


def _node(op: str, args: tuple[Expr, ...], size: Size, exponent: int = 0) -> Expr:
    widest = max((a.symbols for a in args), key=len)
    symbols = widest if all(a.symbols <= widest for a in args) else widest.union(*(a.symbols for a in args))
    rational = op in ("add", "mul", "pow") and all(a.rational for a in args)
    key = hash((op, exponent, tuple(a._hash for a in args)))
    return Expr(op, _ZERO, "", exponent, args, symbols, rational, size.checked(), key)


def _short(value: Fraction) -> int:
    return value.numerator.bit_length() + value.denominator.bit_length()


def _same(a: Expr, b: Expr) -> bool:
    """Structural equality, without recursion and each pair of nodes once."""
    seen: set[tuple[int, int]] = set()
    stack = [(a, b)]
    while stack:
        x, y = stack.pop()
        if x is y or (id(x), id(y)) in seen:
            continue
        seen.add((id(x), id(y)))
        if (x._hash, x.op, x.value, x.name, x.exponent) != (y._hash, y.op, y.value, y.name, y.exponent):
            return False
        if len(x.args) != len(y.args):
            return False
        stack.extend(zip(x.args, y.args, strict=True))
    return True
