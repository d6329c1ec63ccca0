"""Circular interval arithmetic on arrays: each entry is a disc that is proved to hold the number it stands for.

A disc has its centre in double precision; each operation encloses the true result over all members of its operands and
adds the rounding error of the centre. With u = 2**-53 a complex sum is off by at most u of its size, a product by at
most sqrt(5) u (Brent, Percival & Zimmermann, Math. Comp. 76 (2007) 1469-1481). Whatever overflows becomes infinite or
nan, and every comparison with it fails: such a disc proves nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

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

    def __matmul__(self, other: Discs) -> Discs:
        """Matrix products over the last two axes, summed in any order: off by (k + 4) u per unit of abs(A) abs(B)."""
        mine, theirs = np.abs(self.mid), np.abs(other.mid)
        count = self.mid.shape[-1]
        rad = mine @ (other.rad + (count + 4) * PRODUCT * theirs) + self.rad @ (theirs + other.rad)
        return Discs(self.mid @ other.mid, rad * (1 + (count + 16) * UNIT) + TINY)

    def times(self, matrix: Discs) -> Discs:
        """The matrix product with a constant."""
        return self @ matrix

    def scaled(self, factor: Discs) -> Discs:
        """The product by a constant."""
        return factor * self

    def apply(self, change: Callable[[NDArray[Any]], NDArray[Any]]) -> Discs:
        """Moves entries about, the same way in both arrays."""
        return Discs(change(self.mid), change(self.rad))

    def __getitem__(self, index: Any) -> Discs:
        return Discs(self.mid[index], self.rad[index])


def constant(value: acb) -> Discs:
    """The disc, of shape (), around a ball of any precision."""
    mid = complex(value)
    rad = float(abs(value - acb(mid)).abs_upper()) * UP + TINY
    return Discs(np.asarray(mid, complex), np.asarray(rad, float))


@dataclass(frozen=True, slots=True)
class Jets:
    """A function of w over a disc of w: ``value`` encloses its values, ``slope`` those of its derivative."""

    value: Discs
    slope: Discs

    @staticmethod
    def exact(values: ComplexArray) -> Jets:
        """Constants."""
        return Jets(Discs.exact(values), Discs.exact(np.zeros(values.shape, complex)))

    def __add__(self, other: Jets) -> Jets:
        return Jets(self.value + other.value, self.slope + other.slope)

    def __neg__(self) -> Jets:
        return Jets(-self.value, -self.slope)

    def __sub__(self, other: Jets) -> Jets:
        return self + -other

    def __mul__(self, other: Jets) -> Jets:
        return Jets(self.value * other.value, self.slope * other.value + self.value * other.slope)

    def __matmul__(self, other: Jets) -> Jets:
        return Jets(self.value @ other.value, self.slope @ other.value + self.value @ other.slope)

    def times(self, matrix: Discs) -> Jets:
        """The matrix product with a constant."""
        return Jets(self.value @ matrix, self.slope @ matrix)

    def scaled(self, factor: Discs) -> Jets:
        """The product by a constant."""
        return Jets(factor * self.value, factor * self.slope)

    def reciprocal(self) -> Jets:
        """1/f; infinite where f may vanish."""
        inverse = self.value.reciprocal()
        return Jets(inverse, -(self.slope * inverse * inverse))

    def apply(self, change: Callable[[NDArray[Any]], NDArray[Any]]) -> Jets:
        """Moves entries about, the same way in all arrays."""
        return Jets(self.value.apply(change), self.slope.apply(change))

    def __getitem__(self, index: Any) -> Jets:
        return Jets(self.value[index], self.slope[index])


Ring = TypeVar("Ring", Discs, Jets)


def powers(base: Ring, count: int) -> list[Ring]:
    """base**0, ..., base**(count - 1)."""
    found = [_one(base)]
    while len(found) < count:
        found.append(found[-1] * base)
    return found[:count]


def linear_combination(weights: Sequence[Discs], terms: Sequence[Ring]) -> Ring:
    """sum_k weights[k] terms[k] for constant weights."""
    total = terms[0].scaled(weights[0])
    for weight, term in zip(weights[1:], terms[1:], strict=True):
        total = total + term.scaled(weight)
    return total


def joined(parts: Sequence[Ring], gather: Callable[[Sequence[NDArray[Any]]], NDArray[Any]]) -> Ring:
    """One object of several, by ``gather`` (np.stack or np.concatenate along some axis) on their arrays."""
    first = parts[0]
    if isinstance(first, Discs):
        return Discs(gather([p.mid for p in parts]), gather([p.rad for p in parts]))
    values, slopes = [p.value for p in parts], [p.slope for p in parts]
    return Jets(joined(values, gather), joined(slopes, gather))


def _one(like: Ring) -> Ring:
    if isinstance(like, Discs):
        return Discs.exact(np.ones(like.mid.shape, complex))
    return Jets.exact(np.ones(like.value.mid.shape, complex))
