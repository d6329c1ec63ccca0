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

CLOSE = 1e-9
"""Relative distance from a critical value, known to about 1e-12, within which a point is left open."""


@dataclass(frozen=True, slots=True)
class Along:
    """The critical values in (low, high), ascending, and the verdict in each of the intervals that they leave.

    The verdicts are certified at one point of each interval; that the values are all there are is numerical.
    """

    critical: tuple[float, ...]
    verdicts: tuple[Verdict, ...]

    def at(self, points: Array) -> list[Verdict]:
        """The verdicts at points of the range: undecided next to a critical value."""
        place = self.places(points)
        return [self.verdicts[k] if k >= 0 else Verdict.UNDECIDED for k in place]

    def places(self, points: Array) -> Array:
        """The number of the interval of each point, -1 next to a critical value."""
        cuts = np.array(self.critical)
        if not len(cuts):
            return np.zeros(len(points), np.intp)
        place = np.searchsorted(cuts, points)
        near = np.min([np.abs(points - cuts[np.clip(place - k, 0, len(cuts) - 1)]) for k in (0, 1)], axis=0)
        return np.where(near < CLOSE * np.abs(points), -1, place)


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
    return Along(found.lams, tuple(_between(scheme, values, name, ends)))


def _between(scheme: Scheme, values: Mapping[str, Fraction], name: str, ends: Sequence[float]) -> list[Verdict]:
    verdicts = []
    for a, b in pairwise(ends):
        try:
            verdicts.append(quick_verdict(scheme, {**values, name: Fraction((a + b) / 2)}))
        except InputError:
            verdicts.append(Verdict.UNDECIDED)
    return verdicts
