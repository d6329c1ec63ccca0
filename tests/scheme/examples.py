"""The two examples of the format's documentation, and a way to change a line of them."""

from __future__ import annotations

import pytest

from gks.errors import SchemeError
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

INTERFACE = """\
title  = "Traditional coupling, first order"
source = "Banks & Sjögreen, eq. (3.6)"

[parameters]
lam   = { role = "cfl", default = 0.9 }
alpha = { default = 1, range = [1e-4, 1e4], doc = "kappa_R / kappa_L" }

[interior]
space = "upwind1"
time  = "forward-euler"

[domains.L]
side     = "left"
unknowns = ["u", "s"]
flux     = [["0", "-1"], ["-1", "0"]]            # q_t + flux q_x = 0, here with rho = kappa = c = 1

[domains.R]
side     = "right"
unknowns = ["u", "s"]
flux     = [["0", "-1/alpha"], ["-alpha", "0"]]  # rho = kappa = alpha, c = 1

[closure]
let = { u_I = "L.u[0]", s_I = "R.s[0]" }
equations = [
  "L.u[1] = u_I",  "L.s[1] = s_I",
  "R.u[-1] = u_I", "R.s[-1] = s_I",
]

[[claims]]
source = "Theorem 3.1"
bound  = "min(1, 4/(1 + 1/alpha))"
"""

LEAPFROG = """\
title = "Leapfrog, outflow by space extrapolation"

[parameters]
lam = { role = "cfl", default = 0.5 }

[domains.R]
side     = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"]     # u_t = u_x
first    = 1

[closure]
equations = ["u[0, n+1] = u[1, n+1]"]
"""

IN_LINES = (
    'interior = ["u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"]',
    'interior = ["dt(u[i]) = u[i+1] - u[i-1]"]\ntime = "ab2"',
)
"""Turns the leapfrog example into the method of lines."""


def changed(text: str, *replacements: tuple[str, str]) -> str:
    """The text with each (old, new) applied once; the old must be there."""
    for old, new in replacements:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def read(text: str, *replacements: tuple[str, str]) -> Scheme:
    return parse_scheme(changed(text, *replacements), "example", "example.toml")


def refusal(text: str, *replacements: tuple[str, str]) -> str:
    """The whole message with which a changed example is refused."""
    with pytest.raises(SchemeError) as caught:
        read(text, *replacements)
    return str(caught.value)
