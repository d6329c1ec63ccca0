"""Stable sets without elimination: the zeros s along their rays, and modes traced across the unit circle.

Where elimination is possible too, both have to say the same.
"""

from __future__ import annotations

from fractions import Fraction
from math import cos, pi, sin

import numpy as np
import pytest
from flint import acb
from hypothesis import given
from numpy.typing import NDArray

from gks import catalogue
from gks.bounds.cfl import StableSet, stable_set
from gks.bounds.crossings import crossings
from gks.bounds.curve import curve
from gks.bounds.located import Located
from gks.bounds.rayballs import stable_intervals_ball
from gks.bounds.wideset import wide_stable_set
from gks.catalogue.interfaces import UNIT, closure_lines, two_media
from gks.errors import InputError
from gks.modes.analysis import quick_verdict
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import ModeKind, Verdict
from gks.modes.wide import wide_modes
from gks.scheme.integrators import integrator
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import upwind_flux
from tests.examples import examples
from tests.literature.closures import CLOSURES, half_line
from tests.literature.inverse_lax_wendroff import beam_warming
from tests.oracle.scheme_texts import WEIGHTED, interface
from tests.strategies import Draft, scalar_drafts

ComplexArray = NDArray[np.complex128]
Array = NDArray[np.float64]


def agree(found: Located, exact: StableSet) -> None:
    assert found.undecided is None
    assert exact.undecided is None
    assert len(found.intervals) == len(exact.intervals)
    for span, interval in zip(found.intervals, exact.intervals, strict=True):
        for end, root, empty in ((span[0], interval.low, Fraction(0)), (span[1], interval.high, None)):
            if root is None:
                assert end == empty
                continue
            assert end is not None
            truth = Fraction(root.ball(120).real.mid().str(30, radius=False))
            assert abs(end - truth) <= Fraction(found.error) * truth + Fraction(1, 10**25)
    assert found.limited_by == exact.limited_by


# The theorem behind the rays ------------------------------------------------------------------------------------------

TIMES = ["forward-euler", "backward-euler", "crank-nicolson", "leapfrog", "ab2", "ab3", "bdf2", "rk2", "ssprk3", "rk4"]


@pytest.mark.parametrize("time", TIMES)
def test_in_the_left_half_plane_the_stable_part_of_a_ray_begins_at_zero(time: str) -> None:
    """In 100 directions with Re <= 0, the axes among them: one interval from 0 on, or none."""
    method = integrator(time)
    directions = [acb(0, 1), acb(-1)] + [
        acb(cos(phi), sin(phi)) for phi in (pi / 2 + pi / 2 * k / 99 for k in range(1, 99))
    ]
    for s in directions:
        found = stable_intervals_ball(method, s, 200)
        assert found is not None
        assert len(found) <= 1
        assert not found or found[0][0] == 0


def test_in_the_right_half_plane_it_need_not() -> None:
    found = stable_intervals_ball(integrator("rk4"), acb(0.02, 1), 200)
    assert found is not None
    assert found[0][0] > 1


@pytest.mark.parametrize("name", ["traditional-1", "traditional-2", "weighted-2", "implicit-1"])
def test_rays_against_elimination_for_the_interface(name: str) -> None:
    scheme = catalogue.find(name)
    values = scheme.values({"alpha": "7/3"})
    found = wide_stable_set(scheme, values)
    assert found.proved
    agree(found, stable_set(scheme, values))


@pytest.mark.parametrize("time", ["forward-euler", "ab2", "rk4", "bdf2"])
def test_rays_against_elimination_with_random_weights(time: str) -> None:
    scheme = interface(WEIGHTED, time, parameters='a = "1/3"\nb = "3/4"\nc = "-1/5"\nd = "1/2"\ne = "1/3"\nf = "2/7"')
    for alpha in ("1/7", "8"):
        values = scheme.values({"alpha": alpha})
        agree(wide_stable_set(scheme, values), stable_set(scheme, values))


# u[0] = k u[1] is kappa = 1/k; s = (1/kappa - kappa)/2 for central differences, 9/13 for the compact ones
GROWING_IN_TIME = [
    ("dt(u[i]) = (u[i-1] - u[i+1])/2", 3, "backward-euler", Fraction(3, 2)),  # abs(1 - lam s) > 1: lam > 2/s
    ("dt(u[i]) = (u[i-1] - u[i+1])/2", 3, "bdf2", Fraction(3)),  # z = -1 at lam s = 4
    ("dt(u[i+1])/4 + dt(u[i]) + dt(u[i-1])/4 = 3/4*(u[i-1] - u[i+1])", 2, "bdf2", Fraction(52, 9)),
]


@pytest.mark.parametrize(("equation", "factor", "time", "above"), GROWING_IN_TIME)
def test_a_mode_with_positive_real_s_is_stable_from_a_lam_on(
    equation: str, factor: int, time: str, above: Fraction
) -> None:
    """No limit of the interior to start from: the mode itself sets the scale."""
    scheme = half_line(equation, f"u[0] = {factor}*u[1]", time=time)
    found = wide_stable_set(scheme, {})
    ((low, high),) = found.intervals
    assert high is None
    assert abs(low - above) <= Fraction(found.error) * above
    agree(found, stable_set(scheme, {}))


def test_an_interior_that_is_never_stable() -> None:
    found = wide_stable_set(half_line("dt(u[i]) = (u[i+1] - u[i-1])/2", CLOSURES["space-0"], time="forward-euler"), {})
    assert (found.intervals, found.limited_by, found.undecided) == ((), "interior", None)


# Tracing --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("interior", ["lax-wendroff", "lax-friedrichs", "backward-euler"])
@pytest.mark.parametrize("closure", ["space-2", "oblique-1", "one-sided", "box"])
def test_tracing_against_elimination_for_classical_closures(interior: str, closure: str) -> None:
    scheme = half_line(interior, CLOSURES[closure])
    found = wide_stable_set(scheme, {})
    assert not found.proved
    agree(found, stable_set(scheme, {}))


@pytest.mark.parametrize(
    "case",
    [
        (5, 3, Fraction(1, 2)),
        (3, 1, Fraction(1, 2)),
        (4, 2, Fraction(1, 2)),
        (2, 1, Fraction(0)),
        (2, 1, Fraction(-1, 4)),
    ],
)
def test_tracing_finds_every_interval_of_inverse_lax_wendroff_closures(case: tuple[int, int, Fraction]) -> None:
    """Up to three intervals, with thresholds to twelve digits."""
    scheme = beam_warming(*case)
    found = wide_stable_set(scheme, {})
    agree(found, stable_set(scheme, {}))
    assert found.error < 1e-11


@pytest.mark.parametrize("order", [6, 8])
def test_wide_lax_wendroff_schemes_keep_their_whole_range(order: int) -> None:
    """Out of reach of elimination with lam as a symbol; stable for 0 < lam < 1 by Goldberg & Tadmor's theorem."""
    found = curve(catalogue.find(f"lax-wendroff-order-{order}-oblique"), {})
    (point,) = found.points
    assert (point.lam_max, point.limited_by, point.stable_set) == (1.0, "interior", ((0.0, 1.0),))
    assert found.to_json()["tier"] == "numeric"


def test_what_was_traced_is_no_proof() -> None:
    (point,) = curve(catalogue.find("lax-wendroff-order-8-oblique"), {}, certify=True).points
    assert not point.resolved
    assert point.lam_max is None
    assert "traced" in point.because


def test_neutral_bands_are_left_open_and_not_guessed() -> None:
    """Crank-Nicolson with oblique extrapolation has a mode on the circle for every lam > 2: no isolated crossing."""
    found = wide_stable_set(half_line("crank-nicolson", CLOSURES["oblique-0"]), {})
    assert found.undecided is not None
    assert found.intervals == ()


def moving(*zeros: tuple[float, float]) -> object:
    """Delta = prod (z - e^(i t) (1 + lam - l))(z - its conjugate): a pair crosses at t when lam = l, outwards."""

    def delta(z: ComplexArray, lam: Array) -> ComplexArray:
        value = np.ones_like(z)
        for angle, at in zeros:
            place = np.exp(1j * angle) * (1 + lam - at)
            value = value * (1 - place / z) * (1 - place.conj() / z)
        return value

    return delta


@pytest.mark.parametrize(
    "zeros",
    [
        [],
        [(1.0, 0.5)],
        [(1e-3, 0.25), (2.0, 0.26), (3.1, 0.9)],
        [(0.7, 1e-3), (0.7001, 0.999)],
        [(0.0, 0.3), (pi, 0.6)],
    ],
)
def test_crossings_of_a_delta_with_known_ones(zeros: list[tuple[float, float]]) -> None:
    found = crossings(moving(*zeros), 0.0, 1.0)  # type: ignore[arg-type]
    assert found.open_ is None
    if any(angle in (0.0, pi) for angle, _ in zeros):
        # Here two real zeros cross together, and Delta touches zero without a change of sign: a bound, not an answer.
        assert set(found.lams) <= {at for _, at in zeros}
        return
    np.testing.assert_allclose(found.lams, sorted(at for _, at in zeros), rtol=1e-11)


@pytest.mark.parametrize("extrapolated", [0, 1, 2, 3])
@pytest.mark.parametrize("lam", ["1/10", "1/1000", "1/100000", "1/10000000", "1/1000000000"])
def test_a_crossing_too_small_for_doubles_leaves_the_set_open(extrapolated: int, lam: str) -> None:
    """(1 - kappa)**n (1 - kappa/c) with c = (1 - lam)/(1 + lam): z = 1 for Lax-Friedrichs, unstable below that lam."""
    c = (1 - Fraction(lam)) / (1 + Fraction(lam))
    factors = [Fraction(1)]
    for root in [Fraction(1)] * extrapolated + [1 / c]:
        factors = [x - root * y for x, y in zip([*factors, Fraction(0)], [Fraction(0), *factors], strict=True)]
    closure = " + ".join(f"({-a})*u[{k}]" for k, a in enumerate(factors) if k)
    found = wide_stable_set(half_line("lax-friedrichs", f"u[0] = {closure}"), {})
    if found.undecided is None:
        ((low, high),) = found.intervals
        assert abs(low - Fraction(lam)) <= Fraction(found.error) * Fraction(lam)
        assert high == 1
    else:
        assert found.intervals == ()


def test_a_crossing_is_where_the_verdict_changes() -> None:
    scheme = beam_warming(5, 3, Fraction(1, 2))
    (low, high), *_ = wide_stable_set(scheme, {}).intervals
    assert low == 0
    assert high is not None
    step = Fraction(1, 10**11)
    below, above = (quick_verdict(scheme, {"lam": high * (1 + sign * step)}) for sign in (-1, 1))
    assert (below, above) == (Verdict.STABLE, Verdict.UNSTABLE)


@pytest.mark.parametrize("speed", ["1 - 2*lam", "lam - 3", "lam - 1/2"])
@pytest.mark.parametrize("closure", ["u[0]", "u[1]/2", "2*u[0] - u[1]"])
def test_where_a_speed_changes_its_sign_with_lam_another_scheme_begins(speed: str, closure: str) -> None:
    scheme = upwind_flux(speed, closure)
    found = wide_stable_set(scheme, scheme.values({}))
    if closure == "u[1]/2" and found.undecided is not None:  # a mode touches the circle inside
        assert "stable on either side of lam" in found.undecided
    else:
        agree(found, stable_set(scheme, scheme.values({})))


@given(scalar_drafts())
@examples(12)
def test_random_schemes_with_and_without_elimination(draft: Draft) -> None:
    """Random scalar interiors and closures: the same intervals, or nothing said."""
    scheme = draft.scheme()
    try:
        exact = stable_set(scheme, scheme.values({}))
    except InputError:
        return
    found = wide_stable_set(scheme, scheme.values({}))
    if found.undecided is None and exact.undecided is None:
        agree(found, exact)


@pytest.mark.parametrize("time", ["rk4", "ssprk3", "leapfrog", "crank-nicolson", "bdf2"])
def test_a_wave_trapped_without_loss_is_followed_along_its_ray(time: str) -> None:
    """Central differences, means continued evenly and differences oddly, impedances 1 : 4. The wave has s = 5i/4, which
    RK4 damps up to lam = sqrt(8)/1.25 and leapfrog never; by elimination and without."""
    pairs = [
        line
        for v in "us"
        for line in (f"L.{v}[1] + R.{v}[-1] = L.{v}[0] + R.{v}[0]", f"L.{v}[1] + L.{v}[0] = R.{v}[0] + R.{v}[-1]")
    ]
    parameters = 'lam = { role = "cfl", default = "1/2" }'
    methods = f'space = "central2"\ntime = "{time}"'
    text = two_media("trapped", parameters, methods, closure_lines(pairs), (UNIT, ("-1/4", "-4")))
    scheme = parse_scheme(text, "trapped")
    found = wide_stable_set(scheme, {})
    agree(found, stable_set(scheme, scheme.values({})))
    if time == "rk4":
        assert float(found.intervals[0][1] or 0) == pytest.approx(8**0.5 / 1.25, rel=1e-14)


def test_the_semi_discrete_problem_has_its_exact_point_at_s_zero() -> None:
    """Third-order upwinding whose inflow ghosts are extrapolated linearly: constants are a solution, at s = 0."""
    scheme = parse_scheme(
        """
title = "inflow without data"
[parameters]
lam = { role = "cfl", default = 1 }
[interior]
space = "upwind3"
time  = "exact"
[domains.R]
side     = "right"
unknowns = ["u"]
flux     = [["1"]]
[closure]
equations = ["u[-1] = 2*u[0] - u[1]", "u[-2] = 3*u[0] - 2*u[1]"]
""",
        "inflow",
    )
    found = wide_modes(normal_mode_problem(scheme, scheme.values({})))
    assert (found.doubts, found.certified) == ([], True)
    assert [(mode.z_complex, mode.kind) for mode in found.modes] == [(1, ModeKind.GENERALIZED)]
    assert wide_stable_set(scheme, scheme.values({})).intervals == ()
