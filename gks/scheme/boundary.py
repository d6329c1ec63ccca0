"""Which values the closure has to give, and whether it has an equation for each.

A boundary unknown is a value at an index that the interior scheme does not give and that is read all the same, by the
interior scheme at some cell or by a closure equation, with a coefficient that is not identically zero as a formula.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from gks.scheme.model import Equation, GridValue, HalfLine, Parameter


def boundary_unknowns(
    domains: Sequence[HalfLine], equations: Sequence[Equation], parameters: Sequence[Parameter]
) -> tuple[GridValue, ...]:
    """All of them, at level 0, by domain, index and unknown. SchemeError (without a place) from `operators.reach`."""
    found: set[tuple[str, int, str]] = set()
    for domain in domains:
        found |= {(domain.name, index, unknown) for index, unknown in _read_by_interior(domain, parameters)}
    sides = {domain.name: domain for domain in domains}
    for equation in equations:
        for value, _ in equation.form.terms:
            if sides[value.domain].is_boundary(value.index):
                found.add((value.domain, value.index, value.unknown))
    order = {(domain.name, unknown): k for domain in domains for k, unknown in enumerate(domain.unknowns)}
    names = [domain.name for domain in domains]
    in_order = sorted(found, key=lambda f: (names.index(f[0]), f[1], order[f[0], f[2]]))
    return tuple(GridValue(name, unknown, index, 0) for name, index, unknown in in_order)


def _read_by_interior(domain: HalfLine, parameters: Sequence[Parameter]) -> set[tuple[int, str]]:
    """(index, unknown) of the boundary points that the interior scheme reads, as i runs over its cells.

    An offset o from i >= first reaches every index from first + o on; mirrored on the left.
    """
    from gks.scheme.operators import reach

    found: set[tuple[int, str]] = set()
    for unknown, (least, greatest) in reach(domain, parameters).items():
        if domain.side == "right":
            indices = range(domain.first + least, domain.first)
        else:
            indices = range(-domain.first + 1, -domain.first + greatest + 1)
        found |= {(index, unknown) for index in indices}
    return found


def without_equation(unknowns: Sequence[GridValue], equations: Sequence[Equation]) -> list[GridValue]:
    """Boundary unknowns that are left over when each equation is spent on one unknown that it holds.

    Those that no equation holds come first; among the others a maximum matching leaves as few as possible.
    """
    place = {(u.domain, u.unknown, u.index): k for k, u in enumerate(unknowns)}
    held: list[list[int]] = []
    for equation in equations:
        keys = ((value.domain, value.unknown, value.index) for value, _ in equation.form.terms)
        held.append(sorted({place[key] for key in keys if key in place}))
    occurring = {k for row in held for k in row}
    spent = _matched(held)
    absent = [u for k, u in enumerate(unknowns) if k not in occurring]
    return absent + [u for k, u in enumerate(unknowns) if k in occurring and k not in spent]


# An augmenting path costs up to the number of terms, and each equation needs one.
_MOST_EQUATIONS_MATCHED = 300


def _matched(held: Sequence[Sequence[int]]) -> set[int]:
    """The unknowns of a maximum matching of equations with unknowns they hold, by augmenting paths breadth first."""
    owner: dict[int, int] = {}  # unknown -> the equation spent on it
    for start in range(min(len(held), _MOST_EQUATIONS_MATCHED)):
        reached_from: dict[int, int] = {}  # unknown -> the equation that reached it
        queue = deque([start])
        free: int | None = None
        while queue and free is None:
            equation = queue.popleft()
            for unknown in held[equation]:
                if unknown in reached_from:
                    continue
                reached_from[unknown] = equation
                if unknown not in owner:
                    free = unknown
                    break
                queue.append(owner[unknown])
        _augment(free, start, reached_from, owner)
    return set(owner)


def _augment(free: int | None, start: int, reached_from: dict[int, int], owner: dict[int, int]) -> None:
    """Spend the equations along the path that ends in `free` each on the next unknown."""
    previous = {equation: unknown for unknown, equation in owner.items()}
    while free is not None:
        equation = reached_from[free]
        released = previous.get(equation) if equation != start else None
        owner[free] = equation
        free = released
