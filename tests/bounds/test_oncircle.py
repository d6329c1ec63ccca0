"""Delta on the unit circle is the limit of Delta outside."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from gks.bounds.oncircle import delta_of_z
from gks.modes.kreiss import normal_mode_problem
from tests.literature.closures import half_line


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson", "ab2", "rk4"])
@pytest.mark.parametrize("closure", ["2*u[1] - u[2]", "u[1]/2"])
def test_on_the_circle_delta_is_the_limit_from_outside(time: str, closure: str) -> None:
    """Central differences under a method without dissipation: every kappa is on the circle with Re s = 0."""
    scheme = half_line("dt(u[i]) = (u[i+1] - u[i-1])/2", f"u[0] = {closure}", time=time)
    delta = delta_of_z(normal_mode_problem(scheme, {"lam": Fraction(1, 2)}, ("lam",)))
    theta = np.concatenate([np.linspace(0.01, 0.5, 40), np.linspace(0.55, 3.1, 40)])  # leapfrog: glancing at pi/6
    z, lam = np.exp(1j * theta), np.full(80, 0.5)
    np.testing.assert_allclose(delta(z, lam), delta(z * (1 + 1e-9), lam), rtol=1e-6)
