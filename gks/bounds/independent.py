"""Verdicts at many independent points at once, for stencils of any width: the numeric tier of sweeps.

The modes with abs(z) > 1 number what Delta's winding along the unit circle lacks from the one along a large circle.
Neighbouring nodes have to agree to better than Delta's own size, or the nodes are doubled; a point that this does not
settle stays open. Nothing is proved: `gks modes` has the verdict of a point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import pi

import numpy as np
from numpy.typing import NDArray

from gks.bounds.crossings import VANISHING
from gks.bounds.oncircle import DeltaOfZ, delta_of_z
from gks.bounds.radius import in_interior, within
from gks.bounds.sampled import Array, ComplexArray
from gks.errors import NotAnalysable
from gks.modes.interior import interior_limits
from gks.modes.kreiss import normal_mode_problem, spatial_problem
from gks.scheme.model import Scheme

NODES = 24
"""Steps of the first walk along the half-circle, closer together towards z = 1 and z = -1; doubled up to MOST_NODES."""
MOST_NODES = 1536
STEP = 0.8
"""Most that Delta may change from node to node, relative to its size: half of what could hide a turn."""
LARGE = 1e4
"""Modulus of the large circle: no mode of a scheme with coefficients of moderate size is outside of it."""


@dataclass(frozen=True, slots=True)
class Verdicts:
    """At N points. growing : number of modes with abs(z) > 1 (0 where the interior is unstable); interior : whether it
    is Cauchy-stable; resolved : where the count closed.
    """

    growing: NDArray[np.intp]
    interior: NDArray[np.bool_]
    resolved: NDArray[np.bool_]

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Where the scheme is stable; says nothing where it is not resolved."""
        return np.asarray(self.resolved & self.interior & (self.growing == 0))


def verdicts_at(scheme: Scheme, values: Mapping[str, Fraction], at: Mapping[str, Array]) -> Verdicts:
    """The verdicts at N points given by arrays (N,), of lam and possibly of other parameters.

    NotAnalysable where the interior holds one of these.
    """
    others = [name for name in at if name != scheme.cfl]
    names = (*others, scheme.cfl)
    lam = np.asarray(at[scheme.cfl], float)
    middle = {name: Fraction(float(np.median(at[name]))) for name in names}
    problem = normal_mode_problem(scheme, {**values, **middle}, names)
    if any(in_interior(problem, name) for name in others):
        raise NotAnalysable("the parameter is part of the interior scheme")
    interior = within(
        interior_limits(spatial_problem(scheme, {**values, **middle, scheme.cfl: Fraction(1)}, (scheme.cfl,))), lam
    )
    growing, resolved = _counted(delta_of_z(problem), [np.asarray(at[name], float) for name in names])
    return Verdicts(np.where(interior, growing, 0), interior, resolved | ~interior)


def _counted(delta: DeltaOfZ, symbols: list[Array]) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Zeros with abs(z) > 1 at every point, and whether that is settled."""
    points = len(symbols[0])
    at_infinity = _at_infinity(delta, symbols)
    growing, resolved = np.zeros(points, np.intp), np.zeros(points, bool)
    left, nodes = np.arange(points), NODES
    while len(left) and nodes <= MOST_NODES:
        turns, smooth = _turns(delta, [each[left] for each in symbols], nodes, 1.0)
        growing[left[smooth]] = at_infinity - turns[smooth]
        resolved[left[smooth]] = growing[left[smooth]] >= 0
        left, nodes = left[~smooth], 2 * nodes
    return growing, resolved


def _at_infinity(delta: DeltaOfZ, symbols: list[Array]) -> int:
    """The order of Delta's pole at infinity: the same at all points where the closure gives the next level."""
    some = [each[:: max(1, len(each) // 5)] for each in symbols]
    turns, smooth = _turns(delta, some, 8 * NODES, LARGE)
    if not smooth.any():
        raise NotAnalysable("Delta's behaviour at infinity is not resolved")
    return int(np.median(turns[smooth]))


def _turns(
    delta: DeltaOfZ, symbols: list[Array], nodes: int, modulus: float
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Full turns of Delta along a circle of z, from its upper half, and where the steps are small enough for that."""
    theta = pi * (1 - np.cos(pi * np.arange(nodes + 1) / nodes)) / 2
    z = modulus * np.exp(1j * theta)
    z[-1] = -modulus
    turns = np.zeros(len(symbols[0]), np.intp)
    smooth = np.zeros(len(symbols[0]), bool)
    chunk = max(1, CHUNK // (nodes + 1))
    for start in range(0, len(turns), chunk):
        mine = slice(start, start + chunk)
        count = len(symbols[0][mine])
        flat = [np.repeat(each[mine], nodes + 1) for each in symbols]
        value: ComplexArray = delta(np.tile(z, count), *flat).reshape(count, nodes + 1)
        with np.errstate(all="ignore"):
            ratio = value[:, 1:] / value[:, :-1]
            ends = np.abs(value[:, [0, -1]]).min(axis=1) > VANISHING
            smooth[mine] = (np.abs(ratio - 1).max(axis=1) < STEP) & ends
            half = np.angle(ratio).sum(axis=1) / pi
        turns[mine] = np.where(smooth[mine], np.round(np.nan_to_num(half)), 0).astype(np.intp)
    return turns, smooth


CHUNK = 20_000
"""Values of Delta computed at once: their arrays stay in the cache."""
