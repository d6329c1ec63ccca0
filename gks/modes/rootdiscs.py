"""The roots of many polynomials at once, each polynomial known up to discs around its coefficients.

Approximations x_1, ..., x_n (of any quality) are turned into inclusions by Smith's theorem (J. ACM 17 (1970) 137-147):
all roots of p, of degree n with leading coefficient c, lie in the union of the discs

    abs(x - x_j) <= n abs(p(x_j)) / abs(c prod_{i != j} (x_j - x_i)),

and a connected component of the union made up of k discs holds exactly k roots. The bound is evaluated for the worst
polynomial within the coefficients' discs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gks.modes.discs import PRODUCT, UNIT, UP, Array, ComplexArray, Discs, Jets

Mask = NDArray[np.bool_]

START_STEPS = 40
"""Simultaneous iteration from Bini-like starting points takes 6 to 15 steps; a multiple root takes one a bit and is cut
off here: inclusion discs judge what comes out."""
NEXT_STEPS = 4
"""From the roots at a neighbouring point the iteration, of third order, is at the rounding error after three steps."""


@dataclass(frozen=True, slots=True)
class RootDiscs:
    """centre, cover : (N, n). joined : (N, n, n), whether two discs belong to one component of the union.

    With every root of a polynomial one can associate one j so that the root lies within cover[j] of centre[j], and
    each component gets as many roots as it has members.
    """

    centre: ComplexArray
    cover: Array
    joined: Mask


def root_discs(coefficients: Discs, centre: ComplexArray) -> RootDiscs:
    """Inclusions around approximations, infinite where nothing is proved.

    coefficients (N, n+1) ascending, centre (N, n).
    """
    degree = centre.shape[1]
    if not degree:
        return RootDiscs(centre, np.zeros(centre.shape), np.zeros((*centre.shape, 0), bool))
    with np.errstate(all="ignore"):  # a coincidence or an overflow makes a radius infinite or nan, which proves nothing
        size = np.abs(centre)
        value = np.repeat(coefficients.mid[:, -1:], degree, axis=1)
        error = np.repeat(coefficients.rad[:, -1:], degree, axis=1)
        for k in range(degree - 1, -1, -1):
            product = value * centre
            value = product + coefficients.mid[:, k : k + 1]
            error = (
                error * size + PRODUCT * np.abs(product) + 2 * UNIT * np.abs(value) + coefficients.rad[:, k : k + 1]
            ) * UP
        gap = np.abs(centre[:, :, None] - centre[:, None, :]) * (1 - PRODUCT)
        gap[:, np.arange(degree), np.arange(degree)] = 1.0
        lead = np.abs(coefficients.mid[:, -1:]) * (1 - PRODUCT) - coefficients.rad[:, -1:]
        # n factors are multiplied and two sums rounded: n + 8 roundings, of which PRODUCT covers four each.
        slack = 1 + (degree + 8) * PRODUCT
        radius = degree * (np.abs(value) + error) / (lead * gap.prod(axis=2)) * slack
        radius = np.where((lead > 0) & np.isfinite(radius), radius, np.inf)
        # A gap that rounding closes is one: overlaps must not be missed.
        joined = gap * (1 - PRODUCT) <= (radius[:, :, None] + radius[:, None, :]) * UP
        joined[:, np.arange(degree), np.arange(degree)] = True
        joined = _closure(joined)
        gap[:, np.arange(degree), np.arange(degree)] = 0.0
        reach = np.where(joined, gap * (1 + 4 * PRODUCT) + radius[:, None, :], 0.0)
    return RootDiscs(centre, reach.max(axis=2) * UP, joined)


SIZES = 2.0 ** np.arange(-40, 6)
"""Radii tried for the disc of a group."""


@dataclass(frozen=True, slots=True)
class RootGroup:
    """A disc with exactly ``count`` roots of every polynomial of a set."""

    centre: complex
    radius: float
    count: int

    def holds(self, x: ComplexArray, cover: Array) -> Mask:
        """Which discs lie in it."""
        return np.asarray(np.abs(x - self.centre) * UP + cover < self.radius)


@np.errstate(all="ignore")  # an infinite cover makes everything infinite or nan, which proves nothing
def root_groups(middle: Discs, spread: Discs, most: int) -> list[RootGroup] | None:
    """Disjoint discs with ``most`` roots each at most, for all polynomials with coefficients in ``spread`` (1, n + 1).

    By Rouché's theorem: on abs(x - m) = r the polynomial in the ``middle``, whose roots are told apart, is at least
    c prod abs(r - abs(x_i - m)), and the others differ from it by no more than sum_k rad_k (abs(m) + r)**k. So roots
    that meet somewhere in the set are enclosed by what they move, where discs round those of a single polynomial would
    be several times as large. None where no such discs are found.
    """
    roots = root_discs(middle, approximate(middle.mid))
    x, cover = roots.centre[0], roots.cover[0]
    lead = float(middle.lower()[0, -1])
    off = (np.abs(spread.mid - middle.mid)[0] + spread.rad[0] + middle.rad[0]) * UP
    left, groups = list(range(len(x))), list[RootGroup]()
    while left:
        near = sorted(left, key=lambda j: abs(x[j] - x[left[0]]))
        for count in range(1, min(most, len(near)) + 1):
            radius = _group_radius(x, cover, lead, off, near[:count])
            if radius is not None:
                groups.append(RootGroup(complex(x[near[:count]].mean()), radius, count))
                left = [j for j in left if j not in near[:count]]
                break
        else:
            return None
    apart = all(
        abs(a.centre - b.centre) * (2 - UP) > a.radius + b.radius for i, a in enumerate(groups) for b in groups[:i]
    )
    return groups if apart else None


def _group_radius(x: ComplexArray, cover: Array, lead: float, off: Array, members: Sequence[int]) -> float | None:
    """The least of SIZES that does round the mean of some roots."""
    m = complex(x[members].mean())
    distance = np.abs(x - m)
    gaps = np.abs(SIZES[:, None] - distance) * (2 - UP) - cover - 4 * UNIT * (SIZES[:, None] + distance)
    least = lead * np.where(gaps > 0, gaps, 0).prod(axis=1) * (1 - (len(x) + 4) * PRODUCT)
    most = ((abs(m) + SIZES[:, None]) ** np.arange(len(off)) * off).sum(axis=1) * (1 + (len(off) + 8) * PRODUCT)
    inside = distance < SIZES[:, None]
    holds = (inside.sum(axis=1) == len(members)) & inside[:, members].all(axis=1)
    good = np.flatnonzero((least > most) & holds)
    return float(SIZES[good[0]]) if len(good) else None


def branches(coefficients: Jets, found: RootDiscs) -> Jets:
    """The roots as functions of w, given polynomials in x whose coefficients (N, n+1) are: (N, n).

    A simple root x(w) that stays in a disc X has x = c - p(c)/q with q in p_x(X), X being convex, and the derivative
    -p_w(x)/p_x(x). Where roots are not kept apart, or p_x may vanish, the value is the cover and the slope infinite.
    """
    alone = found.joined.sum(axis=2) == 1
    cover = Discs(found.centre, found.cover)
    with np.errstate(all="ignore"):  # an infinite cover makes everything infinite or nan
        inverse = _horner(_derivative(coefficients.value), cover).reciprocal()
        centre = Discs.exact(found.centre)
        value = centre - _horner(coefficients.value, centre) * inverse
        better = alone & (value.rad < found.cover)
        value = Discs(np.where(better, value.mid, found.centre), np.where(better, value.rad, found.cover))
        slope = -(_horner(coefficients.slope, value) * _horner(_derivative(coefficients.value), value).reciprocal())
    proved = alone & np.isfinite(slope.mid) & np.isfinite(slope.rad)
    return Jets(value, Discs(np.where(proved, slope.mid, 0), np.where(proved, slope.rad, np.inf)))


def _derivative(coefficients: Discs) -> Discs:
    degrees = np.arange(1, coefficients.mid.shape[1])
    return Discs(coefficients.mid[:, 1:] * degrees, coefficients.rad[:, 1:] * degrees * UP) + Discs(
        np.zeros_like(coefficients.mid[:, 1:]), np.zeros_like(coefficients.rad[:, 1:])
    )


def _horner(coefficients: Discs, x: Discs) -> Discs:
    """sum_k coefficients[:, k] x**k for x (N, n)."""
    degree = coefficients.mid.shape[1] - 1
    value = coefficients.apply(lambda each: np.repeat(each[:, -1:], x.mid.shape[1], axis=1))
    for k in range(degree - 1, -1, -1):
        value = value * x + Discs(coefficients.mid[:, k : k + 1], coefficients.rad[:, k : k + 1])
    return value


def _closure(joined: Mask) -> Mask:
    """The transitive closure of a symmetric reflexive relation."""
    if not joined.sum() > joined.shape[0] * joined.shape[1]:
        return joined
    reach = 1
    while reach < joined.shape[1]:
        joined = np.matmul(joined.astype(np.int64), joined.astype(np.int64)) > 0
        reach *= 2
    return joined


def approximate(coefficients: ComplexArray, start: ComplexArray | None = None) -> ComplexArray:
    """Approximate roots (N, n), by Ehrlich-Aberth iteration from ``start`` or from points on circles."""
    degree = coefficients.shape[1] - 1
    if start is None:
        return _iterated(coefficients, _starting_points(coefficients), START_STEPS)
    return _iterated(coefficients, start, NEXT_STEPS) if degree else start


def _starting_points(coefficients: ComplexArray) -> ComplexArray:
    """Points at the moduli that a Newton polygon gives (Bini, Numer. Algorithms 13 (1996) 179-200).

    One polygon serves all: that of the coefficients' median sizes.
    """
    with np.errstate(divide="ignore"):
        logs = np.log2(np.median(np.abs(coefficients), axis=0))
    return np.tile(_polygon_points(logs, coefficients.shape[1] - 1), (len(coefficients), 1))


def _polygon_points(logs: Array, degree: int) -> ComplexArray:
    live = [k for k in range(degree + 1) if np.isfinite(logs[k])]
    hull: list[int] = []
    for k in live:
        while len(hull) > 1 and _below(logs, hull[-2], hull[-1], k):
            hull.pop()
        hull.append(k)
    points: list[complex] = [0j] * (hull[0] if hull else degree)
    for low, high in pairwise(hull):
        radius = 2.0 ** float(np.clip((logs[low] - logs[high]) / (high - low), -500, 500))
        angles = 2 * np.pi * np.arange(high - low) / (high - low) + 0.7 * (high + 1)
        points += list(radius * np.exp(1j * angles))
    return np.array(points + [np.inf] * (degree - len(points)))


def _below(logs: Array, a: int, b: int, c: int) -> bool:
    return bool((logs[b] - logs[a]) * (c - a) <= (logs[c] - logs[a]) * (b - a))


def _iterated(coefficients: ComplexArray, x: ComplexArray, steps: int) -> ComplexArray:
    degree = x.shape[1]
    diagonal = np.arange(degree)
    x = x.copy()
    with np.errstate(all="ignore"):  # a coincidence of two points gives nan, which is not taken as a step
        for _ in range(steps):
            value = np.repeat(coefficients[:, -1:], degree, axis=1)
            slope = np.zeros_like(value)
            for k in range(degree - 1, -1, -1):
                slope = slope * x + value
                value = value * x + coefficients[:, k : k + 1]
            differences = x[:, :, None] - x[:, None, :]
            differences[:, diagonal, diagonal] = np.inf
            step = value / (slope - value * (1 / differences).sum(axis=2))
            step = np.where(np.isfinite(step), step, 0)
            x = x - step
            if (np.abs(step) <= 4 * UNIT * np.abs(x)).all():
                break
    return x
