"""Systems whose unknowns no change of basis separates: one scalar equation for all of them.

On the mirrored half-line the interior of m unknowns is a square polynomial matrix in the shift E,

    M(sigma, E) V = 0,        V_u(n) the unknown u at the n-th point that the interior reads of it,

column u multiplied by x**reach_u, so that no negative power is left. With D = det M and c = adj(M) h for any constant
vector h,

    M c = D h,        so V = c(E) w solves the system wherever D(E) w = 0.

The solutions number deg_x D, and w -> c(E) w hits each once unless c vanishes at a root of D: the coupled half-line is
one scalar field w, and its unknowns are combinations of shifts of it. Where all columns of adj(M) vanish at a spatial
root two or more branches cross; ``crossing`` takes over there.

Values below an unknown's own reach, which only the closure reads, are free: each is a spatial root 0 of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import ctx, fmpz_mpoly

from gks.errors import NotAnalysable
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.coefficients import Coefficients, Ratio, common_denominator
from gks.modes.determinant import determinant
from gks.modes.fibre import VanishesIdentically, at_balls, fibre, is_zero, specialise
from gks.modes.fibre import coefficients as powers_of
from gks.modes.field import Field, mirrored, without_content
from gks.modes.resolvent import Resolvent
from gks.scheme.model import HalfLine, LinearForm, WrittenDiscrete, WrittenLines

Matrix = tuple[tuple[fmpz_mpoly, ...], ...]


@dataclass(frozen=True, slots=True)
class System:
    """The interior of a coupled half-line: M by rows, its determinant D, and how far below the cell each unknown is
    read.
    """

    matrix: Matrix
    symbol: fmpz_mpoly
    reach: tuple[int, ...]

    @property
    def size(self) -> int:
        return len(self.reach)

    def column(self, h: Sequence[int]) -> tuple[fmpz_mpoly, ...]:
        """adj(M) h, by Cramer's rule."""
        one = self.symbol.context().constant(1)
        found = []
        for u in range(self.size):
            rows = [[*row[:u], one * k, *row[u + 1 :]] for row, k in zip(self.matrix, h, strict=True)]
            found.append(determinant(rows, one))
        return tuple(found)

    def adjugate(self) -> list[tuple[fmpz_mpoly, ...]]:
        """The columns of adj(M)."""
        return [self.column([int(j == k) for j in range(self.size)]) for k in range(self.size)]

    def row_degree(self, variable: str) -> int:
        """The degree in the resolvent variable that D has where the leading coefficients determine the new level."""
        place = self.symbol.context().names().index(variable)
        return sum(max(int(entry.degrees()[place]) for entry in row if not entry.is_zero()) for row in self.matrix)


@dataclass(frozen=True, slots=True)
class CoupledField(Field):
    """The field w of a coupled half-line; ``column`` is c, one polynomial in x an unknown."""

    system: System
    column: tuple[fmpz_mpoly, ...]

    def polynomial(self, coefficients: Coefficients, ghosts: int) -> fmpz_mpoly:
        """D without its factors in sigma alone; all ghost values are in it already."""
        return without_content(self.system.symbol)

    def share(self, component: int, n: int, ghosts: int) -> list[tuple[int, Ratio]]:
        """V_u(n) = sum_j c_{u,j} w_{n+j}, counted from the unknown's own first point."""
        place = n - ghosts + self.system.reach[component]
        if place < 0:
            return []
        one = self.system.symbol.context().constant(1)
        powers = enumerate(powers_of(self.column[component], "x"))
        return [(place + j, Ratio(c, one)) for j, c in powers if not c.is_zero()]

    def vanishes(self, point: Mapping[str, Root], root: Root) -> bool:
        """Whether c is zero at a spatial root, so that w does not give the solution there."""
        at = {**point, "x": root}
        with ctx.workprec(START_BITS + GUARD_BITS):
            balls = {name: each.ball(START_BITS) for name, each in at.items()}
            if any(not at_balls(c, balls).contains(0) for c in self.column):
                return False
        return all(is_zero(at, c) for c in self.column)


@dataclass(frozen=True, slots=True)
class ValueField(Field):
    """The values of one unknown by themselves: the n-th of them is v_n.

    ``free``: those below the interior's reach, which it does not tie to anything (the stencil, which only the question
    of Cauchy stability sees, says that they do not change). Otherwise those that the interior reads.
    """

    component: int
    reach: int
    free: bool

    def polynomial(self, coefficients: Coefficients, ghosts: int) -> fmpz_mpoly:
        """x**(number of free values)."""
        return coefficients.gens["x"] ** (ghosts - self.reach)

    def share(self, component: int, n: int, ghosts: int) -> list[tuple[int, Ratio]]:
        """The value itself, where it is one of these."""
        first = ghosts - self.reach
        if component != self.component or (n < first) != self.free:
            return []
        one = next(iter(self.stencil.values())).den
        return [(n if self.free else n - first, Ratio(one, one))]


def coupled_fields(half_line: HalfLine, coefficients: Coefficients, resolvent: Resolvent) -> list[Field]:
    """The one field of a coupled half-line and the free values of each unknown.

    Raises NotAnalysable where the equations do not determine the unknowns, or where two independent solutions share
    their spatial root for every sigma.
    """
    system = _system(half_line, coefficients, resolvent)
    if coefficients.is_zero(system.symbol):
        raise NotAnalysable(f"domain {half_line.name}: the interior equations do not determine all its unknowns")
    column = next(_cyclic(system, coefficients), None)
    if column is None:
        raise NotAnalysable(
            f"domain {half_line.name}: its coupled unknowns have independent solutions with one spatial root",
            expected="a coupled interior with one solution for each spatial root",
        )
    stencil = {
        j: coefficients.of(c) for j, c in enumerate(powers_of(system.symbol, "x")) if not coefficients.is_zero(c)
    }
    still = {0: coefficients.of(coefficients.gens[resolvent.name])}
    fields: list[Field] = [CoupledField(half_line.name, (), stencil, None, system, column)]
    fields += [
        ValueField(half_line.name, (), still, None, component, reach, True)
        for component, reach in enumerate(system.reach)
    ]
    return fields


def _system(half_line: HalfLine, coefficients: Coefficients, resolvent: Resolvent) -> System:
    interior = half_line.interior
    assert isinstance(interior, WrittenDiscrete | WrittenLines)
    rows = [_row(half_line, form, coefficients, resolvent) for form in interior.equations]
    unknowns = range(len(half_line.unknowns))
    reach = tuple(-min((j for row in rows for u, j in row if u == unknown), default=0) for unknown in unknowns)
    x, zero = coefficients.gens["x"], coefficients.context.constant(0)
    matrix = tuple(
        tuple(sum((c * x ** (j + reach[u]) for (v, j), c in row.items() if v == u), zero) for u in unknowns)
        for row in rows
    )
    return System(matrix, determinant(matrix, coefficients.context.constant(1)), reach)


def _row(
    half_line: HalfLine, form: LinearForm, coefficients: Coefficients, resolvent: Resolvent
) -> dict[tuple[int, int], fmpz_mpoly]:
    """One equation: (unknown, mirrored offset) -> coefficient, cleared of denominators and of powers of z."""
    base, _ = form.levels
    entries: dict[tuple[int, int], Ratio] = {}
    for value, coefficient in form.terms:
        term = coefficients.evaluate(coefficient) * resolvent.power(coefficients, value.level - base)
        if value.derivative:
            term = term * resolvent.of(half_line.name)
        key = half_line.unknowns.index(value.unknown), mirrored(half_line, value.index)
        entries[key] = entries[key] + term if key in entries else term
    live = {key: value for key, value in entries.items() if not coefficients.is_zero(value.num)}
    clear = common_denominator(list(live.values()), coefficients.context.constant(1))
    return {key: value.num * (clear / value.den) for key, value in live.items()}


def _cyclic(system: System, coefficients: Coefficients) -> Iterator[tuple[fmpz_mpoly, ...]]:
    """The columns c = adj(M) h, factors in sigma alone cleared, that vanish at no root of D for general sigma."""
    symbol = without_content(system.symbol)
    for h in trial_vectors(system.size):
        column = system.column(h)
        common = column[0]
        for entry in column[1:]:
            common = common.gcd(entry)
        if common.is_zero():
            continue
        if not common.degrees()[common.context().names().index("x")] and _holds_at_sample(
            symbol, column, coefficients
        ):
            yield tuple(entry / common for entry in column)


def _holds_at_sample(symbol: fmpz_mpoly, column: Sequence[fmpz_mpoly], coefficients: Coefficients) -> bool:
    """That c vanishes at no root of D at one arbitrary sigma. Greatest common factors do not know that a generator's
    relation holds; this does.
    """
    if not coefficients.generators or any(each.root is None for each in coefficients.generators):
        return True
    names = {"s": Fraction(17, 7), "z": Fraction(17, 7)}
    names |= {coefficients.variable(s): Fraction(23, 19) for s in coefficients.symbols}
    point = coefficients.point()
    parts = [specialise(c, names) for c in column]
    try:
        roots = fibre(point, specialise(symbol, names), "x")
    except VanishesIdentically:
        return False
    return not any(all(is_zero({**point, "x": r.root}, c) for c in parts) for r in roots)


def trial_vectors(size: int) -> Iterator[list[int]]:
    """Constant vectors h to try: unit vectors give the smallest columns, mixtures see fields that do not meet."""
    for k in range(size):
        yield [int(j == k) for j in range(size)]
    for k in range(1, 4):
        yield [(j + 1) ** k for j in range(size)]
