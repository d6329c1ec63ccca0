"""Whether a problem looks the same with time run backwards, and what follows for its modes on the unit circle.

Under a nondissipative integrator z -> 1/z takes lam*s to -lam*s. Where that, with the characteristic fields exchanged
(and their signs changed, at most), takes every symbol and the closure to themselves, the spatial roots inside the
circle go to spatial roots inside the circle: wherever none of them is on it, Delta(1/z) is Delta(z) up to a constant.
Its coefficients are real, so the zeros close to the unit circle come in pairs z, 1/conj(z), and one that has no other
beside it lies on the circle exactly. Waves of u_t = s_x, s_t = u_x below a wall or an interface that couples u with u
and s with s are of this kind: s changes its sign. So is a wave of u_t + u_x = 0 through an interface that looks the
same from either side: the half-lines are exchanged.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, product

from flint import fmpq, fmpq_poly, fmpz_mat, fmpz_mpoly

from gks.modes.cauchy import degree_in, reciprocal_in
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem, Term
from gks.scheme.integrators import Integrator


def reversible(problem: NormalModeProblem) -> bool:
    """Whether the problem is its own time reversal; False also where that is not looked into."""
    method = problem.resolvent.integrator if problem.variable == "s" else None
    if problem.coupled or problem.coefficients.generators or (problem.variable == "s" and not reverses_time(method)):
        return False
    images = [_image(problem, k) for k in range(len(problem.families))]
    if any(image is None for image in images):
        return False
    before = [_expanded(problem, row, range(len(problem.blocks)), [1] * len(problem.blocks)) for row in problem.rows]
    reversed_rows = [_reversed_row(problem, row) for row in problem.rows]
    for order in _exchanges(problem, images):
        for signs in product((1, -1), repeat=len(order) - 1):
            after = [_expanded(problem, row, order, [1, *signs]) for row in reversed_rows]
            if _rank(before + after) == _rank(before) == _rank(after) == problem.size:
                return True
    return False


def reverses_time(method: Integrator | None) -> bool:
    """Whether lam*s(1/z) = -lam*s(z) for every root z of the integrator: then Re s = 0 wherever abs(z) = 1."""
    if method is None or method.kind == "runge-kutta":
        return False
    if method.kind == "exact":
        return True
    degree = max(len(method.rho), len(method.sigma)) - 1
    rho, sigma = (fmpq_poly([fmpq(c.numerator, c.denominator) for c in part]) for part in (method.rho, method.sigma))
    return bool(_mirrored(rho, degree) * sigma == -(rho * _mirrored(sigma, degree)))


def _mirrored(polynomial: fmpq_poly, degree: int) -> fmpq_poly:
    """z**degree polynomial(1/z)."""
    return fmpq_poly([polynomial[degree - k] for k in range(degree + 1)])


def time_reversed(problem: NormalModeProblem, polynomial: fmpz_mpoly) -> fmpz_mpoly:
    """The polynomial at -s, or at 1/z times the power of z that clears it."""
    name = problem.variable
    if name != "s":
        return reciprocal_in(polynomial, (name,))
    return polynomial.compose(*(-g if n == name else g for n, g in problem.coefficients.gens.items()))


def _image(problem: NormalModeProblem, family: int) -> int | None:
    """The family whose symbol is that of this one reversed."""
    image = time_reversed(problem, problem.families[family].polynomial)
    for k, other in enumerate(problem.families):
        if other.polynomial in (image, -image) and other.decaying == problem.families[family].decaying:
            return k
    return None


MOST_EXCHANGES = 200
"""Ways to exchange fields that are looked at: all of a few fields; of many equal ones the first."""


def _exchanges(problem: NormalModeProblem, images: Sequence[int | None]) -> Iterator[list[int]]:
    """The ways to take each block to one with the family's image, as places; of the same half-line first."""
    blocks = problem.blocks

    def completed(order: list[int]) -> Iterator[list[int]]:
        if len(order) == len(blocks):
            yield order
            return
        block = blocks[len(order)]
        fitting = [
            to
            for to, other in enumerate(blocks)
            if other.family == images[block.family] and other.zeros == block.zeros and to not in order
        ]
        for to in sorted(fitting, key=lambda to: blocks[to].field.domain != block.field.domain):
            yield from completed([*order, to])

    return islice(completed([]), MOST_EXCHANGES)


def _reversed_row(problem: NormalModeProblem, row: Sequence[Term]) -> list[Term]:
    if problem.variable == "s":
        return [Term(t.block, t.n, time_reversed(problem, t.coefficient)) for t in row]
    # One power of z for the whole row clears its denominators.
    z = problem.coefficients.gens[problem.variable]
    degrees = [degree_in(t.coefficient, problem.variable) for t in row]
    return [
        Term(t.block, t.n, time_reversed(problem, t.coefficient) * z ** (max(degrees) - degree))
        for t, degree in zip(row, degrees, strict=True)
    ]


def _expanded(
    problem: NormalModeProblem, row: Sequence[Term], order: Sequence[int], signs: Sequence[int]
) -> dict[tuple[int, int, int], int]:
    """A row by block, place and power of the variable, its blocks moved and their signs changed."""
    entries: dict[tuple[int, int, int], int] = {}
    for term in row:
        for power, c in enumerate(powers_of(term.coefficient, problem.variable)):
            if not c.is_zero():
                entries[order[term.block], term.n, power] = signs[term.block] * int(c.coeffs()[0])
    return entries


def _rank(rows: Sequence[dict[tuple[int, int, int], int]]) -> int:
    keys = sorted({key for row in rows for key in row})
    return int(fmpz_mat([[row.get(key, 0) for key in keys] for row in rows]).rank()) if keys else 0
