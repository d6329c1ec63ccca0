"""A normal-mode problem with its polynomials evaluated but for the resolvent variable: in balls, or in double precision.

The variable of the tables is mu = lam*s where the problem's is s, and z where it is z. Each symbol and each closure row
is divided by a power of two that brings its largest coefficient to about 1; neither moves a zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from flint import acb, ctx, fmpz_mpoly

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


@dataclass(frozen=True, slots=True)
class Symbol(Generic[C]):
    """P(mu, x): ``powers[i][k]`` is the coefficient of x**i mu**k (absent: 0), k at most ``degree``."""

    powers: tuple[Mapping[int, C], ...]
    degree: int
    decaying: int


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
            symbols.append(Symbol(tuple(parts), degree, family.decaying))
        rows = []
        for row in problem.rows:
            parts, degree = _scaled(problem, [t.coefficient for t in row], at, lam, bits)
            rows.append(Row(tuple(Entry(t.block, t.n, c) for t, c in zip(row, parts, strict=True)), degree))
    longest = [
        1 + max((t.n for row in problem.rows for t in row if t.block == k), default=0) for k in range(len(problem.blocks))
    ]
    return Tables(tuple(symbols), tuple(rows), tuple((b.family, b.zeros) for b in problem.blocks), tuple(longest))


def disc_tables(problem: NormalModeProblem) -> Tables[Discs]:
    """The tables in double precision, every coefficient a disc of shape ()."""
    tables = ball_tables(problem, DOUBLE_BITS)
    with ctx.workprec(DOUBLE_BITS):
        symbols = (Symbol(tuple(_rounded(p) for p in s.powers), s.degree, s.decaying) for s in tables.symbols)
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
