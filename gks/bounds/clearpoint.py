"""Proof by balls that no mode is on or outside the circle at a point (p, lam) of two algebraic numbers.

Where boundary curves meet inside the stable region, most often nothing happens: the roots that meet the circle there
belong to solutions that do not decay. To see that takes no algebra over the field of both numbers, which may be of high
degree: see ``modes.clear``, of which this is the form with two symbols.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, ctx, fmpz_mpoly

from gks.errors import InputError
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.clear import CLEAR_BITS, clear_factor, decaying_factor
from gks.modes.fibre import at_balls
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.polynomial import Elimination, characteristic_factors
from gks.scheme.model import Scheme


@dataclass(frozen=True, slots=True)
class Eliminated:
    """A problem with lam, and p where there is one, as its symbols, and the norm of its determinant."""

    problem: NormalModeProblem
    norm: Elimination


def eliminated(scheme: Scheme, values: Mapping[str, Fraction], symbols: tuple[str, ...]) -> Eliminated | None:
    """The elimination at a sample, which settles signs of wave speeds and counts; None where there is none to use."""
    try:
        problem = normal_mode_problem(scheme, values, symbols)
        norm = characteristic_factors(problem)
    except InputError:
        return None
    unknown = len(problem.coefficients.point()) < len(problem.coefficients.generators)
    if norm.lost_sheet or problem.coupled or unknown or (problem.variable == "s" and problem.time_map is None):
        return None
    return Eliminated(problem, norm)


def clear_at(found: Eliminated, values: Mapping[str, Root]) -> bool:
    """Whether it is proved that no mode at the symbols' ``values`` has abs(z) >= 1, z = oo included.

    The interior has to be Cauchy-stable there. False proves nothing.
    """
    return _proved(found, values, clear_factor)


def decays_at(found: Eliminated, values: Mapping[str, Root]) -> bool:
    """Whether it is proved that any mode at the symbols' ``values`` with abs(z) >= 1 decays in space strictly.

    No eigenvalue there is generalized then. The interior has to be Cauchy-stable there. False proves nothing.
    """
    return _proved(found, values, decaying_factor)


def _proved(
    found: Eliminated,
    values: Mapping[str, Root],
    proves: Callable[[NormalModeProblem, fmpz_mpoly, Mapping[str, acb]], bool],
) -> bool:
    """For every factor of the norm, where none vanishes identically in z."""
    problem, norm = found.problem, found.norm
    point = {problem.coefficients.variable(name): root for name, root in values.items()}
    bits = START_BITS
    while bits <= CLEAR_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            at = {name: root.ball(bits) for name, root in {**problem.coefficients.point(), **point}.items()}
            factors = [factor.polynomial for factor in (*norm.factors, *norm.clearing)]
            if not any(at_balls(idle, at).contains(0) for idle in norm.idle) and all(
                proves(problem, factor, at) for factor in factors
            ):
                return True
        bits *= 2
    return False
