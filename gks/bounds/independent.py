"""Verdicts at many independent points at once, for stencils of any width: the numeric tier of sweeps.

The modes with abs(z) > 1 number what Delta's winding along the unit circle lacks from the one along a large circle.
Neighbouring nodes have to agree to better than Delta's own size, or the steps there and the two beside them are halved;
a point that this does not settle stays open. Nothing is proved: `gks modes` has the verdict of a point.
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
from gks.bounds.signs import interior_sets
from gks.errors import NotAnalysable
from gks.modes.kreiss import normal_mode_problem
from gks.scheme.model import Scheme

NODES = 24
"""Steps of the first walk along the half-circle, closer together towards z = 1 and z = -1."""
HALVINGS = 20
"""How often a step is halved at most: what is left at z = i is 6e-8, and a mode much nearer leaves a point open."""
LAYER = 2.0**-6
"""Fraction of the smallest lam to which nodes close in on z = 1 and z = -1: as lam -> 0 modes come near to those in
proportion to lam, and a pair of them could turn Delta fully before the first step is done.
"""
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

    NotAnalysable where the interior holds one of these, or a wave speed changes its sign with lam.
    """
    others = [name for name in at if name != scheme.cfl]
    names = (*others, scheme.cfl)
    lam = np.asarray(at[scheme.cfl], float)
    middle = {name: Fraction(float(np.median(at[name]))) for name in names}
    sets, signs = interior_sets(scheme, {**values, **middle})
    if signs:
        raise NotAnalysable(f"a wave speed changes its sign with {scheme.cfl}")
    problem = normal_mode_problem(scheme, {**values, **middle}, names)
    if any(in_interior(problem, name) for name in others):
        raise NotAnalysable("the parameter is part of the interior scheme")
    interior = within(sets, lam)
    growing, resolved = _counted(delta_of_z(problem), [np.asarray(at[name], float) for name in names])
    return Verdicts(np.where(interior, growing, 0), interior, resolved | ~interior)


def _counted(delta: DeltaOfZ, symbols: list[Array]) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Zeros with abs(z) > 1 at every point, and whether that is settled."""
    points = len(symbols[0])
    at_infinity = _at_infinity(delta, symbols)
    growing, resolved = np.zeros(points, np.intp), np.zeros(points, bool)
    chunk = max(1, CHUNK // (NODES + 1))
    order = np.argsort(symbols[-1], kind="stable")
    for start in range(0, points, chunk):
        mine = order[start : start + chunk]
        lam = float(symbols[-1][mine[0]])
        turns, smooth = _turns(delta, [each[mine] for each in symbols], _first_places(lam), 1.0)
        growing[mine] = np.where(smooth, at_infinity - turns, 0)
        resolved[mine] = smooth & (growing[mine] >= 0)
    return growing, resolved


def _at_infinity(delta: DeltaOfZ, symbols: list[Array]) -> int:
    """The order of Delta's pole at infinity: the same at all points where the closure gives the next level."""
    some = [each[:: max(1, len(each) // 5)] for each in symbols]
    turns, smooth = _turns(delta, some, np.arange(8 * NODES + 1) / (8 * NODES), LARGE)
    if not smooth.any():
        raise NotAnalysable("Delta's behaviour at infinity is not resolved")
    return int(np.median(turns[smooth]))


def _first_places(lam: float) -> Array:
    """Places of the first nodes in (0, 1): evenly, and by halves towards both ends.

    Next to 0, theta is pi (pi place / 2)**2; places below 2**-26 are as good as the end itself.
    """
    least = max(2 / pi * np.sqrt(LAYER * lam / pi), 2.0**-26) if lam > 0 else 1 / NODES
    near = 2.0 ** -np.arange(1, max(1, np.ceil(-np.log2(least * NODES)) + 1)) / NODES
    return np.concatenate([[0.0], near[::-1], np.arange(1, NODES) / NODES, 1 - near, [1.0]])


@dataclass(slots=True)
class _Walks:
    """Nodes of some points' walks, those of a point in a row and ascending: number of the point, place in (0, 1) of the
    half-circle, value of Delta there.
    """

    point: NDArray[np.intp]
    place: Array
    value: ComplexArray

    def inside(self) -> NDArray[np.bool_]:
        """Which steps from a node to the next are a point's own."""
        return np.asarray(self.point[1:] == self.point[:-1])

    def take(self, kept: NDArray[np.bool_]) -> _Walks:
        return _Walks(self.point[kept], self.place[kept], self.value[kept])

    def with_nodes(self, after: NDArray[np.intp], place: Array, value: ComplexArray) -> _Walks:
        """One node more after each of some."""
        return _Walks(
            np.insert(self.point, after + 1, self.point[after]),
            np.insert(self.place, after + 1, place),
            np.insert(self.value, after + 1, value),
        )


def _turns(
    delta: DeltaOfZ, symbols: list[Array], places: Array, modulus: float
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Full turns of Delta along a circle of z, from its upper half, and where the steps are small enough for that."""
    points = len(symbols[0])

    def values(point: NDArray[np.intp], place: Array) -> ComplexArray:
        theta = pi * (1 - np.cos(pi * place)) / 2
        z = np.where(place == 1, -modulus, modulus * np.exp(1j * theta))
        return delta(z, *(each[point] for each in symbols))

    point, place = np.repeat(np.arange(points), len(places)), np.tile(places, points)
    walks = _Walks(point, place, values(point, place))
    half, smooth, zero = np.zeros(points), np.zeros(points, bool), np.zeros(points, bool)
    for halving in range(HALVINGS + 1):
        inside = walks.inside()
        with np.errstate(all="ignore"):
            ratio = walks.value[1:] / walks.value[:-1]
            rough = inside & ~(np.abs(ratio - 1) < STEP)
        zero[walks.point[~(np.abs(walks.value) > VANISHING)]] = True
        open_ = np.zeros(points, bool)
        open_[walks.point[:-1][rough]] = True
        settled = inside & ~open_[walks.point[:-1]]
        half += np.bincount(walks.point[:-1][settled], np.angle(ratio[settled]), points)
        smooth[walks.point[~open_[walks.point]]] = True
        open_ &= ~zero
        if halving == HALVINGS or not open_.any():
            break
        cut = rough.copy()
        cut[1:] |= rough[:-1]
        cut[:-1] |= rough[1:]
        kept = open_[walks.point]
        cut = np.append(cut & inside, False)[kept]
        walks = walks.take(kept)
        after = np.flatnonzero(cut)
        between = (walks.place[after] + walks.place[after + 1]) / 2
        walks = walks.with_nodes(after, between, values(walks.point[after], between))
    smooth &= ~zero
    return np.where(smooth, np.round(half / pi), 0).astype(np.intp), smooth


CHUNK = 20_000
"""Values of Delta computed at once: their arrays stay in the cache."""
