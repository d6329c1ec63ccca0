"""Single zeros of Delta, in balls: polished to any precision, and proved.

Delta is evaluated together with its derivative in mu (lam*s, or z) as a dual number of balls. With X a ball and x0 in
it, the interval Newton step N = x0 - Delta(x0)/Delta'(X) holds every zero in X; N inside X proves just one, a
simple one (Moore, Interval Analysis, 1966; for an analytic function as for a real one, since Delta(x) - Delta(x0)
is x - x0 times a mean of Delta' over the segment between them, which lies in the convex enclosure of Delta'(X)).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import acb, arb, ctx

from gks.modes.algebraic import GUARD_BITS
from gks.modes.kreiss import newton_columns
from gks.modes.tables import Row, Symbol, Tables

APPROXIMATION_STEPS = 12
"""Ehrlich-Aberth triples the digits of simple roots at each step: enough from doubles to any precision used here."""


class NotEnclosed(ArithmeticError):
    """The balls are too wide: spatial roots are not told apart, or no pivot is certain."""


@dataclass(frozen=True, slots=True)
class Dual:
    """A value and its derivative in mu, both balls."""

    value: acb
    slope: acb

    def __add__(self, other: Dual) -> Dual:
        return Dual(self.value + other.value, self.slope + other.slope)

    def __sub__(self, other: Dual) -> Dual:
        return Dual(self.value - other.value, self.slope - other.slope)

    def __mul__(self, other: Dual) -> Dual:
        return Dual(self.value * other.value, self.slope * other.value + self.value * other.slope)

    def __truediv__(self, other: Dual) -> Dual:
        quotient = self.value / other.value
        return Dual(quotient, (self.slope - quotient * other.slope) / other.value)


ZERO = Dual(acb(0), acb(0))
ONE = Dual(acb(1), acb(0))


@dataclass(frozen=True, slots=True)
class SpatialRoots:
    """The roots y of a family's symbol over a ball of mu, the decaying ones with their derivatives."""

    decaying: tuple[Dual, ...]
    others: tuple[acb, ...]

    def told_by_modulus(self) -> bool:
        """Whether the ones called decaying are those, and all those, inside the unit circle."""
        return all(abs(x.value) < 1 for x in self.decaying) and all(abs(x) > 1 for x in self.others)


def spatial_roots(symbol: Symbol, mu: acb, hints: Sequence[complex]) -> SpatialRoots:
    """Encloses the roots of a family over a ball; ``hints`` approximate them all, the decaying ones first.

    Raises NotEnclosed where a decaying root is not separated from the others.
    """
    value = [_at(p, mu) for p in symbol.powers]
    exact = [_at(p, mu.mid()).mid() for p in symbol.powers]
    centres = _polished(exact, [acb(x) for x in hints])
    radii = _radii(value, centres)
    found: list[Dual] = []
    slopes = [_slope_at(p, mu) for p in symbol.powers]
    for k, centre in enumerate(centres[: symbol.decaying]):
        ball = _ball(centre, radii[k])
        if any(ball.overlaps(_ball(centres[j], radii[j])) for j in range(len(centres)) if j != k):
            raise NotEnclosed("spatial roots that are not kept apart")
        across = _horner(_derivative(value), ball)
        if across.contains(0):
            raise NotEnclosed("a spatial root that may be double")
        sharper = centre - _horner(value, centre) / across
        if sharper.rad() < ball.rad():
            ball = sharper
        found.append(Dual(ball, -_horner(slopes, ball) / _horner(_derivative(value), ball)))
    rest = tuple(_ball(c, r) for c, r in zip(centres[symbol.decaying :], radii[symbol.decaying :], strict=True))
    return SpatialRoots(tuple(found), rest)


def _ball(centre: acb, radius: arb) -> acb:
    reach = arb(0, radius.upper())
    return acb(centre.real + reach, centre.imag + reach)


def _at(polynomial: Mapping[int, acb], mu: acb) -> acb:
    return sum((c * mu**k for k, c in polynomial.items()), acb(0))


def _slope_at(polynomial: Mapping[int, acb], mu: acb) -> acb:
    return sum((k * c * mu ** (k - 1) for k, c in polynomial.items() if k), acb(0))


def _derivative(coefficients: Sequence[acb]) -> list[acb]:
    return [k * c for k, c in enumerate(coefficients)][1:]


def _horner(coefficients: Sequence[acb], x: acb) -> acb:
    value = acb(0)
    for c in reversed(coefficients):
        value = value * x + c
    return value


def _polished(coefficients: Sequence[acb], start: Sequence[acb]) -> list[acb]:
    """Approximate roots, exact numbers, by Ehrlich-Aberth steps at the working precision."""
    x = list(start)
    slope = _derivative(coefficients)
    goal = arb(2) ** (-ctx.prec // 2)
    for _ in range(APPROXIMATION_STEPS):
        moved = arb(0)
        for k, each in enumerate(x):
            value = _horner(coefficients, each)
            repulsion = sum((1 / (each - other) for j, other in enumerate(x) if j != k), acb(0))
            step = (value / (_horner(slope, each) - value * repulsion)).mid()
            if step.is_finite():
                x[k] = (each - step).mid()
                moved = moved.max(abs(step).mid() / abs(x[k]).mid().max(arb(2) ** -ctx.prec))
        if moved < goal:
            break
    return x


def _radii(coefficients: Sequence[acb], centres: Sequence[acb]) -> list[arb]:
    """Smith's radii (see `gks.modes.rootdiscs`); infinite where two centres coincide."""
    radii = []
    for k, centre in enumerate(centres):
        product = coefficients[-1]
        for j, other in enumerate(centres):
            if j != k:
                product = product * (centre - other)
        radii.append(abs(_horner(coefficients, centre)) * len(centres) / abs(product))
    return radii


def root_near(coefficients: Sequence[acb], starts: Sequence[complex], near: complex) -> acb:
    """A ball around the root of a polynomial closest to a point; NotEnclosed where another one overlaps it."""
    centres = _polished([c.mid() for c in coefficients], [acb(x) for x in starts])
    balls = [_ball(c, r) for c, r in zip(centres, _radii(coefficients, centres), strict=True)]
    k = min(range(len(balls)), key=lambda j: abs(complex(centres[j]) - near))
    if any(balls[k].overlaps(other) for j, other in enumerate(balls) if j != k) or not balls[k].is_finite():
        raise NotEnclosed("growth factors that are not kept apart")
    return balls[k]


# The determinant ------------------------------------------------------------------------------------------------------


def delta(tables: Tables, mu: acb, roots: Sequence[SpatialRoots]) -> Dual:
    """Delta and its derivative over a ball of mu, in the Newton basis of the decaying roots."""
    variable = Dual(mu, acb(1))
    columns = []
    for k, (family, zeros) in enumerate(tables.blocks):
        decaying = [_turned_back(tables.symbols[family], y) for y in roots[family].decaying]
        columns.append(newton_columns([ZERO] * zeros + decaying, tables.longest[k], ZERO, ONE))
    matrix = [_line(row, columns, variable) for row in tables.rows]
    return determinant(matrix)


def _turned_back(symbol: Symbol, y: Dual) -> Dual:
    """x = (y + c)/(1 + conj(c) y)."""
    if not symbol.turn:
        return y
    turn, back = (Dual(acb(c), acb(0)) for c in (symbol.turn, symbol.turn.conjugate()))
    return (y + turn) / (ONE + back * y)


def kappas(tables: Tables, roots: Sequence[SpatialRoots]) -> tuple[tuple[acb, ...], ...]:
    """The decaying roots x of every family."""
    return tuple(
        tuple(_turned_back(symbol, y).value for y in mine.decaying)
        for symbol, mine in zip(tables.symbols, roots, strict=True)
    )


def _line(row: Row, columns: Sequence[Sequence[Sequence[Dual]]], mu: Dual) -> list[Dual]:
    weights = [
        (e.block, e.n, Dual(_at(e.coefficient, mu.value), _slope_at(e.coefficient, mu.value))) for e in row.entries
    ]
    line = []
    for k, block in enumerate(columns):
        for column in block:
            entry = ZERO
            for at, n, weight in weights:
                if at == k:
                    entry = entry + weight * column[n]
            line.append(entry)
    return line


def determinant(matrix: Sequence[Sequence[Dual]]) -> Dual:
    """Elimination with the largest certain pivot; the last entry left is multiplied in as it is, zero or not."""
    rows = [list(row) for row in matrix]
    result = ONE
    while len(rows) > 1:
        places = [(i, j) for i in range(len(rows)) for j in range(len(rows)) if not rows[i][j].value.contains(0)]
        if not places:
            raise NotEnclosed("no certain pivot")
        i, j = max(places, key=lambda p: float(abs(rows[p[0]][p[1]].value).mid()))
        pivot = rows.pop(i)
        result = result * pivot[j]
        if (i + j) % 2:
            result = Dual(-result.value, -result.slope)
        reduced = []
        for row in rows:
            factor = row[j] / pivot[j]
            reduced.append([a - factor * b for k, (a, b) in enumerate(zip(row, pivot, strict=True)) if k != j])
        rows = reduced
    return result * rows[0][0] if rows else result


# Newton's method ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Zero:
    """A simple zero of Delta, proved to be the only one in the ball ``mu``; ``roots`` of every family over it."""

    mu: acb
    roots: tuple[SpatialRoots, ...]


def enclose(tables: Tables, mu: acb, hints: Sequence[Sequence[complex]], bits: int) -> Zero:
    """Proves a simple zero close to a good approximation; NotEnclosed where the Newton test fails."""
    with ctx.workprec(bits + GUARD_BITS):
        centre, value = _refined(tables, mu.mid(), hints, bits)
        step = value.value / value.slope
        # Four times what is left, and not less than what the last digits of the centre can move it by.
        ball = _ball(centre, 4 * abs(step).upper() + abs(centre).upper() * arb(2) ** (-bits - GUARD_BITS // 2))
        image = centre - value.value / _value(tables, ball, hints).slope
        if not ball.contains_interior(image):
            raise NotEnclosed("the Newton step leaves its ball")
        return Zero(image, tuple(spatial_roots(s, image, h) for s, h in zip(tables.symbols, hints, strict=True)))


def _refined(tables: Tables, centre: acb, hints: Sequence[Sequence[complex]], bits: int) -> tuple[acb, Dual]:
    """Newton steps up to the precision asked for: the exact point reached, and Delta there."""
    goal = arb(2) ** (4 - bits)
    for _ in range(bits.bit_length() + 4):  # quadratic convergence: each step doubles the digits
        value = _value(tables, centre, hints)
        step = value.value / value.slope
        if not step.is_finite():
            raise NotEnclosed("a zero that may be multiple")
        if abs(step).upper() <= abs(centre).upper() * goal or abs(step).upper() <= goal * goal:
            return centre, value
        centre = (centre - step).mid()
    raise NotEnclosed("Newton's method does not settle")


def _value(tables: Tables, mu: acb, hints: Sequence[Sequence[complex]]) -> Dual:
    return delta(tables, mu, [spatial_roots(s, mu, h) for s, h in zip(tables.symbols, hints, strict=True)])
