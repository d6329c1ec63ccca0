"""Where the verdict may change as lam runs, at fixed values of the other parameters.

With lam a symbol, elimination gives the characteristic polynomial F(z, lam), a product of irreducible factors f. As lam
moves, a root z can reach the unit circle only at a lam where

- f(1) = 0 or f(-1) = 0, or two roots z and 1/z meet (a conjugate pair on the circle): f and its reciprocal f* share a
  root. Both f + f* and f - f* are, up to factors z - 1 and z + 1, polynomials in x = z + 1/z, and the resultant of
  these two is half the degree of that of f and f*;
- the leading coefficient vanishes (a root comes in from infinity).

A factor with f = f* has roots on the circle for whole intervals of lam; they leave it, or change character, only where
two meet (the discriminant in x), at z = 1 or -1, or where the spatial roots at such a z meet each other or the circle.
The interior adds its own critical values. All of these together are finitely many algebraic numbers; which of them
matter is decided by exact verdicts at and between them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpz_mpoly, fmpz_poly

from gks.modes.algebraic import Root, isolated_roots, primitive
from gks.modes.cauchy import degree_in, reciprocal_in
from gks.modes.cauchy_set import in_cosine
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import coefficients as powers_of
from gks.modes.fibre import specialise, univariate
from gks.modes.kreiss import NormalModeProblem
from gks.modes.polynomial import Degenerate, Factor, TooWide, characteristic_factors
from gks.modes.solvable import degenerate_closure

MAPPED_DEGREE = 40
"""Degree in lam up to which z is followed as an algebraic function: beyond it the resultants take minutes."""


@dataclass(frozen=True, slots=True)
class Events:
    """Where anything can change for the modes that one factor of the norm stands for."""

    factor: Factor
    polynomials: tuple[fmpz_poly, ...]


@dataclass(frozen=True, slots=True)
class LamElimination:
    """A problem with lam as its one symbol, eliminated: integer polynomials in lam whose positive roots are critical.

    ``lost`` are those at whose roots the closure is degenerate or the scheme has no value: no verdict speaks for both
    sides. ``lost_sheet`` is the elimination's.
    """

    problem: NormalModeProblem
    events: tuple[Events, ...]
    lost: tuple[fmpz_poly, ...]
    lost_sheet: bool

    def polynomials(self) -> Iterator[fmpz_poly]:
        """All of them."""
        yield from self.lost
        for each in self.events:
            yield from each.polynomials


def lam_elimination(problem: NormalModeProblem) -> LamElimination:
    """Eliminates; SchemeError for a determinant that is zero as a formula, else what ``characteristic_factors``
    raises.
    """
    try:
        elimination = characteristic_factors(problem)
    except Degenerate:
        raise degenerate_closure(problem) from None
    lost = [*elimination.idle, *map(problem.coefficients.norm, problem.coefficients.inverted.values())]
    events = [
        Events(factor, _in_lam(problem, boundary_polynomials(problem, growth_factors(problem, [factor]))))
        for factor in (*elimination.factors, *elimination.clearing)
    ]
    return LamElimination(problem, tuple(events), _in_lam(problem, lost), elimination.lost_sheet)


def _in_lam(problem: NormalModeProblem, polynomials: Iterable[fmpz_mpoly]) -> tuple[fmpz_poly, ...]:
    """Those that hold lam, dense."""
    lam = problem.coefficients.variable(problem.resolvent.cfl)
    return tuple(univariate(each, lam) for each in polynomials if degree_in(each, lam))


def boundary_polynomials(problem: NormalModeProblem, factors: Iterable[fmpz_mpoly]) -> Iterator[fmpz_mpoly]:
    """Nonzero polynomials in the symbols of ``problem``; off their zeros no root of a growth factor meets the circle.

    Constants among them say nothing.
    """
    for factor in factors:
        for polynomial in _critical(problem, factor):
            rest = problem.coefficients.norm(polynomial)
            if not rest.is_zero():
                yield rest


def growth_factors(problem: NormalModeProblem, factors: Iterable[Factor]) -> list[fmpz_mpoly]:
    """The irreducible factors of F(z, lam): those in z as they are, those in s mapped by the integrator."""
    found: dict[str, fmpz_mpoly] = {}
    for factor in factors:
        mapped = [factor.polynomial]
        if problem.time_map is not None:
            if degree_in(factor.polynomial, "s") * degree_in(problem.time_map, "s") > MAPPED_DEGREE:
                raise TooWide("the modes s are too many to be followed in lam through this integrator")
            mapped = [g for g, _ in irreducible_factors(factor.polynomial.resultant(problem.time_map, "s"))]
        for polynomial in mapped:
            if degree_in(polynomial, "z") or degree_in(polynomial, "s"):
                found.setdefault(str(polynomial), polynomial)
    return list(found.values())


def _critical(problem: NormalModeProblem, f: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    variable = "s" if degree_in(f, "s") else "z"
    yield powers_of(f, variable)[-1]
    if variable == "s":
        # The semi-discrete problem: roots meet the imaginary axis.
        yield from _on_axis(f)
        return
    for end in (1, -1):
        yield specialise(f, {"z": Fraction(end)})
    mirrored = reciprocal_in(f, ("z",))
    if f in (mirrored, -mirrored):
        yield from _on_circle(problem, f)
        return
    symmetric, skew = _cosine(f + mirrored), _cosine(f - mirrored)
    yield symmetric.resultant(skew, "z") if degree_in(symmetric, "z") or degree_in(skew, "z") else symmetric
    for part in (symmetric, skew):
        if not degree_in(part, "z"):
            yield part


def _cosine(polynomial: fmpz_mpoly) -> fmpz_mpoly:
    """A polynomial that equals plus or minus its reciprocal, without its factors z - 1 and z + 1, in x = z + 1/z."""
    context = polynomial.context()
    z = context.gen(context.variable_to_index("z"))
    for factor in (z, z - 1, z + 1):
        quotient, remainder = divmod(polynomial, factor)
        while remainder.is_zero():
            polynomial = quotient
            quotient, remainder = divmod(polynomial, factor)
    return in_cosine(polynomial, "z")


def _on_circle(problem: NormalModeProblem, f: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    """A factor whose roots may stay on the circle."""
    cosine = _cosine(f)
    if degree_in(cosine, "z"):
        yield cosine.discriminant("z")
        for end in (2, -2):
            yield specialise(cosine, {"z": Fraction(end)})
    for family in problem.families:
        if degree_in(family.polynomial, "x"):
            yield from _spatial_events(problem, f, family.polynomial)


def _spatial_events(problem: NormalModeProblem, f: fmpz_mpoly, symbol: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    """Where a spatial root at a zero of f meets the circle or another one.

    For f of low degree the spatial roots themselves are eliminated to: the factors h of Res_z(f, P) in x. Otherwise the
    points (z, lam) at which any spatial root meets the circle or another one are, and then those on f.
    """
    if degree_in(f, "z") <= FEW_ROOTS:
        yield from _events_along(_at_roots(problem, f, symbol))
        return
    if problem.time_map is not None:
        symbol = symbol.resultant(problem.time_map, "s")
    mirrored = reciprocal_in(symbol, ("z", "x"))
    for locus in (symbol.resultant(mirrored, "x"), symbol.discriminant("x")):
        for curve, _ in irreducible_factors(locus) if not locus.is_zero() else ():
            if degree_in(curve, "z") and curve != f:
                yield f.resultant(curve, "z")


FEW_ROOTS = 2
"""Degree of f in z up to which the spatial roots over all its zeros are cheap to have in one polynomial."""


def _at_roots(problem: NormalModeProblem, f: fmpz_mpoly, symbol: fmpz_mpoly) -> fmpz_mpoly:
    """The polynomial in x of the spatial roots over the zeros of f, and of their images under inversion."""
    if problem.time_map is not None:
        # f in z alone stands for the s that the integrator maps there.
        symbol = symbol.resultant(f.resultant(problem.time_map, "z"), "s")
    elif degree_in(symbol, "z"):
        symbol = symbol.resultant(f, "z")
    return symbol


def _events_along(spatial: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    """Where roots of the factors in x meet each other or the circle."""
    if spatial.is_zero():
        return
    factors = [h for h, _ in irreducible_factors(spatial) if degree_in(h, "x")]
    for k, h in enumerate(factors):
        yield powers_of(h, "x")[-1]
        yield powers_of(h, "x")[0]
        mirrored = reciprocal_in(h, ("x",))
        yield h.discriminant("x") if h in (mirrored, -mirrored) else h.resultant(mirrored, "x")
        for end in (1, -1):
            yield specialise(h, {"x": Fraction(end)})
        for other in factors[:k]:
            yield h.resultant(other, "x")


def _on_axis(f: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    """Even and odd parts in s share a root where a pair is on the imaginary axis (or s and -s are both roots)."""
    context = f.context()
    s = context.gen(context.variable_to_index("s"))
    parts = powers_of(f, "s")
    even = sum((c * s ** (k // 2) for k, c in enumerate(parts) if k % 2 == 0), context.constant(0))
    odd = sum((c * s ** (k // 2) for k, c in enumerate(parts) if k % 2), context.constant(0))
    yield parts[0]
    if not even.is_zero() and not odd.is_zero() and (degree_in(even, "s") or degree_in(odd, "s")):
        yield even.resultant(odd, "s")


def positive_roots(polynomials: Iterable[fmpz_poly]) -> list[Root]:
    """The distinct positive real roots, in no order."""
    known: dict[tuple[int, ...], fmpz_poly] = {}
    for polynomial in polynomials:
        for factor, _ in polynomial.factor()[1]:
            known.setdefault(tuple(int(c) for c in list(factor)), primitive(factor))
    roots = [root for poly in known.values() for root in isolated_roots(poly, is_square_free=True) if root.is_real]
    return [root for root in roots if root.ball().real > 0]
