"""A normal-mode problem with its polynomials evaluated but for the resolvent variable, in balls or as arrays of discs.

The variable of the tables is mu = lam*s where the problem's is s, and z where it is z. Each symbol and each closure row
is divided by a power of two that brings its largest coefficient to about 1; neither moves a zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from flint import acb, acb_poly, ctx, fmpz_mpoly
from numpy.typing import NDArray

from gks.modes.algebraic import GUARD_BITS
from gks.modes.coefficients import value_ball
from gks.modes.discs import Discs, constant, joined
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem
from gks.modes.kreiss import longest as longest_read

DOUBLE_BITS = 128
"""Precision of coefficients that are then rounded to doubles: what cancellation among a few generators' terms costs
stays below a double's rounding, and is in the discs' radii where it does not."""

TURN = 0.25 + 0.375j
"""c of the turn x = (y + c)/(1 + conj(c) y), which keeps the unit disc. Exact in doubles, and off the real axis: a
family has a root x = 1/conj(c), which would go to infinity in its turn, by an accident only."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """P(mu, y): ``powers[i][k]`` is the coefficient of y**i mu**k (absent: 0), k at most ``degree``; ``plain`` in x.

    x = (y + turn)/(1 + conj(turn) y). The turn is 0 where no spatial root passes through infinity while abs(z) = 1.
    """

    powers: tuple[Mapping[int, acb], ...]
    plain: tuple[Mapping[int, acb], ...]
    degree: int
    decaying: int
    turn: complex


@dataclass(frozen=True, slots=True)
class Entry:
    """A coefficient, given by its powers of mu, times v_n of a block."""

    block: int
    n: int
    coefficient: Mapping[int, acb]


@dataclass(frozen=True, slots=True)
class Row:
    """One closure equation, of degree at most ``degree`` in mu."""

    entries: tuple[Entry, ...]
    degree: int


@dataclass(frozen=True, slots=True)
class Tables:
    """``blocks`` gives (family, zeros) of every block, ``longest`` how many v_n the closure reads of it, at least 1."""

    symbols: tuple[Symbol, ...]
    rows: tuple[Row, ...]
    blocks: tuple[tuple[int, int], ...]
    longest: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of equations, which is that of decaying solutions."""
        return len(self.rows)


def ball_tables(problem: NormalModeProblem, bits: int) -> Tables:
    """The tables to a relative precision of about ``bits``."""
    with ctx.workprec(bits + GUARD_BITS):
        lam = acb(1)
        if problem.variable == "s":
            lam = value_ball(problem.coefficients.values[problem.resolvent.cfl], bits)
        at = {name: root.ball(bits) for name, root in problem.coefficients.point().items()}
        symbols = []
        for family in problem.families:
            parts, degree = _scaled(problem, powers_of(family.polynomial, "x"), at, lam, bits)
            symbols.append(
                _turned(Symbol(tuple(parts), tuple(parts), degree, family.decaying, 0j), _reaches_infinity(problem))
            )
        rows = []
        for row in problem.rows:
            parts, degree = _scaled(problem, [t.coefficient for t in row], at, lam, bits)
            rows.append(Row(tuple(Entry(t.block, t.n, c) for t, c in zip(row, parts, strict=True)), degree))
    longest = [max(1, longest_read(problem.rows, k)) for k in range(len(problem.blocks))]
    return Tables(tuple(symbols), tuple(rows), tuple((b.family, b.zeros) for b in problem.blocks), tuple(longest))


def _reaches_infinity(problem: NormalModeProblem) -> bool:
    """Whether lam*s is infinite at a point with abs(z) = 1: the poles of Crank-Nicolson and of the exact solution."""
    method = problem.resolvent.integrator
    if problem.variable == "z" or method is None or method.kind == "runge-kutta":
        return False
    return method.kind == "exact" or not (sum(method.sigma) and sum(c * (-1) ** k for k, c in enumerate(method.sigma)))


def _turned(symbol: Symbol, infinite: bool) -> Symbol:
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
    return Symbol(tuple(total), symbol.plain, symbol.degree, symbol.decaying, TURN)


@dataclass(frozen=True, slots=True)
class DiscSymbol:
    """A symbol in double precision: ``powers`` (degree + 1, n + 1), rows by powers of mu; ``plain`` the same in x.

    In y a few large terms nearly cancel where x is small, so that little can be said of the roots over a disc: y is for
    the places where a root may be infinite alone.
    """

    powers: Discs
    plain: Discs
    decaying: int
    turn: complex


@dataclass(frozen=True, slots=True)
class DiscRows:
    """The closure equations of one degree in mu: their numbers, and what they read, (degree + 1, rows, columns).

    The columns are v_0, v_1, ... of the first block, then those of the next.
    """

    numbers: NDArray[np.intp]
    weights: Discs


@dataclass(frozen=True, slots=True)
class DiscTables:
    """The tables in double precision."""

    symbols: tuple[DiscSymbol, ...]
    rows: tuple[DiscRows, ...]
    blocks: tuple[tuple[int, int], ...]
    longest: tuple[int, ...]

    @property
    def size(self) -> int:
        """Number of equations."""
        return sum(len(rows.numbers) for rows in self.rows)


def disc_tables(problem: NormalModeProblem) -> DiscTables:
    """Rounds the tables of a problem to discs."""
    tables = ball_tables(problem, DOUBLE_BITS)
    first = np.concatenate([[0], np.cumsum(tables.longest)])
    with ctx.workprec(DOUBLE_BITS):
        symbols = [
            DiscSymbol(_symbol_table(s.powers, s.degree), _symbol_table(s.plain, s.degree), s.decaying, s.turn)
            for s in tables.symbols
        ]
        rows = []
        for degree in sorted({row.degree for row in tables.rows}):
            numbers = [i for i, row in enumerate(tables.rows) if row.degree == degree]
            weights = [
                _rounded([e.coefficient for e in row], degree, [int(first[e.block]) + e.n for e in row], int(first[-1]))
                for row in (tables.rows[i].entries for i in numbers)
            ]
            rows.append(DiscRows(np.array(numbers), joined(weights, lambda parts: np.stack(parts, 1))))
    return DiscTables(tuple(symbols), tuple(rows), tables.blocks, tables.longest)


def _symbol_table(powers: Sequence[Mapping[int, acb]], degree: int) -> Discs:
    return _rounded(powers, degree, range(len(powers)), len(powers))


def _rounded(polynomials: Sequence[Mapping[int, acb]], degree: int, places: Sequence[int], width: int) -> Discs:
    """Polynomials as the columns at the given places of (degree + 1, width)."""
    mid, rad = np.zeros((degree + 1, width), complex), np.zeros((degree + 1, width))
    for polynomial, place in zip(polynomials, places, strict=True):
        for power, c in polynomial.items():
            disc = constant(c)
            mid[power, place], rad[power, place] = disc.mid, disc.rad
    return Discs(mid, rad)


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
