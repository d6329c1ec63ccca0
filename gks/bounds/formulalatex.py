"""A formula in LaTeX."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import NamedTuple

from gks.modes.printing import latex_name
from gks.scheme.expression import Expr
from gks.scheme.numbers import integer_text


class _Part(NamedTuple):
    """LaTeX with what its neighbours must know: whether it is a sum, what it is a reciprocal of, its value if a
    number.
    """

    text: str
    is_sum: bool = False
    below: str | None = None
    value: Fraction | None = None

    @property
    def factor(self) -> str:
        return rf"\left({self.text}\right)" if self.is_sum else self.text


def latex(formula: Expr) -> str:
    """The formula as LaTeX, divisions as fractions."""
    return _standing(formula.fold(_Latex()))


def _standing(part: _Part) -> str:
    """A part on its own, or as a summand."""
    return rf"\frac{{1}}{{{part.below}}}" if part.below is not None else part.text


class _Latex:
    def number(self, value: Fraction) -> _Part:
        size, sign = abs(value), "-" if value < 0 else ""
        text = integer_text(size.numerator)
        if size.denominator != 1:
            text = rf"\frac{{{text}}}{{{integer_text(size.denominator)}}}"
        return _Part(sign + text, value=value)

    def symbol(self, name: str) -> _Part:
        return _Part(latex_name(name))

    def add(self, terms: Sequence[_Part]) -> _Part:
        text = ""
        for own in map(_standing, terms):
            text += own if not text else f" - {own[1:]}" if own.startswith("-") else f" + {own}"
        return _Part(text, is_sum=True)

    def mul(self, factors: Sequence[_Part]) -> _Part:
        """Numbers and signs in front, everything divided by below one bar."""
        constant = Fraction(1)
        above: list[_Part] = []
        for part in factors:
            if part.value is not None:
                constant *= part.value
            elif part.below is None and not part.is_sum and part.text.startswith("-"):
                constant = -constant
                above.append(_Part(part.text[1:]))
            elif part.below is None:
                above.append(part)
        below = [part for part in factors if part.below is not None]
        sign, constant = "-" if constant < 0 else "", abs(constant)
        top = self._row(constant.numerator, above, alone=bool(below) or constant.denominator > 1)
        if constant.denominator == 1 and not below:
            return _Part(sign + top)
        bottom = [
            rf"\left({b.below}\right)" if b.is_sum and (len(below) > 1 or constant.denominator > 1) else f"{b.below}"
            for b in below
        ]
        divisor = [integer_text(constant.denominator)] if constant.denominator > 1 else []
        return _Part(rf"{sign}\frac{{{top}}}{{{' '.join(divisor + bottom)}}}")

    def _row(self, number: int, factors: Sequence[_Part], *, alone: bool) -> str:
        """A product; a sum that stands alone above a bar needs no parentheses."""
        if number == 1 and len(factors) == 1 and alone:
            return factors[0].text
        return " ".join(([integer_text(number)] if number != 1 or not factors else []) + [f.factor for f in factors])

    def power(self, base: _Part, exponent: int) -> _Part:
        size = abs(exponent)
        body = base.text if size == 1 else f"{base.factor}^{{{size}}}"
        return _Part("", is_sum=base.is_sum and size == 1, below=body) if exponent < 0 else _Part(body)

    def sqrt(self, radicand: _Part) -> _Part:
        return _Part(rf"\sqrt{{{radicand.text}}}")
