"""Five interiors and eleven closures for u_t = u_x on x > 0, every verdict derived by hand.

Write kappa = u[i+1]/u[i] and z = u(n+1)/u(n). Each closure ties kappa to z by one equation, each interior by another;
the
normal modes are their common solutions with abs(kappa) < 1 (or, on abs(z) = 1, entering from the boundary).

- Space extrapolation: kappa = 1. Then z = 1 is the physical wave, which leaves; only leapfrog has a second one, z = -1,
  whose group velocity is reversed: it enters (Trefethen 1984, sect. 3). Generalized for every order and every lam < 1.
- Oblique extrapolation: kappa = z, whatever the order.
  leapfrog: z - 1/z = lam (z - 1/z) leaves z = 1, -1, and both waves leave. Lax-Friedrichs: the same two.
  Lax-Wendroff: z = kappa = lam/(2 + lam), decaying. Backward Euler: z = 2/lam - 1, outside with abs(kappa) > 1, or
  inside.
  Crank-Nicolson: z = exp(i t) with lam cos(t/2)**2 = 1 exists for lam >= 1, with group velocity -cos t = 1 - 2/lam: the
  wave enters for lam > 2, glances at lam = 2.
- One-sided update z - 1 = lam (kappa - 1): leapfrog, Lax-Wendroff and Lax-Friedrichs leave kappa = z = 1 alone;
  Crank-Nicolson: kappa = 2/lam - 1, z = 3 - 2 lam; backward Euler: kappa = 1/lam - 1, z = 2 - 2 lam. Both are modes
  once
  abs(kappa) < 1, and reach abs(z) = 1 at lam = 2 (kappa = 0) and lam = 3/2 (kappa = -1/3).
- Implicit one-sided update z - 1 = lam z (kappa - 1): leapfrog z kappa = 1, Crank-Nicolson kappa = -1 - 2/lam,
backward Euler
  kappa = 1: none decays. Lax-Wendroff: kappa = 1 - 1/lam, z = 1/2. Lax-Friedrichs: kappa = 1/lam - 1, z = 1/(2 lam):
  where
  one is outside, so is the other.
- Box (z - 1)(kappa + 1) = lam (z + 1)(kappa - 1): leapfrog z = kappa or z kappa = 1, both only at 1 and -1;
Crank-Nicolson,
  Lax-Wendroff, Lax-Friedrichs kappa = 1 (or both -1); backward Euler z = 2 kappa/(1 + kappa**2), kappa = (1 - lam)/(1
  + lam):
  abs(z) < 1.

At the explicit schemes' limit lam = 1: leapfrog has a double root on the circle and is not Cauchy-stable; the other two
are the shift u[i, n+1] = u[i+1], which reads no boundary value, and are stable with every closure that determines it.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from gks.modes import Verdict, analyse
from gks.solvers.update import update_matrix
from tests.literature.closures import CLOSURES, INTERIORS, half_line

LAMS = [Fraction(text) for text in ("1/2", "7/10", "9/10", "1", "6/5", "3/2", "2", "21/10", "5/2")]
TABLE = list(product(INTERIORS, CLOSURES))
EXPLICIT = ("leapfrog", "lax-wendroff", "lax-friedrichs")


def known(interior: str, closure: str, lam: Fraction) -> tuple[Verdict, str | None]:
    """The verdict and its reason, as derived above."""
    if interior in EXPLICIT and (lam > 1 or (lam == 1 and interior == "leapfrog")):
        return Verdict.UNSTABLE, "interior"
    if interior == "leapfrog" and closure.startswith("space"):
        return Verdict.GENERALIZED, "closure"
    if interior == "crank-nicolson" and closure.startswith("oblique") and lam >= 2:
        return Verdict.GENERALIZED, "closure"
    limit = {"crank-nicolson": Fraction(2), "backward-euler": Fraction(3, 2)}.get(interior)
    if closure == "one-sided" and limit is not None and lam >= limit:
        return (Verdict.NEUTRAL if lam == limit else Verdict.UNSTABLE), "closure"
    return Verdict.STABLE, None


@pytest.mark.parametrize(("interior", "closure"), TABLE)
def test_verdict_of_the_table(interior: str, closure: str) -> None:
    scheme = half_line(interior, CLOSURES[closure])
    for lam in LAMS:
        found = analyse(scheme, {"lam": lam})
        assert (found.verdict, found.reason) == known(interior, closure, lam), lam
        assert found.certified or found.reason == "interior"


@pytest.mark.parametrize(("interior", "closure"), TABLE)
def test_the_table_in_the_mirror(interior: str, closure: str) -> None:
    """x -> -x, a(t) -> -a: the same closures of u_t + u_x = 0 on x < 0."""

    def mirror(text: str) -> str:
        for k in range(6):
            text = text.replace(f"[{k}", f"[-{k}")
        return text.replace("[i+", "[i@").replace("[i-", "[i+").replace("[i@", "[i-")

    scheme = half_line(mirror(INTERIORS[interior]), mirror(CLOSURES[closure]), side="left")
    lam = Fraction(19, 10)
    assert analyse(scheme, {"lam": lam}).verdict is known(interior, closure, lam)[0]
    lam = Fraction(2, 3)
    assert analyse(scheme, {"lam": lam}).verdict is known(interior, closure, lam)[0]


@pytest.mark.parametrize(
    ("interior", "lam", "kappa", "z"),
    [
        ("crank-nicolson", Fraction(21, 10), Fraction(2, 1) / Fraction(21, 10) - 1, 3 - 2 * Fraction(21, 10)),
        ("backward-euler", Fraction(2), Fraction(1, 2) - 1, Fraction(-2)),
    ],
)
def test_the_growing_mode_is_the_one_of_the_formula(interior: str, lam: Fraction, kappa: Fraction, z: Fraction) -> None:
    scheme = half_line(interior, CLOSURES["one-sided"])
    (mode,) = [m for m in analyse(scheme, {"lam": lam}).modes if m.kind.value == "growing"]
    assert abs(mode.z[0] - z) <= mode.radius < Fraction(1, 10**15)
    assert mode.z[1] == 0
    ((real, imaginary),) = mode.kappa["R"]
    assert imaginary == 0
    assert abs(real - kappa) < Fraction(1, 10**15)
    # The second way: the finite problem's matrix has this eigenvalue.
    eigenvalues = np.linalg.eigvals(update_matrix(scheme, {"lam": lam}, 40))
    assert np.abs(eigenvalues - float(z)).min() < 1e-8


@pytest.mark.parametrize(
    ("interior", "closure", "lam"),
    [("leapfrog", "space-0", Fraction(1, 2)), ("crank-nicolson", "oblique-0", Fraction(21, 10))],
)
def test_the_finite_matrix_never_settles_on_a_generalized_row(interior: str, closure: str, lam: Fraction) -> None:
    """The naive way: a spectral radius above 1 that more cells bring down, so that any tolerance says either."""
    scheme = half_line(interior, CLOSURES[closure])
    excess = [
        float(np.abs(np.linalg.eigvals(update_matrix(scheme, {"lam": lam}, cells))).max()) - 1 for cells in (12, 24, 48)
    ]
    assert excess[0] > excess[1] > excess[2] > 1e-6
    assert excess[2] < excess[0] / 2
