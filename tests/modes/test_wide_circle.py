"""Modes on the unit circle under interiors too wide for elimination: glancing waves at walls, trapped waves at
interfaces.

A symbol that conserves energy has waves of zero group velocity. For the fourth-order central difference of u_t = s_x,
s_t = u_x, whose waves have omega = sin(xi) (4 - cos(xi))/3 / dx, that is at cos(xi) = 1 - sqrt(3/2): kappa is a square
root in lam*s = i lam omega there, a decaying root meets one that grows, and Delta has a branch point.
"""

from __future__ import annotations

from cmath import exp, phase, sqrt
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest
import sympy
from flint import acb, arb, ctx
from hypothesis import given
from hypothesis import strategies as st

from gks.bounds.wideset import wide_stable_set
from gks.catalogue.interfaces import UNIT, closure_lines, two_media
from gks.errors import InputError
from gks.modes import analysis
from gks.modes.admissible import admissible, point_of
from gks.modes.algebraic import Position, Root
from gks.modes.analysis import analyse, eliminated, quick_verdict
from gks.modes.candidates import candidates_of
from gks.modes.chart import chart_of
from gks.modes.conjugates import _sizes, smallest_exponent, vanishes
from gks.modes.dependence import _smallest, nullity
from gks.modes.fibre import fibre
from gks.modes.glancing import GlancingPoints
from gks.modes.kreiss import Block, NormalModeProblem, normal_mode_problem
from gks.modes.recognised import _shortest
from gks.modes.reversal import reversible
from gks.modes.tables import disc_tables
from gks.modes.verdict import ModeKind, Verdict
from gks.modes.wide import WideModes, wide_modes
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.runs import forced_response
from gks.solvers.update import update_matrix
from tests.examples import examples
from tests.oracle.finite_matrix import growing_modulus, largest_modulus
from tests.oracle.scheme_texts import traditional

COSINE = 1 - (3 / 2) ** 0.5
"""cos(xi) of the wave of the fourth-order difference that does not move."""
OMEGA = (1 - COSINE**2) ** 0.5 * (4 - COSINE) / 3

MIRROR = ("u[-1] = -u[0]", "s[-1] = s[0]", "u[-2] = -u[1]", "s[-2] = s[1]")
"""A wall, u = 0: odd and even continuation, under which the half-line is half of a whole line."""
EXTRAPOLATED = ("u[-1] = -u[0]", "s[-1] = s[0]", "u[-2] = -u[1]", "s[-2] = s[0]")
"""A wall with one value of s extrapolated instead."""

COPIED = tuple(
    line
    for v in ("u", "s")
    for m in (1, 2)
    for line in (f"L.{v}[{m}] = R.{v}[{m - 1}]", f"R.{v}[-{m}] = L.{v}[{1 - m}]")
)
"""No interface at all where both media are the same."""
JUMPS = tuple(
    line
    for v in ("u", "s")
    for m in (1, 2)
    for line in (
        f"L.{v}[{m}] + R.{v}[-{m}] = L.{v}[{1 - m}] + R.{v}[{m - 1}]",
        f"L.{v}[{m}] + L.{v}[{1 - m}] = R.{v}[{m - 1}] + R.{v}[-{m}]",
    )
)
"""Means of u and s continued evenly across the interface, their differences oddly."""


def wall(time: str, closure: Sequence[str], lam: str = "1/2", space: str = "central4") -> Scheme:
    return parse_scheme(
        f"""
title = "wall"
[parameters]
lam = {{ role = "cfl", default = "{lam}" }}
[interior]
space = "{space}"
time = "{time}"
[domains.R]
side = "right"
unknowns = ["u", "s"]
flux = [["0", "-1"], ["-1", "0"]]
[closure]
equations = [{", ".join(f'"{each}"' for each in closure)}]
""",
        "wall",
    )


def media(time: str, closure: Sequence[str], alpha: str, lam: str = "1/2", speed: str = "1") -> Scheme:
    text = two_media(
        "two media",
        f'lam = {{ role = "cfl", default = "{lam}" }}\nalpha = "{alpha}"\nc = "{speed}"',
        f'space = "central4"\ntime = "{time}"',
        closure_lines(closure),
        (UNIT, ("-c/alpha", "-alpha*c")),
    )
    return parse_scheme(text, "media")


def problem_of(scheme: Scheme) -> NormalModeProblem:
    return normal_mode_problem(scheme, scheme.values({}))


def counted(scheme: Scheme) -> WideModes:
    return wide_modes(problem_of(scheme))


def on_circle(found: WideModes) -> list[complex]:
    """The modes on the circle in the upper half-plane, by multiplicity."""
    kinds = (ModeKind.EIGENVALUE, ModeKind.GENERALIZED)
    return [m.z_complex for m in found.modes if m.kind in kinds and m.z_complex.imag > 0 for _ in range(m.multiplicity)]


def glancing_growth(time: str, lam: float) -> complex:
    """z of the wave that does not move, in the upper half-plane, z near 1 as lam -> 0."""
    mu = complex(0, lam * OMEGA)
    if time == "leapfrog":  # z - 1/z = 2 mu
        return mu + sqrt(mu * mu + 1)
    return (1 + mu / 2) / (1 - mu / 2) if time == "crank-nicolson" else exp(mu)


# Glancing waves -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson", "exact"])
def test_the_wave_along_a_wall_is_a_generalized_eigenvalue(time: str) -> None:
    """Half of the whole line's standing wave: the one place where the Kreiss condition fails, by the closed form."""
    found = counted(wall(time, MIRROR))
    assert (found.certified, found.doubts) == (True, [])
    assert all(mode.kind is ModeKind.GENERALIZED and abs(mode.modulus - 1) == 0 for mode in found.modes)
    modes = on_circle(found)
    expected = glancing_growth(time, 0.5)
    expected = expected if expected.imag > 0 else expected.conjugate()
    wanted = [expected, -expected.conjugate()] if time == "leapfrog" else [expected]
    assert sorted(modes, key=phase) == pytest.approx(sorted(wanted, key=phase), abs=1e-14)


def test_forcing_it_grows_with_the_square_root_of_time() -> None:
    """The march's word: forced at the glancing frequency the wall resonates, and beside it or with the other closure
    it does not."""
    scheme, z = wall("crank-nicolson", MIRROR), glancing_growth("crank-nicolson", 0.5)
    values = scheme.values({})
    assert forced_response(scheme, values, z).exponent == pytest.approx(0.5, abs=0.15)
    assert forced_response(scheme, values, z * exp(-0.5j)).exponent < 0.2
    assert forced_response(wall("crank-nicolson", EXTRAPOLATED), values, z).exponent < 0.2


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson", "exact"])
def test_a_branch_point_is_no_mode(time: str) -> None:
    """With one value extrapolated Delta is not zero where the roots meet, and nothing else is on the circle."""
    found = counted(wall(time, EXTRAPOLATED))
    assert found.certified
    assert not on_circle(found)
    assert quick_verdict(wall(time, EXTRAPOLATED), {"lam": Fraction(1, 2)}) is Verdict.STABLE


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson", "exact"])
def test_no_interface_has_two(time: str) -> None:
    """The whole line cut in two: the standing waves of both characteristic fields, at the same z."""
    found = counted(media(time, COPIED, "1"))
    assert found.certified
    assert {(mode.kind, mode.multiplicity) for mode in found.modes} == {(ModeKind.GENERALIZED, 2)}


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson"])
def test_elimination_says_the_same(time: str) -> None:
    """At second order both can be done: the count of zeros at a wall against the roots of the norm."""
    scheme = wall(time, MIRROR[:2], "1/3", "central2")
    exact = analysis._eliminated(problem_of(scheme), inner=False).modes
    found = counted(scheme)
    assert found.certified
    kept = [m.z_complex for m in exact if m.kind is ModeKind.GENERALIZED and m.z_complex.imag > 0]
    assert kept
    assert sorted(on_circle(found), key=phase) == pytest.approx(sorted(kept, key=phase), abs=1e-14)


@given(st.lists(st.integers(-3, 3), min_size=12, max_size=12), st.sampled_from(["leapfrog", "crank-nicolson"]))
@examples(12)
def test_random_walls_against_the_finite_matrix(weights: list[int], time: str) -> None:
    """Ghost values from three cells with random weights, half of them conserving nothing: what grows in the finite
    problem is a mode, with its modulus; where nothing is found to grow, nothing does."""
    parts = [" + ".join(f"({w}/2)*u[{k}]" for k, w in enumerate(weights[3 * j : 3 * j + 3])) for j in range(4)]
    closure = [f"{name} = {part.replace('u[', name[0] + '[')}" for name, part in zip(GHOSTS, parts, strict=True)]
    scheme = wall(time, closure)
    try:
        found = counted(scheme)
    except InputError:
        return
    growing = max((m for m in found.modes if m.kind is ModeKind.GROWING), key=lambda m: m.modulus, default=None)
    seen = growing_modulus(scheme, scheme.values({}), 24)
    if seen is not None and seen > 1 + 1e-4:
        assert growing is not None
        assert float(growing.modulus) == pytest.approx(seen, rel=1e-5)
    elif growing is not None:
        # The finite problem sees it as far as it fits into its cells.
        widest = max(abs(complex(*map(float, x))) for x in growing.kappa["R"])
        assert widest**24 > 1e-4 or float(growing.modulus) == pytest.approx(
            largest_modulus(scheme, scheme.values({}), 48), rel=1e-3
        )


GHOSTS = ("u[-1]", "s[-1]", "u[-2]", "s[-2]")


# Trapped waves --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("time", ["leapfrog", "crank-nicolson", "exact"])
def test_a_wave_trapped_at_an_interface_is_neutral(time: str) -> None:
    """Media of impedance 1 and 4, coupled without loss: a mode with abs(z) = 1 exactly, at no rational point."""
    found = counted(media(time, JUMPS, "4"))
    assert found.certified
    kinds = [mode.kind for mode in found.modes]
    assert kinds.count(ModeKind.EIGENVALUE) == (4 if time == "leapfrog" else 2)
    for mode in found.modes:
        assert mode.modulus == 1
        if mode.kind is ModeKind.EIGENVALUE:
            assert all(abs(complex(*map(float, x))) < 1 for x in mode.kappa["R"])
            assert all(abs(complex(*map(float, x))) > 1 for x in mode.kappa["L"])


def test_four_stages_damp_a_trapped_wave() -> None:
    """With s = i omega in continuous time it is stable for lam below sqrt(8)/omega: RK4 holds that much of the axis."""
    (wave,) = (m for m in counted(media("exact", JUMPS, "4")).modes if m.kind is ModeKind.EIGENVALUE and m.z[1] > 0)
    omega = phase(wave.z_complex) / 0.5
    found = wide_stable_set(media("rk4", JUMPS, "4"), {"alpha": Fraction(4), "c": Fraction(1)})
    assert (found.proved, found.limited_by) == (True, "closure")
    ends = [float(end) for span in found.intervals for end in span if end is not None]
    assert ends == pytest.approx([0.0, 8**0.5 / omega], rel=1e-12)


def test_the_finite_problem_has_it_on_the_circle() -> None:
    """Its kappas are 0.11 and 0.54: forty cells a side hold it to all digits."""
    scheme = media("leapfrog", JUMPS, "4")
    values = scheme.values({})
    spectrum = np.linalg.eigvals(update_matrix(scheme, values, 40))
    for mode in counted(scheme).modes:
        if mode.kind is ModeKind.EIGENVALUE:
            nearest = spectrum[np.abs(spectrum - mode.z_complex).argmin()]
            assert abs(nearest - mode.z_complex) < 1e-10
            assert abs(nearest) == pytest.approx(1, abs=1e-10)


def test_what_is_not_recognised_is_left_open() -> None:
    """Traditional coupling is neutral at lam = 4/(1 + alpha). With 120 digits of alpha its z is a root of polynomials
    longer than the digits that are looked at: the count says how close it is to the circle, elimination decides."""
    alpha = Fraction(31, 9) + Fraction(1, 10**120)
    scheme = traditional()
    values = scheme.values({"lam": str(4 / (1 + alpha)), "alpha": str(alpha)})
    found = wide_modes(normal_mode_problem(scheme, values))
    assert not found.certified
    assert "not told from abs(z) = 1" in found.doubts[0]
    assert analyse(scheme, values).verdict is Verdict.NEUTRAL


def test_a_hair_off_the_neutral_point_is_not_taken_for_it() -> None:
    """1e-40 to either side: told by balls, and on its own side."""
    for sign, kind in ((1, ModeKind.GROWING), (-1, ModeKind.DECAYING)):
        scheme = traditional()
        values = scheme.values({"lam": "9/10", "alpha": str(Fraction(31, 9) + sign * Fraction(1, 10**40))})
        found = wide_modes(normal_mode_problem(scheme, values))
        assert found.certified
        assert {mode.kind for mode in found.modes} == {kind}


# The means ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("number", "polynomial"),
    [("2", [2, -1]), ("sqrt(2)", [2, 0, -1]), ("sqrt(2)*I + 1/3", [19, -6, 9]), ("(1 + sqrt(5))*I/2", [1, 0, 3, 0, 1])],
)
def test_algebraic_numbers_are_recognised(number: str, polynomial: list[int]) -> None:
    found = _shortest(ball(number, 768))
    assert found is not None
    coefficients = [int(c) for c in found]
    assert coefficients in (polynomial, [-c for c in polynomial])


@pytest.mark.parametrize("number", ["pi", "pi + I*E", "2**Rational(1, 23)"])
def test_others_are_not(number: str) -> None:
    """Numbers that are no root of a short polynomial of degree 16 at most."""
    assert _shortest(ball(number, 768)) is None


def ball(number: str, bits: int) -> acb:
    """A number by sympy, to that many bits."""
    exact = sympy.sympify(number)
    digits = int(bits * 0.302)
    with ctx.workprec(bits):
        parts = [arb(str(sympy.N(part, digits + 5))) + arb(0, arb(2) ** -bits) for part in exact.as_real_imag()]
        return acb(*parts)


@given(st.integers(2, 60), st.integers(1, 60), st.sampled_from(["forward-euler", "leapfrog"]))
@examples(25)
def test_no_determinant_is_smaller_than_its_bound(numerator: int, denominator: int, time: str) -> None:
    """Delta at rational points, over every choice of spatial roots: 0, or above 2**-E. Where it is computed to be
    nonzero ``vanishes`` says so, and it is what the bound is compared with."""
    problem = normal_mode_problem(traditional(time), traditional(time).values({"lam": "9/10", "alpha": "31/9"}))
    sigma = Root.of(Fraction(numerator, denominator))
    exponent = smallest_exponent(problem, sigma)
    with ctx.workprec(256):
        sizes = list(_sizes(problem, sigma.ball(256)))
    assert exponent < 10_000
    assert all(size > -exponent or size < -200 for size in sizes)


def test_the_bound_tells_a_zero_from_a_small_number() -> None:
    """Traditional coupling at its neutral point and 1e-200 beside it, at the same sigma: zero, and not."""
    scheme = traditional()
    told = []
    for alpha in (Fraction(31, 9), Fraction(31, 9) + Fraction(1, 10**200)):
        problem = normal_mode_problem(scheme, scheme.values({"lam": "9/10", "alpha": str(alpha)}))
        mode = next(m for m in analyse(scheme, scheme.values({"lam": "9/10", "alpha": "31/9"})).modes if m.modulus == 1)
        neutral = normal_mode_problem(scheme, scheme.values({"lam": "9/10", "alpha": "31/9"}))
        candidates = [c for f in eliminated(neutral).factors for c in candidates_of(neutral, f)]
        sigma = next(
            c.sigma for c in candidates if c.z is not None and abs(complex(c.z.ball()) - mode.z_complex) < 1e-9
        )
        told.append(vanishes(problem, sigma, [admissible_of(problem, block, sigma) for block in problem.blocks]))
    assert told == [True, False]


def admissible_of(problem: NormalModeProblem, block: Block, sigma: Root) -> list[Root]:
    """The roots inside the circle at a point, as often as they count, and the ghosts' zeros."""
    roots = fibre({problem.variable: sigma}, problem.families[block.family].polynomial, "x")
    inside = [r.root for r in roots if r.position is Position.INSIDE for _ in range(r.multiplicity)]
    return [Root.of(0)] * block.zeros + inside


def test_the_dimension_of_what_a_closure_annihilates() -> None:
    """One standing wave at a wall, two on the whole line; each needs two of the roots, none the damped ones."""
    for scheme, dimension in ((wall("leapfrog", MIRROR), 1), (media("leapfrog", COPIED, "1"), 2)):
        problem = problem_of(scheme)
        points = GlancingPoints(problem, disc_tables(problem), chart_of(problem))
        centre = points.of_conservative()[0]
        candidate = next(m.candidate for m in points._meetings_of(0) or [] if abs(complex(m.w) - centre) < 1e-12)
        families = [admissible(problem, family, candidate) for family in problem.families]
        roots = [families[b.family].strictly() + families[b.family].on_circle() for b in problem.blocks]
        point = point_of(problem, candidate)
        assert nullity(problem, point, roots) == dimension
        part = _smallest(problem, point, roots)
        assert sum(map(len, part)) == 2
        assert all(root.position is Position.ON for mine in part for root in mine)
        assert nullity(problem, point, [families[b.family].strictly() for b in problem.blocks]) == 0


@pytest.mark.parametrize(
    ("scheme", "expected"),
    [
        (wall("leapfrog", MIRROR), True),
        (media("exact", JUMPS, "4"), True),
        (media("crank-nicolson", JUMPS, "4", speed="2"), True),
        (wall("rk4", MIRROR), False),  # z -> 1/z does not take lam*s to -lam*s
        (wall("leapfrog", MIRROR, space="upwind3"), False),  # the interior damps
        (wall("leapfrog", ("u[-1] = s[0]", "s[-1] = s[0]", "u[-2] = -u[1]", "s[-2] = s[1]")), False),  # u takes from s
    ],
)
def test_what_looks_the_same_with_time_reversed(scheme: Scheme, expected: bool) -> None:
    assert reversible(problem_of(scheme)) is expected


def test_media_of_different_speeds_have_trapped_waves_too() -> None:
    """Four families of spatial roots: far beyond elimination, and proved by the reversal of time alone."""
    scheme = media("crank-nicolson", JUMPS, "9", speed="6/5")
    found = counted(scheme)
    assert found.certified
    trapped = [mode for mode in found.modes if mode.kind is ModeKind.EIGENVALUE]
    assert trapped
    spectrum = np.linalg.eigvals(update_matrix(scheme, scheme.values({}), 40))
    for mode in trapped:
        assert np.abs(spectrum - mode.z_complex).min() < 1e-8
