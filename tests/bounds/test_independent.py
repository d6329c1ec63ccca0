"""Verdicts at many points at once: right next to neutral, and as lam -> 0, or left open."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from gks.bounds.independent import verdicts_at
from gks.catalogue.interfaces import COPIED, closure_lines, ghost_equations, two_media
from gks.modes.analysis import quick_verdict
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.oracle.scheme_texts import interface

CLOSURE = closure_lines(ghost_equations(1, 1, COPIED, COPIED))


def lax_wendroff() -> Scheme:
    parameters = 'lam = { role = "cfl", default = 0.5 }\nalpha = 1'
    return parse_scheme(two_media("t", parameters, 'scheme = "lax-wendroff"', CLOSURE), "t")


@pytest.fixture(scope="module")
def coupled() -> Scheme:
    return lax_wendroff()


@pytest.mark.parametrize("lam", [0.9, 0.5, 0.1])
def test_next_to_neutral(coupled: Scheme, lam: float) -> None:
    """The interface is neutral at alpha = 3 for every lam < 1, stable below and unstable above."""
    distances = 10.0 ** -np.arange(1, 12)
    alpha = np.concatenate([3 * (1 - distances), 3 * (1 + distances)])
    found = verdicts_at(coupled, coupled.values({}), {"lam": np.full(len(alpha), lam), "alpha": alpha})
    assert not (found.resolved & (found.stable != (alpha < 3))).any()
    assert found.resolved[[0, 1, 2, 11, 12, 13]].all()
    assert not found.resolved[[10, 21]].any()


def test_small_lam_hides_no_pair_of_modes_next_to_one(coupled: Scheme) -> None:
    """Modes are at z = 1 + lam c there: walks whose first step is a hundredth would pass them by."""
    source = np.random.default_rng(5)
    at = {"lam": 10.0 ** source.uniform(-6, -2, 60), "alpha": 10.0 ** source.uniform(-2, 2, 60)}
    found = verdicts_at(coupled, coupled.values({}), at)
    assert found.resolved.sum() > 20
    for lam, alpha, known, stable in zip(at["lam"], at["alpha"], found.resolved, found.stable, strict=True):
        if known:
            exact = quick_verdict(coupled, {"lam": Fraction(lam), "alpha": Fraction(alpha)})
            assert stable == (exact is Verdict.STABLE)


def test_branch_points_on_the_circle() -> None:
    """Leapfrog's spatial roots meet on abs(z) = 1: the count is right where it closes."""
    scheme = interface(CLOSURE, space="central2", time="leapfrog")
    alpha = np.geomspace(0.1, 10, 7)[:5]  # those left open above 1 take longest
    found = verdicts_at(scheme, scheme.values({}), {"lam": np.full(5, 0.5), "alpha": alpha})
    assert found.resolved.sum() >= 3
    for value, known, growing in zip(alpha, found.resolved, found.growing, strict=True):
        exact = quick_verdict(scheme, {**scheme.values({}), "lam": Fraction(1, 2), "alpha": Fraction(value)})
        if known:
            assert (exact, growing) == (Verdict.STABLE, 0)
