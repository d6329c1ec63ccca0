"""A spatial root that decays outside the circle may pass infinity just inside it, where Delta has a pole.

u(n+1) = (1 - lam/4) u + lam/4 u[i-1] has kappa = (lam/4)/(z - 1 + lam/4), a pole of Delta at z = 1 - lam/4. A winding
number counts zeros less poles: a zero at z = 1 beside that pole counts as nothing, and the boundary condition that has
it as stable.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from gks.modes import Verdict, analyse
from gks.modes.kreiss import normal_mode_problem
from gks.modes.wide import wide_modes
from tests.oracle.scheme_texts import half_line

UPWIND = "u[i, n+1] = u[i] + lam/4*(u[i-1] - u[i])"


@pytest.mark.parametrize("lam", ["1/20", "3/20", "1/2", "4"])
@pytest.mark.parametrize("closure", ["u[1, n+1]", "2*u[1, n+1] - u[2, n+1]", "u[1]", "2*u[1] - u[2, n-1]"])
def test_the_pole_does_not_hide_the_zero(lam: str, closure: str) -> None:
    """Extrapolation where the wave enters: z = kappa = 1 solves all of these, and the wave comes from the boundary."""
    scheme = half_line(UPWIND, f'"u[0, n+1] = {closure}"', 1)
    values = {"lam": Fraction(lam)}
    assert analyse(scheme, values).verdict is Verdict.GENERALIZED
    counted = wide_modes(normal_mode_problem(scheme, values))
    assert 1 in [mode.z_complex for mode in counted.modes if mode.kind.value == "generalized"]


def test_a_growing_mode_close_to_the_pole_is_found() -> None:
    scheme = half_line(UPWIND, '"u[0, n+1] = -1/4*u[1, n-1] + 4*u[3]"', 1)
    values = {"lam": Fraction(3, 20)}
    exact = [float(m.modulus) for m in analyse(scheme, values).modes if m.kind.value == "growing"]
    counted = wide_modes(normal_mode_problem(scheme, values))
    assert exact
    assert [float(m.modulus) for m in counted.modes if m.kind.value == "growing"] == pytest.approx(exact)
