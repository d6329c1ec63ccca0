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

from gks.catalogue.interfaces import UNIT, UPWIND, closure_lines, ghost_equations, own_value, two_media

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

    named = UPWIND if interior == "upwind1" else f'scheme = "{interior}"'
    name = f"{condition.name}-{order}-{interior}"
    ghosts = ghost_equations(order, INTERIORS[interior], ("u_I_L", "s_I"), ("u_I_R", "s_I"))
    closure = closure_lines(ghosts, _interface_values(condition, order))
    text = two_media(name, _PARAMETERS, named, closure, (UNIT, ("-1/alpha", "-alpha*c**2")))
    return parse_scheme(text + _ADMITTANCES, name)


_PARAMETERS = """\
lam   = { role = "cfl", default = 0.9, doc = "c_L dt/dx" }
alpha = { default = 1, doc = "rho_R/rho_L" }
c     = { default = 1, doc = "c_R/c_L" }"""

_ADMITTANCES = """
[definitions]
e_L = "1"
e_R = "1/(c*alpha)"
"""


def _interface_values(condition: Condition, order: int) -> dict[str, str]:
    """Each side's own values at the interface, and the condition's means of them."""
    values = {f"{unknown}_{side}": own_value(side, unknown, order) for unknown in "us" for side in "LR"}
    velocity = _mean("u", condition.velocity)
    left, stress = _mean("u", condition.left_ghost or condition.velocity), _mean("s", condition.stress)
    if condition.crossed:
        velocity = left = f"{velocity} + e_L*e_R*(s_R - s_L)/(e_L + e_R)"
        stress = f"{stress} + (u_R - u_L)/(e_L + e_R)"
    return values | {"u_I_L": left, "u_I_R": velocity, "s_I": stress}


def _mean(unknown: str, share: str) -> str:
    return f"({share})*{unknown}_L + (1 - {share})*{unknown}_R"
