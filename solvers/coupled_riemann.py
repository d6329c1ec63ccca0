"""The exact solution of the Riemann problem between an elastic solid (x < 0) and a gas (x > 0).

The solid answers with one acoustic wave to the left, across which -u + sigma/Z is constant (Z = rho_s c_s), the gas
with one shock or rarefaction to the right. With u continuous and sigma = -p at the interface its pressure p solves

    f_R(p) + (p + sigma_s)/Z + u_f - u_s = 0,

increasing and concave like the gas's own equation (`riemann`), so Newton's method climbs to the root from below.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.solvers.riemann import CONVERGED, GAMMA, MOST_ITERATIONS, Gas, sample, velocity_change

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Solid:
    """A linearly elastic solid: density rho_s, wave speed c_s = sqrt(E/rho_s), and its state."""

    density: float
    speed: float = 3.0**0.5
    velocity: float = 1.0
    stress: float = -1.0

    @property
    def impedance(self) -> float:
        return self.density * self.speed

    @property
    def modulus(self) -> float:
        """Young's modulus E = rho_s c_s**2."""
        return self.density * self.speed**2


def gas(density: float = 1.0, velocity: float = 0.0, pressure: float = 1.0) -> Gas:
    """A uniform gas; by default the paper's initial state."""
    return Gas(np.asarray(density), np.asarray(velocity), np.asarray(pressure))


@dataclass(frozen=True, slots=True)
class CoupledRiemann:
    """The solution for one solid and one gas: velocity and pressure at the interface, and profiles over x."""

    solid: Solid
    fluid: Gas
    velocity: float
    pressure: float

    @property
    def star_gas(self) -> Gas:
        """The gas between the interface and its wave."""
        return self._ray(np.asarray(self.velocity))

    def solid_profile(self, label: Array, t: float) -> tuple[Array, Array, Array]:
        """(x, u, sigma) of the solid's points X = label < 0 at time t; x = X + the integral of u."""
        arrival = -label / self.solid.speed
        reached = arrival < t
        after = np.maximum(t - arrival, 0.0)
        x = label + self.solid.velocity * (t - after) + self.velocity * after
        velocity = np.where(reached, self.velocity, self.solid.velocity)
        return x, velocity, np.where(reached, -self.pressure, self.solid.stress)

    def gas_profile(self, x: Array, t: float) -> Gas:
        """The gas at the points x and time t > 0; points left of the interface x = u* t take its state there."""
        return self._ray(np.maximum(x / t, self.velocity))

    def _ray(self, speed: Array) -> Gas:
        """The gas on rays x/t = speed: its collision with its mirror image in the interface drives the same wave."""
        wall = Gas(self.fluid.density, 2 * self.velocity - self.fluid.velocity, self.fluid.pressure)
        everywhere = np.zeros_like(speed)
        mirrored, given = (Gas(*(quantity + everywhere for quantity in state)) for state in (wall, self.fluid))
        return sample(mirrored, given, speed)


def coupled_riemann(solid: Solid, fluid: Gas, gamma: float = GAMMA) -> CoupledRiemann:
    """Solve for the interface. ArithmeticError where the solid outruns the gas, p = 0 (vacuum at the interface)."""
    z = solid.impedance

    def total(p: Array) -> tuple[Array, Array]:
        f, slope = velocity_change(p, fluid, gamma)
        return f + (p + solid.stress) / z + fluid.velocity - solid.velocity, slope + 1 / z

    p = np.asarray(fluid.pressure, dtype=float)
    f, slope = total(p)
    if f > 0:  # the root is below the gas's pressure
        p = np.asarray(np.maximum(p - f / slope, np.finfo(float).tiny * p))
    for _ in range(MOST_ITERATIONS):
        f, slope = total(p)
        new = p - f / slope
        if not new > 0:
            raise ArithmeticError("the interface pressure falls to zero: a vacuum opens between solid and gas")
        moved, p = abs(new - p) / new, new
        if moved <= CONVERGED:
            break
    velocity = float(fluid.velocity + velocity_change(p, fluid, gamma)[0])
    return CoupledRiemann(solid, fluid, velocity, float(p))
