"""The classical closures of u_t = u_x on x > 0 (outflow at x = 0), written as they are printed.

Gustafsson, Kreiss & Sundström, Math. Comp. 26 (1972); Gustafsson, Kreiss & Oliger, Time Dependent Problems and
Difference Methods, ch. 11; Goldberg & Tadmor, Math. Comp. 36 (1981); Trefethen, Comm. Pure Appl. Math. 37 (1984).
"""

from __future__ import annotations

from math import comb

from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

INTERIORS = {
    "leapfrog": "u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])",
    "lax-wendroff": "u[i, n+1] = u[i] + lam/2*(u[i+1] - u[i-1]) + lam**2/2*(u[i+1] - 2*u[i] + u[i-1])",
    "lax-friedrichs": "u[i, n+1] = (u[i+1] + u[i-1])/2 + lam/2*(u[i+1] - u[i-1])",
    "crank-nicolson": "u[i, n+1] - lam/4*(u[i+1, n+1] - u[i-1, n+1]) = u[i] + lam/4*(u[i+1] - u[i-1])",
    "backward-euler": "u[i, n+1] - lam/2*(u[i+1, n+1] - u[i-1, n+1]) = u[i]",
}


def space_extrapolation(order: int, at: int = 0) -> str:
    """(E - 1)**(order + 1) u = 0 at the new level."""
    terms = [f"({(-1) ** k * comb(order + 1, k + 1)})*u[{at + k + 1}, n+1]" for k in range(order + 1)]
    return f"u[{at}, n+1] = {' + '.join(terms)}"


def oblique_extrapolation(order: int, at: int = 0) -> str:
    """The same along the diagonal: each step inwards is a step back in time."""
    levels = ["n", *(f"n-{k}" for k in range(1, order + 1))]
    terms = [f"({(-1) ** k * comb(order + 1, k + 1)})*u[{at + k + 1}, {levels[k]}]" for k in range(order + 1)]
    return f"u[{at}, n+1] = {' + '.join(terms)}"


CLOSURES = {
    **{f"space-{order}": space_extrapolation(order) for order in range(4)},
    **{f"oblique-{order}": oblique_extrapolation(order) for order in range(4)},
    "one-sided": "u[0, n+1] = u[0] + lam*(u[1] - u[0])",
    "one-sided-implicit": "u[0, n+1] = u[0] + lam*(u[1, n+1] - u[0, n+1])",
    "box": "u[0, n+1] + u[1, n+1] - lam*(u[1, n+1] - u[0, n+1]) = u[0] + u[1] + lam*(u[1] - u[0])",
}


def half_line(interior: str, *closure: str, first: int = 1, side: str = "right", time: str = "") -> Scheme:
    """One unknown u on one half-line; ``interior`` is an equation, or the name of one of INTERIORS."""
    equations = ", ".join(f'"{equation}"' for equation in closure)
    return parse_scheme(
        f"""
title = "half-line"
[parameters]
lam = {{ role = "cfl", default = "1/2" }}
[domains.R]
side = "{side}"
unknowns = ["u"]
interior = ["{INTERIORS.get(interior, interior)}"]
first = {first}
{f'time = "{time}"' if time else ""}
[closure]
equations = [{equations}]
""",
        "half-line",
    )
