"""A stable set whose ends are located by numbers: what schemes beyond elimination have instead of algebraic ends."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from gks.bounds.cfl import Limit
from gks.modes.algebraic import Root
from gks.modes.numerals import exact_fraction

Span = tuple[Fraction, Fraction | None]
"""An open interval of lam; None is infinity."""


@dataclass(frozen=True, slots=True)
class Located:
    """Stable intervals, ascending and disjoint.

    ``error`` bounds the relative error of every end but 0 and infinity. ``undecided`` says what stayed open; nothing is
    said then. ``proved``: the whole set is, within ``error``; else each piece is proved at one point of it, and that
    the verdict changes nowhere inside a piece has been seen numerically.
    """

    intervals: tuple[Span, ...]
    limited_by: Limit | None
    error: float
    proved: bool
    undecided: str | None = None

    @property
    def lam_max(self) -> Fraction | None:
        """As `StableSet.lam_max`."""
        if self.intervals and self.intervals[0][0] == 0:
            return self.intervals[0][1]
        return Fraction(0)


END_BITS = 80
"""Bits of an irrational end: the double nearest to it, and bits to spare."""


def close_to(end: Root) -> Fraction:
    """A real number itself where it is rational, else with a relative error of at most 2**-80."""
    rational = end.rational
    return exact_fraction(end.ball(END_BITS).real) if rational is None else rational


def nothing_said(why: str) -> Located:
    """What an analysis that stayed open gives."""
    return Located((), None, 0.0, False, why)
