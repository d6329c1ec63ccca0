"""Random schemes: what elimination says against the finite update matrix, the count of zeros, other ways of writing.

Eigenvalues outside the circle of a truncated problem converge geometrically to the growing modes; what does not
converge is the spectrum of the truncated interior, whose excess over 1 fades with the number of cells.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

import numpy as np
from hypothesis import HealthCheck, assume, given
from hypothesis import strategies as st

from gks.errors import InputError
from gks.modes import ModesResult, Verdict, analyse
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import Mode, ModeKind
from gks.modes.wide import wide_modes
from gks.scheme.model import Scheme
from tests.examples import examples
from tests.modes.random_drafts import random_draft
from tests.modes.rewritings import mirrored, moved, renamed, reordered, scaled
from tests.oracle.finite_matrix import largest_modulus
from tests.strategies import Draft, interface_drafts, scalar_drafts

QUIET = [HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large]


def judged(draft: Draft) -> tuple[Scheme, ModesResult]:
    scheme = draft.scheme()
    try:
        return scheme, analyse(scheme, scheme.values({}))
    except InputError:
        assume(False)
        raise


def seeded(seed: int) -> Draft:
    """A random draft; one in four may reach two points to either side."""
    r = Random(seed)
    return random_draft(r, r.choice((1, 1, 1, 2)))


SEEDS = st.integers(0, 10**12).map(seeded)
"""Drafts by a seed: what matters is how many there are, and a failing one is small as it is."""


def growing(found: ModesResult) -> float:
    """The largest modulus outside the circle, 1 where none is."""
    return max((float(m.modulus) for m in found.modes if m.kind.value == "growing"), default=1.0)


def split_by_rounding(found: ModesResult) -> float:
    """How far outside double precision may see an eigenvalue on the circle: an m-fold one, which the finite matrix has
    in Jordan blocks of up to m, splits by the m-th root of the rounding. That is 2**-53 times norms of eigenvectors,
    some 2**17 with the third-order extrapolations drawn; simple ones are given the fading excess of the interior.
    """
    most = max((m.multiplicity for m in found.modes if m.kind.value in ("eigenvalue", "generalized")), default=1)
    return float(max(1e-4, 2.0 ** (-36 / most)))


def slowest_decay(found: ModesResult) -> float:
    """The largest factor from cell to cell inwards among the components of the mode that grows most."""
    worst = max((m for m in found.modes if m.kind.value == "growing"), key=lambda m: m.modulus)
    sizes = [abs(complex(*map(float, kappa))) for kappas in worst.kappa.values() for kappa in kappas]
    return max((min(size, 1 / size) for size in sizes), default=0.0)


def assert_agrees(draft: Draft, cells: int) -> None:
    """The verdict and the largest growing mode are those of the finite matrix, as far as that has settled."""
    scheme, found = judged(draft)
    assert found.reason != "interior", "the interiors drawn are Cauchy-stable"
    if not found.solvable:
        return
    predicted = growing(found)
    if found.verdict is Verdict.UNDECIDED:
        assert predicted == 1
        return
    assert (found.verdict is Verdict.UNSTABLE) == (predicted > 1)
    values = scheme.values({})
    fine = largest_modulus(scheme, values, 2 * cells)
    if fine <= 1 + split_by_rounding(found) if predicted == 1 else np.isclose(fine, predicted, rtol=1e-5):
        return
    assert abs(largest_modulus(scheme, values, cells) - fine) >= 1e-8 * fine, "what settles outside is a mode"
    if predicted > 1.1 and slowest_decay(found) ** (2 * cells) < 1e-6:
        # A mode that hardly decays in space is seen late, and one near 1 among the truncated interior's own spectrum.
        assert abs(fine - predicted) < 1e-2 * predicted


@given(scalar_drafts())
@examples(100, QUIET)
def test_a_known_interior_with_a_random_closure(draft: Draft) -> None:
    assert_agrees(draft, 16)


@given(interface_drafts())
@examples(50, QUIET)
def test_a_random_interface(draft: Draft) -> None:
    assert_agrees(draft, 10)


@given(SEEDS)
@examples(1300, QUIET)
def test_a_random_interior_with_a_random_closure(draft: Draft) -> None:
    assert_agrees(draft, 16 if len(draft.lines) == 1 else 10)


@given(SEEDS)
@examples(150, QUIET)
def test_the_count_of_zeros_agrees_with_elimination(draft: Draft) -> None:
    """The certified tier knows nothing of characteristic polynomials. It may say less, never otherwise."""
    scheme, found = judged(draft)
    problem = normal_mode_problem(scheme, scheme.values({}))
    assume(found.tier == "exact" and found.solvable and not problem.coupled and problem.size)
    counted = wide_modes(problem)
    mine, theirs = ([m for m in each.modes if m.kind is ModeKind.GROWING] for each in (found, counted))
    matches = [[m for m in mine if close(m, t)] for t in theirs]
    if counted.certified:
        assert len(mine) == len(theirs)
        assert all(
            [m.multiplicity for m in match] == [t.multiplicity] for match, t in zip(matches, theirs, strict=True)
        )
        on_circle = {m.kind.value for m in counted.modes} & {"eigenvalue", "generalized"}
        assert on_circle == {m.kind.value for m in found.modes} & {"eigenvalue", "generalized"}
    else:
        assert counted.doubts
        assert all(matches)


def close(one: Mode, other: Mode) -> bool:
    """Whether the discs round two modes meet."""
    return sum((a - b) ** 2 for a, b in zip(one.z, other.z, strict=True)) <= (one.radius + other.radius) ** 2


WAYS: tuple[Callable[[Draft, Random], Draft], ...] = (
    lambda draft, r: scaled(draft, [r.choice(("-7/3", "1e-40", "10**30", "(2 + lam)")) for _ in range(4)]),
    lambda draft, r: renamed(draft),
    lambda draft, r: mirrored(draft),
    lambda draft, r: reordered(draft),
    lambda draft, r: moved(draft, r.randint(-3, 4)),
)


@given(SEEDS, st.sampled_from(WAYS), st.integers(0, 99))
@examples(400, QUIET)
def test_how_it_is_written_changes_nothing(draft: Draft, way: Callable[[Draft, Random], Draft], seed: int) -> None:
    (_, one), (_, other) = judged(draft), judged(way(draft, Random(seed)))
    assert (one.verdict, one.reason, one.tier) == (other.verdict, other.reason, other.tier)
    assert outside(one) == outside(other)


def outside(found: ModesResult) -> list[tuple[str, int, float]]:
    """Kind, multiplicity and modulus of the modes with abs(z) >= 1; 13 digits of numbers known to 24."""
    rows = [(m.kind.value, m.multiplicity, float(f"{float(m.modulus):.12e}")) for m in found.modes]
    return sorted(row for row in rows if row[0] in ("growing", "eigenvalue", "generalized"))
