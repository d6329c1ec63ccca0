"""Linear combinations of grid values while a formula is read: constant + sum(coefficient * grid value)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from gks.scheme.expression import Expr, add, mul, number
from gks.scheme.limits import TERM_WORK, Work
from gks.scheme.model import GridValue
from gks.scheme.zerotest import Range, test_work


@dataclass(frozen=True, slots=True)
class Combination:
    """An inhomogeneous linear form; the constant has to cancel by the end of an equation."""

    constant: Expr
    terms: Mapping[GridValue, Expr]


Value = Expr | Combination
"""What a part of a formula stands for: a parameter expression, or something that holds grid values."""

_MINUS_ONE = number(-1)


def negated(value: Value) -> Value:
    """Its negative."""
    return scaled(value, _MINUS_ONE, None)


def scaled(value: Value, factor: Expr, work: Work | None) -> Value:
    """Its product with a parameter expression."""
    if isinstance(value, Expr):
        return mul([factor, value])
    if work is not None:
        work.spend(TERM_WORK * len(value.terms))
    terms = {grid: mul([factor, coefficient]) for grid, coefficient in value.terms.items()}
    return Combination(mul([factor, value.constant]), terms)


def total(values: Sequence[Value], work: Work) -> Value:
    """The sum; coefficients of the same grid value are gathered first, so that long sums stay flat."""
    if len(values) == 1:
        return values[0]
    constants: list[Expr] = []
    gathered: dict[GridValue, list[Expr]] = {}
    for value in values:
        if isinstance(value, Expr):
            constants.append(value)
            continue
        work.spend(TERM_WORK * len(value.terms))
        constants.append(value.constant)
        for grid, coefficient in value.terms.items():
            gathered.setdefault(grid, []).append(coefficient)
    if not gathered:
        return add(constants)
    return Combination(add(constants), {grid: add(parts) for grid, parts in gathered.items()})


def differentiated(value: Combination) -> Combination:
    """dt(...) of a combination without constant."""
    return Combination(value.constant, {replace(grid, derivative=True): c for grid, c in value.terms.items()})


class ZeroTest:
    """Decides whether formulas vanish over the ranges of a file's parameters, remembers them, and meters the work."""

    def __init__(self, ranges: Mapping[str, Range], work: Work) -> None:
        self._ranges = ranges
        self._work = work
        self._known: dict[Expr, bool] = {}

    def __call__(self, expr: Expr) -> bool:
        """Raises ZeroDivisionError for a denominator that vanishes identically."""
        if expr.op in ("num", "sym"):
            return expr.op == "num" and not expr.value
        known = self._known.get(expr)
        if known is None:
            self._work.spend(test_work(expr))
            known = self._known[expr] = expr.identically_zero(self._ranges)
        return known

    def nonzero(self, terms: Iterable[tuple[GridValue, Expr]]) -> tuple[tuple[GridValue, Expr], ...]:
        """The terms whose coefficients do not vanish identically."""
        return tuple((grid, coefficient) for grid, coefficient in terms if not self(coefficient))
