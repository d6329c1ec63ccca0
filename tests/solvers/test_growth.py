"""Growth rates with honest uncertainties: from traces whose rate is known, each kind with what makes it hard."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.solvers.growth import Growth, Trace, dominant_term, envelope, exponent, observe, observe_mode, pencil, quantile
from tests.examples import examples


def trace(values: np.ndarray) -> Trace:
    """Values of moderate size, as they are."""
    return Trace(values.reshape(len(values), -1), np.zeros(len(values)))


def scaled(log_rate: float, values: np.ndarray) -> Trace:
    """values * exp(log_rate * n), kept in exponents as a march keeps them."""
    n = np.arange(len(values))
    powers = log_rate * n / math.log(2.0)
    whole = np.floor(powers)
    return Trace(values.reshape(len(values), -1) * np.exp2(powers - whole)[:, None], whole)


def contains(found: Growth, rate: float) -> bool:
    return abs(found.rate - rate) <= found.uncertainty


@given(st.floats(-30, 30), st.floats(0.05, 3.0), st.floats(0.0, 6.0))
@examples(25)
def test_a_complex_pair_of_any_size_and_angle(log_rate: float, angle: float, phase: float) -> None:
    """The norm oscillates and passes e**15000; the rate is found to rounding."""
    n = np.arange(501)
    values = np.stack([np.cos(angle * n + phase), 0.3 * np.cos(angle * n - 1.0)], axis=1)
    found = observe(scaled(abs(log_rate), values))
    assert found.rate == pytest.approx(math.exp(abs(log_rate)), rel=1e-6)
    assert contains(found, math.exp(abs(log_rate)))


@pytest.mark.parametrize("jump", [100, 800, 1600, 3200])
@pytest.mark.parametrize("step", [1, 40])
def test_a_jump_of_hundreds_of_orders_leaves_the_rate_to_what_comes_after(jump: int, step: int) -> None:
    """A ghost value with a weight of 1e300 makes all that was there before negligible at once; then 1.1 a step."""
    n = np.arange(97)
    found = observe(Trace(1.1 ** n[:, None], np.where(n >= step, jump, 0)))
    assert contains(found, 1.1)


@given(st.floats(0.6, 1.4), st.floats(0.1, 0.9), st.integers(0, 2**31))
@examples(25)
def test_a_mode_beside_a_transient(rate: float, ratio: float, seed: int) -> None:
    source = np.random.default_rng(seed)
    n = np.arange(401)
    amplitudes = source.uniform(0.5, 1.5, size=(2, 3))
    values = amplitudes[0] + ratio ** n[:, None] * amplitudes[1]
    found = observe(scaled(math.log(rate), values))
    assert contains(found, rate)
    assert found.uncertainty < 0.05 * rate


@pytest.mark.parametrize("power", [1, 2, 3])
@pytest.mark.parametrize("rate", [0.99, 1.0, 1.2])
def test_the_polynomial_factor_of_a_multiple_root_is_not_growth(power: int, rate: float) -> None:
    n = np.arange(1025.0)
    found = observe(scaled(math.log(rate), (n + 3) ** power))
    assert found.rate == pytest.approx(rate, rel=1e-3)
    assert contains(found, rate)


@pytest.mark.parametrize("power", [0.5, 1.0, 1.5])
def test_waves_that_leave_decay_algebraically_and_that_is_not_decay_of_a_mode(power: float) -> None:
    n = np.arange(1025.0)
    values = (n + 1) ** -power * (1 + 0.3 * np.cos(2.1 * n) + 0.1 * np.cos(0.7 * n + 1))
    found = observe(trace(values))
    assert contains(found, 1.0) and found.uncertainty < 2e-3


def test_uncertainty_covers_the_rate_as_often_as_it_says() -> None:
    """Two hundred noisy signals of known rate: at 99 % confidence about two may miss, six or more hardly ever do (1.6
    %).
    """
    missed = 0
    for seed in range(200):
        source = np.random.default_rng(seed)
        n = np.arange(600)
        noise = source.normal(scale=0.2, size=600)
        missed += not contains(envelope(0.003 * n + noise, 0), math.exp(0.003))
    assert missed < 6


def test_correlated_noise_widens_the_interval() -> None:
    """A beat longer than the blocks must not pass for a trend."""
    n = np.arange(1000)
    quiet = envelope(np.log(2 + np.cos(2.0 * n)), 0)
    beating = envelope(np.log(2 + np.cos(0.01 * n)), 0)
    assert contains(beating, 1.0) and beating.uncertainty > 10 * quiet.uncertainty


def test_decay_stops_counting_at_the_round_off_floor() -> None:
    n = np.arange(400)
    noise = 1e-17 * np.random.default_rng(0).normal(size=400)
    found = observe(trace(0.7**n + noise))
    assert "floor" in found.how
    assert contains(found, 0.7) and found.uncertainty < 1e-2


def test_a_mode_that_rises_out_of_the_floor_is_seen() -> None:
    n = np.arange(800)
    found = observe(trace(0.5**n + 1e-17 * 1.05**n))
    assert found.rate == pytest.approx(1.05, rel=1e-6)
    assert "floor" not in found.how


def test_exact_zero_has_rate_zero() -> None:
    values = np.ones((50, 2))
    values[7:] = 0.0
    assert observe(trace(values)) == Growth(0.0, 0.0, "exactly zero at the end")


@pytest.mark.parametrize("length", [1, 2, 3])
def test_too_few_steps_say_nothing(length: int) -> None:
    found = observe(trace(np.ones((length, 2))))
    assert found.uncertainty == math.inf
    assert not found.exceeds(0.5) and not found.below(2.0)


def test_white_noise_is_no_mode() -> None:
    values = np.random.default_rng(4).normal(size=(100, 3))
    assert dominant_term(trace(values))[1] > 0.1
    assert pencil(trace(np.concatenate([values, values[::-1]]))) is None


def test_the_pencil_finds_the_larger_of_two_pairs_that_beat() -> None:
    n = np.arange(100)
    values = np.stack(
        [np.cos(0.5 * n) * 1.02**n + np.cos(0.6 * n), np.sin(0.5 * n) * 1.02**n - np.sin(0.6 * n)], axis=1
    )
    modulus, unexplained = dominant_term(trace(values))
    assert modulus == pytest.approx(1.02, rel=1e-8)
    assert unexplained < 1e-9


@given(st.complex_numbers(min_magnitude=0.3, max_magnitude=50))
def test_a_mode_from_its_start_gives_its_complex_z(z: complex) -> None:
    n = np.arange(12)
    values = np.array([1.0, 2.0 - 1j])[None, :] * (z / abs(z)) ** n[:, None]
    seen, growth = observe_mode(scaled(math.log(abs(z)), values))
    assert seen == pytest.approx(z, rel=1e-9)
    assert growth.rate == pytest.approx(abs(z), rel=1e-9)


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 2.0])
def test_exponent_of_a_response(power: float) -> None:
    n = np.arange(1000.0)
    found, uncertainty = exponent(np.log((n + 1) ** power * (1.2 + np.cos(1.3 * n))))
    assert found == pytest.approx(power, abs=max(0.03, uncertainty))


def test_student_quantiles_fall_with_the_degrees_of_freedom() -> None:
    values = [quantile(freedom) for freedom in range(1, 40)]
    assert values == sorted(values, reverse=True)
    assert 2.576 < values[-1] < 3  # never below the normal distribution's
