"""Verdicts along one parameter at fixed lam: any number of points for the price of the critical values.

The values at which a mode crosses abs(z) = 1 are traced once (`gks.bounds.crossings`, with the parameter in the place
of lam), and one certified verdict decides each interval between them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from gks.bounds.crossings import crossings
from gks.bounds.oncircle import delta_of_z
from gks.bounds.radius import in_interior
from gks.bounds.sampled import Array
from gks.errors import InputError, NotAnalysable
from gks.modes.analysis import analyse, quick_verdict
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme

BESIDE = (40, 34, 30, 24, 20)
"""A critical value is held between verdicts at a distance of 2**-k, relative to it and then to the range, for the first
k at which both are those of their intervals: how well it is known is found out and not assumed."""


@dataclass(frozen=True, slots=True)
class Along:
    """The critical values in (low, high), ascending, the distance to which each is known, and the verdict in each of
    the intervals that they leave.

    The verdicts are certified at one point of each interval and at its ends; that the values are all there are is
    numerical.
    """

    critical: tuple[float, ...]
    errors: tuple[float, ...]
    verdicts: tuple[Verdict, ...]

    def at(self, points: Array) -> list[Verdict]:
        """The verdicts at points of the range: undecided next to a critical value."""
        place = self.places(points)
        return [self.verdicts[k] if k >= 0 else Verdict.UNDECIDED for k in place]

    def places(self, points: Array) -> Array:
        """The number of the interval of each point, -1 as near to a critical value as that is known."""
        cuts, errors = np.array(self.critical), np.array(self.errors)
        if not len(cuts):
            return np.zeros(len(points), np.intp)
        place = np.searchsorted(cuts, points)
        beside = [np.clip(place - k, 0, len(cuts) - 1) for k in (0, 1)]
        near = np.any([np.abs(points - cuts[k]) <= errors[k] for k in beside], axis=0)
        return np.where(near, -1, place)


def verdicts_along(scheme: Scheme, values: Mapping[str, Fraction], name: str, low: Fraction, high: Fraction) -> Along:
    """The verdicts for low < value < high of a parameter that the interior does not hold, at the lam in ``values``.

    NotAnalysable where the interior holds it, where it is not Cauchy-stable, or where the tracing stays open.
    """
    middle = (low + high) / 2
    problem = normal_mode_problem(scheme, {**values, name: middle}, (name, scheme.cfl))
    if in_interior(problem, name):
        raise NotAnalysable(f"{name} is part of the interior scheme")
    if analyse(scheme, {**values, name: middle}).reason == "interior":
        raise NotAnalysable("the interior scheme is not Cauchy-stable")
    delta, lam = delta_of_z(problem), float(values[scheme.cfl])
    found = crossings(lambda z, p: delta(z, p, np.full(len(p), lam)), float(low), float(high))
    if found.open_ is not None or found.always is not None:
        raise NotAnalysable(found.open_ or f"Delta vanishes at z = {found.always} for every {name}")
    ends = [float(low), *found.lams, float(high)]
    verdicts = _between(scheme, values, name, ends)
    for (a, b), verdict in zip(pairwise(ends), verdicts, strict=True):
        for value in found.unseen_between(a, b):
            if _verdict(scheme, values, name, value) not in (verdict, Verdict.UNDECIDED):
                raise NotAnalysable(f"the verdict at {name} = {value:.12g} is not that of its interval")
    errors = tuple(_error(scheme, values, name, ends[k : k + 3], verdicts[k : k + 2]) for k in range(len(found.lams)))
    return Along(found.lams, errors, tuple(verdicts))


def _error(
    scheme: Scheme, values: Mapping[str, Fraction], name: str, around: Sequence[float], verdicts: Sequence[Verdict]
) -> float:
    """The distance from the middle value at which the verdicts on either side are had; NotAnalysable where none is."""
    low, cut, high = around
    sizes = (abs(cut), high - low)
    for step in sorted(size * 2.0**-k for size in sizes for k in BESIDE):
        if 0 < step < min(cut - low, high - cut) / 2 and all(
            _verdict(scheme, values, name, cut + side * step) is verdict
            for side, verdict in zip((-1, 1), verdicts, strict=True)
        ):
            return step
    raise NotAnalysable(f"the critical value near {name} = {cut:.12g} was not confirmed")


def _between(scheme: Scheme, values: Mapping[str, Fraction], name: str, ends: Sequence[float]) -> list[Verdict]:
    return [_verdict(scheme, values, name, (a + b) / 2) for a, b in pairwise(ends)]


def _verdict(scheme: Scheme, values: Mapping[str, Fraction], name: str, value: float) -> Verdict:
    try:
        return quick_verdict(scheme, {**values, name: Fraction(value)})
    except InputError:
        return Verdict.UNDECIDED
