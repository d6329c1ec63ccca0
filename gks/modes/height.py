"""How small a nonzero minor of the Kreiss matrix can be.

At a root sigma of an integer polynomial f with leading coefficient L, L*sigma is an algebraic integer; with lc the
leading coefficient of a family's P(sigma, x), so is lc*x up to powers of L. A minor, cleared of these denominators, is
an algebraic integer y, and the product of its nonzero conjugates is a nonzero integer. So abs(y) is 0 or at least one
over the product of bounds of its conjugates. The bounds here are coarse (coefficient sums, Cauchy's bound for the
spatial roots): they cost precision, never truth.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf, lgamma, log, log2

from flint import arb, fmpz_mpoly

from gks.modes.algebraic import Root, isolated_roots
from gks.modes.kreiss import NormalModeProblem

_SLACK = 2.0
"""Bits added to each factor of a bound, above anything the double-precision logarithms lose."""


def zero_exponent(problem: NormalModeProblem, sigma: Root | None, used: Mapping[int, int] | None = None) -> float:
    """E such that every minor of the Kreiss matrix at sigma is 0 or larger than 2**-E; sigma None is the point z =
    oo.

    ``used`` says how many different spatial roots of each family the matrix is made of, where they are not all that
    decay.
    """
    heights = {problem.variable: conjugate_heights(sigma)} if sigma is not None else {problem.variable: [0.0]}
    conjugates = 1
    for generator in problem.coefficients.generators:
        if generator.root is not None:
            mine = conjugate_heights(generator.root.minimal)
            heights[generator.name] = [max(mine)]
            conjugates *= len(mine)
    x = problem.coefficients.context.names().index("x")
    for number, family in enumerate(problem.families):
        # Ordered choices of the roots among all roots of the symbol.
        degree = int(family.polynomial.degrees()[x])
        for k in range(min(family.decaying if used is None else used.get(number, 0), degree - 1)):
            conjugates *= degree - k
    bounds = [
        _minor_bound(problem, {**{n: h[0] for n, h in heights.items()}, problem.variable: height})
        for height in heights[problem.variable]
    ]
    return conjugates * sum(bounds) + max(bounds)


def conjugate_heights(root: Root) -> list[float]:
    """log2 max(1, L, abs(L x)) for every conjugate x."""
    minimal = root.minimal
    lead = abs(int(minimal.poly.leading_coefficient()))
    return [
        max(0.0, _log2_integer(lead) + max(0.0, log2_upper(abs(other.ball())))) + _SLACK
        for other in isolated_roots(minimal.poly, is_square_free=True)
    ]


def _log2_integer(value: int) -> float:
    if value == 0:
        return -inf
    shift = max(value.bit_length() - 60, 0)
    return log2(value >> shift) + shift


def log2_upper(value: arb) -> float:
    """log2 of the absolute value, rounded up but for the last digits of a double; -inf for 0."""
    size = value.abs_upper()
    if size == 0:
        return -inf
    mantissa, exponent = size.man_exp()
    return _log2_integer(abs(int(mantissa))) + int(exponent)


def norm_bits(polynomials: Iterable[fmpz_mpoly]) -> float:
    """log2 of the sum of the absolute values of all coefficients."""
    total = sum(abs(int(c)) for p in polynomials for c in p.coeffs())
    return _log2_integer(total) if total else 0.0


def _weight(polynomial: fmpz_mpoly, names: tuple[str, ...], heights: dict[str, float]) -> float:
    """log2 of the bound that the powers of sigma and the generators contribute."""
    return sum(int(degree) * heights.get(name, 0.0) for name, degree in zip(names, polynomial.degrees(), strict=True))


def _minor_bound(problem: NormalModeProblem, heights: dict[str, float]) -> float:
    names = problem.coefficients.context.names()
    size = problem.size
    total = lgamma(size + 1) / log(2)
    scales = [norm_bits([f.polynomial]) + _weight(f.polynomial, names, heights) + _SLACK for f in problem.families]
    for row in problem.rows:
        if not row:
            continue
        total += norm_bits(t.coefficient for t in row) + _SLACK
        total += max(_weight(t.coefficient, names, heights) for t in row)
        reach: dict[int, int] = {}
        for term in row:
            family = problem.blocks[term.block].family
            reach[family] = max(reach.get(family, 0), term.n)
        # A divided difference of x**n over d roots has at most 2**(n+d) monomials.
        total += max(term.n + problem.blocks[term.block].width for term in row)
        total += sum(n * scales[family] for family, n in reach.items())
    return total
