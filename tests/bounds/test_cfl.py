"""Exact stable sets: their ends, what limits them, isolated unstable lam, and random lam against the verdict itself."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, reject
from hypothesis import strategies as st

from gks import catalogue
from gks.bounds.cfl import StableSet, stable_set
from gks.errors import InputError, SchemeError
from gks.modes import Verdict, analyse
from gks.modes.algebraic import Root
from gks.scheme.model import Scheme
from tests.bounds.theorem_schemes import upwind_flux
from tests.examples import examples
from tests.literature.closures import CLOSURES, half_line
from tests.strategies import DISCRETE, Draft, scalar_drafts

UPWIND = "u[i, n+1] = u[i] - lam*(u[i] - u[i-1])"
TINY = Fraction(1, 10**40)


def ends(found: StableSet) -> list[Fraction | float | None]:
    """Low and high ends, exact where rational; None for 0 and infinity."""
    every = [end for interval in found.intervals for end in (interval.low, interval.high)]
    return [None if end is None else end.rational or float(end.ball().real.mid()) for end in every]


def inflow(closure: str, interior: str = UPWIND, time: str = "") -> Scheme:
    return half_line(interior, closure, first=0, time=time)


def inside(found: StableSet, lam: Fraction) -> bool:
    point = Root.of(lam)
    return any((i.low is None or i.low < point) and (i.high is None or point < i.high) for i in found.intervals)


def at_end(found: StableSet, lam: Fraction) -> bool:
    point = Root.of(lam)
    return any(end is not None and end == point for i in found.intervals for end in (i.low, i.high))


class TestAgainstTheVerdict:
    @given(scalar_drafts(), st.lists(st.integers(1, 80), min_size=6, max_size=6))
    @examples(25, [HealthCheck.too_slow, HealthCheck.filter_too_much])
    def test_random_lam(self, draft: Draft, samples: list[int]) -> None:
        """Of one-step and leapfrog updates, whose critical polynomials are small."""
        assume(len(draft.closure) == 1 and not draft.lines[0].named)
        scheme = draft.scheme()
        try:
            found = stable_set(scheme, {})
        except InputError:
            reject()
        assert found.undecided is None
        for k in samples:
            lam = Fraction(k, 20)
            verdict = analyse(scheme, {"lam": lam}).verdict
            if verdict is Verdict.STABLE:
                # Stable points that are no interval are left out, and only such.
                assert inside(found, lam) or at_end(found, lam) or _isolated(scheme, lam)
            else:
                assert not inside(found, lam)

    @pytest.mark.parametrize("closure", ["space-0", "oblique-0", "oblique-1", "one-sided", "one-sided-implicit", "box"])
    def test_the_classical_limits(self, closure: str) -> None:
        """The table of tests/literature as sets."""
        unlimited = ([None, None], None)
        expected = {
            ("leapfrog", "space-0"): ([], "closure"),
            ("crank-nicolson", "oblique-0"): ([None, 2], "closure"),
            ("crank-nicolson", "oblique-1"): ([None, 2], "closure"),
            ("crank-nicolson", "one-sided"): ([None, 2], "closure"),
            ("backward-euler", "one-sided"): ([None, Fraction(3, 2)], "closure"),
        }
        for interior in ("leapfrog", "lax-wendroff", "lax-friedrichs", "crank-nicolson", "backward-euler"):
            found = stable_set(half_line(interior, CLOSURES[closure]), {})
            explicit = interior in ("leapfrog", "lax-wendroff", "lax-friedrichs")
            default = ([None, 1], "interior") if explicit else unlimited
            assert (ends(found), found.limited_by) == expected.get((interior, closure), default), interior


def _isolated(scheme: Scheme, lam: Fraction) -> bool:
    return all(analyse(scheme, {"lam": lam + shift}).verdict is not Verdict.STABLE for shift in (-TINY, TINY))


class TestIsolatedLam:
    def test_an_unstable_lam_splits_the_interval_and_ends_lam_max(self) -> None:
        """z = 1 - 4 (lam - 1/2)**2 for a boundary value that feeds the interior: z = kappa = 1 at lam = 1/2 alone."""
        scheme = inflow("u[-1, n+1] = (1 - 4*(lam - 1/2)**2)*u[-1]")
        found = stable_set(scheme, {})
        assert ends(found) == [None, Fraction(1, 2), Fraction(1, 2), 1]
        assert found.lam_max is not None
        assert found.lam_max.rational == Fraction(1, 2)
        assert found.limited_by == "closure"
        assert analyse(scheme, {"lam": Fraction(1, 2)}).verdict is Verdict.GENERALIZED
        assert analyse(scheme, {"lam": Fraction(1, 2) + TINY}).verdict is Verdict.STABLE

    def test_at_an_irrational_lam_too(self) -> None:
        found = stable_set(inflow("u[-1, n+1] = (1 - (2*lam**2 - 1)**2)*u[-1]"), {})
        np.testing.assert_allclose([float(e) for e in ends(found) if e is not None], [2**-0.5, 2**-0.5, 1])

    def test_a_set_that_does_not_begin_at_zero_has_no_lam_max(self) -> None:
        """z = 1/2 + 16 (lam - 1/2)**2, below 1 within sqrt(1/32) of lam = 1/2."""
        found = stable_set(inflow("u[-1, n+1] = (1/2 + 16*(lam - 1/2)**2)*u[-1]"), {})
        low, high = (float(e) for e in ends(found) if e is not None)
        np.testing.assert_allclose([low, high], [0.5 - 32**-0.5, 0.5 + 32**-0.5])
        assert found.lam_max is not None
        assert found.lam_max.is_zero

    @pytest.mark.parametrize(
        "closure",
        ["(lam - 1/2)*u[-1] = 0", "(2*lam - 1)*u[-1] = (2*lam - 1)*u[0]/3", "u[-1] = u[0]/3*(lam - 1/2)/(lam - 1/2)"],
    )
    @pytest.mark.parametrize("interior", [(UPWIND, ""), ("dt(u[i]) = -(u[i] - u[i-1])", "forward-euler")])
    def test_a_lam_without_a_scheme_splits_it_as_well(self, closure: str, interior: tuple[str, str]) -> None:
        """Degenerate, or a division by zero, at lam = 1/2 only."""
        found = stable_set(inflow(closure, *interior), {})
        assert ends(found) == [None, Fraction(1, 2), Fraction(1, 2), 1]

    def test_a_closure_that_is_degenerate_for_every_lam_is_an_error(self) -> None:
        """Two ghosts, and twice the same equation for them."""
        interior = "u[i, n+1] = u[i] - lam/2*(3*u[i] - 4*u[i-1] + u[i-2]) + lam**2/2*(u[i] - 2*u[i-1] + u[i-2])"
        scheme = half_line(interior, "u[-1] = 2*u[-2]", "lam*u[-1] = 2*lam*u[-2]", first=0)
        with pytest.raises(SchemeError, match=r"degenerate|undetermined"):
            stable_set(scheme, {})


class TestWhatLimits:
    def test_both_at_once_is_the_interior(self) -> None:
        """Traditional coupling at alpha = 3: 4/(1 + alpha) = 1, the interior's own limit."""
        scheme = catalogue.find("traditional-1")
        for alpha, bound, by in (
            ("3", Fraction(1), "interior"),
            ("31/9", Fraction(9, 10), "closure"),
            ("1", 1, "interior"),
        ):
            found = stable_set(scheme, scheme.values({"alpha": alpha}))
            assert (ends(found), found.limited_by) == ([None, bound], by)

    def test_nothing_limits_an_implicit_scheme(self) -> None:
        found = stable_set(half_line("backward-euler", CLOSURES["box"]), {})
        assert (ends(found), found.limited_by, found.lam_max) == ([None, None], None, None)

    def test_an_interior_that_is_never_stable(self) -> None:
        found = stable_set(half_line("u[i, n+1] = u[i] + lam/2*(u[i+1] - u[i-1])", "u[0] = 0"), {})
        assert (found.intervals, found.limited_by) == ((), "interior")

    @pytest.mark.parametrize(
        ("time", "limit"),
        [
            ("forward-euler", 1),
            ("rk2", 1),
            ("ssprk3", 1.2563726633091645),
            ("rk4", 1.3926467817026410),
            ("ab2", 0.5),
            ("backward-euler", None),
            ("crank-nicolson", None),
            ("bdf2", None),
        ],
    )
    def test_upwinding_under_each_integrator(self, time: str, limit: float | None) -> None:
        """The real axis: abs(R(-2 lam)) = 1, the stability intervals 2, 2, 2.5127, 2.7853 and 1 halved."""
        found = stable_set(inflow("u[-1] = 0", "dt(u[i]) = -(u[i] - u[i-1])", time), {})
        assert found.limited_by == (None if limit is None else "interior")
        (low, high) = ends(found)
        assert low is None
        assert (high is None) if limit is None else abs(float(high or 0) / limit - 1) < 1e-15


def test_ends_are_exact_at_any_size() -> None:
    scheme = catalogue.find("traditional-1")
    for alpha in (Fraction(10) ** 300, Fraction(10) ** 300 + Fraction(1, 7), Fraction(10**40 + 1, 3)):
        found = stable_set(scheme, scheme.values({"alpha": alpha}))
        assert ends(found) == [None, 4 / (1 + alpha)]


def test_the_interiors_drawn_are_the_ones_named() -> None:
    assert {"leapfrog", "crank-nicolson"} <= set(DISCRETE)


@pytest.mark.parametrize("a", [Fraction(2), Fraction(1, 3), Fraction(-1)])
@pytest.mark.parametrize("closure", ["u[0]/2", "u[0]"])
def test_stable_sets_where_a_wave_speed_changes_its_sign_with_lam(a: Fraction, closure: str) -> None:
    """Upwinding follows the sign: below and above lam = 1/a there are two schemes on one axis."""
    scheme = upwind_flux("1 - a*lam", closure)
    found = stable_set(scheme, scheme.values({"a": a}))
    for lam in (Fraction(k, 7) for k in range(1, 40, 2)):
        verdict = analyse(scheme, scheme.values({"a": a, "lam": lam})).verdict
        assert at_end(found, lam) or inside(found, lam) is (verdict is Verdict.STABLE)
