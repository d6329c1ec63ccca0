"""Eight interiors, both directions of the wave, seventeen closures: the exact verdict against the slow second way.

The oracle (`tests.oracle.normal_modes`) takes each root of a resultant to z (1 + 1e-15) and looks which spatial roots
are inside there. The closures are as likely to be wrong for the wave as right: extrapolation where it enters, updates
against the wind, rules over three time levels.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import comb

import pytest

from gks.errors import InputError
from gks.modes import Verdict, analyse
from gks.scheme.schemefile import parse_scheme
from tests.oracle.normal_modes import Equation, verdict

Table = dict[str, dict[tuple[int, int], Fraction]]
ONE = Fraction(1)


def interiors(lam: Fraction) -> Table:
    """Coefficients by (offset, level) for u_t = u_x; -lam turns the wave round."""
    half, square = lam / 2, lam * lam
    return {
        "leapfrog": {(0, 1): ONE, (0, -1): -ONE, (1, 0): -lam, (-1, 0): lam},
        "lax-wendroff": {(0, 1): ONE, (0, 0): square - 1, (1, 0): -half - square / 2, (-1, 0): half - square / 2},
        "lax-friedrichs": {(0, 1): 2 * ONE, (1, 0): -1 - lam, (-1, 0): lam - 1},
        "crank-nicolson": {
            (0, 1): ONE, (1, 1): -half / 2, (-1, 1): half / 2, (0, 0): -ONE, (1, 0): -half / 2, (-1, 0): half / 2,
        },
        "backward-euler": {(0, 1): ONE, (1, 1): -half, (-1, 1): half, (0, 0): -ONE},
        "bdf2": {(0, 1): 3 * ONE / 2, (0, 0): -2 * ONE, (0, -1): ONE / 2, (1, 1): -half, (-1, 1): half},
        "du-fort-frankel": {(0, 1): 1 + lam / 3, (0, -1): lam / 3 - 1, (1, 0): -4 * lam / 3, (-1, 0): 2 * lam / 3},
        "leapfrog-4": {
            (0, 1): ONE, (0, -1): -ONE, (2, 0): lam / 6, (1, 0): -4 * lam / 3, (-1, 0): 4 * lam / 3, (-2, 0): -lam / 6,
        },
    }  # fmt: skip


def closures(ghost: int, lam: Fraction) -> Table:
    """Rules for u[ghost], the new level being 1."""
    found: Table = {}
    for order in range(4):
        signs = [Fraction((-1) ** k * comb(order + 1, k)) for k in range(order + 2)]
        found[f"space-{order}"] = {(ghost + k, 1): sign for k, sign in enumerate(signs)}
        found[f"oblique-{order}"] = {(ghost + k, 1 - k): sign for k, sign in enumerate(signs)}
    here, next_to_it = ghost, ghost + 1
    return found | {
        "one-sided": {(here, 1): ONE, (here, 0): lam - 1, (next_to_it, 0): -lam},
        "one-sided-implicit": {(here, 1): 1 + lam, (here, 0): -ONE, (next_to_it, 1): -lam},
        "one-sided, the wrong way": {(here, 1): ONE, (here, 0): -1 - lam, (next_to_it, 0): lam},
        "box": {(here, 1): 1 + lam, (next_to_it, 1): 1 - lam, (here, 0): lam - 1, (next_to_it, 0): -1 - lam},
        "data": {(here, 1): ONE},
        "reflection": {(here, 1): ONE, (next_to_it, 1): ONE},
        "at rest": {(here, 1): ONE, (here, -1): -ONE},
        "mean in space and time": {(here, 1): 2 * ONE, (next_to_it, 1): -ONE, (here, -1): -ONE},
        "late": {(here, 1): ONE, (next_to_it, -2): -ONE},
    }


def text(interior: Equation, closure: Sequence[Equation], ghosts: int, side: str, first: int) -> str:
    """A scheme file with the cells beginning at ``first``, mirrored on the left."""
    sign = 1 if side == "right" else -1

    def terms(equation: Equation, offsets: bool) -> str:
        parts = []
        for (k, level), coefficient in equation.items():
            place = f"i{sign * k:+d}" if offsets else str(sign * (k + first - ghosts))
            if coefficient:
                parts.append(f"({coefficient})*u[{place}, n{level:+d}]".replace(", n+0", ""))
        return " + ".join(parts) + " = 0"

    equations = ", ".join(f'"{terms(each, False)}"' for each in closure)
    return f"""
title = "row of the table"
[parameters]
lam = {{ role = "cfl", default = 1 }}
[domains.R]
side = "{side}"
first = {first}
unknowns = ["u"]
interior = ["{terms(interior, True)}"]
[closure]
equations = [{equations}]
"""


@pytest.mark.parametrize("name", sorted(interiors(ONE)))
@pytest.mark.parametrize(("lam", "side", "first"), [("1/2", "right", 0), ("-1/2", "left", 2), ("3/2", "left", 1)])
def test_every_closure(name: str, lam: str, side: str, first: int) -> None:
    speed = Fraction(lam)
    interior = {place: c for place, c in interiors(speed)[name].items() if c}
    ghosts = -min(offset for offset, _ in interior)
    for rule in closures(0, speed):
        closure = [{place: c for place, c in closures(k, speed)[rule].items() if c} for k in range(ghosts)]
        scheme = parse_scheme(text(interior, closure, ghosts, side, first), rule)
        try:
            found = analyse(scheme, scheme.values({}))
        except InputError:
            continue  # the closure does not give the new level; which is not the oracle's matter
        expected = verdict(interior, closure, ghosts)
        assert found.certified or found.reason == "interior"
        assert found.verdict.value == expected[0], rule
        assert found.reason == expected[1] or not found.solvable, rule


@pytest.mark.parametrize("name", ["leapfrog", "crank-nicolson"])
@pytest.mark.parametrize("lam", ["1/2", "999999999999/1000000000000", "1e-30"])
def test_a_rule_over_many_points_and_levels(name: str, lam: str) -> None:
    """u[0, n+1] = u[9, n-5]: kappa**9 = z**6 holds on the circle alone, where waves of either direction meet it; bounds
    on algebraic numbers alone would ask for 10**5 bits and more."""
    speed = Fraction(lam)
    closure = {(0, 1): ONE, (9, -5): -ONE}
    scheme = parse_scheme(text(interiors(speed)[name], [closure], 1, "right", 1), "deep")
    assert analyse(scheme, scheme.values({})).verdict is Verdict.GENERALIZED
