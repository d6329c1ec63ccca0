"""Circular interval arithmetic on arrays: every entry is a disc that is proved to hold the complex number it stands for.

A disc has its centre in double precision; each operation encloses the true result over all members of its operands and
adds the rounding error of the centre. With u = 2**-53 a complex sum is off by at most u of its size, a product by at
most sqrt(5) u (Brent, Percival & Zimmermann, Math. Comp. 76 (2007) 1469-1481). Whatever overflows becomes infinite or
nan, and every comparison with it fails: such a disc proves nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import acb
from numpy.typing import NDArray

ComplexArray = NDArray[np.complex128]
Array = NDArray[np.float64]

UNIT = 2.0**-53
PRODUCT = 4 * UNIT
"""Relative error of a complex product: sqrt(5) u, with room for the rounding of the moduli in the bound itself."""
UP = 1 + 16 * UNIT
"""Lifts a radius, computed by at most eight roundings, above its exact value."""
TINY = 2.0**-1000
"""Above anything that a product lost to underflow in numbers that were scaled to about 1."""


@dataclass(frozen=True, slots=True)
class Discs:
    """mid : complex array, rad : nonnegative array of the same shape."""

    mid: ComplexArray
    rad: Array

    @staticmethod
    def exact(values: ComplexArray) -> Discs:
        """Discs of radius 0."""
        return Discs(values, np.zeros(values.shape))

    def __add__(self, other: Discs) -> Discs:
        mid = self.mid + other.mid
        return Discs(mid, (self.rad + other.rad + 2 * UNIT * np.abs(mid)) * UP)

    def __neg__(self) -> Discs:
        return Discs(-self.mid, self.rad)

    def __sub__(self, other: Discs) -> Discs:
        return self + -other

    def __mul__(self, other: Discs) -> Discs:
        mid = self.mid * other.mid
        mine, theirs = np.abs(self.mid), np.abs(other.mid)
        rad = mine * other.rad + theirs * self.rad + self.rad * other.rad + PRODUCT * mine * theirs
        return Discs(mid, rad * UP + TINY)

    def reciprocal(self) -> Discs:
        """1/x; infinite where the disc holds 0."""
        size = np.abs(self.mid) * (2 - UP)
        rest = size - self.rad * UP
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            mid = 1 / self.mid
            rad = np.where(rest > 0, self.rad / (size * rest) + PRODUCT / size, np.inf)
        return Discs(mid, rad * UP + TINY)

    def upper(self) -> Array:
        """At least the modulus of every member."""
        return (np.abs(self.mid) + self.rad) * UP

    def lower(self) -> Array:
        """At most the modulus of every member."""
        return np.maximum(np.abs(self.mid) * (2 - UP) - self.rad * UP, 0.0)

    def take(self, index: NDArray[np.intp]) -> Discs:
        """The discs at the places given, along the first axis."""
        return Discs(self.mid[index], self.rad[index])


def constant(value: acb) -> Discs:
    """The disc, of shape (), around a ball of any precision."""
    mid = complex(value)
    rad = float(abs(value - acb(mid)).abs_upper()) * UP + TINY
    return Discs(np.asarray(mid, complex), np.asarray(rad, float))


def powers(base: Discs, count: int) -> list[Discs]:
    """base**0, ..., base**(count - 1)."""
    found = [Discs.exact(np.ones(base.mid.shape, complex))]
    while len(found) < count:
        found.append(found[-1] * base)
    return found[:count]


def linear_combination(weights: list[Discs], terms: list[Discs]) -> Discs:
    """sum_k weights[k] terms[k]; weights may be of shape ()."""
    total = weights[0] * terms[0]
    for weight, term in zip(weights[1:], terms[1:], strict=True):
        total = total + weight * term
    return total
