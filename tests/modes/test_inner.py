"""Modes just inside the circle on the counting route: the ones that elimination lists there, and no others."""

from __future__ import annotations

from fractions import Fraction
from math import prod

import pytest

from gks.api import load
from gks.modes.analysis import analyse
from gks.modes.inner import DEEPEST
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import ModeKind, Verdict
from gks.modes.wide import wide_modes
from gks.scheme.model import Scheme
from tests.modes.test_wide import INFLOW, lax_wendroff, written

CASES = [
    ("traditional-1", {"alpha": "33/10"}),
    ("traditional-2", {"alpha": "15/100"}),
    ("weighted-1", {}),
    ("beam-warming-inverse-5-3", {}),
    ("beam-warming-inverse-4-2", {"lam": "3/2"}),
    ("backward-euler-one-sided", {"lam": "7/5"}),
    ("lax-wendroff-order-4-oblique", {}),
]


def inside(scheme: Scheme, values: dict[str, str]) -> list[complex]:
    found = wide_modes(normal_mode_problem(scheme, scheme.values(values)), inner=True)
    assert found.certified and len(found.modes) == len(found.places)
    assert all(m.radius < 1e-20 for m in found.modes if m.kind is ModeKind.DECAYING)
    return sorted((m.z_complex for m in found.modes if m.kind is ModeKind.DECAYING), key=lambda z: (z.real, z.imag))


@pytest.mark.parametrize(("name", "values"), CASES)
def test_the_same_modes_as_by_elimination(name: str, values: dict[str, str]) -> None:
    scheme = load(name).scheme
    exact = analyse(scheme, scheme.values(values))
    assert exact.tier == "exact"
    theirs = {m.z_complex for m in exact.modes if m.kind is ModeKind.DECAYING and m.modulus > DEEPEST}
    ours = inside(scheme, values)
    assert ours == pytest.approx(sorted(theirs, key=lambda z: (z.real, z.imag)), abs=1e-12)


def wide(kappa: Fraction) -> Scheme:
    """Order 8 entering, four ghosts u[-k] = u[0]/kappa**k: the sequence kappa**i is a mode while abs(kappa) < 1."""
    return written(lax_wendroff(4, INFLOW), [f"u[{-k}] = ({1 / kappa})**{k}*u[0]" for k in (1, 2, 3, 4)])


@pytest.mark.parametrize("kappa", ["-3/4", "-1/2", "-12/25", "-2/5"])
def test_margin_is_that_of_the_mode_known_by_hand(kappa: str) -> None:
    # z is the scheme's symbol at kappa: the polynomial through 9 points at the foot of the characteristic.
    scheme, k, lam = wide(Fraction(kappa)), Fraction(kappa), Fraction(1, 2)
    z = sum((_lagrange(j, -lam) * Fraction(k**j) for j in range(-4, 5)), start=Fraction(0))
    result = analyse(scheme, scheme.values({"lam": "1/2"}))
    assert result.tier == "certified"
    assert result.verdict is (Verdict.UNSTABLE if abs(z) > 1 else Verdict.STABLE)
    if abs(z) > DEEPEST:
        (mode,) = result.modes
        assert mode.kind is (ModeKind.GROWING if abs(z) > 1 else ModeKind.DECAYING)
        assert mode.z[0] == pytest.approx(z) and not mode.z[1]
        assert result.margin is not None and float(result.margin) == pytest.approx(float(1 - abs(z)), abs=1e-12)
    else:
        assert result.modes == () and result.margin is None


def _lagrange(j: int, at: Fraction) -> Fraction:
    return prod((Fraction(at - m, j - m) for m in range(-4, 5) if m != j), start=Fraction(1))
