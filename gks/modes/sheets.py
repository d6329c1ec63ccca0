"""Which choice of spatial roots makes the determinant vanish at a root of the norm.

At a root sigma of the norm some choice (sheet) vanishes: the norm is the product over all of them, and no leading
coefficient is zero there. If balls keep the determinant of every other choice away from 0, the one that is left
vanishes, exactly, at a precision far below what a bound on algebraic numbers would ask for. Where the norm is that of a
factor of the determinant with the roots of some families alone, the choices that differ in these are all there are.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations, product

from flint import ctx

from gks.modes.admissible import Candidate, point_of
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.fibre import at_balls, fibre
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import Family, NormalModeProblem, closure_matrix
from gks.modes.rank import certain_rank

SHEET_BITS = 1 << 10
"""Precision beyond which a second choice that still may vanish is taken to do so."""

Choice = tuple[tuple[Root, ...], ...]
"""The nonzero spatial roots of every family."""


def only_vanishing(problem: NormalModeProblem, candidate: Candidate, mine: Choice) -> bool:
    """Whether all choices but ``mine`` are proved not to vanish; False proves nothing."""
    if not candidate.sheets or problem.coefficients.generators:
        return False
    if any(not _leads(problem, candidate, family) for family in problem.families):
        return False
    point = point_of(problem, candidate)
    wanted = _key(mine)
    return any(
        all(
            _key(choice) == wanted or _never_vanishes(problem, point, choice)
            for choice in _choices(problem, candidate, mine, families)
        )
        for families in candidate.sheets
    )


def _never_vanishes(problem: NormalModeProblem, point: Mapping[str, Root], choice: Choice) -> bool:
    roots = [[Root.of(0)] * block.zeros + list(choice[block.family]) for block in problem.blocks]
    rank = certain_rank(lambda bits: closure_matrix(problem, point, roots, bits), SHEET_BITS)
    return rank == problem.size


def _key(choice: Choice) -> tuple[tuple[tuple[tuple[int, ...], int], ...], ...]:
    """Equal exactly for equal choices, whatever the order of the roots."""
    return tuple(tuple(sorted(_name(root) for root in roots)) for roots in choice)


def _name(root: Root) -> tuple[tuple[int, ...], int]:
    """An algebraic number by its irreducible polynomial and its place among the roots."""
    minimal = root.minimal
    return tuple(int(c) for c in list(minimal.poly)), minimal.index


def _leads(problem: NormalModeProblem, candidate: Candidate, family: Family) -> bool:
    """Whether the family keeps all its roots at the candidate: the leading coefficient of its part is not 0."""
    lead = powers_of(family.part, "x")[-1]
    with ctx.workprec(START_BITS + GUARD_BITS):
        at = {name: root.ball(START_BITS) for name, root in point_of(problem, candidate).items()}
        return not at_balls(lead, at).contains(0)


def _choices(
    problem: NormalModeProblem, candidate: Candidate, mine: Choice, families: Collection[int]
) -> Iterator[Choice]:
    """Every choice that may differ from ``mine`` in the families given."""
    per_family: list[Sequence[tuple[Root, ...]]] = []
    point = point_of(problem, candidate)
    for k, family in enumerate(problem.families):
        if k not in families:
            per_family.append([mine[k]])
            continue
        roots = [r.root for r in fibre(point, family.part, "x") for _ in range(r.multiplicity)]
        distinct = {_key((choice,)): choice for choice in combinations(roots, family.decaying)}
        per_family.append(list(distinct.values()))
    yield from product(*per_family)
