"""Far ends: so far away that they cannot be felt, and the distance is computed."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from gks.scheme.model import Scheme
from gks.solvers.farends import SILENCE, cells_needed, steps_allowed
from gks.solvers.matrices import layout
from gks.solvers.problem import build
from gks.solvers.runs import run
from gks.solvers.seeds import random_levels
from tests.oracle.scheme_texts import CRANK_NICOLSON, LEAPFROG, constructs, half_line, traditional

CONSTRUCTS = constructs()


def pollution(scheme: Scheme, cells: list[int], steps: int) -> float:
    """What changes near the boundary when the ends are moved twice as far, against the largest value seen."""
    problem = build(scheme, scheme.values({}))
    traces = []
    for factor in (1, 2):
        grid = layout(problem, [factor * count for count in cells])
        traces.append(run(grid, random_levels(grid, 5), steps))
    near, far = (trace.values * np.exp2(trace.exponents)[:, None] for trace in traces)
    length = min(len(near), len(far))
    return float(np.abs(near[:length] - far[:length]).max() / np.abs(far).max())


@pytest.mark.parametrize("name", [name for name in CONSTRUCTS if "exact" not in name])
def test_moving_the_ends_twice_as_far_changes_nothing(name: str) -> None:
    scheme = CONSTRUCTS[name]
    cells = cells_needed(build(scheme, scheme.values({})), 60)
    # Rounding itself differs only where the arithmetic does: the factorisations of different sizes.
    assert pollution(scheme, list(cells), 60) < 1e-12


def test_a_far_end_that_is_too_near_is_felt() -> None:
    """The bound is not idle: at a third of the distance leapfrog's reflected waves are back."""
    scheme = half_line(LEAPFROG, '"u[0, n+1] = u[1, n]"', 1)
    (cells,) = cells_needed(build(scheme, scheme.values({})), 300)
    assert pollution(scheme, [cells // 3], 300) > 1e-4


def test_explicit_schemes_need_no_more_than_their_domain_of_dependence() -> None:
    scheme = traditional()
    for lam in ("0.9", "0.3", "0.01"):
        problem = build(scheme, scheme.values({"lam": lam}))
        for steps in (50, 400):
            # Out and back: half the steps each way, one cell a step, and a little for the circles sampled.
            assert max(cells_needed(problem, steps)) <= steps // 2 + problem.near + 12


def test_implicit_schemes_need_the_signal_speed_and_a_margin() -> None:
    """Crank-Nicolson carries nothing faster than lam cells a step: the margin for its tails stays bounded."""
    problem = build(half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1]"', 1), {"lam": Fraction(2)})
    few, many = cells_needed(problem, 200)[0], cells_needed(problem, 400)[0]
    assert 100 * 2 - 20 < many - few < 100 * 2 + 60


def test_distance_beside_a_growing_mode_does_not_depend_on_the_steps() -> None:
    problem = build(traditional(), traditional().values({"alpha": 10}))
    assert cells_needed(problem, 10**6, growth=1.5) == cells_needed(problem, 10**7, growth=1.5)
    assert max(cells_needed(problem, 10**6, growth=1.5)) < 200


@pytest.mark.parametrize("cells", [60, 150, 400])
def test_steps_allowed_inverts_cells_needed(cells: int) -> None:
    problem = build(half_line(LEAPFROG, '"u[0, n+1] = u[1, n]"', 1), {"lam": Fraction(1)})
    steps = steps_allowed(problem, [cells], 10**5)
    assert cells_needed(problem, steps)[0] <= cells < cells_needed(problem, steps + 1)[0]


def test_no_steps_are_allowed_where_one_is_already_felt() -> None:
    problem = build(half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1]"', 1), {"lam": Fraction(10**6)})
    assert steps_allowed(problem, [20], 100) == 0
    assert np.finfo(float).eps > SILENCE
