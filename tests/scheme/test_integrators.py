"""Named integrators: order from both sides, tableau against stability polynomial, published stability limits."""

from __future__ import annotations

from fractions import Fraction as F
from math import factorial

import numpy as np
import pytest

from gks.scheme.integrators import INTEGRATORS, Integrator, integrator

MULTISTEP = [i for i in INTEGRATORS.values() if i.kind == "multistep"]
RUNGE_KUTTA = [i for i in INTEGRATORS.values() if i.kind == "runge-kutta"]


def name_of(each: Integrator) -> str:
    return each.name


@pytest.mark.parametrize("method", MULTISTEP, ids=name_of)
def test_multistep_order_from_both_sides(method: Integrator) -> None:
    """rho(exp h) - h sigma(exp h) = O(h**(p + 1)), coefficient by coefficient (Hairer, Norsett & Wanner I, III.2.4)."""
    assert method.order is not None

    def defect(q: int) -> F:
        rho = sum((c * F(j) ** q / factorial(q) for j, c in enumerate(method.rho)), F(0))
        sigma = sum((c * F(j) ** (q - 1) / factorial(q - 1) for j, c in enumerate(method.sigma)), F(0)) if q else F(0)
        return rho - sigma

    assert [defect(q) for q in range(method.order + 1)] == [0] * (method.order + 1)
    assert defect(method.order + 1) != 0


@pytest.mark.parametrize("method", MULTISTEP, ids=name_of)
def test_multistep_methods_are_normalised_and_zero_stable(method: Integrator) -> None:
    """sigma(1) = rho'(1) = 1 times the steps of size h in one application: mu is the eigenvalue times dt."""
    assert sum(method.sigma) == sum(j * c for j, c in enumerate(method.rho))
    roots = np.roots([float(c) for c in reversed(method.rho)])
    assert max(abs(roots)) < 1 + 1e-12
    on_circle = [r for r in roots if abs(r) > 1 - 1e-6]
    assert all(abs(a - b) > 0.1 for i, a in enumerate(on_circle) for b in on_circle[:i])


@pytest.mark.parametrize("method", RUNGE_KUTTA, ids=name_of)
def test_runge_kutta_order_conditions_of_the_tableau(method: Integrator) -> None:
    """All trees up to order 4 (Hairer, Norsett & Wanner I, II.2): satisfied up to the order, and one fails beyond."""
    tableau = method.tableau
    assert tableau is not None and method.order is not None
    a, b, c = tableau.a, tableau.b, tableau.c
    n = range(len(b))

    def a_times(v: list[F]) -> list[F]:
        return [sum((a[i][j] * v[j] for j in n), F(0)) for i in n]

    def weigh(v: list[F]) -> F:
        return sum((b[i] * v[i] for i in n), F(0))

    one = [F(1)] * len(b)
    ac = a_times(list(c))
    conditions = {
        1: [(weigh(one), F(1))],
        2: [(weigh(list(c)), F(1, 2))],
        3: [(weigh([x**2 for x in c]), F(1, 3)), (weigh(ac), F(1, 6))],
        4: [
            (weigh([x**3 for x in c]), F(1, 4)),
            (weigh([x * y for x, y in zip(c, ac, strict=True)]), F(1, 8)),
            (weigh(a_times([x**2 for x in c])), F(1, 12)),
            (weigh(a_times(ac)), F(1, 24)),
        ],
        5: [(weigh(a_times(a_times(ac))), F(1, 120))],
    }
    for order in range(1, method.order + 1):
        assert all(found == wanted for found, wanted in conditions[order])
    assert any(found != wanted for found, wanted in conditions[method.order + 1])


@pytest.mark.parametrize("method", RUNGE_KUTTA, ids=name_of)
def test_stability_polynomial_is_one_step_of_the_tableau(method: Integrator) -> None:
    tableau = method.tableau
    assert tableau is not None
    mu = F(3, 7)
    slopes: list[F] = []
    for row in tableau.a:
        slopes.append(mu * (1 + sum((x * k for x, k in zip(row, slopes, strict=False)), F(0))))
    step = 1 + sum((x * k for x, k in zip(tableau.b, slopes, strict=True)), F(0))
    assert step == sum(c * mu**k for k, c in enumerate(method.stability))
    assert all(c == F(1, factorial(k)) for k, c in enumerate(method.stability[: (method.order or 0) + 1]))


@pytest.mark.parametrize(
    ("name", "limit"),
    [("forward-euler", 2), ("ab2", 1), ("ab3", F(6, 11)), ("rk2", 2), ("ssprk3", 2.5127453266), ("rk4", 2.7852935634)],
)
def test_real_stability_interval(name: str, limit: float) -> None:
    """The published ends of the stability interval on the negative real axis (Hairer & Wanner II, IV.2 and V.1)."""

    def growth(mu: float) -> float:
        pi = [float(sum(c * mu**k for k, c in enumerate(row))) for row in integrator(name).characteristic()]
        return float(max(abs(np.roots(pi[::-1]))))

    assert growth(-float(limit) * (1 - 1e-6)) < 1
    assert growth(-float(limit) * (1 + 1e-6)) > 1


@pytest.mark.parametrize("name", ["backward-euler", "crank-nicolson", "bdf2"])
def test_the_implicit_methods_are_a_stable(name: str) -> None:
    """All z inside the circle at points of the left half plane, and with modulus at most 1 on the imaginary axis."""
    pi = integrator(name).characteristic()
    for mu in (-1e-3 + 5j, -2.0, -40 + 1j, -1e3, 3j):
        z = np.roots([complex(sum(complex(c) * mu**k for k, c in enumerate(row))) for row in reversed(pi)])
        assert max(abs(z)) <= 1 + 1e-12
        assert mu.real == 0 or max(abs(z)) < 1


def test_leapfrog_is_neutral_on_the_imaginary_axis_up_to_one_and_nowhere_stable_off_it() -> None:
    def growth(mu: complex) -> float:
        return float(max(abs(np.roots([1, -2 * mu, -1]))))

    rows = integrator("leapfrog").characteristic()
    assert rows == ((F(-1),), (F(0), F(-2)), (F(1),))
    assert growth(0.99j) == pytest.approx(1, abs=1e-12)
    assert growth(1.01j) > 1.1
    assert growth(-0.01 + 0.5j) > 1.001


def test_the_exact_integrator_has_no_polynomial() -> None:
    exact = integrator("exact")
    assert (exact.kind, exact.order) == ("exact", None)
    with pytest.raises(ValueError, match="exp"):
        exact.characteristic()


def test_names_and_sources() -> None:
    names = "forward-euler backward-euler crank-nicolson leapfrog ab2 ab3 bdf2 rk2 ssprk3 rk4 exact"
    assert list(INTEGRATORS) == names.split()
    assert all(i.source for i in INTEGRATORS.values())
    implicit = [i.name for i in INTEGRATORS.values() if not i.explicit]
    assert implicit == ["backward-euler", "crank-nicolson", "bdf2", "exact"]
    with pytest.raises(KeyError):
        integrator("rk5")
