"""The unit circle in two parts: where Delta is kept from zero, and pockets round the places where it may vanish.

A first walk along the circle gets stuck where Delta has a zero on the circle or close to it. There a disc across the
circle is sought over which the decaying roots keep apart from the others; in it Delta is analytic, and a walk round it
counts the zeros. The walk along the circle then goes round all pockets.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gks.modes.chart import Chart
from gks.modes.discs import Discs
from gks.modes.glancing import GlancingPocket, GlancingPoints
from gks.modes.kreissdiscs import Region, region_of
from gks.modes.tables import DiscTables
from gks.modes.winding import CIRCLE_STEP, FEW_STEPS, Walk, full_circle, half_circle, walk

SMALLEST = (2.0**-11, 2.0**-14, 2.0**-17, 2.0**-22, 2.0**-27, 2.0**-34)
"""Shortest steps of the rounds. What is stuck at the first is the neighbourhood of a zero or of a branch point; shorter
steps leave a shorter stretch to be covered by a pocket. Towards a branch point on the circle steps shrink in a few
dozen halvings; at 2**-34 the radii of inclusion discs, near the root of the rounding error there, no longer do."""
LARGEST = 2.0**-4
"""Radius of the largest pocket tried: wide enough for a few zeros near a point, and narrow enough to miss most branch
points."""
NEIGHBOURS = 16
"""Stuck steps at most so many smallest steps apart are one stretch, centred on the real axis if it is as near."""
MOST_PLACES = 40
"""Stretches with pockets of their own: where there are more, Delta is too small all along to be told from zero."""
MARGIN = 1 + CIRCLE_STEP + 2.0**-6
"""A pocket's region is that much wider than the pocket, so that the discs along its boundary, of at most CIRCLE_STEP
times its radius, lie in it."""


@dataclass(frozen=True, slots=True)
class Pocket:
    """A disc (centre real, or in the upper half-plane with the disc) with ``count`` zeros of Delta in it."""

    centre: complex
    radius: float
    region: Region
    walk: Walk

    @property
    def count(self) -> int:
        return round(self.walk.zeros)


@dataclass(frozen=True, slots=True)
class Circle:
    """The walk along the unit circle round the pockets; it encloses every zero with abs(w) < 1 that no pocket holds."""

    walk: Walk
    pockets: tuple[Pocket, ...]
    glancing: tuple[GlancingPocket, ...]

    @property
    def count(self) -> int:
        return round(self.walk.zeros)


def circled(tables: DiscTables, chart: Chart, points: GlancingPoints) -> Circle:
    """Finds the pockets and walks round them; what stays stuck is in the walk."""
    pockets: list[Pocket] = []
    glancing = _glancing(points, points.of_conservative(), (), SMALLEST[0])
    around = walk(tables, chart, half_circle(_discs(pockets, glancing)), SMALLEST[0])
    for smallest, following in pairwise(SMALLEST):
        places = _gathered(around.stuck, smallest) if around.stuck else []
        if not 0 < len(places) <= MOST_PLACES:
            break
        for place in places:
            others = [(other.centre, other.reach) for other in places if other is not place]
            others += _discs(pockets, glancing)
            found = _pocket(tables, chart, place, others, smallest)
            if found is not None:
                pockets.append(found)
            elif place.centre.imag:
                taken = _discs(pockets, glancing)
                glancing += _glancing(points, points.near(place.centre, place.reach), taken, smallest)
        around = walk(tables, chart, half_circle(_discs(pockets, glancing)), following, known=around)
    return Circle(around, tuple(pockets), tuple(glancing))


def _discs(pockets: Sequence[Pocket], glancing: Sequence[GlancingPocket]) -> list[tuple[complex, float]]:
    return [(p.centre, p.radius) for p in pockets] + [(p.centre, p.radius) for p in glancing]


@dataclass(frozen=True, slots=True)
class Place:
    """A stretch of the circle: a point of the disc's closure and how far its stuck steps reach from there."""

    centre: complex
    reach: float


def _gathered(stuck: Sequence[complex], smallest: float) -> list[Place]:
    """Neighbouring stuck steps as one stretch; one near the real axis is centred on it."""
    points = sorted(stuck, key=lambda w: float(np.angle(w)))
    groups: list[list[complex]] = [[points[0]]]
    for w in points[1:]:
        if abs(w - groups[-1][-1]) < NEIGHBOURS * smallest:
            groups[-1].append(w)
        else:
            groups.append([w])
    places = []
    for group in groups:
        middle = (group[0] + group[-1]) / 2
        centre = middle / abs(middle)
        if min(w.imag for w in group) < NEIGHBOURS * smallest:
            centre = complex(np.sign(centre.real))
        places.append(Place(centre, max(abs(w - centre) for w in group) + 2 * smallest))
    return places


def _radii(place: Place, others: Sequence[tuple[complex, float]]) -> Iterator[float]:
    """Radii that hold the place and keep clear of the real axis (unless centred there) and of other discs."""
    room = [abs(place.centre - centre) - reach for centre, reach in others]
    most = min([LARGEST, *(r / 3 for r in room)])
    if place.centre.imag:
        most = min(most, place.centre.imag / (2 * MARGIN))
    radius = LARGEST
    while radius > place.reach:
        if radius <= most:
            yield radius
        radius /= 2


def _glancing(
    points: GlancingPoints, centres: Sequence[complex], taken: Sequence[tuple[complex, float]], smallest: float
) -> list[GlancingPocket]:
    """Pockets round glancing points; they need not hold all of a stretch, since shorter steps come closer."""
    found: list[GlancingPocket] = []
    for k, centre in enumerate(centres):
        others = [*taken, *((p.centre, p.radius) for p in found), *((other, 0.0) for other in centres[k + 1 :])]
        met = points.pocket(centre, _radii(Place(centre, smallest), others), smallest)
        if met is not None:
            found.append(met)
    return found


def _pocket(
    tables: DiscTables, chart: Chart, place: Place, others: Sequence[tuple[complex, float]], smallest: float
) -> Pocket | None:
    for radius in _radii(place, others):
        disc = Discs(np.array([place.centre]), np.array([MARGIN * radius]))
        region = region_of(tables, chart, disc, place.centre * (1 - radius / 2))
        if region is None:
            continue
        boundary = walk(tables, chart, full_circle(place.centre, radius), smallest * radius, region, FEW_STEPS)
        if not boundary.stuck:
            return Pocket(place.centre, radius, region, boundary)
    return None
