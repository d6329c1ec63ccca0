"""Named operators: order from both sides, reflection, and what a half-line reads."""

from __future__ import annotations

from fractions import Fraction as F

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.errors import SchemeError
from gks.scheme.expression import Expr, number, sqrt, symbol
from gks.scheme.model import (
    GridValue,
    HalfLine,
    Interior,
    LinearForm,
    NamedLines,
    NamedScheme,
    Parameter,
    WrittenDiscrete,
)
from gks.scheme.operators import DISCRETE_SCHEMES, SPACE_OPERATORS, discrete_stencil, reach, stencil

BOTH = pytest.mark.parametrize("positive", [True, False])


@BOTH
@pytest.mark.parametrize("name", SPACE_OPERATORS)
def test_space_operators_are_exact_up_to_their_order_and_not_beyond(name: str, positive: bool) -> None:
    operator = stencil(name, positive)

    def defect(degree: int) -> F:
        """sum d_j p(j) - sum m_j p'(j) for p = x**degree."""
        values = sum(d * F(j) ** degree for j, d in operator.derivative.items())
        slopes = sum(m * degree * F(j) ** (degree - 1) for j, m in operator.mass.items()) if degree else F(0)
        return F(values - slopes)

    assert [defect(k) for k in range(operator.order + 1)] == [0] * (operator.order + 1)
    assert defect(operator.order + 1) != 0


def shifted(coefficients: tuple[F, ...], nu: F) -> F:
    return sum((c * nu**power for power, c in enumerate(coefficients)), F(0))


@BOTH
@pytest.mark.parametrize("name", DISCRETE_SCHEMES)
def test_discrete_schemes_are_exact_up_to_their_order_and_not_beyond(name: str, positive: bool) -> None:
    """q(x, t) = (x - a t)**k moves by nu: the moments sum c_j(nu) j**k must be (-nu)**k, an identity in nu."""
    scheme = discrete_stencil(name, positive)

    def defects(degree: int) -> list[F]:
        """At more values of nu than the polynomials (degree at most degree + 2) have coefficients."""
        return [
            sum((shifted(c, F(nu)) * F(j) ** degree for j, c in scheme.coefficients.items()), F(0)) - F(-nu) ** degree
            for nu in range(-degree - 2, degree + 3)
        ]

    for degree in range(scheme.order + 1):
        assert not any(defects(degree))
    assert any(defects(scheme.order + 1))


@BOTH
def test_fromm_is_the_mean_of_lax_wendroff_and_beam_warming(positive: bool) -> None:
    first = discrete_stencil("lax-wendroff", positive).coefficients
    second = discrete_stencil("beam-warming", positive).coefficients
    zero = (F(0), F(0), F(0))
    mean = {
        j: tuple((a + b) / 2 for a, b in zip(first.get(j, zero), second.get(j, zero), strict=True))
        for j in first.keys() | second.keys()
    }
    assert mean == dict(discrete_stencil("fromm", positive).coefficients)


def test_every_discrete_scheme_moves_exactly_one_cell_at_courant_number_one() -> None:
    for name in DISCRETE_SCHEMES:
        for positive in (True, False):
            nu = F(1 if positive else -1)
            moved = {j: shifted(c, nu) for j, c in discrete_stencil(name, positive).coefficients.items()}
            assert {j for j, c in moved.items() if c} == {-nu}, name
            assert moved[int(-nu)] == 1


def test_symmetric_operators_are_their_own_reflection() -> None:
    for operator in SPACE_OPERATORS.values():
        reflected = operator.mirrored()
        same = dict(reflected.mass) == dict(operator.mass) and dict(reflected.derivative) == dict(operator.derivative)
        assert same is not operator.upwinded, operator.name
        assert reflected.mirrored() == operator
    for scheme in DISCRETE_SCHEMES.values():
        assert (dict(scheme.mirrored().coefficients) == dict(scheme.coefficients)) is not scheme.upwinded, scheme.name


@BOTH
@pytest.mark.parametrize("name", [n for n, s in SPACE_OPERATORS.items() if s.upwinded])
def test_upwind_stencils_lean_against_the_wave(name: str, positive: bool) -> None:
    offsets = stencil(name, positive).derivative
    assert (-min(offsets) > max(offsets)) is positive


# --- reach --------------------------------------------------------------------------------------------------------

LAM = Parameter("lam", "cfl", F(9, 10), F(0), None, False, "")


def parameter(name: str, default: int | None = 1, low: F | None = F(0), high: F | None = None) -> Parameter:
    return Parameter(name, None, None if default is None else F(default), low, high, True, "")


def line(flux: list[list[Expr | int]], interior: Interior) -> HalfLine:
    rows = tuple(tuple(number(e) if isinstance(e, int) else e for e in row) for row in flux)
    return HalfLine("R", "right", tuple("uvwxyz"[: len(rows)]), 0, rows, interior)


UPWIND = NamedLines("upwind1", "forward-euler")


def test_an_upwind_wave_system_reads_both_unknowns_on_both_sides() -> None:
    """It reads one combination of two ghosts; both are unknowns."""
    alpha = symbol("alpha")
    flux = line([[0, -1 / alpha], [-alpha, 0]], UPWIND)
    assert reach(flux, [LAM, parameter("alpha")]) == {"u": (-1, 1), "v": (-1, 1)}


def test_diagonal_fields_are_read_from_where_their_waves_come() -> None:
    assert reach(line([[1, 0], [0, -1]], UPWIND), [LAM]) == {"u": (-1, 0), "v": (0, 1)}
    assert reach(line([[1, 0], [0, -1]], NamedLines("upwind3", "rk4")), [LAM]) == {"u": (-2, 1), "v": (-1, 2)}


def test_triangular_flux_reads_by_columns() -> None:
    """A = [[1, 3], [0, -1]] has e_1 as eigenvector of 1: u is read from the left only, v, in both fields, from both."""
    assert reach(line([[1, 3], [0, -1]], UPWIND), [LAM]) == {"u": (-1, 0), "v": (-1, 1)}


def test_a_field_at_rest_is_read_nowhere_else() -> None:
    assert reach(line([[0, 0], [0, 2]], UPWIND), [LAM]) == {"u": (0, 0), "v": (-1, 0)}
    assert reach(line([[0, 0], [0, 2]], NamedScheme("lax-wendroff")), [LAM]) == {"u": (0, 0), "v": (-1, 1)}
    assert reach(line([[0, 0], [0, 2]], NamedScheme("lax-friedrichs")), [LAM]) == {"u": (-1, 1), "v": (-1, 1)}


def test_compact_schemes_read_the_mass_of_every_unknown() -> None:
    assert reach(line([[0, 0], [0, 2]], NamedLines("compact4", "rk4")), [LAM]) == {"u": (-1, 1), "v": (-1, 1)}


def test_the_sign_of_a_speed_is_free_over_its_range() -> None:
    speed = symbol("a")
    both = parameter("a", low=F(-1), high=F(1))
    assert reach(line([[speed]], UPWIND), [LAM, both]) == {"u": (-1, 1)}
    assert reach(line([[speed]], UPWIND), [LAM, parameter("a")]) == {"u": (-1, 0)}
    assert reach(line([[speed - 1]], UPWIND), [LAM, parameter("a", 2, F(1, 10**4), F(10**4))]) == {"u": (-1, 1)}


def test_a_coefficient_that_cancels_identically_is_not_read() -> None:
    a, lam = symbol("a"), symbol("lam")
    assert reach(line([[a - a]], UPWIND), [LAM, parameter("a")]) == {"u": (0, 0)}
    # Courant number one, whatever lam: the whole update is u[i-1]
    assert reach(line([[1 / lam]], NamedScheme("fromm")), [LAM]) == {"u": (-1, 0)}


def test_irrational_speeds_are_decided_in_balls() -> None:
    root = sqrt(symbol("a") + 1)
    flux = line([[0, root], [root, 0]], UPWIND)
    assert reach(flux, [LAM, parameter("a")]) == {"u": (-1, 1), "v": (-1, 1)}
    # sqrt(a + 1)**2 - a - 1 = 0: v is at rest
    assert reach(line([[root, 0], [0, root * root - symbol("a") - 1]], UPWIND), [LAM, parameter("a")])["v"] == (0, 0)


def test_complex_speeds_and_missing_eigenvectors_are_refused_where_upwinding_needs_them() -> None:
    with pytest.raises(SchemeError, match=r"not hyperbolic.*1\.00000j") as raised:
        reach(line([[0, 1], [-1, 0]], UPWIND), [LAM])
    assert raised.value.path == "domains.R.flux"
    with pytest.raises(SchemeError, match="not hyperbolic"):
        reach(line([[1, 1], [0, 1]], NamedScheme("fromm")), [LAM])
    assert reach(line([[0, 1], [-1, 0]], NamedLines("central2", "rk4")), [LAM]) == {"u": (-1, 1), "v": (-1, 1)}


def test_written_equations_are_read_as_they_stand() -> None:
    terms = ((GridValue("R", "u", 0, 1), number(1)), (GridValue("R", "u", 1, -1), -symbol("lam")))
    written = WrittenDiscrete((LinearForm(terms),))
    assert reach(HalfLine("R", "right", ("u",), 0, None, written), [LAM]) == {"u": (0, 1)}


@given(st.lists(st.integers(-3, 3), min_size=1, max_size=4), st.data())
def test_reach_agrees_with_the_projectors_of_a_known_diagonalisation(speeds: list[int], data: st.DataObject) -> None:
    """A = T diag(speeds) T**-1 with T unit triangular: A+ and A- formed outright, as matrices."""
    import sympy

    n = len(speeds)
    t = sympy.eye(n)
    for i in range(n):
        for j in range(i):
            t[i, j] = data.draw(st.integers(-2, 2))
    flux = t * sympy.diag(*speeds) * t.inv()
    plus = t * sympy.diag(*[max(s, 0) for s in speeds]) * t.inv()
    minus = t * sympy.diag(*[min(s, 0) for s in speeds]) * t.inv()
    rows: list[list[Expr | int]] = [[int(flux[i, j]) for j in range(n)] for i in range(n)]
    expected = {
        "uvwxyz"[k]: (-1 if any(plus[i, k] for i in range(n)) else 0, 1 if any(minus[i, k] for i in range(n)) else 0)
        for k in range(n)
    }
    assert reach(line(rows, UPWIND), [LAM]) == expected
