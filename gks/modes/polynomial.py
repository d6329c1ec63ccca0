"""The exact route: elimination of the spatial roots to the characteristic polynomial.

Delta(sigma) = 0 with P(sigma, kappa_j) = 0 is an algebraic system. The determinant is written with one variable for
each spatial root that a family has to carry: its decaying roots, or its growing ones where they are fewer (then the
decaying factor of P is the quotient by the others). The variables are eliminated by resultants with the divided
differences P[k_1], P[k_1, k_2], ..., the last first, which gives the product of Delta over all ways to choose the
roots: a polynomial N(sigma) that has every zero of Delta among its roots, and more. Which of them belong to decaying
solutions is not for this module to say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial, prod

from flint import fmpz_mpoly

from gks.errors import NotAnalysable
from gks.modes.coefficients import KAPPA_VARIABLES, Coefficients
from gks.modes.determinant import determinant
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import Family, NormalModeProblem, kreiss_matrix, longest, newton_columns
from gks.modes.route import beyond_elimination

ELIMINATION_SIZE = 32
"""Closure equations, those that pin unread points included, up to which a determinant of polynomials is taken."""


class TooWide(NotAnalysable):
    """The elimination would carry too many spatial roots."""


class Degenerate(ArithmeticError):
    """Delta vanishes for every value of the resolvent variable on some sheet, so that the norm is zero."""


@dataclass(frozen=True, slots=True)
class Factor:
    """An irreducible factor of the characteristic polynomial, with its multiplicity there.

    Delta is a product of parts that each depend on the roots of some families; ``sheets`` are the sets of families of
    the parts whose norm has the factor: at each of its zeros that part vanishes for some choice of their roots.
    """

    polynomial: fmpz_mpoly
    multiplicity: int
    sheets: tuple[frozenset[int], ...] = ()


@dataclass(frozen=True, slots=True)
class _Carrier:
    """How the determinant writes a family's decaying factor: the variables, and the relations they satisfy."""

    variables: tuple[str, ...]
    relations: tuple[fmpz_mpoly, ...]
    monic: tuple[fmpz_mpoly, ...] | None
    """The quotient P / prod(x - k_j), ascending, where the variables are the growing roots."""


@dataclass(frozen=True, slots=True)
class Elimination:
    """The irreducible factors of the norm of Delta in sigma and the symbolic parameters.

    ``lost_sheet`` says that Delta vanishes identically on some component of the sheets, which was divided out: the
    caller has to make sure that it is not the component of the decaying roots. ``clearing`` are factors of leading
    coefficients that cleared a quotient's denominators: Delta need not vanish at their zeros, and may. ``idle`` are
    factors without sigma: where one vanishes, so may Delta for every sigma.
    """

    factors: tuple[Factor, ...]
    lost_sheet: bool
    clearing: tuple[Factor, ...] = ()
    idle: tuple[fmpz_mpoly, ...] = ()


def characteristic_factors(problem: NormalModeProblem) -> Elimination:
    """Eliminates the spatial roots.

    Delta is split into parts that depend on the roots of some families alone, so that the norm does not count the zeros
    of one part once for every choice that another has: what every sheet shares, what two half-lines that the closure
    does not tie have by themselves.
    Raises TooWide, and Degenerate where the determinant is zero as a formula.
    """
    if problem.size > ELIMINATION_SIZE:
        raise TooWide(f"the closure has {problem.size} unknowns (limit of the elimination {ELIMINATION_SIZE})")
    if beyond_elimination(problem):
        raise TooWide("the scheme is too wide for the elimination: too many choices of spatial roots")
    carriers = _carriers(problem)
    delta = symbolic_determinant(problem, carriers)
    if delta.is_zero():
        raise Degenerate
    parts, lost = [], False
    for part, families in _separated(delta, carriers):
        mine = [carriers[k] for k in sorted(families)]
        norm = _norm(part, mine)
        if norm.is_zero():
            lost, norm = True, _norm_of_the_rest(part, mine)
        parts.append(_Part(norm, prod(factorial(len(carrier.variables)) for carrier in mine), families))
    leads = [carrier.monic[-1] for carrier in carriers if carrier.monic is not None]
    return _sorted_out(problem, parts, leads, lost)


@dataclass(frozen=True, slots=True)
class _Part:
    """The norm of a part of Delta, which counts every zero ``repeats`` times, and the families whose roots it has."""

    norm: fmpz_mpoly
    repeats: int
    families: frozenset[int]


def _separated(delta: fmpz_mpoly, carriers: Sequence[_Carrier]) -> list[tuple[fmpz_mpoly, frozenset[int]]]:
    """Factors of Delta, each with the families whose variables it holds."""
    parts = [delta]
    for carrier in carriers:
        split = []
        for part in parts:
            free = _free_of(part, carrier.variables)
            split += [each for each in (free, part / free) if not each.is_constant()]
        parts = split
    found: dict[frozenset[int], fmpz_mpoly] = {}
    for part in parts:
        families = frozenset(k for k, c in enumerate(carriers) if _holds(part, c.variables))
        found[families] = found[families] * part if families in found else part
    return [(part, families) for families, part in found.items()]


def _holds(polynomial: fmpz_mpoly, variables: Sequence[str]) -> bool:
    names = polynomial.context().names()
    degrees = polynomial.degrees()
    return any(degrees[names.index(name)] for name in variables)


def _free_of(polynomial: fmpz_mpoly, variables: Sequence[str]) -> fmpz_mpoly:
    """The largest factor that holds none of the variables (1 where only a number does)."""
    parts = [polynomial]
    for name in variables:
        parts = [part for each in parts for part in powers_of(each, name) if not part.is_zero()]
    common = polynomial.context().constant(0)
    if len(parts) == 1:
        return polynomial
    for part in sorted(parts, key=len):
        common = common.gcd(part)
        if common.is_constant():
            return polynomial.context().constant(1)
    return common


def _carried(family: Family) -> int:
    """How many of a family's roots become variables: the decaying ones, or the growing ones where they are fewer.

    A lone root is a variable too: its resultant clears just the denominators that the determinant has.
    """
    if family.degree == family.decaying == 1:
        return 1
    return min(family.decaying, family.degree - family.decaying)


def _carriers(problem: NormalModeProblem) -> list[_Carrier]:
    carriers: list[_Carrier] = []
    used = 0
    for family in problem.families:
        few = _carried(family)
        if used + few > KAPPA_VARIABLES:
            raise TooWide(f"the elimination would carry more than {KAPPA_VARIABLES} spatial roots")
        names = tuple(f"k{used + j}" for j in range(few))
        used += few
        carriers.append(_carrier(problem.coefficients, family, names, few < family.decaying))
    return carriers


def _carrier(coefficients: Coefficients, family: Family, names: tuple[str, ...], growing: bool) -> _Carrier:
    rest = powers_of(family.part, "x")
    relations = []
    for name in names:
        rest, remainder = _horner(rest, coefficients.gens[name])
        relations.append(remainder)
    return _Carrier(names, tuple(relations), tuple(rest) if growing else None)


def _horner(powers: Sequence[fmpz_mpoly], root: fmpz_mpoly) -> tuple[list[fmpz_mpoly], fmpz_mpoly]:
    """Quotient and remainder of a polynomial in x by x - root."""
    quotient: list[fmpz_mpoly] = []
    value = powers[-1]
    for power in reversed(powers[:-1]):
        quotient.append(value)
        value = power + root * value
    return quotient[::-1], value


def symbolic_determinant(problem: NormalModeProblem, carriers: Sequence[_Carrier] | None = None) -> fmpz_mpoly:
    """Delta as a polynomial in sigma, the parameters and the spatial roots carried."""
    carriers = carriers if carriers is not None else _carriers(problem)
    coefficients = problem.coefficients
    zero, one = coefficients.context.constant(0), coefficients.context.constant(1)
    columns = []
    for index, block in enumerate(problem.blocks):
        count = longest(problem.rows, index)
        carrier = carriers[block.family]
        if carrier.monic is None:
            roots = [zero] * block.zeros + [coefficients.gens[name] for name in carrier.variables]
            columns.append(newton_columns(roots, count, zero, one))
        else:
            columns.append(_ghost_columns([zero] * block.zeros + list(carrier.monic), count, zero, one))
    matrix = kreiss_matrix(problem.rows, columns, lambda c: c, zero)
    return determinant(matrix, one)


def _ghost_columns(
    factor: Sequence[fmpz_mpoly], count: int, zero: fmpz_mpoly, one: fmpz_mpoly
) -> list[list[fmpz_mpoly]]:
    """v_n as a function of v_0, ..., v_{d-1} from the recurrence with the given factor, times a power of its lead.

    x**n modulo the factor, every column times lead**(count - d) so that no denominator appears.
    """
    width = len(factor) - 1
    lead = factor[-1]
    spare = max(count - width, 0)
    remainder = [one if j == 0 else zero for j in range(width)]
    scaled: list[list[fmpz_mpoly]] = []
    used = 0
    for n in range(count):
        if n >= width:
            used += 1
        scaled.append([value * lead ** (spare - used) for value in remainder])
        top = remainder[-1] if width else zero
        if n + 1 < width:
            remainder = [zero, *remainder[:-1]]
        else:
            shifted = [zero, *remainder[:-1]]
            remainder = [a * lead - top * b for a, b in zip(shifted, factor[:-1], strict=True)]
    return [[scaled[n][j] for n in range(count)] for j in range(width)]


def _norm(delta: fmpz_mpoly, carriers: Sequence[_Carrier]) -> fmpz_mpoly:
    """The product over all sheets, up to factors that clear denominators."""
    for carrier in carriers:
        for variable, relation in reversed(list(zip(carrier.variables, carrier.relations, strict=True))):
            if delta.is_zero():
                return delta
            _, delta = delta.primitive()
            delta = delta.resultant(relation, variable)
    return delta


def _norm_of_the_rest(delta: fmpz_mpoly, carriers: Sequence[_Carrier]) -> fmpz_mpoly:
    """The product over the sheets on which Delta does not vanish identically.

    It is the lowest coefficient in t of the product of Delta + t over all sheets: those that vanish give t. (A common
    factor of the norm so far and the next relation would not do: a sheet that is lost may be tied to one that is not,
    as k_2 = 1/k_1 beside k_2 = -k_1.)
    """
    used = {name for carrier in carriers for name in carrier.variables}
    t = next((name for k in range(KAPPA_VARIABLES) if (name := f"k{k}") not in used), None)
    if t is None:
        raise TooWide(f"the elimination would carry more than {KAPPA_VARIABLES - 1} spatial roots beside a lost one")
    context = delta.context()
    norm = _norm(delta + context.gen(context.variable_to_index(t)), carriers)
    return next(part for part in powers_of(norm, t) if not part.is_zero())


def _sorted_out(
    problem: NormalModeProblem, parts: Sequence[_Part], leads: Sequence[fmpz_mpoly], lost: bool
) -> Elimination:
    """The factors of the parts, each of which counts every zero of Delta so many times."""
    sigma = problem.coefficients.context.names().index(problem.variable)
    foreign = [f for lead in leads if (f := problem.coefficients.norm(lead)).degrees()[sigma]]
    found: dict[str, Factor] = {}
    idle: dict[str, fmpz_mpoly] = {}
    for part in parts:
        norm = problem.coefficients.norm(part.norm)
        if norm.is_zero():
            raise Degenerate
        for polynomial, power in irreducible_factors(norm):
            if not polynomial.degrees()[sigma]:
                idle[str(polynomial)] = polynomial
                continue
            known = found.get(str(polynomial))
            multiplicity = max(1, power // part.repeats) + (known.multiplicity if known else 0)
            sheets = (*(known.sheets if known else ()), part.families)
            found[str(polynomial)] = Factor(polynomial, multiplicity, () if lost else sheets)
    own: list[Factor] = []
    clearing: list[Factor] = []
    for factor in found.values():
        clears = any(divmod(f, factor.polynomial)[1].is_zero() for f in foreign)
        (clearing if clears else own).append(factor)
    return Elimination(tuple(own), lost, tuple(clearing), tuple(idle.values()))
