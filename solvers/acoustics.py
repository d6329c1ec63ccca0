"""The linear solver of Section 4 of Banks & Sjögreen: two acoustic lines of finite length under an interface condition.

It marches the characteristic variables (see `waves`), in which the interior schemes are scalar: `toward`, the field
that runs to the interface (b on the left, a on the right), and `away`, the one that leaves it (a on the left, b on
the right). Each is stored with its index growing along its motion, so all four rows take one and the same stencil.

Grid: cell centres at distances dx/2, 3 dx/2, ... from the interface, cells + 1 on each side of unit length as in the
text. Far ends: nothing comes in, what goes out is extrapolated from the last cell ("first order characteristic").

The interior schemes are the named ones of scheme files. The text calls its "fully second order" scheme a "second
order upwind discretization"; of the two candidates that are stable at CFL 0.9, Fromm's reproduces what it prints (a
rate of 1.99 over the last doubling, 1e-59 left at t = 5 where the text has about 1e-60), Beam and Warming's does not
(2.00, 1e-72).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.scheme.operators import DISCRETE_SCHEMES
from gks.solvers.coupling import INTERIORS, Condition
from gks.solvers.waves import Interface

Array = NDArray[np.float64]

GHOSTS = 2
"""Ghost cells kept at either end: as many as the widest stencil reads."""

CEILING = 1e150
"""A march whose values pass this has blown up: the next products would leave the range of doubles."""

SIGN = np.array([1.0, -1.0])
"""u = c SIGN (away - toward): a - b on the left, where a leaves the interface, and on the right, where b does."""


@dataclass(frozen=True, slots=True)
class Setting:
    """What is marched: media and pulse, condition and its order, interior scheme, CFL number max(c) dt/dx, 1/dx."""

    interface: Interface
    condition: Condition
    order: int = 1
    interior: str = "upwind1"
    cfl: float = 0.9
    cells: int = 50

    @property
    def dx(self) -> float:
        return 1.0 / self.cells

    @property
    def dt(self) -> float:
        return self.cfl * self.dx / max(self.interface.left.speed, self.interface.right.speed)


@dataclass(frozen=True, slots=True)
class History:
    """Largest errors over all cells after each step: shapes (steps + 1,), of velocity and of stress.

    complete : False where the march blew up (see CEILING); the history ends there.
    """

    setting: Setting
    times: Array
    velocity_error: Array
    stress_error: Array
    complete: bool


class Acoustics:
    """The state of a march and its advance by one step."""

    def __init__(self, setting: Setting) -> None:
        media = (setting.interface.left, setting.interface.right)
        self.setting, self.steps = setting, 0
        self.speed = np.array([medium.speed for medium in media])
        self.modulus = np.array([medium.modulus for medium in media])
        self.admittance = np.array([1.0 / medium.impedance for medium in media])
        self.distance: Array = setting.dx * (np.arange(setting.cells + 1, dtype=np.float64) + 0.5)
        self.stencil = _stencil(setting.interior, self.speed * setting.dt / setting.dx)
        self.toward, self.away = self.exact_characteristics()

    @property
    def time(self) -> float:
        return self.steps * self.setting.dt

    def exact_characteristics(self) -> tuple[Array, Array]:
        """The exact (toward, away) at the present time, in the state's own layout."""
        interface, x = self.setting.interface, self.distance
        a_left, b_left = interface.left_characteristics(-x, self.time)
        a_right, b_right = interface.right_characteristics(x, self.time)
        return np.stack([b_left[::-1], a_right[::-1]]), np.stack([a_left, b_right])

    def errors(self) -> tuple[float, float]:
        """The largest errors of velocity and stress over all cells."""
        toward, away = self.exact_characteristics()
        off_toward, off_away = (self.toward - toward)[:, ::-1], self.away - away
        velocity, stress = self.physical(off_toward, off_away)
        return float(np.abs(velocity).max()), float(np.abs(stress).max())

    def step(self) -> None:
        """Advance by dt: ghost values from the condition, then one stencil for all fields."""
        toward_ghosts, away_ghosts = self._ghosts()
        ends = np.zeros((2, GHOSTS))
        toward = np.concatenate([ends, self.toward, toward_ghosts], axis=1)
        away = np.concatenate([away_ghosts[:, ::-1], self.away, ends + self.away[:, -1:]], axis=1)
        self.toward, self.away = self._advanced(toward), self._advanced(away)
        self.steps += 1

    def _advanced(self, field: Array) -> Array:
        length = field.shape[1] - 2 * GHOSTS
        new = np.zeros((2, length))
        for offset, weight in self.stencil:
            new += weight * field[:, GHOSTS + offset : GHOSTS + offset + length]
        return new

    def physical(self, toward: Array, away: Array) -> tuple[Array, Array]:
        """(u, sigma) of both sides from fields indexed by the distance from the interface."""
        velocity = (SIGN * self.speed)[:, None] * (away - toward)
        return velocity, self.modulus[:, None] * (away + toward)

    def _ghosts(self) -> tuple[Array, Array]:
        """(toward, away) in the ghost cells, nearest to the interface first: (3.2) at order 1, (3.22) at order 2."""
        near = self.physical(self.toward[:, : -GHOSTS - 1 : -1], self.away[:, :GHOSTS])
        if self.setting.order == 1:
            own_velocity, own_stress = (values[:, 0] for values in near)
        else:
            own_velocity, own_stress = (1.5 * values[:, 0] - 0.5 * values[:, 1] for values in near)
        left, right = ((own_velocity[side : side + 1], own_stress[side : side + 1]) for side in (0, 1))
        value = self.setting.condition.values(self.admittance[:1], self.admittance[1:], left, right)
        velocity = np.stack([value.left_velocity, value.right_velocity])
        stress = np.stack([value.stress, value.stress])
        if self.setting.order == 2:
            velocity, stress = 2 * velocity - near[0], 2 * stress - near[1]
        ghosts = np.broadcast_to(velocity, (2, GHOSTS)) * (SIGN / self.speed)[:, None], stress / self.modulus[:, None]
        return (ghosts[1] - ghosts[0]) / 2, (ghosts[1] + ghosts[0]) / 2


def march(setting: Setting, end: float) -> History:
    """March to the step nearest to the time `end`, with the errors after every step."""
    solver = Acoustics(setting)
    count = round(end / setting.dt)
    found = [solver.errors()]
    while solver.steps < count and max(found[-1]) < CEILING:
        solver.step()
        found.append(solver.errors())
    velocity, stress = np.array(found, dtype=np.float64).T
    times: Array = setting.dt * np.arange(len(found), dtype=np.float64)
    return History(setting, times, velocity, stress, solver.steps == count)


def final_error(setting: Setting, end: float) -> float:
    """The largest velocity error at the step nearest to the time `end`; the steps between are not compared."""
    solver = Acoustics(setting)
    for _ in range(round(end / setting.dt)):
        solver.step()
    return solver.errors()[0]


def _stencil(interior: str, nu: Array) -> list[tuple[int, Array]]:
    """[(offset, weight)] of a field whose index grows along its motion; weights of shape (2, 1) at the sides' nu."""
    if interior not in INTERIORS:
        raise ValueError(f"no interior scheme {interior!r} here: {', '.join(INTERIORS)}")
    if interior == "upwind1":
        return [(-1, nu[:, None]), (0, 1.0 - nu[:, None])]
    table = DISCRETE_SCHEMES[interior].coefficients
    stencil: list[tuple[int, Array]] = []
    for offset, row in table.items():
        weight = np.zeros((len(nu), 1))
        for coefficient in reversed(row):  # Horner, in nu
            weight = weight * nu[:, None] + float(coefficient)
        stencil.append((offset, weight))
    return stencil
