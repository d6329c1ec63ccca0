"""One step: the marcher and the dense one-step matrix are two ways through the same equations."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from gks.errors import NotAnalysable
from gks.scheme.model import Scheme
from gks.solvers.march import march_growth
from gks.solvers.matrices import Layout, layout, level_matrices, onto_constraints, update_matrix
from gks.solvers.problem import build
from gks.solvers.relation import Explicit, Implicit
from gks.solvers.seeds import random_levels
from gks.solvers.update import Marcher
from tests.oracle.scheme_texts import (
    BACKWARD_CENTRED,
    CRANK_NICOLSON,
    LAX_WENDROFF,
    LEAPFROG,
    constructs,
    half_line,
    interface,
    traditional,
)

CONSTRUCTS = constructs()


def start(scheme: Scheme, cells: int = 12, seed: int = 1) -> tuple[Layout, list[np.ndarray]]:
    problem = build(scheme, scheme.values({}))
    grid = layout(problem, [cells] * len(problem.sides))
    levels = random_levels(grid, seed)
    return grid, levels if problem.stages is None else [onto_constraints(grid, levels[0])]


@pytest.mark.parametrize("name", CONSTRUCTS)
def test_every_construct_marches_by_its_update_matrix(name: str) -> None:
    scheme = CONSTRUCTS[name]
    grid, levels = start(scheme)
    marcher = Marcher(grid, levels)
    for _ in range(5):
        marcher.step()
    matrix = update_matrix(scheme, scheme.values({}), 12)
    expected = np.linalg.matrix_power(matrix, 5) @ np.concatenate(levels)
    assert np.concatenate(marcher.levels) == pytest.approx(expected, rel=1e-10, abs=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("name", [name for name, s in CONSTRUCTS.items() if build(s, s.values({})).stages is None])
def test_every_level_satisfies_every_equation_as_written(name: str) -> None:
    """The definition: sum_k A_k w[n+k] = 0, with the equations' own coefficients and no update solved for."""
    scheme = CONSTRUCTS[name]
    grid, levels = start(scheme)
    assert grid.problem.stages is None
    marcher, history = Marcher(grid, levels), list(levels)
    for _ in range(4):
        marcher.step()
        history.append(marcher.state.copy())
    matrices = level_matrices(grid)
    for n in range(4):
        residual = sum(matrix @ history[n + k] for k, matrix in enumerate(matrices))
        assert np.abs(residual).max() < 1e-13 * max(np.abs(level).max() for level in history)


def test_slices_and_factorisation_agree() -> None:
    grid, levels = start(traditional())
    out, other = np.zeros(grid.size), np.zeros(grid.size)
    assert Explicit(grid).newest(levels, out) == pytest.approx(Implicit(grid).newest(levels, other), abs=1e-14)


def test_upwind_interior_step_by_hand() -> None:
    """Right-going u + s and left-going u - s at alpha = 1 are shifted copies at lam = 1: each cell takes its
    neighbour's.
    """
    scheme = traditional()
    problem = build(scheme, scheme.values({"lam": 1}))
    grid = layout(problem, (12, 12))
    marcher = Marcher(grid, random_levels(grid, 3))
    before = grid.block(marcher.state, 1).copy()
    marcher.step()
    after = grid.block(marcher.state, 1)
    u, s = 0, 1
    # q_t + A q_x = 0 with A = [[0, -1], [-1, 0]]: u - s moves right, u + s moves left.
    assert (after[u] - after[s])[3:9] == pytest.approx((before[u] - before[s])[2:8])
    assert (after[u] + after[s])[3:9] == pytest.approx((before[u] + before[s])[4:10])


def test_a_mirrored_half_line_marches_as_its_mirror_image() -> None:
    right = half_line(LAX_WENDROFF, '"u[-1] = 2*u[0] - u[1]"')
    # x -> -x turns u_t = u_x into u_t = -u_x.
    left = half_line(LAX_WENDROFF.replace("lam/2*", "(-lam)/2*"), '"u[1] = 2*u[0] - u[-1]"', side="left")
    states = []
    for scheme in (right, left):
        grid, levels = start(scheme)
        marcher = Marcher(grid, levels)
        for _ in range(7):
            marcher.step()
        states.append(marcher.state.copy())
    assert states[0] == pytest.approx(states[1], rel=1e-12)


def test_stages_keep_the_closure() -> None:
    grid, levels = start(CONSTRUCTS["compact4 rk2"])
    marcher = Marcher(grid, levels)
    for _ in range(10):
        marcher.step()
    state = marcher.state
    assert np.abs(onto_constraints(grid, state) - state).max() < 1e-13 * np.abs(state).max()


def test_growth_by_hundreds_of_orders_of_magnitude_is_kept_in_the_exponent() -> None:
    """u[-1] = 500 u[0] gives z = 1000 + 500 with kappa = 1/500, beside an interior that multiplies by about 1000."""
    scheme = half_line("u[i, n+1] = 10**3*u[i] + u[i-1]", '"u[-1] = 500*u[0]"')
    found = march_growth(scheme, scheme.values({}), steps=500)
    assert float(found.trace.log_sizes()[-1]) == pytest.approx(500 * np.log(1500.0), abs=10)
    assert found.growth.rate == pytest.approx(1500.0, abs=found.growth.uncertainty)


def test_update_matrix_of_the_crank_nicolson_trap_shows_growth_that_vanishes_with_more_cells() -> None:
    """The finite matrix gives 1.0005 where the right answer is abs(z) = 1 exactly: the oracle's limits, kept in
    view.
    """
    scheme = half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1, n]"', 1)
    values = scheme.values({"lam": "2.1"})
    radii = [np.abs(np.linalg.eigvals(update_matrix(scheme, values, cells))).max() for cells in (40, 80, 160)]
    assert radii[0] > radii[1] > radii[2] > 1


class TestRefused:
    """What has no next level, or no meaning, is refused with one line."""

    def test_closure_that_does_not_determine_its_ghost_at_these_parameters(self) -> None:
        scheme = half_line(LAX_WENDROFF, '"(lam - 1/2)*u[-1] = u[0]"')
        grid = layout(build(scheme, {"lam": Fraction(1, 2)}), [12])
        for kind in (Explicit, Implicit):
            with pytest.raises(NotAnalysable, match="do not determine the next level"):
                kind(grid)
        Explicit(layout(build(scheme, {"lam": Fraction(1, 3)}), [12]))

    def test_stages_beside_levels(self) -> None:
        scheme = interface(
            'equations = ["L.u[1] = L.u[0]", "L.s[1] = R.s[0]", "R.u[-1] = L.u[0]", "R.s[-1] = R.s[0]"]',
            right='time = "rk4"',
        )
        with pytest.raises(NotAnalysable, match="forward-euler and rk4"):
            build(scheme, scheme.values({}))

    def test_coefficients_beyond_doubles(self) -> None:
        scheme = traditional()
        with pytest.raises(NotAnalysable, match="beyond double precision"):
            build(scheme, scheme.values({"alpha": "1e400"}))


def test_newest_levels_couple_only_where_they_are_written() -> None:
    """Leapfrog is explicit, Crank-Nicolson and backward Euler are not; a marcher takes the cheap way where there is
    one.
    """
    for text, closure, kind in (
        (LEAPFROG, '"u[0, n+1] = u[1, n+1]"', Explicit),
        (CRANK_NICOLSON, '"u[0, n+1] = u[1]"', Implicit),
        (BACKWARD_CENTRED, '"u[0, n+1] = u[1]"', Implicit),
    ):
        grid, levels = start(half_line(text, closure, 1))
        assert isinstance(Marcher(grid, levels).relation, kind)
