"""Section 2 of Banks & Sjögreen: a gas in the frame of its interface with an elastic solid, by Godunov's scheme.

    gas,   X > 0:  U_t + (F(U) - s U)_X = 0,  U = (rho, rho u, e),  s = dx_I/dt;
    solid, X < 0:  u_t = sigma_X/rho_s,  sigma_t = E u_X.

N cells of width 1/N a side. The two ghost cells take the velocity and stress of an interface condition (`coupling`)
from the cells next to the interface at level n, and both sides advance together. Runs of any densities and conditions
march as one batch: arrays (runs, cells), each run with its own time step. A run that has ended leaves the batch.

How the text was read, and what else it could have meant (Table 1 at CFL 0.9: entries of 18 that agree; see
`table1.departures`):

- (2.4a) prints u_0^(f) for the solid's ghost. Then (2.5) would not be the average of (2.3) and (2.4), and rho_s =
  0.125 comes out stable: 17 of 18. Here the solid's ghost takes the solid's velocity.
- (4.3a) prints the velocity weights of its stress, (3.19) has them crosswise. As printed it is stable too, but the
  interface takes its velocity from the lighter side: at rho_s = 1e-6 it is 40 times too fast at t = 1.1. Here the
  weights are (3.19)'s.
- (4.3) names rho_1, p_1 for the admittance of the gas, whose first cell is 0. Cell 0 is meant; cell 1 gives the same
  verdicts.
- The ghost density is cell 0's, as printed. s is the ghost's velocity; the solid's own velocity gives the same 18
  entries.
- A face of the gas moves, so its Riemann problem is sampled on the ray x/t = s.
- No final time is given for Table 1. At 0.4, that of Figure 2, (2.5) at rho_s = 0.04 still rings (it decays by 0.97 a
  step): 17 of 18. Here t = 1.1.
- "The computation is stopped when p becomes negative" is no criterion for light solids, whose instability saturates:
  alone it finds 14 of 18. Here a run is unstable, too, if solid and gas differ by more than 1e-2 in velocity during
  its last fifth.
- The text's grid has both N - 1 and N + 1 points on a unit length; dx = 1/(N - 1) in place of 1/N changes no entry.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from gks.solvers.coupled_riemann import Solid, gas
from gks.solvers.coupling import Condition
from gks.solvers.riemann import Gas, conserved, moving_flux, primitive, sample

Array = NDArray[np.float64]

CELLS = 100
CFL = 0.9
END = 1.1

JUMP = 1e-2
"""A velocity jump that is no remnant of the start: Table 1's stable runs have 4e-3 or less, unstable ones above 1."""

LAST_PART = 0.2

PATIENCE = 20
"""A run may take as many times the steps that the solid's own speed asks for; the wildest of Table 1 takes 5 times."""


class Cause(Enum):
    """Why a run is called stable or unstable."""

    SETTLED = "settled"
    NEGATIVE_PRESSURE = "negative pressure"
    VELOCITY_JUMP = "velocity jump"
    TIME_STEP = "time step collapsed"


@dataclass(frozen=True, slots=True)
class Run:
    """One run: condition, solid, gas (uniform states), and a wave speed that limits dt besides those on the grid."""

    condition: Condition
    solid: Solid
    fluid: Gas = field(default_factory=gas)
    fastest: float = 0.0


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended: time, steps, largest velocity jump in the last fifth, the interface's last velocity."""

    run: Run
    cause: Cause
    time: float
    steps: int
    jump: float
    interface_velocity: float

    @property
    def stable(self) -> bool:
        return self.cause is Cause.SETTLED


class Coupled:
    """The state of a batch of runs and its advance by one step.

    velocity, stress : the solid, (runs, cells), the interface at the last cell; fluid : conserved, (3, runs, cells),
    at the first. position : x of the cell centres, (runs, 2 cells): the solid's move with their own velocity, the
    gas's with s.
    """

    def __init__(self, runs: Sequence[Run], cells: int = CELLS, cfl: float = CFL) -> None:
        shape = (len(runs), cells)
        self.runs, self.cells, self.cfl, self.dx = list(runs), cells, cfl, 1.0 / cells
        self.impedance = np.array([[run.solid.impedance] for run in runs])
        self.solid_speed = np.array([run.solid.speed for run in runs])
        self.fastest = np.array([run.fastest for run in runs])
        self.velocity = np.ones(shape) * np.array([[run.solid.velocity] for run in runs])
        self.stress = np.ones(shape) * np.array([[run.solid.stress] for run in runs])
        states = [np.ones(shape) * np.array([[float(run.fluid[k])] for run in runs]) for k in range(3)]
        self.fluid = conserved(Gas(*states))
        self.position = np.tile(self.dx * (np.arange(-cells, cells) + 0.5), (len(runs), 1))
        self.time, self.steps = np.zeros(len(runs)), 0
        self.interface_velocity = np.zeros(len(runs))

    def keep(self, wanted: NDArray[np.bool_]) -> None:
        """Drop the other runs from the batch."""
        self.runs = [run for run, stays in zip(self.runs, wanted, strict=True) if stays]
        for name in (
            "impedance",
            "solid_speed",
            "fastest",
            "velocity",
            "stress",
            "position",
            "time",
            "interface_velocity",
        ):
            setattr(self, name, getattr(self, name)[wanted])
        self.fluid = self.fluid[:, wanted]

    def jump(self) -> Array:
        """The solid's velocity minus the gas's, in the cells next to the interface."""
        return np.asarray(self.velocity[:, -1] - self.fluid[1, :, 0] / self.fluid[0, :, 0])

    def step(self, end: float) -> NDArray[np.bool_]:
        """Advance every run by its dt, or to `end`; True where pressures stay positive, the others are unchanged."""
        now = primitive(self.fluid)
        solid_ghost, s, stress = self._interface(now)
        sound = now.sound_speed()
        speeds = np.maximum(
            np.maximum(self.solid_speed, self.fastest), (np.abs(now.velocity - s[:, None]) + sound).max(axis=1)
        )
        dt = np.minimum(self.cfl * self.dx / speeds, end - self.time)
        good = stress < 0  # without pressure in the ghost there is no Riemann problem
        pressure = np.where(good, -stress, 1.0)
        fluid = self._gas_advanced(now, s, pressure, dt)
        velocity, stresses = self._solid_advanced(solid_ghost, stress, dt)
        new = primitive(fluid)
        good &= (new.pressure > 0).all(axis=1) & (new.density > 0).all(axis=1)
        good &= np.isfinite(velocity).all(axis=1) & np.isfinite(stresses).all(axis=1)
        chosen = good[:, None]
        moves = np.concatenate([self.velocity, np.broadcast_to(s[:, None], self.velocity.shape)], axis=1)
        self.position = self.position + np.where(chosen, dt[:, None] * moves, 0.0)
        self.fluid = np.where(chosen, fluid, self.fluid)
        self.velocity, self.stress = np.where(chosen, velocity, self.velocity), np.where(chosen, stresses, self.stress)
        self.interface_velocity = np.where(good, s, self.interface_velocity)
        self.time, self.steps = self.time + np.where(good, dt, 0.0), self.steps + 1
        return good

    def _interface(self, now: Gas) -> tuple[Array, Array, Array]:
        """(velocity of the solid's ghost, of the gas's ghost, stress of both), shapes (runs,)."""
        first = Gas(*(quantity[:, 0] for quantity in now))
        e_solid, e_gas = 1.0 / self.impedance[:, 0], 1.0 / (first.density * first.sound_speed())
        left, right = (self.velocity[:, -1], self.stress[:, -1]), (first.velocity, -first.pressure)
        found = np.empty((3, len(self.runs)))
        for condition in dict.fromkeys(run.condition for run in self.runs):
            rows = np.array([run.condition is condition for run in self.runs])
            found[:, rows] = np.stack(condition.values(e_solid, e_gas, left, right))[:, rows]
        return found[0], found[1], found[2]

    def _gas_advanced(self, now: Gas, s: Array, pressure: Array, dt: Array) -> Array:
        ghosts = Gas(now.density[:, 0], s, pressure)
        padded = Gas(*(np.concatenate([g[:, None], q, q[:, -1:]], axis=1) for g, q in zip(ghosts, now, strict=True)))
        left, right = Gas(*(q[:, :-1] for q in padded)), Gas(*(q[:, 1:] for q in padded))
        faces = sample(left, right, np.broadcast_to(s[:, None], left.density.shape))
        return self.fluid - (dt / self.dx)[:, None] * np.diff(moving_flux(faces, s[:, None]), axis=2)

    def _solid_advanced(self, ghost_velocity: Array, ghost_stress: Array, dt: Array) -> tuple[Array, Array]:
        """Godunov's scheme of a linear system is upwinding: a face takes a from its right and b from its left."""
        u = np.concatenate([self.velocity[:, :1], self.velocity, ghost_velocity[:, None]], axis=1)
        sigma = np.concatenate([self.stress[:, :1], self.stress, ghost_stress[:, None]], axis=1)
        z = self.impedance
        face_velocity = 0.5 * (u[:, :-1] + u[:, 1:]) + 0.5 * np.diff(sigma, axis=1) / z
        face_stress = 0.5 * (sigma[:, :-1] + sigma[:, 1:]) + 0.5 * z * np.diff(u, axis=1)
        courant = (dt * self.solid_speed / self.dx)[:, None]  # dt/(rho_s dx) = courant/Z, E dt/dx = courant Z
        return self.velocity + courant / z * np.diff(face_stress), self.stress + courant * z * np.diff(face_velocity)


def march(
    runs: Sequence[Run],
    end: float = END,
    cells: int = CELLS,
    cfl: float = CFL,
    watch: Callable[[Coupled], None] | None = None,
) -> list[Outcome]:
    """March all runs to `end` and say how each ended; `watch` sees the batch after every step."""
    batch = Coupled(runs, cells, cfl)
    outcomes: dict[int, Outcome] = {}
    numbers, jumps = np.arange(len(runs)), np.zeros(len(runs))
    most = int(PATIENCE * end * cells * max(run.solid.speed for run in runs) / cfl) + 1
    while len(numbers):
        # A run that blows up overflows in the step that is then discarded.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            good = batch.step(end)
        if watch is not None:
            watch(batch)
        late = batch.time >= (1 - LAST_PART) * end
        jumps = np.maximum(jumps, np.where(late, np.abs(batch.jump()), 0.0))
        ended = ~good | (batch.time >= end) | (batch.steps >= most)
        for row in np.flatnonzero(ended):
            outcomes[int(numbers[row])] = _outcome(batch, int(row), bool(good[row]), float(jumps[row]), end)
        if ended.any():
            batch.keep(~ended)
            numbers, jumps = numbers[~ended], jumps[~ended]
    return [outcomes[number] for number in range(len(runs))]


def _outcome(batch: Coupled, row: int, good: bool, jump: float, end: float) -> Outcome:
    time = float(batch.time[row])
    if not good:
        cause = Cause.NEGATIVE_PRESSURE
    elif time < end:
        cause = Cause.TIME_STEP
    else:
        cause = Cause.VELOCITY_JUMP if jump > JUMP else Cause.SETTLED
    return Outcome(batch.runs[row], cause, time, batch.steps, jump, float(batch.interface_velocity[row]))


@dataclass(frozen=True, slots=True)
class Profile:
    """(x, u, sigma) of both sides at one time, x the physical coordinate, sigma = -p in the gas; shapes (cells,)."""

    time: float
    solid: tuple[Array, Array, Array]
    gas: tuple[Array, Array, Array]


def profile(run: Run, end: float, cells: int = CELLS, cfl: float = CFL) -> Profile:
    """The numerical solution of one run at time `end`. ArithmeticError where it does not get there."""
    batch = Coupled([run], cells, cfl)
    while batch.time[0] < end:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            if not batch.step(end)[0]:
                raise ArithmeticError(f"the pressure turns negative at t = {batch.time[0]:.6g}")
    now = primitive(batch.fluid)
    x = batch.position[0]
    solid = (x[:cells], batch.velocity[0], batch.stress[0])
    return Profile(float(batch.time[0]), solid, (x[cells:], now.velocity[0], -now.pressure[0]))
