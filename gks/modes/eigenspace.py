"""The space of normal modes at one point: the kernel of the closure applied to the decaying solutions, in balls.

At a fixed point the decaying solutions of a half-line are spanned by

    v_n = binom(n, j) x**(n - j),        j = 0, ..., multiplicity of x minus 1,

one ordinary power for a simple spatial root x, a polynomial times a power where roots collide, and a single ghost
value where x = 0. The Newton basis of `kreiss` spans the same space; this one says which spatial root has how much of
the mode. (It is the wrong basis for a determinant that is to be analytic, and the right one for one point.)

How many modes there are is decided exactly elsewhere; given that number, the kernel is solved for in balls, so its
entries are enclosed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import comb
from typing import Protocol

from flint import acb, ctx

from gks.modes.admissible import Admissible, Candidate, admissible, point_with_z
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root
from gks.modes.crossing import Branch, Chain, LocalMatrix, Space, space_at, systems_of, value_places, value_rows
from gks.modes.direction import group_velocities, slope_velocity
from gks.modes.fibre import at_balls
from gks.modes.kreiss import NormalModeProblem, kreiss_matrix, longest
from gks.modes.polish import Found
from gks.modes.undecided import Undecided

CHEAP_BITS = 1 << 9
"""Precision up to which pivots alone are asked whether there is just one mode."""
ABSENCE_BITS = 1 << 14
"""Bits of the bound on algebraic numbers beyond which it is left open whether an amplitude is zero: a second's work."""


class Located(Protocol):
    """A number that gives a ball at any precision, or the one it has."""

    def ball(self, bits: int = 64) -> acb: ...


@dataclass(frozen=True, slots=True)
class Enclosed:
    """A number known by one ball."""

    value: acb

    def ball(self, bits: int = 64) -> acb:
        return self.value


@dataclass(frozen=True, slots=True)
class Part:
    """The solutions of one half-line with one spatial root x (kappa on the right, 1/kappa on the left).

    ``group_velocities``: of the branches of a unimodular x that count, in grid points a step towards larger x; empty
    where x is inside the circle. ``ghosts``: x is 0, its solutions are single values that no interior equation reads.
    """

    domain: str
    root: Located
    multiplicity: int
    group_velocities: tuple[float, ...] = ()
    ghosts: bool = False


@dataclass(frozen=True, slots=True)
class Column:
    """The solution binom(n, power) x**(n - power) of a part, in the values of one field (see ``value_fields``).

    ``silent``: an auxiliary vector that no grid value shows.
    """

    part: int
    field: int
    power: int
    silent: bool = False


@dataclass(frozen=True, slots=True)
class Eigenspace:
    """The decaying solutions at one point, and how many modes the closure leaves of them.

    ``local`` is None where the point is known by a ball only (``enclosed_space``).
    """

    problem: NormalModeProblem
    point: Mapping[str, Located]
    parts: tuple[Part, ...]
    columns: tuple[Column, ...]
    dimension: int
    local: _Powers | None

    def at(self, bits: int) -> dict[str, acb]:
        """Balls of everything that a coefficient holds."""
        return {name: each.ball(bits) for name, each in self.point.items()}

    def kernel(self, bits: int) -> list[list[acb]] | None:
        """``dimension`` vectors of amplitudes, one a column, at the precision in force; None where it is too low."""
        matrix = self.local.at_balls(bits) if self.local is not None else self._matrix(bits)
        idle = self.local.idle if self.local is not None else 0
        return kernel(matrix, [column.silent for column in self.columns], idle, self.dimension)

    def _matrix(self, bits: int) -> list[list[acb]]:
        """The closure's rows over the columns; the fields are those of the blocks."""
        blocks: list[list[list[acb]]] = []
        for k in range(len(self.problem.blocks)):
            count = longest(self.problem.rows, k)
            mine = [column for column in self.columns if column.field == k]
            blocks.append([[power(self.parts[c.part].root.ball(bits), n, c.power) for n in range(count)] for c in mine])
        at = self.at(bits)
        return kreiss_matrix(self.problem.rows, blocks, lambda c: at_balls(c, at), acb(0))

    def absent(self, part: int) -> bool | None:
        """Whether no mode has a share in a part, exactly; None where that is left open.

        So it is when the modes without the part's columns are as many.
        """
        if self.local is None:
            return None
        keep = [k for k, column in enumerate(self.columns) if column.part != part]
        rest = self.local.without(part, keep)
        if rest.zero_exponent() > ABSENCE_BITS:
            return None
        try:
            return rest.nullity == self.dimension
        except Undecided:
            return None


def power(x: acb, n: int, j: int) -> acb:
    """binom(n, j) x**(n - j), the n-th value of a solution."""
    return acb(0) if n < j else comb(n, j) * x ** (n - j)


# The kernel -----------------------------------------------------------------------------------------------------------


def kernel(
    matrix: Sequence[Sequence[acb]], silent: Sequence[bool], idle: int, dimension: int
) -> list[list[acb]] | None:
    """A basis of the kernel, of which ``dimension`` vectors differ in the columns that are not silent.

    Gauss-Jordan elimination with the largest certain pivots, silent columns first: ``idle`` of these stay free and are
    set to 0. The number of pivots is known; None where the balls do not certify so many.
    """
    width = len(silent)
    rows = [list(row) for row in matrix]
    free = set(range(width))
    pivots: dict[int, int] = {}
    while len(pivots) < width - idle - dimension:
        place = _largest_pivot(rows, pivots, [j for j in free if silent[j]]) or _largest_pivot(rows, pivots, list(free))
        if place is None:
            return None
        i, j = place
        pivots[i] = j
        free.remove(j)
        _eliminate(rows, i, j, free)
    shown = sorted(j for j in free if not silent[j])
    if len(shown) != dimension:
        return None
    basis = []
    for chosen in shown:
        vector = [acb(int(j == chosen)) for j in range(width)]
        for i, j in pivots.items():
            vector[j] = -rows[i][chosen] / rows[i][j]
        basis.append(vector)
    return basis


def _largest_pivot(
    rows: Sequence[Sequence[acb]], pivots: Mapping[int, int], columns: Sequence[int]
) -> tuple[int, int] | None:
    best, place = None, None
    for i, row in enumerate(rows):
        if i in pivots:
            continue
        for j in columns:
            if not row[j].contains(0):
                size = row[j].abs_lower()
                if best is None or size > best:
                    best, place = size, (i, j)
    return place


def _eliminate(rows: list[list[acb]], i: int, j: int, free: set[int]) -> None:
    """Takes the pivot's row from all others, in the columns that are still free."""
    pivot = rows[i]
    for k, row in enumerate(rows):
        if k != i and row[j] != 0:
            factor = row[j] / pivot[j]
            rows[k] = [a - factor * b if c in free else a for c, (a, b) in enumerate(zip(row, pivot, strict=True))]


# At an exact point ----------------------------------------------------------------------------------------------------


class _Powers(LocalMatrix):
    """The same space as ``LocalMatrix`` has, its ordinary roots in the basis of this module."""

    def columns(self, bits: int, least: int = 0) -> list[dict[int, list[acb]]]:
        found = super().columns(bits, least)
        places = value_places(self.problem)
        start = 0
        for k, roots in enumerate(self.space.roots):
            for at, (root, j) in enumerate(_numbered(roots)):
                count = len(found[start + at][places[k]])
                x = root.ball(bits)
                found[start + at] = {places[k]: [power(x, n, j) for n in range(count)]}
            start += len(roots)
        return found

    def without(self, part: int, keep: Sequence[int]) -> LocalMatrix:
        """The matrix of Newton's basis with the columns of a part left out: ``keep`` are those that stay."""
        left = set(keep)
        roots, start = [], 0
        for mine in self.space.roots:
            roots.append([root for at, root in enumerate(mine) if start + at in left])
            start += len(mine)
        groups: list[list[Chain | Branch]] = [[] for _ in self.space.groups]
        for k, group in self.groups:
            if start in left:
                groups[k].append(group)
            start += self._vectors(group) * self.systems[k].size
        return LocalMatrix(self.problem, self.point, Space(roots, groups), self.systems, self.rows)


def _numbered(roots: Sequence[Root]) -> list[tuple[Root, int]]:
    """Each root with how many equal ones stand before it."""
    seen: list[Root] = []
    found = []
    for root in roots:
        found.append((root, sum(root is other or root == other for other in seen)))
        seen.append(root)
    return found


def exact_space(problem: NormalModeProblem, candidate: Candidate) -> Eigenspace:
    """The modes at a candidate that is known to be one; Undecided where the admissible solutions stay open."""
    families = [admissible(problem, family, candidate) for family in problem.families]
    point = point_with_z(problem, candidate)
    space = space_at(problem, candidate, families)
    local = _Powers(problem, point, space, systems_of(problem), value_rows(problem))
    builder = _Builder(problem, candidate, families)
    for k, mine in enumerate(space.roots):
        builder.ordinary(k, mine)
    for k, group in local.groups:
        builder.group(k, group)
    silent = [column.silent for column in builder.columns]
    return Eigenspace(problem, point, tuple(builder.parts), tuple(builder.columns), _dimension(local, silent), local)


def _dimension(local: _Powers, silent: Sequence[bool]) -> int:
    """The number of independent modes, one at least: pivots that leave room for no second prove that there is one."""
    bits = START_BITS
    while bits <= CHEAP_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            if kernel(local.at_balls(bits), silent, local.idle, 1) is not None:
                return 1
        bits *= 2
    return LocalMatrix(local.problem, local.point, local.space, local.systems, local.rows).nullity


class _Builder:
    """Collects the parts of an exact point, equal roots of one family on one half-line as one part."""

    def __init__(self, problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible]) -> None:
        self.problem, self.candidate, self.families = problem, candidate, families
        self.parts: list[Part] = []
        self.columns: list[Column] = []
        self._places = value_places(problem)
        self._known: dict[tuple[str, int, int], int] = {}

    def ordinary(self, block: int, roots: Sequence[Root]) -> None:
        """The columns of an ordinary block."""
        family, domain = self.problem.blocks[block].family, self.problem.blocks[block].field.domain
        for root, j in _numbered(roots):
            first = next(at for at, other in enumerate(roots) if other is root or other == root)
            key = (domain, -1, 0) if root.is_zero else (domain, family, first - self.problem.blocks[block].zeros)
            if key not in self._known:
                self._known[key] = len(self.parts)
                count = sum(other is root or other == root for other in roots)
                self.parts.append(self._part(block, root, count))
            self.columns.append(Column(self._known[key], self._places[block], j))

    def group(self, block: int, group: Chain | Branch) -> None:
        """The vectors of a group of a coupled block."""
        size = len(self.problem.scheme.half_line(self.problem.blocks[block].field.domain).unknowns)
        length = group.length if isinstance(group, Chain) else 1
        part = self._part(block, group.root, length)
        if isinstance(group, Branch):
            velocity = slope_velocity(group.slope, right=self._right(block))
            part = Part(part.domain, part.root, 1, (velocity,))
        self.parts.append(part)
        for j in range(length):
            self.columns += [Column(len(self.parts) - 1, self._places[block] + u, j) for u in range(size)]
        if isinstance(group, Branch):
            self.columns += [Column(len(self.parts) - 1, self._places[block] + u, 0, True) for u in range(size)]

    def _right(self, block: int) -> bool:
        return self.problem.scheme.half_line(self.problem.blocks[block].field.domain).side == "right"

    def _part(self, block: int, root: Root, count: int) -> Part:
        family = self.problem.blocks[block].family
        velocities: tuple[float, ...] = ()
        for each, branches in self.families[family].limiting:
            if each.root is root or each.root == root:
                here = self.problem.families[family]
                found = group_velocities(self.problem, here, self.candidate, each, right=self._right(block))
                velocities = found if len(found) == 1 else found[:branches]
        return Part(self.problem.blocks[block].field.domain, root, count, velocities, root.is_zero)


# At a point known by a ball -------------------------------------------------------------------------------------------


def enclosed_space(problem: NormalModeProblem, found: Found) -> Eigenspace | None:
    """The mode at a proved simple zero of Delta; None where its spatial roots overlap, or it is not simple.

    At a simple zero the kernel has dimension one: the derivative of a determinant vanishes where the rank is lower.
    """
    sigma = found.sigma(problem)
    if found.multiplicity != 1 or sigma is None:
        return None
    point: dict[str, Located] = {**problem.coefficients.point(), problem.variable: Enclosed(sigma)}
    parts: list[Part] = []
    columns: list[Column] = []
    known: dict[tuple[str, int, int], int] = {}
    for k, block in enumerate(problem.blocks):
        mine = found.roots[block.family]
        if any(a.overlaps(b) for at, a in enumerate(mine) for b in mine[:at]):
            return None
        domain = block.field.domain
        entries = [((domain, -1, 0), acb(0), j) for j in range(block.zeros)]
        entries += [((domain, block.family, at), x, 0) for at, x in enumerate(mine)]
        for key, x, j in entries:
            if key not in known:
                known[key] = len(parts)
                parts.append(Part(domain, Enclosed(x), block.zeros if key[1] < 0 else 1, (), key[1] < 0))
            columns.append(Column(known[key], k, j))
    return Eigenspace(problem, point, tuple(parts), tuple(columns), 1, None)


def direct_sum(problem: NormalModeProblem, spaces: Sequence[Eigenspace]) -> Eigenspace:
    """The modes of independent parts of a problem at one z, as those of the whole."""
    fields = [block.field for block in problem.blocks]
    parts: list[Part] = []
    columns: list[Column] = []
    for space in spaces:
        places = [next(k for k, each in enumerate(fields) if each is b.field) for b in space.problem.blocks]
        columns += [replace(c, part=c.part + len(parts), field=places[c.field]) for c in space.columns]
        parts += space.parts
    columns.sort(key=lambda column: column.field)  # in the order of the blocks, as the matrix has them
    dimension = sum(space.dimension for space in spaces)
    return Eigenspace(problem, spaces[0].point, tuple(parts), tuple(columns), dimension, None)
