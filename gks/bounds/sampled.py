"""Delta at many points at once, in double precision: what tracing, maps and fast sweeps are computed with.

Nothing here is proved. The decaying solutions on abs(z) = 1 are told by the direction in which log(abs(kappa)) moves as
abs(z) grows, to first order, so points at which spatial roots meet on the circle are as good as a limit there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import fmpz_mpoly
from numpy.typing import NDArray

from gks.bounds.allroots import all_roots
from gks.modes.doubledouble import UNIT
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem, longest

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

ROUNDINGS = 16
"""A computed root is off by some roundings of the terms of its polynomial over the slope there: 16 of them for degrees
up to 8, of which a few are seen."""
CLEAR = 2.0**-20
"""log(abs(kappa)) beyond which a root is on its side of the circle, whatever its rounding: that of a pair which far
apart is a thousandth of it."""


@dataclass(frozen=True, slots=True)
class _Terms:
    """A polynomial: coefficients (T,) and exponents (T, variables), scaled to a largest coefficient of 1."""

    weights: Array
    exponents: NDArray[np.intp]

    @property
    def moduli(self) -> _Terms:
        """The same with the moduli of its coefficients: at moduli of the variables the sum of those of the terms."""
        return _Terms(np.abs(self.weights), self.exponents)

    @property
    def operations(self) -> int:
        """Roundings that a term goes through: its coefficient, the variables, the products and the sums."""
        return len(self.weights) + 2 * int(self.exponents.sum(axis=1).max(initial=0)) + 1

    def at(self, powers: Sequence[Sequence[ComplexArray]], points: int) -> ComplexArray:
        total = np.zeros(points, complex)
        for weight, exponents in zip(self.weights, self.exponents, strict=True):
            term: ComplexArray | float = float(weight)
            for table, e in zip(powers, exponents, strict=True):
                if e:
                    term = term * table[e]
            total += term
        return total


@dataclass(frozen=True, slots=True)
class _Family:
    powers: tuple[_Terms, ...]
    decaying: int


@dataclass(frozen=True, slots=True)
class Values:
    """At N points: Delta (N,), each row divided by the sum of the moduli of its terms, and the spatial roots of every
    family, the decaying ones (N, decaying) and the others.
    """

    determinant: ComplexArray
    decaying: tuple[ComplexArray, ...]
    others: tuple[ComplexArray, ...]

    def take(self, points: NDArray[np.intp]) -> Values:
        """At some of the points."""
        decaying, others = (tuple(each[points] for each in every) for every in (self.decaying, self.others))
        return Values(self.determinant[points], decaying, others)


@dataclass(frozen=True, slots=True)
class Rounded:
    """abs(Delta) at N points as in `Values`, log2 of what the rows were divided by, and a bound of what the rounding of
    the rows, of their elimination and of nothing else adds up to.
    """

    modulus: Array
    scale: Array
    rounding: Array


@dataclass(frozen=True, slots=True)
class Sampled:
    """A problem ready to be evaluated at its resolvent variable, its symbols, and what is irrational in it."""

    families: tuple[_Family, ...]
    blocks: tuple[tuple[int, int, int], ...]
    """(family, zeros, longest) of every block."""
    rows: tuple[tuple[tuple[int, int, _Terms], ...], ...]
    irrational: tuple[complex | _Terms, ...]
    highest: tuple[int, ...]
    variable: str

    def at(self, sigma: ComplexArray, *symbols: Array, towards: ComplexArray | None = None) -> Values:
        """Delta at points sigma with values of the symbols, all of shape (N,).

        ``towards``: the direction in which sigma moves as abs(z) grows, where it is not abs(sigma) or Re s that does.
        """
        if towards is None:
            towards = sigma if self.variable == "z" else np.ones_like(sigma)
        powers = self._powers(sigma, symbols)
        split = [_split(family, powers, towards) for family in self.families]
        decaying = tuple(mine for mine, _ in split)
        return Values(self._determinant(decaying, powers, len(sigma)), decaying, tuple(others for _, others in split))

    def reach(self, sigma: ComplexArray, decaying: Sequence[ComplexArray], *symbols: Array) -> Array:
        """How far sigma has to move to change the polynomial of a decaying solution by the sum of the moduli of its
        terms: times the relative rounding of those, the change of sigma that rounding amounts to. At least abs(sigma).
        """
        powers = self._powers(sigma, symbols)
        moduli = [[np.abs(each) for each in table] for table in powers]
        farthest = np.abs(sigma)
        for family, roots in zip(self.families, decaying, strict=True):
            sizes = np.stack([terms.moduli.at(moduli, len(sigma)).real for terms in family.powers], axis=1)
            steps = np.stack([_derivative(terms).at(powers, len(sigma)) for terms in family.powers], axis=1)
            each = horner(sizes, np.abs(roots)) / np.abs(horner(steps, roots))
            farthest = np.maximum(farthest, each.max(axis=1, initial=0))
        return np.asarray(farthest)

    def _powers(self, sigma: ComplexArray, symbols: Sequence[Array]) -> list[list[ComplexArray]]:
        """Tables of the powers of all variables."""
        powers: list[list[ComplexArray]] = []
        for value in (sigma, *symbols):
            powers.append(_powers(np.asarray(value, complex), self.highest[len(powers)]))
        for each in self.irrational:
            known = each if isinstance(each, complex) else np.sqrt(each.at(powers, len(sigma)))
            powers.append(_powers(np.zeros(len(sigma), complex) + known, self.highest[len(powers)]))
        return powers

    def continued(
        self, sigma: ComplexArray, found: Values, *symbols: Array
    ) -> tuple[tuple[ComplexArray, ...], NDArray[np.bool_]]:
        """The spatial roots that the decaying ones found elsewhere have become, and whether these are told from the
        others: no pair of them has come nearer by more than two thirds of its distance there.
        """
        powers = self._powers(sigma, symbols)
        nearest, apart = [], np.ones(len(sigma), bool)
        for family, before, others in zip(self.families, found.decaying, found.others, strict=True):
            few = family.decaying
            roots = all_roots(np.stack([terms.at(powers, len(sigma)) for terms in family.powers], axis=1))
            if 0 < few < roots.shape[1]:
                distance = np.abs(roots[:, :, None] - before[:, None, :]).min(axis=2)
                order = np.argsort(distance, axis=1)
                roots, distance = (np.take_along_axis(each, order, axis=1) for each in (roots, distance))
                between = np.abs(others[:, :, None] - before[:, None, :]).min(axis=(1, 2))
                apart &= (distance[:, few - 1] < between / 3) & (distance[:, few] > between * 2 / 3)
            nearest.append(roots[:, :few])
        return tuple(nearest), apart

    def delta(self, sigma: ComplexArray, decaying: Sequence[ComplexArray], *symbols: Array) -> Rounded:
        """Delta of these solutions, with what rounding may have made of it."""
        powers = self._powers(sigma, symbols)
        matrix, size = self._matrix(decaying, powers, len(sigma))
        # The rows are scaled to sums of moduli of at most 1, and so no cofactor is above 1.
        with np.errstate(all="ignore"):
            scale = np.log2(size).sum(axis=0)
        determinant = np.linalg.det(np.ascontiguousarray(matrix.transpose(2, 0, 1)))
        return Rounded(np.abs(determinant), scale, self._rounding(decaying, powers, size))

    def surplus(self, counts: Sequence[int]) -> bool:
        """Whether so many solutions of every family outnumber the closure's equations."""
        return sum(zeros + counts[family] for family, zeros, _ in self.blocks) > len(self.rows)

    def full_rank(
        self, sigma: ComplexArray, roots: Sequence[ComplexArray],
        around: Sequence[tuple[ComplexArray, Sequence[ComplexArray]]], *symbols: Array,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """Where the closure certainly annihilates none of the solutions with these spatial roots, which are at most as
        many as its equations. ``around``: places as far off as sigma may be, with the roots there.

        A matrix loses rank by no change smaller than its smallest singular value (Eckart & Young).
        """
        powers = self._powers(sigma, symbols)
        matrix, size = self._matrix(roots, powers, len(sigma))
        if not matrix.shape[1]:
            return np.ones(len(sigma), bool)
        size = np.where(size > 0, size, 1)  # a row may have no solution of these
        change = np.zeros(len(sigma))
        for place, beside in around:
            # The roots' own rounding moves them and not the closure.
            for there in (self._powers(place, symbols), powers):
                moved, _ = self._matrix(beside, there, len(sigma), size)
                change += np.linalg.norm(moved - matrix, axis=(0, 1))
        stacked = np.ascontiguousarray(matrix.transpose(2, 0, 1))
        rounding = self._rounding(roots, powers, size)
        good = np.isfinite(stacked).all(axis=(1, 2)) & np.isfinite(change + rounding)
        least = np.zeros(len(sigma))
        least[good] = np.linalg.svd(stacked[good], compute_uv=False)[:, -1]
        # As of a determinant: the other half is for the curvature.
        return np.asarray(good & (least > 2 * change + rounding) & (matrix.shape[1] <= matrix.shape[0]))

    def _rounding(self, roots: Sequence[ComplexArray], powers: Sequence[Sequence[ComplexArray]], size: Array) -> Array:
        """What the rounding of the rows divided by their sizes, and that of their elimination, adds up to."""
        points = size.shape[1]
        moduli = [[np.abs(each) for each in table] for table in powers]
        order, operations, terms_size = len(self.rows), 4 * len(self.rows), np.zeros_like(size)
        columns = self._columns([np.abs(each).astype(complex) for each in roots], points)
        for i, row in enumerate(self.rows):
            for block, n, terms in row:
                share = terms.moduli.at(moduli, points).real * columns[block][n].real
                terms_size[i] += share.sum(axis=0)
                operations = max(operations, terms.operations + 4 * n + 4 * order)
        with np.errstate(all="ignore"):
            relative = (terms_size / size).sum(axis=0)
        return np.asarray(operations * UNIT * relative)

    def _determinant(
        self, roots: Sequence[ComplexArray], powers: Sequence[Sequence[ComplexArray]], points: int
    ) -> ComplexArray:
        matrix, _ = self._matrix(roots, powers, points)
        return np.asarray(np.linalg.det(np.ascontiguousarray(matrix.transpose(2, 0, 1))), complex)

    def _columns(self, roots: Sequence[ComplexArray], points: int) -> list[ComplexArray]:
        # Points run along the last axis: the others are a few numbers long.
        columns = []
        for family, zeros, count in self.blocks:
            mine = np.concatenate([np.zeros((zeros, points), complex), roots[family].T])
            columns.append(_newton(mine, count))
        return columns

    def _matrix(
        self, roots: Sequence[ComplexArray], powers: Sequence[Sequence[ComplexArray]], points: int,
        divisors: Array | None = None,
    ) -> tuple[ComplexArray, Array]:  # fmt: skip
        """The closure on the solutions, (rows, columns, N), and what each row was divided by: the sum of the moduli of
        its terms unless told.
        """
        columns = self._columns(roots, points)
        first = np.cumsum([0, *(c.shape[1] for c in columns)])
        matrix = np.zeros((len(self.rows), int(first[-1]), points), complex)
        size = np.zeros((len(self.rows), points))
        for i, row in enumerate(self.rows):
            for block, n, terms in row:
                share = terms.at(powers, points) * columns[block][n]
                matrix[i, first[block] : first[block + 1]] += share
                size[i] += np.abs(share).sum(axis=0)
        size = size if divisors is None else divisors
        matrix /= np.where(size > 0, size, 1)[:, None]
        return matrix, size


def sampled(problem: NormalModeProblem) -> Sampled:
    """Compiles a problem; its symbols are the arguments of ``at``, in their order."""
    index = _places(problem)
    families = tuple(
        _Family(_scaled([*powers_of(family.polynomial, "x")], index), family.decaying) for family in problem.families
    )
    rows = []
    for row in problem.rows:
        weights = _scaled([term.coefficient for term in row], index)
        rows.append(tuple((term.block, term.n, w) for term, w in zip(row, weights, strict=True)))
    irrational: list[complex | _Terms] = []
    for generator in problem.coefficients.generators:
        if generator.root is not None:
            irrational.append(complex(generator.root.ball()))
        else:
            square = problem.coefficients.gens[generator.name] ** 2 - generator.relation
            irrational.append(_exactly(square, index))
    every = [t for f in families for t in f.powers] + [t for row in rows for _, _, t in row]
    every += [t for t in irrational if isinstance(t, _Terms)]
    highest = np.max([t.exponents.max(axis=0, initial=0) for t in every], axis=0)
    blocks = tuple((b.family, b.zeros, max(1, longest(problem.rows, k))) for k, b in enumerate(problem.blocks))
    return Sampled(families, blocks, tuple(rows), tuple(irrational), tuple(int(h) for h in highest), problem.variable)


@dataclass(frozen=True, slots=True)
class Coefficients:
    """A polynomial in the resolvent variable, its coefficients being polynomials in the symbols."""

    powers: tuple[_Terms, ...]

    def at(self, *symbols: Array) -> ComplexArray:
        """Ascending: (N, degree + 1)."""
        points = len(symbols[0])
        highest = np.max([t.exponents.max(axis=0, initial=0) for t in self.powers], axis=0)
        tables = [_powers(np.asarray(v, complex), int(h)) for v, h in zip(symbols, highest[1:], strict=False)]
        return np.stack([terms.at([[], *tables], points) for terms in self.powers], axis=1)

    def sizes(self, *symbols: Array) -> Array:
        """The sums of the moduli of the terms of every coefficient: what its rounding is relative to."""
        moduli = Coefficients(tuple(terms.moduli for terms in self.powers))
        return np.asarray(moduli.at(*(np.abs(each) for each in symbols)).real)

    @property
    def operations(self) -> int:
        """Roundings that a coefficient's terms go through at most, those of the symbols included."""
        return max(terms.operations for terms in self.powers)


def polynomial_of(problem: NormalModeProblem, polynomial: fmpz_mpoly) -> Coefficients:
    """Compiles a polynomial in the resolvent variable and the symbols of the problem."""
    return Coefficients(_scaled(powers_of(polynomial, problem.variable), _places(problem)))


def _places(problem: NormalModeProblem) -> list[int]:
    """The resolvent variable, the symbols and the generators among the variables of the context."""
    names = [problem.variable, *(problem.coefficients.variable(s) for s in problem.coefficients.symbols)]
    names += [generator.name for generator in problem.coefficients.generators]
    return [problem.coefficients.context.names().index(name) for name in names]


def _scaled(polynomials: Sequence[fmpz_mpoly], index: Sequence[int]) -> tuple[_Terms, ...]:
    """With one scale for all."""
    bits = max((abs(int(c)).bit_length() for p in polynomials for c in p.coeffs()), default=0)
    return tuple(_exactly(p, index, bits) for p in polynomials)


def _exactly(polynomial: fmpz_mpoly, index: Sequence[int], bits: int = 0) -> _Terms:
    terms: Mapping[tuple[int, ...], int] = {tuple(int(e) for e in m): int(c) for m, c in polynomial.terms()}
    weights = np.array([c / (1 << bits) for c in terms.values()], float)
    exponents = np.array([[m[i] for i in index] for m in terms], np.intp).reshape(len(terms), len(index))
    return _Terms(weights, exponents)


def _powers(value: ComplexArray, highest: int) -> list[ComplexArray]:
    table = [np.ones_like(value)]
    for _ in range(highest):
        table.append(table[-1] * value)
    return table


def _newton(roots: ComplexArray, count: int) -> ComplexArray:
    """The Newton basis (count, d, N), as in `gks.modes.kreiss.newton_columns`."""
    basis = np.zeros((count, *roots.shape), complex)
    basis[0, :1] = 1
    for n in range(1, count):
        basis[n] = roots * basis[n - 1]
        basis[n, 1:] += basis[n - 1, :-1]
    return basis


# Spatial roots --------------------------------------------------------------------------------------------------------


def _split(
    family: _Family, powers: Sequence[Sequence[ComplexArray]], towards: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """The spatial roots: those that decay, or leave the circle inwards, (N, decaying), and the others."""
    few = family.decaying
    coefficients = np.stack([terms.at(powers, len(towards)) for terms in family.powers], axis=1)
    roots = all_roots(coefficients)
    if few in (0, roots.shape[1]):
        return roots[:, :few], roots[:, few:]
    with np.errstate(all="ignore"):
        key = np.log(np.maximum(np.abs(roots), 1e-300))
        ascending = np.sort(key, axis=1)
        close = np.flatnonzero(~((ascending[:, few - 1] < -CLEAR) & (ascending[:, few] > CLEAR)))
        if len(close):
            some = [[each[close] for each in table] for table in powers]
            key[close] = _told(family, some, towards[close], coefficients[close], roots[close], key[close])
    ordered = np.take_along_axis(roots, np.argsort(key, axis=1), axis=1)
    return ordered[:, :few], ordered[:, few:]


def _told(
    family: _Family, powers: Sequence[Sequence[ComplexArray]], towards: ComplexArray, coefficients: ComplexArray,
    roots: ComplexArray, key: Array,
) -> Array:  # fmt: skip
    """log(abs(kappa)); where that is zero to rounding, a number as small with the sign of the direction it takes."""
    steps = np.stack([_derivative(terms).at(powers, len(towards)) for terms in family.powers], axis=1)
    along = horner(steps, roots) * towards[:, None]
    across = horner(coefficients[:, 1:] * np.arange(1, coefficients.shape[1]), roots) * roots
    size = horner(np.abs(coefficients), np.abs(roots))
    blur = ROUNDINGS * 2.0**-52 * np.abs(size / across)
    return np.where(np.abs(key) < blur, np.sign((-along / across).real) * blur, key)


def _derivative(terms: _Terms) -> _Terms:
    """By the resolvent variable, the first."""
    powers = terms.exponents[:, 0]
    lowered = terms.exponents.copy()
    lowered[:, 0] = np.maximum(powers - 1, 0)
    return _Terms(terms.weights * powers, lowered)


def horner(coefficients: NDArray[Any], x: NDArray[Any]) -> NDArray[Any]:
    """Polynomials (N, n + 1) at their own points (N, k)."""
    value = np.zeros_like(x)
    for k in reversed(range(coefficients.shape[1])):
        value = value * x + coefficients[:, k : k + 1]
    return value


def polynomial_at(row: Sequence[Fraction], x: NDArray[Any]) -> ComplexArray:
    """A polynomial with rational coefficients, ascending, at points of any shape."""
    total = np.zeros(x.shape, complex)
    for c in reversed(row):
        total = total * x + float(c)
    return total
