"""Where modes cross abs(z) = 1 as lam runs: the zeros of Delta(exp(i theta), lam), traced numerically.

The strip 0 < theta < pi, low < lam < high is cut into boxes, finer towards both ends of either axis (in
log tan(theta/2), since modes near z = 1 scale with lam). A box on which Delta varies by less than its modulus holds no
zero; any other is divided, down to a size from which Newton's method in the two variables goes on. The ends z = 1 and
z = -1, where Delta is real, are searched for changes of sign.

What is found this way is not proved to be all there is: a pair of zeros closer together than the boxes that were passed
over could hide in one. Certified verdicts stand on either side of what is found (`gks.bounds.wideset`).
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
"""abs(Delta), each row measured by its terms, below which it is zero to rounding: seven digits are left for
cancellation in the determinant and for spatial roots that are close together."""


SETTLED = 2.0**-48
"""Steps of Newton's method in (tau, v) below which rounding moves them."""
NOISE = 2.0**-44
"""abs(Delta) below which its sign is rounding: (1 - kappa)**3 of an extrapolation is 1e-18 at lam = 1e-6."""


@dataclass(frozen=True, slots=True)
class Crossings:
    """The critical lam, ascending. ``open_``: why the search was not finished, if so. ``always``: z = 1 or z = -1 that
    is a zero for every lam.
    """

    lams: tuple[float, ...]
    open_: str | None
    always: int | None


@dataclass(frozen=True, slots=True)
class _Axis:
    """log(lam - low) - log(high - lam) where high is finite, else log lam."""

    low: float
    high: float

    def lam(self, v: Array) -> Array:
        if np.isinf(self.high):
            return np.asarray(self.low + np.exp(v))
        return np.asarray(self.low + (self.high - self.low) / (1 + np.exp(-v)))


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
    lams = sorted([*(lam for each in real if each is not None for lam in each), *inner])
    return Crossings(tuple(_distinct(lams)), open_, None)


def _distinct(lams: list[float]) -> list[float]:
    kept: list[float] = []
    for lam in lams:
        if not kept or lam - kept[-1] > 1e-11 * lam:
            kept.append(lam)
    return kept


def _at_end(delta: Delta, axis: _Axis, z: float) -> list[float] | None:
    """Changes of sign of the real Delta at z = 1 or -1; None where it is zero throughout."""
    v = np.linspace(-ENDS, ENDS, 1 + int(ENDS / FIRST) * 32)

    def value(at: Array) -> Array:
        return np.asarray(delta(np.full(len(at), z, complex), axis.lam(at)).real)

    heights = value(v)
    if np.median(np.abs(heights)) < VANISHING:
        return None
    turned = (np.sign(heights[1:]) != np.sign(heights[:-1])) & np.isfinite(heights[1:] * heights[:-1])
    changes = np.flatnonzero(turned & (np.maximum(np.abs(heights[1:]), np.abs(heights[:-1])) > NOISE))
    if not len(changes):
        return []
    a, b = v[changes], v[changes + 1]
    side = np.sign(heights[changes])
    for _ in range(60):
        middle = (a + b) / 2
        same = np.sign(value(middle)) == side
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    # A pole or a jump changes sign as well.
    return [float(axis.lam(np.array([x]))[0]) for x, h in zip(b, np.abs(value(b)), strict=True) if h < 2.0**-20]


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

    at, step = centres.copy(), 1e-6
    for _ in range(30):  # most boxes are there in five; from one that holds no zero the steps wander off
        here = value(at)
        ahead = [(value(at + step * e) - value(at - step * e)) / (2 * step) for e in np.eye(2)]
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
