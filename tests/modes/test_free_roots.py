"""A square root of a parameter: exact at any value of it, and no polynomial in it where it is left free."""

from fractions import Fraction

import pytest
from flint import acb, fmpq

from gks.bounds.curve import curve
from gks.bounds.sweep import parse_sweep
from gks.errors import NotAnalysable
from gks.modes import analyse
from gks.modes.algebraic import newton_refined
from gks.modes.derivation import derive
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

FILE = """
title = "speed sqrt(k)"
[parameters]
lam = {{ role = "cfl", default = "1/2" }}
k = {{ default = 2 }}
[interior]
space = "upwind1"
time = "{time}"
[domains.R]
side = "right"
unknowns = {unknowns}
flux = {flux}
[closure]
equations = {closure}
"""
SCALAR = FILE.format(time="forward-euler", unknowns='["u"]', flux='[["sqrt(k)"]]', closure='["u[-1] = u[0]/2"]')
SYSTEM = FILE.format(
    time="forward-euler",
    unknowns='["u", "s"]',
    flux='[["0", "-1/sqrt(k)"], ["-k", "0"]]',
    closure='["u[-1] = 0", "s[-1] = s[0]"]',
)


def speed_of(text: str) -> int:
    """The speed is k to this power over four."""
    return {SCALAR: 2, SYSTEM: 1}[text]


def read(text: str) -> Scheme:
    return parse_scheme(text, "free root")


@pytest.mark.parametrize("text", [SCALAR, SYSTEM])
def test_a_sweep_takes_every_value_by_itself(text: str) -> None:
    """First-order upwinding is stable up to lam * speed = 1, under a closure that reflects less than it gets."""
    points = curve(read(text), {"lam": Fraction(1, 2), "k": Fraction(2)}, parse_sweep("k=1:5:5")).points
    for point, k in zip(points, range(1, 6), strict=True):
        assert point.lam_max == pytest.approx(k ** (-speed_of(text) / 4), rel=1e-12)


@pytest.mark.parametrize("text", [SCALAR, SYSTEM])
def test_no_polynomial_is_derived_where_it_is_free(text: str) -> None:
    scheme = read(text)
    with pytest.raises(NotAnalysable, match="a square root of k, left free; set it with -p"):
        derive(scheme, scheme.values({}, ["lam", "k"]))


def test_a_ball_that_is_far_wider_than_its_root_is_not_refined() -> None:
    """Around 0 its relative accuracy is minus a huge number, which no working precision doubles."""
    wide = acb(0, 0) + acb("0 +/- 1e300")
    assert newton_refined(wide, 64, lambda x: (x - acb(fmpq(1, 10**700)), acb(1))) is None


def test_a_coefficient_of_1e_minus_700() -> None:
    """u[-1] = q u[0] on an upwind scheme: z = 1 - lam (1 - q) is no mode, as kappa = 1/q does not decay."""
    text = SCALAR.replace("sqrt(k)", "1").replace("u[0]/2", "1e-700*u[0]")
    scheme = read(text)
    assert analyse(scheme, scheme.values({})).verdict is Verdict.STABLE
