"""Other ways to write a scheme: each is a scheme file of its own, and the same scheme."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import cycle

from tests.strategies import Draft, Equation


def scaled(draft: Draft, factors: Sequence[str]) -> Draft:
    """Every equation times one of the factors in turn."""

    def times(equations: tuple[Equation, ...]) -> tuple[Equation, ...]:
        return tuple(
            tuple(replace(t, coefficient=f"({t.coefficient})*{factor}") for t in equation)
            for equation, factor in zip(equations, cycle(factors), strict=False)
        )

    lines = tuple(replace(line, interior=times(line.interior)) for line in draft.lines)
    return replace(draft, lines=lines, closure=times(draft.closure))


def renamed(draft: Draft) -> Draft:
    """The names chosen are those of the analyser's own variables."""
    names = {"u": "kappa", "s": "z", "L": "x", "R": "k0"}
    changed = draft.on_terms(
        lambda t: replace(
            t, unknown=names[t.unknown], domain=names[t.domain], coefficient=t.coefficient.replace("lam", "q0")
        )
    )
    lines = tuple(
        replace(line, name=names[line.name], unknowns=tuple(names[u] for u in line.unknowns)) for line in changed.lines
    )
    return replace(changed, lines=lines, cfl="q0")


def mirrored(draft: Draft) -> Draft:
    """x -> -x: sides swap, indices and fluxes change sign."""
    turned = draft.on_terms(lambda t: replace(t, index=-t.index))
    sides = {"left": "right", "right": "left"}
    lines = tuple(
        replace(line, side=sides[line.side], flux=tuple(tuple(f"-({a})" for a in row) for row in line.flux))
        for line in turned.lines
    )
    return replace(turned, lines=lines)


def reordered(draft: Draft) -> Draft:
    """Domains and closure equations from the last to the first."""
    return replace(draft, lines=draft.lines[::-1], closure=draft.closure[::-1])


def moved(draft: Draft, by: int) -> Draft:
    """`first` and every absolute index move together; offsets in interiors stay."""
    move = {line.name: by if line.side == "right" else -by for line in draft.lines}
    closure = tuple(tuple(replace(t, index=t.index + move[t.domain]) for t in equation) for equation in draft.closure)
    lines = tuple(replace(line, first=line.first + by) for line in draft.lines)
    return replace(draft, lines=lines, closure=closure)
