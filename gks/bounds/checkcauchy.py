"""Cauchy stability of an interior with rational coefficients, by the checker's own means."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, pairwise

from flint import acb, arb, fmpq, fmpz_mpoly, fmpz_poly

from gks.bounds.checkballs import Open, deflated, solved
from gks.bounds.checknumbers import roots_of, univariate
from gks.bounds.checkring import degree, enclose, factors, mirror, parts_of


def cauchy(growth: fmpz_mpoly) -> bool:
    """Whether F(z, x) = 0, with integer coefficients, is Cauchy-stable.

    Cuts of the upper half circle: where a leading coefficient vanishes or roots z may meet the circle or each other.
    Between cuts one rational point decides; at a cut the moduli are limits, and only a multiple root on the circle
    can do harm.
    """
    split = [f for f, _ in factors(growth) if degree(f, "z")]
    cuts = _slopes([cut for f in split for cut in _cutting(f, split)])
    inner = [(a[1] + b[0]) / 2 for a, b in pairwise(cuts)]
    first = [cuts[0][0] / 2] if cuts and cuts[0][0] > 0 else [Fraction(1)] if not cuts else []
    last = [cuts[-1][1] + 1] if cuts else []
    for t in [*first, *inner, *last]:
        x = acb(1, fmpq(t.numerator, t.denominator)) / acb(1, -fmpq(t.numerator, t.denominator))
        if not all(_inside_or_on(f, x) for f in split):
            return False
    ends = [acb(1), acb(-1), *(_circle_ball(cut) for cut in cuts)]
    return all(_simple_on_circle(split, x) for x in ends)


def _cutting(f: fmpz_mpoly, split: Sequence[fmpz_mpoly]) -> Iterator[fmpz_poly]:
    yield univariate(parts_of(f, "z")[-1], "x")
    turned = mirror(f, "z", "x")
    loci = [f.resultant(turned, "z")] if turned not in (f, -f) else []
    if degree(f, "z") > 1:
        loci.append(f.discriminant("z"))
    loci += [f.resultant(other, "z") for other in split if other != f]
    yield from (univariate(locus, "x") for locus in loci if not locus.is_zero())


def _slopes(cuts: Sequence[fmpz_poly]) -> list[tuple[Fraction, Fraction]]:
    """Disjoint rational intervals for tan(theta/2), 0 < theta < pi, of all cuts on the circle (more do no harm)."""
    found: list[tuple[Fraction, Fraction]] = []
    known = {tuple(int(c) for c in list(g)): g for cut in cuts for g, _ in cut.factor()[1]}
    for g in known.values():
        for x in roots_of(g):
            if abs(x).contains(1) and x.imag > 0:
                slope = x.imag / (1 + x.real)
                found.append((_exact(slope.lower()), _exact(slope.upper())))
    found.sort()
    merged: list[tuple[Fraction, Fraction]] = []
    for low, high in found:
        if merged and low <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(high, merged[-1][1]))
        else:
            merged.append((low, high))
    return merged


def _exact(value: arb) -> Fraction:
    mantissa, exponent = value.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _circle_ball(slope: tuple[Fraction, Fraction]) -> acb:
    low, high = (arb(fmpq(e.numerator, e.denominator)) for e in slope)
    t = low.union(high)
    return acb(1 - t * t, 2 * t) / (1 + t * t)


def limit_holds(growth: fmpz_mpoly, at: Mapping[str, acb]) -> bool:
    """Whether F(z, x) = 0 is Cauchy-stable at a point in balls, given that it is the limit of stable ones.

    The moduli then are at most 1, and only a multiple root on the circle can do harm: one that balls do not tell from
    it counts. Open where they tell nothing.
    """
    split = [f for f, _ in factors(growth) if degree(f, "z")]
    loci = [f.discriminant("z") for f in split if degree(f, "z") > 1]
    loci += [one.resultant(other, "z") for one, other in combinations(split, 2)]
    spots = [acb(1), acb(-1)] if loci else []
    for locus in loci:
        for g, _ in factors(locus):
            parts = [enclose(c, at) for c in parts_of(g, "x")]
            try:
                spots += solved(parts)
            except Open:
                spots += [x for found in deflated(parts) for x in found]
    return all(_simple_at(split, {**at, "x": x}) for x in spots if abs(x).contains(1))


def _inside_or_on(f: fmpz_mpoly, x: acb) -> bool:
    """Whether no root z at a point between cuts is outside; on the circle are those whose mirror image is their own."""
    roots = solved([enclose(c, {"x": x}) for c in parts_of(f, "z")])
    neutral = mirror(f, "z", "x") in (f, -f)
    for z in roots:
        if abs(z) > 1:
            return False
        if abs(z) < 1:
            continue
        image = 1 / z.conjugate()
        if not neutral or sum(r.overlaps(image) for r in roots) != 1:
            raise Open
    return True


def _simple_on_circle(split: Sequence[fmpz_mpoly], x: acb) -> bool:
    return _simple_at(split, {"x": x})


def _simple_at(split: Sequence[fmpz_mpoly], at: Mapping[str, acb]) -> bool:
    near: list[acb] = []
    for f in split:
        parts = [enclose(c, at) for c in parts_of(f, "z")]
        if parts[-1].contains(0):
            return False
        try:
            near += [z for z in solved(parts) if not abs(z) < 1]
        except Open:
            if any(abs(z).contains(1) for z in deflated(parts)[1]):
                return False  # a double root on the circle
    return not any(a.overlaps(b) for k, a in enumerate(near) for b in near[:k])
