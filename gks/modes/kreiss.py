"""The normal-mode problem of a scheme: spatial families, and the Kreiss matrix in the Newton basis of decaying
solutions.

On the mirrored half-line a field's decaying solutions are the sequences v_0, v_1, ... annihilated by

    K(E) = prod_j (E - kappa_j),        kappa_j the decaying roots of P(sigma, .), zeros counted,

v_0 being the lowest grid point that the scheme or the closure reads. They are spanned by the divided differences

    v_n = [kappa_1, ..., kappa_j] x**n,        j = 1, ..., d,

which stay a basis when roots collide, depend symmetrically and analytically on the roots up to a unit triangular
change of basis, and start with the unit vectors for the roots 0 (ghost values that the interior never reads). So

    Delta(sigma) = det(closure equations applied to these columns)

is the determinant in the basis of the ghost values v_0, ..., v_{d-1}: no zero, pole or branch point comes from
colliding roots (Gustafsson, Kreiss & Sundström, Math. Comp. 26 (1972), Lemma 10.3 uses the same normalisation).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol, Self, TypeVar

from flint import acb, fmpz_mpoly

from gks.errors import ParameterError, SchemeError, Where, quoted
from gks.modes.algebraic import Position, Root
from gks.modes.characteristic import fields_of
from gks.modes.coefficients import Coefficients, Ratio, common_denominator
from gks.modes.coupled import CoupledField
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import at_balls, fibre, specialise
from gks.modes.fibre import coefficients as powers_of
from gks.modes.field import Field, mirrored
from gks.modes.resolvent import Resolvent, characteristic, resolvent_of
from gks.modes.unimodular import rational_ends
from gks.scheme.expression import Expr
from gks.scheme.model import GridValue, HalfLine, Scheme


class Number(Protocol):
    """What the Newton basis is computed with: balls, or polynomials in the spatial roots."""

    def __add__(self, other: Self, /) -> Self: ...
    def __mul__(self, other: Self, /) -> Self: ...


N = TypeVar("N", bound=Number)


class Enclosed(Protocol):
    """A number known by balls."""

    def ball(self, bits: int, /) -> acb:
        """A ball around it, of relative radius at most ``2**-bits``."""


@dataclass(frozen=True, slots=True)
class Family:
    """The spatial roots shared by all fields with one symbol.

    ``polynomial`` is P(sigma, x) without its roots 0; ``decaying`` of its roots have abs(x) < 1 for every abs(z) > 1
    (constant there, by Cauchy stability). ``part`` is the product of the irreducible factors of P that hold them, and
    ``degree`` its degree in x: a branch that never decays is of no use to an elimination.
    """

    polynomial: fmpz_mpoly
    decaying: int
    part: fmpz_mpoly
    degree: int


@dataclass(frozen=True, slots=True)
class Block:
    """One field's columns: ``zeros`` roots 0, then the decaying roots of its family."""

    field: Field
    family: int
    zeros: int
    width: int


@dataclass(frozen=True, slots=True)
class Term:
    """``coefficient`` times v_n of the field of a block."""

    block: int
    n: int
    coefficient: fmpz_mpoly


@dataclass(frozen=True, slots=True)
class NormalModeProblem:
    """Everything that the spatial problem of a scheme at given values consists of."""

    scheme: Scheme
    coefficients: Coefficients
    resolvent: Resolvent
    families: tuple[Family, ...]
    blocks: tuple[Block, ...]
    rows: tuple[tuple[Term, ...], ...]
    lowest: Mapping[str, int]
    """Mirrored index of v_0, a domain."""
    time_map: fmpz_mpoly | None
    """pi(z, lam*s), where the variable is s and z is algebraic in it."""

    @property
    def size(self) -> int:
        return len(self.rows)

    @property
    def variable(self) -> str:
        return self.resolvent.name

    @property
    def coupled(self) -> bool:
        """Whether a half-line has a system that no basis separates."""
        return any(isinstance(block.field, CoupledField) for block in self.blocks)

    def ghosts(self, domain: str) -> int:
        """How many grid points lie below the first cell that the interior scheme gives."""
        return self.scheme.half_line(domain).first - self.lowest[domain]


def normal_mode_problem(
    scheme: Scheme, values: Mapping[str, Fraction | Root], symbols: Sequence[str] = ()
) -> NormalModeProblem:
    """Derives the problem; ``symbols`` name the parameters that stay variables.

    Raises SchemeError where decaying solutions and closure equations differ in number, NotAnalysable and
    ParameterError as the characteristic decomposition does.
    """
    problem = spatial_problem(scheme, values, symbols)
    require_square(problem)
    return problem


def spatial_problem(
    scheme: Scheme, values: Mapping[str, Fraction | Root], symbols: Sequence[str] = ()
) -> NormalModeProblem:
    """The same without the count of decaying solutions, which means nothing where the interior is not Cauchy-stable.

    Several questions are asked about the same values one after the other: the last few answers are kept, where the
    values are rational and nothing irrational was adjoined to them since.
    """
    asked = dict(values), tuple(symbols)
    for known_scheme, known, problem in tuple(_RECENT):
        if known_scheme is scheme and known == asked and not problem.coefficients.generators:
            return problem
    problem = _derived(scheme, *asked)
    if all(isinstance(value, Fraction) for value in values.values()):
        _RECENT.append((scheme, asked, problem))
    return problem


_RECENT: deque[tuple[Scheme, tuple[dict[str, Fraction | Root], tuple[str, ...]], NormalModeProblem]] = deque(maxlen=16)
"""What was derived last: scheme, values and symbols, problem. A theorem asks half of its questions twice."""


def _derived(scheme: Scheme, values: Mapping[str, Fraction | Root], symbols: tuple[str, ...]) -> NormalModeProblem:
    coefficients = Coefficients(values, symbols)
    resolvent = resolvent_of(scheme, coefficients)
    lowest = {half_line.name: _lowest(scheme, half_line) for half_line in scheme.domains}
    families: list[Family] = []
    blocks: list[Block] = []
    for half_line in scheme.domains:
        ghosts = half_line.first - lowest[half_line.name]
        try:
            fields = fields_of(half_line, coefficients, resolvent)
        except ParameterError as error:
            where = Where(scheme.path or scheme.name)
            raise _placed(error, where, f"{error.message} in the interior of {quoted(half_line.name)}") from None
        for each in fields:
            blocks.append(_block(each, ghosts, families, coefficients, resolvent))
    rows = closure_rows(scheme, lowest, [block.field for block in blocks], coefficients, resolvent)
    time_map = None
    if resolvent.integrator is not None and resolvent.integrator.kind != "exact":
        time_map = characteristic(resolvent.integrator, coefficients, scheme.cfl)
    return NormalModeProblem(
        scheme, coefficients, resolvent, tuple(families), tuple(blocks), tuple(rows), lowest, time_map
    )


def require_square(problem: NormalModeProblem) -> None:
    """SchemeError where the closure does not have one equation for each decaying solution."""
    scheme = problem.scheme
    columns = sum(block.width for block in problem.blocks)
    if columns == problem.size:
        return
    given = len(scheme.closure.equations)
    raise SchemeError(
        f"the interior scheme has {columns - (problem.size - given)} decaying solutions for abs(z) > 1 "
        f"and the closure gives {given} equations",
        where=scheme.closure_place,
        path="closure.equations",
        expected="one closure equation for each decaying solution",
        mend="move `first` or rewrite the interior so that each equation is centred on the cell it updates",
    )


def _lowest(scheme: Scheme, half_line: HalfLine) -> int:
    indices = [mirrored(half_line, v.index) for v in scheme.boundary_unknowns if v.domain == half_line.name]
    return min([half_line.first, *indices])


def _block(each: Field, ghosts: int, families: list[Family], coefficients: Coefficients, resolvent: Resolvent) -> Block:
    polynomial = each.polynomial(coefficients, ghosts)
    zeros = min((i for i, c in enumerate(powers_of(polynomial, "x")) if not c.is_zero()), default=0)
    polynomial = polynomial / coefficients.gens["x"] ** zeros
    _, polynomial = polynomial.primitive()
    if polynomial.leading_coefficient() < 0:
        polynomial = -polynomial
    for index, family in enumerate(families):
        if family.polynomial == polynomial:
            return Block(each, index, zeros, zeros + family.decaying)
    family = _family(polynomial, coefficients, resolvent)
    families.append(family)
    return Block(each, len(families) - 1, zeros, zeros + family.decaying)


def _family(polynomial: fmpz_mpoly, coefficients: Coefficients, resolvent: Resolvent) -> Family:
    decaying = 0
    part = coefficients.context.constant(1)
    for factor, multiplicity in irreducible_factors(polynomial):
        mine = _decaying(factor, coefficients, resolvent)
        if mine:
            decaying += mine * multiplicity
            part *= factor**multiplicity
    return Family(polynomial, decaying, part, len(powers_of(part, "x")) - 1)


def sample_point(coefficients: Coefficients, resolvent: Resolvent) -> Fraction:
    """A value of the resolvent variable with abs(z) > 1.

    z = 3; or 0 < lam*s < 1, which every consistent integrator maps to a z > 1: the root that is exp(mu) to leading
    order is real and above 1 for 0 < mu < 1.
    """
    if resolvent.in_z:
        return Fraction(3)
    return Fraction(1, 2) / upper_bound(coefficients.values[resolvent.cfl])


def upper_bound(value: Fraction | Root) -> Fraction:
    """A rational at or above a real number."""
    return value if isinstance(value, Fraction) else rational_ends(value.ball().real)[1]


def _decaying(polynomial: fmpz_mpoly, coefficients: Coefficients, resolvent: Resolvent) -> int:
    sample = {coefficients.variable(s): upper_bound(coefficients.values[s]) for s in coefficients.symbols}
    sample[resolvent.name] = sample_point(coefficients, resolvent)
    coefficients.without_free_roots(polynomial)
    roots = fibre(coefficients.point(), specialise(polynomial, sample), "x")
    return sum(root.multiplicity for root in roots if root.position is Position.INSIDE)


def closure_rows(
    scheme: Scheme, lowest: Mapping[str, int], fields: Sequence[Field], coefficients: Coefficients, resolvent: Resolvent
) -> list[tuple[Term, ...]]:
    """The closure in terms of the fields, a row for each equation, and for each value that nothing reads."""
    rows = []
    for equation in scheme.closure.equations:
        try:
            rows.append(_row(equation.form.terms, scheme, lowest, fields, coefficients, resolvent))
        except ParameterError as error:
            where = Where(scheme.path or scheme.name, equation.line, equation.column)
            raise _placed(error, where, f"{error.message} in {quoted(equation.text)}") from None
    return rows + _unread(scheme, lowest, fields, coefficients)


def _placed(error: ParameterError, where: Where, message: str) -> ParameterError:
    """The error of a formula that has no value, with the place of the formula."""
    return ParameterError(message, where=where, path=error.path, expected=error.expected, mend=error.mend)


def _row(
    terms: Sequence[tuple[GridValue, Expr]], scheme: Scheme, lowest: Mapping[str, int], fields: Sequence[Field],
    coefficients: Coefficients, resolvent: Resolvent,
) -> tuple[Term, ...]:  # fmt: skip
    base = min(value.level for value, _ in terms)
    entries: dict[tuple[int, int], Ratio] = {}
    for value, coefficient in terms:
        half_line = scheme.half_line(value.domain)
        n = mirrored(half_line, value.index) - lowest[value.domain]
        weight = coefficients.evaluate(coefficient) * resolvent.power(coefficients, value.level - base)
        if value.derivative:
            weight = weight * resolvent.of(value.domain)
        component = half_line.unknowns.index(value.unknown)
        for k, field in enumerate(fields):
            if field.domain != value.domain:
                continue
            for place, factor in field.share(component, n, half_line.first - lowest[value.domain]):
                share = weight * factor
                entries[k, place] = entries[k, place] + share if (k, place) in entries else share
    return _cleared(entries, coefficients)


def _cleared(entries: Mapping[tuple[int, int], Ratio], coefficients: Coefficients) -> tuple[Term, ...]:
    live = {key: value for key, value in entries.items() if not value.is_zero()}
    clear = common_denominator(list(live.values()), coefficients.context.constant(1))
    return tuple(Term(k, n, value.num * (clear / value.den)) for (k, n), value in sorted(live.items()))


def _unread(
    scheme: Scheme, lowest: Mapping[str, int], fields: Sequence[Field], coefficients: Coefficients
) -> list[tuple[Term, ...]]:
    """Pins the grid points that only the common indexing of a half-line's unknowns brings in: nothing reads them."""
    rows = []
    known = {(v.domain, v.unknown, v.index) for v in scheme.boundary_unknowns}
    for half_line in scheme.domains:
        ghosts = half_line.first - lowest[half_line.name]
        for n in range(ghosts):
            index = mirrored(half_line, n + lowest[half_line.name])
            for component, unknown in enumerate(half_line.unknowns):
                if (half_line.name, unknown, index) in known:
                    continue
                entries = {
                    (k, place): factor
                    for k, field in enumerate(fields)
                    if field.domain == half_line.name
                    for place, factor in field.share(component, n, ghosts)
                }
                rows.append(_cleared(entries, coefficients))
    return rows


# The Newton basis -----------------------------------------------------------------------------------------------------


def newton_columns(roots: Sequence[N], count: int, zero: N, one: N) -> list[list[N]]:
    """``columns[j][n] = [kappa_1, ..., kappa_{j+1}] x**n`` for n < count.

    The divided differences of powers are the complete homogeneous polynomials, by the recurrence
    c_j[n] = c_{j-1}[n-1] + kappa_j c_j[n-1] with c_{-1}[n] = 1 at n = -1 only.
    """
    columns: list[list[N]] = []
    previous: list[N] = [zero] * count
    for j, root in enumerate(roots):
        column: list[N] = []
        for n in range(count):
            if j == 0:
                value = one if n == 0 else root * column[n - 1]
            else:
                value = zero if n == 0 else previous[n - 1] + root * column[n - 1]
            column.append(value)
        columns.append(column)
        previous = column
    return columns


def longest(rows: Sequence[Sequence[Term]], block: int) -> int:
    """One more than the highest index at which the closure reads the field of a block."""
    return 1 + max((term.n for row in rows for term in row if term.block == block), default=-1)


def kreiss_matrix(
    rows: Sequence[Sequence[Term]],
    columns: Sequence[Sequence[Sequence[N]]],
    coefficient: Callable[[fmpz_mpoly], N],
    zero: N,
) -> list[list[N]]:
    """Closure rows applied to the columns of every block: ``columns[block][j][n]``."""
    matrix: list[list[N]] = []
    for row in rows:
        line: list[N] = []
        for k, block in enumerate(columns):
            mine = [(term.n, coefficient(term.coefficient)) for term in row if term.block == k]
            for column in block:
                entry = zero
                for n, value in mine:
                    entry = entry + value * column[n]
                line.append(entry)
        matrix.append(line)
    return matrix


def closure_matrix(
    problem: NormalModeProblem, point: Mapping[str, Root], roots: Sequence[Sequence[Enclosed]], bits: int
) -> list[list[acb]]:
    """The Kreiss matrix in balls at the working precision; each block's columns in the order of its roots."""
    at = {name: root.ball(bits) for name, root in point.items()}
    return kreiss_matrix_at(problem, at, [[r.ball(bits) for r in mine] for mine in roots])


def kreiss_matrix_at(
    problem: NormalModeProblem, at: Mapping[str, acb], roots: Sequence[Sequence[acb]]
) -> list[list[acb]]:
    """The same with the point and the roots as balls."""
    columns = [newton_columns(mine, longest(problem.rows, k), acb(0), acb(1)) for k, mine in enumerate(roots)]
    return kreiss_matrix(problem.rows, columns, lambda c: at_balls(c, at), acb(0))
