"""The multiplicity of a normal mode: the order to which Delta itself vanishes, where the norm vanishes to a higher one.

The norm is the product of Delta over all choices of spatial roots, and counts the zeros of every choice. Where the
choice of the decaying roots is analytic near the point, its derivative decides: a nonzero one, in balls, proves a
simple zero. What that does not prove keeps the norm's count, an upper bound.
"""

from __future__ import annotations

from flint import acb, ctx

from gks.modes.admissible import Candidate, point_of
from gks.modes.algebraic import GUARD_BITS, Position, Root
from gks.modes.coefficients import value_ball
from gks.modes.enclosure import NotEnclosed, SpatialRoots, delta, spatial_roots
from gks.modes.fibre import fibre, is_zero
from gks.modes.kreiss import NormalModeProblem
from gks.modes.tables import ball_tables

BITS = 80
"""Precision of the derivative, that of the roots printed: a slope that these bits do not tell from 0 is taken for 0."""


def multiplicity(problem: NormalModeProblem, candidate: Candidate) -> int:
    """How many times a mode off the unit circle counts; the norm's multiplicity where that is not told."""
    if candidate.multiplicity == 1 or problem.coupled or candidate.position is Position.ON or candidate.z is None:
        return candidate.multiplicity
    if problem.time_map is not None and is_zero(
        {**point_of(problem, candidate), "z": candidate.z}, problem.time_map.derivative("z")
    ):
        return candidate.multiplicity
    return 1 if _simple(problem, candidate) else candidate.multiplicity


def _simple(problem: NormalModeProblem, candidate: Candidate) -> bool:
    """Whether Delta's derivative is not zero, the decaying roots being apart from the others and all of them inside."""
    tables = ball_tables(problem, BITS)
    with ctx.workprec(BITS + GUARD_BITS):
        mu = candidate.sigma.ball(BITS)
        if problem.variable == "s":
            mu *= value_ball(problem.coefficients.values[problem.resolvent.cfl], BITS)
        roots: list[SpatialRoots] = []
        for family, symbol in zip(problem.families, tables.symbols, strict=True):
            every = fibre(point_of(problem, candidate), family.polynomial, "x")
            inside = [r.root for r in every if r.position is Position.INSIDE for _ in range(r.multiplicity)]
            others = [r.root for r in every if r.position is not Position.INSIDE for _ in range(r.multiplicity)]
            if len(inside) != symbol.decaying or symbol.turn or len(inside) + len(others) != len(symbol.powers) - 1:
                return False
            try:
                roots.append(spatial_roots(symbol, mu, [_near(r) for r in inside + others]))
            except (NotEnclosed, ZeroDivisionError, OverflowError):
                return False
        try:
            return not delta(tables, mu, roots).slope.contains(0)
        except NotEnclosed:
            return False


def _near(root: Root) -> complex:
    return complex(acb(root.ball(64)))
