"""Zeros of Delta that several choices of spatial roots share, told exactly. Part of the checker.

At a rational point the values of Delta over all roots sigma of an irreducible g and all choices of spatial roots are
the roots t of one integer polynomial: the norm of t - Delta. Its order at t = 0 is the number of choices at which Delta
is zero. Where it equals the number of those whose ball holds 0, each of them is zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import factorial, prod

from flint import fmpz_mpoly, fmpz_poly

from gks.bounds.checkballs import Open
from gks.bounds.checkcurves import carried_roots, delta_polynomial, relations
from gks.bounds.checkderive import Problem
from gks.bounds.checkring import GEN, ZERO, parts_of, put

VALUE = "p"
"""The ring's name for t: at a rational point the parameter is not in use."""


def zeros_of_delta(problem: Problem, g: fmpz_poly, at: Mapping[str, Fraction]) -> int:
    """How many (root of g, choice of spatial roots) make Delta zero; Open where the count is beyond this."""
    carried = carried_roots(problem)
    value = GEN[VALUE] - specialised(delta_polynomial(problem, carried), at)
    for names, family in zip(carried, problem.families, strict=True):
        for name, relation in relations(specialised(family.part, at), names):
            value = value.resultant(relation, name)
    sigma = sum((int(c) * GEN[problem.variable] ** k for k, c in enumerate(list(g))), ZERO)
    norm = value.resultant(sigma, problem.variable)
    if norm.is_zero():
        raise Open
    parts = parts_of(norm, VALUE)
    order = next(k for k, part in enumerate(parts) if not part.is_zero())
    # Every choice is met once for each order in which its roots may be taken.
    orders = prod(factorial(family.decaying) for family in problem.families)
    if order % orders:
        raise Open
    return order // orders


def specialised(polynomial: fmpz_mpoly, values: Mapping[str, Fraction]) -> fmpz_mpoly:
    """Rationals put in for variables, denominators cleared."""
    for name, value in values.items():
        polynomial = put(polynomial, name, value)
    return polynomial
