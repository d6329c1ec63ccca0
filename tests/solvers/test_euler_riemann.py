"""The exact Riemann solver of a gas: Toro's problems, the jump conditions, symmetries, vacuum."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

from gks.solvers.riemann import GAMMA, Gas, conserved, moving_flux, primitive, sample, star, velocity_change

Array = NDArray[np.float64]

POWER = st.floats(-8, 8).map(lambda power: 10.0**power)
MACH = st.floats(-50, 50)


def gas(density: float, velocity: float, pressure: float) -> Gas:
    return Gas(np.array([density]), np.array([velocity]), np.array([pressure]))


def pair(densities: tuple[float, float], pressures: tuple[float, float], mach: float) -> tuple[Gas, Gas]:
    """Two gases that meet with a speed of `mach` times the larger of their speeds of sound."""
    left, right = (gas(rho, 0.0, p) for rho, p in zip(densities, pressures, strict=True))
    speed = mach * max(float(side.sound_speed()[0]) for side in (left, right))
    return left._replace(velocity=np.array([speed])), right


PAIR = st.builds(pair, st.tuples(POWER, POWER), st.tuples(POWER, POWER), MACH)

TORO = [
    ((1.0, 0.0, 1.0), (0.125, 0.0, 0.1), 0.30313, 0.92745),
    ((1.0, -2.0, 0.4), (1.0, 2.0, 0.4), 0.00189, 0.0),
    ((1.0, 0.0, 1000.0), (1.0, 0.0, 0.01), 460.894, 19.5975),
    ((1.0, 0.0, 0.01), (1.0, 0.0, 100.0), 46.0950, -6.19633),
    ((5.99924, 19.5975, 460.894), (5.99242, -6.19633, 46.0950), 1691.64, 8.68975),
]
"""Left, right, p*, u*: Toro, Tables 4.1 and 4.2."""


@pytest.mark.parametrize(("left", "right", "pressure", "velocity"), TORO)
def test_toro(left: tuple[float, ...], right: tuple[float, ...], pressure: float, velocity: float) -> None:
    found = star(gas(*left), gas(*right))
    assert found.pressure[0] == pytest.approx(pressure, rel=1e-5, abs=5e-6)
    assert found.velocity[0] == pytest.approx(velocity, rel=1e-5, abs=5e-6)
    assert not found.vacuum[0]


@given(PAIR)
def test_the_waves_meet_at_one_pressure_and_velocity(sides: tuple[Gas, Gas]) -> None:
    left, right = sides
    found = star(left, right)
    assume(not found.vacuum[0])
    (f_left, d_left), (f_right, d_right) = (velocity_change(found.pressure, side) for side in sides)
    off = (f_left + f_right + right.velocity - left.velocity) / (d_left + d_right)
    # Velocities are as exact as the largest of them, and as the pressure's last digit allows.
    largest = np.maximum(np.abs(left.velocity), np.maximum(np.abs(f_left), np.abs(f_right)))
    inexact = 1e-14 * (largest + (d_left + d_right) * found.pressure)
    assert np.abs(off)[0] <= (inexact / (d_left + d_right))[0]
    assert found.velocity[0] == pytest.approx((left.velocity - f_left)[0], abs=inexact[0])


@given(PAIR)
def test_shocks_obey_rankine_and_hugoniot(sides: tuple[Gas, Gas]) -> None:
    """Seen from the shock itself the flux is the same on both sides."""
    left, right = sides
    found = star(left, right)
    assume(float(found.pressure[0]) > 1.01 * float(right.pressure[0]))
    behind = sample(left, right, found.velocity * (1 + 1e-12) + 1e-12 * right.sound_speed())
    mass = behind.density * right.density * (behind.velocity - right.velocity) / (behind.density - right.density)
    shock = right.velocity + mass / right.density
    flux_behind, flux_ahead = moving_flux(behind, shock), moving_flux(right, shock)
    sizes = [moving_flux(side._replace(velocity=np.abs(side.velocity)), -np.abs(shock)) for side in (behind, right)]
    assert (np.abs(flux_behind - flux_ahead) <= 1e-9 * (sizes[0] + sizes[1])).all()


@given(st.tuples(POWER, POWER), POWER, st.floats(0.1, 4.9))
def test_a_fan_keeps_entropy_and_riemanns_invariant(
    densities: tuple[float, float], pressure: float, mach: float
) -> None:
    left = gas(densities[0], 0.0, pressure)
    sound = float(left.sound_speed()[0])
    right = gas(densities[0], mach * sound, pressure)
    inside = sample(left, right, np.array([-0.9 * sound]))
    assert inside.pressure[0] / inside.density[0] ** GAMMA == pytest.approx(pressure / densities[0] ** GAMMA, rel=1e-9)
    invariant = inside.velocity + 2 * inside.sound_speed() / (GAMMA - 1)
    assert invariant[0] == pytest.approx(2 * sound / (GAMMA - 1), rel=1e-12)
    # Either the ray is one of the fan's, u - c = x/t, or the fan has ended at the mean velocity.
    on_ray = inside.velocity[0] - inside.sound_speed()[0] == pytest.approx(-0.9 * sound, rel=1e-12)
    assert on_ray or inside.velocity[0] == pytest.approx(mach * sound / 2)


@given(PAIR, st.floats(-5, 5))
def test_a_mirror_image_has_the_mirrored_solution(sides: tuple[Gas, Gas], ray: float) -> None:
    left, right = sides
    scale = max(float(side.sound_speed()[0]) for side in sides)
    speed = np.array([ray * scale])
    found = sample(left, right, speed)
    swapped = [side._replace(velocity=-side.velocity) for side in (right, left)]
    mirrored = sample(swapped[0], swapped[1], -speed)
    between = star(left, right)
    assume(abs(float(between.velocity[0]) - ray * scale) > 1e-9 * scale)  # at the contact both sides are right
    assert np.concatenate(mirrored) * [1, -1, 1] == pytest.approx(np.concatenate(found), rel=1e-9, abs=1e-300)


def test_equal_states_stay() -> None:
    left = gas(2.0, 3.0, 5.0)
    for ray in (-10.0, 3.0, 10.0):
        assert np.concatenate(sample(left, left, np.array([ray]))) == pytest.approx(np.concatenate(left), rel=1e-15)


def test_vacuum_opens_where_the_gases_part_fast_enough() -> None:
    left, right = gas(1.0, -6.0, 1.0), gas(1.0, 6.0, 1.0)  # 2 (c + c)/(gamma - 1) = 11.8
    found = star(left, right)
    assert found.vacuum[0] and found.pressure[0] == 0 and found.velocity[0] == 0
    empty = sample(left, right, np.array([0.0]))
    assert empty.density[0] == 0 and empty.pressure[0] == 0
    edge = -6.0 + 5 * float(left.sound_speed()[0])
    outside = sample(left, right, np.array([1.01 * edge]))
    assert 0 < outside.density[0] < 1e-6
    assert not star(left, gas(1.0, 5.8, 1.0)).vacuum[0]


@given(POWER, MACH, POWER)
def test_conserved_and_primitive_are_inverse(density: float, mach: float, pressure: float) -> None:
    state = gas(density, 0.0, pressure)
    state = state._replace(velocity=mach * state.sound_speed())
    assert np.concatenate(primitive(conserved(state))) == pytest.approx(np.concatenate(state), rel=1e-9)


def test_the_flux_through_a_moving_face_is_that_of_the_moving_frame() -> None:
    """F(U) - s U for U = (rho, rho u, e): (2.1a)."""
    rho, u, p, s = 2.0, 3.0, 5.0, 0.7
    e = p / (GAMMA - 1) + rho * u * u / 2
    expected = [rho * u - rho * s, rho * u * u + p - rho * u * s, u * (e + p) - e * s]
    assert moving_flux(gas(rho, u, p), np.array([s]))[:, 0] == pytest.approx(expected)
