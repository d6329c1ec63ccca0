"""Stable lam along the ray of a mode: closed forms, dense scans, balls, and what must stay open."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from flint import acb, arb
from hypothesis import given
from hypothesis import strategies as st

from gks.bounds.rayballs import stable_intervals_ball
from gks.bounds.raypolynomial import ray_polynomial
from gks.bounds.rays import Intervals, everything, intersect, stable_intervals
from gks.modes.doubledouble import Complex
from gks.modes.rootbatch import roots
from gks.scheme.integrators import INTEGRATORS, Integrator, integrator
from tests.examples import examples

POLYNOMIAL = [i for i in INTEGRATORS.values() if i.kind != "exact"]
ALL = list(INTEGRATORS.values())


def name_of(each: Integrator) -> str:
    return each.name


def at(method: Integrator | str, s: complex | list[complex], error: float = 0.0) -> Intervals:
    values = np.atleast_1d(np.asarray(s, complex))
    chosen = integrator(method) if isinstance(method, str) else method
    return stable_intervals(chosen, values.real.copy(), values.imag.copy(), error)


def listed(found: Intervals, point: int = 0) -> list[tuple[float, float]]:
    assert found.resolved[point]
    return [(float(found.lo[point, k]), float(found.hi[point, k])) for k in range(found.count[point])]


def assert_ends(found: list[tuple[float, float]], expected: list[tuple[float, float]], rel: float = 1e-15) -> None:
    assert np.array(found) == pytest.approx(np.array(expected), rel=rel, abs=0)


def growth(method: Integrator, mu: complex) -> float:
    """max |z| by the obvious way: a companion matrix at one mu."""
    rows = method.characteristic()
    return float(max(abs(np.roots([sum(complex(c) * mu**k for k, c in enumerate(row)) for row in reversed(rows)]))))


# --- closed forms -------------------------------------------------------------------------------------------------

plane = st.complex_numbers(min_magnitude=1e-3, max_magnitude=1e3, allow_nan=False, allow_infinity=False).filter(
    lambda s: s.real == 0 or abs(s.real) > 1e-280  # else the end is no normal double
)


@examples(80)
@given(plane)
def test_forward_and_backward_euler_have_closed_forms(s: complex) -> None:
    """-2 Re(1/s) bounds lam for forward Euler from above; for backward Euler 2 Re(1/s) does from below."""
    limit = -2 * (mpmath.mpc(s) ** -1).real
    forward, backward = listed(at("forward-euler", s)), listed(at("backward-euler", s))
    assert_ends(forward, [(0, float(limit))] if s.real < 0 else [])
    assert_ends(backward, [(-float(limit), np.inf)] if s.real > 0 else [(0, np.inf)])


@examples(40)
@given(plane)
def test_crank_nicolson_and_the_exact_integrator_know_only_the_sign_of_the_real_part(s: complex) -> None:
    for method in ("crank-nicolson", "exact"):
        assert listed(at(method, s)) == ([(0, np.inf)] if s.real < 0 else [])


def test_leapfrog_is_never_stable() -> None:
    """z_1 z_2 = -1."""
    found = at("leapfrog", [-1, 1j, 0.5 - 0.5j, -1e-9 + 1j])
    assert found.resolved.all() and not found.count.any()


@pytest.mark.parametrize("method", ALL, ids=name_of)
def test_a_mode_at_rest_has_z_equal_to_one(method: Integrator) -> None:
    assert listed(at(method, 0)) == []
    assert not at(method, 0, error=1e-20).resolved[0]


def test_rk4_along_a_ray_that_leans_to_the_right_is_stable_in_the_middle_only() -> None:
    [(low, high)] = listed(at("rk4", 0.02 + 1j))
    assert (round(low, 3), round(high, 3)) == (1.279, 2.780)
    rk4 = integrator("rk4")
    for end in (low, high):
        assert growth(rk4, end * (0.02 + 1j)) == pytest.approx(1, abs=1e-12)
    assert growth(rk4, 0.9 * low * (0.02 + 1j)) > 1 > growth(rk4, 1.1 * low * (0.02 + 1j))


@pytest.mark.parametrize(
    ("method", "s", "ends"),
    [
        ("rk4", 1j, [(0, 8**0.5)]),
        ("rk4", -1j, [(0, 8**0.5)]),
        ("ssprk3", 1j, [(0, 3**0.5)]),
        ("rk2", 1j, []),
        ("rk4", -1, [(0, 2.785293563405282)]),
        ("ab2", -2, [(0, 0.5)]),
        ("ab3", -1, [(0, 6 / 11)]),
        ("ab3", 1j, [(0, 0.7236272269866327)]),
        ("ab2", 1j, []),
        ("bdf2", 1, [(4, np.inf)]),
        ("bdf2", -5, [(0, np.inf)]),
        ("crank-nicolson", 1j, []),
    ],
)
def test_known_limits_on_the_axes(method: str, s: complex, ends: list[tuple[float, float]]) -> None:
    """Ends of the real and imaginary stability intervals (Hairer & Wanner II, IV.2, V.1; 0.7236 is AB3's)."""
    assert_ends(listed(at(method, s)), ends, rel=1e-14)


# --- the slow obvious way -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", POLYNOMIAL, ids=name_of)
def test_a_dense_scan_finds_the_same_set(method: Integrator) -> None:
    rng = np.random.default_rng(11)
    modes = np.exp(1j * rng.uniform(-np.pi, np.pi, 12)) * rng.uniform(0.2, 3, 12)
    modes = np.concatenate([modes, [1e-3 + 1j, -1e-3 + 1j, 0.05 - 1j, -0.3 + 1e-7j]])
    found = at(method, list(modes))
    assert found.resolved.all()
    for point, s in enumerate(modes):
        ends = listed(found, point)
        for lam in np.linspace(0.0113, 6, 160) / abs(s):
            size = growth(method, lam * s)
            if abs(size - 1) > 1e-9:
                assert (size < 1) == any(low < lam < high for low, high in ends), (s, lam, size, ends)


off_axes = st.floats(-np.pi, np.pi).filter(lambda angle: abs(np.sin(2 * angle)) > 1e-4)


@examples(150)
@given(st.sampled_from(ALL), off_axes, st.integers(-300, 300))
def test_balls_say_the_same_at_every_scale(method: Integrator, angle: float, octaves: int) -> None:
    """And the ends scale exactly with s: nothing in the way depends on its size."""
    s = complex(np.cos(angle), np.sin(angle))
    found = at(method, [s, s * 2.0**octaves])
    balls = stable_intervals_ball(method, acb(s.real, s.imag), 400)
    assert balls is not None and found.resolved.all()
    assert len(balls) == found.count[0] == found.count[1]
    for (low, high), (a, b), (c, d) in zip(balls, listed(found, 0), listed(found, 1), strict=True):
        assert (c * 2.0**octaves, d * 2.0**octaves) == (a, b)
        assert abs(arb(a) - low) <= abs(low) * float(found.error()[0])
        assert np.isinf(b) if high is None else abs(arb(b) - high) <= high * float(found.error()[0])


@examples(60)
@given(st.sampled_from(POLYNOMIAL), st.floats(0.01, 3.1), st.floats(1e-14, 1e-7), st.floats(-np.pi, np.pi))
def test_the_stated_error_covers_every_mode_within_the_stated_disk(
    method: Integrator, angle: float, error: float, direction: float
) -> None:
    s = complex(np.cos(angle), np.sin(angle))
    other = s * (1 + 0.99 * error * complex(np.cos(direction), np.sin(direction)))
    found, moved = at(method, s, error), at(method, other)
    if not found.resolved[0]:
        return
    assert found.count[0] == moved.count[0]
    for k, (low, high) in enumerate(listed(found)):
        a, b = listed(moved)[k]
        assert abs(a - low) <= low * found.lo_error[0, k]
        assert b == high or abs(b - high) <= high * found.hi_error[0, k]


# --- modes of a coupling ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [1e-10, 1e-4, 1.0, 30.0, 1e6, 1e10])
def test_a_second_order_coupling_under_forward_euler(ratio: float) -> None:
    """r of (2 r**2 - r + 1)**2 + a (3 r - 1)**2 = 0 and s = r - 1: lam_max = min -2 Re(1/s), to the last digit."""
    a = ratio
    found = roots(np.array([[1 + a, -2 - 6 * a, 5 + 9 * a, -4, 4.0]]))
    s = Complex.of(found.hi[0], found.lo[0]) - Complex.of(np.ones(4, complex))
    error = found.radius[0] * np.abs(found.hi[0]) / np.abs(s.hi)
    limits = stable_intervals(integrator("forward-euler"), s.re, s.im, error)
    assert limits.resolved.all() and (limits.count == 1).all()
    with mpmath.workdps(60):
        exact = [mpmath.mpf(c) for c in (4.0, -4, 5 + 9 * a, -2 - 6 * a, 1 + a)]
        true = min(-2 * (1 / (r - 1)).real for r in mpmath.polyroots(exact, maxsteps=500, extraprec=400))
        assert abs(limits.hi.min() - true) <= 3e-16 * true
    if ratio == 1e10:
        assert limits.hi.min() == pytest.approx(7.407407406856882e-11, rel=1e-15)


def test_the_low_part_of_s_counts_where_doubles_cancel() -> None:
    """r = 1 - 1e-20 + 1e-10 i: rounded to double r - 1 is purely imaginary, and forward Euler would be unstable."""
    r = Complex.of(np.array([1 + 1e-10j]), np.array([-1e-20 + 0j]))
    s = r - Complex.of(np.array([1 + 0j]))
    limit = stable_intervals(integrator("forward-euler"), s.re, s.im, 0.0)
    assert_ends(listed(limit), [(0, 2)])
    assert listed(at("forward-euler", complex((1 + 1e-10j) - 1))) == []


# --- what is left open --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", [m for m in ALL if m.name != "leapfrog"], ids=name_of)
def test_a_sign_within_the_error_is_not_decided(method: Integrator) -> None:
    assert not at(method, -1e-12 + 1j, error=1e-9).resolved[0]
    assert at(method, -1e-6 + 1j, error=1e-9).resolved[0]
    assert not at(method, -1 + 1j, error=0.01).resolved[0]
    assert not at(method, [np.nan, np.inf, complex(1, np.nan)]).resolved.any()


def test_modes_close_to_the_real_axis_need_more_bits_under_multistep_methods() -> None:
    """At a distance y from it two cuts are of the order y apart."""
    s = complex(-1, 1e-30)
    assert not at("ab2", s).resolved[0]
    assert stable_intervals_ball(integrator("ab2"), acb(-1, 1e-30), 100) is None
    [(low, high)] = stable_intervals_ball(integrator("ab2"), acb(-1, 1e-30), 1000) or []
    assert low == 0 and high is not None and abs(high - 1) < 1e-25


def test_balls_leave_open_what_they_hold_both_ways() -> None:
    wide = acb(arb(0, 1e-9), 1)
    for method in POLYNOMIAL:
        if method.name != "leapfrog":
            assert stable_intervals_ball(method, wide, 200) is None
    assert stable_intervals_ball(integrator("exact"), wide, 200) is None
    assert stable_intervals_ball(integrator("rk4"), acb(arb(0, 1e-9), arb(0, 1e-9)), 200) is None


@pytest.mark.parametrize("s", [-1e-300 + 1e-300j, -1e300 + 1e299j])
def test_the_ends_of_the_double_range(s: complex) -> None:
    [(low, high)] = listed(at("forward-euler", s))
    exact = -2 * (1 / mpmath.mpc(s)).real
    assert low == 0 and abs(high - exact) <= 1e-15 * exact


def test_ends_that_no_normal_double_holds_are_unresolved() -> None:
    assert not at("backward-euler", 1e-309 + 2j).resolved[0]
    assert not at("forward-euler", -1e-309).resolved[0]
    assert at("exact", -1e-309).resolved[0]


# --- the polynomial itself ----------------------------------------------------------------------------------------


@examples(60)
@given(st.sampled_from([m for m in POLYNOMIAL if m.name != "leapfrog"]), st.floats(-3, 3), st.floats(0.1, 3))
def test_the_ray_polynomial_is_the_product_over_pairs_of_roots(method: Integrator, x: float, y: float) -> None:
    """|lc|**(2k) prod (1 - z_i conj(z_j)) = t * (the polynomial at t = 1), roots from a companion matrix."""
    mu = complex(x, y)
    rows = [sum(complex(c) * mu**k for k, c in enumerate(row)) for row in method.characteristic()]
    z = np.roots(rows[::-1])
    z = np.concatenate([z, np.zeros(len(rows) - 1 - len(z))])
    pairs = abs(rows[-1]) ** (2 * len(z)) * np.prod([1 - a * np.conj(b) for a in z for b in z])
    polynomial = ray_polynomial(method.name)
    assert polynomial is not None
    terms = [float(q) * x**j * abs(mu) ** (2 * m) for row in polynomial.terms for j, m, q in row]
    assert sum(terms) == pytest.approx(pairs.real, abs=1e-9 * sum(map(abs, terms)) + 1e-9)


# --- intersections ------------------------------------------------------------------------------------------------


@st.composite
def interval_sets(draw: st.DrawFn) -> list[tuple[float, float]]:
    ends: list[int] = sorted(draw(st.lists(st.integers(0, 12), unique=True, min_size=0, max_size=6)))
    unbounded: bool = draw(st.booleans())
    pairs = [(float(a), float(b)) for a, b in zip(ends[::2], ends[1::2], strict=False)]
    return [*pairs, (float(ends[-1]) + 0.5, np.inf)] if ends and unbounded else pairs


def packed(pairs: list[tuple[float, float]]) -> Intervals:
    width = max(len(pairs), 1)
    lo, hi = np.full((1, width), np.nan), np.full((1, width), np.nan)
    for k, (a, b) in enumerate(pairs):
        lo[0, k], hi[0, k] = a, b
    error = np.where((lo > 0) & np.isfinite(lo), 1e-16, 0.0)
    hi_error = np.where(np.isfinite(hi), 1e-16, 0.0)
    return Intervals(lo, hi, error, hi_error, np.array([len(pairs)]), np.array([True]))


@given(interval_sets(), interval_sets())
def test_intersections_hold_what_both_hold(a: list[tuple[float, float]], b: list[tuple[float, float]]) -> None:
    both = intersect(packed(a), packed(b))
    touching = any(x[1] == y[0] or y[1] == x[0] for x in a for y in b)
    assert bool(both.resolved[0]) is not touching
    ends = [(both.lo[0, k], both.hi[0, k]) for k in range(both.count[0])]
    assert ends == sorted(ends)
    for lam in np.arange(0.25, 14, 0.25):
        inside = all(any(low < lam < high for low, high in pairs) for pairs in (a, b))
        assert inside == any(low < lam < high for low, high in ends)


def test_intersecting_modes_of_a_batch() -> None:
    modes = np.array([0.02 + 1j, -0.3 + 0.8j, 1.0])
    total = everything(3)
    for s in (modes, np.array([0.02 - 1j, -0.5, -1.0])):
        total = intersect(total, at("rk4", list(s)))
    assert total.resolved.all()
    assert total.count.tolist() == [1, 1, 0]
    assert listed(total, 0) == listed(at("rk4", 0.02 + 1j))
    assert listed(total, 1) == listed(at("rk4", -0.3 + 0.8j))
