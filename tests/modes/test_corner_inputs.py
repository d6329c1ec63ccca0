"""Inputs at the edge of what a scheme file can say: fields that stand still, closures that are no ODE, lam <= 0."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from gks.errors import ParameterError, SchemeError
from gks.modes import Verdict, analyse
from gks.scheme.model import Scheme
from gks.scheme.operators import stencil
from gks.scheme.schemefile import parse_scheme
from tests.oracle.finite_matrix import largest_modulus


def half_line(keys: str, closure: str, flux: str = "1", first: int = 0) -> Scheme:
    return parse_scheme(
        f'title = "corner"\n[parameters]\nlam = {{ role = "cfl", default = "1/4" }}\n[domains.R]\nside = "right"\n'
        f'unknowns = ["u"]\nflux = [["{flux}"]]\nfirst = {first}\n{keys}\n[closure]\nequations = [{closure}]\n',
        "corner",
    )


def lines(space: str, time: str) -> str:
    return f'space = "{space}"\ntime = "{time}"'


GHOSTS = {"upwind1": 1, "upwind2": 2, "upwind3": 2, "fromm": 2, "central2": 1, "central4": 2, "compact4": 1}


@pytest.mark.parametrize("time", ["forward-euler", "leapfrog", "ab3", "bdf2", "rk4", "exact"])
@pytest.mark.parametrize("space", ["upwind1", "central4", "compact4"])
def test_a_field_with_speed_zero_stands_still(space: str, time: str) -> None:
    """q_t = 0 whatever its ghosts do: nothing reads them, and a value twice the first cell's feeds nothing back."""
    for keys in (lines(space, time), 'scheme = "lax-wendroff"'):
        ghosts = ", ".join(f'"u[-{k}] = 2*u[0]"' for k in range(1, 1 + GHOSTS[space]))
        scheme = half_line(keys, ghosts, flux="0")
        assert analyse(scheme, scheme.values({})).verdict is Verdict.STABLE


@pytest.mark.parametrize("value", ["-1/2", "0"])
def test_a_number_of_steps_to_a_cell_is_positive(value: str) -> None:
    """dt/dx is no parameter of a formula like the others: what is not positive is no scheme."""
    scheme = half_line(lines("upwind1", "forward-euler"), '"u[-1] = 0"')
    with pytest.raises(ParameterError, match=r"lam: .* is not positive"):
        analyse(scheme, scheme.values({"lam": value}))


def test_a_ghost_tied_by_derivatives() -> None:
    """dt(u_-1) = dt(u_0) + u_0 with dt(u_0) = u_-1 - u_0: s**2 = 1, and s = 1 has kappa = 1/(1 + s) = 1/2."""
    for time, growth in (("forward-euler", 1.25), ("exact", np.exp(0.25))):
        scheme = half_line(lines("upwind1", time), '"dt(u[-1]) = dt(u[0]) + u[0]"')
        result = analyse(scheme, scheme.values({}))
        assert result.verdict is Verdict.UNSTABLE
        assert float(result.modes[0].modulus) == pytest.approx(growth, rel=1e-15)


def test_a_ghost_that_only_the_next_level_sees() -> None:
    """u_0 = 0 leaves the ghost to the equation of the first cell: explicit steps never give it, implicit ones do."""
    for time in ("forward-euler", "rk4"):
        with pytest.raises(SchemeError, match=r"R\.u\[-1\] is left undetermined"):
            scheme = half_line(lines("upwind1", time), '"u[0] = 0"')
            analyse(scheme, scheme.values({}))
    scheme = half_line(lines("upwind1", "bdf2"), '"u[0] = 0"')
    assert analyse(scheme, scheme.values({})).verdict is Verdict.STABLE


COMPACT = {
    "one-sided": "dt(u[0]) = u[1] - u[0]",
    "compact": "dt(u[0]) + 2*dt(u[1]) = -5/2*u[0] + 2*u[1] + 1/2*u[2]",
    "extrapolated": "u[0] = 2*u[1] - u[2]",
    "growing": "dt(u[0]) = 3*u[0]",
}


@pytest.mark.parametrize("closure", COMPACT)
@pytest.mark.parametrize("time", ["rk4", "bdf2"])
def test_a_compact_interior_with_equations_of_its_own_at_the_boundary(closure: str, time: str) -> None:
    scheme = half_line(lines("compact4", time), f'"{COMPACT[closure]}"', flux="-1", first=1)
    values = scheme.values({})
    result = analyse(scheme, values)
    seen = max(largest_modulus(scheme, values, n) for n in (40, 41))
    if closure == "growing":
        assert result.verdict is Verdict.UNSTABLE
        assert float(result.modes[0].modulus) == pytest.approx(seen, rel=1e-9)
    else:
        assert result.verdict is Verdict.STABLE
        assert seen < 1 + 1e-6


# The interior's own limit ---------------------------------------------------------------------------------------------

# What is known at the limit itself: lam, and whether the interior scheme is Cauchy-stable there.
LIMITS = [
    ("upwind1", "forward-euler", "1", True),  # z = exp(-i theta): a shift
    ("upwind1", "rk2", "1", True),  # the disc abs(mu + 1) <= 1 lies in the region and touches it at 0 and -2
    ("upwind1", "ab2", "1/2", True),  # mu = -1 at theta = pi: z = -1, simple
    ("upwind1", "ab3", "3/11", True),  # mu = -6/11 there
    ("central2", "leapfrog", "1", False),  # z = i twice at theta = pi/2
    ("upwind2", "forward-euler", "1/1000", False),  # mu is nearly imaginary for small theta
    ("central2", "forward-euler", "1/1000", False),
    ("upwind1", "leapfrog", "1/1000", False),
    ("upwind1", "bdf2", "1000", True),  # A-stable
    ("central4", "ab2", "1/1000", False),  # abs(z) - 1 ~ mu**4 / 4 on the imaginary axis
]


@pytest.mark.parametrize(("space", "time", "lam", "stable"), LIMITS)
def test_at_the_limit_itself(space: str, time: str, lam: str, stable: bool) -> None:
    ghosts = ", ".join(f'"u[-{k}] = 0"' for k in range(1, 1 + GHOSTS[space]))
    scheme = half_line(lines(space, time), ghosts)
    result = analyse(scheme, scheme.values({"lam": lam}))
    assert (result.reason != "interior") is stable
    if stable and lam != "1000":
        beyond = analyse(scheme, scheme.values({"lam": str(Fraction(lam) * Fraction(10**9 + 1, 10**9))}))
        assert (beyond.verdict, beyond.reason) == (Verdict.UNSTABLE, "interior")


@pytest.mark.parametrize(
    ("scheme", "limit"), [("lax-friedrichs", 1), ("lax-wendroff", 1), ("beam-warming", 2), ("fromm", 1)]
)
def test_a_shift_at_the_limit(scheme: str, limit: int) -> None:
    """At their limits these move every wave by whole cells, which is stable; just above, waves grow."""
    wide = scheme in ("beam-warming", "fromm")
    file = half_line(f'scheme = "{scheme}"', '"u[-1] = 0", "u[-2] = 0"' if wide else '"u[-1] = 0"')
    assert analyse(file, file.values({"lam": str(limit)})).reason != "interior"
    above = analyse(file, {"lam": limit + Fraction(1, 10**9)})
    assert above.reason == "interior"


def symbol(space: str, theta: NDArray[np.float64]) -> NDArray[np.complex128]:
    """-(the difference operator over its mass) at every wave number: mu = lam times this."""
    operator, wave = stencil(space, True), np.exp(1j * theta)
    slope = sum(float(c) * wave**j for j, c in operator.derivative.items())
    mass = sum(float(c) * wave**j for j, c in operator.mass.items())
    return np.asarray(-slope / mass)


@pytest.mark.parametrize("space", GHOSTS)
def test_an_interior_grows_where_a_wave_is_seen_to(space: str) -> None:
    """Runge-Kutta methods of two and four stages: abs(R(mu)) on a fine grid of wave numbers, 1e-6 off the limit."""
    mu = symbol(space, np.linspace(0, np.pi, 2001))
    ghosts = ", ".join(f'"u[-{k}] = 0"' for k in range(1, 1 + GHOSTS[space]))
    for time, terms in (("rk2", 2), ("rk4", 4)):
        scheme = half_line(lines(space, time), ghosts)
        for lam in (Fraction(1, 10), Fraction(2, 5), Fraction(3, 4), Fraction(5, 4), Fraction(5, 2)):
            factor, term = np.ones_like(mu), np.ones_like(mu)
            for k in range(1, terms + 1):
                term = term * float(lam) * mu / k
                factor = factor + term
            excess = float(np.abs(factor).max()) - 1
            interior = analyse(scheme, {"lam": lam}).reason == "interior"
            assert interior is (excess > 1e-12) or abs(excess) < 1e-6
