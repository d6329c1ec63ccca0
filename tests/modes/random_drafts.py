"""Random schemes that are Cauchy-stable because of how they are built, with random closures, sides and `first`.

Interiors are random stencils, not known schemes. What keeps them stable is an inequality between their coefficients:

- explicit, one or two levels: the absolute coefficients add up to at most 1, so that no maximum grows;
- implicit: the new level's matrix is diagonally dominant by at least that;
- leapfrog type: u(n+1) - u(n-1) = Q u with a skew symbol of size below 2;
- lines: dt(u) = a (C - 1) u with C as in the first case, whose symbol lies in the disc abs(s + a) <= a, or a skew one
  of
  size below 1, under integrators whose stability region holds that disc or that piece of the axis times lam;
- systems: the same with matrices, diagonal in one basis, or of maximum-row-sum norms that add up to at most 1 (coupled:
  no basis separates them).

Each is a scheme on a right half-line; left ones are mirrored afterwards. Closures are those of the field (extrapolation
in space and along the diagonal, of orders 0 to 3) and random combinations, over several levels, implicit, with ODEs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import comb
from random import Random

from tests.strategies import Draft, Equation, Line, Term

DISC = {
    # lam up to which the integrator is stable for every s with abs(s + 1) <= 1
    "forward-euler": Fraction(1),
    "rk2": Fraction(1),
    "ssprk3": Fraction(1),
    "rk4": Fraction(1),
    "backward-euler": Fraction(3),
    "crank-nicolson": Fraction(3),
    "bdf2": Fraction(3),
    "ab2": Fraction(1, 4),
    "ab3": Fraction(1, 5),
    "exact": Fraction(1),
}
AXIS = {
    # lam up to which it is stable for every s = i y with abs(y) <= 1
    "ssprk3": Fraction(17, 10),
    "rk4": Fraction(28, 10),
    "backward-euler": Fraction(3),
    "crank-nicolson": Fraction(3),
    "bdf2": Fraction(3),
    "ab3": Fraction(7, 10),
    "leapfrog": Fraction(9, 10),
    "exact": Fraction(1),
}
MULTISTEP = ("ab2", "ab3", "bdf2", "leapfrog")


@dataclass(frozen=True)
class Interior:
    """Equations of one right half-line for its unknowns, and what a closure beside it may hold."""

    unknowns: tuple[str, ...]
    equations: tuple[Equation, ...]
    named: tuple[tuple[str, str], ...]
    lam: Fraction
    levels: tuple[int, ...]
    """Time levels that closure values may have; empty under the method of lines."""


def small(r: Random) -> Fraction:
    """A small rational, often 0 or a whole number."""
    return Fraction(r.randint(-6, 6), r.choice((1, 1, 2, 3, 4)))


def stencil(r: Random, left: int, right: int) -> dict[int, Fraction]:
    """Random coefficients whose absolute values add up to 1; the outermost on the left is not 0."""
    weights = {j: r.randint(-4, 4) for j in range(-left, right + 1)}
    weights[-left] = weights[-left] or r.choice((-1, 1, 2))
    total = sum(map(abs, weights.values()))
    return {j: Fraction(w, total) for j, w in weights.items() if w}


def skew(r: Random, reach: int) -> dict[int, Fraction]:
    """c_k (E**k - E**-k) with 2 sum abs(c_k) <= 19/20."""
    weights = [r.randint(-3, 3) for _ in range(reach)]
    weights[-1] = weights[-1] or 1
    scale = Fraction(19, 40) / sum(map(abs, weights))
    found: dict[int, Fraction] = {}
    for k, w in enumerate(weights, 1):
        if w:
            found |= {k: w * scale, -k: -w * scale}
    return found


def twentieths(r: Random, largest: Fraction) -> Fraction:
    """A lam in (0, largest], the end itself often enough."""
    return largest if r.random() < 0.1 else Fraction(r.randint(1, int(20 * largest)), 20)


def _terms(row: dict[int, Fraction], unknown: str, level: int = 0, sign: int = -1) -> list[Term]:
    return [Term(str(sign * c), "R", unknown, j, level) for j, c in row.items()]


# Interiors ------------------------------------------------------------------------------------------------------------


def contraction(r: Random, reach: int) -> Interior:
    """u(n+1) = lam C u(n) + (1 - lam) u(n)."""
    row = stencil(r, r.randint(1, reach), r.randint(0, reach))
    lam = twentieths(r, Fraction(1))
    terms = [Term("1", "R", "u", 0, 1), Term("-(1 - lam)", "R", "u", 0)]
    terms += [Term(f"-({c})*lam", "R", "u", j) for j, c in row.items()]
    return Interior(("u",), (tuple(terms),), (), lam, (1, 0, -1))


def two_levels(r: Random, reach: int) -> Interior:
    """u(n+1) = C u(n) + D u(n-1), the absolute coefficients of both adding up to 1."""
    share = Fraction(r.randint(1, 7), 8)
    new = {j: c * share for j, c in stencil(r, r.randint(1, reach), r.randint(0, reach)).items()}
    old = {j: c * (1 - share) for j, c in stencil(r, r.randint(0, 1), r.randint(0, 1)).items()}
    terms = [Term("1", "R", "u", 0, 1), *_terms(new, "u"), *_terms(old, "u", -1)]
    return Interior(("u",), (tuple(terms),), (), Fraction(1, 2), (1, 0, -1))


def implicit(r: Random, reach: int) -> Interior:
    """B u(n+1) = C u(n), B dominated by its diagonal by 1 or more."""
    row = stencil(r, r.randint(0, reach), r.randint(0, reach))
    new = {j: c * r.choice((1, 2)) for j, c in stencil(r, r.randint(1, reach), r.randint(0, reach)).items()}
    new[0] = 1 + sum(abs(c) for j, c in new.items() if j) + max(Fraction(0), new.get(0, Fraction(0)))
    terms = [*_terms(new, "u", 1, 1), *_terms(row, "u")]
    return Interior(("u",), (tuple(terms),), (), Fraction(1, 2), (1, 0, -1))


def leapfrog(r: Random, reach: int) -> Interior:
    """u(n+1) = u(n-1) + 2 lam Q u, Q skew of size below 1."""
    terms = [Term("1", "R", "u", 0, 1), Term("-1", "R", "u", 0, -1)]
    terms += [Term(f"({-2 * c})*lam", "R", "u", j) for j, c in skew(r, min(reach, 2)).items()]
    return Interior(("u",), (tuple(terms),), (), twentieths(r, Fraction(1)), (1, 0, -1))


def lines(r: Random, reach: int) -> Interior:
    """dt(u) = (C - 1) u or skew, now and then with a mass matrix whose symbol lies in [1/2, 3/2]."""
    if r.random() < 0.5:
        time, row = r.choice(sorted(DISC)), stencil(r, r.randint(1, reach), r.randint(0, reach))
        largest = DISC[time]
        row[0] = row.get(0, Fraction(0)) - 1
    else:
        time, row = r.choice(sorted(AXIS)), skew(r, min(reach, 2))
        largest = AXIS[time]
    mass = [Term("1", "R", "u", 0, 0, dt=True)]
    if r.random() < 0.2:
        m = str(Fraction(r.choice((-1, 1)), r.choice((4, 5, 6))))
        mass += [Term(m, "R", "u", j, 0, dt=True) for j in (-1, 1)]
        # Re s <= 0 alone is kept; where the size doubles, lam is halved, and a disc is no longer one: A-stable ones.
        time, largest = r.choice(("backward-euler", "crank-nicolson", "bdf2")), Fraction(3)
    levels = (0, -1) if time in MULTISTEP and r.random() < 0.5 else ()
    terms = (*mass, *_terms({j: c for j, c in row.items() if c}, "u"))
    return Interior(("u",), (terms,), (("time", time),), twentieths(r, largest), levels)


def system(r: Random, reach: int) -> Interior:
    """v(n+1) = sum_j A_j v, the A_j diagonal in one random basis."""
    a, b = Fraction(r.randint(-2, 2), 2), Fraction(r.randint(-2, 2), 3)
    basis = ((Fraction(1), a), (b, 1 + a * b))  # determinant 1
    inverse = ((1 + a * b, -a), (-b, Fraction(1)))
    reach = min(reach, 2)
    rows = [stencil(r, r.randint(0, reach), r.randint(0, reach)) for _ in range(2)]
    matrices = {
        j: [
            [
                sum((basis[i][m] * rows[m].get(j, Fraction(0)) * inverse[m][k] for m in range(2)), Fraction(0))
                for k in (0, 1)
            ]
            for i in (0, 1)
        ]
        for j in sorted({*rows[0], *rows[1]})
    }
    return _matrix_update(matrices)


def coupled(r: Random, reach: int) -> Interior:
    """The same with random matrices whose row sums of absolute values add up to at most 1."""
    offsets = range(-1, 2)
    weights = [[{j: r.choice((-2, -1, 0, 0, 1, 2)) for j in offsets} for _ in (0, 1)] for _ in (0, 1)]
    totals = [sum(abs(w) for cell in row for w in cell.values()) or 1 for row in weights]
    matrices = {j: [[Fraction(weights[i][k][j], totals[i]) for k in (0, 1)] for i in (0, 1)] for j in offsets}
    return _matrix_update(matrices)


def _matrix_update(matrices: dict[int, list[list[Fraction]]]) -> Interior:
    names = ("u", "s")
    equations = tuple(
        (
            Term("1", "R", names[i], 0, 1),
            *(
                Term(str(-matrix[i][k]), "R", names[k], j)
                for j, matrix in sorted(matrices.items())
                for k in (0, 1)
                if matrix[i][k]
            ),
        )
        for i in (0, 1)
    )
    return Interior(names, equations, (), Fraction(1, 2), (1, 0, -1))


SCALARS = (contraction, two_levels, implicit, leapfrog, lines, lines, lines)
SYSTEMS = (system, coupled)


# Closures -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Place:
    """A half-line as closures see it: values[k] is the k-th cell inwards from ``first``, the ghosts have k < 0."""

    name: str
    interior: Interior
    ghosts: tuple[tuple[str, int], ...]


def ghosts_of(interior: Interior) -> tuple[tuple[str, int], ...]:
    """The (unknown, index < 0) that the interior reads at some cell i >= 0."""
    lowest = dict.fromkeys(interior.unknowns, 0)
    for equation in interior.equations:
        for term in equation:
            lowest[term.unknown] = min(lowest[term.unknown], term.index)
    return tuple((u, k) for u in interior.unknowns for k in range(lowest[u], 0))


def rule(r: Random, place: Place, others: Sequence[Place], unknown: str, ghost: int) -> Equation:
    """One closure equation for a ghost value."""
    levels = place.interior.levels
    fully = bool(levels) and levels[0] == 1
    new = 1 if fully else 0
    own = Term("1", place.name, unknown, ghost, new)
    kind = r.random()
    if kind < 0.15:
        order = r.randint(0, 3)
        return (own, *(_value(place, unknown, ghost + k, new, _binomial(order, k)) for k in range(1, order + 2)))
    if kind < 0.3 and fully:
        order = r.randint(0, 2)
        return (own, *(_value(place, unknown, ghost + k, 1 - k, _binomial(order, k)) for k in range(1, order + 2)))
    terms = [own]
    if not fully and not levels and r.random() < 0.3:
        terms = [replace(own, dt=True), _value(place, unknown, ghost, 0, small(r))]
    elif levels and r.random() < 0.3:
        terms.append(_value(place, unknown, ghost, new - 1, small(r)))
    for k in range(r.randint(1, 3)):
        level = r.choice(levels) if levels else 0
        terms.append(_value(place, r.choice(place.interior.unknowns), k, level, small(r)))
    if others and r.random() < 0.7:
        other = r.choice(others)
        terms.append(_value(other, r.choice(other.interior.unknowns), r.randint(0, 1), new, small(r)))
    if len(place.ghosts) > 1 and r.random() < 0.3:
        seen, index = r.choice(place.ghosts)
        if (seen, index) != (unknown, ghost):
            terms.append(_value(place, seen, index, new, Fraction(r.randint(-2, 2), 3)))
    return tuple(term for term in terms if term.coefficient != "0")


def _value(place: Place, unknown: str, k: int, level: int, coefficient: Fraction) -> Term:
    return Term(str(coefficient), place.name, unknown, k, level)


def _binomial(order: int, k: int) -> Fraction:
    """The coefficient of u[k] in (E - 1)**(order + 1) u[0] = 0, that of u[0] being 1."""
    return Fraction((-1) ** k * comb(order + 1, k))


# Schemes --------------------------------------------------------------------------------------------------------------


def random_draft(r: Random, reach: int = 2) -> Draft:
    """One half-line, or two with scalar interiors of one kind, somewhere on the index axis."""
    systems = r.random() < 0.25
    make = r.choice(SYSTEMS if systems else SCALARS)
    interior = make(r, reach)
    pair = make is not coupled and r.random() < 0.3
    interiors = [interior]
    if pair:
        partner = interior
        if interior.named == () and not systems and r.random() < 0.5:
            partner = replace(contraction(r, 1), lam=interior.lam)
            # The contraction is stable for lam <= 1, which all fully discrete drafts keep.
        interiors = [replace(interior), partner]
    names = ("R", "L")
    places = [Place(n, i, ghosts_of(i)) for n, i in zip(names, interiors, strict=False)]
    closure = []
    for place in places:
        others = [p for p in places if p is not place]
        closure += [rule(r, place, others, unknown, ghost) for unknown, ghost in place.ghosts]
    halves = [("R", "right"), ("L", "left")] if pair else [("R", r.choice(("right", "left")))]
    firsts = {name: r.randint(0, 3) for name, _ in halves}
    sides = dict(halves)

    def placed(term: Term) -> Term:
        sign = 1 if sides[term.domain] == "right" else -1
        return replace(term, index=sign * (term.index + firsts[term.domain]))

    def within(term: Term, name: str) -> Term:
        sign = 1 if sides[name] == "right" else -1
        return replace(term, domain=name, index=sign * term.index)

    drawn = tuple(
        Line(
            name,
            sides[name],
            place.interior.unknowns,
            firsts[name],
            tuple(tuple(within(t, name) for t in equation) for equation in place.interior.equations),
            place.interior.named,
        )
        for (name, _), place in zip(halves, places, strict=True)
    )
    return Draft(interior.lam, drawn, tuple(tuple(map(placed, equation)) for equation in closure))
