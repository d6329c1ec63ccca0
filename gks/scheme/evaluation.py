"""Two readings of an expression: its exact value at given parameters, and its text."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from gks.errors import IrrationalValue, ParameterError
from gks.scheme.expression import Expr, rational_sqrt
from gks.scheme.limits import MAX_BITS, MULTIPLY_WORK

# Schoolbook gcd and division of b-bit integers cost about b**2; this many units are about a second of them, twenty
# operations on numbers of MAX_BITS. Checked before each operation on the sizes at hand.
_MAX_WORK = 20 * MAX_BITS**2


def value_work(expr: Expr, bits: int = 0) -> float:
    """About how long `exact_value` takes at most where the values have that many bits, in nanoseconds."""
    longest = 2 * expr.size.bits + bits * expr.size.degree
    return 2_000 * expr.size.written + min(MULTIPLY_WORK * longest**2 * expr.size.written, MULTIPLY_WORK * _MAX_WORK)


def exact_value(expr: Expr, values: Mapping[str, Fraction]) -> Fraction:
    """The value at exact parameters, see `Expr.at`."""
    return expr.fold(_Exact({name: values[name] for name in sorted(expr.symbols) if name in values}))


class _Exact:
    """Rational arithmetic that looks at the size of its operands before it computes."""

    def __init__(self, values: Mapping[str, Fraction]) -> None:
        self.values = values
        self.work = 0

    def number(self, value: Fraction) -> Fraction:
        return value

    def symbol(self, name: str) -> Fraction:
        if name not in self.values:
            raise ParameterError("no value is given for it", path=name, mend=f"set it with -p {name}=...")
        return Fraction(self.values[name])

    def add(self, terms: Sequence[Fraction]) -> Fraction:
        return self._balanced(terms, lambda a, b: a + b)

    def mul(self, factors: Sequence[Fraction]) -> Fraction:
        return self._balanced(factors, lambda a, b: a * b)

    def power(self, base: Fraction, exponent: int) -> Fraction:
        if exponent < 0 and not base:
            raise ParameterError(f"division by zero at {self._point()}", mend="take other values")
        if base not in (-1, 0, 1):
            self._spend(_bits(base) * abs(exponent))
        return Fraction(base**exponent)

    def sqrt(self, radicand: Fraction) -> Fraction:
        if radicand < 0:
            raise ParameterError(f"the square root of a negative number at {self._point()}", mend="take other values")
        self._spend(_bits(radicand))
        root = rational_sqrt(radicand)
        if root is None:
            raise IrrationalValue(f"the square root is irrational at {self._point()}")
        return root

    def minimum(self, values: Sequence[Fraction]) -> Fraction:
        return min(values)

    def maximum(self, values: Sequence[Fraction]) -> Fraction:
        return max(values)

    def _balanced(self, parts: Sequence[Fraction], combine: Callable[[Fraction, Fraction], Fraction]) -> Fraction:
        """Combine neighbours pairwise, then the results, and so on: long operands meet only at the end."""
        row = list(parts)
        while len(row) > 1:
            pairs = range(0, len(row) - 1, 2)
            for k in pairs:
                self._spend(_bits(row[k]) + _bits(row[k + 1]))
            row = [combine(row[k], row[k + 1]) for k in pairs] + row[len(row) - len(row) % 2 :]
        return row[0]

    def _spend(self, bits: int) -> None:
        self.work += bits * bits
        if bits > 2 * MAX_BITS or self.work > _MAX_WORK:
            raise ParameterError(
                f"the exact value of a formula needs over {MAX_BITS} bits at {self._point()}",
                mend="take values with fewer digits or nearer to 1",
            )

    def _point(self) -> str:
        shown = [f"{name} = {_shown(Fraction(value))}" for name, value in self.values.items()]
        return ", ".join(shown[:6]) if shown else "any parameters"


def _bits(value: Fraction) -> int:
    return value.numerator.bit_length() + value.denominator.bit_length()


def _shown(value: Fraction) -> str:
    """A rational for a message: exact while short, else to a few digits."""
    if _bits(value) <= 200:
        return str(value)
    from gks.scheme.numbers import decimal_text

    return decimal_text(value)


def formula_text(expr: Expr) -> str:
    """The expression as text that the formula parser reads back and sympy reads too: `(1 + 1/alpha)/2`."""
    return expr.fold(_Text()).alone


@dataclass(frozen=True, slots=True)
class _Piece:
    """A text as a signed quotient of factors, each fit to stand in a product; `unsigned` is it standing alone."""

    unsigned: str
    above: tuple[str, ...]
    below: tuple[str, ...] = ()
    negative: bool = False
    atom: bool = False  # whether it can be raised to a power as it is

    @property
    def alone(self) -> str:
        return "-" + self.unsigned if self.negative else self.unsigned


class _Text:
    """Text with as few parentheses as the precedences of the formula language allow."""

    def number(self, value: Fraction) -> _Piece:
        above = (_digits(abs(value.numerator)),) if abs(value.numerator) != 1 else ()
        below = (_digits(value.denominator),) if value.denominator != 1 else ()
        return _quotient(above, below, value < 0)

    def symbol(self, name: str) -> _Piece:
        return _Piece(name, (name,), atom=True)

    def add(self, terms: Sequence[_Piece]) -> _Piece:
        rest = (f" - {t.unsigned}" if t.negative else f" + {t.unsigned}" for t in terms[1:])
        text = terms[0].alone + "".join(rest)
        return _Piece(text, (f"({text})",))

    def mul(self, factors: Sequence[_Piece]) -> _Piece:
        above = tuple(text for f in factors for text in f.above)
        below = tuple(text for f in factors for text in f.below)
        return _quotient(above, below, sum(f.negative for f in factors) % 2 == 1)

    def power(self, base: _Piece, exponent: int) -> _Piece:
        if exponent == -1:
            return _quotient(base.below, base.above, base.negative)
        text = f"{base.unsigned if base.atom else f'({base.alone})'}**{abs(exponent)}"
        return _quotient((text,), ()) if exponent > 0 else _quotient((), (text,))

    def sqrt(self, radicand: _Piece) -> _Piece:
        return self._call("sqrt", [radicand])

    def minimum(self, values: Sequence[_Piece]) -> _Piece:
        return self._call("min", values)

    def maximum(self, values: Sequence[_Piece]) -> _Piece:
        return self._call("max", values)

    def _call(self, name: str, arguments: Sequence[_Piece]) -> _Piece:
        text = f"{name}({', '.join(a.alone for a in arguments)})"
        return _Piece(text, (text,), atom=True)


def _quotient(above: tuple[str, ...], below: tuple[str, ...], negative: bool = False) -> _Piece:
    text = "*".join(above) or "1"
    if below:
        text += f"/{below[0]}" if len(below) == 1 else f"/({'*'.join(below)})"
    return _Piece(text, above, below, negative, atom=not below and text.isdigit() and not negative)


def _digits(value: int) -> str:
    """A positive integer; beyond 1000 digits in blocks, `((12)*10**1000 + 345)`, since Python refuses to print longer
    ones and the formula language to raise to higher powers."""
    block = 10**1000
    blocks = []
    while value >= block:
        value, low = divmod(value, block)
        blocks.append(low)
    text = str(value)
    for low in reversed(blocks):
        text = f"({text}*10**1000 + {low})" if low else f"({text}*10**1000)"
    return text
