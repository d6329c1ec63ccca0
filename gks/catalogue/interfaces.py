"""Scheme files of two acoustic half-lines that meet at an interface, from what sets one apart from the next.

L lies on the left and R on the right. Velocity u and stress s obey u_t = s_x/rho, s_t = rho c**2 u_x on either side, as
q_t + flux q_x = 0 has it. The text comes out the same to the byte for the same arguments, so it may be digested.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

Medium = tuple[str, str]
"""The flux matrix off its diagonal, -1/rho and -rho c**2, as formulas."""

UNIT: Medium = ("-1", "-1")
RATIO: Medium = ("-1/alpha", "-alpha")
"""Density alpha and speed 1."""

BY_NAME = ("u_I", "s_I")
"""Interface values of u and s that `let` defines."""

COPIED = ("L.u[0]", "R.s[0]")
"""Those of the traditional coupling at first order: velocity of the left, stress of the right."""

UPWIND = 'space = "upwind1"\ntime = "forward-euler"'

_TEXT = """\
title = "{title}"

[parameters]
{parameters}

[interior]
{interior}

[domains.L]
side = "left"
unknowns = ["u", "s"]
flux = [["0", "{left[0]}"], ["{left[1]}", "0"]]

[domains.R]
side = "right"
unknowns = ["u", "s"]
flux = [["0", "{right[0]}"], ["{right[1]}", "0"]]

[closure]
{closure}
"""


def two_media(
    title: str, parameters: str, interior: str, closure: str, media: tuple[Medium, Medium] = (UNIT, RATIO)
) -> str:
    """The scheme file. parameters, interior, closure : the lines of those tables; media : left and right."""
    left, right = media
    return _TEXT.format(title=title, parameters=parameters, interior=interior, left=left, right=right, closure=closure)


def closure_lines(equations: Sequence[str], let: Mapping[str, str] | None = None) -> str:
    """The lines of a `[closure]` table, two equations a line."""
    pairs = (equations[start : start + 2] for start in range(0, len(equations), 2))
    named = (f'let.{name} = "{value}"' for name, value in (let or {}).items())
    return "\n".join([*named, "equations = [", *("  " + _quoted(pair) + "," for pair in pairs), "]"])


def _quoted(equations: Sequence[str]) -> str:
    return ", ".join(f'"{each}"' for each in equations)


def own_value(side: str, unknown: str, order: int) -> str:
    """A side's own value at the interface: of its last cell, or extrapolated linearly from its last two."""
    inner = {"L": -1, "R": 1}[side]
    near = f"{side}.{unknown}[0]"
    return near if order == 1 else f"(3/2*{near} - 1/2*{side}.{unknown}[{inner}])"


def ghost_equations(
    order: int, depth: int = 1, left: tuple[str, str] = BY_NAME, right: tuple[str, str] = BY_NAME
) -> list[str]:
    """`depth` ghost cells a side hold the interface values (order 1), or mirror in them (order 2).

    left, right : the interface values of u and s as each side's ghost cells take them, names or grid values.
    """
    equations = []
    for ghost in range(1, depth + 1):
        for side, outward, values in (("L", 1, left), ("R", -1, right)):
            for unknown, value in zip("us", values, strict=True):
                mirrored = f"2*{value} - {side}.{unknown}[{outward * (1 - ghost)}]"
                equations.append(f"{side}.{unknown}[{outward * ghost}] = {value if order == 1 else mirrored}")
    return equations
