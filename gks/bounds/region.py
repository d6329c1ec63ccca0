"""A stable region cell by cell, as data: what is read off the boundary curves, and stated as pieces of a theorem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from gks.bounds.boundary import Boundary, curve_at
from gks.bounds.cfl import Limit
from gks.bounds.criticality import ascending_roots
from gks.modes.algebraic import Root
from gks.modes.unimodular import by_real_part
from gks.modes.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Branch:
    """lam as a function of p: the k-th positive root, from 1, of a curve."""

    curve: int
    k: int


End = Branch | Root | None
"""An end of a stable interval: a branch over a cell, a number on a cut; None is 0 below and infinity above."""


@dataclass(frozen=True, slots=True)
class Span:
    """An open interval of stable lam."""

    low: End
    high: End


@dataclass(frozen=True, slots=True)
class Cell:
    """An open interval of p (None: the end of the domain), its rational sample, and the stable intervals over it."""

    low: Root | None
    high: Root | None
    sample: Fraction
    spans: tuple[Span, ...]
    limited_by: Limit | None
    at_bound: Verdict | None


@dataclass(frozen=True, slots=True)
class Cut:
    """A point between two cells. ``spans`` None: the stable set is the common limit of both sides.

    ``at_bound`` is the verdict on the bound here: None where the bound is 0 or infinite, UNDECIDED where it stays open.
    """

    root: Root
    spans: tuple[Span, ...] | None
    at_bound: Verdict | None


@dataclass(frozen=True, slots=True)
class Decomposition:
    """``len(cells) == len(cuts) + 1``, ascending."""

    boundary: Boundary
    cells: tuple[Cell, ...]
    cuts: tuple[Cut, ...]


def value_of(found: Boundary, end: Branch | Root, p: Fraction) -> Root:
    """The number that an end of a stable interval is at p."""
    if isinstance(end, Root):
        return end
    return ascending_roots(curve_at(found.curves[end.curve], p))[end.k - 1]


def split_at(
    intervals: Sequence[tuple[Root | None, Root | None]], points: Sequence[Root]
) -> list[tuple[Root | None, Root | None]]:
    """Intervals without some inner points; neighbours that touch are one before."""
    found: list[tuple[Root | None, Root | None]] = []
    for low, high in intervals:
        if found and low is not None and found[-1][1] == low:
            found[-1] = (found[-1][0], high)
        else:
            found.append((low, high))
    for point in by_real_part(points):
        k = next(
            k for k, (low, high) in enumerate(found) if (low is None or low < point) and (high is None or point < high)
        )
        found[k : k + 1] = [(found[k][0], point), (point, found[k][1])]
    return found
