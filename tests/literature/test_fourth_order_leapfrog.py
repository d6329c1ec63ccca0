"""Leapfrog with fourth-order central differences for u_t = u_x: oblique extrapolation is not stable up to the CFL
limit.

Extrapolating both boundary values along the diagonal leaves v with (1 - E/z) v = 0 twice over, so kappa = z again. On
the circle z = kappa = exp(i t) needs sin t = (lam/6)(8 sin t - sin 2t), cos t = 4 - 3/lam =: c. The wave's group
velocity
has the sign of (4 c**2 - 8 c - 2)/c; for c < 0 it points inwards once c > 1 - sqrt(6)/2, that is for

    lam > 3/(4 - c) = 6/(6 + sqrt(6)) = 0.7101...,

and it glances there. The interior's own limit is lam = 1/max((8 sin x - sin 2x)/6) = 0.7287..., slightly above.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

import numpy as np
import pytest

from gks.modes import Verdict, analyse
from tests.literature.closures import half_line

INTERIOR = "u[i, n+1] = u[i, n-1] + lam/6*(-u[i+2] + 8*u[i+1] - 8*u[i-1] + u[i-2])"
OBLIQUE = half_line(INTERIOR, "u[0, n+1] = u[1]", "u[1, n+1] = u[2]", first=2)
SPACE = half_line(INTERIOR, "u[0, n+1] = u[1, n+1]", "u[1, n+1] = u[2, n+1]", first=2)
DIGITS = 10**12
LIMIT = 6 / (6 + Fraction(isqrt(6 * DIGITS**2), DIGITS))
"""The bound from above to twelve digits (the square root is rounded down)."""


@pytest.mark.parametrize(
    ("lam", "verdict"),
    [
        (Fraction(1, 2), Verdict.STABLE),
        (Fraction(71, 100), Verdict.STABLE),
        (LIMIT - Fraction(10, DIGITS), Verdict.STABLE),
        (LIMIT + Fraction(10, DIGITS), Verdict.GENERALIZED),
        (Fraction(72, 100), Verdict.GENERALIZED),
    ],
)
def test_oblique_extrapolation_loses_the_last_part_of_the_interval(lam: Fraction, verdict: Verdict) -> None:
    assert analyse(OBLIQUE, {"lam": lam}).verdict is verdict


def test_the_wave_that_enters_is_the_one_of_the_formula() -> None:
    found = analyse(OBLIQUE, {"lam": Fraction(72, 100)})
    waves = [m for m in found.modes if m.kind.value == "generalized"]
    for mode in waves:
        np.testing.assert_allclose(mode.z_complex.real, 4 - 3 / 0.72, rtol=1e-14)
        assert min(abs(complex(*map(float, k)) - mode.z_complex) for k in mode.kappa["R"]) < 1e-14
    assert len(waves) == 2


def test_beyond_the_interior_limit_the_interior_is_to_blame() -> None:
    assert analyse(OBLIQUE, {"lam": Fraction(73, 100)}).reason == "interior"


def test_space_extrapolation_meets_the_parasite_as_in_second_order() -> None:
    found = analyse(SPACE, {"lam": Fraction(1, 2)})
    assert found.verdict is Verdict.GENERALIZED
    assert [m.z_complex for m in found.modes if m.kind.value == "generalized"] == [-1]
