"""Where modes cross abs(z) = 1 as lam runs: the zeros of Delta(exp(i theta), lam), traced numerically.

The strip 0 < theta < pi, low < lam < high is cut into boxes, finer towards both ends of either axis (in
log tan(theta/2), since modes near z = 1 scale with lam). A box on which Delta varies by less than its modulus holds no
zero; any other is divided, down to a size from which Newton's method in the two variables goes on. The ends z = 1 and
z = -1, where Delta is real, are searched for changes of sign.

What is found this way is not proved to be all there is: a pair of zeros closer together than the boxes that were passed
over could hide in one. Certified verdicts stand on either side of what is found (`gks.bounds.wideset`), and where
doubles see nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.bounds.sampled import Array, ComplexArray

Delta = Callable[[ComplexArray, Array], ComplexArray]
"""Delta at points z and lam, both (N,)."""

REACH = 17.0
"""tan(theta/2) runs from exp(-17) to exp(17): 4e-8 from the ends, beyond which the ends themselves speak."""
FIRST = 0.5
"""Size of the first boxes in log tan(theta/2) and in the logarithm of lam."""
SMALLEST = 2.0**-12
"""Size at which boxes are no longer divided, relative to the first ones: Newton's method converges from there."""
NARROWEST = 2.0**-30
"""The same in lam alone: at the ends of theta, exp(-17) away from 1, the trace of a zero there is as narrow as that."""
VARIES = 0.6
"""Most that Delta may vary over a box, relative to its value at the centre, for the box to be passed over: nine values
are compared, and a zero inside would make it at least 1."""
MOST_BOXES = 60_000
"""Boxes looked at before giving up: some ten seconds for the widest schemes."""
VANISHING = 1e-9
"""abs(Delta), each row measured by its terms, at which Newton's method is taken to have reached a zero. What is no zero
and as small adds a cut with one verdict on both sides, which is harmless or left open; the zeros that it loses have
values above it to rounding, 1e-16 times a condition of 1e7, and a box that began near one leaves the search open."""
STEP = 1e-6
"""Of the central differences, in logarithms: near the cube root of the rounding unit, where truncation and rounding
balance. The slopes, right to about 1e-10, set how fast Newton's method converges and not where to."""
SETTLED = 2.0**-48
"""Steps of Newton's method in (tau, v) below which rounding moves them: 32 units."""
NOISE = 2.0**-44
"""abs(Delta) below which its sign may be rounding: 512 units, for rows of so many operations and spatial roots that are
off by as much. (1 - kappa)**3 of an extrapolation is 1e-18 at lam = 1e-6, and a change of sign is not seen there: such
stretches are ``unseen``, and a certified verdict has to speak for them."""
MERGED = 1e-11
"""Relative distance of values of lam that count as one: Newton's method from several boxes ends a few roundings times
a condition apart. Two crossings that are merged hide what is between, 1e-11 long; verdicts beside the cut still hold
for what is beyond (`gks.bounds.wideset`, `gks.bounds.along`)."""
BEYOND = 2.0**-30
"""Fraction of what is left at either end at which a verdict is asked for: a mode that crosses there, once, farther in
than 2e-15 of the interval, is noticed."""


@dataclass(frozen=True, slots=True)
class Crossings:
    """The critical lam, ascending. ``open_``: why the search was not finished, if so. ``always``: z = 1 or z = -1 that
    is a zero for every lam. ``unseen``: lam, ascending, from the stretches that were not searched or where Delta at
    z = 1 or -1 is too small for its sign: a crossing may be missing where the verdict there is not the interval's.
    """

    lams: tuple[float, ...]
    open_: str | None
    always: int | None
    unseen: tuple[float, ...] = ()

    def unseen_between(self, low: float, high: float) -> list[float]:
        return [lam for lam in self.unseen if low < lam < high]


@dataclass(frozen=True, slots=True)
class _Axis:
    """log(lam - low) - log(high - lam) where high is finite, else log lam."""

    low: float
    high: float

    def lam(self, v: Array) -> Array:
        if np.isinf(self.high):
            return np.asarray(self.low + np.exp(v))
        return np.asarray(self.low + (self.high - self.low) / (1 + np.exp(-v)))

    def beyond(self) -> list[float]:
        """Places beyond both ends of the search."""
        first, last = (float(x) for x in self.lam(np.array([-ENDS, ENDS])))
        start = self.low + (first - self.low) * BEYOND
        return [start, last / BEYOND if np.isinf(self.high) else self.high - (self.high - last) * BEYOND]


ENDS = 13.0
"""The logarithm runs from -13 to 13: 2e-6 of the interval is left at either end."""


def crossings(delta: Delta, low: float, high: float) -> Crossings:
    """All that are found for low < lam < high (which may be infinite)."""
    axis = _Axis(low, high)
    real = [_at_end(delta, axis, z) for z in (1.0, -1.0)]
    for z, found in zip((1, -1), real, strict=True):
        if found is None:
            return Crossings((), None, z)
    boxes = _suspicious(delta, axis)
    if boxes is None:
        return Crossings((), "the modes that cross the unit circle are too many to be traced", None)
    inner, open_ = _polished(delta, axis, boxes)
    lams = sorted([*(lam for each in real if each is not None for lam in each.lams), *inner])
    dark = {lam for each in real if each is not None for lam in each.unseen}
    return Crossings(tuple(_distinct(lams)), open_, None, tuple(sorted({*dark, *axis.beyond()})))


def _distinct(lams: list[float]) -> list[float]:
    kept: list[float] = []
    for lam in lams:
        if not kept or lam - kept[-1] > MERGED * abs(lam):
            kept.append(lam)
    return kept


def _at_end(delta: Delta, axis: _Axis, z: float) -> Crossings | None:
    """Changes of sign of the real Delta at z = 1 or -1; None where it is zero throughout."""
    v = np.linspace(-ENDS, ENDS, 1 + int(ENDS / FIRST) * 32)

    def value(at: Array) -> Array:
        return np.asarray(delta(np.full(len(at), z, complex), axis.lam(at)).real)

    heights = value(v)
    if np.median(np.abs(heights)) < VANISHING:
        return None
    turned = (np.sign(heights[1:]) != np.sign(heights[:-1])) & np.isfinite(heights[1:] * heights[:-1])
    changes = np.flatnonzero(turned & (np.maximum(np.abs(heights[1:]), np.abs(heights[:-1])) > NOISE))
    dark = tuple(float(lam) for lam in axis.lam(_darkness(v, ~(np.abs(heights) > NOISE))))
    if not len(changes):
        return Crossings((), None, None, dark)
    a, b = v[changes], v[changes + 1]
    side = np.sign(heights[changes])
    for _ in range(60):
        middle = (a + b) / 2
        same = np.sign(value(middle)) == side
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    # A pole or a jump changes sign as well.
    kept = b[np.abs(value(b)) < 2.0**-20]
    return Crossings(tuple(float(lam) for lam in axis.lam(kept)), None, None, dark)


def _darkness(v: Array, dark: NDArray[np.bool_]) -> Array:
    """The first, the middle and the last place of each stretch."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], dark, [False]]).astype(int)))
    first, last = edges[::2], edges[1::2] - 1
    return np.asarray(v[np.unique(np.concatenate([first, (first + last) // 2, last]))])


def _z(tau: Array) -> ComplexArray:
    """exp(i theta) with tan(theta/2) = exp(tau)."""
    t = np.exp(tau)
    return np.asarray((1 + 1j * t) / (1 - 1j * t))


_NINE = np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0)])


@dataclass(frozen=True, slots=True)
class _Boxes:
    """Centres and half-widths (N, 2) in (tau, v)."""

    centre: NDArray[np.float64]
    half: NDArray[np.float64]

    def take(self, mask: NDArray[np.bool_]) -> _Boxes:
        return _Boxes(self.centre[mask], self.half[mask])

    def halved(self, along: NDArray[np.intp]) -> _Boxes:
        """Each cut in two along one of its sides."""
        rows = np.arange(len(along))
        half = self.half.copy()
        half[rows, along] /= 2
        shift = np.zeros_like(half)
        shift[rows, along] = half[rows, along]
        return _Boxes(np.concatenate([self.centre - shift, self.centre + shift]), np.concatenate([half, half]))


def _suspicious(delta: Delta, axis: _Axis) -> NDArray[np.float64] | None:
    """Centres (N, 2) of the smallest boxes that may hold a zero, in (tau, v); None where they are too many."""
    tau = np.arange(-REACH, REACH, FIRST) + FIRST / 2
    v = np.arange(-ENDS, ENDS, FIRST) + FIRST / 2
    centres = np.stack(np.meshgrid(tau, v, indexing="ij"), axis=-1).reshape(-1, 2)
    boxes, seen = _Boxes(centres, np.full_like(centres, FIRST / 2)), 0
    small: list[NDArray[np.float64]] = []
    while len(boxes.centre):
        seen += len(boxes.centre)
        if seen > MOST_BOXES:
            return None
        open_, along = _varying(delta, axis, boxes)
        boxes, along = boxes.take(open_), along[open_]
        # A zero at z = 1 or -1 narrows in lam alone, in proportion to its distance from there: the ends' own.
        narrow = boxes.half[np.arange(len(along)), along] < FIRST / 2 * np.where(along == 0, SMALLEST, NARROWEST)
        done = narrow | (boxes.half.max(axis=1) < FIRST * SMALLEST)
        small.append(boxes.centre[done])
        boxes = boxes.take(~done).halved(along[~done])
    return np.concatenate(small) if small else np.empty((0, 2))


def _varying(delta: Delta, axis: _Axis, boxes: _Boxes) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """Whether Delta varies too much over each box, and along which side more."""
    places = boxes.centre[:, None, :] + boxes.half[:, None, :] * _NINE[None]
    values = delta(_z(places[..., 0].ravel()), axis.lam(places[..., 1].ravel())).reshape(-1, 3, 3)
    with np.errstate(all="ignore"):
        varies = np.abs(values / values[:, 1:2, 1:2] - 1).max(axis=(1, 2))
        sides = np.stack([np.abs(np.diff(values, axis=k)).max(axis=(1, 2)) for k in (1, 2)], axis=1)
    sides = np.where(np.isfinite(sides), sides, 0) + boxes.half * 2.0**-500
    return ~(varies <= VARIES), np.argmax(sides, axis=1)


def _polished(delta: Delta, axis: _Axis, centres: NDArray[np.float64]) -> tuple[list[float], str | None]:
    """Newton's method from every box, and the critical lam it leads to."""
    if not len(centres):
        return [], None

    def value(at: NDArray[np.float64]) -> ComplexArray:
        return delta(_z(at[:, 0]), axis.lam(at[:, 1]))

    at = centres.copy()
    for _ in range(30):  # most boxes are there in five; from one that holds no zero the steps wander off
        here = value(at)
        ahead = [(value(at + STEP * e) - value(at - STEP * e)) / (2 * STEP) for e in np.eye(2)]
        across = ahead[0].real * ahead[1].imag - ahead[0].imag * ahead[1].real
        with np.errstate(all="ignore"):
            move = np.stack(
                [
                    (here.real * ahead[1].imag - here.imag * ahead[1].real) / across,
                    (ahead[0].real * here.imag - ahead[0].imag * here.real) / across,
                ],
                axis=1,
            )
        move = np.clip(np.nan_to_num(move), -FIRST / 8, FIRST / 8)
        at = at - move
        if np.abs(move).max() < SETTLED:
            break
    # A zero that Newton's method left is another box's; one at an end of theta is the ends' own.
    near = np.abs(at - centres).max(axis=1) < FIRST / 4
    found = near & (np.abs(value(at)) < VANISHING) & (np.abs(at[:, 0]) < REACH)
    lost = np.abs(value(centres)) < VANISHING * 2.0**10
    if (lost & ~found & (np.abs(centres[:, 0]) < REACH - 1)).any():
        return [], "Delta is nearly zero on the unit circle where no crossing was resolved"
    return [float(x) for x in axis.lam(at[found, 1])], None
