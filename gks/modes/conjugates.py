"""How small a nonzero determinant can be at an algebraic point, from the sizes of its conjugates.

Let sigma be a root of an irreducible integer polynomial with leading coefficient L, D_k the degree of a family's
P_k(sigma, x) in sigma, p_k its leading coefficient in x, a_i the degree of closure row i in sigma, and e_k the degree
of Delta in one of the family's roots (Delta is symmetric in them, and the last one stands in the last column of each
block alone). A product of different roots of P_k times L**D_k p_k(sigma) is an algebraic integer, so

    y = L**(sum_i a_i + sum_k e_k D_k) prod_k p_k(sigma)**e_k Delta

is one as well, and its conjugates are among its values at the conjugates of sigma over every choice of as many spatial
roots of each family. The product of the nonzero ones is a nonzero integer: abs(y) is 0 or at least one over the product
of the others, each counted as 1 at least. Unlike a bound by heights this takes the sizes that the conjugates have, and
each set of roots once.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, product
from math import comb, inf, prod

from flint import acb, acb_mat, acb_poly, arb, ctx

from gks.modes.algebraic import GUARD_BITS, START_BITS, Root, isolated_roots
from gks.modes.cauchy import degree_in
from gks.modes.fibre import at_balls
from gks.modes.fibre import coefficients as powers_of
from gks.modes.height import log2_upper
from gks.modes.kreiss import Enclosed, NormalModeProblem, closure_matrix, kreiss_matrix, longest, newton_columns
from gks.modes.rank import RANK_BITS

MOST_CONJUGATES = 2000
"""Determinants that a bound is made of, at most: a second's work."""


def vanishes(problem: NormalModeProblem, sigma: Root, roots: Sequence[Sequence[Enclosed]]) -> bool | None:
    """Whether Delta is zero at sigma over the spatial roots given, a block each and as many as decay; None where that
    takes too much.
    """
    exponent = smallest_exponent(problem, sigma)
    bits = 2 * START_BITS
    while bits <= 2 * RANK_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            point = {**problem.coefficients.point(), problem.variable: sigma}
            value = acb_mat(closure_matrix(problem, point, roots, bits)).det()
            if not value.contains(0):
                return False
            if exponent == inf:
                return None
            if value.abs_upper() < arb(2) ** -int(exponent + 1):
                return True
        bits = max(2 * bits, min(int(exponent) + 2 * START_BITS, RANK_BITS))
    return None


def smallest_exponent(problem: NormalModeProblem, sigma: Root) -> float:
    """E such that Delta at sigma is 0 or larger than 2**-E, over any choice of roots; infinite where none is known."""
    minimal = sigma.minimal
    degree = minimal.poly.degree()
    choices = prod(comb(_degree(problem, k), f.decaying) for k, f in enumerate(problem.families))
    if problem.coupled or not problem.size or degree * choices > MOST_CONJUGATES or not _in_one_variable(problem):
        return inf
    weights = _Weights(problem, minimal)
    total = 0.0
    with ctx.workprec(4 * START_BITS + GUARD_BITS):
        for other in isolated_roots(minimal.poly, is_square_free=True):
            at = other.ball(4 * START_BITS)
            if at.imag < 0:
                continue  # the conjugate of one that is counted twice
            factor = weights.bits(at)
            try:
                sizes = list(_sizes(problem, at))
            except ValueError:  # FLINT did not isolate the spatial roots
                return inf
            total += sum(max(0.0, factor + size + 1) for size in sizes) * (1 if at.imag == 0 else 2)
        return total + max(0.0, weights.bits(minimal.ball(4 * START_BITS))) + 1


def _in_one_variable(problem: NormalModeProblem) -> bool:
    """Whether all coefficients are polynomials in the resolvent variable alone."""
    names = problem.coefficients.context.names()
    others = [k for k, name in enumerate(names) if name not in (problem.variable, "x")]
    polynomials = [f.polynomial for f in problem.families] + [t.coefficient for row in problem.rows for t in row]
    return not any(p.degrees()[k] for p in polynomials for k in others)


def _degree(problem: NormalModeProblem, family: int) -> int:
    return degree_in(problem.families[family].polynomial, "x")


class _Weights:
    """The logarithm of what makes Delta an algebraic integer."""

    def __init__(self, problem: NormalModeProblem, minimal: Root) -> None:
        name = problem.variable
        degrees = [0] * len(problem.families)
        for k, block in enumerate(problem.blocks):
            degrees[block.family] += max(0, longest(problem.rows, k) - block.width)
        rows = sum(max((degree_in(t.coefficient, name) for t in row), default=0) for row in problem.rows)
        power = rows + sum(e * degree_in(f.polynomial, name) for e, f in zip(degrees, problem.families, strict=True))
        self._lead = int(power) * log2_upper(abs(arb(minimal.poly.leading_coefficient())))
        self._parts = [(e, powers_of(f.polynomial, "x")[-1]) for e, f in zip(degrees, problem.families, strict=True)]
        self._name = name

    def bits(self, at: acb) -> float:
        """log2, rounded up; -inf where a leading coefficient vanishes."""
        sizes = (e * log2_upper(abs(at_balls(part, {self._name: at}))) for e, part in self._parts if e)
        return self._lead + sum(sizes) + 1


def _sizes(problem: NormalModeProblem, at: acb) -> Iterator[float]:
    """log2 of abs(Delta) at a point over every choice of spatial roots."""
    name = problem.variable
    weights = {id(t.coefficient): at_balls(t.coefficient, {name: at}) for row in problem.rows for t in row}
    options = []
    for family in problem.families:
        polynomial = acb_poly([at_balls(c, {name: at}) for c in powers_of(family.polynomial, "x")])
        options.append(list(combinations(polynomial.roots(), family.decaying)))
    lengths = [longest(problem.rows, k) for k in range(len(problem.blocks))]
    for choice in product(*options):
        columns = [
            newton_columns([acb(0)] * b.zeros + list(choice[b.family]), count, acb(0), acb(1))
            for b, count in zip(problem.blocks, lengths, strict=True)
        ]
        matrix = kreiss_matrix(problem.rows, columns, lambda c: weights[id(c)], acb(0))
        yield log2_upper(abs(acb_mat(matrix).det()))
