"""A problem that falls apart into several that know nothing of each other.

Two equal media coupled with no preference for a side, or two fields behind walls of their own: combinations of the
closure's rows hold the fields of one group alone. Delta is then the product of the groups' own determinants, a double
zero of it a simple one of each, and what holds of a wave that runs one way is proved for it by itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import gcd

from flint import fmpz_mat

from gks.modes.kreiss import NormalModeProblem, Term

_Key = tuple[int, int, tuple[int, ...]]
"""A block, a place, and the powers of a monomial of the coefficient."""


def decoupled(problem: NormalModeProblem) -> list[NormalModeProblem]:
    """The independent parts that constant combinations of the rows leave, each with as many rows as decaying
    solutions; the problem itself where it is one. Whether the blocks of a coupled one are independent is not looked at.
    """
    if problem.coupled:
        return [problem]
    used = [k for k, block in enumerate(problem.blocks) if block.width]
    rows = [_expanded(row, used) for row in problem.rows]
    reduced = _reduced(rows)
    if len(reduced) < len(rows):
        return [problem]
    groups = _groups(used, [{block for block, _, _ in row} for row in reduced])
    parts = [_part(problem, group, [row for row in reduced if next(iter(row))[0] in group]) for group in groups]
    if len(parts) < 2 or any(sum(b.width for b in part.blocks) != part.size for part in parts):
        return [problem]
    return parts


def _expanded(row: Sequence[Term], used: Sequence[int]) -> dict[_Key, int]:
    return {
        (term.block, term.n, powers): int(c)
        for term in row
        if term.block in used
        for powers, c in term.coefficient.to_dict().items()
    }


def _reduced(rows: Sequence[dict[_Key, int]]) -> list[dict[_Key, int]]:
    """The reduced echelon form: that of a direct sum is made up of those of its summands."""
    keys = sorted({key for row in rows for key in row})
    if not keys:
        return []
    echelon, _, rank = fmpz_mat([[row.get(key, 0) for key in keys] for row in rows]).rref()
    found = []
    for i in range(int(rank)):
        entries = [int(echelon[i, j]) for j in range(len(keys))]
        common = gcd(*entries)
        found.append({key: entry // common for key, entry in zip(keys, entries, strict=True) if entry})
    return found


def _groups(used: Sequence[int], joined: Sequence[set[int]]) -> Iterator[list[int]]:
    """The blocks, by what rows join."""
    left = list(used)
    while left:
        group = {left[0]}
        while more := {block for each in joined if each & group for block in each} - group:
            group |= more
        yield sorted(group)
        left = [block for block in left if block not in group]


def _part(problem: NormalModeProblem, group: Sequence[int], rows: Sequence[dict[_Key, int]]) -> NormalModeProblem:
    """The problem of a group of blocks, which are counted anew, as are the families they use."""
    families = sorted({problem.blocks[k].family for k in group})
    blocks = [replace(problem.blocks[k], family=families.index(problem.blocks[k].family)) for k in group]
    context = problem.coefficients.context
    terms = []
    for row in rows:
        places = dict.fromkeys((block, n) for block, n, _ in row)
        terms.append(
            tuple(
                Term(
                    group.index(block),
                    n,
                    context.from_dict({powers: c for (b, m, powers), c in row.items() if (b, m) == (block, n)}),
                )
                for block, n in places
            )
        )
    return replace(
        problem,
        families=tuple(problem.families[k] for k in families),
        blocks=tuple(blocks),
        rows=tuple(terms),
    )
