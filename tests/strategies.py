"""Random schemes as data, so that a test can change how one is written without changing what it is.

A ``Draft`` holds equations as lists of terms; ``text`` renders it as a scheme file. Interiors are known ones that are
Cauchy-stable at the lam drawn; closures are random.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction

from hypothesis import strategies as st

from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme


@dataclass(frozen=True)
class Term:
    """coefficient * domain.unknown[index, n + level], under dt(...) where ``dt``; interiors have offsets for
    indices.
    """

    coefficient: str
    domain: str
    unknown: str
    index: int
    level: int = 0
    dt: bool = False

    def text(self, offset: bool) -> str:
        place = f"i{self.index:+d}" if offset else str(self.index)
        value = f"{self.unknown}[{place}, n{self.level:+d}]" if self.level else f"{self.unknown}[{place}]"
        value = value if offset else f"{self.domain}.{value}"
        return f"({self.coefficient})*" + (f"dt({value})" if self.dt else value)


Equation = tuple[Term, ...]


@dataclass(frozen=True)
class Line:
    """A half-line; ``interior`` is written out, or empty where ``named`` holds the keys of a named one."""

    name: str
    side: str
    unknowns: tuple[str, ...]
    first: int
    interior: tuple[Equation, ...] = ()
    named: tuple[tuple[str, str], ...] = ()
    flux: tuple[tuple[str, ...], ...] = ()

    def text(self) -> str:
        lines = [f"[domains.{self.name}]", f'side = "{self.side}"', f"first = {self.first}"]
        lines.append(f"unknowns = {list(self.unknowns)}".replace("'", '"'))
        if self.flux:
            lines.append(f"flux = {[list(row) for row in self.flux]}".replace("'", '"'))
        if self.interior:
            lines.append(f"interior = [{_quoted(self.interior, offset=True)}]")
        lines += [f'{key} = "{value}"' for key, value in self.named]
        return "\n".join(lines)


@dataclass(frozen=True)
class Draft:
    """A scheme at one lam."""

    lam: Fraction
    lines: tuple[Line, ...]
    closure: tuple[Equation, ...]
    cfl: str = "lam"
    definitions: tuple[tuple[str, str], ...] = ()

    def text(self) -> str:
        parts = [f'title = "draft"\n[parameters]\n{self.cfl} = {{ role = "cfl", default = "{self.lam}" }}']
        if self.definitions:
            parts.append("[definitions]\n" + "\n".join(f'{name} = "{formula}"' for name, formula in self.definitions))
        parts += [line.text() for line in self.lines]
        parts.append(f"[closure]\nequations = [{_quoted(self.closure, offset=False)}]")
        return "\n".join(parts) + "\n"

    def scheme(self) -> Scheme:
        return parse_scheme(self.text(), "draft")

    def line(self, name: str) -> Line:
        return next(line for line in self.lines if line.name == name)

    def on_terms(self, change: Callable[[Term], Term]) -> Draft:
        """The draft with every term of interiors and closure changed."""
        lines = tuple(
            replace(line, interior=tuple(tuple(map(change, e)) for e in line.interior)) for line in self.lines
        )
        return replace(self, lines=lines, closure=tuple(tuple(map(change, e)) for e in self.closure))


def _quoted(equations: tuple[Equation, ...], *, offset: bool) -> str:
    return ", ".join('"' + " + ".join(t.text(offset) for t in equation) + ' = 0"' for equation in equations)


# Interiors of u_t = u_x ("out") or u_t = -u_x ("in") on a right half-line
# ------------------------------------------------

Rows = tuple[tuple[str, int, int, bool], ...]
"""(coefficient, offset, level, under dt)."""


def _update(*rows: tuple[str, int, int]) -> Rows:
    return tuple((c, j, k, False) for c, j, k in rows)


def _lines(mass: dict[int, str], slope: dict[int, str]) -> Rows:
    """sum m_j dt(u[i+j]) - sum d_j u[i+j] = 0."""
    return (*((c, j, 0, True) for j, c in mass.items()), *((f"-({c})", j, 0, False) for j, c in slope.items()))


DISCRETE: dict[str, tuple[Rows, int, Fraction]] = {
    # name: equation with `lam` (for u_t = u_x; `-lam` turns it round), ghost points for "out", largest lam
    "leapfrog": (_update(("1", 0, 1), ("-1", 0, -1), ("-lam", 1, 0), ("lam", -1, 0)), 1, Fraction(19, 20)),
    "lax-wendroff": (
        _update(("1", 0, 1), ("lam**2 - 1", 0, 0), ("-(lam + lam**2)/2", 1, 0), ("(lam - lam**2)/2", -1, 0)),
        1,
        Fraction(1),
    ),
    "lax-friedrichs": (_update(("2", 0, 1), ("-(1 + lam)", 1, 0), ("-(1 - lam)", -1, 0)), 1, Fraction(1)),
    "crank-nicolson": (
        _update(("1", 0, 1), ("-lam/4", 1, 1), ("lam/4", -1, 1), ("-1", 0, 0), ("-lam/4", 1, 0), ("lam/4", -1, 0)),
        1,
        Fraction(4),
    ),
    "backward-euler": (_update(("1", 0, 1), ("-lam/2", 1, 1), ("lam/2", -1, 1), ("-1", 0, 0)), 1, Fraction(4)),
    "bdf2": (
        _update(("3/2", 0, 1), ("-2", 0, 0), ("1/2", 0, -1), ("-lam/2", 1, 1), ("lam/2", -1, 1)),
        1,
        Fraction(4),
    ),
}
CENTRAL: dict[str, tuple[Rows, tuple[str, ...], Fraction]] = {
    # name: equation, integrators that are stable with it, largest lam
    "central2": (
        _lines({0: "1"}, {1: "1/2", -1: "-1/2"}),
        ("rk4", "ssprk3", "ab3", "leapfrog", "crank-nicolson"),
        Fraction(7, 10),
    ),
    "compact4": (
        _lines({-1: "1/4", 0: "1", 1: "1/4"}, {1: "3/4", -1: "-3/4"}),
        ("rk4", "ssprk3", "bdf2", "crank-nicolson"),
        Fraction(9, 10),
    ),
}
UPWIND: dict[str, tuple[Rows, int, tuple[str, ...], Fraction]] = {
    # u_t = -u_x: equation, ghost points, integrators, largest lam
    "upwind1": (
        _lines({0: "1"}, {0: "-1", -1: "1"}),
        1,
        ("forward-euler", "rk2", "ab2", "backward-euler"),
        Fraction(1, 2),
    ),
    "upwind2": (_lines({0: "1"}, {0: "-3/2", -1: "2", -2: "-1/2"}), 2, ("rk2", "rk4", "bdf2"), Fraction(1, 2)),
    "upwind3": (_lines({0: "1"}, {1: "-1/3", 0: "-1/2", -1: "1", -2: "-1/6"}), 2, ("rk4", "ssprk3"), Fraction(1)),
}


def coefficients() -> st.SearchStrategy[str]:
    """Small rationals."""
    return st.builds(lambda p, q: str(Fraction(p, q)), st.integers(-6, 6), st.integers(1, 4))


def lams(largest: Fraction) -> st.SearchStrategy[Fraction]:
    """Twentieths up to the largest."""
    return st.integers(2, int(20 * largest)).map(lambda k: Fraction(k, 20))


def _interior(rows: Rows, turned: bool) -> Equation:
    """As an equation for u; ``turned`` swaps the direction of the wave by x -> -x."""
    return tuple(Term(c, "R", "u", -j if turned else j, k, dt) for c, j, k, dt in rows)


@st.composite
def scalar_drafts(draw: st.DrawFn) -> Draft:
    """One unknown on a right half-line with boundary points 0, ..., ghosts - 1."""
    kind = draw(st.sampled_from(["discrete", "central", "upwind"]))
    turned, levels = False, [0]
    named: tuple[tuple[str, str], ...] = ()
    if kind == "discrete":
        name = draw(st.sampled_from(sorted(DISCRETE)))
        rows, ghosts, largest = DISCRETE[name]
        turned = draw(st.booleans())
        levels = [0, 1, -1] if name in ("leapfrog", "bdf2") else [0, 1]
    elif kind == "central":
        name = draw(st.sampled_from(sorted(CENTRAL)))
        rows, times, largest = CENTRAL[name]
        ghosts, turned = 1, draw(st.booleans())
        named = (("time", draw(st.sampled_from(times))),)
    else:
        name = draw(st.sampled_from(sorted(UPWIND)))
        rows, ghosts, times, largest = UPWIND[name]
        named = (("time", draw(st.sampled_from(times))),)
    lam = draw(lams(largest))
    ode = kind != "discrete" and draw(st.booleans())
    closure = []
    for target in range(ghosts):
        inner = range(ghosts, ghosts + draw(st.integers(1, 3)))
        inside = [Term(draw(coefficients()), "R", "u", k, draw(st.sampled_from(levels))) for k in inner]
        own = Term("1", "R", "u", target, 1 if kind == "discrete" else 0, dt=ode and target == 0)
        back = [Term(draw(coefficients()), "R", "u", target, 0)] if ode and target == 0 else []
        closure.append((own, *back, *inside))
    line = Line("R", "right", ("u",), ghosts, (_interior(rows, turned),), named)
    return Draft(lam, (line,), tuple(closure))


INTERFACES: tuple[tuple[tuple[tuple[str, str], ...], Fraction], ...] = (
    ((("space", "upwind1"), ("time", "forward-euler")), Fraction(1)),
    ((("space", "upwind1"), ("time", "backward-euler")), Fraction(3)),
    ((("space", "upwind1"), ("time", "rk4")), Fraction(1)),
    ((("scheme", "lax-wendroff"),), Fraction(1)),
    ((("scheme", "lax-friedrichs"),), Fraction(1)),
    ((("space", "central2"), ("time", "rk4")), Fraction(2)),
)


@st.composite
def interface_drafts(draw: st.DrawFn) -> Draft:
    """Two acoustic half-lines of wave speed 1, impedance ratio alpha, with random interface values."""
    named, largest = draw(st.sampled_from(INTERFACES))
    alpha = Fraction(draw(st.integers(1, 12)), draw(st.integers(1, 12)))
    flux = {"L": (("0", "-1"), ("-1", "0")), "R": (("0", f"-{1 / alpha}"), (f"-{alpha}", "0"))}
    lines = tuple(
        Line(name, side, ("u", "s"), 0, (), named, flux[name]) for name, side in (("L", "left"), ("R", "right"))
    )
    closure = []
    for unknown in ("u", "s"):
        weight = Fraction(draw(st.integers(-4, 12)), 8)
        cross = Fraction(draw(st.integers(-2, 2)), 4)
        other = "s" if unknown == "u" else "u"
        value = [
            Term(str(-weight), "L", unknown, 0),
            Term(str(weight - 1), "R", unknown, 0),
            Term(str(-cross), "L", other, 0),
            Term(str(cross), "R", other, 0),
        ]
        closure += [(Term("1", "L", unknown, 1), *value), (Term("1", "R", unknown, -1), *value)]
    return Draft(draw(lams(largest)), lines, tuple(closure))


def drafts() -> st.SearchStrategy[Draft]:
    """Any of them."""
    return st.one_of(scalar_drafts(), interface_drafts())
