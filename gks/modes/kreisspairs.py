"""The Kreiss determinant round a glancing point: where a decaying spatial root meets one that does not.

Near a point w_0 where they meet, the two roots of the pair are m(w) +- delta(w), with delta**2 analytic and with a
simple zero at w_0: they are the values at t and at -t of one analytic function of t = sqrt(w - w_0). Where the pairs of
several families meet at the same w_0 the determinant over the decaying roots is a function F(t), over the others of all
pairs it is F(-t), and

    G(w) = F(t) F(-t)

is analytic round w_0. It has as many zeros w as F has zeros t, with multiplicity. So a walk round w_0 that takes both
determinants at once needs no branch cut. Which root of one pair goes with which of another is told by delta_k/delta_1,
which is analytic and has no zero: where its real part, relative to its value at a point where the decaying roots are
known, keeps its sign all along the walk, it does so inside as well (the minimum principle).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gks.modes.chart import Chart
from gks.modes.discs import PRODUCT, UP, Array, ComplexArray, Discs, Jets
from gks.modes.kreissdiscs import (
    Index,
    Patch,
    Start,
    closure_over,
    determinant,
    inside_circle,
)
from gks.modes.rootdiscs import Mask, RootDiscs, RootGroup, approximate, root_discs, root_groups
from gks.modes.rootdiscs import branches as branches_of
from gks.modes.symboldiscs import led, symbol_over, turned_back
from gks.modes.tables import DiscTables


@dataclass(frozen=True, slots=True)
class Neighbourhood:
    """A family's roots over a disc of w: discs (n,) around them, the decaying ones first, then those of the pair.

    ``alone`` is the number of decaying roots that meet no other; ``apart`` is decaying less not decaying of the pair at
    the node, None where the family has no pair. All in x where ``plain``, else in y.
    """

    discs: Discs
    alone: int
    apart: complex | None
    plain: bool

    @property
    def pair(self) -> int:
        """Number of roots in the pair."""
        return 0 if self.apart is None else 2

    def order(self, found: RootDiscs) -> tuple[Index, Mask]:
        """The order of roots (N, n) that puts them as ``discs`` has them, and whether each is told for certain (N,)."""
        gap = np.abs(found.centre[:, :, None] - self.discs.mid[None, None, :])
        within = gap + found.cover[:, :, None] <= self.discs.rad * (2 - UP)
        kinds = np.repeat([0, 1, 2], [self.alone, self.pair, len(self.discs.mid) - self.alone - self.pair])
        member = np.stack([within[:, :, kinds == kind].any(axis=2) for kind in range(3)], axis=2)
        kind = member.argmax(axis=2)
        told = (member.sum(axis=2) == 1).all(axis=1)
        told &= (np.sort(kind, axis=1) == kinds).all(axis=1)
        return np.lexsort((np.abs(found.centre), kind), axis=1), np.asarray(told)


@dataclass(frozen=True, slots=True)
class PairedRegion:
    """The roots of all families over a disc of w, in which at least one family has a pair."""

    families: tuple[Neighbourhood, ...]

    @property
    def paired(self) -> list[int]:
        """The families with a pair."""
        return [k for k, family in enumerate(self.families) if family.apart is not None]


@np.errstate(all="ignore")  # infinite discs give nan, and a nan proves nothing
def paired_region(tables: DiscTables, chart: Chart, disc: Discs, node: complex) -> PairedRegion | None:
    """The roots over a disc of w, given a node in it with abs(node) < 1.

    None where more than two roots meet, or none that decays with one that does not.
    """
    if chart.branches > 1:
        return None
    stages = chart.stages(np.array([node]))
    over, centre, at = (
        chart.images(Jets(each, Discs.exact(np.ones(1, complex))), stages)
        for each in (disc, Discs.exact(disc.mid), Discs.exact(np.array([node])))
    )
    families = []
    for symbol in tables.symbols:
        plain = led(symbol, over)
        exact = symbol_over(symbol, (at[0].value, at[1].value), plain)
        near = root_discs(exact, approximate(exact.mid))
        inside, certain = inside_circle(near)
        if not certain.all() or inside.sum() != symbol.decaying:
            return None
        middle = symbol_over(symbol, (centre[0].value, centre[1].value), plain)
        spread = symbol_over(symbol, (over[0].value, over[1].value), plain)
        groups = root_groups(middle, spread, 2)
        family = None if groups is None else _neighbourhood(groups, near, inside[0], plain=bool(plain.all()))
        # Where a root passes x = oo Delta has a pole, which a winding number would count against its zeros.
        if family is None or (symbol.turn and not family.plain and not _bounded(family, abs(symbol.turn))):
            return None
        families.append(family)
    region = PairedRegion(tuple(families))
    return region if region.paired else None


def _bounded(family: Neighbourhood, turn: float) -> bool:
    """Whether no root that counts reaches y = -1/conj(turn), which is x = oo."""
    used = family.discs[: family.alone + family.pair].upper()
    return bool((used < (2 - UP) / turn).all())


def _neighbourhood(groups: Sequence[RootGroup], near: RootDiscs, inside: Mask, *, plain: bool) -> Neighbourhood | None:
    """The groups by what their roots do at a node; None where two meet of which both decay, or neither does."""
    kinds, apart = [], None
    for group in groups:
        mine, count = group.holds(near.centre[0], near.cover[0]), group.count
        if mine.sum() != count:
            return None
        if count == 1:
            kinds.append(0 if inside[mine][0] else 2)
        elif inside[mine].sum() != 1 or apart is not None:
            return None
        else:
            kinds.append(1)
            apart = complex(near.centre[0][mine & inside][0] - near.centre[0][mine & ~inside][0])
    # A pair's disc stands twice, once for each root.
    order = [k for kind in range(3) for k in range(len(groups)) if kinds[k] == kind for _ in range(groups[k].count)]
    discs = Discs(np.array([groups[k].centre for k in order]), np.array([groups[k].radius for k in order]))
    return Neighbourhood(discs, kinds.count(0), apart, plain)


@np.errstate(all="ignore")
def paired_patch(
    tables: DiscTables, chart: Chart, disc: Discs, node: ComplexArray, start: Start | None, region: PairedRegion
) -> Patch:
    """G over discs of w (N,) that lie in that of the region and keep clear of where the pairs meet; see ``patch``."""
    points = len(node)
    stages = chart.stages(node)
    over = chart.images(Jets(disc, Discs.exact(np.ones(points, complex))), stages)
    at = chart.images(Jets.exact(node), stages)
    valid = np.ones(points, bool)
    rows = np.arange(points)[:, None]
    spatial, nodes, roots = [], [], []
    first: Discs | None = None
    for k, (symbol, family) in enumerate(zip(tables.symbols, region.families, strict=True)):
        plain = np.full(points, family.plain)
        exact = symbol_over(symbol, (at[0].value, at[1].value), plain)
        near = root_discs(exact, approximate(exact.mid, None if start is None else start.spatial[k][:, 0]))
        order, told = family.order(near)
        valid &= told
        here = Discs(near.centre, near.cover)[rows, order]
        coefficients = symbol_over(symbol, over, plain)
        found = branches_of(coefficients, root_discs(coefficients.value, here.mid))
        if family.apart is not None:
            apart = found.value[:, family.alone] - found.value[:, family.alone + 1]
            if first is None:
                first = apart.scaled(Discs.exact(np.asarray(1 / family.apart)))
            ratio = apart * first.reciprocal() * Discs.exact(np.full(points, 1 / family.apart))
            valid &= np.abs(ratio.mid.real) > ratio.rad * UP + 2 * PRODUCT * np.abs(ratio.mid)
            turned = np.where(
                ratio.mid.real[:, None] < 0, _swapped(family, here.mid.shape[1]), np.arange(order.shape[1])
            )
            here, found = here[rows, turned], found[rows, turned]
        spatial.append(here.mid)
        nodes.append(here)
        roots.append(found)
    reach = (np.abs(disc.mid - node) * UP + disc.rad) * UP
    sides = [_side(tables, region, over, at, nodes, roots, reach, swap=swap) for swap in (False, True)]
    phases, logs, relatives, changes = (np.stack(each) for each in zip(*sides, strict=True))
    total = (1 + np.where(valid, changes, np.inf)).prod(axis=0) * (1 + 2 * PRODUCT) - 1
    begin_next = Start(stages, tuple(x[:, None, :] for x in spatial))
    return Patch(phases.sum(axis=0), logs.T, total, relatives.min(axis=0), begin_next)


def _swapped(family: Neighbourhood, count: int) -> Index:
    """The order of a family's roots with those of its pair exchanged."""
    order = np.arange(count)
    if family.apart is not None:
        order[[family.alone, family.alone + 1]] = family.alone + 1, family.alone
    return order


def _side(
    tables: DiscTables, region: PairedRegion, over: tuple[Jets, Jets], at: tuple[Jets, Jets], nodes: Sequence[Discs],
    roots: Sequence[Jets], reach: Array, *, swap: bool,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """The determinant over the first root of each pair, or over the second."""
    here, there = [], []
    for symbol, family, x, branch in zip(tables.symbols, region.families, nodes, roots, strict=True):
        chosen = _swapped(family, x.mid.shape[1])[: symbol.decaying] if swap else np.arange(symbol.decaying)
        plain = np.full(len(reach), family.plain)
        here.append(turned_back(symbol, x[:, chosen], plain))
        there.append(turned_back(symbol, branch[:, chosen], plain))
    matrix = closure_over(tables, here, (at[0].value, at[1].value))
    return determinant(matrix, closure_over(tables, there, over), reach)
