"""A normal-mode problem with its polynomials evaluated but for the resolvent variable: in balls, or in double precision.

The variable of the tables is mu = lam*s where the problem's is s, and z where it is z. Each symbol and each closure row
is divided by a power of two that brings its largest coefficient to about 1; neither moves a zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from flint import acb, acb_poly, ctx, fmpz_mpoly

from gks.modes.algebraic import GUARD_BITS
from gks.modes.coefficients import value_ball
from gks.modes.discs import Discs, constant
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem

DOUBLE_BITS = 128
"""Precision of coefficients that are then rounded to doubles: what cancellation among a few generators' terms costs stays
below a double's rounding, and is in the discs' radii where it does not."""

C = TypeVar("C")
D = TypeVar("D")


TURN = 0.25 + 0.375j
"""c of the turn x = (y + c)/(1 + conj(c) y), which keeps the unit disc: exact in doubles, off the axes and the circle, so that
no family has a root x = 1/conj(c), which would go to infinity in its turn, but by an accident."""


@dataclass(frozen=True, slots=True)
class Symbol(Generic[C]):
    """P(mu, y): ``powers[i][k]`` is the coefficient of y**i mu**k (absent: 0), k at most ``degree``.

    x = (y + turn)/(1 + conj(turn) y). The turn is 0 where no spatial root passes through infinity while abs(z) = 1.
    """

    powers: tuple[Mapping[int, C], ...]
    degree: int
    decaying: int
    turn: complex


@dataclass(frozen=True, slots=True)
class Entry(Generic[C]):
    """A coefficient, given by its powers of mu, times v_n of a block."""

    block: int
    n: int
    coefficient: Mapping[int, C]


@dataclass(frozen=True, slots=True)
class Row(Generic[C]):
    """One closure equation, of degree at most ``degree`` in mu."""

    entries: tuple[Entry[C], ...]
    degree: int


@dataclass(frozen=True, slots=True)
class Tables(Generic[C]):
    """``blocks`` gives (family, zeros) of every block, ``longest`` how many v_n the closure reads of it (at least 1)."""

    symbols: tuple[Symbol[C], ...]
    rows: tuple[Row[C], ...]
    blocks: tuple[tuple[int, int], ...]
    longest: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of equations, which is that of decaying solutions."""
        return len(self.rows)


def ball_tables(problem: NormalModeProblem, bits: int) -> Tables[acb]:
    """The tables to a relative precision of about ``bits``."""
    with ctx.workprec(bits + GUARD_BITS):
        lam = acb(1)
        if problem.variable == "s":
            lam = value_ball(problem.coefficients.values[problem.resolvent.cfl], bits)
        at = {name: root.ball(bits) for name, root in problem.coefficients.point().items()}
        symbols = []
        for family in problem.families:
            parts, degree = _scaled(problem, powers_of(family.polynomial, "x"), at, lam, bits)
            symbols.append(_turned(Symbol(tuple(parts), degree, family.decaying, 0j), _reaches_infinity(problem)))
        rows = []
        for row in problem.rows:
            parts, degree = _scaled(problem, [t.coefficient for t in row], at, lam, bits)
            rows.append(Row(tuple(Entry(t.block, t.n, c) for t, c in zip(row, parts, strict=True)), degree))
    longest = [
        1 + max((t.n for row in problem.rows for t in row if t.block == k), default=0) for k in range(len(problem.blocks))
    ]
    return Tables(tuple(symbols), tuple(rows), tuple((b.family, b.zeros) for b in problem.blocks), tuple(longest))


def _reaches_infinity(problem: NormalModeProblem) -> bool:
    """Whether lam*s is infinite at a point with abs(z) = 1: the poles of Crank-Nicolson and of the exact solution."""
    method = problem.resolvent.integrator
    if problem.variable == "z" or method is None or method.kind == "runge-kutta":
        return False
    return method.kind == "exact" or not (sum(method.sigma) and sum(c * (-1) ** k for k, c in enumerate(method.sigma)))


def _turned(symbol: Symbol[acb], infinite: bool) -> Symbol[acb]:
    """The symbol in y, where its leading coefficient in x may vanish on the circle."""
    lead = symbol.powers[-1]
    if len(lead) < 2 and not (infinite and symbol.degree not in lead):
        return symbol
    turn, back = acb(TURN), acb(TURN.conjugate())
    total: list[dict[int, acb]] = [{} for _ in symbol.powers]
    for i, part in enumerate(symbol.powers):
        factor = acb_poly([turn, 1]) ** i * acb_poly([1, back]) ** (len(symbol.powers) - 1 - i)
        for j, weight in enumerate(factor.coeffs()):
            for power, c in part.items():
                total[j][power] = total[j].get(power, acb(0)) + weight * c
    return Symbol(tuple(total), symbol.degree, symbol.decaying, TURN)


def disc_tables(problem: NormalModeProblem) -> Tables[Discs]:
    """The tables in double precision, every coefficient a disc of shape ()."""
    tables = ball_tables(problem, DOUBLE_BITS)
    with ctx.workprec(DOUBLE_BITS):
        symbols = (Symbol(tuple(_rounded(p) for p in s.powers), s.degree, s.decaying, s.turn) for s in tables.symbols)
        rows = (
            Row(tuple(Entry(e.block, e.n, _rounded(e.coefficient)) for e in row.entries), row.degree)
            for row in tables.rows
        )
        return Tables(tuple(symbols), tuple(rows), tables.blocks, tables.longest)


def _rounded(polynomial: Mapping[int, acb]) -> dict[int, Discs]:
    return {power: constant(c) for power, c in polynomial.items()}


def _scaled(
    problem: NormalModeProblem, polynomials: Sequence[fmpz_mpoly], at: Mapping[str, acb], lam: acb, bits: int
) -> tuple[list[dict[int, acb]], int]:
    """The polynomials in mu with one scale, and their largest degree."""
    expanded = [
        {
            power: problem.coefficients.ball(c, bits, at) / lam**power
            for power, c in enumerate(powers_of(polynomial, problem.variable))
            if not c.is_zero()
        }
        for polynomial in polynomials
    ]
    shift = max((_exponent(c) for parts in expanded for c in parts.values()), default=0)
    scale = acb(2) ** -shift
    degree = max((power for parts in expanded for power in parts), default=0)
    return [{power: c * scale for power, c in parts.items()} for parts in expanded], degree


def _exponent(value: acb) -> int:
    """log2 of the modulus, rounded up."""
    mantissa, exponent = value.abs_upper().man_exp()
    return int(exponent) + int(mantissa).bit_length()
