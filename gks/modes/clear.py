"""Proof by balls that no mode is on or outside the circle at one lam, which may be algebraic of any degree.

Most critical values of lam are harmless: the root z that meets the circle there belongs to solutions that do not
decay. To see that takes no algebra over the field of lam. All zeros sigma of the norm are enclosed; where a z may be
on or outside the circle, all spatial roots are kept off the circle and Delta of the decaying ones off 0. What balls
leave open is not answered here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import acb, acb_poly, ctx, fmpz_mpoly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.fibre import at_balls, polynomial_at_balls
from gks.modes.kreiss import NormalModeProblem, kreiss_matrix_at
from gks.modes.polynomial import Elimination
from gks.modes.rank import ball_rank

CLEAR_BITS = 4 * START_BITS
"""Precision beyond which the exact route is asked; only speed depends on it."""


def clear_of_modes(problem: NormalModeProblem, elimination: Elimination, lam: Root) -> bool:
    """Whether it is proved that no mode at ``lam`` has abs(z) >= 1 (z = oo included); False proves nothing.

    ``problem`` and its ``elimination`` have lam as their one symbol, and the number of decaying solutions at ``lam``;
    the interior is Cauchy-stable there.
    """
    if elimination.lost_sheet or problem.coupled or problem.coefficients.generators:
        return False
    if problem.variable == "s" and problem.time_map is None:
        return False
    name = problem.coefficients.variable(problem.resolvent.cfl)
    bits = START_BITS
    while bits <= CLEAR_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            at = {name: lam.ball(bits)}
            zeros = (*elimination.factors, *elimination.clearing)
            if _regular(problem, elimination, at) and all(_clear(problem, f.polynomial, at) for f in zeros):
                return True
        bits *= 2
    return False


def _regular(problem: NormalModeProblem, elimination: Elimination, at: Mapping[str, acb]) -> bool:
    """Whether the scheme has a value at this lam and its norm does not vanish identically there."""
    kept = (*elimination.idle, *map(problem.coefficients.norm, problem.coefficients.inverted.values()))
    return not any(at_balls(each, at).contains(0) for each in kept)


def _clear(problem: NormalModeProblem, factor: fmpz_mpoly, at: Mapping[str, acb]) -> bool:
    zeros = _roots(factor, problem.variable, at)
    return zeros is not None and all(_harmless(problem, {**at, problem.variable: sigma}) for sigma in zeros)


def _roots(polynomial: fmpz_mpoly, variable: str, at: Mapping[str, acb]) -> Sequence[acb] | None:
    """Enclosures of all roots, None where they are not told apart or the degree is in doubt."""
    parts = polynomial_at_balls(polynomial, variable, at)
    if not parts or parts[-1].contains(0):
        return None
    try:
        return list(acb_poly(parts).roots())
    except ValueError:
        return None


def _harmless(problem: NormalModeProblem, at: Mapping[str, acb]) -> bool:
    """Whether a zero of the norm has all its z inside, or belongs to another choice of spatial roots."""
    images = [at["z"]] if problem.time_map is None else _roots(problem.time_map, "z", at)
    if images is None:
        return False
    if all(abs(z) < 1 for z in images):
        return True
    per_family = []
    for family in problem.families:
        found = _roots(family.polynomial, "x", at)
        if found is None or not all(abs(x) < 1 or abs(x) > 1 for x in found):
            return False
        inside = [x for x in found if abs(x) < 1]
        if len(inside) != family.decaying:
            return False
        per_family.append(inside)
    roots = [[acb(0)] * block.zeros + per_family[block.family] for block in problem.blocks]
    return ball_rank(kreiss_matrix_at(problem, at, roots)) == problem.size
