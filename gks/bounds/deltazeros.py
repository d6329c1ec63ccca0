"""Whether Delta has a zero where the eliminated polynomial has a root, for many computed roots at once, in doubles.

The polynomial also vanishes where other solutions than the decaying ones satisfy the closure, so every root is put to
Delta. What the computed Delta means there is bounded by the disc that holds the root (`gks.bounds.rootdiscs`), by how
far the spatial roots are off, and by the rounding of the determinant: the root is no mode if Delta does not come down
to zero within those. It is one if Delta is smaller there than on a whole circle around it that no other root is in:
then Delta has a zero inside (the minimum modulus principle; poles do no harm), all zeros of Delta are roots of the
polynomial, and this is the only one. All else is in doubt.

Inside the unit circle other solutions may decay than outside. There is a mode where they outnumber the closure's
equations, and none where the closure's matrix has full rank on them: its smallest singular value does not come down to
zero within the same bounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.bounds.sampled import ROUNDINGS, Array, ComplexArray, Rounded, Sampled, Values
from gks.modes.doubledouble import UNIT

Mask = NDArray[np.bool_]

RIM = np.exp(2j * np.pi * np.arange(8) / 8)
"""Places on a circle. Between two of them a function whose one zero is in the middle keeps its modulus."""
LARGEST = 2.0**-7
"""Radius of the largest circle against max(1, abs(sigma)): farther out spatial roots meet more often."""
CIRCLES, SMALLER = 4, 2.0**-6
"""So many circles are tried, each by that smaller: down to 2**-25, where Delta at a simple zero is the root of the
rounding unit. One that is too large for the spatial roots, or too small for the rounding, tells nothing."""


@dataclass(frozen=True, slots=True)
class Judged:
    """At N roots: ``mode`` where Delta has a zero, ``unsure`` where that is not told; ``limit``: the modes whose
    solutions are not seen to decay, and stand for the limits of some that do; ``expected``: certainly as many of every
    family decay as outside the unit circle.
    """

    mode: Mask
    unsure: Mask
    limit: Mask
    expected: Mask


def judged(
    compiled: Sampled, sigma: ComplexArray, radii: Array, gap: Array, on_circle: Mask, symbols: Sequence[Array]
) -> Judged:
    """All arrays (N,): the roots, the radii of their discs, the distance to any other root, and which are on the unit
    circle as far as is known: from there decaying solutions are the limits of those outside.
    """
    found = compiled.at(sigma, *symbols)
    here = compiled.delta(sigma, found.decaying, *symbols)
    widest, others = _widest(found), _narrowest(found)
    spread = radii + ROUNDINGS * 2 * UNIT * compiled.reach(sigma, found.decaying, *symbols)
    change, drift = np.zeros(len(sigma)), np.zeros(len(sigma))
    for direction in (1, 1j):
        moved = compiled.at(sigma + spread * direction * _outwards(compiled, sigma), *symbols)
        # The roots' own rounding moves kappa and not the closure, and the two may cancel where both move.
        alone = compiled.delta(sigma, moved.decaying, *symbols).modulus
        change += np.abs(moved.determinant - found.determinant) + np.abs(alone - here.modulus)
        drift += np.abs(_widest(moved) - widest) + np.abs(_narrowest(moved) - others)
    # Over the disc a linear function changes by what it does in one direction: the other half is for its curvature.
    away = here.modulus > 2 * change + here.rounding
    decays = widest + drift < 1
    may_decay = ~(widest - drift > 1) | on_circle
    # Inside the unit circle more solutions than that may decay, or fewer.
    finite, may_more = np.isfinite(sigma), ~(others - drift > 1) & ~on_circle
    fewer = (widest - drift > 1) & ~on_circle & ~away
    surplus, doubt = _of_those_inside(compiled, sigma, radii, found, (may_more | fewer) & finite, symbols)
    zero = _zero_inside(compiled, sigma, spread, gap, (found, here), may_decay & ~away & finite, symbols)
    mode = ((decays | on_circle) & zero & ~may_more & finite) | surplus
    unsure = (may_decay & ~away & ~may_more & finite & ~mode) | doubt
    return Judged(mode, unsure, mode & ~decays & on_circle, decays & ~may_more)


def _zero_inside(
    compiled: Sampled, sigma: ComplexArray, spread: Array, gap: Array, found: tuple[Values, Rounded], asked: Mask,
    symbols: Sequence[Array],
) -> Mask:  # fmt: skip
    """Whether Delta of the same solutions is certainly smaller at the root than on some circle that holds no other."""
    values, here = found
    inside = np.zeros(len(sigma), bool)
    radius = np.minimum(gap / 2, LARGEST * np.maximum(1, np.abs(sigma)))
    for _ in range(CIRCLES):
        at = np.flatnonzero(asked & ~inside & (radius > 4 * spread))
        if len(at):
            some = [each[at] for each in symbols]
            smaller = np.ones(len(at), bool)
            for direction in RIM:
                place = sigma[at] + radius[at] * direction
                roots, apart = compiled.continued(place, values.take(at), *some)
                outer = compiled.delta(place, roots, *some)
                rescaled = (outer.modulus - outer.rounding) * np.exp2(outer.scale - here.scale[at])
                smaller &= apart & (rescaled > here.modulus[at] + here.rounding[at])
            inside[at] = smaller
        radius = radius * SMALLER
    return inside


def _of_those_inside(
    compiled: Sampled, sigma: ComplexArray, radii: Array, found: Values, asked: Mask, symbols: Sequence[Array]
) -> tuple[Mask, Mask]:
    """Where the solutions that do decay outnumber the closure, and where it is not told that it has full rank on them;
    ``found`` is at the roots.
    """
    surplus, doubt = np.zeros(len(sigma), bool), asked.copy()
    at = np.flatnonzero(asked)
    if not len(at):
        return surplus, doubt
    sigma, symbols, roots = sigma[at], [each[at] for each in symbols], _ascending(found.take(at))
    spread = radii[at] + ROUNDINGS * 2 * UNIT * compiled.reach(sigma, roots, *symbols)
    places = [sigma + spread * direction * _outwards(compiled, sigma) for direction in (1, 1j)]
    beside = [_ascending(compiled.at(place, *symbols)) for place in places]
    told = np.ones(len(at), bool)
    for k, mine in enumerate(roots):
        drift = sum(np.abs(np.abs(each[k]) - np.abs(mine)) for each in beside)
        told &= (np.abs(np.abs(mine) - 1) > drift).all(axis=1)
    counts = np.stack([(np.abs(mine) < 1).sum(axis=1) for mine in roots], axis=1)
    for combination in np.unique(counts[told], axis=0).tolist():
        some = np.flatnonzero(told & (counts == combination).all(axis=1))
        if compiled.surplus(combination):
            surplus[at[some]], doubt[at[some]] = True, False
            continue
        kept, *moved = ([x[some, :n] for x, n in zip(e, combination, strict=True)] for e in (roots, *beside))
        around = [(place[some], each) for place, each in zip(places, moved, strict=True)]
        doubt[at[some]] = ~compiled.full_rank(sigma[some], kept, around, *(each[some] for each in symbols))
    return surplus, doubt


def _ascending(found: Values) -> list[ComplexArray]:
    """All spatial roots of every family, the moduli ascending."""
    every = [np.concatenate(pair, axis=1) for pair in zip(found.decaying, found.others, strict=True)]
    return [np.take_along_axis(x, np.argsort(np.abs(x), axis=1), axis=1) for x in every]


def _outwards(compiled: Sampled, sigma: ComplexArray) -> ComplexArray:
    """The direction in which abs(z) grows."""
    modulus, one = np.abs(sigma), np.ones_like(sigma)
    return one if compiled.variable == "s" else np.where(modulus > 0, sigma / np.where(modulus > 0, modulus, 1), one)


def _widest(found: Values) -> Array:
    return np.asarray(np.max([np.abs(x).max(axis=1, initial=0) for x in found.decaying], axis=0, initial=0))


def _narrowest(found: Values) -> Array:
    """The least modulus of the other solutions; 2 where there are none below that."""
    return np.asarray(np.min([np.abs(x).min(axis=1, initial=2) for x in found.others], axis=0, initial=2))
