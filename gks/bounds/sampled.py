"""Delta at many points at once, in double precision: what tracing, maps and fast sweeps are computed with.

Nothing here is proved. The decaying solutions on abs(z) = 1 are told by the direction in which log(abs(kappa)) moves as
abs(z) grows, to first order, so points at which spatial roots meet on the circle are as good as a limit there.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from flint import fmpz_mpoly
from numpy.typing import NDArray

from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem, longest

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

ROUNDINGS = 16
"""A computed root is off by some roundings of the terms of its polynomial over the slope there: 16 of them for degrees
up to 8, of which a few are seen."""


@dataclass(frozen=True, slots=True)
class _Terms:
    """A polynomial: coefficients (T,) and exponents (T, variables), scaled to a largest coefficient of 1."""

    weights: Array
    exponents: NDArray[np.intp]

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


@dataclass(frozen=True, slots=True)
class Sampled:
    """A problem ready to be evaluated at its resolvent variable, its symbols, and what is irrational in it."""

    families: tuple[_Family, ...]
    blocks: tuple[tuple[int, int, int], ...]
    """(family, zeros, longest) of every block."""
    rows: tuple[tuple[tuple[int, int, _Terms], ...], ...]
    irrational: tuple[complex | _Terms, ...]
    highest: tuple[int, ...]

    def at(self, sigma: ComplexArray, *symbols: Array) -> Values:
        """Delta at points sigma with values of the symbols, all of shape (N,)."""
        points = len(sigma)
        powers: list[list[ComplexArray]] = []
        for value in (sigma, *symbols):
            powers.append(_powers(np.asarray(value, complex), self.highest[len(powers)]))
        for each in self.irrational:
            known = each if isinstance(each, complex) else np.sqrt(each.at(powers, points))
            powers.append(_powers(np.zeros(points, complex) + known, self.highest[len(powers)]))
        split = [_split(family, powers, sigma) for family in self.families]
        decaying = tuple(mine for mine, _ in split)
        return Values(self._determinant(decaying, powers, points), decaying, tuple(others for _, others in split))

    def _determinant(
        self, roots: Sequence[ComplexArray], powers: Sequence[Sequence[ComplexArray]], points: int
    ) -> ComplexArray:
        # Points run along the last axis: the others are a few numbers long.
        columns = []
        for family, zeros, count in self.blocks:
            mine = np.concatenate([np.zeros((zeros, points), complex), roots[family].T])
            columns.append(_newton(mine, count))
        first = np.cumsum([0, *(c.shape[1] for c in columns)])
        matrix = np.zeros((len(self.rows), int(first[-1]), points), complex)
        size = np.zeros((len(self.rows), points))
        for i, row in enumerate(self.rows):
            for block, n, terms in row:
                share = terms.at(powers, points) * columns[block][n]
                matrix[i, first[block] : first[block + 1]] += share
                size[i] += np.abs(share).sum(axis=0)
        matrix /= np.where(size > 0, size, 1)[:, None]
        return np.asarray(np.linalg.det(np.ascontiguousarray(matrix.transpose(2, 0, 1))), complex)


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
    return Sampled(families, blocks, tuple(rows), tuple(irrational), tuple(int(h) for h in highest))


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
    family: _Family, powers: Sequence[Sequence[ComplexArray]], sigma: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """The spatial roots: those that decay, or leave the circle inwards, (N, decaying), and the others."""
    points, few = len(sigma), family.decaying
    coefficients = np.stack([terms.at(powers, points) for terms in family.powers], axis=1)
    roots = all_roots(coefficients)
    if few in (0, roots.shape[1]):
        return roots[:, :few], roots[:, few:]
    steps = np.stack([_derivative(terms).at(powers, points) for terms in family.powers], axis=1)
    with np.errstate(all="ignore"):
        along = np.stack([_horner(steps, x) for x in roots.T], axis=1) * sigma[:, None]
        across = np.stack([_horner_slope(coefficients, x) for x in roots.T], axis=1) * roots
        size = np.stack([_horner(np.abs(coefficients).astype(complex), np.abs(x)) for x in roots.T], axis=1)
        blur = ROUNDINGS * 2.0**-52 * np.abs(size / across)
        key = np.log(np.maximum(np.abs(roots), 1e-300))
        # On the circle to rounding: by the direction in which it leaves.
        key = np.where(np.abs(key) < blur, np.sign((-along / across).real) * blur, key)
    ordered = np.take_along_axis(roots, np.argsort(key, axis=1), axis=1)
    return ordered[:, :few], ordered[:, few:]


def _derivative(terms: _Terms) -> _Terms:
    """By the resolvent variable, the first."""
    powers = terms.exponents[:, 0]
    lowered = terms.exponents.copy()
    lowered[:, 0] = np.maximum(powers - 1, 0)
    return _Terms(terms.weights * powers, lowered)


def _horner(coefficients: ComplexArray, x: ComplexArray) -> ComplexArray:
    value = np.zeros_like(x)
    for c in coefficients.T[::-1]:
        value = value * x + c
    return value


def _horner_slope(coefficients: ComplexArray, x: ComplexArray) -> ComplexArray:
    return _horner(coefficients[:, 1:] * np.arange(1, coefficients.shape[1]), x)


def all_roots(coefficients: ComplexArray) -> ComplexArray:
    """The roots of polynomials (N, n + 1), ascending coefficients: (N, n), infinite where the leading one vanishes."""
    degree = coefficients.shape[1] - 1
    with np.errstate(all="ignore"):
        if degree < 1:
            return np.empty((len(coefficients), 0), complex)
        if degree == 1:
            return np.asarray(-coefficients[:, :1] / coefficients[:, 1:])
        if degree == 2:
            return _quadratic(coefficients)
        if degree == 3:
            return _cubic(coefficients)
        # The companion matrix of whichever end has the larger coefficient: the other may vanish.
        swap = np.abs(coefficients[:, -1]) < np.abs(coefficients[:, 0])
        ordered = np.where(swap[:, None], coefficients[:, ::-1], coefficients)
        companion = np.zeros((len(ordered), degree, degree), complex)
        companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1
        companion[:, :, -1] = -ordered[:, :-1] / ordered[:, -1:]
        finite = np.asarray(np.isfinite(companion).all(axis=(1, 2)))
        roots = np.linalg.eigvals(np.where(finite[:, None, None], companion, 0))
        return np.where(finite[:, None], np.where(swap[:, None], 1 / roots, roots), np.nan)


def _quadratic(coefficients: ComplexArray) -> ComplexArray:
    c, b, a = coefficients.T
    root = np.sqrt(b * b - 4 * a * c)
    half = -(b + np.where((b.conj() * root).real < 0, -root, root)) / 2
    return np.stack([half / a, np.where(half == 0, -half, c / half)], axis=1)


_THIRD_TURN = np.exp(2j * np.pi / 3 * np.arange(3))


def _cubic(coefficients: ComplexArray) -> ComplexArray:
    """Cardano's formula for the depressed cubic, then two Newton steps for what cancels in it: ten times as fast as
    companion matrices of so small a size.
    """
    swap = np.abs(coefficients[:, -1]) < np.abs(coefficients[:, 0])
    d, c, b, a = np.where(swap[:, None], coefficients[:, ::-1], coefficients).T
    shift = b / (3 * a)
    p = c / a - 3 * shift * shift
    q = 2 * shift**3 - shift * c / a + d / a
    root = np.sqrt(q * q / 4 + (p / 3) ** 3)
    cube = -q / 2 + np.where((q.conj() * root).real > 0, -root, root)
    one = cube ** (1 / 3)
    all_three = one[:, None] * _THIRD_TURN
    x = all_three - np.where(all_three == 0, 0, p[:, None] / (3 * all_three)) - shift[:, None]
    for _ in range(2):
        value = ((a[:, None] * x + b[:, None]) * x + c[:, None]) * x + d[:, None]
        slope = (3 * a[:, None] * x + 2 * b[:, None]) * x + c[:, None]
        step = value / slope
        # Next to a double root a Newton step is all rounding.
        x = np.where(np.abs(step) < 2.0**-10 * np.abs(x), x - step, x)
    return np.asarray(np.where(swap[:, None], 1 / x, x))
