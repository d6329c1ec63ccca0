"""Two acoustic half-lines under random interface weights: media, interiors, integrators and orders drawn as well."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import strategies as st

from gks.catalogue.interfaces import UNIT, closure_lines, ghost_equations, own_value, two_media

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
    own = {f"{side}.{unknown}": own_value(side, unknown, order) for side in "LR" for unknown in "us"}
    values = {}
    for unknown, other in ("us", "su"):
        weight, cross = draw(tenths(2)), draw(tenths(1))
        left = draw(st.one_of(st.just(1 - weight), tenths(2)))  # consistent weights and any
        values[f"{unknown}_I"] = (
            f"({weight})*{own[f'L.{unknown}']} + ({left})*{own[f'R.{unknown}']}"
            f" + ({cross})*({own[f'L.{other}']} - {own[f'R.{other}']})"
        )
    return two_media(
        "random interface weights",
        f'lam = {{ role = "cfl", default = "{lam}" }}\nalpha = "{alpha}"\nc = "{speed}"',
        interior,
        closure_lines(ghost_equations(order, ghosts), values),
        (UNIT, ("-1/alpha", "-alpha*c**2")),
    )
