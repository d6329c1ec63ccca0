"""A formula in LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from gks.modes.printing import latex_name
from gks.scheme.expression import Expr


class _Part(NamedTuple):
    """LaTeX with what its neighbours must know: a sum, a negative, what it is a reciprocal of, whether a number."""

    text: str
    is_sum: bool = False
    below: str | None = None
    is_number: bool = False

    @property
    def factor(self) -> str:
        return rf"\left({self.text}\right)" if self.is_sum else self.text


def latex(formula: Expr) -> str:
    """The formula as LaTeX, divisions as fractions."""
    part = formula.fold(_Latex())
    return rf"\frac{{1}}{{{part.below}}}" if part.below is not None else part.text


class _Latex:
    def number(self, value: Fraction) -> _Part:
        if value.denominator == 1:
            return _Part(str(value), is_number=True)
        sign = "-" if value < 0 else ""
        return _Part(rf"{sign}\frac{{{abs(value.numerator)}}}{{{value.denominator}}}", is_number=True)

    def symbol(self, name: str) -> _Part:
        return _Part(latex_name(name))

    def add(self, terms: Sequence[_Part]) -> _Part:
        text = ""
        for term in terms:
            own = rf"\frac{{1}}{{{term.below}}}" if term.below is not None else term.text
            text += own if not text else f" - {own[1:]}" if own.startswith("-") else f" + {own}"
        return _Part(text, is_sum=True)

    def mul(self, factors: Sequence[_Part]) -> _Part:
        above = [f for f in factors if f.below is None]
        below = [f for f in factors if f.below is not None]
        sign = ""
        if above and above[0].text.startswith("-") and above[0].is_number:
            sign, rest = "-", above[0].text[1:]
            above = above[1:] if rest == "1" else [_Part(rest, is_number=True), *above[1:]]
        if not below:
            return _Part(sign + (" ".join(f.factor for f in above) or "1"))
        top = above[0].text if len(above) == 1 else " ".join(f.factor for f in above) or "1"
        bottom = (f"\\left({f.below}\\right)" if f.is_sum and len(below) > 1 else f"{f.below}" for f in below)
        return _Part(rf"{sign}\frac{{{top}}}{{{' '.join(bottom)}}}")

    def power(self, base: _Part, exponent: int) -> _Part:
        size = abs(exponent)
        body = base.text if size == 1 else f"{base.factor}^{{{size}}}"
        return _Part("", is_sum=base.is_sum and size == 1, below=body) if exponent < 0 else _Part(body)

    def sqrt(self, radicand: _Part) -> _Part:
        return _Part(rf"\sqrt{{{radicand.text}}}")
