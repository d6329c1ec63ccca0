"""Exact numbers on their way out: doubles where they fit, decimal strings beyond, readable text."""

from __future__ import annotations

from decimal import Context, Decimal
from fractions import Fraction
from math import frexp, isfinite

from flint import acb, arb

ComplexNumber = tuple[Fraction, Fraction]

_DIGITS = 17
"""Decimal digits that determine a double; numbers beyond a double's range are printed with as many."""

_MOST_DIGITS = 1000
"""Decimal digits up to which a number is printed exactly."""


def to_double(value: Fraction) -> float | None:
    """The nearest double, None where it overflows or a nonzero number would become 0 or lose bits as a subnormal."""
    try:
        double = float(value)
    except OverflowError:
        return None
    if not isfinite(double) or (value and (not double or frexp(double)[1] < -1021)):
        return None
    return double


def json_real(value: Fraction) -> float | str:
    """A JSON number where a double holds it, else a decimal string."""
    double = to_double(value)
    return decimal_text(value) if double is None else double


def json_complex(value: ComplexNumber) -> list[float | str]:
    """[re, im]."""
    return [json_real(value[0]), json_real(value[1])]


def rounding_of(value: ComplexNumber) -> Fraction:
    """How far the JSON form of a complex number may lie from it: exact for doubles, a unit of the last digit beyond."""
    total = Fraction(0)
    for part in value:
        double = to_double(part)
        total += abs(part) / 10 ** (_DIGITS - 1) if double is None else abs(part - Fraction(double))
    return total


def decimal_text(value: Fraction, digits: int = _DIGITS) -> str:
    """Decimal with an exponent, rounded to the digits given; any size."""
    context = Context(prec=digits, Emax=10**9, Emin=-(10**9))
    numerator = context.create_decimal(Decimal(value.numerator))
    return str(context.divide(numerator, Decimal(value.denominator)).normalize(context)).lower()


def text_real(value: Fraction) -> str:
    """At most 15 significant digits."""
    double = to_double(value)
    if double is None:
        return decimal_text(value, 15)
    return f"{double:.15g}"


def text_exact(value: Fraction) -> str:
    """The number itself: by `text_real` or a longer decimal where one spells it, else a fraction, unless too long."""
    for text in (text_real(value), decimal_text(value, _MOST_DIGITS)):
        if Fraction(text) == value:
            return text
    short = max(abs(value.numerator), value.denominator) < 10**_MOST_DIGITS
    return str(value) if short else f"about {text_real(value)}"


def text_complex(value: ComplexNumber, *, latex: bool = False) -> str:
    """a + bi to 15 significant digits each, parts that are exactly 0 left out."""
    real, imaginary = value
    unit = r"\mathrm{i}" if latex else "i"
    if not imaginary:
        return text_real(real)
    sign = "-" if imaginary < 0 else "+"
    size = text_real(abs(imaginary))
    if not real:
        return f"{'-' if imaginary < 0 else ''}{size}{unit}"
    return f"{text_real(real)} {sign} {size}{unit}"


def exact_fraction(value: arb) -> Fraction:
    """The midpoint of a ball, exactly."""
    mantissa, exponent = value.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def midpoint(value: acb) -> ComplexNumber:
    """The midpoint of a complex ball, exactly."""
    return exact_fraction(value.real), exact_fraction(value.imag)


def radius_of(value: acb) -> Fraction:
    """An upper bound of the distance from the midpoint to any number in the ball."""
    return exact_fraction(value.real.rad()) + exact_fraction(value.imag.rad())


def modulus_of(value: acb) -> Fraction:
    """The midpoint of a ball around the modulus."""
    return exact_fraction(abs(value))
