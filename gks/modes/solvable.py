"""Does the closure, with the interior, determine level n+1? Delta at z = infinity, in the ghost basis.

At z = infinity only the top power of the resolvent variable is left of every equation. An explicit interior then says
that
all new interior values are known, so the decaying solutions are the ghost values alone; an implicit one keeps the
spatial
roots of its new level. Under the method of lines z = infinity is s = infinity, or s = rho_k / (lam sigma_k) where the
integrator is implicit.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from flint import acb, ctx, fmpz_mpoly

from gks.errors import GksError, SchemeError
from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root
from gks.modes.coupled import System
from gks.modes.crossing import Branch, Chain, LocalMatrix, Space, systems_of, value_fields, value_rows
from gks.modes.determinant import determinant
from gks.modes.fibre import VanishesIdentically, at_balls, fibre
from gks.modes.fibre import value as algebraic_value
from gks.modes.field import mirrored
from gks.modes.height import zero_exponent
from gks.modes.kreiss import NormalModeProblem, Term, closure_matrix, normal_mode_problem, sample_point
from gks.modes.rank import exact_rank
from gks.scheme.model import Scheme

TRIALS = 3
"""Random parameter sets at which Delta(oo) must vanish for it to count as identically zero.

A nonzero algebraic function of the parameters vanishes at a random rational of 40 bits with probability below its
degree
over 2**39.
"""


def determines_next_level(problem: NormalModeProblem) -> bool:
    """False where Delta(oo) = 0 at these values; SchemeError where it is zero for all values."""
    if _full_rank(problem):
        return True
    generator = random.Random(0)
    for _ in range(TRIALS):
        other = _elsewhere(problem.scheme, generator)
        if other is not None and _full_rank(other):
            return False
    refuse_undetermined(problem)
    return False


def _elsewhere(scheme: Scheme, generator: random.Random) -> NormalModeProblem | None:
    """The same scheme at random values inside the parameters' ranges, None where the formulas have no value there."""
    values = {}
    for parameter in scheme.parameters:
        share = Fraction(generator.randrange(1, 1 << 40), 1 << 40)
        low, high = parameter.low, parameter.high
        if low is not None and high is not None:
            values[parameter.name] = low + (high - low) * share
        elif low is not None:
            values[parameter.name] = low + share / (1 - share)
        elif high is not None:
            values[parameter.name] = high - share / (1 - share)
        else:
            values[parameter.name] = (share - Fraction(1, 2)) / (share * (1 - share))
    try:
        return normal_mode_problem(scheme, values)
    except GksError:
        return None


def _top(problem: NormalModeProblem) -> NormalModeProblem:
    """The problem with every symbol and row replaced by what is left of it at z = infinity."""
    if _implicit(problem) is not None:
        return problem
    families = [replace(f, polynomial=_leading([f.polynomial], problem.variable)[0]) for f in problem.families]
    rows = tuple(_leading_row(row, problem.variable) for row in problem.rows)
    return replace(problem, families=tuple(families), rows=rows)


def _leading_row(row: Sequence[Term], variable: str) -> tuple[Term, ...]:
    leads = _leading([term.coefficient for term in row], variable)
    return tuple(replace(t, coefficient=c) for t, c in zip(row, leads, strict=True) if not c.is_zero())


def _implicit(problem: NormalModeProblem) -> Root | None:
    """The finite s that an implicit integrator maps to z = infinity."""
    method = problem.resolvent.integrator
    if problem.variable == "z" or method is None or method.kind != "multistep" or method.explicit:
        return None
    coefficients = problem.coefficients
    lead = coefficients.number(method.rho[-1] / method.sigma[-1]) / coefficients.symbol(problem.resolvent.cfl)
    return algebraic_value(coefficients.point(), lead.num, lead.den)


def _point(problem: NormalModeProblem) -> dict[str, Root]:
    finite = _implicit(problem)
    point = problem.coefficients.point()
    return point if finite is None else {**point, "s": finite}


def _leading(polynomials: Sequence[fmpz_mpoly], variable: str) -> list[fmpz_mpoly]:
    """The coefficients of the highest power of the variable that any of the polynomials holds."""
    if not polynomials:
        return []
    context = polynomials[0].context()
    index = context.names().index(variable)
    top = max(p.degrees()[index] for p in polynomials)
    return [
        context.from_dict(
            {
                (*powers[:index], 0, *powers[index + 1 :]): int(c)
                for powers, c in p.to_dict().items()
                if powers[index] == top
            }
        )
        for p in polynomials
    ]


def _roots_at_top(problem: NormalModeProblem) -> list[list[Root]] | None:
    """The admissible roots of each block at z = infinity, None where a family has lost one."""
    return _roots_of(problem, _point(problem))


def _roots_of(problem: NormalModeProblem, point: Mapping[str, Root]) -> list[list[Root]] | None:
    per_family = []
    for family in problem.families:
        found = [
            each.root
            for each in fibre(point, family.polynomial, "x")
            if each.position is Position.INSIDE
            for _ in range(each.multiplicity)
        ]
        if len(found) != family.decaying:
            return None
        per_family.append(found)
    return [[Root.of(0)] * block.zeros + per_family[block.family] for block in problem.blocks]


def _full_rank(problem: NormalModeProblem) -> bool:
    if not problem.size:
        return True
    if problem.coupled:
        local = _local_top(problem)
        return local is not None and local.nullity == 0
    top = _top(problem)
    roots = _roots_at_top(top)
    if roots is None:
        return False
    rank = exact_rank(
        lambda bits: closure_matrix(top, _point(top), roots, bits), lambda: zero_exponent(top, _implicit(top))
    )
    return rank == problem.size


# Coupled systems -----------------------------------------------------------------------------------------------------


def _local_top(problem: NormalModeProblem) -> LocalMatrix | None:
    """The closure at z = infinity on the values themselves, None where a decaying solution is lost there."""
    systems, rows = systems_of(problem), value_rows(problem)
    if _implicit(problem) is None:
        systems = {k: _leading_system(system, problem.variable) for k, system in systems.items()}
        rows = [_leading_row(row, problem.variable) for row in rows]
    return _local(_top(problem), _point(problem), systems, rows)


def _leading_system(system: System, variable: str) -> System:
    """Each equation's highest power of the variable."""
    matrix = tuple(tuple(_leading(row, variable)) for row in system.matrix)
    return replace(system, matrix=matrix, symbol=determinant(matrix, system.symbol.context().constant(1)))


def _local(
    problem: NormalModeProblem, point: Mapping[str, Root], systems: Mapping[int, System], rows: Sequence[Sequence[Term]]
) -> LocalMatrix | None:
    """The closure on all decaying solutions at a point off the circle, None where their number is not the usual one."""
    roots: list[list[Root]] = []
    groups: list[list[Chain | Branch]] = []
    for k, block in enumerate(problem.blocks):
        symbol = systems[k].symbol if k in systems else problem.families[block.family].polynomial
        try:
            inside = [each for each in fibre(point, symbol, "x") if each.position is Position.INSIDE]
        except VanishesIdentically:
            return None
        if sum(each.multiplicity for each in inside) != block.width - (0 if k in systems else block.zeros):
            return None
        plain = [] if k in systems else [each.root for each in inside for _ in range(each.multiplicity)]
        roots.append(plain if k in systems else [Root.of(0)] * block.zeros + plain)
        groups.append([Chain(each.root, each.multiplicity) for each in inside] if k in systems else [])
    return LocalMatrix(problem, point, Space(roots, groups), systems, rows)


# What is left undetermined ------------------------------------------------------------------------------------------


def refuse_undetermined(problem: NormalModeProblem) -> None:
    """SchemeError that names boundary values which nothing determines."""
    scheme = problem.scheme
    names = _undetermined(problem)
    what = ", ".join(names) if names else "some boundary value"
    raise SchemeError(
        f"{what} {'are' if len(names) > 1 else 'is'} left undetermined: closure and interior do not give level n+1",
        where=scheme.closure_place,
        path="closure.equations",
        expected="equations that can be solved for every boundary value at the new level",
        mend=f"add {what} to an equation, or move `first`",
    )


def _undetermined(problem: NormalModeProblem) -> list[str]:
    """Boundary unknowns that take part in a solution of the homogeneous equations at z = infinity."""
    local = _local_top(problem)
    if local is None:
        return []
    bits = 2 * START_BITS
    with ctx.workprec(bits + GUARD_BITS):
        kernel = _kernel_vector(local.at_balls(bits))
        if kernel is None:
            return []
        at = {name: root.ball(bits) for name, root in local.point.items()}
        most = max(problem.ghosts(half_line.name) for half_line in problem.scheme.domains)
        columns = local.columns(bits, max(most, 1))
        fields = value_fields(problem)
        names = []
        for value in problem.scheme.boundary_unknowns:
            half_line = problem.scheme.half_line(value.domain)
            component = half_line.unknowns.index(value.unknown)
            n = mirrored(half_line, value.index) - problem.lowest[value.domain]
            total = acb(0)
            for k, field in enumerate(fields):
                if field.domain != value.domain:
                    continue
                for place, factor in field.share(component, n, problem.ghosts(value.domain)):
                    weight = at_balls(factor.num, at) / at_balls(factor.den, at)
                    total += weight * sum(
                        (v * column[k][place] for v, column in zip(kernel, columns, strict=True) if k in column), acb(0)
                    )
            if not total.contains(0):
                names.append(str(value))
        return names


def _kernel_vector(matrix: list[list[acb]]) -> list[acb] | None:
    """A vector that elimination with certain pivots leaves in the kernel, None without free columns."""
    rows = [list(row) for row in matrix]
    columns = len(rows[0]) if rows else 0
    pivots: list[tuple[int, int]] = []
    for column in range(columns):
        used = [i for i, _ in pivots]
        live = [i for i in range(len(rows)) if i not in used and not rows[i][column].contains(0)]
        if not live:
            continue
        pivot = live[0]
        pivots.append((pivot, column))
        for i in range(len(rows)):
            if i != pivot:
                factor = rows[i][column] / rows[pivot][column]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[pivot], strict=True)]
    free = [c for c in range(columns) if c not in {column for _, column in pivots}]
    if not free:
        return None
    vector = [acb(0)] * columns
    vector[free[0]] = acb(1)
    for i, column in pivots:
        vector[column] = -rows[i][free[0]] / rows[i][column]
    return vector


def independent_at_sample(problem: NormalModeProblem) -> bool:
    """Whether Delta is not zero at one point with abs(z) > 1; then it does not vanish identically."""
    sample = Root.of(sample_point(problem.coefficients, problem.resolvent))
    point = {**problem.coefficients.point(), problem.variable: sample}
    if problem.coupled:
        local = _local(problem, point, systems_of(problem), value_rows(problem))
        return local is not None and local.nullity == 0
    roots = _roots_of(problem, point)
    if roots is None:
        return False
    rank = exact_rank(lambda bits: closure_matrix(problem, point, roots, bits), lambda: zero_exponent(problem, sample))
    return rank == problem.size


def degenerate_closure(problem: NormalModeProblem) -> SchemeError:
    """The error for a Delta that is zero for every z."""
    return SchemeError(
        "the closure is degenerate at these values: its determinant vanishes for every z",
        where=problem.scheme.closure_place,
        path="closure.equations",
        expected="equations that are independent on the decaying solutions",
        mend="look for an equation that repeats another one, or that the interior scheme already implies",
    )
