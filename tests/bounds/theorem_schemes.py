"""Schemes for the theorems' tests."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

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

_INTERFACE = """
title = "{title}"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
alpha = {{ default = 1, range = [1e-4, 1e4] }}
[interior]
{interior}
[domains.L]
side = "left"
unknowns = ["u", "s"]
flux = [["0", "-1"], ["-1", "0"]]
[domains.R]
side = "right"
unknowns = ["u", "s"]
flux = [["0", "-1/alpha"], ["-alpha", "0"]]
[closure]
let.u_I = "{u}"
let.s_I = "{s}"
equations = ["L.u[1] = u_I", "L.s[1] = s_I", "R.u[-1] = u_I", "R.s[-1] = s_I"]
"""


def interface(name: str) -> Scheme:
    """The traditional coupling of two half-lines under a named fully discrete scheme."""
    text = _INTERFACE.format(title=name, interior=f'scheme = "{name}"', u="L.u[0]", s="R.s[0]")
    return parse_scheme(text, name)


def weighted_interface(weights: Sequence[Fraction]) -> Scheme:
    """First-order upwinding with interface values that any two rational combinations give."""
    a, b, c, d, e, f = (f"({w})" for w in weights)
    u = f"{a}*L.u[0] + {b}*R.u[0] + {c}*(L.s[0] - R.s[0])"
    s = f"{d}*L.s[0] + {e}*R.s[0] + {f}*(L.u[0] - R.u[0])"
    text = _INTERFACE.format(title="weights", interior='space = "upwind1"\ntime = "forward-euler"', u=u, s=s)
    return parse_scheme(text, "weights")
