"""Normal modes of coupled half-lines where the scalar field w loses solutions: crossings, and z = infinity.

At a point where c(x) vanishes for a spatial root x the map w -> c(E) w misses solutions. If another column of adj(M)
does not vanish there, it takes over (``regular_problem``). If all of them do, several branches cross, and the solutions
are written with vectors of their own, tied by the interior equations themselves. To a root x of multiplicity mu in D
belong, with M_j = M^(j)(x) / j!,

    V(n) = sum_k binom(n, k) x**(n - k) a_k,        sum_j M_j a_{i+j} = 0,  i = 0, ..., mu - 1,

mu independent solutions whatever their Jordan structure. On the circle, with z = z0 (1 + eps), x = x0 (1 + eta), a
clean crossing (M(x0) has a kernel of the dimension d that x0 has as a root) splits to first order: for the branch
eta = v eps of a simple slope v the limit of the solution is V = x0**n a with

    M a = 0,        (M_eps + v M_eta) a + M b = 0        for some b,

which determines a up to a factor and b up to the kernel of M (Kato, Perturbation Theory for Linear Operators, II 2.3,
the reduction process). A mode is then a vector in the kernel of one matrix: the closure applied to these columns, and
the conditions on the a and b beneath it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import comb, factorial, inf

from flint import acb, fmpz_mpoly

from gks.modes.admissible import Admissible, Candidate, crossing_slopes, outward, point_of, point_with_z
from gks.modes.algebraic import Root
from gks.modes.coupled import CoupledField, System, ValueField, trial_vectors
from gks.modes.fibre import FibreRoot, at_balls, is_zero, vanishes
from gks.modes.field import Field
from gks.modes.height import conjugate_heights, norm_bits
from gks.modes.kreiss import NormalModeProblem, Term, closure_rows, newton_columns
from gks.modes.rank import exact_rank
from gks.modes.undecided import Undecided


def regular_problem(
    problem: NormalModeProblem, candidate: Candidate, roots: Sequence[Sequence[Root]]
) -> NormalModeProblem | None:
    """The problem itself where no c vanishes at an admissible root, else with columns that do not; None at a crossing.

    ``roots`` are the admissible roots of each block.
    """
    point = point_of(problem, candidate)
    fields: list[Field] = []
    for block, mine in zip(problem.blocks, roots, strict=True):
        field = block.field
        if isinstance(field, CoupledField):
            found = _regular_field(field, point, mine)
            if found is None:
                return None
            field = found
        fields.append(field)
    if all(field is block.field for field, block in zip(fields, problem.blocks, strict=True)):
        return problem
    rows = closure_rows(problem.scheme, problem.lowest, fields, problem.coefficients, problem.resolvent)
    blocks = tuple(replace(block, field=field) for field, block in zip(fields, problem.blocks, strict=True))
    return replace(problem, rows=tuple(rows), blocks=blocks)


def _regular_field(field: CoupledField, point: Mapping[str, Root], roots: Sequence[Root]) -> CoupledField | None:
    if not any(field.vanishes(point, root) for root in roots):
        return field
    for h in trial_vectors(field.system.size):
        other = replace(field, column=field.system.column(h))
        if not any(other.vanishes(point, root) for root in roots):
            return other
    return None


# The solutions at one root -------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Chain:
    """The first ``length`` vectors a_0, a_1, ... at a spatial root."""

    root: Root
    length: int


@dataclass(frozen=True, slots=True)
class Branch:
    """The limit of one of ``order`` branches that cross at a root on the circle, by its slope v."""

    root: Root
    slope: Root
    order: int


def groups_of(
    problem: NormalModeProblem, block: int, candidate: Candidate, found: Admissible, *, strict: bool
) -> list[Chain | Branch]:
    """The admissible solutions of a coupled block at a candidate; with ``strict`` those that decay.

    Undecided where branches meet on the circle in a way that first order does not separate.
    """
    field = problem.blocks[block].field
    assert isinstance(field, CoupledField)
    if vanishes(point_of(problem, candidate), field.system.symbol):
        raise Undecided("every spatial factor solves the coupled interior at this z")
    zeros = problem.blocks[block].zeros + sum(r.multiplicity for r in found.inside if r.root.is_zero)
    groups: list[Chain | Branch] = [Chain(Root.of(0), zeros)] if zeros else []
    groups += [Chain(r.root, r.multiplicity) for r in found.inside if not r.root.is_zero]
    if not strict:
        for root, count in found.limiting:
            groups += _limits(problem, block, candidate, root, count)
    return groups


def _limits(
    problem: NormalModeProblem, block: int, candidate: Candidate, root: FibreRoot, count: int
) -> list[Chain | Branch]:
    family = problem.families[problem.blocks[block].family]
    field = problem.blocks[block].field
    assert isinstance(field, CoupledField)
    point = {**point_of(problem, candidate), "x": root.root}
    if not is_zero(point, family.polynomial.derivative(problem.variable)):
        return [Chain(root.root, count)]
    if not clean(field.system, point, "x", root.multiplicity):
        raise Undecided("branches that cross on the circle share their solutions")
    if count == root.multiplicity:
        return [Chain(root.root, 1)]
    slopes = crossing_slopes(problem, family, candidate, root)
    incoming = [(slope, times) for slope, times in slopes if slope.ball().real < 0]
    if any(times > 1 for _, times in incoming):
        raise Undecided("branches that cross on the circle have one group velocity")
    return [Branch(root.root, slope, root.multiplicity) for slope, _ in incoming]


def clean(system: System, point: Mapping[str, Root], variable: str, multiplicity: int) -> bool:
    """Whether M has a kernel of the dimension that D has as order of vanishing in a variable, x or the resolvent's.

    So it is exactly when adj(M) vanishes to order multiplicity - 1: D vanishes to the sum of the partial
    multiplicities, adj(M) to that sum without the largest one.
    """
    for column in system.adjugate():
        for entry in column:
            for _ in range(multiplicity - 1):
                if not is_zero(point, entry):
                    return False
                entry = entry.derivative(variable)
    return True


# One matrix for everything -------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Space:
    """Admissible solutions: Newton's basis over the roots of ordinary blocks, groups for coupled ones."""

    roots: Sequence[Sequence[Root]]
    groups: Sequence[Sequence[Chain | Branch]]


class LocalMatrix:
    """The closure over the conditions on the local vectors, at one point; its kernel is that of the normal modes.

    ``point`` has the coordinates of everything but x; ``systems`` gives each coupled block its M, ``rows`` are the
    closure in values (``value_rows``).
    """

    def __init__(
        self, problem: NormalModeProblem, point: Mapping[str, Root], space: Space,
        systems: Mapping[int, System], rows: Sequence[Sequence[Term]],
    ) -> None:  # fmt: skip
        self.problem, self.point, self.space, self.systems, self.rows = problem, point, space, systems, rows
        self.groups = [(k, group) for k, groups in enumerate(space.groups) for group in groups]
        self.width = sum(map(len, space.roots)) + sum(self._vectors(g) * systems[k].size for k, g in self.groups)
        # The b of a branch are free up to the kernel of M, and the closure does not see them.
        self.idle = sum(group.order for _, group in self.groups if isinstance(group, Branch))

    @staticmethod
    def _vectors(group: Chain | Branch) -> int:
        return group.length if isinstance(group, Chain) else 2

    @property
    def nullity(self) -> int:
        """The dimension of the space of normal modes."""
        ceiling = self.width - self.idle
        return ceiling - exact_rank(self.at_balls, self.zero_exponent, ceiling=ceiling) if ceiling else 0

    def at_balls(self, bits: int) -> list[list[acb]]:
        """The matrix at the working precision: closure rows, then the conditions."""
        at = {name: root.ball(bits) for name, root in self.point.items()}
        columns = self.columns(bits)
        matrix = []
        for row in self.rows:
            terms = [(term.block, term.n, at_balls(term.coefficient, at)) for term in row]
            matrix.append([sum((c * column[k][n] for k, n, c in terms if k in column), acb(0)) for column in columns])
        start = sum(map(len, self.space.roots))
        for k, group in self.groups:
            for condition in self._conditions(k, group, at, bits):
                line = [acb(0)] * self.width
                line[start : start + len(condition)] = condition
                matrix.append(line)
            start += self._vectors(group) * self.systems[k].size
        return matrix

    def columns(self, bits: int, least: int = 0) -> list[dict[int, list[acb]]]:
        """For each column the values v_n, ``least`` or more, of the ``value_fields`` that it concerns."""
        reach = max(least, 1 + max((term.n for row in self.rows for term in row), default=-1))
        places = value_places(self.problem)
        found: list[dict[int, list[acb]]] = []
        for k, roots in enumerate(self.space.roots):
            balls = [root.ball(bits) for root in roots]
            found += [{places[k]: column} for column in newton_columns(balls, reach, acb(0), acb(1))]
        for k, group in self.groups:
            x = group.root.ball(bits)
            for j in range(self._vectors(group)):
                silent = isinstance(group, Branch) and j == 1
                values = [acb(0) if silent or n < j else comb(n, j) * x ** (n - j) for n in range(reach)]
                found += [{places[k] + u: values} for u in range(self.systems[k].size)]
        return found

    def _conditions(self, block: int, group: Chain | Branch, at: Mapping[str, acb], bits: int) -> list[list[acb]]:
        system = self.systems[block]
        here = {**at, "x": group.root.ball(bits)}
        if isinstance(group, Chain):
            blocks = [_derived(system, here, j) for j in range(group.length)]
            tiles: list[list[list[list[acb]] | None]] = [
                [blocks[k - i] if k >= i else None for k in range(group.length)] for i in range(group.length)
            ]
        else:
            matrix = _derived(system, here, 0)
            tiles = [[matrix, None], [self._drift(system, group, here, bits), matrix]]
        zero = [[acb(0)] * system.size for _ in range(system.size)]
        return [
            [entry for tile in row for entry in (zero if tile is None else tile)[i]]
            for row in tiles
            for i in range(system.size)
        ]

    def _drift(self, system: System, branch: Branch, here: Mapping[str, acb], bits: int) -> list[list[acb]]:
        """M_eps + v M_eta, times the denominator of d sigma / d eps."""
        top, bottom = (at_balls(part, here) for part in outward(self.problem))
        turn = branch.slope.ball(bits) * bottom * here["x"]
        variable = self.problem.variable
        return [
            [at_balls(e.derivative(variable), here) * top + at_balls(e.derivative("x"), here) * turn for e in row]
            for row in system.matrix
        ]

    def zero_exponent(self) -> float:
        """E such that every minor is 0 or larger than 2**-E, as in ``height``: bounds on all conjugates of all rows."""
        heights = {name: max(conjugate_heights(root)) for name, root in self.point.items()}
        algebraic = {root.minimal for root in self.point.values()}
        algebraic |= {root.minimal for roots in self.space.roots for root in roots}
        algebraic |= {group.root.minimal for _, group in self.groups}
        algebraic |= {group.slope.minimal for _, group in self.groups if isinstance(group, Branch)}
        conjugates, tallest = 1, 1.0
        for root in algebraic:
            conjugates *= int(root.poly.degree())
            tallest = max(tallest, *conjugate_heights(root))
        names = self.problem.coefficients.context.names()

        def weight(polynomials: Sequence[fmpz_mpoly]) -> float:
            degrees = [max(int(p.degrees()[i]) for p in polynomials) for i in range(len(names))]
            return norm_bits(polynomials) + sum(
                d * heights.get(name, tallest) for name, d in zip(names, degrees, strict=True) if d
            )

        total = 0.0
        for row in self.rows:
            if row:
                reach = max(term.n for term in row)
                total += weight([term.coefficient for term in row]) + (reach + self.width) * (1 + tallest)
        top, bottom = outward(self.problem)
        for k, group in self.groups:
            system = self.systems[k]
            for entries in system.matrix:
                # Derivatives of order j over j! have at most 2**degree times the coefficients.
                degree = max(int(e.degrees()[names.index("x")]) for e in entries)
                each = weight(entries) + degree + 2
                if isinstance(group, Branch):
                    drift = each + weight([top]) + weight([bottom]) + 3 * tallest + _degree_bits(entries)
                    total += each + drift
                else:
                    total += group.length * (each + group.length)
        return inf if conjugates > 1 << 20 else (conjugates + 1) * total


def _degree_bits(polynomials: Sequence[fmpz_mpoly]) -> int:
    """Bits that a first derivative may add to coefficients."""
    return max(int(d) for p in polynomials for d in p.degrees()).bit_length()


def _derived(system: System, here: Mapping[str, acb], order: int) -> list[list[acb]]:
    """M_j = M^(j)(x) / j! in balls."""
    found = []
    for row in system.matrix:
        line = []
        for entry in row:
            for _ in range(order):
                entry = entry.derivative("x")
            line.append(at_balls(entry, here) / factorial(order))
        found.append(line)
    return found


# Values as fields ----------------------------------------------------------------------------------------------------


def value_places(problem: NormalModeProblem) -> list[int]:
    """Where each block begins among ``value_fields``."""
    places, place = [], 0
    for block in problem.blocks:
        places.append(place)
        place += block.field.system.size if isinstance(block.field, CoupledField) else 1
    return places


def value_fields(problem: NormalModeProblem) -> list[Field]:
    """The blocks' fields, a coupled one replaced by the values of its unknowns."""
    fields: list[Field] = []
    for block in problem.blocks:
        field = block.field
        if isinstance(field, CoupledField):
            fields += [
                ValueField(field.domain, (), {0: problem.resolvent.z}, None, u, reach, False)
                for u, reach in enumerate(field.system.reach)
            ]
        else:
            fields.append(field)
    return fields


def value_rows(problem: NormalModeProblem) -> list[tuple[Term, ...]]:
    """The closure in terms of ``value_fields``."""
    return closure_rows(problem.scheme, problem.lowest, value_fields(problem), problem.coefficients, problem.resolvent)


def systems_of(problem: NormalModeProblem) -> dict[int, System]:
    """The coupled blocks with their systems."""
    return {k: b.field.system for k, b in enumerate(problem.blocks) if isinstance(b.field, CoupledField)}


def modes_at(
    problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible], *, strict: bool = False
) -> int:
    """The number of independent normal modes at a candidate; with ``strict`` of those all of whose components decay."""
    space = space_at(problem, candidate, families, strict=strict)
    return LocalMatrix(
        problem, point_with_z(problem, candidate), space, systems_of(problem), value_rows(problem)
    ).nullity


def space_at(
    problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible], *, strict: bool = False
) -> Space:
    """The admissible solutions at a candidate; with ``strict`` those that decay."""
    roots: list[list[Root]] = []
    groups: list[list[Chain | Branch]] = []
    for k, block in enumerate(problem.blocks):
        found = families[block.family]
        if isinstance(block.field, CoupledField):
            roots.append([])
            groups.append(groups_of(problem, k, candidate, found, strict=strict))
        else:
            limiting = [] if strict else found.on_circle()
            roots.append([Root.of(0)] * block.zeros + found.strictly() + limiting)
            groups.append([])
    return Space(roots, groups)
