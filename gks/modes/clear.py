"""Proof by balls that no mode is on or outside the circle at one lam, which may be algebraic of any degree.

Most critical values of lam are harmless: the root z that meets the circle there belongs to solutions that do not
decay. To see that takes no algebra over the field of lam. All zeros sigma of the norm are enclosed; where a z may be
on or outside the circle, all spatial roots are kept off the circle and Delta of the decaying ones off 0. What balls
leave open is not answered here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from flint import acb, acb_poly, ctx, fmpz_mpoly, fmpz_poly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.critical import LamElimination
from gks.modes.fibre import polynomial_at_balls
from gks.modes.kreiss import NormalModeProblem, kreiss_matrix_at
from gks.modes.rank import ball_rank

CLEAR_BITS = 4 * START_BITS
"""Precision beyond which the exact route is asked; only speed depends on it."""


def clear_of_modes(eliminated: LamElimination, lam: Root) -> bool:
    """Whether it is proved that no mode at ``lam`` has abs(z) >= 1 (z = oo included), given that none has beside it.

    The elimination's problem has the number of decaying solutions at ``lam``, where the interior is Cauchy-stable.
    False proves nothing.
    """
    problem = eliminated.problem
    irrational = problem.coefficients.point()
    if eliminated.lost_sheet or problem.coupled or len(irrational) < len(problem.coefficients.generators):
        return False
    if problem.variable == "s" and problem.time_map is None:
        return False
    if _is_root(lam, eliminated.lost):
        return False
    moved = [each.factor.polynomial for each in eliminated.events if _is_root(lam, each.polynomials)]
    name = problem.coefficients.variable(problem.resolvent.cfl)
    bits = START_BITS
    while bits <= CLEAR_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            at = {each: root.ball(bits) for each, root in {**irrational, name: lam}.items()}
            if all(clear_factor(problem, factor, at) for factor in moved):
                return True
        bits *= 2
    return False


def _is_root(lam: Root, polynomials: Iterable[fmpz_poly]) -> bool:
    """Exactly: an irreducible polynomial divides whatever shares a root with it."""
    minimal = lam.minimal.poly
    return any(not each % minimal for each in polynomials)


def clear_factor(problem: NormalModeProblem, factor: fmpz_mpoly, at: Mapping[str, acb]) -> bool:
    """Whether balls prove that no zero of one factor of the norm is a mode with abs(z) >= 1 at a point."""
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


def decaying_factor(problem: NormalModeProblem, factor: fmpz_mpoly, at: Mapping[str, acb]) -> bool:
    """Whether balls prove that a mode with abs(z) >= 1 from one factor of the norm would decay in space strictly."""
    zeros = _roots(factor, problem.variable, at)
    return zeros is not None and all(
        _is_inner(problem, here) or _inside(problem, here) is not None
        for here in ({**at, problem.variable: sigma} for sigma in zeros)
    )


def _is_inner(problem: NormalModeProblem, at: Mapping[str, acb]) -> bool:
    """Whether all z of a zero of the norm are inside the circle."""
    images = [at["z"]] if problem.time_map is None else _roots(problem.time_map, "z", at)
    return images is not None and all(abs(z) < 1 for z in images)


def _inside(problem: NormalModeProblem, at: Mapping[str, acb]) -> list[list[acb]] | None:
    """The decaying spatial roots of each family; None where one may be on the circle, or the count is not theirs."""
    per_family = []
    for family in problem.families:
        found = _roots(family.polynomial, "x", at)
        if found is None or not all(abs(x) < 1 or abs(x) > 1 for x in found):
            return None
        inside = [x for x in found if abs(x) < 1]
        if len(inside) != family.decaying:
            return None
        per_family.append(inside)
    return per_family


def _harmless(problem: NormalModeProblem, at: Mapping[str, acb]) -> bool:
    """Whether a zero of the norm has all its z inside, or belongs to another choice of spatial roots."""
    if _is_inner(problem, at):
        return True
    per_family = _inside(problem, at)
    if per_family is None:
        return False
    roots = [[acb(0)] * block.zeros + per_family[block.family] for block in problem.blocks]
    return ball_rank(kreiss_matrix_at(problem, at, roots)) == problem.size
