"""Normal modes that are found and not counted, for schemes too wide for elimination: just inside the unit circle, and
outside where the count does not come about.

Inside nothing can be counted: the interior's own spectrum lies there, and where z crosses it the number of decaying
solutions changes. On a grid of points at which that number is still the one outside, the lowest places of abs(Delta)
(an analytic function has none but its zeros) are polished by Newton's method, and a zero is kept when balls prove it,
its spatial roots told by their moduli. So what is found is a mode, and there may be others.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gks.modes.discs import ComplexArray, Discs
from gks.modes.kreissdiscs import patch
from gks.modes.polish import DIFFERENCE, Found, Polisher

DEEPEST = 0.75
"""The smallest abs(z) looked at: modes farther in bear on nobody's verdict."""
RADII, ANGLES = 8, 65
"""The grid in abs(w) and, over the closed upper half-plane, in its angle: steps of about a twentieth."""
MOST = 12
"""Small values that are followed, the smallest first."""
STEPS = 8
"""Newton steps from a grid point: a handful where a zero is near."""
NEAR = 0.15
"""Length of a step that still leads to a zero near by: three of the grid's."""


def just_inside(polisher: Polisher) -> list[Found]:
    """The simple zeros of Delta found with DEEPEST < abs(z) < 1, each proved to be a normal mode, one of each pair."""
    return [zero for zero in _between(polisher, 1.0, 1 / DEEPEST) if abs(zero.z) < 1]


def outside(polisher: Polisher) -> list[Found]:
    """The same with abs(z) > 1, where a count of them does not come about: one is enough for a verdict."""
    return [zero for zero in _between(polisher, 0.0, 1.0) if abs(zero.z) > 1]


def _between(polisher: Polisher, low: float, high: float) -> list[Found]:
    angles = np.pi * np.arange(ANGLES) / (ANGLES - 1)
    radii = low + (high - low) * (np.arange(RADII) + 0.5) / RADII
    node = (radii[:, None] * np.exp(1j * angles)).ravel()
    values = patch(polisher.tables, polisher.chart, Discs.exact(node), node)
    size = np.where(np.isfinite(values.change), values.log.sum(axis=1), np.inf).reshape(RADII, ANGLES)
    lowest = np.flatnonzero(_minima(size).ravel())
    lowest = lowest[np.argsort(size.ravel()[lowest], kind="stable")][:MOST]
    found: list[Found] = []
    for w in _followed(polisher, node[lowest], low, 1.02 * high):
        zero = polisher.simple(complex(w), None)
        if zero is None or not zero.proved:
            continue
        conjugate = zero.z.conjugate()
        if not any(zero.z.overlaps(other.z) or conjugate.overlaps(other.z) for other in found):
            found.append(zero)
    return found


def _minima(size: NDArray[np.float64]) -> NDArray[np.bool_]:
    """The finite entries below which no neighbour lies."""
    padded = np.pad(size, 1, constant_values=np.inf)
    rows, columns = size.shape
    around = [
        padded[1 + i : 1 + i + rows, 1 + j : 1 + j + columns]
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
        if (i, j) != (0, 0)
    ]
    return np.asarray(np.isfinite(size) & (size <= np.min(around, axis=0)))


def _followed(polisher: Polisher, w: ComplexArray, low: float, high: float) -> list[complex]:
    """Newton's method on Delta from several points, the difference quotient as derivative; those that settle.

    A point whose step is longer than NEAR, or leads out of the annulus, has no zero near by and is let go.
    """
    settled: list[complex] = []
    for _ in range(STEPS):
        if not len(w):
            break
        points = np.concatenate([w, w + DIFFERENCE, w - DIFFERENCE])
        values = patch(polisher.tables, polisher.chart, Discs.exact(points), points)
        logs = (values.log.sum(axis=1) + 1j * values.phase).reshape(3, -1)
        with np.errstate(all="ignore"):  # Delta may be zero to rounding, or no number: neither goes on
            slope = (np.exp(logs[1] - logs[0]) - np.exp(logs[2] - logs[0])) / (2 * DIFFERENCE)
            step = 1 / slope
            w = w - step
            near = (np.abs(step) < NEAR) & (np.abs(w) > low) & (np.abs(w) < high)
            still = near & (np.abs(step) < 2.0**-20)  # the next step would be one of the rounding's size
        settled += w[still].tolist()
        w = w[near & ~still]
    return settled
