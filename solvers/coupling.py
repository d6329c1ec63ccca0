"""The interface conditions of two half-lines: as arithmetic for a solver, and as a scheme file for the analyser.

One `Condition` serves the acoustic problem of Section 3 of Banks & Sjögreen and the fluid/solid problem of its
Section 2: both take an interface velocity and an interface stress as weighted means of the two sides. e_L, e_R are
the sides' admittances, 1/(rho c). The left half-line is the solid where there is one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from gks.scheme.model import Scheme

Array = NDArray[np.float64]

SHARES: Mapping[str, Callable[[Array, Array], Array]] = {
    "0": lambda e_left, e_right: 0.0 * e_left,
    "1": lambda e_left, e_right: 0.0 * e_left + 1.0,
    "1/2": lambda e_left, e_right: 0.0 * e_left + 0.5,
    "e_L/(e_L + e_R)": lambda e_left, e_right: e_left / (e_left + e_right),
    "e_R/(e_L + e_R)": lambda e_left, e_right: e_right / (e_left + e_right),
}
"""The shares of the left side that conditions use, each by the formula that a scheme file has for it."""


class Values(NamedTuple):
    """What the ghost cells take: one stress, and a velocity for each side's ghost."""

    left_velocity: Array
    right_velocity: Array
    stress: Array


@dataclass(frozen=True, slots=True)
class Condition:
    """u_I = w u_L + (1 - w) u_R, s_I = v s_L + (1 - v) s_R, with w = `velocity` and v = `stress`, keys of `SHARES`.

    left_ghost : the share w in the velocity of the left side's ghost, where it is not the right side's ("" elsewhere).
    crossed : the terms e_L e_R (s_R - s_L)/(e_L + e_R) and (u_R - u_L)/(e_L + e_R) are added: (3.17) and (3.18).
    """

    name: str
    source: str
    velocity: str
    stress: str
    left_ghost: str = ""
    crossed: bool = False

    def values(self, e_left: Array, e_right: Array, left: tuple[Array, Array], right: tuple[Array, Array]) -> Values:
        """The interface values from (velocity, stress) next to the interface on either side."""
        (u_left, s_left), (u_right, s_right) = left, right
        v = SHARES[self.stress](e_left, e_right)
        stress = v * s_left + (1 - v) * s_right
        w = SHARES[self.velocity](e_left, e_right)
        velocity = w * u_left + (1 - w) * u_right
        if self.crossed:
            stress = stress + (u_right - u_left) / (e_left + e_right)
            velocity = velocity + e_left * e_right * (s_right - s_left) / (e_left + e_right)
        if not self.left_ghost:
            return Values(velocity, velocity, stress)
        w = SHARES[self.left_ghost](e_left, e_right)
        return Values(w * u_left + (1 - w) * u_right, velocity, stress)


_VELOCITY, _STRESS = "e_R/(e_L + e_R)", "e_L/(e_L + e_R)"

TRADITIONAL = Condition("traditional", "(2.4), (3.6), (3.23): velocity of the left, stress of the right", "1", "0")
MIRROR = Condition("mirror", "(2.3): stress of the left, velocity of the right", "0", "1")
AVERAGE = Condition("average", "(2.5): the mean of both", "1/2", "1/2")
WEIGHTED = Condition("weighted", "(3.19), (3.30), (4.3): weighted by impedance", _VELOCITY, _STRESS)
CHARACTERISTIC = Condition("characteristic", "(3.17), (3.18): the Riemann problem's", _VELOCITY, _STRESS, crossed=True)

CONDITIONS: Mapping[str, Condition] = {
    each.name: each for each in (TRADITIONAL, MIRROR, AVERAGE, WEIGHTED, CHARACTERISTIC)
}

INTERIORS: Mapping[str, int] = {"upwind1": 1, "lax-wendroff": 1, "beam-warming": 2, "fromm": 2}
"""Interior schemes by name, with the ghost cells that each reads; upwind1 is advanced by forward Euler."""


def coupling_scheme(condition: Condition, order: int = 1, interior: str = "upwind1") -> Scheme:
    """The scheme file of two acoustic half-lines under the condition; rho_L = c_L = 1.

    Its parameters: lam = c_L dt/dx, alpha = rho_R/rho_L, c = c_R/c_L. At order 1 the ghost cells take the interface
    values, (3.2); at order 2 they mirror in the interface values extrapolated from two cells a side, (3.22).
    """
    from gks.scheme.schemefile import parse_scheme

    named = 'space = "upwind1"\ntime = "forward-euler"' if interior == "upwind1" else f'scheme = "{interior}"'
    name = f"{condition.name}-{order}-{interior}"
    return parse_scheme(_TEXT.format(name=name, interior=named, closure=_closure(condition, order, interior)), name)


_TEXT = """
title = "{name}"
[parameters]
lam   = {{ role = "cfl", default = 0.9, doc = "c_L dt/dx" }}
alpha = {{ default = 1, doc = "rho_R/rho_L" }}
c     = {{ default = 1, doc = "c_R/c_L" }}
[definitions]
e_L = "1"
e_R = "1/(c*alpha)"
[interior]
{interior}
[domains.L]
side = "left"
unknowns = ["u", "s"]
flux = [["0", "-1"], ["-1", "0"]]
[domains.R]
side = "right"
unknowns = ["u", "s"]
flux = [["0", "-1/alpha"], ["-alpha*c**2", "0"]]
[closure]
{closure}
"""


def _closure(condition: Condition, order: int, interior: str) -> str:
    """The `[closure]` table: each side's own interface values, the condition's means of them, and the ghost values."""
    lines = []
    for unknown in "us":
        for side, inner in (("L", -1), ("R", 1)):
            near = f"{side}.{unknown}[0]"
            own = near if order == 1 else f"3/2*{near} - 1/2*{side}.{unknown}[{inner}]"
            lines.append(f'let.{unknown}_{side} = "{own}"')
    velocity = _mean("u", condition.velocity)
    left, stress = _mean("u", condition.left_ghost or condition.velocity), _mean("s", condition.stress)
    if condition.crossed:
        velocity = left = f"{velocity} + e_L*e_R*(s_R - s_L)/(e_L + e_R)"
        stress = f"{stress} + (u_R - u_L)/(e_L + e_R)"
    lines += [f'let.u_I_L = "{left}"', f'let.u_I_R = "{velocity}"', f'let.s_I = "{stress}"']
    equations = []
    for ghost in range(1, INTERIORS[interior] + 1):
        for side, sign in (("L", 1), ("R", -1)):
            for unknown, value in (("u", f"u_I_{side}"), ("s", "s_I")):
                mirrored = f"2*{value} - {side}.{unknown}[{sign * (1 - ghost)}]"
                equations.append(f'"{side}.{unknown}[{sign * ghost}] = {value if order == 1 else mirrored}"')
    return "\n".join([*lines, f"equations = [{', '.join(equations)}]"])


def _mean(unknown: str, share: str) -> str:
    return f"({share})*{unknown}_L + (1 - {share})*{unknown}_R"
