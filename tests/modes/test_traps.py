"""The traps of normal-mode analysis: for each the right answer, and a naive way that goes wrong."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import prod

import numpy as np
import pytest

from gks import catalogue
from gks.bounds.cfl import stable_set
from gks.catalogue.interfaces import closure_lines, ghost_equations, two_media
from gks.errors import SchemeError
from gks.modes import Verdict, analyse
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.march import forced_response
from gks.solvers.update import update_matrix
from tests.literature.closures import half_line
from tests.oracle.finite_matrix import largest_modulus

HALF = {"lam": Fraction(1, 2)}
SPACE, OBLIQUE = "u[0, n+1] = u[1, n+1]", "u[0, n+1] = u[1]"
ONE_SIDED = "u[0, n+1] = u[0] + lam*(u[1] - u[0])"


def verdict(scheme: Scheme, **values: Fraction | int | str) -> Verdict:
    return analyse(scheme, scheme.values(values)).verdict


class TestLeapfrogWithExtrapolation:
    """No zero in abs(z) > 1; the mode z = -1, kappa = 1 is a wave with reversed group velocity that enters."""

    def test_generalized_eigenvalue_at_minus_one(self) -> None:
        found = analyse(half_line("leapfrog", SPACE), HALF)
        assert found.verdict is Verdict.GENERALIZED
        (mode,) = [m for m in found.modes if m.kind.value == "generalized"]
        assert mode.z_complex == -1
        assert mode.kappa["R"] == ((Fraction(1), Fraction(0)),)

    def test_its_neighbour_with_the_time_level_moved_is_stable(self) -> None:
        assert verdict(half_line("leapfrog", OBLIQUE), lam="1/2") is Verdict.STABLE

    def test_a_march_shows_it_only_when_forced(self) -> None:
        """Forced by (-1)**n at the boundary the answer grows linearly; free data stay bounded."""
        forced = forced_response(half_line("leapfrog", SPACE), HALF, -1 + 0j)
        assert abs(forced.exponent - 1) < 0.15
        kept = forced_response(half_line("leapfrog", OBLIQUE), HALF, -1 + 0j)
        assert abs(kept.exponent) < 0.15

    @pytest.mark.parametrize("eps", [1e-4, 1e-8, 1e-12])
    def test_no_perturbation_of_z_is_safe(self, eps: float) -> None:
        """Naive: move z to -(1 + eps), take the root with abs(kappa) < 1 and see whether the closure kappa = 1 nearly
        holds.

        kappa - 1 is about -eps/lam, so a small lam hides the mode from every eps.
        """
        lam = eps / 1000
        z = -(1 + eps)
        kappa = min(np.roots([1, -(z - 1 / z) / lam, -1]), key=abs)
        assert abs(kappa - 1) > 0.9
        assert verdict(half_line("leapfrog", SPACE), lam=Fraction(lam)) is Verdict.GENERALIZED

    def test_the_other_extreme(self) -> None:
        """Crank-Nicolson at lam = 1e12: z and kappa are within 2e-6 of -1, where z = -1 would give kappa = 0."""
        assert verdict(half_line("crank-nicolson", OBLIQUE), lam=10**12) is Verdict.GENERALIZED


class TestCrankNicolsonWithObliqueExtrapolation:
    def test_generalized_from_two_on_and_stable_below(self) -> None:
        scheme = half_line("crank-nicolson", OBLIQUE)
        tiny = Fraction(1, 10**50)
        assert verdict(scheme, lam="21/10") is verdict(scheme, lam=2) is Verdict.GENERALIZED
        assert verdict(scheme, lam=2 - tiny) is Verdict.STABLE
        (interval,) = stable_set(scheme, {}).intervals
        assert interval.low is None
        assert interval.high is not None
        assert interval.high.rational == 2

    def test_the_finite_matrix_says_unstable_and_less_so_with_more_cells(self) -> None:
        radii = [
            largest_modulus(half_line("crank-nicolson", OBLIQUE), {"lam": Fraction(21, 10)}, n) for n in (20, 40, 80)
        ]
        assert radii[0] > radii[1] > radii[2] > 1


class TestBackwardEulerWithAnExplicitBoundary:
    """z = -1, kappa = -1/3 at lam = 3/2: a decaying mode on the circle."""

    def test_neutral_between_stable_and_unstable(self) -> None:
        scheme = half_line("backward-euler", ONE_SIDED)
        tiny = Fraction(1, 10**600)
        assert verdict(scheme, lam=Fraction(3, 2) - tiny) is Verdict.STABLE
        assert verdict(scheme, lam=Fraction(3, 2) + tiny) is Verdict.UNSTABLE
        found = analyse(scheme, {"lam": Fraction(3, 2)})
        assert found.verdict is Verdict.NEUTRAL
        (mode,) = [m for m in found.modes if m.kind.value == "eigenvalue"]
        assert mode.z_complex == -1
        ((real, imaginary),) = mode.kappa["R"]
        assert float(real) == -1 / 3 and not imaginary

    def test_a_tolerance_calls_it_either_way(self) -> None:
        scheme = half_line("backward-euler", ONE_SIDED)
        seen = [
            largest_modulus(scheme, {"lam": lam}, 24) - 1
            for lam in (Fraction(3, 2), Fraction(3, 2) + Fraction(1, 10**13))
        ]
        assert max(map(abs, seen)) < 1e-10  # one is neutral, the other grows


class TestImpedanceWeightedCoupling:
    """r = 1/2 twice, semisimple; the mode would not decay."""

    SCHEME = catalogue.find("weighted-1")

    def test_one_root_of_multiplicity_two_that_is_no_mode(self) -> None:
        found = analyse(self.SCHEME, self.SCHEME.values({"alpha": 3}))
        (mode,) = found.modes
        assert (mode.multiplicity, mode.kind.value) == (2, "inadmissible") and not mode.z[1]
        assert abs(mode.z[0] - Fraction(11, 20)) <= mode.radius < Fraction(1, 10**20)
        assert found.verdict is Verdict.STABLE

    def test_a_float_root_finder_splits_it(self) -> None:
        """At any alpha the determinant is a square, 0.25 (2 r - 1)**2 up to sign; six digits in, two distinct roots."""
        roots = np.roots(np.array([4.0, -4.0, 1.0 + 2**-52]))
        assert abs(roots[0] - roots[1]) > 1e-9

    def test_the_finite_matrix_shows_another_number(self) -> None:
        radius = largest_modulus(self.SCHEME, self.SCHEME.values({"alpha": 3}), 40)
        assert radius > 0.6  # the spectrum of the truncated interior, not 0.55


class TestClosuresThatAreNone:
    def test_a_ghost_value_that_nothing_determines_is_named(self) -> None:
        with pytest.raises(SchemeError, match=r"u\[0\].* undetermined"):
            analyse(half_line("lax-wendroff", "u[1] = u[2]"), HALF)

    def test_elimination_alone_would_call_it_stable(self) -> None:
        """Delta = kappa (1 - kappa): the count fits, and the root z = kappa = 1 does not count."""
        z = np.roots([1, -1])  # of (z - 1)/8
        assert not np.any(abs(z[z != 1]) >= 1)

    @pytest.mark.parametrize("text", ["u[0, n+1] - u[1] = (u[0, n+1] - u[1])*(lam + 1/2)", "(lam - 1/2)*u[0] = 0"])
    def test_delta_identically_zero_is_an_error(self, text: str) -> None:
        scheme = half_line("lax-wendroff", text)
        with pytest.raises(SchemeError, match=r"degenerate|undetermined"):
            analyse(scheme, HALF)
        assert verdict(scheme, lam="1/3") is Verdict.STABLE


def coupled(interior: str) -> Scheme:
    """Each side's ghost cells take what the other side has next to the interface, whatever the materials."""
    closure = closure_lines(ghost_equations(1, 1, ("R.u[0]", "R.s[0]"), ("L.u[0]", "L.s[0]")))
    parameters = 'lam = { role = "cfl", default = 0.8 }\nalpha = 3'
    return parse_scheme(two_media("consistent coupling", parameters, interior, closure), "coupled")


class TestCrossingBranches:
    """At z = kappa = 1 of a wave system P_z = P_kappa = 0: an incoming and an outgoing branch."""

    @pytest.mark.parametrize("interior", ['scheme = "lax-wendroff"', 'scheme = "lax-friedrichs"'])
    @pytest.mark.parametrize("alpha", ["3", "1/3"])
    def test_a_consistent_coupling_is_not_generalized_for_that(self, interior: str, alpha: str) -> None:
        scheme = coupled(interior)
        found = analyse(scheme, scheme.values({"alpha": alpha}))
        assert found.verdict is Verdict.STABLE
        naive = [m for m in found.modes if abs(m.z_complex - 1) < 1e-12]
        assert naive, "the crossing point is among the roots, and only its branches say that it is harmless"
        assert {m.kind.value for m in naive} == {"inadmissible"}

    def test_equal_materials_are_one_line(self) -> None:
        """Under Lax-Wendroff the line is stable. Under leapfrog kappa = i has no group velocity: it fits both sides
        and is
        on both the limit of decaying ones, so the coupling has a generalized eigenvalue there.
        """
        damped = coupled('scheme = "lax-wendroff"')
        assert verdict(damped, alpha=1) is Verdict.STABLE
        neutral = coupled('space = "central2"\ntime = "leapfrog"')
        found = analyse(neutral, neutral.values({"alpha": "1"}))
        assert found.verdict is Verdict.GENERALIZED
        still = {(round(float(x), 12), round(float(y), 12)) for m in found.modes for x, y in m.kappa["R"]}
        assert still == {(0, 1), (0, -1)}


class TestExtremeRatios:
    def test_four_roots_of_the_second_order_coupling_at_1e10(self) -> None:
        """Held against 60 digits of the two quadratics' resultant, which the paper's polynomial factors give."""
        scheme = catalogue.find("traditional-2")
        found = analyse(scheme, scheme.values({"alpha": "1e10"}))
        moduli = sorted(float(m.modulus) for m in found.modes)
        assert len(moduli) == 4
        assert all(m.radius <= Fraction(1, 10**12) * m.modulus for m in found.modes)
        gaps = [abs(a.z_complex - b.z_complex) for a, b in pairwise(sorted(found.modes, key=lambda m: m.modulus))]
        assert max(gaps) / min(gaps) > 1e9

    def test_a_plain_determinant_has_no_value(self) -> None:
        huge = np.float64(1e300)
        with np.errstate(all="ignore"):
            naive = np.linalg.det(np.array([[huge**2, huge], [huge, huge**2]]))
        assert not abs(naive) < np.inf

    @pytest.mark.parametrize("alpha", ["1e-300", "1e300"])
    def test_ratios_near_the_end_of_the_doubles(self, alpha: str) -> None:
        """Traditional coupling, r = (1 +- sqrt(-alpha))/2, abs(z)**2 = 1 - lam + lam**2 (1 + alpha)/4."""
        scheme = catalogue.find("traditional-1")
        bound = min(Fraction(1), 4 / (1 + Fraction(alpha)))
        top = stable_set(scheme, scheme.values({"alpha": alpha})).lam_max
        assert top is not None
        assert top.rational == bound
        below, above = bound * (1 - Fraction(1, 10**600)), bound * (1 + Fraction(1, 10**600))
        assert verdict(scheme, alpha=alpha, lam=below) is Verdict.STABLE
        assert verdict(scheme, alpha=alpha, lam=above) is Verdict.UNSTABLE


class TestInteriorsThatAreNotCauchyStable:
    def test_no_zero_of_the_determinant_is_needed(self) -> None:
        """Forward Euler with central differences and u[0] = 0: the determinant is the constant 1."""
        scheme = half_line("u[i, n+1] = u[i] + lam/2*(u[i+1] - u[i-1])", "u[0] = 0")
        found = analyse(scheme, HALF)
        assert (found.verdict, found.reason, found.modes) == (Verdict.UNSTABLE, "interior", ())

    def test_interior_outranks_closure(self) -> None:
        scheme = half_line("lax-wendroff", "u[0, n+1] = 3*u[0]")
        assert analyse(scheme, {"lam": Fraction(11, 10)}).reason == "interior"
        assert analyse(scheme, {"lam": Fraction(9, 10)}).reason == "closure"


class TestCollidingSpatialRoots:
    def test_beam_warming_at_one_half_has_no_mode_at_three_halves(self) -> None:
        """kappa = 1/3 twice at z = 3/2. Eigenvectors 1, kappa_1**i and 1, kappa_2**i are then equal, and their
        determinant
        (Vandermonde) vanishes there: a mode that is none."""
        interior = "u[i, n+1] = u[i] - lam/2*(3*u[i] - 4*u[i-1] + u[i-2]) + lam**2/2*(u[i] - 2*u[i-1] + u[i-2])"
        found = analyse(half_line(interior, "u[0] = 0", "u[1] = 0", first=2), HALF)
        assert (found.verdict, found.modes) == (Verdict.STABLE, ())
        kappas = np.roots([1.5 - 0.375, -0.75, 0.125])
        assert abs(np.linalg.det(np.vander(kappas))) < 1e-6


def high_order_lax_wendroff(half_width: int) -> str:
    """Interpolation at x + lam through 2 r + 1 points: order 2 r in space and time for u_t = u_x."""
    points = range(-half_width, half_width + 1)
    terms = []
    for j in points:
        top = "*".join(f"(lam - ({m}))" for m in points if m != j)
        terms.append(f"{top}/({prod(j - m for m in points if m != j)})*u[i{'+' if j >= 0 else '-'}{abs(j)}]")
    return "u[i, n+1] = " + " + ".join(terms)


@pytest.mark.parametrize("half_width", [2, 3, 4])
def test_lax_wendroff_up_to_order_eight(half_width: int) -> None:
    """With oblique extrapolation kappa = z, and no such root is outside; a symbolic determinant takes a minute at r
    = 4.
    """
    closure = [f"u[{k}, n+1] = u[{k + 1}]" for k in range(half_width)]
    scheme = half_line(high_order_lax_wendroff(half_width), *closure, first=half_width)
    found = analyse(scheme, {"lam": Fraction(9, 10)})
    assert found.verdict is Verdict.STABLE
    assert largest_modulus(scheme, {"lam": Fraction(9, 10)}, 16) < 1 + 1e-9


def test_a_shared_branch_is_no_degenerate_closure() -> None:
    """Lax-Wendroff at lam = 1: kappa = z solves interior and closure for every z, and never decays."""
    assert verdict(half_line("lax-wendroff", OBLIQUE), lam=1) is Verdict.STABLE


def test_a_mode_where_a_cleared_denominator_vanishes() -> None:
    """Third-order upwind under Crank-Nicolson, ghosts that change sign each step: z = -1 with kappa = 0 twice. There
    the
    symbol's leading coefficient in kappa vanishes, which elimination clears: dropping its powers drops the mode."""
    scheme = half_line(
        "dt(u[i]) = -(2*u[i+1] + 3*u[i] - 6*u[i-1] + u[i-2])/6",
        "u[0, n+1] = -u[0]",
        "u[1, n+1] = -u[1]",
        first=2,
        time="crank-nicolson",
    )
    assert verdict(scheme) is Verdict.NEUTRAL
    assert np.abs(np.linalg.eigvals(update_matrix(scheme, HALF, 30)) + 1).min() < 1e-9
