"""The Kreiss determinant over many small discs of w at once, enclosed.

Over a disc B the decaying roots of each family are enclosed by inclusion discs: which ones they are is known at a node
in B with abs(w) < 1, where they are the roots with abs(x) < 1, and no root changes from one component of the inclusion
discs to another while w moves in B. From the roots follows the Kreiss matrix M(w) in the Newton basis. With R, an
approximate inverse of M at the node, R M(w) = I + E(w), and rho_i the row sums of abs(E) over B,

    abs(det(R M(w)) - 1) <= prod_i (1 + rho_i) - 1        (expand in principal minors),

so if that is below 1, Delta has no zero in B (where abs(w) <= 1) and stays within a right angle of its value at the node.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gks.modes.chart import Chart
from gks.modes.discs import PRODUCT, UNIT, UP, Array, ComplexArray, Discs, linear_combination, powers
from gks.modes.rootdiscs import Mask, RootDiscs, approximate, root_discs
from gks.modes.tables import Polynomial, SymbolTable, Tables


@dataclass(frozen=True, slots=True)
class Start:
    """Where root finding starts at the points of a batch: roots mu of the integrator, and spatial roots of each family."""

    stages: ComplexArray
    spatial: tuple[ComplexArray, ...]

    def take(self, index: np.ndarray) -> Start:  # type: ignore[type-arg]
        branches = max(self.stages.shape[1], 1)
        points = len(self.stages)
        every = np.concatenate([index + k * points for k in range(branches)])
        return Start(self.stages[index], tuple(x[every] for x in self.spatial))


@dataclass(frozen=True, slots=True)
class Patch:
    """Delta over N discs. phase, log : of Delta at the nodes. change : (N,), at least abs(Delta(w)/Delta(node) - 1).

    relative : abs(Delta) at the node over the product of its rows' lengths (1 for orthogonal rows). selected : whether
    the decaying roots are told from the others. ``change`` is infinite where nothing is proved.
    """

    phase: Array
    log: Array
    change: Array
    relative: Array
    start: Start


def patch(tables: Tables, chart: Chart, disc: Discs, node: ComplexArray, start: Start | None = None) -> Patch:
    """Delta over discs of w (N,), each with a node in it that has abs(node) < 1."""
    points = len(node)
    stages = chart.stages(node, None if start is None else start.stages)
    over = _joined(chart.images(disc, stages))
    at = _joined(chart.images(Discs.exact(node), stages))
    spatial, covers = [], []
    valid = np.ones(points * chart.branches, bool)
    for k, symbol in enumerate(tables.symbols):
        exact = _symbol(symbol, at)
        centre = approximate(exact.mid, None if start is None else start.spatial[k])
        order, certain = _decaying(root_discs(exact, centre), symbol.decaying)
        centre = np.take_along_axis(centre, order, axis=1)
        cover = root_discs(_symbol(symbol, over), centre).cover[:, : symbol.decaying]
        valid &= certain
        spatial.append(centre)
        covers.append(Discs(centre[:, : symbol.decaying], cover))
    nodes = [Discs.exact(each.mid) for each in covers]
    phase, log, change, relative = _determinant(_matrix(tables, nodes, at), _matrix(tables, covers, over))
    change = np.where(valid, change, np.inf).reshape(chart.branches, points)
    with np.errstate(over="ignore"):
        total = np.prod(1 + change, axis=0) * (1 + PRODUCT * chart.branches) - 1
    return Patch(
        phase.reshape(chart.branches, points).sum(axis=0),
        log.reshape(chart.branches, points).sum(axis=0),
        total,
        relative.reshape(chart.branches, points).min(axis=0),
        Start(stages, tuple(spatial)),
    )


Pair = tuple[Discs, Discs]


def _joined(pairs: Sequence[Pair]) -> Pair:
    """All branches one after the other."""

    def join(parts: Sequence[Discs]) -> Discs:
        return Discs(np.concatenate([p.mid for p in parts]), np.concatenate([p.rad for p in parts]))

    return join([a for a, _ in pairs]), join([b for _, b in pairs])


def homogeneous(pair: Pair, degree: int) -> list[Discs]:
    """a**k b**(degree - k) for every k."""
    a, b = (powers(each, degree + 1) for each in pair)
    return [a[k] * b[degree - k] for k in range(degree + 1)]


def _evaluated(polynomial: Polynomial, basis: Sequence[Discs]) -> Discs:
    if not polynomial:
        return Discs.exact(np.zeros(basis[0].mid.shape, complex))
    return linear_combination(list(polynomial.values()), [basis[power] for power in polynomial])


def _symbol(symbol: SymbolTable, pair: Pair) -> Discs:
    """The coefficients of P in x, ascending: (N, n + 1)."""
    basis = homogeneous(pair, symbol.degree)
    values = [_evaluated(each, basis) for each in symbol.powers]
    return Discs(np.stack([v.mid for v in values], 1), np.stack([v.rad for v in values], 1))


def _decaying(found: RootDiscs, count: int) -> tuple[np.ndarray, Mask]:  # type: ignore[type-arg]
    """The order by modulus, and whether exactly ``count`` roots are proved inside and the rest outside the unit circle."""
    size = np.abs(found.centre)
    order = np.argsort(size, axis=1)
    with np.errstate(invalid="ignore"):
        inside = (size * UP + found.cover < 1).sum(axis=1)
        outside = (size * (2 - UP) - found.cover > 1).sum(axis=1)
    return order, (inside == count) & (outside == found.centre.shape[1] - count)


def _matrix(tables: Tables, roots: Sequence[Discs], pair: Pair) -> Discs:
    """The Kreiss matrix (N, m, m) in the Newton basis; ``roots`` of every family (N, decaying)."""
    points, size = len(pair[0].mid), tables.size
    mid, rad = np.zeros((points, size, size), complex), np.zeros((points, size, size))
    bases = [homogeneous(pair, row.degree) for row in tables.rows]
    place = 0
    for k, (family, zeros) in enumerate(tables.blocks):
        count = 1 + max((e.n for row in tables.rows for e in row.entries if e.block == k), default=-1)
        columns = newton_discs(roots[family], max(count - zeros, 0))
        for i, (row, basis) in enumerate(zip(tables.rows, bases, strict=True)):
            for entry in row.entries:
                if entry.block != k:
                    continue
                weight = _evaluated(entry.coefficient, basis)
                if entry.n < zeros:
                    mid[:, i, place + entry.n] += weight.mid
                    rad[:, i, place + entry.n] += weight.rad + 2 * UNIT * np.abs(mid[:, i, place + entry.n])
                    continue
                product = Discs(weight.mid[:, None], weight.rad[:, None]) * columns[entry.n - zeros]
                last = slice(place + zeros, place + zeros + product.mid.shape[1])
                mid[:, i, last] += product.mid
                rad[:, i, last] = (rad[:, i, last] + product.rad + 2 * UNIT * np.abs(mid[:, i, last])) * UP
        place += zeros + roots[family].mid.shape[1]
    return Discs(mid, rad)


def newton_discs(roots: Discs, count: int) -> list[Discs]:
    """For n < count the divided differences [x_1, ..., x_j] x**n, j = 1, ..., d: each (N, d).

    By c_j[n] = c_{j-1}[n-1] + x_j c_j[n-1], as in `gks.modes.kreiss.newton_columns`.
    """
    points, width = roots.mid.shape
    first = np.zeros((points, width), complex)
    if width:
        first[:, 0] = 1
    rows = [Discs.exact(first)]
    while len(rows) < count:
        last = rows[-1]
        shifted = Discs(np.roll(last.mid, 1, axis=1), np.roll(last.rad, 1, axis=1))
        if width:
            shifted.mid[:, 0], shifted.rad[:, 0] = 0, 0
        rows.append(shifted + roots * last)
    return rows[:count]


def _determinant(node: Discs, over: Discs) -> tuple[Array, Array, Array, Array]:
    """Phase and logarithm of det at the nodes, the bound of its relative change over the discs, and its relative size."""
    size = node.mid.shape[1]
    rows = _powers_of_two(node.upper().max(axis=2, initial=0.0))[:, :, None]
    matrix = node.mid * rows
    columns = _powers_of_two(np.abs(matrix).max(axis=1, initial=0.0))[:, None, :]
    matrix = matrix * columns
    finite = np.isfinite(matrix).all(axis=(1, 2))
    matrix = np.where(finite[:, None, None], matrix, 0)
    sign, log = np.linalg.slogdet(matrix)
    finite &= sign != 0
    inverse = np.linalg.inv(np.where(finite[:, None, None], matrix, np.eye(size)))
    with np.errstate(all="ignore"):  # infinite discs give nan, which proves nothing
        mid, rad = over.mid * rows * columns, over.rad * rows * columns
        product = inverse @ mid
        weight = np.abs(inverse)
        # A product of two m x m matrices in any order of summation: (m + 4) u per unit of abs(R) abs(M).
        rounding = (size + 4) * 4 * UNIT * (weight @ np.abs(mid))
        spread = np.abs(product - np.eye(size)) + rounding + weight @ rad * UP
        sums = spread.sum(axis=2) * (1 + size * PRODUCT)
        change = np.prod(1 + sums, axis=1) * (1 + size * PRODUCT) - 1
        lengths = np.sqrt((np.abs(matrix) ** 2).sum(axis=2)).prod(axis=1)
        relative = np.where(finite, np.exp(log) / lengths, 0.0)
    change = np.where(finite & np.isfinite(change), change, np.inf)
    scales = np.log(rows[:, :, 0]).sum(axis=1) + np.log(columns[:, 0, :]).sum(axis=1)
    return np.where(finite, np.angle(sign), 0.0), np.where(finite, log - scales, -np.inf), change, relative


def _powers_of_two(size: Array) -> Array:
    """Close to 1/size; 1 where that is not to be had."""
    usable = np.isfinite(size) & (size > 0)
    _, exponent = np.frexp(np.where(usable, size, 1.0))
    return np.ldexp(1.0, -exponent)
