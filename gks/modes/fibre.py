"""Polynomials at algebraic points: exact zero tests, signs and values, and the fibre over a point with multiplicities.

A point gives each of some variables an algebraic number (``Root``). Every question about F(point) is answered in two
steps. Norms (resultants with the coordinates' irreducible polynomials) give an integer polynomial that has the wanted
number among its roots; balls then tell which root it is. Norms also hold the values at the conjugate points, so they
only ever propose; what is returned is counted exactly.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from flint import acb, arb, ctx, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from gks.modes.algebraic import (
    GUARD_BITS,
    START_BITS,
    Position,
    Root,
    Side,
    factored_roots,
    isolated_roots,
    primitive,
)

Point = Mapping[str, Root]


class VanishesIdentically(ArithmeticError):
    """F(point, x) is the zero polynomial in x: every x solves it, and there is no fibre to list."""


@dataclass(frozen=True, slots=True)
class FibreRoot:
    """One root x of F(point, x) = 0 with its exact multiplicity there."""

    root: Root
    multiplicity: int

    def ball(self, bits: int = START_BITS) -> acb:
        return self.root.ball(bits)

    @property
    def position(self) -> Position:
        return self.root.position

    @property
    def side(self) -> Side:
        return self.root.side


def univariate(poly: fmpz_mpoly, x: str) -> fmpz_poly:
    """``poly``, which holds no other variable, as a polynomial in ``x``."""
    k = poly.context().variable_to_index(x)
    coefficients = [0] * (poly.degrees()[k] + 1 if poly else 1)
    for powers, coefficient in poly.to_dict().items():
        if any(power for j, power in enumerate(powers) if j != k):
            raise ValueError(f"expected a polynomial in {x} alone, got {poly}")
        coefficients[powers[k]] = int(coefficient)
    return fmpz_poly(coefficients)


def embed(poly: fmpz_poly, context: fmpz_mpoly_ctx, x: str) -> fmpz_mpoly:
    """A univariate polynomial in the generator ``x`` of ``context``."""
    k, n = context.variable_to_index(x), context.nvars()
    return context.from_dict(
        {tuple(power if j == k else 0 for j in range(n)): c for power, c in enumerate(list(poly)) if c}
    )


def coefficients(poly: fmpz_mpoly, x: str) -> list[fmpz_mpoly]:
    """The coefficients of ``x**0, x**1, ...`` in the same context; ``[]`` for the zero polynomial."""
    context = poly.context()
    k = context.variable_to_index(x)
    parts: dict[int, dict[tuple[int, ...], int]] = {}
    for powers, coefficient in poly.to_dict().items():
        parts.setdefault(powers[k], {})[(*powers[:k], 0, *powers[k + 1 :])] = int(coefficient)
    return [context.from_dict(parts.get(power, {})) for power in range(max(parts, default=-1) + 1)]


def specialise(poly: fmpz_mpoly, values: Mapping[str, Fraction]) -> fmpz_mpoly:
    """``poly`` with rational values put in, times the positive integer that clears denominators; same context.

    Zeros and signs are kept, values are not.
    """
    context = poly.context()
    for name, value in values.items():
        k = context.variable_to_index(name)
        degree = poly.degrees()[k]
        if not degree:
            continue
        scale = [value.numerator**p * value.denominator ** (degree - p) for p in range(degree + 1)]
        terms: dict[tuple[int, ...], int] = {}
        for powers, coefficient in poly.to_dict().items():
            rest = (*powers[:k], 0, *powers[k + 1 :])
            terms[rest] = terms.get(rest, 0) + int(coefficient) * scale[powers[k]]
        poly = context.from_dict(terms)
    return poly


@cache
def _names(context: fmpz_mpoly_ctx) -> tuple[str, ...]:
    return tuple(context.names())


def at_balls(poly: fmpz_mpoly, values: Mapping[str, acb]) -> acb:
    """A ball around ``poly`` at the given balls (every variable that occurs), at the current precision."""
    if poly.is_constant():  # as most coefficients of a closure are
        return acb(poly.coeffs()[0]) if poly else acb(0)
    occurring = [(k, degree) for k, degree in enumerate(poly.degrees()) if degree]
    names = _names(poly.context())
    if len(occurring) == 1:
        ((k, degree),) = occurring
        dense = [0] * (degree + 1)
        for exponents, coefficient in poly.to_dict().items():
            dense[exponents[k]] = int(coefficient)
        return fmpz_poly(dense)(values[names[k]])
    powers_of: list[tuple[int, list[acb]]] = []
    for k, degree in occurring:
        powers = [acb(1)]
        for _ in range(degree):
            powers.append(powers[-1] * values[names[k]])
        powers_of.append((k, powers))
    total = acb(0)
    for exponents, coefficient in poly.to_dict().items():
        term = acb(coefficient)
        for k, table in powers_of:
            if power := exponents[k]:
                term *= table[power]
        total += term
    return total


def polynomial_at_balls(poly: fmpz_mpoly, x: str, values: Mapping[str, acb]) -> list[acb]:
    """Balls around the coefficients of ``x**0, x**1, ...`` of ``poly`` at the given balls."""
    return [at_balls(c, values) for c in coefficients(poly, x)]


def is_zero(point: Point, poly: fmpz_mpoly) -> bool:
    """Whether ``poly`` vanishes at the point, exactly."""
    rest, point = _without_rationals(point, poly)
    if rest.is_constant():
        return not rest
    if len(point) == 1:
        # An irreducible p shares a root with G exactly when it divides G.
        ((name, root),) = point.items()
        return not (univariate(rest, name) % root.poly)
    with ctx.workprec(START_BITS + GUARD_BITS):
        if not at_balls(rest, _balls(point, START_BITS)).contains(0):
            return False
    return _root_of_norm(point, rest).is_zero


def vanishes(point: Point, poly: fmpz_mpoly) -> bool:
    """Whether ``poly`` is zero at the point for all values of the variables that the point leaves free, exactly."""
    context = poly.context()
    fixed = [name in point for name in context.names()]
    parts: dict[tuple[int, ...], dict[tuple[int, ...], int]] = {}
    for powers, coefficient in poly.to_dict().items():
        free = tuple(0 if held else power for power, held in zip(powers, fixed, strict=True))
        bound = tuple(power if held else 0 for power, held in zip(powers, fixed, strict=True))
        parts.setdefault(free, {})[bound] = int(coefficient)
    return all(is_zero(point, context.from_dict(part)) for part in parts.values())


def sign(point: Point, poly: fmpz_mpoly) -> int:
    """The sign (-1, 0, 1) of ``poly`` at a point with real coordinates, exactly."""
    if not all(root.is_real for root in point.values()):
        raise ValueError(f"a sign needs real coordinates, got {dict(point)}")
    rest, point = _without_rationals(point, poly)
    if is_zero(point, rest):
        return 0
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            value: arb = at_balls(rest, _balls(point, bits)).real
            if value > 0:
                return 1
            if value < 0:
                return -1
        bits *= 2


def value(point: Point, numerator: fmpz_mpoly, denominator: fmpz_mpoly | None = None) -> Root:
    """The algebraic number ``numerator/denominator`` at the point, exactly.

    Raises ZeroDivisionError where the denominator vanishes there.
    """
    if denominator is not None and is_zero(point, denominator):
        raise ZeroDivisionError(f"{denominator} vanishes at {dict(point)}")
    return _root_of_norm(point, numerator, denominator)


def fibre(point: Point, poly: fmpz_mpoly, x: str) -> list[FibreRoot]:
    """All roots x of ``poly(point, x) = 0``, each with its exact multiplicity; ``[]`` for a nonzero constant.

    ``poly`` may hold the variables of the point and ``x``. Raises VanishesIdentically where every x is a root.

    Candidates are the roots of the norm. The number of leading derivatives F, F_x, F_xx, ... whose ball at a candidate
    holds 0 is at least its multiplicity, and the multiplicities add up to the exact degree of F(point, x); so once the
    counts add up to that degree each of them is exact, and refining the balls gets there.
    """
    rest, point = _without_rationals(point, poly)
    if not point:
        return _rational_fibre(univariate(rest, x), poly)
    parts = coefficients(rest, x)
    while parts and is_zero(point, parts[-1]):
        parts.pop()
    if not parts:
        raise VanishesIdentically(f"{poly} vanishes for every {x} at {dict(point)}")
    degree = len(parts) - 1
    if degree == 0:
        return []
    generator = rest.context().gen(rest.context().variable_to_index(x))
    true_part = sum((c * generator**k for k, c in enumerate(parts)), rest.context().constant(0))
    candidates = isolated_roots(univariate(norm(point, true_part), x))
    derivatives = [true_part]
    for _ in range(degree):
        derivatives.append(derivatives[-1].derivative(x))
    return _counted(point, derivatives, x, candidates, degree)


def _rational_fibre(poly: fmpz_poly, original: fmpz_mpoly) -> list[FibreRoot]:
    if not poly:
        raise VanishesIdentically(f"{original} vanishes identically at the given rational point")
    return [FibreRoot(root, multiplicity) for root, multiplicity in factored_roots(poly)]


def _counted(
    point: Point, derivatives: list[fmpz_mpoly], x: str, candidates: list[Root], degree: int
) -> list[FibreRoot]:
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            balls = _balls(point, bits)
            found = [
                FibreRoot(root, count)
                for root in candidates
                if (count := _vanishing(derivatives, {**balls, x: root.ball(bits)}))
            ]
        if sum(each.multiplicity for each in found) == degree:
            return found
        bits *= 2


def _vanishing(derivatives: Iterable[fmpz_mpoly], values: Mapping[str, acb]) -> int:
    """How many of the first derivatives may vanish: at least the multiplicity of the root in the balls."""
    count = 0
    for derivative in derivatives:
        if not at_balls(derivative, values).contains(0):
            break
        count += 1
    return count


def _balls(point: Point, bits: int) -> dict[str, acb]:
    return {name: root.ball(bits) for name, root in point.items()}


def _without_rationals(point: Point, poly: fmpz_mpoly) -> tuple[fmpz_mpoly, dict[str, Root]]:
    """Rational coordinates put in; of the others those that still occur, each over its irreducible polynomial."""
    names = poly.context().names()
    rationals = {n: r.rational for n, r in point.items() if n in names}
    rest = specialise(poly, {name: exact for name, exact in rationals.items() if exact is not None})
    occurring = {name for name, degree in zip(names, rest.degrees(), strict=True) if degree}
    return rest, {name: root.minimal for name, root in point.items() if name in occurring}


def norm(point: Point, poly: fmpz_mpoly) -> fmpz_mpoly:
    """The primitive product of ``poly`` over the conjugates of every coordinate: a nonzero multiple of poly(point, .).

    ``poly`` must not be zero at the point for all values of the rest, and the point's roots must be over irreducible
    polynomials (``Root.minimal``). The result holds no variable of the point.

    Where a conjugate point makes the product vanish identically although poly(point, .) does not, the norm taken so far
    is divisible by the next coordinate's polynomial p. A power of p divides out, and what is left still has
    poly(point, .) as a factor over the point: the p-adic valuation of the product is the sum of those of its factors.
    """
    context = poly.context()
    for name, root in point.items():
        relation = embed(root.poly, context, name)
        quotient, remainder = divmod(poly, relation)
        while not remainder:
            poly = quotient
            quotient, remainder = divmod(poly, relation)
        poly = poly.resultant(relation, name)
        _, poly = poly.primitive()
    return poly


def _root_of_norm(point: Point, numerator: fmpz_mpoly, denominator: fmpz_mpoly | None = None) -> Root:
    """numerator/denominator at the point, found among the roots of the norm of ``denominator*w - numerator``."""
    context = numerator.context()
    extended = fmpz_mpoly_ctx.get((*context.names(), _fresh(context.names())), "lex")
    w = extended.gen(context.nvars())
    top = numerator.project_to_context(extended)
    bottom = extended.constant(1) if denominator is None else denominator.project_to_context(extended)
    # Cleared denominators must agree, so rational coordinates are put in once the fraction is one polynomial.
    linear, algebraic = _without_rationals(point, bottom * w - top)
    name = extended.name(context.nvars())
    candidates = isolated_roots(univariate(norm(algebraic, linear), name))
    (only,) = _counted(algebraic, [linear, linear.derivative(name)], name, candidates, 1)
    return Root(primitive(only.root.poly), only.root.index)


def _fresh(names: Iterable[str]) -> str:
    taken = set(names)
    name = "w"
    while name in taken:
        name += "_"
    return name
