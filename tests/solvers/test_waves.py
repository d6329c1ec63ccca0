"""The pulse that crosses an interface: the exact solution satisfies the equations, and the printed one does not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.solvers.waves import Interface, Medium, Pulse

DENSITY = st.floats(-10, 10).map(lambda power: 10.0**power)
SPEED = st.floats(0.2, 5.0)
MEDIUM = st.builds(Medium, DENSITY, SPEED)
INTERFACE = st.builds(Interface, MEDIUM, MEDIUM)


@given(INTERFACE, st.floats(0.05, 0.95))
def test_velocity_and_stress_are_continuous_at_the_interface(interface: Interface, part: float) -> None:
    t = 2 * part * 0.5 / interface.left.speed  # the pulse is centred at the interface for part = 1/2
    u, sigma = interface.exact(np.array([-1e-300, 1e-300]), t)
    assert u[0] == pytest.approx(u[1], rel=1e-12, abs=1e-14 * interface.left.speed)
    assert sigma[0] == pytest.approx(sigma[1], rel=1e-12, abs=1e-14 * interface.left.modulus)


@given(INTERFACE, st.floats(-1, 1).filter(lambda x: abs(x) > 0.01), st.floats(0.1, 1.5))
def test_the_equations_hold_on_both_sides(interface: Interface, x: float, transit: float) -> None:
    """u_t = sigma_x/rho and sigma_t = kappa u_x, by fourth-order differences, in units of each side's own waves."""
    medium = interface.left if x < 0 else interface.right
    t = transit / interface.left.speed
    if abs(x - medium.speed * t) < 0.05:  # the front of the data: the pulse's tail is cut there, at 1e-11
        return
    h = 1e-3
    offsets, weights = np.array([-2, -1, 1, 2]) * h, np.array([1, -8, 8, -1]) / (12 * h)
    u_x, sigma_x = (weights @ field for field in interface.exact(x + offsets, t))
    at_times = [interface.exact(np.array([x]), t + offset / medium.speed) for offset in offsets]
    u_t = medium.speed * sum(w * float(u[0]) for w, (u, _) in zip(weights, at_times, strict=True))
    sigma_t = medium.speed * sum(w * float(s[0]) for w, (_, s) in zip(weights, at_times, strict=True))
    steep = max(1.0, interface.left.speed / medium.speed) ** 5 * interface.left.speed * medium.speed
    assert u_t == pytest.approx(sigma_x / medium.density, rel=1e-3, abs=1e-3 * steep)
    assert sigma_t / medium.impedance == pytest.approx(
        medium.modulus * u_x / medium.impedance, rel=1e-3, abs=1e-3 * steep
    )


@given(INTERFACE)
def test_the_pulses_energy_is_reflected_or_transmitted(interface: Interface) -> None:
    """Power of a wave: Z u**2 = Z c**2 b**2; what comes equals what leaves."""
    left, right = interface.left, interface.right
    comes = left.impedance * left.speed**2
    leaves = left.impedance * (left.speed * interface.reflection) ** 2
    crosses = right.impedance * (right.speed * interface.transmission) ** 2
    assert comes == pytest.approx(leaves + crosses, rel=1e-12)


def test_equal_media_let_the_pulse_pass() -> None:
    interface = Interface.of_ratio(1.0)
    x, c = np.linspace(-1, 1, 41), math.sqrt(3.0)
    u, sigma = interface.exact(x, 0.4)
    ahead = x > c * 0.4
    assert u == pytest.approx(np.where(ahead, 0.0, -c * Pulse()(x - c * 0.4)), abs=1e-14)
    assert sigma == pytest.approx(-c * u, abs=1e-13)


def test_the_interface_values_of_the_text() -> None:
    """(4.2), right as printed for equal speeds."""
    interface = Interface.of_ratio(3.0)
    c, t = math.sqrt(3.0), 0.3
    kappa_left, kappa_right = interface.left.modulus, interface.right.modulus
    f = float(Pulse()(np.array(-c * t)))
    u, sigma = interface.exact(np.array([-1e-14]), t)
    assert u[0] == pytest.approx(-2 * c * f / (1 + kappa_right / kappa_left))
    assert sigma[0] == pytest.approx(2 * f / (1 / kappa_right + 1 / kappa_left))


def test_the_printed_solution_is_none() -> None:
    """Its velocity left of the interface, (2 f(-ct) + u_I/c + sigma_I/kappa_L) c/2, jumps there by 2 c f(-ct)."""
    interface = Interface.of_ratio(3.0)
    c, t = math.sqrt(3.0), 0.3
    f = float(Pulse()(np.array(-c * t)))
    u, sigma = (float(field[0]) for field in interface.exact(np.array([1e-14]), t))
    printed = (2 * f + u / c + sigma / interface.left.modulus) * c / 2
    assert printed - u == pytest.approx(2 * c * f)
    assert abs(printed - u) > 1.0
    # and a pulse centred at +1/2, as printed, has left nothing on the left to come
    assert np.abs(Pulse(centre=0.5)(np.linspace(-1, 0, 11))).max() < 1e-10


def test_the_pulse_is_where_the_text_sees_it() -> None:
    """At t = 0.375 it is crossing: both sides are in motion; at 0.75 the halves run apart and have not left."""
    interface = Interface.of_ratio(4 / 0.9 - 1)
    x = np.linspace(-1, 1, 401)
    crossing, later = (np.abs(interface.exact(x, t)[0]) for t in (0.375, 0.75))
    assert crossing[x < 0].max() > 0.1 and crossing[x > 0].max() > 0.1
    assert later[np.abs(x) < 0.5].max() < 1e-3 and later[x < -0.7].max() > 0.1 and later[x > 0.7].max() > 0.1
