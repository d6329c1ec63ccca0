"""The scheme file that ``gks new`` writes: it runs as it is, and its comments say what may stand in it."""

from __future__ import annotations

import json

_TEXT = '''\
title = @TITLE@
source = ""                       # where the scheme is published, if it is
notes = ""

# Every symbol a formula below may use. One has role "cfl": the number whose stable bound is sought.
[parameters]
lam   = { role = "cfl", default = 0.9, doc = "c dt/dx" }
alpha = { default = 2, range = [1e-4, 1e4], doc = "kappa_R/kappa_L" }

# Shorthands for the formulas below, in any order.
[definitions]
weight = "alpha/(1 + alpha)"      # try "1", "1/2" or "0" and look at `gks modes` and `gks curve` again

# The scheme inside.
#   space:  upwind1, upwind2, upwind3, fromm, central2, central4, central6, compact4
#   time:   forward-euler, backward-euler, crank-nicolson, leapfrog, ab2, ab3, bdf2, rk2, ssprk3, rk4, exact
# or, instead of both, a fully discrete one,
#   scheme: lax-friedrichs, lax-wendroff, beam-warming, fromm
[interior]
space = "upwind1"
time  = "forward-euler"

# x < 0: cells i = 0, -1, -2, ...; the unknowns' equation is q_t + flux q_x = 0. A domain may also have its scheme
# written out, one equation an unknown,
#   interior = ["u[i, n+1] = u[i] - lam*(u[i] - u[i-1])"]
# and its first cell moved by `first`. For a boundary instead of an interface leave one of the two domains out.
[domains.L]
side     = "left"
unknowns = ["u", "s"]
flux     = [["0", "-1"], ["-1", "0"]]

# x > 0: cells i = 0, 1, 2, ...; indices grow with x on both sides.
[domains.R]
side     = "right"
unknowns = ["u", "s"]
flux     = [["0", "-1/alpha"], ["-alpha", "0"]]

# One equation for each value outside the cells that the scheme reads: here u and s at L's 1 and at R's -1.
# `let` names combinations of grid values. A missing time level is n; u[0, n+1] is one level on.
[closure]
let.u_I = "(1 - weight)*L.u[0] + weight*R.u[0]"
let.s_I = "weight*L.s[0] + (1 - weight)*R.s[0]"
equations = [
  "L.u[1] = u_I",  "L.s[1] = s_I",
  "R.u[-1] = u_I", "R.s[-1] = s_I",
]

# What a publication states of the scheme, for `gks audit`: a bound, or stable at given values, or a modulus.
[[claims]]
source = "an example: stable up to the scheme's own limit"
bound  = "1"
'''


def starter(name: str) -> str:
    """The text of a starter scheme file with `name` as its title."""
    # JSON's string escapes are among TOML's, so that any printable name makes a valid title.
    return _TEXT.replace("@TITLE@", json.dumps(name, ensure_ascii=False))
