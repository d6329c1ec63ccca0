"""The value of a claim's formula, compared exactly with a number that was derived.

A formula with square roots, minima and maxima is evaluated in the exact field of the analysis: "equal" is proved by
algebra, "different" by balls. A decimal that a publication prints stands for every number that rounds to it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import ctx, fmpz_mpoly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Root, isolation
from gks.modes.coefficients import Coefficients, Ratio
from gks.modes.fibre import embed
from gks.modes.numerals import exact_fraction
from gks.scheme.expression import Expr
from gks.scheme.numbers import decimal

VALUE_BITS = 80
"""Precision of values that are printed: a double's 53 bits and enough to round them correctly."""


class ClaimField(Coefficients):
    """The exact field, with the order that min and max need."""

    __slots__ = ()

    def minimum(self, values: Sequence[Ratio]) -> Ratio:
        least = values[0]
        for value in values[1:]:
            least = value if self.sign(value - least) < 0 else least
        return least

    def maximum(self, values: Sequence[Ratio]) -> Ratio:
        return -self.minimum([-value for value in values])

    def number_of(self, root: Root) -> Ratio:
        """An algebraic number, real or not, as an element of the field."""
        rational = root.rational
        if rational is not None:
            return self.number(rational)
        minimal = root.minimal
        return self.adjoin(embed(minimal.poly, self.context, "x"), minimal)


def compare(formula: Expr, values: Mapping[str, Fraction], derived: Root) -> int:
    """The sign of formula - derived at the values, 0 only where they are proved equal.

    Raises ParameterError where the formula has no value, NotAnalysable where it holds too many irrational numbers.
    """
    field = ClaimField(values)
    return field.sign(field.evaluate(formula) - field.number_of(derived))


def compare_modulus(formula: Expr, values: Mapping[str, Fraction], z: Root) -> int:
    """The sign of formula - abs(z); as `compare`."""
    field = ClaimField(values)
    claimed = field.evaluate(formula)
    if field.sign(claimed) < 0:
        return -1
    if z.is_real:
        modulus = field.number_of(z)
        return field.sign(claimed - (modulus if field.sign(modulus) >= 0 else -modulus))
    return field.sign(claimed * claimed - field.number_of(z) * field.number_of(conjugate(z)))


def difference(one: Expr, other: Expr, values: Mapping[str, Fraction]) -> int:
    """The sign of one formula minus another at the values."""
    field = ClaimField(values)
    return field.sign(field.evaluate(one) - field.evaluate(other))


def value_of(formula: Expr, values: Mapping[str, Fraction], accuracy: int = VALUE_BITS) -> Fraction:
    """A rational within 2**-accuracy (relative) of the formula's value; the value itself where it is rational."""
    field = ClaimField(values)
    ratio = field.evaluate(formula)
    if ratio.num.is_constant() and ratio.den.is_constant():
        return Fraction(_integer(ratio.num), _integer(ratio.den))
    if field.is_zero(ratio.num):
        return Fraction(0)
    bits = accuracy
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            ball = (field.ball(ratio.num, bits) / field.ball(ratio.den, bits)).real
            if ball.rel_accuracy_bits() >= accuracy:
                return exact_fraction(ball)
        bits *= 2


def number_of(root: Root, accuracy: int = VALUE_BITS) -> Fraction:
    """A rational within 2**-accuracy (relative) of a real algebraic number; the number itself where it is rational."""
    return exact_fraction(root.ball(accuracy).real) if root.rational is None else root.rational


def both_sides(formula: Expr, values: Mapping[str, Fraction], derived: Root) -> tuple[Fraction, Fraction]:
    """(formula, derived) as rationals on the right sides of each other; the two must not be equal."""
    accuracy = VALUE_BITS
    while True:
        claimed, number = value_of(formula, values, accuracy), number_of(derived, accuracy)
        # Each is off by at most a 2**-accuracy of itself; a gap 16 times as wide is real, and has room inside.
        if abs(claimed - number) > 16 * max(abs(claimed), abs(number)) / 2**accuracy:
            return claimed, number
        accuracy *= 2


def _integer(constant: fmpz_mpoly) -> int:
    return int(constant.leading_coefficient()) if constant else 0


def conjugate(z: Root) -> Root:
    """The complex conjugate: the other root of the same polynomial (an `Isolation` keeps a pair together)."""
    if z.is_real:
        return z
    balls = isolation(z.poly).balls(START_BITS)
    mirrored = z.ball().conjugate()
    (index,) = (k for k, ball in enumerate(balls) if ball.overlaps(mirrored))
    return Root(z.poly, index)


# Decimals -----------------------------------------------------------------------------------------------------------


def printed_decimal(text: str) -> tuple[Fraction, Fraction] | None:
    """(value, half a unit of the last digit printed) of a text like 0.4397 or 7.4e-11; None for any other formula.

    A whole number without a point or exponent is meant exactly, and no decimal.
    """
    bare = text.strip()
    if not any(mark in bare for mark in ".eE"):
        return None
    try:
        value = decimal(bare)
    except ValueError:
        return None
    mantissa, _, exponent = bare.lower().partition("e")
    places = len(mantissa.partition(".")[2])
    return value, Fraction(10) ** (int(exponent or 0) - places) / 2


def rounds_to(derived: Root, printed: tuple[Fraction, Fraction]) -> int:
    """0 if a real number rounds to the decimal printed (a tie either way), else the sign of decimal - number."""
    value, half = printed
    if derived < Root.of(value - half):
        return 1
    return -1 if Root.of(value + half) < derived else 0
