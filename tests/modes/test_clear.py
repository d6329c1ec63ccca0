"""Balls may prove that a lam is clear of modes; they must never say so where one is on the circle."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import fmpz_poly

from gks.bounds.cfl import stable_set
from gks.modes.algebraic import Root, isolated_roots
from gks.modes.analysis import quick_verdict
from gks.modes.cauchy_set import rationals_between
from gks.modes.clear import clear_of_modes
from gks.modes.critical import LamElimination, lam_elimination, positive_roots
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

LAX_WENDROFF = "u[i, n+1] = u[i] + lam/2*(u[i+1] - u[i-1]) + lam**2/2*(u[i+1] - 2*u[i] + u[i-1])"
INFLOW = LAX_WENDROFF.replace("lam/2*(u[i+1] - u[i-1])", "lam/2*(u[i-1] - u[i+1])")


def half_line(interior: str, closure: str) -> Scheme:
    return parse_scheme(
        f"""
title = "half-line"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["{interior}"]
first = 1
[closure]
equations = ["{closure}"]
""",
        "half-line",
    )


def eliminated(scheme: Scheme) -> LamElimination:
    return lam_elimination(normal_mode_problem(scheme, {"lam": Fraction(1, 3)}, ("lam",)))


def critical(scheme: Scheme) -> list[Root]:
    """The critical lam below the Cauchy limit 1."""
    return sorted({r.minimal for r in positive_roots(eliminated(scheme).polynomials()) if r < Root.of(1)})


@pytest.mark.parametrize(
    ("closure", "spot"),
    [
        # The boundary value is multiplied by z = 1 - 4 (lam - 1/2)**2 or 1 - (2 lam**2 - 1)**2: on the circle at one
        # lam.
        ("u[0, n+1] = (1 - 4*(lam - 1/2)**2)*u[0]", [-1, 2]),
        ("u[0, n+1] = (1 - (2*lam**2 - 1)**2)*u[0]", [-1, 0, 2]),
        # No value at lam = 1/2; a closure that says nothing there.
        ("u[0, n+1] = u[0]/(4*lam - 2)/10", [-1, 2]),
        ("(2*lam - 1)*u[0, n+1] = (2*lam - 1)*u[0]/2", [-1, 2]),
    ],
)
def test_a_lam_that_is_not_clear(closure: str, spot: list[int]) -> None:
    scheme = half_line(INFLOW, closure)
    (lam,) = [r for r in isolated_roots(fmpz_poly(spot)) if r.ball().real > 0]
    assert lam in critical(scheme)
    assert not clear_of_modes(eliminated(scheme), lam)


@pytest.mark.parametrize(
    ("weights", "degrees"),
    [
        ("5/2*u[1] - 4*u[2, n+1] + u[3]/4", [6]),
        ("u[1]/2 + u[2, n+1]/3", [4]),
        ("2*u[1] - u[2]", []),
        ("3*u[1] - 3*u[2, n+1] + u[3]", []),
        ("-u[1, n+1]/2 + u[2]", [7]),
        ("(1 + lam)*u[1] - lam*u[2]", []),
        ("-5/2*u[1] + 3/2*u[2, n+1]", [2]),
        ("4*u[1] - u[2, n+1]", [2]),
        ("-u[1, n+1]/2", [2]),
    ],
)
def test_between_stable_pieces_as_the_exact_route_has_it(weights: str, degrees: list[int]) -> None:
    """At every critical lam of a degree below 8 with stable lam on both sides that balls see to be harmless."""
    scheme = half_line(LAX_WENDROFF, f"u[0, n+1] = {weights}")
    spots = critical(scheme)
    beside = [quick_verdict(scheme, {"lam": lam}) is Verdict.STABLE for lam in rationals_between([*spots, Root.of(1)])]
    within = [lam for k, lam in enumerate(spots) if beside[k] and beside[k + 1] and lam.poly.degree() < 8]
    harmless = [lam for lam in within if clear_of_modes(eliminated(scheme), lam)]
    assert [lam.poly.degree() for lam in harmless] == degrees
    assert all(quick_verdict(scheme, {"lam": lam}) is Verdict.STABLE for lam in harmless)


@pytest.mark.parametrize(
    ("weights", "low"), [("5/2*u[1] - 4*u[2, n+1] + u[3]/4", None), ("-4*u[1] - 4*u[2, n+1] + u[3]/4", 0.2443438321437)]
)
def test_harmless_critical_lam_of_high_degree(weights: str, low: float | None) -> None:
    """The exact route takes minutes for those of degree 15; balls see that they are harmless inside the stable set."""
    scheme = half_line(LAX_WENDROFF, f"u[0, n+1] = {weights}")
    (interval,) = stable_set(scheme, {}).intervals
    assert interval.high == Root.of(1)
    assert (interval.low and float(interval.low.ball().real)) == (low and pytest.approx(low, abs=1e-12))
    inside = [r for r in critical(scheme) if interval.low is None or interval.low < r]
    wide = [r for r in inside if r.poly.degree() > 4]
    assert wide
    assert all(clear_of_modes(eliminated(scheme), r) for r in wide)
