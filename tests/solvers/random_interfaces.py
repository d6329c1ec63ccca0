"""Two acoustic half-lines under random interface weights: media, interiors, integrators and orders drawn as well."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import strategies as st

from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

INTERIORS: dict[str, tuple[str, int, Fraction]] = {
    # name: keys, ghost points a side, a lam at which the interior is Cauchy-stable for every smaller one
    "upwind1 forward-euler": ('space = "upwind1"\ntime = "forward-euler"', 1, Fraction(1)),
    "upwind1 backward-euler": ('space = "upwind1"\ntime = "backward-euler"', 1, Fraction(3)),
    "upwind1 crank-nicolson": ('space = "upwind1"\ntime = "crank-nicolson"', 1, Fraction(2)),
    "upwind1 ab2": ('space = "upwind1"\ntime = "ab2"', 1, Fraction(1, 2)),
    "upwind1 ssprk3": ('space = "upwind1"\ntime = "ssprk3"', 1, Fraction(5, 4)),
    "upwind1 bdf2": ('space = "upwind1"\ntime = "bdf2"', 1, Fraction(2)),
    "central2 rk4": ('space = "central2"\ntime = "rk4"', 1, Fraction(14, 5)),
    "lax-wendroff": ('scheme = "lax-wendroff"', 1, Fraction(1)),
    "lax-friedrichs": ('scheme = "lax-friedrichs"', 1, Fraction(1)),
    "beam-warming": ('scheme = "beam-warming"', 2, Fraction(1)),
}

TEXT = """
title = "random interface weights"
[parameters]
lam   = {{ role = "cfl", default = "{lam}" }}
alpha = "{alpha}"
c     = "{speed}"
[interior]
{interior}
[domains.L]
side = "left"
unknowns = ["u", "s"]
flux = [["0", "-1"], ["-1", "0"]]
[domains.R]
side = "right"
unknowns = ["u", "s"]
flux = [["0", "-1/alpha"], ["-alpha*c**2", "0"]]
[closure]
let = {{ u_I = "{u}", s_I = "{s}" }}
equations = [{equations}]
"""


def tenths(largest: int) -> st.SearchStrategy[Fraction]:
    """Multiples of 1/10 up to the largest, of either sign."""
    return st.integers(-10 * largest, 10 * largest).map(lambda k: Fraction(k, 10))


@st.composite
def interface_texts(draw: st.DrawFn, fastest: int = 100) -> str:
    """A scheme file: interface values a mean of both sides with random weights, first or second order.

    Wave speeds 1 and c with 1/fastest <= c <= fastest; lam below the interior's limit for the faster side.
    """
    interior, ghosts, largest = INTERIORS[draw(st.sampled_from(sorted(INTERIORS)))]
    order = draw(st.integers(1, 2))
    alpha = Fraction(draw(st.integers(1, 30)), draw(st.integers(1, 30)))
    speed = draw(st.sampled_from([Fraction(1), Fraction(2), Fraction(1, 3), Fraction(fastest), Fraction(1, fastest)]))
    lam = largest * Fraction(draw(st.integers(2, 19)), 20) / max(speed, Fraction(1))
    near = {
        f"{side}.{unknown}": (
            f"{side}.{unknown}[0]" if order == 1 else f"(3/2*{side}.{unknown}[0] - 1/2*{side}.{unknown}[{inner}])"
        )
        for side, inner in (("L", -1), ("R", 1))
        for unknown in "us"
    }
    values = {}
    for unknown, other in ("us", "su"):
        weight, cross = draw(tenths(2)), draw(tenths(1))
        left = draw(st.one_of(st.just(1 - weight), tenths(2)))  # consistent weights and any
        values[unknown] = (
            f"({weight})*{near[f'L.{unknown}']} + ({left})*{near[f'R.{unknown}']}"
            f" + ({cross})*({near[f'L.{other}']} - {near[f'R.{other}']})"
        )
    return TEXT.format(
        lam=lam, alpha=alpha, speed=speed, interior=interior, u=values["u"], s=values["s"],
        equations=", ".join(_equations(order, ghosts)),
    )  # fmt: skip


def _equations(order: int, ghosts: int) -> list[str]:
    """Ghost values: the interface values (order 1), or mirrored in them."""
    return [
        f'"{side}.{unknown}[{sign * ghost}] = '
        + (f'{unknown}_I"' if order == 1 else f'2*{unknown}_I - {side}.{unknown}[{sign * (1 - ghost)}]"')
        for ghost in range(1, ghosts + 1)
        for side, sign in (("L", 1), ("R", -1))
        for unknown in "us"
    ]


def interfaces(fastest: int = 100) -> st.SearchStrategy[Scheme]:
    """The same, read."""
    return interface_texts(fastest).map(lambda text: parse_scheme(text, "random"))
