"""The exact set of lam > 0 for which a scalar scheme F(z, kappa; lam) = 0 is Cauchy-stable.

On the cylinder abs(kappa) = 1, lam > 0 the curves of ``cauchy.cuts_of`` bound the regions in which the numbers of
roots inside, on and outside the circle are constant. In x = kappa + 1/kappa, -2 <= x <= 2, these are plane algebraic
curves. Over an interval of lam in which none of them turns back, crosses another one, meets x = 2 or x = -2, has an
isolated point, or passes a double root z, the picture (hence the verdict) does not change. The finitely many lam where
one of these happens are roots of discriminants and resultants. ``cauchy_stable`` decides one rational lam between
neighbours; a critical lam beside a stable interval is a limit of stable schemes, which leaves little to decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import combinations, pairwise

from flint import ctx, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Root, isolated_roots, primitive
from gks.modes.cauchy import (
    DoubleRootRule,
    Factors,
    cauchy_stable,
    cuts_of,
    degree_in,
    factored,
    reciprocal_in,
    stable_as_limit,
)
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import Point, VanishesIdentically, coefficients, norm, specialise, univariate
from gks.modes.unimodular import by_real_part, rational_ends, simplest_between


@dataclass(frozen=True, slots=True)
class CauchyInterval:
    """A maximal interval of Cauchy-stable lam: the open (low, high) and whether its ends belong to it.

    ``low`` is 0 (which never belongs) or a critical lam; ``high`` None is infinity.
    """

    low: Root
    high: Root | None
    low_stable: bool
    high_stable: bool


@dataclass(frozen=True, slots=True)
class CauchySet:
    """All Cauchy-stable lam > 0 but for isolated ones: disjoint intervals, ascending.

    Two intervals that share an end have an unstable lam between them.
    """

    intervals: tuple[CauchyInterval, ...]

    @property
    def first_limit(self) -> Root | None:
        """The largest number with every smaller positive lam stable; 0 where there is none, None is infinity."""
        if self.intervals and self.intervals[0].low.is_zero:
            return self.intervals[0].high
        return Root.of(0)

    def contains(self, lam: Root) -> bool:
        """Whether ``lam`` is in one of the intervals, ends included where they are stable."""
        for each in self.intervals:
            if lam == each.low or (each.high is not None and lam == each.high):
                if each.low_stable if lam == each.low else each.high_stable:
                    return True
            elif each.low < lam and (each.high is None or lam < each.high):
                return True
        return False


def cauchy_set(
    poly: fmpz_mpoly,
    point: Point | None = None,
    *,
    z: str = "z",
    kappa: str = "kappa",
    lam: str = "lam",
    harmless: DoubleRootRule | None = None,
) -> CauchySet:
    """The stable set in ``lam`` of the scalar scheme ``poly(z, kappa, lam) = 0``; ``point`` fixes all other variables.

    ``harmless`` judges multiple roots z on the circle, as in ``cauchy_stable``. Results without it and without a
    ``point`` are remembered.
    """
    if point or harmless is not None:
        return _cauchy_set(poly, point or {}, z, kappa, lam, harmless)
    terms = tuple((powers, int(coefficient)) for powers, coefficient in poly.to_dict().items())
    return _remembered(poly.context().names(), terms, z, kappa, lam)


@lru_cache(maxsize=512)
def _remembered(
    names: tuple[str, ...], terms: tuple[tuple[tuple[int, ...], int], ...], z: str, kappa: str, lam: str
) -> CauchySet:
    return _cauchy_set(fmpz_mpoly_ctx.get(names, "lex").from_dict(dict(terms)), {}, z, kappa, lam, None)


def _cauchy_set(
    poly: fmpz_mpoly, point: Point, z: str, kappa: str, lam: str, harmless: DoubleRootRule | None
) -> CauchySet:
    def stable(at: Root) -> bool:
        return cauchy_stable(poly, {**point, lam: at}, z=z, kappa=kappa, harmless=harmless).stable

    def keeps(end: Root) -> bool:
        try:
            return stable_as_limit(poly, {**point, lam: end}, z=z, kappa=kappa, harmless=harmless).stable
        except VanishesIdentically:
            # Here the equation says nothing, so the new level is not determined.
            return False

    critical = critical_values(factored(poly, point, z=z, kappa=kappa), lam)
    cells = [stable(Root.of(sample)) for sample in rationals_between(critical)]
    intervals: list[CauchyInterval] = []
    for k, (low, high) in enumerate(zip([Root.of(0), *critical], [*critical, None], strict=True)):
        if not cells[k]:
            continue
        low_stable = k > 0 and (intervals[-1].high_stable if cells[k - 1] else keeps(low))
        high_stable = high is not None and keeps(high)
        if low_stable and cells[k - 1]:
            intervals[-1] = CauchyInterval(intervals[-1].low, high, intervals[-1].low_stable, high_stable)
        else:
            intervals.append(CauchyInterval(low, high, low_stable, high_stable))
    return CauchySet(tuple(intervals))


def critical_values(factors: Factors, lam: str) -> list[Root]:
    """The positive lam, ascending, between which the verdict cannot change (some of them may be harmless)."""
    known: dict[tuple[int, ...], fmpz_poly] = {}
    for poly in _critical_polynomials(factors, lam):
        for factor, _ in poly.factor()[1]:
            known.setdefault(tuple(int(c) for c in list(factor)), primitive(factor))
    roots = [root for poly in known.values() for root in isolated_roots(poly, is_square_free=True) if root.is_real]
    return by_real_part([root for root in roots if root.ball().real > 0])


def _critical_polynomials(factors: Factors, lam: str) -> Iterator[fmpz_poly]:
    kappa = factors.kappa
    for factor in factors.idle:
        yield univariate(norm(factors.point, factor), lam)
    crossing: list[fmpz_mpoly] = []
    for curve in _irreducible(norm(factors.point, cut) for cut in cuts_of(factors)):
        yield from _alone(curve, kappa, lam)
        if _is_palindromic(curve, kappa):
            crossing.append(curve)
    for one, other in combinations([in_cosine(curve, kappa) for curve in crossing], 2):
        yield univariate(one.resultant(other, kappa), lam)
    for meeting in _irreducible(norm(factors.point, locus) for locus in _double_loci(factors)):
        for end in (1, -1):
            yield from _nonzero(_at(meeting, kappa, end), lam)
        for curve in crossing:
            if meeting != curve:
                yield from _nonzero(curve.resultant(meeting, kappa), lam)


def _alone(curve: fmpz_mpoly, kappa: str, lam: str) -> Iterator[fmpz_poly]:
    """Where one irreducible curve meets kappa = 1 or -1, turns back, is vertical, or has an isolated point."""
    if not degree_in(curve, kappa):
        yield univariate(curve, lam)
        return
    for end in (1, -1):
        yield from _nonzero(_at(curve, kappa, end), lam)
    if _is_palindromic(curve, kappa):
        yield from _nonzero(in_cosine(curve, kappa).discriminant(kappa), lam)
    else:
        # Real coefficients put 1/kappa on the curve with every unimodular kappa, so these points are isolated.
        yield from _nonzero(curve.resultant(reciprocal_in(curve, (kappa,)), kappa), lam)


def _double_loci(factors: Factors) -> Iterator[fmpz_mpoly]:
    """Where F as a whole has a double root z: discriminants and pairwise resultants of its factors."""
    moving = [factor for factor, _ in factors.powers if degree_in(factor, factors.z)]
    for factor in moving:
        yield factor.discriminant(factors.z)
    for one, other in combinations(moving, 2):
        yield one.resultant(other, factors.z)


def _irreducible(polys: Iterable[fmpz_mpoly]) -> list[fmpz_mpoly]:
    """The distinct irreducible factors, up to sign and without constants."""
    distinct: dict[str, fmpz_mpoly] = {}
    for poly in polys:
        for factor, _ in irreducible_factors(poly) if poly else ():
            distinct.setdefault(str(factor), factor)
    return list(distinct.values())


def _is_palindromic(curve: fmpz_mpoly, kappa: str) -> bool:
    """Whether an irreducible curve is its own image under kappa -> 1/kappa; the lines kappa = 1, -1 do not count."""
    degree = degree_in(curve, kappa)
    return degree > 0 and degree % 2 == 0 and reciprocal_in(curve, (kappa,)) == curve


def in_cosine(curve: fmpz_mpoly, kappa: str) -> fmpz_mpoly:
    """A palindromic ``curve`` of degree 2d in kappa, divided by kappa**d, in x = kappa + 1/kappa (held by ``kappa``).

    kappa**j + kappa**-j = C_j(x) with C_0 = 2, C_1 = x, C_(j+1) = x C_j - C_(j-1).
    """
    context = curve.context()
    x = context.gen(context.variable_to_index(kappa))
    parts = coefficients(curve, kappa)
    middle = len(parts) // 2
    total = parts[middle]
    before, current = context.constant(2), x
    for part in parts[middle + 1 :]:
        total += part * current
        before, current = current, x * current - before
    return total


def _at(curve: fmpz_mpoly, kappa: str, end: int) -> fmpz_mpoly:
    return specialise(curve, {kappa: Fraction(end)})


def _nonzero(poly: fmpz_mpoly, lam: str) -> Iterator[fmpz_poly]:
    if poly:
        yield univariate(poly, lam)


def rationals_between(critical: list[Root]) -> list[Fraction]:
    """The simplest rational in each of the open intervals that the ascending ``critical`` cut from (0, inf)."""
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            ends = [(Fraction(0), Fraction(0)), *(rational_ends(root.ball(bits).real) for root in critical)]
        if all(one[1] < other[0] for one, other in pairwise(ends)):
            inner = [simplest_between(one[1], other[0]) for one, other in pairwise(ends)]
            return [*inner, simplest_between(ends[-1][1], None)]
        bits *= 2
