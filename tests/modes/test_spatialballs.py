"""Roots of the norm judged in balls, held against the exact judgement of the same roots."""

from __future__ import annotations

from fractions import Fraction

import pytest
from flint import acb, arb, ctx, fmpz_poly

from gks.catalogue import find
from gks.modes.algebraic import Position, isolated_roots, isolation, newton_refined
from gks.modes.analysis import analyse, eliminated
from gks.modes.candidates import candidates_of
from gks.modes.judgement import judge
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.polynomial import characteristic_factors
from gks.modes.spatialballs import NotTold, ball_space, has_kernel
from gks.modes.verdict import ModeKind
from gks.scheme.schemefile import parse_scheme
from tests.oracle.scheme_texts import LAX_WENDROFF, LEAPFROG, half_line, interface

CLOSURES = (
    'equations = ["L.u[1] = L.u[0] + R.s[0]/3", "L.s[1] = R.s[0]", "R.u[-1] = 2*L.u[0]", "R.s[-1] = R.s[0] - L.u[-1]"]'
)


def problems() -> dict[str, NormalModeProblem]:
    schemes = {
        "one half-line": half_line(LAX_WENDROFF, '"u[0, n+1] = -3*u[1] + 2*u[2, n-1]"', 1),
        "two half-lines": interface(CLOSURES, "rk4", "central2"),
        "a paper scheme": find("traditional-2"),
    }
    return {name: normal_mode_problem(scheme, scheme.values({})) for name, scheme in schemes.items()}


@pytest.mark.parametrize("name", sorted(problems()))
def test_balls_and_exact_algebra_judge_alike(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = problems()[name]
    candidates = [c for factor in eliminated(problem).factors for c in candidates_of(problem, factor)]
    off = [c for c in candidates if c.position is not Position.ON]
    assert off
    by_balls = [judge(problem, candidate) for candidate in off]

    def refuses(problem: NormalModeProblem, candidate: object) -> None:
        raise NotTold

    monkeypatch.setattr("gks.modes.judgement.ball_space", refuses)
    exactly = [judge(problem, candidate) for candidate in off]
    assert [m.kind for m in by_balls] == [m.kind for m in exactly]
    for one, other in zip(by_balls, exactly, strict=True):
        for domain in one.kappa:
            mine = sorted(abs(complex(*map(float, k))) for k in one.kappa[domain])
            theirs = sorted(abs(complex(*map(float, k))) for k in other.kappa[domain])
            assert mine == pytest.approx(theirs, rel=1e-14)


def test_colliding_spatial_roots_are_left_to_exact_algebra() -> None:
    """Beam-Warming at lam = 1/2 has kappa = 1/3 twice at z = 3/2, the root of the closure below."""
    scheme = half_line(
        "u[i, n+1] = u[i] - lam/2*(3*u[i] - 4*u[i-1] + u[i-2]) + lam**2/2*(u[i] - 2*u[i-1] + u[i-2])",
        '"u[0, n+1] = 3/2*u[0]", "u[1, n+1] = 3/2*u[1]"',
        2,
    )
    problem = normal_mode_problem(scheme, scheme.values({}))
    (candidate,) = [
        c for f in eliminated(problem).factors for c in candidates_of(problem, f) if c.sigma.rational == Fraction(3, 2)
    ]
    with pytest.raises(NotTold):
        ball_space(problem, candidate)
    assert judge(problem, candidate).kind is ModeKind.GROWING


def test_half_lines_that_the_closure_does_not_tie_are_eliminated_apart() -> None:
    """The zeros of one do not count once for every choice of the other's spatial roots."""
    scheme = parse_scheme(
        f"""
title = "side by side"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["{LEAPFROG}"]
[domains.L]
side = "left"
unknowns = ["u"]
interior = ["{LAX_WENDROFF}"]
[closure]
equations = ["R.u[-1, n+1] = 2*R.u[0]", "L.u[1, n+1] = -3*L.u[0] + L.u[-1]"]
""",
        "side by side",
    )
    problem = normal_mode_problem(scheme, scheme.values({}))
    factors = characteristic_factors(problem).factors
    assert {sheet for factor in factors for sheet in factor.sheets} == {frozenset({0}), frozenset({1})}
    growing = [m for m in analyse(scheme, scheme.values({})).modes if m.kind is ModeKind.GROWING]
    assert growing
    assert all(mode.multiplicity == 1 for mode in growing)


def test_two_modes_that_differ_in_sign() -> None:
    """Leapfrog with u[0] = 4 u[2]: kappa = 1/2 or -1/2, z - 1/z = lam (kappa - 1/kappa), two modes."""
    scheme = half_line(LEAPFROG, '"u[0, n+1] = 4*u[2, n+1]"', 1)
    problem = normal_mode_problem(scheme, scheme.values({}))
    candidates = [c for f in eliminated(problem).factors for c in candidates_of(problem, f)]
    growing = [c for c in candidates if c.position is Position.OUTSIDE]
    assert [has_kernel(problem, c, ball_space(problem, c)) for c in growing] == [True, True]
    sizes = [float(m.modulus) for m in analyse(scheme, scheme.values({})).modes if m.kind is ModeKind.GROWING]
    assert sizes == pytest.approx([(3 + 73**0.5) / 8] * 2, rel=1e-15)


# Refining one root by itself -----------------------------------------------------------------------------------------


def test_one_root_is_refined_and_the_others_are_left_alone() -> None:
    poly = fmpz_poly([3, -7, 1, 0, 5, 1, -2, 9])
    for root in isolated_roots(poly):
        sharp = root.ball(3000)
        assert sharp.rel_accuracy_bits() >= 3000
        assert root.ball().contains(sharp)
        assert (sharp.imag == 0) == root.is_real
        with ctx.workprec(4000):
            assert poly(sharp).contains(0)
    assert all(ball.rel_accuracy_bits() < 3000 for ball in isolation(poly).balls(64))


def test_a_double_root_is_refused() -> None:
    square = fmpz_poly([4, -4, 1])
    wide = acb(arb(2, 1e-3))
    assert newton_refined(wide, 200, lambda x: (square(x), square.derivative()(x))) is None
