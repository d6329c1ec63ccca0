"""A normal-mode problem in double precision: its polynomials as discs, ready for evaluation at many points at once.

The variable of the tables is mu = lam*s where the problem's is s, and z where it is z. Each symbol and each closure row
is divided by a power of two that brings its largest coefficient to about 1; neither moves a zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import acb, ctx, fmpz_mpoly

from gks.modes.algebraic import GUARD_BITS
from gks.modes.coefficients import value_ball
from gks.modes.discs import Discs, constant
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem

TABLE_BITS = 128
"""Precision of the coefficients before they are rounded to doubles: above a double's by more than cancellation among
the few generators' terms costs; whatever it costs is in the discs' radii."""

Polynomial = Mapping[int, Discs]
"""Power of the variable -> coefficient, of shape (); absent powers are exactly zero."""


@dataclass(frozen=True, slots=True)
class SymbolTable:
    """P(mu, x): ``powers[i]`` is the coefficient of x**i, of degree at most ``degree`` in mu."""

    powers: tuple[Polynomial, ...]
    degree: int
    decaying: int


@dataclass(frozen=True, slots=True)
class Entry:
    """A coefficient times v_n of a block."""

    block: int
    n: int
    coefficient: Polynomial


@dataclass(frozen=True, slots=True)
class RowTable:
    """One closure equation, of degree at most ``degree`` in mu."""

    entries: tuple[Entry, ...]
    degree: int


@dataclass(frozen=True, slots=True)
class Tables:
    """``blocks`` gives (family, zeros) of every block."""

    symbols: tuple[SymbolTable, ...]
    rows: tuple[RowTable, ...]
    blocks: tuple[tuple[int, int], ...]

    @property
    def size(self) -> int:
        return len(self.rows)


def tables_of(problem: NormalModeProblem) -> Tables:
    """Rounds a problem to discs; OverflowError where its coefficients have no common scale within doubles."""
    with ctx.workprec(TABLE_BITS + GUARD_BITS):
        lam = acb(1)
        if problem.variable == "s":
            lam = value_ball(problem.coefficients.values[problem.resolvent.cfl], TABLE_BITS)
        at = {name: root.ball(TABLE_BITS) for name, root in problem.coefficients.point().items()}
        symbols = []
        for family in problem.families:
            parts = powers_of(family.polynomial, "x")
            rounded, degree = _rounded(problem, parts, at, lam)
            symbols.append(SymbolTable(tuple(rounded), degree, family.decaying))
        rows = []
        for row in problem.rows:
            rounded, degree = _rounded(problem, [t.coefficient for t in row], at, lam)
            entries = (Entry(t.block, t.n, c) for t, c in zip(row, rounded, strict=True))
            rows.append(RowTable(tuple(entries), degree))
    return Tables(tuple(symbols), tuple(rows), tuple((b.family, b.zeros) for b in problem.blocks))


def _rounded(
    problem: NormalModeProblem, polynomials: Sequence[fmpz_mpoly], at: Mapping[str, acb], lam: acb
) -> tuple[list[Polynomial], int]:
    """The polynomials in mu with one scale, and their largest degree."""
    expanded = [
        {
            power: problem.coefficients.ball(c, TABLE_BITS, at) / lam**power
            for power, c in enumerate(powers_of(polynomial, problem.variable))
            if not c.is_zero()
        }
        for polynomial in polynomials
    ]
    exponents = [_exponent(c) for parts in expanded for c in parts.values()]
    shift = max((e for e in exponents if e is not None), default=0)
    scale = acb(2) ** -shift
    degree = max((power for parts in expanded for power in parts), default=0)
    return [{power: constant(c * scale) for power, c in parts.items()} for parts in expanded], degree


def _exponent(value: acb) -> int | None:
    """log2 of the modulus, rounded up; None for 0."""
    size = value.abs_upper()
    if size == 0:
        return None
    mantissa, exponent = size.man_exp()
    return int(exponent) + int(mantissa).bit_length()
