"""Roots that cluster: proved apart however close they are, and quickly."""

from __future__ import annotations

from typing import cast

import pytest
from flint import acb, acb_poly, arb, ctx, fmpz_poly
from hypothesis import given
from hypothesis import strategies as st

from gks.modes import clusters
from gks.modes.algebraic import isolated_roots
from gks.modes.clusters import isolate
from tests.examples import examples

x = fmpz_poly([0, 1])
N = 10**300


def overlaps_one_each(poly: fmpz_poly, bits: int) -> bool:
    """Against FLINT's isolation: the same roots, one ball to one ball."""
    mine = isolate(poly, bits)
    assert mine is not None
    with ctx.workprec(4 * bits):
        theirs = [ball for ball, _ in cast("list[tuple[acb, int]]", poly.complex_roots())]
    return len(mine) == len(theirs) and all(sum(a.overlaps(b) for b in theirs) == 1 for a in mine)


@given(st.lists(st.integers(-9, 9), min_size=3, max_size=14).filter(lambda c: c[-1] != 0))
@examples(60)
def test_the_same_roots_as_flint(coefficients: list[int]) -> None:
    poly = fmpz_poly(coefficients)
    poly = poly // poly.gcd(poly.derivative())
    if poly.degree() > 0:
        assert overlaps_one_each(poly, 64)


@pytest.mark.parametrize(
    "poly",
    [
        10**20 * (x - 1) ** 3 + x**3,
        (10**9 * (x**2 + 1) + x) * (10**9 * (x**2 + 1) + 2 * x) * (x - 2),
        (10**12 * x - 1) * (x - 10**12) * (x**2 + x + 3),
    ],
)
def test_moderate_clusters_agree_with_flint_too(poly: fmpz_poly) -> None:
    assert overlaps_one_each(poly, 64)


def test_a_pair_1e_minus_300_apart_near_one() -> None:
    # z = 1 +- i/N: the amplification factors of a centred scheme at lam = 1e-300.
    poly = (N * (x - 1)) ** 2 + 1
    upper, lower = isolate(poly, 64) or []
    with ctx.workprec(3000):
        assert upper.imag * N > 0.999
        assert lower.imag * N < -0.999


def test_clusters_within_clusters() -> None:
    # Three roots within 1/N of i, two of these within 1/N**2 of each other; their conjugates; and a root far off.
    unit = x**2 + 1
    poly = (N * unit + 1) * (N * unit + 2) * (N**2 * (N * unit + 2) + N) * (x - N)
    roots = isolate(poly, 64)
    assert roots is not None
    assert len(roots) == 7
    assert sum(ball.imag == 0 for ball in roots) == 1


def test_a_triple_cluster_around_a_real_point_holds_one_real_root() -> None:
    roots = isolate(N * (x - 1) ** 3 + x**3, 64)
    assert roots is not None
    assert [ball.imag == 0 for ball in roots] == [True, False, False]


def test_none_where_roots_coincide() -> None:
    assert isolate((x - 1) ** 2, 64) is None


def test_the_isolation_uses_it_for_long_coefficients() -> None:
    # FLINT alone takes four seconds for this pair.
    assert [root.is_real for root in isolated_roots((N * (x - 1)) ** 2 + 1)] == [False, False]


def test_a_pair_too_close_for_the_length_of_the_coefficients() -> None:
    # Mignotte: two roots near 1/M at a relative distance of about M**-10. FLINT alone takes half a minute.
    big = 10**30
    roots = isolate(x**20 - 2 * (big * x - 1) ** 2, 64)
    assert roots is not None
    with ctx.workprec(3000):
        assert sum(abs(big * root - 1) < 1e-100 for root in roots) == 2


def test_coefficients_beyond_a_companion_matrix_are_left_to_more_precision() -> None:
    """The quotient by a leading coefficient of 2**-1050 is no double: nothing is found, and nothing raised."""


    assert clusters._roots_of_size_one(acb_poly([1, 1, arb(2) ** -1050]), 0, 0, 2) is None
