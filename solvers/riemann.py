"""The exact Riemann solver of an ideal gas, over arrays.

Toro, Riemann Solvers and Numerical Methods for Fluid Dynamics, 3rd ed., chapter 4.

The pressure p between the waves solves f(p) = f_L(p) + f_R(p) + u_R - u_L = 0, where f_K is the change of velocity
across the wave on side K: a shock for p > p_K (Rankine and Hugoniot), a rarefaction otherwise (Riemann's invariant).
f is increasing and concave, so Newton's method climbs to the root monotonely from any point below it, and from above
it lands below after one step. No starting guess can fail and no iterate needs damping, only to be held above a lower
bound of the root: min(p_L, p_R) or max(p_L, p_R), whichever the sign of f there allows. Two rarefactions have a
closed form, vacuum included.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GAMMA = 1.4

CONVERGED = 2.0**-26
"""Newton's error is squared by each step: after a relative step below sqrt(eps) it is below rounding."""

MOST_ITERATIONS = 60
"""A guard, never met: 17 steps are the most seen over 200 000 random states from 1e-10 to 1e10."""


class Gas(NamedTuple):
    """Density, velocity and pressure, arrays of one shape; density and pressure are positive."""

    density: Array
    velocity: Array
    pressure: Array

    def sound_speed(self, gamma: float = GAMMA) -> Array:
        return np.asarray(np.sqrt(gamma * self.pressure / self.density))


class Star(NamedTuple):
    """Pressure and velocity between the two waves; at vacuum, zero and the mean of the vacuum's two edges."""

    pressure: Array
    velocity: Array
    vacuum: NDArray[np.bool_]


def velocity_change(p: Array, gas: Gas, gamma: float = GAMMA) -> tuple[Array, Array]:
    """f_K(p) and its derivative: by how much the wave to pressure p changes the velocity, away from side K."""
    compressed = np.maximum(p, gas.pressure)
    weight = 0.5 * gas.density * ((gamma + 1) * compressed + (gamma - 1) * gas.pressure)
    shock = (p - gas.pressure) / np.sqrt(weight)
    shock_slope = (1 - 0.25 * (gamma + 1) * gas.density * (p - gas.pressure) / weight) / np.sqrt(weight)
    sound = gas.sound_speed(gamma)
    ratio = np.minimum(p, gas.pressure) / gas.pressure
    power = ratio ** ((gamma - 1) / (2 * gamma))
    fan = 2 * sound / (gamma - 1) * (power - 1)
    # p**(-(gamma + 1)/(2 gamma)) is the power above over p; infinite at vacuum.
    acoustic = ratio * gas.density * sound
    fan_slope = np.divide(power, acoustic, out=np.full_like(acoustic, np.inf), where=acoustic > 0)
    shocked = p > gas.pressure
    return np.where(shocked, shock, fan), np.where(shocked, shock_slope, fan_slope)


def star(left: Gas, right: Gas, gamma: float = GAMMA) -> Star:
    """The state between the waves. ArithmeticError where Newton's method does not end (not met)."""
    jump = right.velocity - left.velocity
    closed, vacuum = _between_fans(left, right, jump, gamma)
    two_fans, two_shocks = _both(left, right, jump, gamma)
    bound = np.where(two_shocks, np.maximum(left.pressure, right.pressure), np.minimum(left.pressure, right.pressure))
    impedance = 0.25 * (left.density + right.density) * (left.sound_speed(gamma) + right.sound_speed(gamma))
    acoustic = 0.5 * (left.pressure + right.pressure) - 0.5 * jump * impedance
    bound = np.where(two_fans, closed, bound)
    p = np.where(two_fans, closed, np.maximum(acoustic, bound))
    for _ in range(MOST_ITERATIONS):
        f_left, d_left = velocity_change(p, left, gamma)
        f_right, d_right = velocity_change(p, right, gamma)
        step = np.maximum(p - (f_left + f_right + jump) / (d_left + d_right), bound) - p
        p = p + step
        if (np.abs(step) <= CONVERGED * p).all():
            break
    else:
        raise ArithmeticError(f"no convergence in {MOST_ITERATIONS} steps")
    bent = np.subtract(d_right, d_left, out=np.zeros_like(p), where=~vacuum)  # both are infinite at vacuum
    apart = f_right - f_left + bent * step  # at the new p, as exact as p is
    return Star(p, 0.5 * (left.velocity + right.velocity + apart), vacuum)


def _both(left: Gas, right: Gas, jump: Array, gamma: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether both waves are rarefactions, f(min p) >= 0, and whether both are shocks, f(max p) < 0."""
    swapped = left.pressure > right.pressure
    low = Gas(*(np.where(swapped, b, a) for a, b in zip(left, right, strict=True)))
    high = Gas(*(np.where(swapped, a, b) for a, b in zip(left, right, strict=True)))
    at_low = velocity_change(low.pressure, high, gamma)[0]  # the other side's own change is zero there
    at_high = velocity_change(high.pressure, low, gamma)[0]
    return at_low + jump >= 0, at_high + jump < 0


def _between_fans(left: Gas, right: Gas, jump: Array, gamma: float) -> tuple[Array, NDArray[np.bool_]]:
    """The pressure between two rarefactions, and where they leave a vacuum."""
    power = (gamma - 1) / (2 * gamma)
    sounds = left.sound_speed(gamma), right.sound_speed(gamma)
    reach = sounds[0] + sounds[1] - 0.5 * (gamma - 1) * jump
    scale = sounds[0] / left.pressure**power + sounds[1] / right.pressure**power
    return (np.maximum(reach, 0.0) / scale) ** (1 / power), reach <= 0


def sample(left: Gas, right: Gas, speed: Array, gamma: float = GAMMA) -> Gas:
    """The solution on the ray x/t = speed."""
    between = star(left, right, gamma)
    on_left = speed <= between.velocity
    # The right side is the left one mirrored: velocities and the ray change their signs.
    sign = np.where(on_left, 1.0, -1.0)
    density, velocity, pressure = (np.where(on_left, a, b) for a, b in zip(left, right, strict=True))
    mirrored = Gas(density, sign * velocity, pressure)
    state, on_fan = _left_wave(mirrored, between.pressure, sign * between.velocity, between.vacuum, sign * speed, gamma)
    if on_fan.any():
        inside = _fan(mirrored, sign * speed, gamma)
        state = Gas(*(np.where(on_fan, a, b) for a, b in zip(inside, state, strict=True)))
    return Gas(state.density, sign * state.velocity, state.pressure)


def _left_wave(
    gas: Gas, p: Array, u: Array, vacuum: NDArray[np.bool_], speed: Array, gamma: float
) -> tuple[Gas, NDArray[np.bool_]]:
    """The state on either side of the left wave, at rays left of the contact; and which rays fall within a fan."""
    sound, ratio = gas.sound_speed(gamma), p / gas.pressure
    m = (gamma - 1) / (gamma + 1)
    shocked = ratio > 1
    front = np.where(shocked, gas.velocity - sound * np.sqrt((ratio + m) / (1 + m)), gas.velocity - sound)
    edge = gas.velocity + 2 * sound / (gamma - 1)  # where expansion into vacuum ends
    tail = np.where(vacuum, edge, u - sound * ratio ** ((gamma - 1) / (2 * gamma)))
    density = gas.density * np.where(shocked, (ratio + m) / (m * ratio + 1), ratio ** (1 / gamma))
    ahead = speed <= front
    state = Gas(*(np.where(ahead, a, b) for a, b in zip(gas, (density, u, p), strict=True)))
    return state, ~shocked & ~ahead & (speed < tail)


def _fan(gas: Gas, speed: Array, gamma: float) -> Gas:
    """The state within a left rarefaction: u - c = speed and Riemann's invariant u + 2 c/(gamma - 1) is gas's own."""
    sound = gas.sound_speed(gamma)
    inner = np.maximum((2 * sound + (gamma - 1) * (gas.velocity - speed)) / (gamma + 1), 0.0)
    ratio = inner / sound
    density, pressure = gas.density * ratio ** (2 / (gamma - 1)), gas.pressure * ratio ** (2 * gamma / (gamma - 1))
    return Gas(density, speed + inner, pressure)


def moving_flux(gas: Gas, speed: Array, gamma: float = GAMMA) -> Array:
    """Flux F(U) - speed U through a face that moves: mass, momentum and energy, stacked on the first axis."""
    relative = gas.velocity - speed
    momentum = gas.density * gas.velocity
    energy = gas.pressure / (gamma - 1) + 0.5 * momentum * gas.velocity
    return np.stack(
        [gas.density * relative, momentum * relative + gas.pressure, energy * relative + gas.pressure * gas.velocity]
    )


def conserved(gas: Gas, gamma: float = GAMMA) -> Array:
    """Density, momentum and energy, stacked on the first axis."""
    momentum = gas.density * gas.velocity
    return np.stack([gas.density, momentum, gas.pressure / (gamma - 1) + 0.5 * momentum * gas.velocity])


def primitive(state: Array, gamma: float = GAMMA) -> Gas:
    """The inverse of `conserved`; the pressure may come out negative."""
    density, momentum, energy = state
    velocity = momentum / density
    return Gas(density, velocity, (gamma - 1) * (energy - 0.5 * momentum * velocity))
