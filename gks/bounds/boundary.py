"""Curves in the plane of one parameter p and lam, off which the verdict of a scheme cannot change.

With both symbolic, every reason for which a verdict changes is a polynomial in (p, lam):

- a normal mode reaches the unit circle, or comes in from infinity (``modes.critical``);
- the spatial roots of a mode on the circle meet the circle or each other, so that what was inadmissible may become
  admissible: the resultant of a growth factor with the loci where that happens to the interior's symbol;
- the interior's own picture on abs(kappa) = 1 changes (the curves of ``modes.cauchy_set``, with p as one more
  variable);
- a formula divides by zero, or a wave speed vanishes.

Off the zeros of all of them roots and their spatial parts move continuously without meeting the circle, so the verdict
is locally constant. What holds on the curves themselves is not said here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import combinations

from flint import Ordering, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from gks.errors import InputError, NotAnalysable
from gks.modes.algebraic import primitive
from gks.modes.amplification import under_multistep
from gks.modes.cauchy import Factors, cuts_of, degree_in, factored, reciprocal_in
from gks.modes.cauchy_set import in_cosine
from gks.modes.coefficients import Coefficients, Ratio
from gks.modes.critical import boundary_polynomials, growth_factors
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import coefficients as powers_of
from gks.modes.fibre import norm, specialise, univariate
from gks.modes.interior import amplification, field_symbol
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.polynomial import Degenerate, characteristic_factors
from gks.modes.solvable import degenerate_closure
from gks.scheme.expression import Expr
from gks.scheme.model import Scheme, WrittenDiscrete, WrittenLines

PLANE = fmpz_mpoly_ctx.get(("p", "lam"), Ordering.lex)
"""The context of boundary curves: the parameter and the CFL number, whatever the file calls them."""


@dataclass(frozen=True, slots=True)
class Boundary:
    """``curves``: irreducible polynomials that hold lam; ``walls``: irreducible polynomials in p alone."""

    curves: tuple[fmpz_mpoly, ...]
    walls: tuple[fmpz_poly, ...]


def boundary(scheme: Scheme, values: Mapping[str, Fraction], parameter: str) -> Boundary:
    """The curves of a scheme in the plane of ``parameter`` and lam; ``values`` gives each of the two a sample.

    The sample settles the signs of wave speeds: the curves hold where these signs do. NotAnalysable where a square root
    of a free parameter remains; what the elimination raises.
    """
    symbols = (parameter, scheme.cfl)
    try:
        problem = _in_z(normal_mode_problem(scheme, values, symbols))
    except (InputError, ValueError):  # counting roots fails at a formula whose root is no rational function
        if _takes_root(scheme, Coefficients(values, symbols)):
            raise NotAnalysable(f"a square root of {parameter} or {scheme.cfl} is in the equations") from None
        raise
    if _holds_root(problem):
        raise NotAnalysable(f"a square root of {parameter} or {scheme.cfl} remains in the equations")
    found = [*_closure(problem), *_interior(problem), *_poles(scheme, problem.coefficients), *_speeds(problem)]
    return _sorted(_in_plane(problem, parameter, each) for each in found)


def _takes_root(scheme: Scheme, coefficients: Coefficients) -> bool:
    for expression in _expressions(scheme):
        expression.fold(coefficients)
    return any(generator.root is None for generator in coefficients.generators)


def _holds_root(problem: NormalModeProblem) -> bool:
    names = [generator.name for generator in problem.coefficients.generators if generator.root is None]
    polynomials = [f.polynomial for f in problem.families] + [t.coefficient for row in problem.rows for t in row]
    return any(degree_in(polynomial, name) for polynomial in polynomials for name in names)


def _in_z(problem: NormalModeProblem) -> NormalModeProblem:
    """With exact time the Cayley map z = (1 + s)/(1 - s) puts the half-planes of s in the place of the disk's two
    sides.
    """
    method = problem.resolvent.integrator
    if method is None or method.kind != "exact":
        return problem
    s, z = (problem.coefficients.gens[name] for name in ("s", "z"))
    return replace(problem, time_map=s * (z + 1) - (z - 1))


def _sorted(polynomials: Iterable[fmpz_mpoly]) -> Boundary:
    curves: dict[str, fmpz_mpoly] = {}
    walls: dict[str, fmpz_poly] = {}
    for polynomial in polynomials:
        for factor, _ in irreducible_factors(polynomial):
            if not degree_in(factor, "lam"):
                wall = primitive(univariate(factor, "p"))
                walls.setdefault(str(wall), wall)
            elif factor != PLANE.gens()[1]:
                curve = factor if factor.leading_coefficient() > 0 else -factor
                curves.setdefault(str(curve), curve)
    return Boundary(tuple(curves.values()), tuple(walls.values()))


def _in_plane(problem: NormalModeProblem, parameter: str, polynomial: fmpz_mpoly) -> fmpz_mpoly:
    polynomial = problem.coefficients.norm(polynomial)
    names = polynomial.context().names()
    p, lam = (names.index(problem.coefficients.variable(n)) for n in (parameter, problem.resolvent.cfl))
    terms: dict[tuple[int, ...], int] = {}
    for powers, coefficient in polynomial.to_dict().items():
        if any(power for k, power in enumerate(powers) if k not in (p, lam)):
            raise ValueError(f"a boundary polynomial holds more than {parameter} and lam: {polynomial}")
        terms[powers[p], powers[lam]] = int(coefficient)
    return PLANE.from_dict(terms)


def _closure(problem: NormalModeProblem) -> Iterator[fmpz_mpoly]:
    try:
        elimination = characteristic_factors(problem)
    except Degenerate:
        raise degenerate_closure(problem) from None
    yield from elimination.idle
    factors = growth_factors(problem, [*elimination.factors, *elimination.clearing])
    yield from boundary_polynomials(problem, factors)
    for locus in _unimodular_loci(problem):
        yield from _at_ends(locus, "z")
        for factor in factors:
            if locus != factor:
                yield factor.resultant(locus, "z")


def _unimodular_loci(problem: NormalModeProblem) -> list[fmpz_mpoly]:
    """Where a unimodular z has a unimodular spatial root; of nondissipative factors, where two of these meet.

    Dissipative factors have such a pair at z = 1 or -1, where the growth factors have curves of their own. An
    irreducible locus that has a unimodular z over an open set of (p, lam) is its own reciprocal; others meet the
    circle on the interior's curves.
    """
    loci: list[fmpz_mpoly] = []
    for family in problem.families:
        symbol = family.polynomial
        if not degree_in(symbol, "x"):
            continue
        if problem.time_map is not None:
            symbol = symbol.resultant(problem.time_map, "s")
        factors = factored(symbol, problem.coefficients.point(), z="z", kappa="x")
        neutral = [f for f, _ in factors.powers if reciprocal_in(f, ("z", "x")) in (f, -f)]
        loci += [f.discriminant("x") for f in neutral if degree_in(f, "x") > 1]
        loci += [one.resultant(other, "x") for one, other in combinations(neutral, 2) if degree_in(one, "x")]
        damped = [f for f, _ in factors.powers if f not in neutral]
        loci += [f.resultant(spot, "x") for spot in _touching(factors) for f in damped]
    moving = (norm(problem.coefficients.point(), locus) for locus in loci if not locus.is_zero())
    return [
        g
        for g in _irreducible(moving)
        if g.total_degree() > 1 and reciprocal_in(g, ("z",)) in (g, -g) and degree_in(g, "z")
    ]


def _touching(factors: Factors) -> Iterator[fmpz_mpoly]:
    """The unimodular x at which a Cauchy-stable scheme may have a unimodular z over an open set of (p, lam).

    The modulus of z touches 1 there from below: as a function of x + 1/x the resultant of the symbol with its mirror
    image has a zero of even order, but for x = 1 and -1.
    """
    for cut in cuts_of(factors):
        for spot, order in irreducible_factors(norm(factors.point, cut)) if not cut.is_zero() else ():
            degree = degree_in(spot, "x")
            if degree and (order > 1 or spot.total_degree() == 1) and reciprocal_in(spot, ("x",)) in (spot, -spot):
                yield spot


# The interior -------------------------------------------------------------------------------------------------------


def _interior(problem: NormalModeProblem) -> Iterator[fmpz_mpoly]:
    seen: dict[str, fmpz_mpoly] = {}
    for block in problem.blocks:
        symbol = field_symbol(block.field, problem.coefficients)
        seen.setdefault(str(symbol), symbol)
    method = problem.resolvent.integrator
    for symbol in seen.values():
        if method is not None and method.kind == "exact":
            one = problem.coefficients.context.constant(1)
            growth = under_multistep(symbol, fmpz_poly([-1, 1]), fmpz_poly([1, 1]), lam=one)
        else:
            growth = amplification(symbol, problem.coefficients, problem.resolvent)
        yield from interior_curves(factored(growth, problem.coefficients.point(), z="z", kappa="x"))


def interior_curves(factors: Factors) -> Iterator[fmpz_mpoly]:
    """``cauchy_set``'s critical polynomials with the remaining symbols left in them; see there for why these."""
    kappa = factors.kappa
    yield from (norm(factors.point, factor) for factor in factors.idle)
    crossing: list[fmpz_mpoly] = []
    for curve in _irreducible(norm(factors.point, cut) for cut in cuts_of(factors)):
        if not degree_in(curve, kappa):
            yield curve
            continue
        yield from _at_ends(curve, kappa)
        if _palindromic(curve, kappa):
            cosine = in_cosine(curve, kappa)
            crossing.append(cosine)
            yield cosine.discriminant(kappa)
        elif degree_in(curve, kappa) > 1 or len(curve) > 2:
            yield curve.resultant(reciprocal_in(curve, (kappa,)), kappa)
    for one, other in combinations(crossing, 2):
        yield one.resultant(other, kappa)
    for locus in _irreducible(norm(factors.point, locus) for locus in _double_loci(factors)):
        yield from _at_ends(locus, kappa)
        if _palindromic(locus, kappa):
            locus = in_cosine(locus, kappa)
            yield from (curve.resultant(locus, kappa) for curve in crossing if curve != locus)
        elif degree_in(locus, kappa) > 1:
            yield locus.resultant(reciprocal_in(locus, (kappa,)), kappa)


def _double_loci(factors: Factors) -> Iterator[fmpz_mpoly]:
    moving = [factor for factor, _ in factors.powers if degree_in(factor, factors.z)]
    yield from (factor.discriminant(factors.z) for factor in moving if degree_in(factor, factors.z) > 1)
    yield from (one.resultant(other, factors.z) for one, other in combinations(moving, 2))


def _irreducible(polynomials: Iterable[fmpz_mpoly]) -> list[fmpz_mpoly]:
    found: dict[str, fmpz_mpoly] = {}
    for polynomial in polynomials:
        for factor, _ in irreducible_factors(polynomial) if not polynomial.is_zero() else ():
            found.setdefault(str(factor), factor)
    return list(found.values())


def _palindromic(curve: fmpz_mpoly, kappa: str) -> bool:
    degree = degree_in(curve, kappa)
    return degree > 0 and degree % 2 == 0 and reciprocal_in(curve, (kappa,)) == curve


def _at_ends(curve: fmpz_mpoly, kappa: str) -> Iterator[fmpz_mpoly]:
    for end in (1, -1):
        value = specialise(curve, {kappa: Fraction(end)})
        if not value.is_zero():
            yield value


# The formulas -------------------------------------------------------------------------------------------------------


class _Divisors:
    """The coefficient algebra, with a record of everything that is divided by."""

    def __init__(self, coefficients: Coefficients) -> None:
        self.coefficients = coefficients
        self.found: list[fmpz_mpoly] = []
        self.number, self.symbol = coefficients.number, coefficients.symbol
        self.add, self.mul, self.sqrt = coefficients.add, coefficients.mul, coefficients.sqrt

    def power(self, base: Ratio, exponent: int) -> Ratio:
        if exponent < 0:
            self.found.append(base.num)
        return self.coefficients.power(base, exponent)


def _poles(scheme: Scheme, coefficients: Coefficients) -> Iterator[fmpz_mpoly]:
    recorder = _Divisors(coefficients)
    for expression in _expressions(scheme):
        expression.fold(recorder)
    yield from recorder.found


def _expressions(scheme: Scheme) -> Iterator[Expr]:
    for half_line in scheme.domains:
        for row in half_line.flux or ():
            yield from row
        if isinstance(half_line.interior, WrittenDiscrete | WrittenLines):
            for form in half_line.interior.equations:
                yield from (coefficient for _, coefficient in form.terms)
    for equation in scheme.closure.equations:
        yield from (coefficient for _, coefficient in equation.form.terms)


def _speeds(problem: NormalModeProblem) -> Iterator[fmpz_mpoly]:
    for block in problem.blocks:
        if block.field.speed is not None and not block.field.speed.is_zero():
            yield block.field.speed.num
            yield block.field.speed.den


def curve_at(curve: fmpz_mpoly, p: Fraction) -> fmpz_poly:
    """A curve over a rational p, as a polynomial in lam (up to a positive factor)."""
    return univariate(specialise(curve, {"p": p}), "lam")


def in_parameter(curve: fmpz_mpoly) -> Sequence[fmpz_poly]:
    """The coefficients of lam**0, lam**1, ... as polynomials in p."""
    return [univariate(part, "p") for part in powers_of(curve, "lam")]
