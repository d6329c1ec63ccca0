"""Scheme files for the solvers' tests, each with the construct it is there for."""

from __future__ import annotations

from fractions import Fraction

from gks.catalogue.interfaces import closure_lines, two_media
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme


def interface(
    closure: str, time: str = "forward-euler", space: str = "upwind1", right: str = "", parameters: str = ""
) -> Scheme:
    """Two acoustic half-lines, kappa ratio alpha; `right` overrides the interior of R."""
    text = two_media(
        "interface",
        f'lam = {{ role = "cfl", default = 0.9 }}\nalpha = 1\n{parameters}',
        f'space = "{space}"\ntime = "{time}"',
        closure,
    )
    # The table of R is the last one before the closure.
    return parse_scheme(text.replace("\n[closure]", f"{right}\n\n[closure]"), "interface")


def traditional(time: str = "forward-euler") -> Scheme:
    """The traditional coupling: velocity from the left, stress from the right (Banks & Sjögreen, (3.6))."""
    return interface(
        """
let = { u_I = "L.u[0]", s_I = "R.s[0]" }
equations = ["L.u[1] = u_I", "L.s[1] = s_I", "R.u[-1] = u_I", "R.s[-1] = s_I"]
""",
        time,
    )


WEIGHTED = """
let = { u_I = "a*L.u[0] + b*R.u[0] + c*(L.s[0] - R.s[0])", s_I = "d*L.s[0] + e*R.s[0] + f*(L.u[0] - R.u[0])" }
equations = ["L.u[1] = u_I", "L.s[1] = s_I", "R.u[-1] = u_I", "R.s[-1] = s_I"]
"""


def weighted(time: str = "forward-euler") -> Scheme:
    """Any linear rule for the interface values, six free weights."""
    return interface(WEIGHTED, time, parameters="a = 1\nb = 0\nc = 0\nd = 0\ne = 1\nf = 0")


def half_line(interior: str, closure: str, first: int = 0, side: str = "right", time: str = "") -> Scheme:
    """One half-line with the interior written out (u only)."""
    extra = f'time = "{time}"' if time else ""
    return parse_scheme(
        f"""
title = "half-line"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
[domains.R]
side = "{side}"
unknowns = ["u"]
interior = ["{interior}"]
first = {first}
{extra}
[closure]
equations = [{closure}]
""",
        "half-line",
    )


LEAPFROG = "u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"
CRANK_NICOLSON = "u[i, n+1] - lam/4*(u[i+1, n+1] - u[i-1, n+1]) = u[i] + lam/4*(u[i+1] - u[i-1])"
BACKWARD_CENTRED = "u[i, n+1] - lam/2*(u[i+1, n+1] - u[i-1, n+1]) = u[i]"
LAX_WENDROFF = "u[i, n+1] = u[i] + lam/2*(u[i+1] - u[i-1]) + lam**2/2*(u[i+1] - 2*u[i] + u[i-1])"


def constructs() -> dict[str, Scheme]:
    """One scheme for each construct of the format that a march has to know."""
    pairs = [
        ("upwind1", "rk4"),
        ("upwind1", "exact"),
        ("upwind1", "ab3"),
        ("upwind1", "crank-nicolson"),
        ("upwind1", "backward-euler"),
        ("central2", "leapfrog"),
        ("central2", "bdf2"),
        ("compact4", "rk2"),
        ("compact4", "ab2"),
    ]
    named = {f"{space} {time}": interface(PAIRS[space], time, space) for space, time in pairs}
    central, own = "dt(u[i]) = (u[i+1] - u[i-1])/2", '"dt(u[0]) = u[1] - u[0]"'
    compact = "dt(u[i-1])/4 + dt(u[i]) + dt(u[i+1])/4 = 3/4*(u[i+1] - u[i-1])"
    one_sided = '"dt(u[0]) + 2*dt(u[1]) = (-5*u[0] + 4*u[1] + u[2])/2"'
    return named | {
        "traditional": traditional(),
        "mixed integrators": interface(PAIRS["upwind1"], right='time = "backward-euler"'),
        "lines beside a discrete scheme": interface(PAIRS["central2"], right='scheme = "lax-wendroff"'),
        "leapfrog, closure at the new level": half_line(LEAPFROG, '"u[0, n+1] = u[1, n+1]"', 1),
        "leapfrog, closure over levels": half_line(LEAPFROG, '"u[0, n+1] = 2*u[1] - u[2, n-1]"', 1),
        "implicit": half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1, n]"', 1),
        "mirrored": half_line(LAX_WENDROFF, '"u[1] = 2*u[0] - u[-1]"', 0, "left"),
        "boundary point with its own equation": half_line(central, own, 1, time="rk4"),
        "the same, multistep": half_line(central, own, 1, time="ab3"),
        "compact written out": half_line(compact, one_sided, 1, time="rk4"),
        "exact with its own equation": half_line(central, own, 1, time="exact"),
    }


PAIRS = {
    "upwind1": 'equations = ["L.u[1] = L.u[0]", "L.s[1] = R.s[0]", "R.u[-1] = L.u[0]", "R.s[-1] = R.s[0]"]',
}
PAIRS["central2"] = PAIRS["compact4"] = PAIRS["upwind1"]


def at(scheme: Scheme, **values: object) -> dict[str, Fraction]:
    """The scheme's parameter values with some replaced (exact: strings or Fractions)."""
    return scheme.values(values)  # type: ignore[arg-type]


STRAND = (
    {0: "-24/17", 1: "59/34", 2: "-4/17", 3: "-3/34"},
    {0: "-1/2", 2: "1/2"},
    {0: "4/43", 1: "-59/86", 3: "59/86", 4: "-4/43"},
    {0: "3/98", 2: "-59/98", 4: "32/49", 5: "-4/49"},
)
"""Boundary rows of the operator of order 4 inside and 2 at the boundary (Strand, J. Comput. Phys. 110 (1994) 47-67);
the first entry of its norm is 17/48."""


def coupled_by_penalties(time: str, alpha: str) -> Scheme:
    """Two acoustic half-lines, summation by parts on both, tied by half the jump as a penalty: energy is conserved."""
    equations = []
    for domain, other, sign, a, b in (("L", "R", -1, "1", "1"), ("R", "L", 1, "1/alpha", "alpha")):
        for u, w, speed in (("u", "s", a), ("s", "u", b)):
            for k, row in enumerate(STRAND):
                slope = " + ".join(f"({sign}*({c}))*{domain}.{w}[{sign * m}]" for m, c in row.items())
                jump = f" - ({sign})*24/17*({other}.{w}[0] - {domain}.{w}[0])" if k == 0 else ""
                equations.append(f"dt({domain}.{u}[{sign * k}]) = ({speed})*({slope}{jump})")
    parameters = f'lam = {{ role = "cfl", default = 1 }}\nalpha = "{alpha}"'
    text = two_media("SBP-SAT", parameters, f'space = "central4"\ntime = "{time}"', closure_lines(equations))
    return parse_scheme(text.replace('unknowns = ["u", "s"]', 'unknowns = ["u", "s"]\nfirst = 4'), "SBP-SAT")
