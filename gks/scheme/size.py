"""How large a formula would be if it were multiplied out, bounded without doing so."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb, log2

from gks.errors import TooLarge
from gks.scheme.limits import MAX_BITS, MAX_DEGREE, MAX_WRITTEN


@dataclass(frozen=True, slots=True)
class Size:
    """Upper bounds for an expression seen as numerator / denominator, integer polynomials in its symbols.

    numerator_degree, denominator_degree   total degrees
    numerator_bits, denominator_bits       log2 of the sum of the absolute values of the coefficients
    written                                nodes of the formula with shared parts repeated

    The bounds hold for the fraction as it is formed without any cancellation, and so for the numerator and
    denominator of every part of the expression too. A square root counts as half of its radicand.
    """

    numerator_degree: int
    denominator_degree: int
    numerator_bits: float
    denominator_bits: float
    written: int

    @property
    def degree(self) -> int:
        return max(self.numerator_degree, self.denominator_degree)

    @property
    def bits(self) -> float:
        return max(self.numerator_bits, self.denominator_bits)

    def terms(self, symbols: int) -> int:
        """The most monomials that numerator or denominator can have in that many symbols."""
        return comb(self.degree + symbols, symbols)

    def checked(self) -> Size:
        """Itself; TooLarge if a bound is over its limit."""
        if self.degree > MAX_DEGREE:
            raise TooLarge(f"the formula has degree {self.degree} multiplied out and the limit is {MAX_DEGREE}")
        if self.bits > MAX_BITS:
            raise TooLarge(
                f"the formula has coefficients of {self.bits:.0f} bits multiplied out and the limit is {MAX_BITS}"
            )
        if self.written > MAX_WRITTEN:
            raise TooLarge(
                f"the formula has {self.written} parts with its shorthands written out and the limit is {MAX_WRITTEN}"
            )
        return self


def number_size(numerator: int, denominator: int) -> Size:
    """A rational number."""
    return Size(0, 0, _bits(numerator), _bits(denominator), 1)


def sum_size(sizes: Sequence[Size]) -> Size:
    """A sum over the product of all denominators."""
    degree = sum(s.denominator_degree for s in sizes)
    bits = sum(s.denominator_bits for s in sizes)
    return Size(
        max(s.numerator_degree - s.denominator_degree for s in sizes) + degree,
        degree,
        max(s.numerator_bits - s.denominator_bits for s in sizes) + bits + log2(len(sizes)),
        bits,
        1 + sum(s.written for s in sizes),
    )


def product_size(sizes: Sequence[Size]) -> Size:
    """A product: degrees add, and the sum of abs(coefficients) is at most the product of those of the factors."""
    return Size(
        sum(s.numerator_degree for s in sizes),
        sum(s.denominator_degree for s in sizes),
        sum(s.numerator_bits for s in sizes),
        sum(s.denominator_bits for s in sizes),
        1 + sum(s.written for s in sizes),
    )


def power_size(base: Size, exponent: int) -> Size:
    """An integer power; a negative one swaps numerator and denominator."""
    k = abs(exponent)
    degrees = (k * base.numerator_degree, k * base.denominator_degree)
    bits = (k * base.numerator_bits, k * base.denominator_bits)
    if exponent < 0:
        degrees, bits = (degrees[1], degrees[0]), (bits[1], bits[0])
    return Size(*degrees, *bits, base.written + 1)


def sqrt_size(radicand: Size) -> Size:
    """A square root counts as half of its radicand."""
    return Size(
        (radicand.numerator_degree + 1) // 2,
        (radicand.denominator_degree + 1) // 2,
        radicand.numerator_bits / 2,
        radicand.denominator_bits / 2,
        radicand.written + 1,
    )


def largest_size(sizes: Sequence[Size]) -> Size:
    """The largest or smallest of several values."""
    return Size(
        max(s.numerator_degree for s in sizes),
        max(s.denominator_degree for s in sizes),
        max(s.numerator_bits for s in sizes),
        max(s.denominator_bits for s in sizes),
        1 + sum(s.written for s in sizes),
    )


def _bits(integer: int) -> float:
    """log2 of abs(integer), rounded up to whole bits; 0 for 0 and 1."""
    return float((abs(integer) - 1).bit_length()) if integer else 0.0
