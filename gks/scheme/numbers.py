"""Numbers as people write them, read as the exact rationals they spell: 0.9 is 9/10, 1e-10 is 1/10**10."""

from __future__ import annotations

import re
from decimal import Decimal
from fractions import Fraction
from math import log10

from gks.errors import TooLarge, quoted
from gks.scheme.limits import MAX_DECIMAL_EXPONENT, MAX_DIGITS

_DECIMAL = re.compile(r"([+-]?)(?:([0-9]+)(?:\.([0-9]*))?|\.([0-9]+))(?:[eE]([+-]?[0-9]+))?", re.ASCII)


def rational(text: str) -> Fraction:
    """The exact value of "0.9", "1e-10", "-3" or "9/10".

    ValueError if it is no finite number, TooLarge if it is over the limits.
    """
    above, slash, below = text.partition("/")
    if not slash:
        return decimal(text)
    divisor = decimal(below.strip())
    if not divisor:
        raise ValueError(f"{quoted(text)} divides by zero")
    return decimal(above.strip()) / divisor


def decimal(text: str) -> Fraction:
    """The exact value of a decimal with an optional exponent; the exponent is checked before the power is built."""
    match = _DECIMAL.fullmatch(text)
    if match is None:
        raise ValueError(f"{quoted(text)} is not a number")
    sign, whole, after_point, only_after_point, exponent_text = match.groups(default="")
    places = after_point or only_after_point
    digits = (whole + places).lstrip("0")
    size = exponent_text.lstrip("+-").lstrip("0") or "0"
    if len(size) > 5 or int(size) > MAX_DECIMAL_EXPONENT:
        raise TooLarge(f"the decimal exponent {quoted(exponent_text, 20)} is over the limit {MAX_DECIMAL_EXPONENT}")
    exponent = -int(size) if exponent_text.startswith("-") else int(size)
    if len(digits) > MAX_DIGITS or len(places) > MAX_DIGITS:
        raise TooLarge(f"a number of {max(len(digits), len(places))} digits is over the limit {MAX_DIGITS}")
    mantissa = int(digits or "0") * (-1 if sign == "-" else 1)
    shift = exponent - len(places)
    if not mantissa:
        return Fraction(0)
    return Fraction(mantissa * 10**shift) if shift >= 0 else Fraction(mantissa, 10**-shift)


def integer_text(value: int) -> str:
    """The number itself, as ``str`` has it; Python's own refuses more than 4300 digits, which 1e5000 has."""
    return f"{Decimal(value):f}"


def fraction_text(value: Fraction) -> str:
    """The number itself, as ``str`` has it, however long."""
    top = integer_text(value.numerator)
    return top if value.denominator == 1 else f"{top}/{integer_text(value.denominator)}"


def decimal_text(value: Fraction, digits: int = 6) -> str:
    """The value rounded to a few significant digits, for messages: 1.23457e-400. Any size."""
    if not value:
        return "0"
    top, bottom = abs(value.numerator), value.denominator
    exponent = int((top.bit_length() - bottom.bit_length()) * log10(2)) - 1  # at most one or two too small
    while top * 10 ** max(-exponent - 1, 0) >= bottom * 10 ** max(exponent + 1, 0):
        exponent += 1
    shift = digits - 1 - exponent
    text = str(round(Fraction(top * 10 ** max(shift, 0), bottom * 10 ** max(-shift, 0))))
    exponent += len(text) - digits  # 9.999996 rounds up to 10
    mantissa = f"{text[0]}.{text[1:digits]}".rstrip("0").rstrip(".")
    return f"{'-' if value < 0 else ''}{mantissa}e{exponent}"
