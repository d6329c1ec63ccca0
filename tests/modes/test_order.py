"""Multiplicities are those of the mode, not of the polynomial that eliminates the spatial roots."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import comb

import pytest

from gks.modes.analysis import analyse, judged
from gks.modes.kreiss import normal_mode_problem
from gks.modes.order import multiplicity, vanishing_order
from gks.modes.verdict import ModeKind
from gks.modes.wide import wide_modes
from gks.scheme.model import Scheme
from tests.oracle.scheme_texts import half_line

UPWIND3 = "u[i, n+1] = u[i] - lam*(2*u[i+1] + 3*u[i] - 6*u[i-1] + u[i-2])/6"


def two_ghosts(first: str, second: str) -> Scheme:
    """Three spatial roots, two of them decaying: the elimination counts a root kappa with either of the others."""
    return half_line(UPWIND3, f'"u[-1] = {first}", "u[-2] = {second}"')


def test_a_zero_shared_by_several_choices_of_roots_is_counted_once() -> None:
    # Both equations say kappa = 1/2, alone or with any second root: one mode, which the norm meets on two sheets.
    scheme = two_ghosts("2*u[0]", "2*u[-1]")
    values = scheme.values({"lam": "1/4"})
    ((mode, candidate),) = judged(normal_mode_problem(scheme, values))[0]
    assert candidate.multiplicity == 2
    assert (mode.kind, mode.multiplicity) == (ModeKind.GROWING, 1)
    assert abs(mode.z[0] - (1 - Fraction(1, 4) * (1 + 3 - 12 + 4) / 6)) <= mode.radius


def test_a_true_double_zero_keeps_its_multiplicity() -> None:
    # The ghost's own equation is z**2 = 4 z - 4, and the cells follow: Delta = (z - 2)**2.
    scheme = half_line("u[i, n+1] = u[i-1, n]", '"u[-1, n+1] = 4*u[-1] - 4*u[-1, n-1]"')
    result = analyse(scheme, scheme.values())
    assert [(m.z_complex, m.multiplicity, m.kind) for m in result.modes] == [(2, 2, ModeKind.GROWING)]


def binomial_interface(reach: int, weight: Fraction) -> Scheme:
    """((1 + a) + (1 - a) E**2)**reach / 2**reach E**-reach, a Lax-Friedrichs step taken ``reach`` times, with every
    ghost the ``weight`` times the value beside it: kappa = 1/weight, alone or with any others.
    """
    a = Fraction(1, 2)
    weights = {
        2 * k - reach: comb(reach, k) * ((1 + a) / 2) ** (reach - k) * ((1 - a) / 2) ** k for k in range(reach + 1)
    }
    terms = " + ".join(f"({c})*u[i{j:+d}]" for j, c in weights.items())
    closure = ", ".join(f'"u[-{m}] = ({weight})**{m}*u[0]"' for m in range(1, reach + 1))
    return half_line(f"u[i, n+1] = {terms}", closure)


@pytest.mark.parametrize("weight", [Fraction(2), Fraction(3, 2)])
def test_ten_choices_that_share_a_zero_are_one_mode(weight: Fraction) -> None:
    """Three of six spatial roots decay: 1/weight with any two of the others are ten choices with that zero."""
    scheme = binomial_interface(3, weight)
    found, doubts = judged(normal_mode_problem(scheme, scheme.values({"lam": "1"})))
    ((mode, candidate),) = [(m, c) for m, c in found if m.kind is ModeKind.GROWING]
    assert not doubts
    assert candidate.multiplicity == comb(5, 2)
    assert mode.multiplicity == 1
    assert abs(mode.z[0] - ((3 * weight + 1 / weight) / 4) ** 3) <= mode.radius


def test_a_zero_on_the_circle_has_its_own_multiplicity_too() -> None:
    """Linear extrapolation at both ghosts of an inflow: Delta = (k_1 - 1)**2 (k_2 - 1)**2, k_1 = 1 - s + ... decaying.

    The elimination meets k_1 with either of the other roots, and the square of its zero twice.
    """
    interior = "dt(u[i]) = -(2*u[i+1] + 3*u[i] - 6*u[i-1] + u[i-2])/6"
    for time in ("exact", "rk4"):
        scheme = half_line(interior, '"u[-1] = 2*u[0] - u[1]", "u[-2] = 2*u[-1] - u[0]"', time=time)
        problem = normal_mode_problem(scheme, scheme.values({"lam": "1/4"}))
        ((mode, candidate),) = [(m, c) for m, c in judged(problem)[0] if m.kind is ModeKind.GENERALIZED]
        assert (mode.z_complex, mode.multiplicity, candidate.multiplicity) == (1, 2, 4)
        (counted,) = wide_modes(problem).modes
        assert (counted.kind, counted.multiplicity) == (ModeKind.GENERALIZED, 2)


@pytest.mark.parametrize("order", [2, 4, 8])
@pytest.mark.parametrize("root", ["1", "-3/2", "1 + 10**-14"])
def test_a_boundary_point_with_a_multiple_root_of_its_own(order: int, root: str) -> None:
    """(E_t - w)**m u_0 = 0 beside u_t = u_x: an m-fold eigenvalue w."""
    terms = " + ".join(f"{comb(order, j)}*(-({root}))**{order - j}*u[0, n+{j}]" for j in range(order + 1))
    scheme = half_line("u[i, n+1] = u[i] + lam*(u[i+1] - u[i])", f'"{terms} = 0"', first=1)
    (mode,) = [m for m in analyse(scheme, scheme.values({"lam": "1/2"})).modes if m.modulus >= 1]
    assert mode.multiplicity == order


def test_no_zero_of_delta_at_a_zero_of_the_norm() -> None:
    """A disc round a zero that belongs to other choices holds none: the order is 0, and there is no mode."""
    scheme = two_ghosts("2*u[0]", "2*u[-1]")
    problem = normal_mode_problem(scheme, scheme.values({"lam": "1/4"}))
    for mode, candidate in judged(problem)[0]:
        order = vanishing_order(problem, candidate)
        assert order is None or (order > 0) is (mode.kind is not ModeKind.INADMISSIBLE)
    scheme = two_ghosts("u[0] + 1/7*u[1]", "2*u[-1]")
    problem = normal_mode_problem(scheme, scheme.values({"lam": "1/4"}))
    orders = [(vanishing_order(problem, c), m.kind is ModeKind.INADMISSIBLE) for m, c in judged(problem)[0]]
    assert (0, True) in orders
    assert all((order == 0) is inadmissible for order, inadmissible in orders if order is not None)


def test_where_the_zeros_of_the_norm_are_not_known_nothing_is_told() -> None:
    scheme = two_ghosts("2*u[0]", "2*u[-1]")
    problem = normal_mode_problem(scheme, scheme.values({"lam": "1/4"}))
    ((_, candidate),) = judged(problem)[0]
    alone = replace(candidate, rivals=())
    assert vanishing_order(problem, alone) is None
    assert multiplicity(problem, alone) == candidate.multiplicity == 2
