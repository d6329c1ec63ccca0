"""The checker's own verdict at a point, in balls.

At rational (p, lam) all polynomials are rational, and what lies on the unit circle is told exactly: a root of an
irreducible polynomial that is its own reciprocal is on the circle when the mirror image of its ball meets no other
ball. At an algebraic point balls prove only what is strict; a root that meets the circle at the highest precision is
taken to be on it, which errs on the side of refusing what is claimed to be stable.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product

from flint import acb, ctx, fmpq, fmpz_mpoly, fmpz_poly

from gks.bounds.checkballs import Open, ball_determinant, deflated, solved
from gks.bounds.checkcauchy import cauchy, limit_holds
from gks.bounds.checkcurves import characteristic, in_z, kreiss
from gks.bounds.checkderive import Problem
from gks.bounds.checkformula import Rejected
from gks.bounds.checknumbers import isolated, roots_of, univariate
from gks.bounds.checkring import Unsupported, degree, enclose, parts_of
from gks.bounds.checkzero import specialised, zeros_of_delta

LADDER = (128, 256, 512, 1024, 2048)
"""Working precisions, in bits; a question that the last leaves open rejects the certificate."""


SHARES = (Fraction(0), Fraction(1, 3), Fraction(2, 5))
"""How far below a point others are tried: where two spatial roots are equal, one meets that at few lam."""

FAR_BITS = (40, 120)
"""Exponents of two at which Delta is looked at far out, beyond the ratios of the coefficients: between them it falls by
2**-80 at least if Delta(oo) = 0."""

Ends = Callable[[int], Mapping[str, acb]]
"""A point as balls at a precision in bits."""


@dataclass(frozen=True, slots=True)
class _Mode:
    """A zero of the norm on or outside the circle: whether Delta vanishes for its decaying solutions."""

    on_circle: bool
    zero: bool
    needs_limit: bool


def interior_holds(problem: Problem, p: Fraction, lam: Fraction) -> bool:
    """Whether the interior is Cauchy-stable at a rational point, exactly."""
    at = {"p": p, "lam": lam}
    for bits in LADDER:
        with ctx.workprec(bits):
            try:
                return all(cauchy(specialised(growth, at)) for growth in problem.growth)
            except Open:
                continue
    raise Rejected(f"Cauchy stability at p = {p}, lam = {lam} is not verified")


def stable_between(judge: Judge, p: Fraction, low: Fraction, lam: Fraction) -> bool:
    """The verdict at lam, on no curve, with none down to ``low``; at points between them where spatial roots meet."""
    for share in SHARES:
        try:
            return judge.stable(p, lam - (lam - low) * share)
        except Rejected:
            if share == SHARES[-1]:
                raise
    raise AssertionError("unreachable")


class Judge:
    """Verdicts of one scheme; ``problem`` has p and lam symbolic."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.own, _ = characteristic(problem)
        self.mapped = in_z(problem, self.own)

    def stable(self, p: Fraction, lam: Fraction) -> bool:
        """At a rational point on no curve, where the interior is Cauchy-stable, exactly."""
        at = {"p": p, "lam": lam}
        for bits in LADDER:
            with ctx.workprec(bits):
                try:
                    if not self.determines(_balls(at), at):
                        return False
                    return not any(mode.zero for mode in self._modes(_balls(at), at))
                except Open:
                    continue
        raise Rejected(f"the verdict at p = {p}, lam = {lam} is not verified")

    def loses_root(self, wall: fmpz_mpoly) -> bool:
        """Whether a root of the characteristic polynomial goes to infinity on a wall, with z: Delta(oo) vanishes there.

        Told where the spatial roots have no other choice and sigma = infinity is z = infinity; else False, not known.
        """
        leads = [parts_of(f, self.problem.variable)[-1] for f in self.own]
        if any(f.decaying not in (0, degree(f.part, "x")) for f in self.problem.families) or not self.problem.explicit:
            return False
        return any(divmod(lead, wall)[1].is_zero() for lead in leads)

    def determines(self, at: Mapping[str, acb], exact: Mapping[str, Fraction]) -> bool:
        """Whether Delta(oo) is not zero, in the ghost basis: its size is compared far out and further out.

        Where sigma = infinity is not z = infinity, it has to be an inner z.
        """
        if not self.problem.explicit:
            return self._inner_at_infinity(at)
        sizes = []
        beyond = self._ratio_bits(at)
        for bits in (beyond + far for far in FAR_BITS):
            ball = {**at, self.problem.variable: acb(2) ** bits}
            roots = []
            for family in self.problem.families:
                zeros, parts = _without_zeros(specialised(family.whole, exact), ball)
                found = [acb(0)] * zeros + solved(parts)
                roots.append([x for x in found if abs(x) < 1])
                if len(roots[-1]) != family.decaying:
                    raise Open
            scale = sum(
                max((degree(c, self.problem.variable) for *_, c in row), default=0) for row in self.problem.rows
            )
            sizes.append(abs(self._delta(roots, ball) / acb(2) ** (bits * scale)))
        least = sizes[0] * 2.0 ** -FAR_BITS[0]
        if not sizes[1] > least and not sizes[1] <= least:
            raise Open
        return bool(sizes[1] > least)

    def _ratio_bits(self, at: Mapping[str, acb]) -> int:
        """log2 of the largest ratio of two coefficients, of symbols and closure, roughly."""
        polynomials = [f.whole for f in self.problem.families] + [c for row in self.problem.rows for *_, c in row]
        parts = [c for f in polynomials for part in parts_of(f, self.problem.variable) for c in parts_of(part, "x")]
        sizes = [c.abs_lower().man_exp() for c in (enclose(part, at) for part in parts) if not c.contains(0)]
        exponents = [int(exponent) + int(mantissa).bit_length() for mantissa, exponent in sizes]
        return max(exponents) - min(exponents) if exponents else 0

    def _inner_at_infinity(self, at: Mapping[str, acb]) -> bool:
        """Whether no s tends to infinity here, or the z it is mapped to then are inside the circle; Open otherwise."""
        assert self.problem.time_map is not None
        leads = [enclose(parts_of(f, "s")[-1], at) for f in self.own]
        if all(not lead.contains(0) for lead in leads):
            return True
        far = solved([enclose(c, at) for c in parts_of(parts_of(self.problem.time_map, "s")[-1], "z")])
        if not all(abs(z) < 1 for z in far):
            raise Open
        return True

    def stable_near(self, p: Fraction, lam: Fraction, place: Callable[[int], acb]) -> bool:
        """At an algebraic parameter value ``place(bits)`` and a rational lam on no curve; ``p`` is a rational value.

        The interior has to be free of the parameter.
        """
        if any(degree(growth, "p") for growth in self.problem.growth):
            raise Unsupported("an interior that depends on the parameter, at an irrational value of it")
        if not interior_holds(self.problem, p, lam):
            return False
        return self.at_point(lambda bits: {"p": place(bits), **_balls({"lam": lam})}, {"lam": lam}) == "stable"

    def on_curve(self, p: Fraction, lam: Fraction) -> str:
        """The verdict at a rational point, exactly: "stable", "neutral", "generalized" or "unstable"."""
        if not interior_holds(self.problem, p, lam):
            return "unstable"
        at = {"p": p, "lam": lam}
        return self._worst(lambda bits: _balls(at), at)

    def at_point(self, ends: Ends, exact: Mapping[str, Fraction] | None = None) -> str:
        """The verdict of the closure where (p, lam) is given by ``ends(bits)``, balls: "stable", "neutral",
        "generalized".

        "unstable" for a growing mode, or where the interior, the limit of Cauchy-stable ones, is not. What holds at
        algebraic points is told by balls: what they do not tell from the circle counts as on it. ``exact`` is the
        coordinate that is rational, if one is.
        """
        return self._worst(ends, exact or {})

    def _worst(self, ends: Ends, exact: Mapping[str, Fraction]) -> str:
        for bits in LADDER[1:]:
            with ctx.workprec(bits):
                try:
                    growth = () if _whole(exact) else (specialised(g, exact) for g in self.problem.growth)
                    if not all(limit_holds(g, ends(bits)) for g in growth):
                        return "unstable"
                    if not self.determines(ends(bits), exact):
                        return "unstable"
                    modes = [mode for mode in self._modes(ends(bits), exact) if mode.zero]
                except Open:
                    continue
                if any(not mode.on_circle for mode in modes):
                    return "unstable"
                if any(mode.needs_limit for mode in modes):
                    return "generalized"
                return "neutral" if modes else "stable"
        raise Rejected("the verdict at a point of a curve is not verified")

    # Closure --------------------------------------------------------------------------------------------------------

    def _modes(self, ball: Mapping[str, acb], exact: Mapping[str, Fraction]) -> Iterator[_Mode]:
        on_circle = [z for f in self.mapped for z in _unimodular(specialised(f, exact))] if _whole(exact) else None
        for f in self.own:
            for sigma in _roots(f, self.problem.variable, ball, exact):
                for z in self._images(sigma, ball):
                    place = _place(z, on_circle)
                    if place >= 0:
                        yield self._mode({**ball, self.problem.variable: sigma, "z": z}, place == 0, exact)

    def _images(self, sigma: acb, ball: Mapping[str, acb]) -> list[acb]:
        if self.problem.time_map is None:
            return [sigma]
        parts = [enclose(c, {**ball, "s": sigma}) for c in parts_of(self.problem.time_map, "z")]
        try:
            return solved(parts)
        except Open:
            return [root for found in deflated(parts) for root in found]

    def _mode(self, at: Mapping[str, acb], on_circle: bool, exact: Mapping[str, Fraction]) -> _Mode:
        chosen, limiting = [], False
        here = {**exact, **self._rational(at, exact)}  # a spatial root may be 0 or infinite there, exactly
        others: list[list[list[acb]]] = []
        for family in self.problem.families:
            whole, part = (specialised(each, here) for each in (family.whole, family.part))
            roots, double = _with_double(whole, at)
            inside = [x for x in roots if abs(x) < 1]
            straddling = [x for x in roots if not abs(x) < 1 and not abs(x) > 1]
            if (straddling or double) and not on_circle:
                raise Open
            # Of two branches that meet on the circle one comes from inside: they leave in opposite directions.
            moving = specialised(family.whole, exact)
            coming = double + [x for x in straddling if self._comes_from_inside(moving, {**at, "x": x})]
            roots = roots + double
            mine = inside + coming
            if len(mine) != family.decaying:
                raise Open
            chosen.append(mine)
            limiting = limiting or bool(coming)
            kept = [x for found in _with_double(part, at) for x in found]
            sheets = [x for x in roots if any(x.overlaps(y) for y in kept)]
            others.append([list(c) for c in combinations(sheets, family.decaying)])
        delta = self._delta(chosen, at)
        if not delta.contains(0):
            return _Mode(on_circle, False, False)
        for choice in product(*others):
            same = all({id(x) for x in a} == {id(x) for x in b} for a, b in zip(choice, chosen, strict=True))
            if not same and self._delta(choice, at).contains(0):
                self._all_zero(at, exact)  # else another choice may be the one that makes the norm vanish
                break
        return _Mode(on_circle, True, limiting and self._limit_needed(chosen, at))

    def _rational(self, at: Mapping[str, acb], exact: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """sigma, where it is rational over a rational point."""
        name = self.problem.variable
        factors = [univariate(specialised(f, exact), name).factor()[1] for f in self.own] if _whole(exact) else []
        lines = [list(g) for found in factors for g, _ in found if g.degree() == 1]
        values = [Fraction(-int(constant), int(slope)) for constant, slope in lines]
        return next(({name: value} for value in values if at[name].contains(_balls({name: value})[name])), {})

    def _all_zero(self, at: Mapping[str, acb], exact: Mapping[str, Fraction]) -> None:
        """Open unless every choice of spatial roots whose Delta holds 0, at any conjugate of sigma, has Delta = 0."""
        name = self.problem.variable
        found = (
            [g for f in self.own for g, _ in univariate(specialised(f, exact), name).factor()[1]]
            if _whole(exact)
            else []
        )
        mine = [g for g in found if any(root.overlaps(at[name]) for root in roots_of(g))]
        if len({str(g) for g in mine}) != 1:
            raise Open
        count = 0
        for sigma in roots_of(mine[0]):
            here = {**at, name: sigma, **({"z": sigma} if name == "z" else {})}
            sheets = [
                [list(c) for c in combinations(solved([enclose(c, here) for c in parts_of(part, "x")]), f.decaying)]
                for f in self.problem.families
                for part in [specialised(f.part, exact)]
            ]
            count += sum(self._delta(choice, here).contains(0) for choice in product(*sheets))
        if count != zeros_of_delta(self.problem, mine[0], exact):
            raise Open

    def _delta(self, roots: Sequence[Sequence[acb]], at: Mapping[str, acb]) -> acb:
        return ball_determinant(self._matrix(roots, at))

    def _matrix(self, roots: Sequence[Sequence[acb]], at: Mapping[str, acb]) -> list[list[acb]]:
        mine = [[acb(0)] * b.zeros + list(roots[b.family]) for b in self.problem.blocks]
        return kreiss(self.problem, mine, lambda c: enclose(c, at), acb(0), acb(1))

    def _limit_needed(self, roots: Sequence[Sequence[acb]], at: Mapping[str, acb]) -> bool:
        """Whether the columns that decay strictly are independent, so that a kernel vector needs the others."""
        columns = [list(column) for column in zip(*self._matrix(roots, at), strict=True)]
        strict = [[acb(0)] * b.zeros + list(roots[b.family]) for b in self.problem.blocks]
        kept = [c for c, x in zip(columns, [x for mine in strict for x in mine], strict=True) if abs(x) < 1]
        gram = [
            [sum((a * b.conjugate() for a, b in zip(one, other, strict=True)), acb(0)) for other in kept]
            for one in kept
        ]
        return not ball_determinant(gram).contains(0) if gram else True

    def _comes_from_inside(self, symbol: fmpz_mpoly, at: Mapping[str, acb]) -> bool:
        """Whether abs(x) falls below 1 as abs(z) grows: the sign of the real part of d log x / d log z."""
        along = enclose(symbol.derivative(self.problem.variable), at)
        if self.problem.time_map is not None:
            pi = self.problem.time_map
            along = -along * enclose(pi.derivative("z"), at) / enclose(pi.derivative("s"), at)
        rate = (-at["z"] * along / (at["x"] * enclose(symbol.derivative("x"), at))).real
        if not (rate < 0 or rate > 0):
            raise Open
        return bool(rate < 0)


def _balls(values: Mapping[str, Fraction]) -> dict[str, acb]:
    return {name: acb(fmpq(v.numerator, v.denominator)) for name, v in values.items()}


def _whole(exact: Mapping[str, Fraction]) -> bool:
    """Whether a point is rational, in both its coordinates."""
    return len(exact) == 2


def _roots(f: fmpz_mpoly, name: str, ball: Mapping[str, acb], exact: Mapping[str, Fraction]) -> list[acb]:
    """The distinct roots, in disjoint balls."""
    if not _whole(exact):
        parts = [enclose(c, ball) for c in parts_of(specialised(f, exact), name)]
        while len(parts) > 1 and parts[-1].contains(0):
            parts.pop()  # a root may be at infinity here, of which `determines` speaks
        try:
            return solved(parts)
        except Open:
            return [root for found in deflated(parts) for root in found]
    poly = univariate(specialised(f, exact), name)
    return isolated(poly)


def _with_double(symbol: fmpz_mpoly, at: Mapping[str, acb]) -> tuple[list[acb], list[acb]]:
    """The simple roots x, and a double one on the circle if that is what keeps the roots from being isolated."""
    zeros, parts = _without_zeros(symbol, at)
    none = [acb(0) for _ in range(zeros)]
    try:
        return none + solved(parts), []
    except Open:
        simple, double = deflated(parts)
        if not all(abs(x).contains(1) for x in double):
            raise
        return none + simple, double


def _without_zeros(symbol: fmpz_mpoly, at: Mapping[str, acb]) -> tuple[int, list[acb]]:
    """How often x = 0 is a root, exactly, and the other factor's coefficients: a scheme may be a shift at a point."""
    parts = parts_of(symbol, "x")
    zeros = next((k for k, part in enumerate(parts) if not part.is_zero()), 0)
    return zeros, [enclose(c, at) for c in parts[zeros:]]


def _unimodular(f: fmpz_mpoly) -> list[acb]:
    """Balls of the roots z that are exactly on the circle."""
    found = []
    for g, _ in univariate(f, "z").factor()[1]:
        turned = fmpz_poly(list(g)[::-1])
        if turned not in (g, -g):
            continue
        roots = roots_of(g)
        for root in roots:
            image = 1 / root.conjugate()
            if abs(root).contains(1) and [r for r in roots if r.overlaps(image)] == [root]:
                found.append(root)
    return found


def _place(z: acb, on_circle: Sequence[acb] | None) -> int:
    """-1 inside, 0 on the circle, 1 outside."""
    if abs(z) < 1:
        return -1
    if abs(z) > 1:
        return 1
    if on_circle is not None and not any(z.overlaps(each) for each in on_circle):
        raise Open
    return 0
