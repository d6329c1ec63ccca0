"""Random interfaces: two elastic media, a rule with weights for the interface values, and an interior scheme.

The interface values are

    u_I = a u_L + (1 - a) u_R + x (s_L - s_R),      s_I = b s_L + (1 - b) s_R + y (u_L - u_R),

consistent for any weights; u_L, u_R and the like are each side's own values at the interface, extrapolated to the
order of the closure, and the ghost values follow from u_I and s_I to that order (Banks & Sjögreen, Section 3). The
traditional coupling is a = 1, b = 0, the average a = b = 1/2, the impedance-weighted one a = Z_L/(Z_L + Z_R),
b = 1 - a, and with x = -1/(Z_L + Z_R), y = -Z_L Z_R/(Z_L + Z_R) it is the one by characteristics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from gks.catalogue.interfaces import UNIT, closure_lines, ghost_equations, own_value, two_media

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn, SearchStrategy

T = TypeVar("T")

F = Fraction


@dataclass(frozen=True, slots=True)
class Interior:
    """A named interior scheme; it is Cauchy-stable for max(c) lam <= limit, or for every lam up to what is drawn.

    ``narrow``: every field has its decaying solutions on one sheet, so that stable sets take a twentieth of a second.
    """

    keys: tuple[tuple[str, str], ...]
    limit: Fraction
    narrow: bool

    @property
    def name(self) -> str:
        return " ".join(value for _, value in self.keys)


def _lines(space: str, time: str, limit: Fraction, narrow: bool = False) -> Interior:
    return Interior((("space", space), ("time", time)), limit, narrow)


def _update(scheme: str, limit: Fraction) -> Interior:
    return Interior((("scheme", scheme),), limit, False)


INTERIORS: tuple[Interior, ...] = (
    _lines("upwind1", "forward-euler", F(1), narrow=True),
    _lines("upwind1", "backward-euler", F(4), narrow=True),
    _lines("upwind1", "crank-nicolson", F(4), narrow=True),
    _lines("upwind1", "rk2", F(1), narrow=True),
    _lines("upwind1", "ssprk3", F(5, 4), narrow=True),
    _lines("upwind1", "rk4", F(27, 20), narrow=True),
    _lines("upwind1", "ab2", F(1, 2), narrow=True),
    _lines("upwind1", "bdf2", F(4), narrow=True),
    _update("lax-friedrichs", F(1)),
    _update("lax-wendroff", F(1)),
    _lines("central2", "ssprk3", F(17, 10)),
    _lines("central2", "rk4", F(14, 5)),
    _lines("central2", "crank-nicolson", F(4)),
    _lines("central2", "leapfrog", F(19, 20)),
)
"""The limits: 1 for the updates and forward Euler; the largest lam for which the operator's symbol (the circle
abs(mu + lam) = lam of upwind1, the segment from -i lam to i lam of central2) lies in the integrator's stability region,
rounded down to twentieths; 4 is where drawing stops for what is stable for every lam."""

RATIOS = tuple(F(p, q) for p, q in ((1, 1), (2, 1), (1, 2), (4, 1), (1, 4), (3, 1), (1, 3), (10, 1), (1, 10)))
RATIOS += (F(5, 3), F(3, 5), F(100), F(1, 100), F(31, 9), F(10**6), F(1, 10**6))

SPEEDS = (F(1), F(1), F(2), F(1, 2), F(1), F(3, 2), F(2, 3), F(4))

LAMS = tuple(F(k, 16) for k in (8, 4, 12, 14, 15, 2, 10, 6, 16, 1, 3, 5, 7, 9, 11, 13))
"""lam over the interior's limit."""

WEIGHTS: tuple[Fraction, ...] = (F(1), F(0), F(1, 2), F(1, 4), F(3, 4), F(1, 3), F(2, 3), F(1, 8), F(7, 8), F(3, 8))
WEIGHTS += (F(5, 8), F(-1, 4), F(5, 4), F(3, 2), F(-1), F(2))

CROSS = tuple(F(p, q) for p, q in ((0, 1), (0, 1), (0, 1), (0, 1), (1, 1), (-1, 1), (1, 2), (-1, 2)))
"""x (Z_L + Z_R) and y (1/Z_L + 1/Z_R): -1 is the value by characteristics."""


@dataclass(frozen=True, slots=True)
class Draft:
    """One interface. ``ratio`` is rho_R/rho_L, ``speed`` c_R/c_L; rho_L = c_L = 1, and the impedance is Z = rho c.

    ``a``, ``b`` are the weights, ``x``, ``y`` the cross weights, all as they stand in the interface values.
    """

    interior: Interior
    order: int
    ratio: Fraction
    speed: Fraction
    a: Fraction
    b: Fraction
    x: Fraction
    y: Fraction
    lam: Fraction

    @property
    def family(self) -> str:
        return f"{self.interior.name}, order {self.order}"

    def weights(self) -> dict[str, str]:
        """The media and the weights, exact, as JSON has them."""
        names = ("ratio", "speed", "a", "b", "x", "y")
        return {name: str(getattr(self, name)) for name in names}

    def text(self, notes: str = "") -> str:
        """The scheme file, with notes if there are any (quotes and backslashes in them are left out)."""
        keys = "\n".join(f'{key} = "{value}"' for key, value in self.interior.keys)
        side = {(q, d): own_value(d, q, self.order) for q in "us" for d in "LR"}
        values = {
            "u_I": _combination((self.a, side["u", "L"]), (1 - self.a, side["u", "R"]), *_jump(self.x, side, "s")),
            "s_I": _combination((self.b, side["s", "L"]), (1 - self.b, side["s", "R"]), *_jump(self.y, side, "u")),
        }
        text = two_media(
            f"Interface: {self.family}",
            f'lam = {{ role = "cfl", default = "{self.lam}" }}',
            keys,
            closure_lines(ghost_equations(self.order), values),
            (UNIT, (f"-{1 / self.ratio}", f"-{self.ratio * self.speed**2}")),
        )
        if not notes:
            return text
        title, rest = text.split("\n", 1)
        return f'{title}\nnotes = "{notes.translate({34: None, 92: None})}"\n{rest}'


def _jump(weight: Fraction, side: dict[tuple[str, str], str], q: str) -> tuple[tuple[Fraction, str], ...]:
    return (weight, side[q, "L"]), (-weight, side[q, "R"])


def _combination(*terms: tuple[Fraction, str]) -> str:
    """The terms with a weight, as a formula."""
    return " + ".join(value if weight == 1 else f"({weight})*{value}" for weight, value in terms if weight)


# Drawing --------------------------------------------------------------------------------------------------------------


def drafts() -> SearchStrategy[Draft]:
    """Random interfaces, as hypothesis draws and shrinks them; what stands first in a table is the simplest.

    Choices are made of booleans: numbers hypothesis also takes from the source code that happens to be loaded, and the
    draws would depend on the process that they are made in.
    """
    from hypothesis import strategies as st

    booleans = st.booleans()

    @st.composite
    def interface(draw: DrawFn) -> Draft:
        def one_of(options: Sequence[T]) -> T:
            place = 0
            for _ in range((len(options) - 1).bit_length()):
                place = 2 * place + draw(booleans)
            return options[place % len(options)]

        interior = one_of(INTERIORS)
        ratio, speed = one_of(RATIOS), one_of(SPEEDS)
        # Beyond one sheet a second-order rule between unequal speeds takes a second to judge, and is left out.
        order = 1 if one_of((True, False)) or (speed != 1 and not interior.narrow) else 2
        left, right = F(1), ratio * speed
        natural = left / (left + right)
        a = one_of((*WEIGHTS, *(natural,) * 8, *(1 - natural,) * 8))
        b = one_of((*WEIGHTS, *(1 - a,) * 12, *(natural,) * 4))
        x, y = one_of(CROSS) / (left + right), one_of(CROSS) * left * right / (left + right)
        return Draft(interior, order, ratio, speed, a, b, x, y, one_of(LAMS) * interior.limit / max(F(1), speed))

    return interface()
