"""Generic rational points of a parameter box: where a formula that is not identically zero does not vanish.

A formula vanishes at a random point with probability zero, so a few points decide "identically zero" for practical
purposes. Signs of eigenvalues are different: they may change inside the box, and a region of small size can be missed.
Therefore the points are drawn on both scales (evenly and geometrically) and on both sides of zero, where the box has
them, and the defaults, the point the user thinks of, come first. The seed is fixed: a file has always the same points.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gks.scheme.model import Parameter

DRAWN = 32
"""Points drawn besides the defaults: eight of each scale and side."""

_OCTAVES = 40
"""How many powers of two a geometric draw spans below the width of the range, and beyond 1 where that is infinite."""

_BITS = 24
"""Random bits of a coordinate: generic, and still small exact numbers."""


def generic_points(parameters: Sequence[Parameter]) -> Iterator[dict[str, Fraction]]:
    """The defaults (if all parameters have one), then DRAWN points; without parameters the one point there is."""
    defaults = {p.name: p.default for p in parameters if p.default is not None}
    if len(defaults) == len(parameters):
        yield defaults
    source = random.Random("gks: generic points")
    for count in range(DRAWN if parameters else 0):
        yield {p.name: _coordinate(p, count, source) for p in parameters}


def _coordinate(parameter: Parameter, count: int, source: random.Random) -> Fraction:
    """One value inside the open range; odd counts geometric, and each parameter takes a side of zero at random."""
    low, high = (parameter.low, parameter.high) if parameter.ranged else (Fraction(0), None)
    negative = source.random() < 0.5
    if (low is None or low < 0) and (high is None or high > 0):  # zero inside: take one side
        low, high = (low, Fraction(0)) if negative else (Fraction(0), high)
    if high is not None and high <= 0:
        return -_positive(-high, None if low is None else -low, count % 2 == 1, source)
    return _positive(Fraction(0) if low is None else low, high, count % 2 == 1, source)


def _positive(low: Fraction, high: Fraction | None, geometric: bool, source: random.Random) -> Fraction:
    """A value in (low, high), 0 <= low; high None is infinite."""
    unit = Fraction(2 * source.getrandbits(_BITS) + 1, 2 ** (_BITS + 1))
    if not geometric:
        return low + (high - low) * unit if high is not None else low + unit / (1 - unit)
    width = high - low if high is not None else max(low, Fraction(1)) * 2**_OCTAVES
    # distances from the lower end are as likely to be small as large
    return low + width * unit / (1 << source.randrange(2 * _OCTAVES if high is None else _OCTAVES))
