"""Critical values of the parameter, and the exact numbers that cells are cut at and sampled by."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations, pairwise

from flint import acb, arb, ctx, fmpq, fmpz_poly

from gks.bounds.boundary import Boundary, in_parameter
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root, primitive
from gks.modes.critical import positive_roots
from gks.modes.fibre import univariate
from gks.modes.numerals import text_exact
from gks.modes.unimodular import by_real_part, rational_ends, simplest_between

Report = Callable[[str], None]
"""Told the stage reached, for whoever waits."""


@dataclass(slots=True)
class Critical:
    """A root of one irreducible polynomial in p: whether a curve contains it, and the pairs of curves that meet."""

    wall: bool = False
    pairs: set[tuple[int, int]] = field(default_factory=set)


def critical_parameters(found: Boundary, report: Report) -> dict[tuple[int, ...], Critical]:
    """Irreducible polynomials in p, by their coefficients, off whose roots the curves are disjoint graphs over p."""
    critical: dict[tuple[int, ...], Critical] = {key_of(wall): Critical(wall=True) for wall in found.walls}

    def add(poly: fmpz_poly, pair: tuple[int, int] | None) -> None:
        for factor, _ in poly.factor()[1]:
            entry = critical.setdefault(key_of(primitive(factor)), Critical())
            if pair is not None:
                entry.pairs.add(pair)

    for index, curve in enumerate(found.curves):
        report(f"discriminant {index + 1} of {len(found.curves)}")
        parts = in_parameter(curve)
        add(parts[-1], None)
        add(parts[0], None)
        if len(parts) > 2:
            add(univariate(curve.discriminant("lam"), "p"), (index, index))
    for (i, one), (j, other) in combinations(enumerate(found.curves), 2):
        report(f"resultant of curves {i + 1} and {j + 1} of {len(found.curves)}")
        add(univariate(one.resultant(other, "lam"), "p"), (i, j))
    return critical


def key_of(poly: fmpz_poly) -> tuple[int, ...]:
    """A polynomial's coefficients, ascending."""
    return tuple(int(c) for c in list(poly))


# Numbers ------------------------------------------------------------------------------------------------------------


def ascending_roots(poly: fmpz_poly) -> list[Root]:
    """The distinct positive roots, ascending, each over its irreducible polynomial."""
    return by_real_part(positive_roots([poly]))


def distinct(roots: Iterator[Root]) -> list[Root]:
    """Each number once, over its irreducible polynomial."""
    return list(dict.fromkeys(root.minimal for root in roots))


def gates(ends: Sequence[Root]) -> list[Fraction]:
    """Rationals below, between and above ascending positive numbers."""
    if not ends:
        return [Fraction(1)]
    return [between(low, high) for low, high in pairwise([Root.of(0), *ends, None])]


def between(low: Root | None, high: Root | None) -> Fraction:
    """The rational of least denominator in an open interval, of integers the one nearest 0; None is infinite."""
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            bottom, top = _ends(low, bits), _ends(high, bits)
        inner = None if bottom is None else bottom[1], None if top is None else top[0]
        outer = None if bottom is None else bottom[0], None if top is None else top[1]
        if inner[0] is None or inner[1] is None or inner[0] < inner[1]:
            answer = _simplest(*inner)
            if answer == _simplest(*outer):  # else an enclosure is too wide to tell
                return answer
        bits *= 2


def _ends(root: Root | None, bits: int) -> tuple[Fraction, Fraction] | None:
    if root is None:
        return None
    exact = root.rational
    return rational_ends(root.ball(bits).real) if exact is None else (exact, exact)


def _simplest(low: Fraction | None, high: Fraction | None) -> Fraction:
    if (low is None or low < 0) and (high is None or high > 0):
        return Fraction(0)
    if low is not None and low >= 0:
        return simplest_between(low, high)
    assert high is not None
    return -simplest_between(-high, None if low is None else -low)


def hull(low: Fraction, high: Fraction) -> acb:
    """A ball that holds an interval."""
    ends = [arb(fmpq(e.numerator, e.denominator)) for e in (low, high)]
    return acb(ends[0].union(ends[1]))


def shown(value: Fraction | Root) -> str:
    """A number for a message."""
    exact = value if isinstance(value, Fraction) else value.rational
    if exact is not None:
        return text_exact(exact)
    assert isinstance(value, Root)
    return str(value.ball().real.str(12, radius=False))
