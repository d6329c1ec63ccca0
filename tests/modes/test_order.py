"""Multiplicities are those of the mode, not of the polynomial that eliminates the spatial roots."""

from __future__ import annotations

from fractions import Fraction

from gks.modes.analysis import analyse, judged
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import ModeKind
from gks.scheme.model import Scheme
from tests.oracle.scheme_texts import half_line

UPWIND3 = "u[i, n+1] = u[i] - lam*(2*u[i+1] + 3*u[i] - 6*u[i-1] + u[i-2])/6"


def two_ghosts(first: str, second: str) -> Scheme:
    """Three spatial roots, two of them decaying: the elimination counts a root kappa with either of the others."""
    return half_line(UPWIND3, f'"u[-1] = {first}", "u[-2] = {second}"')


def test_a_zero_shared_by_several_choices_of_roots_is_counted_once() -> None:
    # Both equations say kappa = 1/2, alone or with any second root: one mode, which the norm meets on two sheets.
    scheme = two_ghosts("2*u[0]", "2*u[-1]")
    values = scheme.values({"lam": "1/4"})
    ((mode, candidate),) = judged(normal_mode_problem(scheme, values))[0]
    assert candidate.multiplicity == 2
    assert (mode.kind, mode.multiplicity) == (ModeKind.GROWING, 1)
    assert abs(mode.z[0] - (1 - Fraction(1, 4) * (1 + 3 - 12 + 4) / 6)) <= mode.radius


def test_a_true_double_zero_keeps_its_multiplicity() -> None:
    # The ghost's own equation is z**2 = 4 z - 4, and the cells follow: Delta = (z - 2)**2.
    scheme = half_line("u[i, n+1] = u[i-1, n]", '"u[-1, n+1] = 4*u[-1] - 4*u[-1, n-1]"')
    result = analyse(scheme, scheme.values())
    assert [(m.z_complex, m.multiplicity, m.kind) for m in result.modes] == [(2, 2, ModeKind.GROWING)]
