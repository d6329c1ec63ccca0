"""The values a sweep runs over: `alpha=1e-4:1e4:401:log`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Context, Decimal
from fractions import Fraction

from gks.errors import ParameterError, TooLarge, quoted
from gks.scheme.numbers import rational

MAX_POINTS = 10_000_000
"""Points of one sweep: its arrays then fit in about a gigabyte."""

_DIGITS = Context(prec=17, Emax=10**6, Emin=-(10**6))
"""Logarithmic points are rounded to the digits that determine a double, at any size."""


Point = Fraction | float
"""A value of the parameter, exact either way: a float stands for the number it holds."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """A parameter and the values it takes, in order."""

    name: str
    values: tuple[Point, ...]
    logarithmic: bool


def parse_sweep(text: str) -> Sweep:
    """Reads `NAME=LOW:HIGH:POINTS` or `NAME=LOW:HIGH:POINTS:log`; ParameterError says what is wrong."""
    name, equals, spec = text.partition("=")
    parts = spec.split(":")
    if not equals or len(parts) not in (3, 4) or (len(parts) == 4 and parts[3] not in ("log", "lin")):
        raise ParameterError(
            f"the sweep {quoted(text)} is not understood",
            path="--sweep",
            expected="NAME=LOW:HIGH:POINTS or NAME=LOW:HIGH:POINTS:log",
            mend="for example --sweep alpha=1e-4:1e4:401:log",
        )
    low, high = _number(name, parts[0]), _number(name, parts[1])
    if not parts[2].isascii() or not parts[2].isdigit() or len(parts[2]) > 8 or not 1 <= int(parts[2]) <= MAX_POINTS:
        raise ParameterError(
            f"{quoted(parts[2])} is not a number of points",
            path=name,
            expected=f"a whole number from 1 to {MAX_POINTS}",
        )
    return sweep(name.strip(), low, high, int(parts[2]), logarithmic=len(parts) == 4 and parts[3] == "log")


def sweep(name: str, low: Fraction, high: Fraction, points: int, *, logarithmic: bool) -> Sweep:
    """Points from low to high, both included: equally spaced, or with equal ratios."""
    if logarithmic and (low <= 0 or high <= 0):
        raise ParameterError("a logarithmic sweep has an end that is not positive", path=name, mend="leave `:log` out")
    if points == 1 or low == high:
        return Sweep(name, (low,) * points, logarithmic)
    if not logarithmic:
        step = (high - low) / (points - 1)
        return Sweep(name, tuple(low + k * step for k in range(points)), False)
    return Sweep(name, tuple(_geometric(low, high, points)), True)


def of_values(name: str, values: Sequence[Fraction]) -> Sweep:
    """A sweep over given values; logarithmic where neighbours have closer ratios than differences."""
    exact = tuple(values)
    positive = all(value > 0 for value in exact)
    wide = positive and len(exact) > 2 and max(exact) > 100 * min(exact)
    return Sweep(name, exact, wide)


def _number(name: str, text: str) -> Fraction:
    try:
        return rational(text.strip())
    except (ValueError, TooLarge) as error:
        raise ParameterError(str(error), path=name.strip(), expected="a number such as 9/10, 0.9 or 1e-10") from None


def _geometric(low: Fraction, high: Fraction, points: int) -> list[Point]:
    """Both ends exact; the points between them are doubles within a double's range, decimals of 17 digits beyond.

    Whole decades are hit exactly, so that a sweep from 1e-4 to 1e4 holds 1 and not its neighbour.
    """
    start, end = (_log10(value) for value in (low, high))
    step = (end - start) / (points - 1)
    if max(abs(start), abs(end)) > DOUBLE_DECADES:
        return [low, *(_decimal_power(start + k * step) for k in range(1, points - 1)), high]
    first, width = float(start), float(step)
    return [low, *(_double_power(first + k * width) for k in range(1, points - 1)), high]


DOUBLE_DECADES = 300
"""Powers of ten up to this are doubles with room to compute."""

_FINE = Context(prec=34, Emax=10**6, Emin=-(10**6))


def _log10(value: Fraction) -> Decimal:
    return _FINE.subtract(_FINE.log10(Decimal(value.numerator)), _FINE.log10(Decimal(value.denominator)))


def _double_power(exponent: float) -> Point:
    nearest = round(exponent)
    # The exponent has lost a few units in the last place of numbers up to DOUBLE_DECADES: under 2**-40.
    if abs(exponent - nearest) < 2.0**-40:
        return Fraction(10) ** nearest
    return float(10.0**exponent)


def _decimal_power(exponent: Decimal) -> Fraction:
    nearest = exponent.to_integral_value()
    # 28 of the 34 digits: what the divisions can have lost of a whole exponent.
    if abs(exponent - nearest) < Decimal("1e-28"):
        return Fraction(10) ** int(nearest)
    return Fraction(_DIGITS.plus(_FINE.power(Decimal(10), exponent)))
