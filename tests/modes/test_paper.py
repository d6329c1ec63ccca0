"""Banks & Sjögreen's interface conditions: the 2x2 system for (a_L, b_R) solved with sympy, against elimination.

Outgoing modes are u_L,i = c r**(i-1) a, s_L,i = kappa_L r**(i-1) a for i <= 1 and u_R,i = -c r**(-i-1) b,
s_R,i = kappa_R r**(-i-1) b for i >= -1, with z = 1 + lam (r - 1). A ghost value (u, s) on the left has the amplitude
a = u/(2 c) + s/(2 kappa_L), on the right b = -u/(2 c) + s/(2 kappa_R), and must have none of the other wave. Here
c = kappa_L = 1, kappa_R = alpha. Nothing is taken from the paper's printed polynomials, radicals or moduli.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import mpmath
import pytest
import sympy

from gks import catalogue
from gks.bounds.cfl import stable_set
from gks.modes import Mode, Verdict, analyse, derive

Symbolic = Any
A, B, R, ALPHA = sympy.symbols("a b r alpha")


def left(i: int) -> tuple[Symbolic, Symbolic]:
    """(u, s) in cell i of the left half-line."""
    return R ** (i - 1) * A, R ** (i - 1) * A


def right(i: int) -> tuple[Symbolic, Symbolic]:
    return -(R ** (-i - 1)) * B, ALPHA * R ** (-i - 1) * B


def first_order(side: Callable[[int], tuple[Symbolic, Symbolic]]) -> tuple[Symbolic, Symbolic]:
    return side(0)


def second_order(side: Callable[[int], tuple[Symbolic, Symbolic]]) -> tuple[Symbolic, Symbolic]:
    """Linear extrapolation from cells 0 and one further in to the interface, half a cell away."""
    further = side(-1) if side is left else side(1)
    return tuple(sympy.Rational(3, 2) * p - sympy.Rational(1, 2) * q for p, q in zip(side(0), further, strict=True))


State = tuple[Symbolic, Symbolic]


def traditional(one: State, other: State) -> State:
    """Velocity from the left, stress from the right."""
    return one[0], other[1]


def average(one: State, other: State) -> State:
    return (one[0] + other[0]) / 2, (one[1] + other[1]) / 2


def weighted(one: State, other: State) -> State:
    """Weights 1/(c rho): the softer side gives the velocity, the stiffer one the stress."""
    soft_left, soft_right = 1, 1 / ALPHA
    total = soft_left + soft_right
    return (soft_right * one[0] + soft_left * other[0]) / total, (soft_left * one[1] + soft_right * other[1]) / total


def characteristic(one: State, other: State) -> State:
    """The Riemann problem: s - u carries from the left (c = kappa_L = 1), s/alpha + u from the right."""
    u, s = sympy.symbols("u s")
    found = sympy.solve([s - u - (one[1] - one[0]), s / ALPHA + u - (other[1] / ALPHA + other[0])], [u, s])
    return found[u], found[s]


RULES: dict[str, tuple[Callable[[State, State], State], int]] = {
    "traditional-1": (traditional, 1),
    "implicit-1": (traditional, 1),
    "average-1": (average, 1),
    "weighted-1": (weighted, 1),
    "characteristic-1": (characteristic, 1),
    "traditional-2": (traditional, 2),
    "weighted-2": (weighted, 2),
    "characteristic-2": (characteristic, 2),
}


def by_hand(name: str) -> Symbolic:
    """The determinant of the 2x2 system, cleared of powers of r and of factors without r, primitive."""
    rule, order = RULES[name]
    value = first_order if order == 1 else second_order
    u, s = rule(value(left), value(right))
    if order == 1:
        ghost_left = ghost_right = (u, s)
    else:
        # Reflection: the mean of the ghost and of cell 0 is the interface value.
        ghost_left = (2 * u - left(0)[0], 2 * s - left(0)[1])
        ghost_right = (2 * u - right(0)[0], 2 * s - right(0)[1])
    a = sympy.expand(ghost_left[0] / 2 + ghost_left[1] / 2 - A)
    b = sympy.expand(-ghost_right[0] / 2 + ghost_right[1] / (2 * ALPHA) - B)
    determinant = sympy.Matrix([[e.coeff(A), e.coeff(B)] for e in (a, b)]).det()
    numerator = sympy.fraction(sympy.cancel(sympy.together(determinant)))[0]
    kept = [factor**power for factor, power in sympy.factor_list(numerator)[1] if factor.has(R) and factor != R]
    return sympy.expand(sympy.prod(kept))


@pytest.mark.parametrize("name", RULES)
def test_characteristic_polynomial(name: str) -> None:
    found = derive(catalogue.find(name), {})
    assert found.variable == "r"
    derived = sympy.sympify(found.characteristic_polynomial, locals={"r": R, "alpha": ALPHA})
    assert sympy.expand(derived - by_hand(name)) == 0 or sympy.expand(derived + by_hand(name)) == 0


def assert_matched(modes: tuple[Mode, ...], roots: list[Symbolic], places: int) -> None:
    """Every root of the list is a mode and the other way round, to so many relative digits."""
    points = [
        mpmath.mpc(*(mpmath.mpf(part.numerator) / part.denominator for part in m.z))
        for m in modes
        for _ in range(m.multiplicity)
    ]
    assert len(points) == len(roots)
    for root in roots:
        nearest = min(points, key=lambda z: abs(z - root))
        assert abs(nearest - root) <= mpmath.mpf(10) ** -places * abs(root)
        points.remove(nearest)


@pytest.mark.parametrize("alpha", ["1e-10", "1/3", "1", "31/9", "1e10"])
@pytest.mark.parametrize("name", ["traditional-1", "traditional-2", "average-1"])
def test_roots_at_sixty_digits(name: str, alpha: str) -> None:
    scheme = catalogue.find(name)
    polynomial = sympy.Poly(by_hand(name).subs(ALPHA, sympy.Rational(alpha)), R)
    with mpmath.workdps(60):
        roots = zeros_of(polynomial.as_expr())
        growth = [1 + mpmath.mpf(9) / 10 * (r - 1) for r in roots]
        assert_matched(analyse(scheme, scheme.values({"alpha": alpha, "lam": "9/10"})).modes, growth, 20)


def zeros_of(polynomial: Symbolic) -> list[Symbolic]:
    """All roots of a rational polynomial in r at the working precision, multiple ones by square-free factors."""
    found = []
    for factor, power in sympy.factor_list(polynomial, R)[1]:
        _, cleared = sympy.Poly(factor, R).clear_denoms()
        numbers = [mpmath.mpf(int(c)) for c in cleared.all_coeffs()]
        found += power * list(mpmath.polyroots(numbers, maxsteps=5000, extraprec=mpmath.mp.prec))
    return found


def bound_by_hand(name: str, alpha: Symbolic) -> Symbolic:
    """min(1, -2 Re 1/(r - 1)) over the roots with abs(r) > 1 once abs(z) >= 1, that is over all with Re(r) < 1."""
    polynomial = sympy.Poly(by_hand(name), R)
    coefficients = [sympy.lambdify(ALPHA, c, "mpmath")(alpha) for c in polynomial.all_coeffs()]
    roots = mpmath.polyroots([mpmath.mpf(c) for c in coefficients], maxsteps=500, extraprec=200)
    return min([mpmath.mpf(1), *(-2 * mpmath.re(1 / (r - 1)) for r in roots)])


@pytest.mark.parametrize("name", ["traditional-1", "traditional-2", "average-1", "weighted-2"])
@pytest.mark.parametrize("exponent", range(-10, 11, 4))
def test_largest_stable_lam_over_twenty_decades(name: str, exponent: int) -> None:
    """The interior's limit is 1, and abs(1 + lam (r - 1)) < 1 for lam < -2 Re 1/(r - 1). For lam <= 1 a root with
    abs(z) >= 1 has abs(r) >= 1, so it decays: no root is inadmissible where it matters."""
    scheme = catalogue.find(name)
    alpha = Fraction(10) ** exponent
    top = stable_set(scheme, scheme.values({"alpha": alpha})).lam_max
    assert top is not None
    with mpmath.workdps(60):
        expected = bound_by_hand(name, mpmath.mpf(10) ** exponent)
        ball = top.ball(200).real
        assert abs(mpmath.mpf(ball.mid().str(50, radius=False)) / expected - 1) < mpmath.mpf(10) ** -40
        assert abs(float(ball.mid()) / float(expected) - 1) < 1e-15


def printed_form(x: Symbolic, sqrt: Callable[[Symbolic], Symbolic]) -> Symbolic:
    """Theorem 3.4's nested radical, in the ratio x = kappa_R/kappa_L."""
    return 1.5 - sqrt(2.0) / 4 * sqrt((-7 + 2 * x + 9 * x**2 + sqrt((49 + 81 * x) * (x + 1) ** 3)) / (x + 1) ** 2)


def test_a_closed_form_in_doubles_loses_what_the_exact_route_holds() -> None:
    """At alpha = 1e10 the radical is a difference of numbers near 3/2: the last digits of its 7e-11 are noise."""
    scheme = catalogue.find("traditional-2")
    top = stable_set(scheme, scheme.values({"alpha": "1e10"})).lam_max
    assert top is not None
    exact = float(top.ball().real.mid())
    assert abs(exact / 7.407407406856882e-11 - 1) < 1e-15
    with mpmath.workdps(60):
        assert abs(printed_form(mpmath.mpf(10) ** 10, mpmath.sqrt) / exact - 1) < 1e-15
    assert abs(printed_form(1e10, math.sqrt) / exact - 1) > 1e-8


@pytest.mark.parametrize("name", sorted(RULES))
@pytest.mark.parametrize("alpha", ["1e-300", "1e300"])
def test_verdicts_at_the_ends_of_the_doubles(name: str, alpha: str) -> None:
    """Against the same roots from mpmath, with more digits than the ratio has."""
    scheme = catalogue.find(name)
    found = analyse(scheme, scheme.values({"alpha": alpha, "lam": "9/10"}))
    with mpmath.workdps(350):
        roots = zeros_of(by_hand(name).subs(ALPHA, sympy.Rational(Fraction(alpha))))
        lam = mpmath.mpf(9) / 10
        implicit = name == "implicit-1"
        sizes = [abs(1 / (1 - lam * (r - 1)) if implicit else 1 + lam * (r - 1)) for r in roots if abs(r) > 1]
        expected = Verdict.UNSTABLE if any(size > 1 for size in sizes) else Verdict.STABLE
    assert found.verdict is expected


def test_one_exactly_neutral_parameter_and_its_neighbours() -> None:
    """abs(z)**2 = 1 - lam + lam**2 (1 + alpha)/4 is 1 at lam = 9/10, alpha = 31/9: roots r = (1 +- i sqrt(31)/3)/2."""
    scheme = catalogue.find("traditional-1")
    tiny = Fraction(1, 10**100)
    at = {
        shift: analyse(scheme, scheme.values({"lam": "9/10", "alpha": Fraction(31, 9) + shift}))
        for shift in (-tiny, 0, tiny)
    }
    assert [found.verdict for found in at.values()] == [Verdict.STABLE, Verdict.NEUTRAL, Verdict.UNSTABLE]
    assert all(m.modulus == 1 for m in at[0].modes)
    assert at[0].margin == 0
    # The real parts are exactly 1 + lam (1/2 - 1) = 11/20.
    assert all(abs(m.z[0] - Fraction(11, 20)) <= m.radius for m in at[0].modes)


def test_the_double_root_of_the_weighted_coupling_is_exact_at_every_ratio() -> None:
    scheme = catalogue.find("weighted-1")
    for alpha in ("1e-300", "1e-10", "1", "7/3", "1e300"):
        (mode,) = analyse(scheme, scheme.values({"alpha": alpha, "lam": "9/10"})).modes
        assert mode.multiplicity == 2
        assert abs(mode.z[0] - Fraction(11, 20)) <= mode.radius


def test_neutral_ratio_of_the_second_order_coupling() -> None:
    """At lam = 9/10 the ratio where abs(z) = 1, from the resultant with the circle, against a bisection in 60
    digits.
    """
    scheme = catalogue.find("traditional-2")
    with mpmath.workdps(60):
        low, high = mpmath.mpf("0.1"), mpmath.mpf(1)
        for _ in range(140):
            middle = (low + high) / 2
            low, high = (middle, high) if bound_by_hand("traditional-2", middle) > mpmath.mpf(9) / 10 else (low, middle)
        ratio = Fraction(mpmath.nstr(low, 45))
    gap = Fraction(1, 10**40)
    assert analyse(scheme, scheme.values({"lam": "9/10", "alpha": ratio - gap})).verdict is Verdict.STABLE
    assert analyse(scheme, scheme.values({"lam": "9/10", "alpha": ratio + gap})).verdict is Verdict.UNSTABLE
    assert abs(float(ratio) - 0.1876) < 5e-5
