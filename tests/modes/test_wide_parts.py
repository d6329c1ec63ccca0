"""The parts of the count: discs that hold what they claim, roots in their discs, bounds that hold, walks that count."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from flint import acb
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from gks.modes.chart import Chart, chart_of
from gks.modes.discs import ComplexArray, Discs, Jets
from gks.modes.enclosure import Dual, NotEnclosed, Zero, determinant, enclose
from gks.modes.exactpoint import exact_point, rational_candidate
from gks.modes.kreiss import normal_mode_problem
from gks.modes.kreissdiscs import patch
from gks.modes.rootdiscs import approximate, branches, root_discs
from gks.modes.tables import ball_tables, disc_tables
from gks.modes.verdict import ModeKind
from gks.modes.winding import full_circle, half_circle, seeds, walk
from gks.scheme.integrators import INTEGRATORS
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.examples import examples
from tests.oracle.scheme_texts import LAX_WENDROFF, LEAPFROG, half_line, traditional

INFLOW = LAX_WENDROFF.replace("lam/2*(u[i+1] - u[i-1])", "(-lam/2)*(u[i+1] - u[i-1])")
"""Waves that run away from the boundary."""
RNG = np.random.default_rng(0)
numbers = st.complex_numbers(max_magnitude=8, min_magnitude=0.125)
radii = st.floats(0, 0.5)


def members(disc: Discs, count: int = 24) -> ComplexArray:
    """Points of a disc, its rim among them."""
    angles = np.exp(2j * np.pi * np.arange(count) / count)
    return np.concatenate([[complex(disc.mid)], disc.mid + disc.rad * angles, disc.mid + disc.rad * angles / 3])


def holds(disc: Discs, values: NDArray[Any]) -> bool:
    # Sampled values carry a rounding error of their own, a few units of the sizes involved.
    return bool((np.abs(values - disc.mid) <= disc.rad + 2.0**-46 * (1 + np.abs(values))).all())


# Discs ----------------------------------------------------------------------------------------------------------------


@examples(60)
@given(numbers, radii, numbers, radii)
def test_operations_enclose_their_values(x: complex, r: float, y: complex, s: float) -> None:
    a, b = Discs(np.asarray(x), np.asarray(r)), Discs(np.asarray(y), np.asarray(s))
    one, other = members(a)[:, None], members(b)[None, :]
    assert holds(a + b, (one + other).ravel())
    assert holds(a - b, (one - other).ravel())
    assert holds(a * b, (one * other).ravel())
    if abs(x) > r * 1.01:
        assert holds(a.reciprocal(), (1 / one).ravel())


def test_the_rounding_error_is_inside() -> None:
    """0.1 * 0.1 is not 0.01 in doubles: the disc of radius 0 around 0.1 holds a number, its square a disc."""
    tenth = Discs.exact(np.asarray(0.1 + 0j))
    with_product = tenth * tenth
    exact = acb(0.1) * acb(0.1)
    assert abs(exact - acb(complex(with_product.mid))) <= float(with_product.rad)
    assert 0 < float(with_product.rad) < 1e-16


def test_reciprocal_of_a_disc_round_zero_proves_nothing() -> None:
    assert np.isinf(Discs(np.asarray(0.5 + 0j), np.asarray(0.6)).reciprocal().rad)


def test_matrix_products_enclose_those_of_members() -> None:
    shape = (2, 3, 3)
    a, b = (Discs(RNG.normal(size=shape) + 1j * RNG.normal(size=shape), RNG.random(shape) / 10) for _ in range(2))
    product = a @ b
    for _ in range(20):
        inside = [d.mid + d.rad * np.exp(2j * np.pi * RNG.random(shape)) for d in (a, b)]
        assert (np.abs(inside[0] @ inside[1] - product.mid) <= product.rad).all()


# Roots ----------------------------------------------------------------------------------------------------------------


def test_every_root_is_in_its_disc() -> None:
    true = np.array([[0.1, 0.5j, -2.0, 3.0 + 1j], [1e-8, 1.0, -1.0, 1e8]])
    coefficients = np.array([np.poly(row)[::-1] for row in true])
    found = root_discs(Discs(coefficients, np.abs(coefficients) * 1e-12), approximate(coefficients))
    assert (found.joined.sum(axis=2) == 1).all()
    for row, centre, cover in zip(true, found.centre, found.cover, strict=True):
        gaps = np.abs(row[:, None] - centre[None, :])
        assert (np.sort(gaps.argmin(axis=1)) == np.arange(4)).all()
        assert (gaps.min(axis=1) <= cover[gaps.argmin(axis=1)]).all()


def test_a_double_root_is_one_component() -> None:
    coefficients = np.array([np.poly([0.5, 0.5, 2.0])[::-1]]).astype(complex)
    found = root_discs(Discs.exact(coefficients), approximate(coefficients))
    near = np.abs(found.centre[0] - 0.5) < 0.1
    assert near.sum() == 2
    assert found.joined[0][np.ix_(near, near)].all()
    assert not found.joined[0][np.ix_(near, ~near)].any()
    assert (np.abs(found.centre[0][near] - 0.5) <= found.cover[0][near]).all()


def test_a_vanishing_leading_coefficient_proves_nothing() -> None:
    found = root_discs(Discs.exact(np.array([[1.0, 1.0, 0.0]], complex)), np.array([[-1.0, 9.0]], complex))
    assert np.isinf(found.cover).all()


def test_branches_have_the_slope_of_the_implicit_function() -> None:
    """x**2 = w near w = 1: the branches 1 and -1 with slopes 1/2 and -1/2, enclosed over a disc of w."""
    w = Jets(Discs(np.array([1 + 0j]), np.array([1e-3])), Discs.exact(np.array([1 + 0j])))
    zero, one = (Discs.exact(np.array([c + 0j])) for c in (0, 1))
    coefficients = Jets(
        Discs(np.stack([-w.value.mid, zero.mid, one.mid], 1), np.stack([w.value.rad, zero.rad, one.rad], 1)),
        Discs.exact(np.array([[-1, 0, 0]], complex)),
    )
    found = branches(coefficients, root_discs(coefficients.value, np.array([[1, -1]], complex)))
    rim = np.sqrt(members(w.value[0]))
    assert holds(found.value[0, 0], rim)
    assert holds(found.slope[0, 0], 1 / (2 * rim))
    assert float(found.slope.rad[0, 0]) < 1e-2


# The chart ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", sorted(INTEGRATORS))
def test_the_chart_solves_the_integrators_equation(name: str) -> None:
    """pi(1/w, a/b) = 0, or a/b = (1 + w)/(1 - w), which has a positive real part inside the circle."""
    chart = Chart(INTEGRATORS[name])
    w = np.array([0.3 + 0.4j, -0.9 + 0.1j, 0.99 + 0j])
    a, b = chart.images(Jets.exact(w), chart.stages(w))
    mu = (a.value.mid / b.value.mid).reshape(chart.branches, -1)
    if name == "exact":
        assert (mu.real > 0).all()
        return
    rows = INTEGRATORS[name].characteristic()
    residual = sum(np.polyval([float(c) for c in reversed(row)], mu) * (1 / w) ** k for k, row in enumerate(rows))
    assert np.abs(residual).max() < 1e-10


# The bound over a disc, and the walk ----------------------------------------------------------------------------------


RADIUS = 2e-3


@pytest.mark.parametrize("scheme", [traditional("rk4"), half_line(LEAPFROG, '"u[0, n+1] = u[1, n]"', 1)])
def test_the_change_over_a_disc_is_bounded(scheme: Scheme) -> None:
    problem = normal_mode_problem(scheme, scheme.values({}))
    tables, chart = disc_tables(problem), chart_of(problem)
    node = np.asarray(0.9 * np.exp(1j * np.array([0.4, 1.1, 2.0])), complex)
    found = patch(tables, chart, Discs(node, np.full(3, RADIUS)), node)
    assert (found.change < 0.9).all()
    for angle in np.linspace(0, 6, 7):
        other = node + RADIUS * np.exp(1j * angle)
        there = patch(tables, chart, Discs.exact(other), other)
        ratio = np.exp((there.log - found.log).sum(axis=1) + 1j * (there.phase - found.phase))
        assert (np.abs(ratio - 1) <= found.change).all()
        assert (np.abs(ratio - 1) > 1e-6).any()


def test_a_walk_counts_and_its_moments_find() -> None:
    """Lax-Wendroff with u[-1] = c u[0], c = 3, at inflow: one zero by hand from kappa = 1/c, z = P's at that kappa."""
    lam, c = 0.5, 3.0
    scheme = half_line(INFLOW, '"u[-1] = 3*u[0]"')
    problem = normal_mode_problem(scheme, scheme.values({}))
    tables, chart = disc_tables(problem), chart_of(problem)
    kappa = 1 / c
    z = 1 - lam / 2 * (kappa - 1 / kappa) + lam**2 / 2 * (kappa - 2 + 1 / kappa)
    assert z > 1
    around = walk(tables, chart, half_circle(), 1e-4)
    assert not around.stuck
    assert round(around.zeros) == 1
    assert seeds(around, 0j, 1.0, 1) == pytest.approx([1 / z], abs=1e-2)
    inner = walk(tables, chart, full_circle(0j, 0.9 / z), 1e-4)
    assert round(inner.zeros) == 0
    beside = walk(tables, chart, half_circle([(1 + 0j, 0.05)]), 1e-4)
    assert round(beside.zeros) == 1


# Balls ----------------------------------------------------------------------------------------------------------------


def test_a_dual_determinant_has_the_derivative_of_the_determinant() -> None:
    matrix = [[Dual(acb(a), acb(b)) for a, b in row] for row in (((1, 2), (3, 0)), ((2, 1), (4, 5)))]
    found = determinant(matrix)
    assert found.value.contains(-2)
    assert found.slope.contains(2 * 4 + 1 * 5 - 3 * 1)


def test_an_enclosure_is_proved_where_the_zero_is_simple_and_refused_where_there_is_none() -> None:
    scheme = traditional()
    problem = normal_mode_problem(scheme, scheme.values({"alpha": "4"}))
    tables, chart = disc_tables(problem), chart_of(problem)
    balls = ball_tables(problem, 96)

    def tried(w: complex) -> Zero:
        at = patch(tables, chart, Discs.exact(np.array([w])), np.array([w]))
        hints = [[complex(x) for x in family[0, 0]] for family in at.start.spatial]
        return enclose(balls, acb(chart.value(w, 0j)), hints, 96)

    zero = tried(1 / (0.5501 + 0.9002j))
    assert abs(complex(1 + zero.mu) - (0.55 + 0.9j)) < 1e-12  # z = 1 + mu, mu = lam s
    assert all(family.told_by_modulus() for family in zero.roots)
    with pytest.raises(NotEnclosed):
        enclose(balls, acb(0), [[1.0 + 0j] * len(s.powers[1:]) for s in balls.symbols], 96)


# Exact points ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_order_of_vanishing_is_counted_exactly(order: int) -> None:
    """Extrapolation of order p at inflow: Delta = (1 - kappa)**p with kappa - 1 a simple function of z - 1."""
    closure = {1: "u[0]", 2: "2*u[0] - u[1]", 3: "3*u[0] - 3*u[1] + u[2]"}[order]
    scheme = half_line(INFLOW, f'"u[-1] = {closure}"')
    problem = normal_mode_problem(scheme, scheme.values({}))
    candidate = rational_candidate(problem, 1)
    assert candidate is not None
    point = exact_point(problem, candidate, 5)
    assert (point.kind, point.order) == (ModeKind.GENERALIZED, order)
    other = rational_candidate(problem, -1)
    assert other is not None
    assert exact_point(problem, other, 5).kind is ModeKind.INADMISSIBLE


def test_an_eigenvalue_that_decays_is_neutral() -> None:
    """A boundary value that keeps itself, u[0, n+1] = u[0, n], beside u = 0 inside: z = 1 with kappa = 0 alone."""
    scheme = parse_scheme(
        """
title = "a value on its own"
[parameters]
lam = { role = "cfl", default = 0.5 }
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = u[i] + lam*(u[i+1] - u[i])"]
first = 1
[closure]
equations = ["u[0, n+1] = u[0]"]
""",
        "alone",
    )
    problem = normal_mode_problem(scheme, scheme.values({}))
    candidate = rational_candidate(problem, 1)
    assert candidate is not None
    assert exact_point(problem, candidate, 3).kind is ModeKind.EIGENVALUE
