"""The Kreiss determinant over many small discs of w at once, enclosed.

Over a disc B the decaying roots of each family are enclosed by inclusion discs: which ones they are is known at a node
in B with abs(w) < 1, where they are the roots with abs(x) < 1, and no root changes from one component of the inclusion
discs to another while w moves in B. From the roots follows the Kreiss matrix M(w) in the Newton basis. With R, an
approximate inverse of M at the node, R M(w) = I + E(w), and rho_i the row sums of abs(E) over B,

    abs(det(R M(w)) - 1) <= prod_i (1 + rho_i) - 1        (expand in principal minors),
                         <= exp(abs(tr E) - log(1 - f) - f) - 1,        f = norm(E, Frobenius) < 1

(log det(I + E) = tr E - tr E**2/2 + ..., and abs(tr E**k) <= f**k from k = 2 on). If one of them is below 1, Delta has
no zero in B (where abs(w) <= 1) and stays within a right angle of its value at the node.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gks.modes.chart import Chart
from gks.modes.discs import PRODUCT, UNIT, UP, Array, ComplexArray, Discs, Jets, Ring, joined
from gks.modes.rootdiscs import Mask, RootDiscs, RootGroup, approximate, root_discs, root_groups
from gks.modes.rootdiscs import branches as branches_of
from gks.modes.symboldiscs import homogeneous, led, symbol_over, turned_back, turned_from, turned_to
from gks.modes.tables import DiscRows, DiscTables

Index = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Start:
    """Where root finding starts at the points of a batch: roots mu of the integrator, spatial roots of each family."""

    stages: ComplexArray
    """(N, branches), without columns where the chart needs none."""
    spatial: tuple[ComplexArray, ...]
    """(N, branches, n) of every family, the decaying roots first; in y where its symbol is turned."""

    def take(self, index: Index) -> Start:
        """The points at the places given."""
        return Start(self.stages[index], tuple(x[index] for x in self.spatial))

    @staticmethod
    def join(parts: Sequence[Start]) -> Start:
        """Several batches as one."""
        spatial = (np.concatenate(each) for each in zip(*(p.spatial for p in parts), strict=True))
        return Start(np.concatenate([p.stages for p in parts]), tuple(spatial))


@dataclass(frozen=True, slots=True)
class Patch:
    """Delta over N discs. phase : its phase at the nodes; log : (N, branches), of each branch's modulus.

    change : (N,), at least abs(Delta(w)/Delta(node) - 1), infinite where nothing is proved. relative : abs(Delta) at
    the node over the product of its rows' lengths (1 for orthogonal rows), the least of the branches.
    """

    phase: Array
    log: Array
    change: Array
    relative: Array
    start: Start

    def take(self, index: Index) -> Patch:
        """The points at the places given."""
        phase, log, change, relative = (each[index] for each in (self.phase, self.log, self.change, self.relative))
        return Patch(phase, log, change, relative, self.start.take(index))

    @staticmethod
    def join(parts: Sequence[Patch]) -> Patch:
        """Several batches as one."""
        phase, log, change, relative = (
            np.concatenate([getattr(p, name) for p in parts]) for name in ("phase", "log", "change", "relative")
        )
        return Patch(phase, log, change, relative, Start.join([p.start for p in parts]))


def _scattered(discs: Discs) -> ComplexArray:
    count = discs.mid.shape[-1]
    return np.asarray(discs.mid + discs.rad / 2 * np.exp(2j * np.pi * (np.arange(count) + 0.3) / max(count, 1)))


@dataclass(frozen=True, slots=True)
class RegionRoots:
    """All spatial roots of a family over a disc of w, in discs (branches, n), the ``decaying`` first."""

    discs: Discs
    decaying: int


@dataclass(frozen=True, slots=True)
class Region:
    """Which roots continue the decaying ones throughout a disc of w that may reach across the unit circle.

    ``stages`` encloses the branches of the chart (branches,) over that disc.
    """

    stages: Discs
    roots: tuple[RegionRoots, ...]

    def start(self, points: int) -> Start:
        """The region's own roots as the start at all points, those that share a disc in different places of it."""
        spatial = (np.broadcast_to(_scattered(r.discs), (points, *r.discs.mid.shape)) for r in self.roots)
        return Start(np.tile(self.stages.mid, (points, 1)), tuple(spatial))

    def holds_stages(self, stages: ComplexArray) -> Mask:
        """Whether each point's branches are those of the region, in its order: (branches * N,)."""
        near = (np.abs(stages - self.stages.mid) < self.stages.rad).all(axis=1)
        return np.tile(near, max(stages.shape[1], 1))

    def continues(
        self, family: int, decaying: Sequence[tuple[complex, float]], others: Sequence[tuple[complex, float]]
    ) -> bool:
        """Whether roots in given discs are, on one branch, those of the region's decaying and other discs."""
        mine = self.roots[family]

        def within(root: tuple[complex, float], discs: Discs) -> bool:
            return bool((np.abs(discs.mid - root[0]) * UP + root[1] < discs.rad * (2 - UP)).any())

        for branch in range(len(mine.discs.mid)):
            inner, outer = mine.discs[branch, : mine.decaying], mine.discs[branch, mine.decaying :]
            if all(within(x, inner) for x in decaying) and all(within(x, outer) for x in others):
                return True
        return False

    def chosen(self, family: int, found: RootDiscs) -> tuple[Mask, Mask]:
        """Which roots lie in the discs of the decaying ones (branches * N, n), and whether all are told for certain."""
        mine = self.roots[family]
        branches = len(mine.discs.mid)
        each = (branches, len(found.centre) // branches, found.centre.shape[1])
        gap = np.abs(found.centre.reshape(each)[:, :, :, None] - mine.discs.mid[:, None, None, :])
        within = gap + found.cover.reshape(each)[:, :, :, None] <= mine.discs.rad[:, None, None, :] * (2 - UP)
        decaying = within[..., : mine.decaying].any(axis=-1)
        other = within[..., mine.decaying :].any(axis=-1)
        shape = found.centre.shape
        return np.asarray(decaying).reshape(shape), _all(np.asarray(decaying ^ other).reshape(shape))


@np.errstate(all="ignore")  # infinite discs give nan, and a nan proves nothing
def patch(
    tables: DiscTables,
    chart: Chart,
    disc: Discs,
    node: ComplexArray,
    start: Start | None = None,
    region: Region | None = None,
) -> Patch:
    """Delta over discs of w (N,), each with a node in it; abs(node) < 1, or the discs lie in that of the region."""
    points, branches = len(node), chart.branches
    if start is None and region is not None:
        start = region.start(points)
    stages = chart.stages(node, None if start is None else start.stages)
    over = chart.images(Jets(disc, Discs.exact(np.ones(points, complex))), stages)
    at = chart.images(Jets.exact(node), stages)
    valid = np.ones(points * branches, bool) if region is None else region.holds_stages(stages)
    spatial: list[ComplexArray] = []
    roots: list[Jets] = []
    nodes: list[Discs] = []
    for k, symbol in enumerate(tables.symbols):
        plain = led(symbol, over) if region is None else np.zeros(points * branches, bool)
        exact = symbol_over(symbol, (at[0].value, at[1].value), plain)
        hint = None if start is None else turned_to(symbol, _by_branch(start.spatial[k]), plain)
        near = root_discs(exact, approximate(exact.mid, hint))
        inside, certain = inside_circle(near) if region is None else region.chosen(k, near)
        valid &= certain & (inside.sum(axis=1) == symbol.decaying)
        order = np.lexsort((np.abs(near.centre), ~inside), axis=1)
        ordered = Discs(near.centre, near.cover)[np.arange(len(order))[:, None], order]
        nodes.append(turned_back(symbol, ordered[:, : symbol.decaying], plain))
        spatial.append(turned_from(symbol, ordered.mid, plain))
        coefficients = symbol_over(symbol, over, plain)
        found = branches_of(coefficients, root_discs(coefficients.value, ordered.mid))
        roots.append(turned_back(symbol, found[:, : symbol.decaying], plain))
    reach = np.tile((np.abs(disc.mid - node) * UP + disc.rad) * UP, branches)
    here = closure_over(tables, nodes, (at[0].value, at[1].value))
    phase, log, relative, change = determinant(here, closure_over(tables, roots, over), reach)
    shape = (branches, points)
    factors = 1 + np.where(valid, change, np.inf).reshape(shape)
    total = factors.prod(axis=0) * (1 + PRODUCT * branches) - 1
    begin = Start(stages, tuple(x.reshape(branches, points, x.shape[1]).transpose(1, 0, 2) for x in spatial))
    return Patch(
        phase.reshape(shape).sum(axis=0), log.reshape(shape).T, total,
        relative.reshape(shape).min(axis=0), begin,
    )  # fmt: skip


@np.errstate(all="ignore")
def region_of(tables: DiscTables, chart: Chart, disc: Discs, node: complex) -> Region | None:
    """The roots that continue the decaying ones over a disc of w, given a node in it with abs(node) < 1.

    None where they are not proved to keep apart from the others all over the disc.
    """
    at_node = np.array([node])
    stages = chart.stages(at_node)
    over = chart.images(Jets(disc, Discs.exact(np.ones(1, complex))), stages)
    at = chart.images(Jets.exact(at_node), stages)
    covers = chart.covers(disc, stages)
    if covers is None:
        return None
    chosen = []
    middle = chart.images(Jets.exact(disc.mid), stages)
    turned = np.zeros(chart.branches, bool)
    for symbol in tables.symbols:
        exact = symbol_over(symbol, (at[0].value, at[1].value), turned)
        inside, certain = inside_circle(near := root_discs(exact, approximate(exact.mid)))
        if not certain.all() or (inside.sum(axis=1) != symbol.decaying).any():
            return None
        spread = symbol_over(symbol, (over[0].value, over[1].value), turned)
        centre = symbol_over(symbol, (middle[0].value, middle[1].value), turned)
        apart = [_apart(centre[k : k + 1], spread[k : k + 1], near, inside, k) for k in range(chart.branches)]
        if any(each is None for each in apart):
            return None
        discs = joined([each for each in apart if each is not None], lambda parts: np.stack(parts))
        # Where a decaying root passes x = oo Delta has a pole, which a winding number would count against its zeros.
        if symbol.turn and not (discs.upper()[:, : symbol.decaying] < (2 - UP) / abs(symbol.turn)).all():
            return None
        chosen.append(RegionRoots(discs, symbol.decaying))
    return Region(covers, tuple(chosen))


def _apart(centre: Discs, spread: Discs, near: RootDiscs, inside: Mask, branch: int) -> Discs | None:
    """Discs (n,) round the roots over a disc of w, the decaying first; None where some of these may meet others."""
    found = root_discs(spread, near.centre[branch : branch + 1])
    mixed = found.joined[0] & (inside[branch][:, None] != inside[branch][None, :])
    if not mixed.any():
        return Discs(found.centre[0], found.cover[0])[np.argsort(~inside[branch], kind="stable")]
    groups = root_groups(centre, spread, near.centre.shape[1])
    decaying, others = list[RootGroup](), list[RootGroup]()
    for group in groups or ():
        mine = group.holds(near.centre[branch], near.cover[branch])
        if mine.sum() != group.count or len(set(inside[branch][mine])) != 1:
            return None
        (decaying if inside[branch][mine][0] else others).append(group)
    every = [group for group in (*decaying, *others) for _ in range(group.count)]
    if not every:
        return None
    return Discs(np.array([group.centre for group in every]), np.array([group.radius for group in every]))


def _by_branch(x: ComplexArray) -> ComplexArray:
    """(N, branches, n) as (branches * N, n)."""
    return x.transpose(1, 0, 2).reshape(x.shape[0] * x.shape[1], x.shape[2])


def inside_circle(found: RootDiscs) -> tuple[Mask, Mask]:
    """Which roots are inside the unit circle (N, n), and whether that is proved for all of them (N,)."""
    size = np.abs(found.centre)
    with np.errstate(invalid="ignore"):
        inside = size * UP + found.cover < 1
        outside = size * (2 - UP) - found.cover > 1
    return inside, _all(inside | outside)


def _all(conditions: Mask) -> Mask:
    """Whether all conditions of each row hold."""
    return np.asarray(np.all(conditions, axis=1))


def closure_over(tables: DiscTables, roots: Sequence[Ring], pair: tuple[Ring, Ring]) -> Ring:
    """The Kreiss matrix (N, m, m) in the Newton basis; ``roots`` of every family (N, decaying)."""
    order = np.argsort(np.concatenate([rows.numbers for rows in tables.rows]))
    every = joined([_weights(rows, pair) for rows in tables.rows], lambda parts: np.concatenate(parts, 1)[:, order])
    blocks, first = [], 0
    for (family, zeros), count in zip(tables.blocks, tables.longest, strict=True):
        columns = newton_basis(_after_zeros(roots[family], zeros), count)
        blocks.append(every[:, :, first : first + count] @ joined(columns, lambda parts: np.stack(parts, 1)))
        first += count
    return joined(blocks, lambda parts: np.concatenate(parts, 2))


def _weights(rows: DiscRows, pair: tuple[Ring, Ring]) -> Ring:
    """The closure's coefficients at every point: (N, rows, columns)."""
    degree, *shape = rows.weights.mid.shape
    flat = homogeneous(pair, degree - 1).times(rows.weights.apply(lambda x: x.reshape(degree, -1)))
    return flat.apply(lambda x: x.reshape(len(x), *shape))


def _after_zeros(x: Ring, count: int) -> Ring:
    """x (N, d) with so many columns of zeros before it."""
    return x.apply(lambda each: np.concatenate([np.zeros((len(each), count), each.dtype), each], axis=1))


def newton_basis(roots: Ring, count: int) -> list[Ring]:
    """For n < count the divided differences [x_1, ..., x_j] x**n, j = 1, ..., d: each (N, d).

    By c_j[n] = c_{j-1}[n-1] + x_j c_j[n-1], as in `gks.modes.kreiss.newton_columns`.
    """
    first = (roots.mid if isinstance(roots, Discs) else roots.value.mid) * 0
    first[:, :1] = 1
    rows: list[Ring] = [type(roots).exact(first)]
    while len(rows) < count:
        shifted = _after_zeros(rows[-1][:, :-1], 1)
        rows.append(shifted + roots * rows[-1])
    return rows[:count]


def determinant(node: Discs, over: Jets, reach: Array) -> tuple[Array, Array, Array, Array]:
    """Phase, logarithm and relative size of det at the nodes, and the bound of its relative change over the discs.

    The change of R M over a disc is bounded by its slope where that is finite, else by the values.
    """
    size = node.mid.shape[1]
    rows = _powers_of_two(node.upper().max(axis=2, initial=0.0))[:, :, None]
    matrix = node.mid * rows
    columns = _powers_of_two(np.abs(matrix).max(axis=1, initial=0.0))[:, None, :]
    matrix = matrix * columns
    finite = np.asarray(np.all(np.isfinite(matrix), axis=(1, 2)))
    matrix = np.where(finite[:, None, None], matrix, 0)
    sign, log = np.linalg.slogdet(matrix)
    finite &= sign != 0
    inverse = np.asarray(np.linalg.inv(np.where(finite[:, None, None], matrix, np.eye(size))), complex)
    weight = np.abs(inverse)
    with np.errstate(all="ignore"):  # infinite discs give nan, which proves nothing
        scale = rows * columns
        near = _spread(inverse, weight, Discs(matrix, node.rad * scale), np.eye(size))
        slope = _spread(inverse, weight, over.slope.apply(lambda x: x * scale), 0)
        plain = _spread(inverse, weight, over.value.apply(lambda x: x * scale), np.eye(size))
        first = (near[0] + slope[0] * reach[:, None, None], near[1] + slope[1] * reach)
        change = np.fmin(_change(*first), _change(*plain))
        lengths = np.sqrt((np.abs(matrix) ** 2).sum(axis=2)).prod(axis=1)
        relative = np.where(finite, np.exp(log) / lengths, 0.0)
    change = np.where(finite & np.isfinite(change), change, np.inf)
    scales = np.log(rows[:, :, 0]).sum(axis=1) + np.log(columns[:, 0, :]).sum(axis=1)
    return np.where(finite, np.angle(sign), 0.0), np.where(finite, log - scales, -np.inf), relative, change


def _spread(inverse: ComplexArray, weight: Array, matrix: Discs, less: Array | int) -> tuple[Array, Array]:
    """Bounds of the entries (N, m, m) of abs(R M - less), and of the modulus of its trace, for M in the discs."""
    size = inverse.shape[1]
    # A product of two m x m matrices, summed in any order, is off by at most (m + 4) u abs(R) abs(M), and by 2 sqrt(2)
    # times as much for complex entries.
    rounding = (size + 4) * 4 * UNIT * (weight @ np.abs(matrix.mid))
    middle = inverse @ matrix.mid - less
    radius = rounding + weight @ matrix.rad * (1 + (size + 4) * PRODUCT)
    trace = np.abs(np.trace(middle, axis1=1, axis2=2)) + np.trace(radius, axis1=1, axis2=2)
    # The sum of m diagonal entries is off by at most m u of the sum of their moduli.
    trace = trace + size * PRODUCT * np.trace(np.abs(middle), axis1=1, axis2=2)
    return (np.abs(middle) + radius) * UP, np.asarray(trace * (1 + size * PRODUCT))


def _change(entries: Array, trace: Array) -> Array:
    """The bound of abs(det(I + E) - 1) from bounds of the entries and the trace of E; infinite where there is none."""
    size = entries.shape[1]
    up = 1 + size * size * PRODUCT
    minors = np.prod(1 + entries.sum(axis=2) * up, axis=1) * up - 1
    norm = np.sqrt((entries**2).sum(axis=(1, 2))) * up
    series = np.where(norm < 1, np.expm1((trace - np.log1p(-norm) - norm + 8 * UNIT * norm) * up), np.inf)
    return np.asarray(np.fmin(minors, series))


def _powers_of_two(size: Array) -> Array:
    """Close to 1/size; 1 where that is not to be had."""
    usable = np.isfinite(size) & (size > 0)
    _, exponent = np.frexp(np.where(usable, size, 1.0))
    return np.ldexp(1.0, -exponent)
