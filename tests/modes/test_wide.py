"""The count of zeros of Delta, held against elimination, against the finite matrix, and against what is known by hand.

Schemes are scalar on one half-line unless said otherwise; high-order Lax-Wendroff is written out from its definition,
the polynomial through 2r + 1 values at the foot of the characteristic (Strang, J. Math. and Phys. 41 (1962) 147-154).
"""

from __future__ import annotations

from fractions import Fraction
from math import comb, factorial, prod
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from gks import catalogue
from gks.modes.analysis import _judge, _modes, analyse
from gks.modes.interior import interior_stability
from gks.modes.kreiss import normal_mode_problem
from gks.modes.route import beyond_elimination, laborious
from gks.modes.verdict import Mode, ModeKind, Verdict
from gks.modes.wide import WideModes, wide_modes
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.examples import examples
from tests.oracle.finite_matrix import largest_modulus
from tests.oracle.scheme_texts import (
    BACKWARD_CENTRED,
    CRANK_NICOLSON,
    LAX_WENDROFF,
    LEAPFROG,
    coupled_by_penalties,
    half_line,
    interface,
    traditional,
)

INFLOW, OUTFLOW = 1, -1
"""Direction of the wave on x > 0: away from the boundary, or towards it."""


def lax_wendroff(r: int, direction: int) -> dict[int, str]:
    """Coefficients of q[i+j] of the scheme of order 2r for q_t + direction q_x = 0: Lagrange's at -direction*lam."""
    points = range(-r, r + 1)
    found = {}
    for j in points:
        others = [m for m in points if m != j]
        found[j] = "*".join(f"(({-direction})*lam - ({m}))" for m in others) + f"/({prod(j - m for m in others)})"
    return found


def written(coefficients: dict[int, str], closure: list[str], title: str = "written out") -> Scheme:
    """A right half-line with an explicit one-level interior."""
    terms = " + ".join(f"({c})*u[i{j:+d}]" for j, c in coefficients.items()).replace("[i+0]", "[i]")
    equations = ", ".join(f'"{each}"' for each in closure)
    return parse_scheme(
        f"""
title = "{title}"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = {terms}"]
[closure]
equations = [{equations}]
""",
        title,
    )


def extrapolation(ghosts: int, order: int) -> list[str]:
    """Every ghost value by polynomial extrapolation: its difference of order ``order`` vanishes."""
    return [
        f"u[{-k}] = " + " + ".join(f"({(-1) ** (m + 1) * comb(order, m)})*u[{m - k}]" for m in range(1, order + 1))
        for k in range(1, ghosts + 1)
    ]


def inverse_lax_wendroff(ghosts: int, kept: int, order: int) -> list[str]:
    """Inflow of zero at x = 0: Taylor's series there, its first ``kept`` derivatives from the data (zero by the
    equation), the others extrapolated from inside (after Tan & Shu, J. Comput. Phys. 229 (2010) 8144-8166)."""
    lines = []
    for k in range(1, ghosts + 1):
        weights: dict[int, Fraction] = {}
        for power in range(kept, order):
            # The derivative of the polynomial through u[0], ..., u[order-1] at the boundary point x = -1/2.
            for m, c in _derivative_weights(order, power).items():
                weights[m] = weights.get(m, Fraction(0)) + c * (Fraction(1, 2) - k) ** power / factorial(power)
        lines.append(f"u[{-k}] = " + " + ".join(f"({c})*u[{m}]" for m, c in weights.items()))
    return lines


def _derivative_weights(points: int, power: int) -> dict[int, Fraction]:
    """Weights of u[0], ..., u[points-1] (at x = m) in the derivative of their polynomial at x = -1/2."""
    weights = {}
    for j in range(points):
        basis = [Fraction(1)]  # in t = x + 1/2, ascending
        for m in range(points):
            if m != j:
                pairs = zip([Fraction(0), *basis], [*basis, Fraction(0)], strict=True)
                basis = [(a - (m + Fraction(1, 2)) * b) / (j - m) for a, b in pairs]
        weights[j] = basis[power] * factorial(power)
    return weights


def counted(scheme: Scheme, **values: str) -> WideModes:
    return wide_modes(normal_mode_problem(scheme, scheme.values(values)))


def verdict(modes: list[Mode], doubts: list[str]) -> Verdict:
    return _judge(None, True, modes, doubts)[0]


def growing(modes: list[Mode]) -> list[complex]:
    """The growing modes by multiplicity, conjugates in a fixed order."""
    found = [m.z_complex for m in modes if m.kind is ModeKind.GROWING for _ in range(m.multiplicity)]
    return sorted(found, key=lambda z: (round(abs(z), 9), z.real, z.imag))


def agree(scheme: Scheme, **values: str) -> WideModes | None:
    """Both routes on one scheme; None where the interior is unstable and the count means nothing."""
    problem = normal_mode_problem(scheme, scheme.values(values))
    if interior_stability(problem) is not None:
        return None
    exact, doubts = _modes(problem)
    wide = wide_modes(problem)
    assert not doubts
    assert verdict(wide.modes, wide.doubts) in (verdict(exact, doubts), Verdict.UNDECIDED)
    assert growing(wide.modes) == pytest.approx(growing(exact), rel=1e-12)
    return wide


# The determinant has no zeros of its own ------------------------------------------------------------------------------


def test_colliding_roots_are_no_mode() -> None:
    """Beam-Warming at lam = 1/2, Dirichlet ghosts: kappa = 1/3 twice at z = 3/2, where a determinant of eigenvectors
    vanishes. Nothing grows: the ghosts are zero, and the scheme is Cauchy-stable."""
    beam_warming = {-2: "lam*(lam - 1)/2", -1: "lam*(2 - lam)", 0: "(1 - lam)*(2 - lam)/2"}
    scheme = written(beam_warming, ["u[-1] = 0*u[0]", "u[-2] = 0*u[0]"])
    found = counted(scheme)
    assert found.certified
    assert not found.modes
    # The naive determinant does vanish there: two equal columns.
    kappa = np.roots([0.375 - 1.5, 0.75, -0.125])
    assert abs(np.linalg.det(np.vander(kappa, 2))) < 1e-7


# Against elimination --------------------------------------------------------------------------------------------------

CLOSURES = (
    "u[0, n+1] = u[1, n+1]",
    "u[0, n+1] = u[1, n]",
    "u[0, n+1] = 2*u[1, n] - u[2, n-1]",
    "u[0, n+1] = u[0, n] + lam*(u[1, n] - u[0, n])",
    "u[0, n+1] = 3*u[1, n] - 2*u[2, n]",
)


@pytest.mark.parametrize("closure", CLOSURES)
@pytest.mark.parametrize("interior", [LEAPFROG, CRANK_NICOLSON, BACKWARD_CENTRED, LAX_WENDROFF])
def test_agrees_with_elimination(interior: str, closure: str) -> None:
    """The classical interiors, with roots at infinity (Crank-Nicolson at z = -1) and glancing points (leapfrog)."""
    wide = agree(half_line(interior, f'"{closure}"', 1), lam="9/10")
    assert wide is not None
    assert wide.certified


@pytest.mark.parametrize("time", ["forward-euler", "backward-euler", "rk4", "exact", "bdf2", "crank-nicolson"])
def test_agrees_through_every_kind_of_integrator(time: str) -> None:
    wide = agree(traditional(time), lam="4/5", alpha="3")
    assert wide is not None
    assert wide.certified


@pytest.mark.parametrize("alpha", ["4", "1e10", "31000000001/9000000000"])
def test_growing_modes_far_away_and_close_to_the_circle(alpha: str) -> None:
    """Traditional coupling, lam = 0.9: neutral at alpha = 31/9, from where the pair leaves as abs(z) ~ sqrt(alpha)."""
    wide = agree(traditional(), lam="9/10", alpha=alpha)
    assert wide is not None
    assert wide.certified
    assert len(growing(wide.modes)) == 2


def test_what_lies_on_the_circle_is_proved_to() -> None:
    """At alpha = 31/9 the pair is on the circle at no rational point: a root of a quadratic, which exact algebra
    confirms."""
    wide = agree(traditional(), lam="9/10", alpha="31/9")
    assert wide is not None
    assert wide.certified
    assert {(mode.kind, mode.modulus) for mode in wide.modes} == {(ModeKind.EIGENVALUE, Fraction(1))}


def test_a_hair_inside_is_stable() -> None:
    """The other side of that point by 1e-12: the pair is found inside the circle and proved to be all there is."""
    wide = counted(traditional(), lam="9/10", alpha="30999999999991/9000000000000")
    assert wide.certified
    assert [m.kind for m in wide.modes] == [ModeKind.DECAYING] * 2
    assert all(0 < 1 - m.modulus < 1e-12 for m in wide.modes)


def test_two_zeros_in_one_place() -> None:
    """Two copies of one unstable problem side by side: a semisimple double mode, counted as two."""
    closure = '"R.u[0, n+1] = 3*R.u[1, n] - 2*R.u[2, n]", "R.v[0, n+1] = 3*R.v[1, n] - 2*R.v[2, n]"'
    scheme = parse_scheme(
        f"""
title = "twice"
[parameters]
lam = {{ role = "cfl", default = 0.9 }}
[domains.R]
side = "right"
unknowns = ["u", "v"]
interior = ["{LEAPFROG}", "{LEAPFROG.replace("u[", "v[")}"]
first = 1
[closure]
equations = [{closure}]
""",
        "twice",
    )
    single = counted(half_line(LEAPFROG, '"u[0, n+1] = 3*u[1, n] - 2*u[2, n]"', 1), lam="9/10")
    double = counted(scheme)
    assert double.certified
    assert growing(double.modes) == pytest.approx([z for z in growing(single.modes) for _ in range(2)], rel=1e-4)
    assert {m.multiplicity for m in double.modes} == {2}


weights = st.fractions(min_value=-3, max_value=3, max_denominator=8)


@examples(12)
@given(st.tuples(weights, weights, weights), st.sampled_from(["1/4", "9/10"]), st.sampled_from([INFLOW, OUTFLOW]))
def test_any_closure_of_lax_wendroff(w: tuple[Fraction, Fraction, Fraction], lam: str, direction: int) -> None:
    closure = f"u[-1] = ({w[0]})*u[0] + ({w[1]})*u[1] + ({w[2]})*u[2]"
    agree(written(lax_wendroff(1, direction), [closure]), lam=lam)


@examples(6)
@given(st.tuples(weights, weights, weights, weights), st.sampled_from(["1/4", "3/4"]))
def test_any_closure_of_fourth_order_lax_wendroff(w: tuple[Fraction, ...], lam: str) -> None:
    closure = [f"u[-1] = ({w[0]})*u[0] + ({w[1]})*u[1]", f"u[-2] = ({w[2]})*u[0] + ({w[3]})*u[1]"]
    agree(written(lax_wendroff(2, INFLOW), closure), lam=lam)


# Wide stencils against the finite matrix ------------------------------------------------------------------------------


def spectrum(scheme: Scheme, r: int, lam: float, direction: int, cells: int) -> list[complex]:
    """Eigenvalues of the update of u[0], ..., u[cells-1], ghosts put in, zeros beyond the far end: a second way, which
    reads the closure's numbers and nothing else of the analyser."""
    row = {j: float(eval_lagrange(r, j, -direction * lam)) for j in range(-r, r + 1)}
    values = scheme.values({"lam": Fraction(str(lam))})
    ghosts: NDArray[Any] = np.zeros((r, cells))
    unknown = np.eye(r)
    for i, equation in enumerate(scheme.closure.equations):
        for value, coefficient in equation.form.terms:
            c = float(coefficient.at(values))
            if value.index >= 0:
                ghosts[i, value.index] -= c
            else:
                unknown[i, -value.index - 1] = c
    ghosts = np.linalg.solve(unknown, ghosts)
    update = np.zeros((cells, cells))
    for i in range(cells):
        for j, c in row.items():
            if i + j < 0:
                update[i] += c * ghosts[-(i + j) - 1]
            elif i + j < cells:
                update[i, i + j] += c
    return [complex(z) for z in np.linalg.eigvals(update)]


def eval_lagrange(r: int, j: int, x: float) -> float:
    return prod((x - m) / (j - m) for m in range(-r, r + 1) if m != j)


WIDE = [
    pytest.param(r, direction, closure, lam, id=f"order {2 * r} {'in' if direction > 0 else 'out'} {name} {lam}")
    for r in (2, 3, 4)
    for direction, name, closure in (
        (INFLOW, "inverse 3 of 4", inverse_lax_wendroff(r, 3, 4)),
        (OUTFLOW, "extrapolation 2", extrapolation(r, 2)),
        (OUTFLOW, "extrapolation 6", extrapolation(r, 6)),
        (INFLOW, "inverse 1 of 4", inverse_lax_wendroff(r, 1, 4)),
        (INFLOW, "inverse 2 of 8", inverse_lax_wendroff(r, 2, 8)),
    )
    for lam in (0.3, 0.9)
]


@pytest.mark.parametrize("r, direction, closure, lam", WIDE)
def test_high_order_lax_wendroff(r: int, direction: int, closure: list[str], lam: float) -> None:
    scheme = written(lax_wendroff(r, direction), closure)
    found = counted(scheme, lam=str(lam))
    assert found.certified, found.doubts
    # Truncation moves a mode by its decay over the grid, and the interior's own eigenvalues stay inside.
    outside = [z for z in spectrum(scheme, r, lam, direction, 80) if abs(z) > 1 + 1e-6]
    modes = growing(found.modes)
    assert len(modes) == len(outside)
    for z in modes:
        assert min(abs(other - z) for other in outside) < 1e-5 * abs(z)


def test_linear_extrapolation_at_inflow_is_generalized() -> None:
    """The constant state obeys it in every ghost: z = kappa = 1, and twice, as Delta has the factor (kappa - 1)**2."""
    scheme = written(lax_wendroff(4, INFLOW), extrapolation(4, 2))
    result = analyse(scheme, scheme.values({}))
    assert result.verdict is Verdict.GENERALIZED
    assert (result.tier, result.certified) == ("certified", True)
    assert [(m.kind, m.z_complex, m.multiplicity) for m in result.modes] == [(ModeKind.GENERALIZED, 1, 2)]


def test_the_route_is_taken_where_elimination_is_too_wide() -> None:
    wide = written(lax_wendroff(4, OUTFLOW), extrapolation(4, 2))
    narrow = written(lax_wendroff(1, OUTFLOW), extrapolation(1, 2))
    assert beyond_elimination(normal_mode_problem(wide, wide.values({})))
    assert not beyond_elimination(normal_mode_problem(narrow, narrow.values({})))
    assert analyse(wide, wide.values({})).tier == "certified"
    assert analyse(narrow, narrow.values({})).tier == "exact"


# Systems --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("lam, stable", [("1/2", True), ("1", False)])
def test_summation_by_parts_with_penalties(lam: str, stable: bool) -> None:
    """Sixteen equations. At lam = 1 the boundary rows' own eigenvalues are too large for three stages."""
    scheme = coupled_by_penalties("ssprk3", "2")
    values = scheme.values({"lam": lam})
    result = analyse(scheme, values)
    assert (result.tier, result.certified) == ("certified", True)
    assert result.verdict is (Verdict.STABLE if stable else Verdict.UNSTABLE)
    finite = largest_modulus(scheme, values, 16)
    if stable:
        assert finite < 1
    else:
        assert finite == pytest.approx(max(float(m.modulus) for m in result.modes), rel=1e-9)


def test_interfaces_of_systems() -> None:
    """Two acoustic half-lines with different impedances under several operators."""
    pairs = 'equations = ["L.u[1] = L.u[0]", "L.s[1] = R.s[0]", "R.u[-1] = L.u[0]", "R.s[-1] = R.s[0]"]'
    for space, time in (("central2", "bdf2"), ("upwind1", "rk4")):
        wide = agree(interface(pairs, time, space), alpha="3", lam="1/2")
        assert wide is not None
        assert wide.certified


TWO_FIELDS_OF_REACH_TWO = r'''
title = "two coupled unknowns of reach two, four closure equations of several levels"
[parameters]
lam = { role = "cfl", default = "1/2" }
[domains.R]
side = "left"
first = 3
unknowns = ["u", "s"]
interior = [
  """u[i+0, n+1] + (-13/45)*u[i+2] + (-4/15)*s[i+2] + (-19/120)*u[i+1] + (-7/40)*s[i+1] + (-47/180)*u[i+0] + \
     (-11/60)*s[i+0] + (29/90)*u[i-1] + (1/15)*s[i-1] + (89/360)*u[i-2] + (17/120)*s[i-2] = 0""",
  """s[i+0, n+1] + (28/135)*u[i+2] + (19/45)*s[i+2] + (49/360)*u[i+1] + (37/120)*s[i+1] + (77/540)*u[i+0] + \
     (41/180)*s[i+0] + (-7/135)*u[i-1] + (13/90)*s[i-1] + (-119/1080)*u[i-2] + (-47/360)*s[i-2] = 0""",
]
[closure]
equations = [
  """R.u[-1, n+1] + (2)*R.u[-1] + (-3/2)*R.u[-3] + (-3/2)*R.s[-4] + (-5)*R.u[-5, n-1] = 0""",
  """R.u[-2, n+1] + (-2)*R.u[-3, n+1] + (1)*R.u[-4, n+1] = 0""",
  """R.s[-1, n+1] + (-3)*R.s[-2, n+1] + (3)*R.s[-3, n+1] + (-1)*R.s[-4, n+1] = 0""",
  """R.s[-2, n+1] + (-3)*R.s[-3] + (3)*R.s[-4, n-1] + (-1)*R.s[-5, n-2] = 0""",
]
'''


def test_the_count_goes_first_where_elimination_would_take_minutes() -> None:
    """36 sets of decaying roots and a closure of degree 4 in z: the norm over all of them has hundreds of roots."""
    scheme = parse_scheme(TWO_FIELDS_OF_REACH_TWO, "laborious")
    problem = normal_mode_problem(scheme, scheme.values({}))
    assert not beyond_elimination(problem)
    assert laborious(problem)
    found = analyse(scheme, scheme.values({}))
    assert (found.verdict.value, found.tier) == ("unstable", "certified")
    assert largest_modulus(scheme, scheme.values({}), 40) == pytest.approx(float(found.modes[0].modulus), rel=1e-6)


def test_long_coefficients_are_no_reason_to_wait() -> None:
    scheme = catalogue.find("lax-wendroff-order-6-oblique")
    short, long = (normal_mode_problem(scheme, scheme.values({"lam": lam})) for lam in ("1/2", "0.123456789012"))
    assert (laborious(short), laborious(long)) == (False, True)
    assert analyse(scheme, scheme.values({"lam": "0.123456789012"})).verdict.value == "stable"
