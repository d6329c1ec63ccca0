"""Group velocities of unimodular spatial roots.

With z = z0 (1 + eps), x = x0 (1 + eta) on abs(z) = abs(x) = 1 a branch moves as eta = v eps with real v. A wave
z**n x**i = exp(i(omega n + xi i)) of that branch has d omega / d xi = 1/v, so its packets travel at -1/v grid points a
step on the mirrored half-line (Trefethen, J. Comput. Phys. 49 (1983), eq. 2.4): away from the boundary exactly when
v < 0, that is when the wave decays for abs(z) > 1.
"""

from __future__ import annotations

from math import inf

from flint import ctx

from gks.modes.admissible import Candidate, crossing_slopes, outward, point_with_z
from gks.modes.algebraic import GUARD_BITS, Root
from gks.modes.coefficients import value_ball
from gks.modes.fibre import FibreRoot, at_balls, is_zero
from gks.modes.kreiss import Family, NormalModeProblem

BITS = 128
"""Precision of a velocity: a double's digits, whatever a well-scaled quotient of polynomials loses."""


def group_velocities(
    problem: NormalModeProblem, family: Family, candidate: Candidate, root: FibreRoot, *, right: bool
) -> tuple[float, ...]:
    """The velocities of the branches through a spatial root on the circle that go away from the boundary, or stand.

    In grid points a step, positive towards larger x on either half-line (``right`` says which). A glancing root has the
    velocity 0. Undecided where branches meet that first order does not separate.
    """
    point = {**point_with_z(problem, candidate), "x": root.root}
    across = family.polynomial.derivative(problem.variable)
    if is_zero(point, across):
        slopes = crossing_slopes(problem, family, candidate, root)
        return tuple(slope_velocity(v, right=right) for v, count in slopes for _ in range(count) if v.ball().real < 0)
    if root.multiplicity > 1:
        return (0.0,)
    top, bottom = outward(problem)
    with ctx.workprec(BITS + GUARD_BITS):
        at = {name: each.ball(BITS) for name, each in point.items()}
        along = at_balls(family.polynomial.derivative("x"), at) * at["x"] * at_balls(bottom, at)
        speed = along / (at_balls(across, at) * at_balls(top, at))
        if problem.time_map is None and problem.variable == "s":
            # z = exp(lam s): d log z = lam ds, which ``outward`` leaves out.
            speed = speed * value_ball(problem.coefficients.values[problem.resolvent.cfl], BITS)
        value = float(speed.real.mid())
    return (value if right else -value,)


def slope_velocity(slope: Root, *, right: bool) -> float:
    """The velocity of a branch eta = slope * eps."""
    with ctx.workprec(BITS + GUARD_BITS):
        value = float((-1 / slope.ball(BITS).real).mid())
    return (value if right else -value) if abs(value) < inf else 0.0
