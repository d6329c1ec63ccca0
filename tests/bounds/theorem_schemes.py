"""Schemes for the theorems' tests."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from gks.catalogue.interfaces import UPWIND, closure_lines, ghost_equations, two_media
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

LEAPFROG_OUTFLOW = """
title = "Leapfrog, outflow by oblique extrapolation"
[parameters]
lam = { role = "cfl", default = 0.5 }
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"]
first = 1
[closure]
equations = ["u[0, n+1] = u[1, n]"]
"""

HALF_LINE = """
title = "A closure with a parameter"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
a = {{ default = 1, range = [{low}, {high}] }}
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["{interior}"]
first = 1
[closure]
equations = ["u[0, n+1] = {closure}"]
"""

LAX_WENDROFF = "u[i, n+1] = u[i] + lam/2*(u[i+1] - u[i-1]) + lam**2/2*(u[i+1] - 2*u[i] + u[i-1])"
LEAPFROG = "u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"
BACKWARD_EULER = "u[i, n+1] = u[i] + lam/2*(u[i+1, n+1] - u[i-1, n+1])"
CRANK_NICOLSON = "u[i, n+1] - lam/4*(u[i+1, n+1] - u[i-1, n+1]) = u[i] + lam/4*(u[i+1] - u[i-1])"

_ADVECTION = """
title = "Weights in characteristic variables"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
p = {{ default = 1, range = [0, inf] }}
[domains.L]
side = "left"
unknowns = ["v", "w"]
interior = ["v[i, n+1] = v[i] + lam*(v[i+1] - v[i])", "w[i, n+1] = w[i] - lam*(w[i] - w[i-1])"]
[domains.R]
side = "right"
unknowns = ["v", "w"]
interior = ["v[i, n+1] = v[i] + lam*(v[i+1] - v[i])", "w[i, n+1] = w[i] - lam*(w[i] - w[i-1])"]
[closure]
equations = ["L.v[1] = {v}", "R.w[-1] = {w}"]
"""


def half_line(interior: str, closure: str, low: str = "0", high: str = "inf") -> Scheme:
    """u_t = u_x on x > 0 with one boundary point, a closure that holds the parameter a, and the range of a."""
    return parse_scheme(HALF_LINE.format(interior=interior, closure=closure, low=low, high=high), "half-line")


def interface(name: str, low: str = "0", high: str = "inf") -> Scheme:
    """The traditional coupling of two half-lines under a named fully discrete scheme."""
    return _coupled(name, f'scheme = "{name}"', _parameters(low, high), "L.u[0]", "R.s[0]")


def upwind_interface(low: str, high: str, u: str = "L.u[0]", s: str = "R.s[0]", further: str = "") -> Scheme:
    """First-order upwinding with interface values given, alpha over a range; further parameters as lines of TOML."""
    return _coupled("upwind", UPWIND, f"{_parameters(low, high)}\n{further}", u, s)


def _parameters(low: str, high: str) -> str:
    return f'lam = {{ role = "cfl", default = 0.5 }}\nalpha = {{ default = 1, range = [{low}, {high}] }}'


def _coupled(name: str, interior: str, parameters: str, u: str, s: str) -> Scheme:
    closure = closure_lines(ghost_equations(1), {"u_I": u, "s_I": s})
    return parse_scheme(two_media(name, parameters, interior, closure), name)


def advection_interface(weights: Sequence[Fraction]) -> Scheme:
    """Upwinded advection both ways; what leaves the interface hangs on both sides, by rational weights and p."""
    a, b, c, d = (f"({w})" for w in weights)
    v = f"({a} + {b}*p)*L.v[0] + {c}*R.w[0] + R.v[0]"
    w = f"({d} + p)*L.v[0] - L.w[0]"
    return parse_scheme(_ADVECTION.format(v=v, w=w), "advection")


def weighted_interface(weights: Sequence[Fraction]) -> Scheme:
    """First-order upwinding with interface values that any two rational combinations give."""
    a, b, c, d, e, f = (f"({w})" for w in weights)
    u = f"{a}*L.u[0] + {b}*R.u[0] + {c}*(L.s[0] - R.s[0])"
    s = f"{d}*L.s[0] + {e}*R.s[0] + {f}*(L.u[0] - R.u[0])"
    return upwind_interface("0", "inf", u, s)


_FLUX = """
title = "A wave speed with a parameter"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
a = {{ default = 1, range = [-inf, inf] }}
[interior]
space = "upwind1"
time = "forward-euler"
[domains.R]
side = "right"
unknowns = ["u"]
flux = [["{speed}"]]
[closure]
equations = ["u[-1] = {closure}"]
"""


def upwind_flux(speed: str, closure: str = "u[0]") -> Scheme:
    """u_t + speed u_x = 0 on x > 0, first-order upwinding, whatever the sign of the speed."""
    return parse_scheme(_FLUX.format(speed=speed, closure=closure), "flux")


APART = parse_scheme(
    """
title = "two half-lines that share no equation"
[parameters]
lam = { role = "cfl", default = "1/2" }
[domains.L]
side = "left"
unknowns = ["v"]
interior = ["v[i, n+1] = (v[i+1] + v[i-1])/2 + lam*3/4*(v[i+1] - v[i-1])/2"]
first = 1
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = (u[i+1] + u[i-1])/2 + lam/2*(u[i+1] - u[i-1])"]
first = 1
[closure]
equations = ["R.u[0, n+1] = R.u[1, n+1]*(3 - 4*lam)", "L.v[0, n+1] = 0"]
""",
    "apart",
)
"""Inside the unit circle no solution decays on the left: where R has a mode there are fewer than outside."""
