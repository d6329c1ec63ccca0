"""Schemes at the ends of the doubles and at the edge of stability, each with its answer by a formula of its own.

The formulas use exact fractions and none of the analyser's code:

- **Two media, first-order traditional coupling, forward Euler.** With the leaving characteristic zero in a decaying
  mode and kappa = c/(s + c) the two conditions give (2 s/c_R + 1)(2 s/c_L + 1) + Z = 0, Z the ratio of the
  impedances. A complex pair leaves abs(1 + lam s) <= 1 at lam = -2 Re(s)/abs(s)**2 = 2 (c_L + c_R)/(c_L c_R (1 + Z));
  a real pair is never admissible. So lam_max is the smaller of that and 1/max(c_L, c_R).
- **Geometric extrapolation**, u[-m] = w**m u[0] at all p ghosts of a scheme u[n+1] = g(shift) u[n]. In x = 1/kappa the
  determinant over the decaying solutions is that of x_j**m - w**m, the Vandermonde determinant of (w, x_1, ...): the
  only mode has kappa = 1/w and z = g(1/w). It exists where abs(w) > 1; at w = 1 it is a wave that enters.
- **A boundary value with its own recursion**, (E - a)**m u[0] = 0 with E the shift in time, that the interior never
  reads: z = a, m times, whatever the interior.
- **Several levels**: leapfrog, Crank-Nicolson and backward Euler under classical closures; the derivations stand at the
  cases.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import comb

from gks.catalogue.interfaces import COPIED, UPWIND, closure_lines, ghost_equations, two_media
from gks.scheme.numbers import decimal_text

TINY = Fraction(1, 10**14)
"""How far from the edge of stability the cases beside it are."""

Number = Fraction | int


@dataclass(frozen=True, slots=True)
class Case:
    """A scheme file, parameter values, and the right answer.

    Either ``verdict`` with the leading mode's ``z`` (None where there is none, or no formula for it) and its
    ``multiplicity``, or ``lam_max``.
    """

    name: str
    text: str
    values: Mapping[str, Fraction]
    verdict: str = ""
    z: Fraction | None = None
    multiplicity: int | None = None
    lam_max: Fraction | None = field(default=None)


def cases() -> list[Case]:
    """All of them, in the order of the table."""
    return [*_media(), *_levels(), *_geometric(), *_systems(), *_multiple()]


def _power(exponent: int) -> Fraction:
    return Fraction(10) ** exponent


# Two media ------------------------------------------------------------------------------------------------------------

_MEDIA = two_media(
    "Two media, first-order traditional coupling",
    """\
lam = { role = "cfl", default = 1 }
Z = 1        # impedance rho c of the right medium, 1 on the left
cL = 1
cR = 1""",
    UPWIND,
    closure_lines(ghost_equations(1, 1, COPIED, COPIED)),
    (("-cL", "-cL"), ("-cR/Z", "-cR*Z")),
)


def coupling_limit(z: Fraction, left: Fraction, right: Fraction) -> Fraction:
    """lam_max of the traditional coupling, by the formula above."""
    return min(1 / max(left, right), 2 * (left + right) / (left * right * (1 + z)))


def _media() -> Iterator[Case]:
    settings = [(exponent, 0, 0) for exponent in (-300, -16, 16, 300)]
    settings += [(exponent, 0, speed) for speed in (-8, 8) for exponent in (-8, 0, 8)]
    settings += [(9, 150, -150), (300, 8, -8)]
    for exponent, left, right in settings:
        values = {"Z": _power(exponent), "cL": _power(left), "cR": _power(right)}
        top = coupling_limit(values["Z"], values["cL"], values["cR"])
        name = f"interface, impedances 1 : 1e{exponent}, speeds 1e{left} : 1e{right}"
        yield Case(name, _MEDIA, {**values, "lam": Fraction(1)}, lam_max=top)
        if top < 1 / max(values["cL"], values["cR"]):
            for what, factor, verdict in (
                ("below", 1 - TINY, "stable"), ("at", Fraction(1), "neutral"), ("above", 1 + TINY, "unstable"),
                ("1e-600 below", 1 - _power(-600), "stable"), ("1e-600 above", 1 + _power(-600), "unstable"),
            ):  # fmt: skip
                yield Case(f"{name}, {what} lam_max", _MEDIA, {**values, "lam": top * factor}, verdict)


# Several levels -------------------------------------------------------------------------------------------------------


def half_line(interior: str, closure: Sequence[str], *, first: int = 0) -> str:
    """A scheme of one unknown on x > 0, with parameters lam and w."""
    equations = ", ".join(f'"{each}"' for each in closure)
    return (
        f'title = "stress"\n[parameters]\nlam = {{ role = "cfl", default = 1 }}\nw = 1\n[domains.R]\nside = "right"\n'
        f'unknowns = ["u"]\ninterior = ["{interior}"]\nfirst = {first}\n[closure]\nequations = [{equations}]\n'
    )


_LEAPFROG = "u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"
_CRANK_NICOLSON = "u[i, n+1] - lam/4*(u[i+1, n+1] - u[i-1, n+1]) = u[i] + lam/4*(u[i+1] - u[i-1])"
_BACKWARD_EULER = "u[i, n+1] - lam/2*(u[i+1, n+1] - u[i-1, n+1]) = u[i]"


def _levels() -> Iterator[Case]:
    one = Fraction(1)
    sizes = (_power(-12), 1 - TINY, one, 1 + TINY, _power(300))
    for closure, right in (("u[0, n+1] = u[1, n+1]", "generalized"), ("u[0, n+1] = u[1, n]", "stable")):
        # z = -1, kappa = 1 enters at every lam < 1 under the first closure and under the second not at all; from
        # lam = 1 on the interior itself has a double root on the circle, or one outside.
        for lam in sizes:
            verdict = right if lam < 1 else "unstable"
            yield _one(f"leapfrog, {closure}", half_line(_LEAPFROG, [closure], first=1), lam, verdict)
    crank = half_line(_CRANK_NICOLSON, ["u[0, n+1] = u[1, n]"], first=1)
    # kappa = z solves the closure. On the circle, z = exp(i t), the scheme then says 2 tan(t/2) = lam sin t: t = 0, a
    # wave that leaves, or cos(t/2)**2 = 1/lam. The velocity of that wave has the sign of 1 - 2/lam: it enters where
    # lam > 2.
    for lam in (_power(-12), 2 - TINY, 2 + TINY, _power(12)):
        yield _one("Crank-Nicolson, u[0, n+1] = u[1, n]", crank, lam, "stable" if lam < 2 else "generalized")
    back = half_line(_BACKWARD_EULER, ["u[0, n+1] = u[0, n] + lam*(u[1, n] - u[0, n])"], first=1)
    # z = 1 + lam (kappa - 1) and 1 - 1/z = lam (kappa - 1/kappa)/2: z = -1 has kappa = -1/3 at lam = 3/2.
    for lam in (_power(-12), Fraction(3, 2) * (1 - TINY), Fraction(3, 2), Fraction(3, 2) * (1 + TINY), _power(12)):
        verdict = "neutral" if lam == Fraction(3, 2) else "stable" if lam < Fraction(3, 2) else "unstable"
        yield _one("backward Euler, one-sided update", back, lam, verdict)


def _one(name: str, text: str, lam: Fraction, verdict: str) -> Case:
    return Case(f"{name}, lam = {shown(lam)}", text, {"lam": lam, "w": Fraction(1)}, verdict)


def shown(value: Fraction) -> str:
    """A short text that keeps how near a value is to a simple one."""
    for simple in (Fraction(1), Fraction(2), Fraction(3, 2)):
        if value == simple:
            return str(simple)
        if abs(value - simple) < Fraction(1, 1000):
            return f"{simple} {'-' if value < simple else '+'} {float(abs(value - simple)):.0e}"
    return decimal_text(value)


# Geometric extrapolation ----------------------------------------------------------------------------------------------


def _geometric() -> Iterator[Case]:
    for reach in (1, 3, 6, 9):
        lam = Fraction(1, 2)
        weights = {
            j: comb(reach, k) * ((1 + lam) / 2) ** (reach - k) * ((1 - lam) / 2) ** k
            for k in range(reach + 1)
            for j in (2 * k - reach,)
        }
        terms = " + ".join(f"({c})*u[i{j:+d}]" for j, c in weights.items())
        text = half_line(f"u[i, n+1] = {terms}", [f"u[-{m}] = w**{m}*u[0]" for m in range(1, reach + 1)])
        for w in (1 - TINY, Fraction(1), 1 + TINY, Fraction(2), _power(30)):
            z = sum((c * w ** (-j) for j, c in weights.items()), Fraction(0))
            verdict = "stable" if w < 1 else "generalized" if w == 1 else "unstable"
            name = f"{reach} points a side, {reach} ghosts, w = {shown(w)}"
            yield Case(name, text, {"lam": Fraction(1), "w": w}, verdict, z if w > 1 else None, 1 if w > 1 else None)
    yield from _cancelling()


def _cancelling() -> Iterator[Case]:
    """u[-1] = (1/a + 1/b) u[0] - u[1]/(a b): kappa = a or b; upwinding to first order has z = 1 + lam (1/kappa - 1)."""
    text = half_line("u[i, n+1] = u[i] - lam*(u[i] - u[i-1])", ["u[-1] = (1/w + 1/2)*u[0] - 1/(2*w)*u[1]"])
    for w in (1 - TINY, Fraction(1), 1 + TINY, 1 - _power(-300), 1 + _power(-300)):
        verdict = "unstable" if w < 1 else "generalized" if w == 1 else "stable"
        z = 1 + Fraction(1, 2) * (1 / w - 1) if w < 1 else None
        yield Case(f"weights that nearly cancel, kappa = {shown(w)}", text, {"lam": Fraction(1, 2), "w": w}, verdict, z)


# Systems and multiple roots -------------------------------------------------------------------------------------------


def _systems() -> Iterator[Case]:
    """Six fields with speeds 1, 2, 3, -1, -2, -3, mixed by a unimodular matrix; every ghost w times the value at 0."""
    speeds = (1, 2, 3, -1, -2, -3)
    size = len(speeds)
    mix = [[Fraction(int(j <= i)) for j in range(size)] for i in range(size)]  # its inverse has two diagonals
    back = [[Fraction(int(j == i) - int(j == i - 1)) for j in range(size)] for i in range(size)]
    flux = [
        [sum((mix[i][k] * speeds[k] * back[k][j] for k in range(size)), Fraction(0)) for j in range(size)]
        for i in range(size)
    ]
    names = [f"q{k}" for k in range(size)]
    rows = ", ".join("[" + ", ".join(f'"{entry}"' for entry in row) + "]" for row in flux)
    listed = ", ".join(f'"{name}"' for name in names)
    closure = ", ".join(f'"{name}[-1] = w*{name}[0]"' for name in names)
    text = (
        'title = "six fields"\n[parameters]\nlam = { role = "cfl", default = 1 }\nw = 1\n'
        '[interior]\nspace = "upwind1"\ntime = "forward-euler"\n'
        f'[domains.R]\nside = "right"\nunknowns = [{listed}]\nflux = [{rows}]\n'
        f"[closure]\nequations = [{closure}]\n"
    )
    lam = Fraction(1, 4)
    for w in (1 - TINY, Fraction(1), 1 + TINY, Fraction(2)):
        verdict = "stable" if w < 1 else "generalized" if w == 1 else "unstable"
        z = 1 + 3 * lam * (w - 1) if w > 1 else None
        yield Case(f"six fields, w = {shown(w)}", text, {"lam": lam, "w": w}, verdict, z)


def _multiple() -> Iterator[Case]:
    for order in (1, 2, 4, 8):
        terms = " + ".join(
            f"{comb(order, j) * (-1) ** (order - j)}*w**{order - j}*u[0, n+{j}]" for j in range(order + 1)
        )
        text = half_line("u[i, n+1] = u[i] + lam*(u[i+1] - u[i])", [f"{terms} = 0"], first=1)
        for w in (Fraction(1, 2), 1 - TINY, Fraction(1), 1 + TINY, Fraction(-3, 2)):
            verdict = "neutral" if w == 1 else "stable" if abs(w) < 1 else "unstable"
            name = f"root of multiplicity {order} at z = {shown(w)}"
            yield Case(name, text, {"lam": Fraction(1, 2), "w": w}, verdict, w, order)
