"""The checker's elimination of the spatial roots, and its boundary curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

from flint import fmpz_mpoly

from gks.bounds.checkderive import Problem
from gks.bounds.checkformula import Rejected
from gks.bounds.checkring import (
    GEN,
    MOST_ROOTS,
    ONE,
    ZERO,
    Fr,
    Unsupported,
    degree,
    determinant,
    factors,
    mirror,
    parts_of,
    put,
)


def bases(roots: Sequence[Any], count: int, zero: Any, one: Any) -> list[list[Any]]:
    """Column j: complete homogeneous polynomials h_(n-j) of the first j + 1 roots, n < count."""
    columns = []
    for j in range(len(roots)):
        # Their generating function is the product of 1/(1 - k_i t).
        series: list[Any] = [one] + [zero] * count
        for root in roots[: j + 1]:
            for m in range(1, count + 1):
                series[m] = series[m] + root * series[m - 1]
        columns.append(([zero] * j + series)[:count])
    return columns


def kreiss(
    problem: Problem, roots: Sequence[Sequence[Any]], coefficient: Callable[[fmpz_mpoly], Any], zero: Any, one: Any
) -> list[list[Any]]:
    """The closure applied to every column; ``roots`` of each block, zeros included."""
    blocks = range(len(problem.blocks))
    reach = [1 + max((n for row in problem.rows for k, n, _ in row if k == b), default=0) for b in blocks]
    columns = [bases(mine, reach[b], zero, one) for b, mine in enumerate(roots)]
    matrix = []
    for row in problem.rows:
        line = []
        for b, block in enumerate(columns):
            mine = [(n, coefficient(c)) for k, n, c in row if k == b]
            line += [sum((c * column[n] for n, c in mine), zero) for column in block]
        matrix.append(line)
    return matrix


def characteristic(problem: Problem) -> tuple[list[fmpz_mpoly], list[fmpz_mpoly]]:
    """Irreducible factors of the norm of Delta: those with sigma, and those in p and lam alone."""
    carried = carried_roots(problem)
    norm = delta_polynomial(problem, carried)
    for names, family in zip(carried, problem.families, strict=True):
        for name, relation in relations(family.part, names):
            common = norm.gcd(relation)
            while degree(common, name):
                norm = norm / common
                common = norm.gcd(relation)
            norm = norm.resultant(relation, name)
            if norm.is_zero():
                raise Rejected("the determinant of the closure vanishes identically")
    found = [f for f, _ in factors(norm)]
    return [f for f in found if degree(f, problem.variable)], [f for f in found if not degree(f, problem.variable)]


def carried_roots(problem: Problem) -> list[list[str]]:
    """Names for the decaying roots of each family."""
    carried: list[list[str]] = []
    used = 0
    for family in problem.families:
        carried.append([f"k{used + j}" for j in range(family.decaying)])
        used += family.decaying
        if used > MOST_ROOTS:
            raise Unsupported("too many spatial roots to eliminate")
    return carried


def delta_polynomial(problem: Problem, carried: Sequence[Sequence[str]]) -> fmpz_mpoly:
    """Delta in the spatial roots by name."""
    roots = [[ZERO] * b.zeros + [GEN[name] for name in carried[b.family]] for b in problem.blocks]
    matrix = kreiss(problem, roots, lambda c: c, ZERO, ONE)
    return determinant([[Fr(entry, ONE) for entry in row] for row in matrix]).num


def relations(part: fmpz_mpoly, names: Sequence[str]) -> list[tuple[str, fmpz_mpoly]]:
    """What each of several roots of one polynomial satisfies given those before it, the last one first."""
    found = []
    rest = part
    for name in names:
        found.append((name, _compose(rest, name)))
        rest = _divided(rest, name)
    return found[::-1]


def _compose(polynomial: fmpz_mpoly, name: str) -> fmpz_mpoly:
    return sum((c * GEN[name] ** k for k, c in enumerate(parts_of(polynomial, "x"))), ZERO)


def _divided(polynomial: fmpz_mpoly, name: str) -> fmpz_mpoly:
    """(f(x) - f(k))/(x - k)."""
    total = ZERO
    for k, c in enumerate(parts_of(polynomial, "x")):
        total += c * sum((GEN["x"] ** i * GEN[name] ** (k - 1 - i) for i in range(k)), ZERO)
    return total


# Curves -------------------------------------------------------------------------------------------------------------


def curves(problem: Problem, *, closure: bool = True) -> dict[str, fmpz_mpoly]:
    """Irreducible polynomials in p and lam off whose zeros the verdict cannot change, but for constants and lam.

    Without ``closure`` only those of the interior.
    """
    found: dict[str, fmpz_mpoly] = {}
    for polynomial in (*problem.structure, *_all_growth(problem), *(_of_closure(problem) if closure else ())):
        for factor, _ in factors(polynomial):
            if not factor.is_constant() and factor != GEN["lam"]:
                found.setdefault(str(factor), factor)
    return found


def in_z(problem: Problem, own: Sequence[fmpz_mpoly]) -> list[fmpz_mpoly]:
    """The factors in sigma mapped to z."""
    if problem.time_map is None:
        return list(own)
    return [g for f in own for g, _ in factors(f.resultant(problem.time_map, "s"))]


def _of_closure(problem: Problem) -> Iterator[fmpz_mpoly]:
    own, idle = characteristic(problem)
    yield from idle
    growing = in_z(problem, own)
    loci = list(_loci(problem))
    for f in growing:
        yield parts_of(f, "z")[-1]
        if not degree(f, "z"):
            continue
        yield from (put(f, "z", Fraction(end)) for end in (1, -1))
        if mirror(f, "z") in (f, -f):
            if degree(f, "z") > 1:
                yield f.discriminant("z")
        else:
            yield inner(f)
        yield from (f.resultant(locus, "z") for locus in loci if locus != f)


def inner(f: fmpz_mpoly) -> fmpz_mpoly:
    """Jury's inner determinant: up to powers of the leading coefficient the product of 1 - z_i z_j over pairs."""
    a = parts_of(f, "z")
    size = len(a) - 2
    matrix = [
        [
            Fr((a[-1 - (j - i)] if j >= i else ZERO) - (a[i + j - size + 1] if i + j >= size - 1 else ZERO), ONE)
            for j in range(size)
        ]
        for i in range(size)
    ]
    return determinant(matrix).num


def _loci(problem: Problem) -> Iterator[fmpz_mpoly]:
    """z over an open set of (p, lam) with a unimodular x, other than 1 and -1."""
    for growth in problem.growth:
        split = [f for f, _ in factors(growth) if degree(f, "x") and degree(f, "z")]
        neutral = [f for f in split if mirror(f, "z", "x") in (f, -f)]
        found = [f.discriminant("x") for f in neutral if degree(f, "x") > 1]
        for f in split:
            if f in neutral:
                continue
            cut = f.resultant(mirror(f, "z", "x"), "z")
            for spot, order in factors(cut):
                if degree(spot, "x") and mirror(spot, "x") in (spot, -spot) and (order > 1 or spot.total_degree() == 1):
                    found.append(f.resultant(spot, "x"))
        for locus in found:
            for g, _ in factors(locus):
                if degree(g, "z") and g.total_degree() > 1 and mirror(g, "z") in (g, -g):
                    yield g


def _all_growth(problem: Problem) -> Iterator[fmpz_mpoly]:
    for growth in problem.growth:
        yield from _interior(growth)


def _interior(growth: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    """Where the picture of F(z, x) = 0 over abs(x) = 1 changes."""
    split = [f for f, _ in factors(growth)]
    yield from (f for f in split if not degree(f, "z") and not degree(f, "x"))
    cuts = _irreducible(locus for f in split for locus in _cuts(f, split))
    moving = [f for f in split if degree(f, "z")]
    meetings = [f.discriminant("z") for f in moving if degree(f, "z") > 1]
    meetings += [one.resultant(other, "z") for one, other in combinations(moving, 2)]
    circle = [c for c in cuts if degree(c, "x")]
    yield from (c for c in cuts if not degree(c, "x"))
    for c in [*circle, *_irreducible(meetings)]:
        yield from (put(c, "x", Fraction(end)) for end in (1, -1))
    palindromes = [c for c in circle if degree(c, "x") % 2 == 0 and mirror(c, "x") == c]
    yield from (c.discriminant("x") for c in palindromes)
    yield from (one.resultant(other, "x") for one, other in combinations(palindromes, 2))


def _cuts(f: fmpz_mpoly, split: Sequence[fmpz_mpoly]) -> Iterator[fmpz_mpoly]:
    """Loci in x of a root z at infinity, on the circle, or, where roots stay on the circle, of two that meet."""
    yield parts_of(f, "z")[-1]
    if not degree(f, "z"):
        return
    if mirror(f, "z", "x") not in (f, -f):
        yield f.resultant(mirror(f, "z", "x"), "z")
        return
    if degree(f, "z") > 1:
        yield f.discriminant("z")
    for other in split[: split.index(f)]:
        if mirror(other, "z", "x") in (other, -other):
            yield f.resultant(other, "z")


def _irreducible(polynomials: Iterable[fmpz_mpoly]) -> list[fmpz_mpoly]:
    return list({str(g): g for polynomial in polynomials for g, _ in factors(polynomial)}.values())
