"""The kinds of a root map's roots, each against the exact analysis of its value; bounds of the errors of z."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import acb, acb_poly, ctx

from gks import catalogue
from gks.bounds.rootimages import Images, growth_factors
from gks.bounds.rootmap import rootmap
from gks.bounds.sweep import parse_sweep
from gks.errors import InputError
from gks.modes.analysis import analyse
from gks.modes.verdict import ModeKind
from gks.scheme.integrators import integrator
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import APART
from tests.literature.closures import CLOSURES, INTERIORS, half_line


def agrees(scheme: Scheme, spec: str, *, open_points: int = 0) -> set[ModeKind]:
    """Every point has the kind of the mode that is nearest; the kinds seen."""
    over = parse_sweep(spec)
    found = rootmap(scheme, scheme.values({}, [over.name]), over)
    seen: set[ModeKind] = set()
    left_open = 0
    for k, value in enumerate(over.values):
        try:
            modes = analyse(scheme, {**found.parameters, over.name: Fraction(value)}).modes
        except InputError:
            assert k in found.faults
            continue
        for point in (track.points[k] for track in found.tracks):
            if point is None:
                continue
            distance = [abs(mode.z_complex - point.z) for mode in modes]
            bound = max(2 * min(distance), point.error)
            near = {mode.kind for mode, each in zip(modes, distance, strict=True) if each <= bound}
            assert min(distance) < 1e-9 * max(1, abs(point.z))
            assert point.kind is None or point.kind in near, (value, point)
            if point.kind is None:
                left_open += 1
            else:
                seen.add(point.kind)
    assert left_open <= open_points
    return seen


def with_factor(interior: str, closure: str) -> Scheme:
    """A half-line whose closure at the new level has a parameter c."""
    return parse_scheme(
        f"""
title = "a factor that runs"
[parameters]
lam = {{ role = "cfl", default = "1/2" }}
c = {{ default = 1, range = [-inf, inf] }}
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["{INTERIORS[interior]}"]
first = 1
[closure]
equations = ["u[0, n+1] = {closure}"]
""",
        "factor",
    )


@pytest.mark.parametrize("interior", INTERIORS)
@pytest.mark.parametrize("closure", ["c*u[1, n+1]", "(1 + c)*u[1, n+1] - c*u[2, n+1]"])
def test_closures_of_one_equation(interior: str, closure: str) -> None:
    """Delta is one number, which is neither small nor large against the others."""
    scheme = with_factor(interior, closure)
    assert agrees(scheme, "c=1e-8:1e8:9:log") & {ModeKind.GROWING, ModeKind.DECAYING}
    agrees(scheme, "c=9/10:11/10:7")


@pytest.mark.parametrize("interior", INTERIORS)
def test_roots_next_to_each_other_keep_their_own_kinds(interior: str) -> None:
    """1 - c kappa beside 1 - kappa: at c = 1 - 1e-9 two roots are 1e-9 apart, and only one may be a mode."""
    scheme = with_factor(interior, "(1 + c)*u[1, n+1] - c*u[2, n+1]")
    agrees(scheme, "c=999999999/1000000000:1000000001/1000000000:5")


@pytest.mark.parametrize("interior", INTERIORS)
@pytest.mark.parametrize("closure", ["space-3", "oblique-1", "oblique-3", "one-sided", "box"])
def test_tiny_lam(interior: str, closure: str) -> None:
    agrees(half_line(interior, CLOSURES[closure]), "lam=1e-8:9/10:9:log", open_points=2)


@pytest.mark.parametrize("name", ["traditional-2", "average-1", "weighted-2-unequal", "implicit-1"])
def test_interfaces_at_extreme_values(name: str) -> None:
    scheme = catalogue.find(name)
    agrees(scheme, "lam=1e-8:1:5:log")
    agrees(scheme, "alpha=1e-8:1e8:5:log")


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson", "ab2", "bdf2", "rk4", "exact"])
@pytest.mark.parametrize("closure", ["3*u[1] - 3*u[2] + u[3]", "u[1]/2", "3*u[1]"])
@pytest.mark.parametrize("space", ["(u[i+1] - u[i-1])/2", "u[i+1] - u[i]"])
def test_the_method_of_lines(time: str, closure: str, space: str) -> None:
    agrees(half_line(f"dt(u[i]) = {space}", f"u[0] = {closure}", time=time), "lam=1e-6:9/10:5:log")


@pytest.mark.parametrize("space", ["upwind1", "central2", "lax-wendroff"])
@pytest.mark.parametrize("sweep", ["a=-1:1:6", "a=-1e-7:1e-7:4"])
def test_a_speed_that_changes_its_sign(space: str, sweep: str) -> None:
    interior = 'scheme = "lax-wendroff"' if space == "lax-wendroff" else f'space = "{space}"\ntime = "crank-nicolson"'
    text = f"""
title = "the speed changes its sign"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
a = {{ default = 1, range = [-inf, inf] }}
[interior]
{interior}
[domains.R]
side = "right"
unknowns = ["u"]
flux = [["a"]]
[closure]
equations = ["u[-1] = 3*u[0]"]
"""
    agrees(parse_scheme(text, "turning"), sweep)


def test_fewer_solutions_decay_inside_the_circle() -> None:
    """On the left none decays at the z that is the right half-line's mode."""
    assert agrees(APART, "lam=1/20:19/20:7") == {ModeKind.GROWING, ModeKind.DECAYING, ModeKind.INADMISSIBLE}


@pytest.mark.parametrize("name", ["leapfrog", "crank-nicolson", "ab2", "ab3", "bdf2", "ssprk3", "rk4"])
def test_growth_factors_are_as_near_as_they_say(name: str) -> None:
    method = integrator(name)
    sigma, radius, lam = np.array([-3 + 0.1j, 1e-9j, 0.5, 1 + 1e-9]), np.array([0.0, 0.0, 1e-7, 1e-12]), 0.75
    for offset in (0, 1, 1j, -1):
        found = growth_factors(method, Images(np.arange(4), sigma, radius, sigma, radius), lam)
        with ctx.workprec(200):
            for s, r, z, error in zip(found.sigma, found.radius, found.z, found.error, strict=True):
                mu = acb(complex(s)) * lam + acb(complex(offset)) * float(r) * lam
                rows = [
                    acb_poly([acb(c.numerator) / c.denominator for c in row])(mu) for row in method.characteristic()
                ]
                true = [complex(root) for root in acb_poly(rows).roots(tol=1e-30)]
                assert min(abs(z - root) for root in true) <= error
                assert error < 1e-5
