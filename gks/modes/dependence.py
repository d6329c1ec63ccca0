"""The dimension of the space of solutions that a closure annihilates, from as few spatial roots as make them up.

Certain pivots bound the dimension from above. It is proved from below one solution at a time: spatial roots are left
out as long as the matrix of those that stay does not look regular, until every one that is left has a share in the
solution. That it is one is an exact statement about these few roots (``rank``), whose conjugates are far fewer than
those of all the roots: a standing wave at a wall needs one root of each characteristic field, in whatever system. Then
one of its roots is left out for good, and the dimension has gone down by one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import ctx

from gks.modes.algebraic import GUARD_BITS, Root
from gks.modes.conjugates import vanishes
from gks.modes.height import zero_exponent
from gks.modes.kreiss import NormalModeProblem, closure_matrix
from gks.modes.rank import exact_rank, pivots

LOOK_BITS = 256
"""Precision at which matrices look regular or not; what is found is proved afterwards."""

Roots = Sequence[Sequence[Root]]
"""Spatial roots, a block each."""


def nullity(problem: NormalModeProblem, point: Mapping[str, Root], roots: Roots) -> int:
    """The dimension of the space of solutions made of the roots given that the closure annihilates, exactly.

    Undecided where a zero test would need too many bits.
    """
    dimension = _seen(problem, point, roots)
    left = [list(mine) for mine in roots]
    for _ in range(dimension):
        part = _smallest(problem, point, left)
        _require_dependent(problem, point, part)
        block = next(k for k, mine in enumerate(part) if mine)
        left[block].remove(part[block][0])
    return dimension


def _seen(problem: NormalModeProblem, point: Mapping[str, Root], roots: Roots) -> int:
    """Columns less certain pivots."""
    with ctx.workprec(LOOK_BITS + GUARD_BITS):
        return sum(map(len, roots)) - pivots(closure_matrix(problem, point, roots, LOOK_BITS))


def _smallest(problem: NormalModeProblem, point: Mapping[str, Root], roots: Roots) -> list[list[Root]]:
    """Some of the roots that seem to hold a solution, and seem not to once any of them is left out."""
    part = [list(mine) for mine in roots]
    for block, mine in enumerate(roots):
        for root in mine:
            part[block].remove(root)
            if not _seen(problem, point, part):
                part[block].append(root)
    return part


def _require_dependent(problem: NormalModeProblem, point: Mapping[str, Root], part: Roots) -> None:
    columns = sum(map(len, part))
    if columns == problem.size and vanishes(problem, point[problem.variable], part):
        return
    used: dict[int, set[Root]] = {}
    for block, mine in zip(problem.blocks, part, strict=True):
        used.setdefault(block.family, set()).update(root for root in mine if not root.is_zero)
    counts = {family: len(mine) for family, mine in used.items()}
    exact_rank(
        lambda bits: closure_matrix(problem, point, part, bits),
        lambda: zero_exponent(problem, point[problem.variable], counts),
        ceiling=columns - 1,
    )
