"""Problems that fall apart: Delta is a product, and each factor is judged by itself.

With equal media on both sides the waves that run left and those that run right know nothing of each other, and by the
mirror symmetry either has the modes of the other: every mode of the whole is double.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import acb, acb_mat, ctx
from hypothesis import given
from hypothesis import strategies as st

from gks.modes.algebraic import Root
from gks.modes.analysis import analyse
from gks.modes.decoupling import decoupled
from gks.modes.kreiss import NormalModeProblem, closure_matrix
from gks.modes.profile import profile
from gks.modes.verdict import Mode, ModeKind, Verdict
from gks.modes.wide import VanishingDeterminant, modes_of_part, wide_modes
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.update import update_matrix
from tests.examples import examples
from tests.modes.test_profile import residual
from tests.modes.test_wide_circle import admissible_of, problem_of
from tests.oracle.scheme_texts import coupled_by_penalties


def delta(problem: NormalModeProblem, sigma: Fraction) -> acb:
    """The determinant at a rational point off the circle, by the spatial roots themselves."""
    here = Root.of(sigma)
    roots = [admissible_of(problem, block, here) for block in problem.blocks]
    with ctx.workprec(200):
        return acb_mat(closure_matrix(problem, {problem.variable: here}, roots, 200)).det()


WEIGHTS = st.lists(st.integers(-4, 4), min_size=6, max_size=6)
MIXTURES = st.sampled_from([(1, 1), (2, 1), (3, -1), (-1, 2), (1, 0)])


def two_walls(weights: list[int], mixed: tuple[int, int]) -> Scheme:
    """A wave that runs away from a wall on either side; the two equations added to each other."""
    left = ("L.u[1]", " + ".join(f"({w}/2)*L.u[-{k}]" for k, w in enumerate(weights[:3])))
    right = ("R.u[-1]", " + ".join(f"({w}/2)*R.u[{k}]" for k, w in enumerate(weights[3:])))
    together = " = ".join(f"{mixed[0]}*({one}) + {mixed[1]}*({two})" for one, two in zip(left, right, strict=True))
    return parse_scheme(
        f"""
title = "two walls"
[parameters]
lam = {{ role = "cfl", default = "1/2" }}
[interior]
space = "central2"
time = "rk4"
[domains.L]
side = "left"
unknowns = ["u"]
flux = [["-1"]]
[domains.R]
side = "right"
unknowns = ["u"]
flux = [["1"]]
[closure]
equations = ["{together}", "{" = ".join(right)}"]
""",
        "two walls",
    )


@given(WEIGHTS, MIXTURES)
@examples(25)
def test_walls_that_are_written_together_are_two_problems(weights: list[int], mixed: tuple[int, int]) -> None:
    """However the equations are mixed: the parts are those of the plain writing, and Delta is their product."""
    plain, whole = problem_of(two_walls(weights, (1, 0))), problem_of(two_walls(weights, mixed))
    parts = decoupled(whole)
    assert len(parts) == len(decoupled(plain)) == 2
    assert sorted(b.field.domain for part in parts for b in part.blocks) == ["L", "R"]
    ratios = []
    for sigma in (Fraction(1, 2), Fraction(3), Fraction(7, 3)):
        product, together = delta(parts[0], sigma) * delta(parts[1], sigma), delta(whole, sigma)
        assert product.contains(0) == together.contains(0)
        if not product.contains(0):
            ratios.append(together / product)
    assert all(ratio.overlaps(ratios[0]) for ratio in ratios)


@given(WEIGHTS, MIXTURES)
@examples(10)
def test_the_modes_of_the_whole_are_those_of_the_parts(weights: list[int], mixed: tuple[int, int]) -> None:
    """Against the same count of zeros made of the whole determinant at once."""
    problem = problem_of(two_walls(weights, mixed))
    try:
        apart, together = wide_modes(problem), modes_of_part(problem, inner=False)
    except VanishingDeterminant:
        assert any(delta(part, Fraction(3)).contains(0) for part in decoupled(problem))
        return
    if apart.certified and together.certified:
        assert growing(apart.modes) == pytest.approx(growing(together.modes), rel=1e-12)


def growing(modes: list[Mode]) -> list[float]:
    return sorted(float(m.modulus) for m in modes if m.kind is ModeKind.GROWING for _ in range(m.multiplicity))


@pytest.mark.parametrize(("alpha", "parts"), [("1", 2), ("2", 1)])
def test_equal_media_fall_apart_and_different_ones_do_not(alpha: str, parts: int) -> None:
    problem = problem_of(coupled_by_penalties("exact", alpha))
    found = decoupled(problem)
    assert len(found) == parts
    assert sum(part.size for part in found) == problem.size
    if parts == 2:
        assert all({b.field.domain for b in part.blocks} == {"L", "R"} for part in found)


@pytest.mark.parametrize(("time", "lam"), [("exact", "1"), ("crank-nicolson", "1"), ("leapfrog", "1/2")])
def test_energy_conserving_penalties_between_equal_media_are_neutral(time: str, lam: str) -> None:
    """A wave trapped in the boundary rows, once for each direction: proved by the reversal of time and of space."""
    scheme = coupled_by_penalties(time, "1")
    values = scheme.values({"lam": lam})
    result = analyse(scheme, values)
    assert (result.verdict, result.certified) == (Verdict.NEUTRAL, True)
    on_circle = [mode for mode in result.modes if mode.kind is ModeKind.EIGENVALUE]
    assert on_circle
    assert all(mode.modulus == 1 and mode.multiplicity == 2 for mode in on_circle)
    if time == "exact":
        return  # there is no step to make a matrix of
    spectrum = np.linalg.eigvals(update_matrix(scheme, values, 40))
    for mode in on_circle:
        nearest = np.sort(np.abs(spectrum - mode.z_complex))
        assert nearest[1] < 1e-7, "twice, split by rounding at most"
        assert nearest[2] > 1e-4


def test_four_stages_damp_it() -> None:
    scheme = coupled_by_penalties("rk4", "1")
    result = analyse(scheme, scheme.values({"lam": "1/2"}))
    assert (result.verdict, result.certified) == (Verdict.STABLE, True)
    assert [mode.multiplicity for mode in result.modes if mode.kind is ModeKind.DECAYING] == [2, 2]


def test_the_profiles_are_a_basis_a_wave_each() -> None:
    """They solve the scheme; in one u = s, in the other u = -s."""
    scheme = coupled_by_penalties("crank-nicolson", "1")
    found = profile(analyse(scheme, scheme.values({"lam": "1/2"})), 0)
    assert found.certified
    assert len(found.shapes) == 2
    ratios = []
    for number, shape in enumerate(found.shapes):
        assert residual(found, number) < 1e-12
        u, s = (complex(*map(float, shape.values["R"][name][5])) for name in "us")
        ratios.append(u / s)
    assert sorted(ratio.real for ratio in ratios) == pytest.approx([-1, 1], abs=1e-9)
    assert [ratio.imag for ratio in ratios] == pytest.approx([0, 0], abs=1e-9)
