"""``check``: a certificate verified from scratch.

Nothing of the prover is used: the scheme is read, its curves are derived and its verdicts found by this checker's own
means (``checkderive``, ``checkpoint``), and every number of the certificate is held against them:

1. every curve that the checker derives is in the certificate;
2. the cuts are exactly the roots, in the domain, of the leading and last coefficients, the discriminants and the
   resultants of the certificate's curves, and of its walls;
3. over every cell, at its sample, the verdict between any two neighbouring curves is what the stable set says, and curves
   inside a stable interval are harmless;
4. on every cut likewise;
5. the pieces say, in formulas and in numbers, what the cells say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations, pairwise
from time import perf_counter
from typing import Any

from flint import acb, arb, ctx, fmpz_mpoly, fmpz_poly

from gks.bounds.checkderive import GEN, ONE, RING, Fr, Unsupported, curves, degree, derive, factors, parts_of
from gks.bounds.checkformula import Rejected, read
from gks.bounds.checkline import line, verdict_on, verify_line
from gks.bounds.checknumbers import (
    BITS,
    Real,
    ball_of,
    close,
    digest,
    exact as _exact,
    fraction,
    gaps_between,
    near_positive,
    positive,
    real_root_of,
    real_roots,
)
from gks.bounds.checkpieces import verify_pieces, verify_single
from gks.bounds.checkpoint import Judge, univariate
from gks.errors import GksError
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

NEARBY = Fraction(1, 1 << 160)
"""How far beside a cut the curves are looked at, relatively: a meeting of m curves is apart by its m-th root there."""

MEETING_RADIUS = 2.0**-30
"""Relative radius of the balls around such points; a fifth root of NEARBY is less."""


@dataclass(frozen=True, slots=True)
class Check:
    """What became of a certificate; ``problem`` says what does not hold, None where all does."""

    problem: str | None
    steps: tuple[str, ...]
    time_s: float = field(compare=False)

    @property
    def accepted(self) -> bool:
        return self.problem is None

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.check/1",
            "accepted": self.accepted,
            "problem": self.problem,
            "steps": list(self.steps),
            "time_s": self.time_s,
        }

    def __str__(self) -> str:
        head = "accepted" if self.accepted else f"rejected: {self.problem}"
        return "\n".join([head, *(f"  {step}" for step in self.steps), f"  ({self.time_s:.3g} s)"])


def check(certificate: Mapping[str, Any]) -> Check:
    """Verify a certificate, as ``to_json`` of a theorem gives it. Never raises for what it says, however it is altered."""
    start = perf_counter()
    steps: list[str] = []
    problem = None
    try:
        with ctx.workprec(BITS):
            _Checker(certificate, steps).run()
    except (Rejected, Unsupported, GksError) as reason:
        problem = str(reason)
    except () as reason:
        pass
    except (ZeroDivisionError,) as reason:
        problem = f"the certificate is malformed ({type(reason).__name__}: {reason})"
    return Check(problem, tuple(steps), perf_counter() - start)


class _Polynomials:
    """Formulas read as rational functions."""

    def integer(self, value: int) -> _Function:
        return _Function(Fr(RING.constant(value), ONE))

    def sqrt(self, value: object) -> object:
        raise Rejected("a square root in a polynomial")


class _Function:
    def __init__(self, value: Fr) -> None:
        self.value = value

    def __add__(self, other: _Function) -> _Function:
        return _Function(self.value + other.value)

    def __sub__(self, other: _Function) -> _Function:
        return _Function(self.value - other.value)

    def __neg__(self) -> _Function:
        return _Function(Fr(-self.value.num, self.value.den))

    def __mul__(self, other: _Function) -> _Function:
        return _Function(self.value * other.value)

    def __pow__(self, exponent: int) -> _Function:
        return _Function(self.value**exponent)


class _Checker:
    def __init__(self, certificate: Mapping[str, Any], steps: list[str]) -> None:
        self.data, self.steps = certificate, steps
        if certificate["schema"] != "gks.certificate/1":
            raise Rejected("this is no certificate of version 1")
        if certificate["digest"] != digest(certificate):
            raise Rejected("the certificate was altered after it was written")
        self.scheme: Scheme = parse_scheme(certificate["scheme"], str(certificate["name"]))
        self.parameter: str | None = certificate["parameter"]
        self.fixed = {str(n): fraction(v) for n, v in certificate["values"].items()}
        names = {p.name for p in self.scheme.parameters}
        if {*self.fixed, self.scheme.cfl, *([self.parameter] if self.parameter else [])} != names:
            raise Rejected("the values do not match the scheme's parameters")
        self.judges: dict[tuple[str, ...], Judge] = {}

    def run(self) -> None:
        if self.parameter is None:
            self.domain: tuple[Fraction | None, Fraction | None] = (None, None)
            spans = self.intervals(self.data["stable_set"])
            pieces = self.data["pieces"]
            if len(pieces) != 1:
                raise Rejected("a theorem without a parameter has one piece")
            verify_line(self.scheme, self.fixed, spans, pieces[0]["at_bound"])
            verify_single(pieces[0], spans, self.scheme.cfl)
            self.steps.append("the stable set derived and verified anew")
            return
        bottom, top = self.data["domain"]
        self.domain = (None if bottom == "-oo" else fraction(bottom), None if top == "oo" else fraction(top))
        self.curves = [self.polynomial(text, "lam") for text in self.data["curves"]]
        self.walls = [self.polynomial(text, "p") for text in self.data["walls"]]
        self.cuts = [_Cut(self, entry) for entry in self.data["cuts"]]
        self.cells = [_CellCheck(self, k, entry) for k, entry in enumerate(self.data["cells"])]
        if len(self.cells) != len(self.cuts) + 1:
            raise Rejected("cells and cuts do not alternate")
        self.all_cuts()
        for cell in self.cells:
            cell.inside()
        self.all_curves()
        for cell in self.cells:
            cell.verdicts()
        self.steps.append(f"{len(self.cells)} cells: every verdict verified at the samples")
        for k, cut in enumerate(self.cuts):
            cut.verify(self.cells[k], self.cells[k + 1])
        self.steps.append(f"{len(self.cuts)} cuts verified")
        verify_pieces(self.data["pieces"], self)
        self.steps.append(f"{len(self.data['pieces'])} pieces: formulas and numbers verified")

    # Reading --------------------------------------------------------------------------------------------------------------

    def polynomial(self, text: object, main: str) -> fmpz_mpoly:
        """An irreducible, primitive polynomial that holds ``main``, leading coefficient positive."""
        names = {self.scheme.cfl: _Function(Fr(GEN["lam"], ONE))}
        if self.parameter is not None:
            names[self.parameter] = _Function(Fr(GEN["p"], ONE))
        value = read(text, _Polynomials(), names).value
        if not value.den.is_one() or [(f, m) for f, m in factors(value.num)] != [(value.num, 1)]:
            raise Rejected(f"{text!r} is not irreducible, or not in lowest terms")
        if not degree(value.num, main) or (main == "p" and degree(value.num, "lam")):
            raise Rejected(f"{text!r} is not a polynomial in the right variables")
        return value.num

    def root(self, entry: Sequence[Any], name: str) -> Real:
        """An algebraic number: an irreducible polynomial in ``name`` and its place among the real roots."""
        text, place = entry
        value = read(text, _Polynomials(), {name: _Function(Fr(GEN["x"], ONE))}).value
        if not value.den.is_one() or [(f, m) for f, m in factors(value.num)] != [(value.num, 1)]:
            raise Rejected(f"{text!r} is not irreducible, or not in lowest terms")
        poly = univariate(value.num, "x")
        if not isinstance(place, int) or isinstance(place, bool) or not 1 <= place <= len(real_roots(poly)):
            raise Rejected(f"{text!r} has no real root number {place}")
        return Real(poly, place)

    def intervals(self, entries: Sequence[Any]) -> list[tuple[Real | None, Real | None]]:
        """Intervals of lam with algebraic ends."""
        found = []
        for low, high in entries:
            found.append(tuple(None if end is None else self.root(end, self.scheme.cfl) for end in (low, high)))
        return found  # type: ignore[return-value]

    def in_domain(self, value: arb) -> bool:
        low, high = self.domain
        return bool((low is None or value > ball_of(low)) and (high is None or value < ball_of(high)))

    # Curves and cuts ------------------------------------------------------------------------------------------------------

    def judge(self, p: Fraction, lam: Fraction) -> Judge:
        """The checker's own problem; it depends on the sample through signs of speeds and counts alone."""
        problem = derive(self.scheme, self.fixed, self.parameter, p, lam)
        key = (*(str(f.whole) for f in problem.families), *(str(f.decaying) for f in problem.families), str(problem.rows))
        if key not in self.judges:
            self.judges[key] = Judge(problem)
        return self.judges[key]

    def all_curves(self) -> None:
        given = {str(c) for c in (*self.curves, *self.walls)}
        if len(given) != len(self.curves) + len(self.walls):
            raise Rejected("a curve is listed twice")
        own: dict[str, fmpz_mpoly] = {}
        for cell in self.cells:
            cell.judge = self.judge(cell.sample, cell.stable_sample())
        for judge in self.judges.values():
            own |= curves(judge.problem)
        for text in own:
            if text not in given:
                raise Rejected(f"the boundary curve {text} is missing")
        self.steps.append(f"{len(own)} boundary curves derived anew, all of them in the certificate")

    def all_cuts(self) -> None:
        """The cuts are exactly the critical parameters of the curves."""
        critical: set[str] = {str(wall) for wall in self.walls}
        for curve in self.curves:
            parts = parts_of(curve, "lam")
            loci = [parts[-1], parts[0]] + ([curve.discriminant("lam")] if len(parts) > 2 else [])
            critical |= {str(f) for locus in loci for f, _ in factors(locus) if degree(f, "p")}
        for one, other in combinations(self.curves, 2):
            critical |= {str(f) for f, _ in factors(one.resultant(other, "lam")) if degree(f, "p")}
        places = []
        for text in critical:
            poly = univariate(read(text.replace("^", "**"), _Polynomials(), {"p": _Function(Fr(GEN["p"], ONE))}).value.num, "p")
            places += [(poly, k + 1, r) for k, r in enumerate(real_roots(poly)) if self.in_domain(r)]
        found = {(tuple(int(c) for c in list(poly)), k) for poly, k, _ in places}
        given = [(tuple(int(c) for c in list(cut.root.poly)), cut.root.place) for cut in self.cuts]
        if found != set(given) or len(given) != len(found):
            raise Rejected("the cuts are not the critical parameters of the curves")
        for one, other in pairwise(self.cuts):
            if not one.root.ball() < other.root.ball():
                raise Rejected("the cuts are not in order")
        self.steps.append(f"{len(found)} critical parameters found anew, the cuts of the certificate")


class _CellCheck:
    def __init__(self, owner: _Checker, index: int, entry: Mapping[str, Any]) -> None:
        self.owner, self.index = owner, index
        self.sample = fraction(entry["sample"])
        self.spans: list[tuple[tuple[int, int] | None, tuple[int, int] | None]] = [
            (_branch(low), _branch(high)) for low, high in entry["stable_set"]
        ]
        self.at_bound: str | None = entry["at_bound"]
        self.judge: Judge | None = None

    @property
    def ends(self) -> tuple[Real | None, Real | None]:
        cuts = self.owner.cuts
        return (cuts[self.index - 1].root if self.index else None), (cuts[self.index].root if self.index < len(cuts) else None)

    def inside(self) -> None:
        """The sample is the rational of least denominator in the cell."""
        low, high = self.ends
        here = ball_of(self.sample)
        if not self.owner.in_domain(here) or (low and not here > low.ball()) or (high and not here < high.ball()):
            raise Rejected(f"the sample {self.sample} is not in its cell")

    def value(self, branch: tuple[int, int], p: Fraction) -> arb:
        return positive(self.owner.curves[branch[0]], p)[branch[1] - 1]

    def levels(self, p: Fraction) -> list[tuple[arb, int]]:
        """All positive lam on curves over p, ascending, with the curve."""
        found = [(r, k) for k, curve in enumerate(self.owner.curves) for r in positive(curve, p)]
        found.sort(key=lambda each: _exact(each[0]))
        for (one, _), (other, _) in pairwise(found):
            if not one < other:
                raise Rejected(f"two curves meet at the sample {p}")
        return found

    def gaps(self, p: Fraction) -> list[Fraction]:
        return gaps_between([level for level, _ in self.levels(p)])

    def stated(self, p: Fraction, lam: Fraction) -> bool:
        """What the certificate says about a point on no curve."""
        here = ball_of(lam)
        return any(
            (low is None or self.value(low, p) < here) and (high is None or here < self.value(high, p)) for low, high in self.spans
        )

    def stable_sample(self) -> Fraction:
        """A lam that is said to be stable, where counts of decaying roots are meant to be taken; else a small one."""
        for lam in self.gaps(self.sample):
            if self.stated(self.sample, lam):
                return lam
        return self.gaps(self.sample)[0]

    def verdicts(self) -> None:
        judge = self.judge
        assert judge is not None
        p = self.sample
        levels, gaps = self.levels(p), self.gaps(p)
        said = [self.stated(p, lam) for lam in gaps]
        for lam, stable in zip(gaps, said, strict=True):
            if judge.stable(p, lam) is not stable:
                raise Rejected(f"at {self.owner.parameter} = {p}, lam = {lam} the verdict is not what the certificate says")
        self.structure([(level, stable) for (level, _), stable in zip(levels, pairwise(said), strict=True)])
        for k, ((_, curve), (below, above)) in enumerate(zip(levels, pairwise(said), strict=True)):
            if below and above:
                stands = any(end == (curve, self.place(curve, k)) for span in self.spans for end in span)
                verdict = verdict_on(judge, p, real_root_of(self.owner.curves[curve], p, self.place(curve, k)))
                if (verdict == "stable") == stands:
                    raise Rejected(f"at {self.owner.parameter} = {p} a curve inside the stable set is not as stated")
        self.bound(judge)

    def structure(self, levels: Sequence[tuple[arb, tuple[bool, bool]]]) -> None:
        """Every end of a stated interval is a level at which the statement changes, or splits."""
        ends = [self.value(end, self.sample) for span in self.spans for end in span if end is not None]
        flat = [(None if low is None else self.value(low, self.sample), None if high is None else self.value(high, self.sample)) for low, high in self.spans]
        for k, (low, high) in enumerate(flat):
            following = flat[k + 1] if k + 1 < len(flat) else None
            if low is not None and high is not None and not low < high:
                raise Rejected("an interval of the stable set is empty")
            if following is not None and (high is None or following[0] is None or following[0] < high):
                raise Rejected("the intervals of the stable set are not in order")
        for end in ends:
            if not any(level.overlaps(end) for level, _ in levels):
                raise Rejected("an end of the stable set is on no curve")

    def place(self, curve: int, level: int) -> int:
        return 1 + sum(1 for _, k in self.levels(self.sample)[:level] if k == curve)

    def bound(self, judge: Judge) -> None:
        """The verdict on the bound."""
        top = self.spans[0][1] if self.spans and self.spans[0][0] is None else None
        if (top is None) != (self.at_bound is None):
            raise Rejected("a verdict on the bound without a bound, or a bound without one")
        if top is not None:
            p = self.sample
            curve, place = self.owner.curves[top[0]], top[1]
            verdict = verdict_on(judge, p, real_root_of(curve, p, place))
            if verdict != self.at_bound:
                raise Rejected(f"on the bound at {self.owner.parameter} = {p} the scheme is {verdict}, not {self.at_bound}")


def _branch(entry: Any) -> tuple[int, int] | None:
    if entry is None:
        return None
    curve, place = entry
    if not (isinstance(curve, int) and isinstance(place, int) and curve >= 0 and place >= 1):
        raise Rejected(f"{entry!r} names no root of a curve")
    return curve, place


class _Cut:
    def __init__(self, owner: _Checker, entry: Mapping[str, Any]) -> None:
        self.owner = owner
        self.root = owner.root(entry["at"], str(owner.parameter))
        self.spans: list[tuple[Real | None, Real | None]] | None = None
        if entry["stable_set"] is not None:
            self.spans = owner.intervals(entry["stable_set"])
        self.at_bound: str | None = entry["at_bound"]
        if self.spans is None and self.at_bound is not None:
            raise Rejected("a verdict on the bound of a cut that has no bound of its own")

    def verify(self, left: _CellCheck, right: _CellCheck) -> None:
        wall = any(_same(univariate(w, "p"), self.root.poly) for w in self.owner.walls)
        if not wall and self.spans is None:
            self._points(left)
            return
        exact = self.root.rational
        if exact is None:
            raise Unsupported("the stable set on a cut at an irrational value")
        fixed = {**self.owner.fixed, str(self.owner.parameter): exact}
        if self.spans is not None:
            verify_line(self.owner.scheme, fixed, self.spans, self.at_bound)
            return
        found = line(self.owner.scheme, fixed)[0]
        for cell, side in ((left, -1), (right, 1)):
            self._limits(cell, exact + side * NEARBY * max(abs(exact), Fraction(1)), found)

    def _limits(self, cell: _CellCheck, p: Fraction, found: Sequence[tuple[Real | None, Real | None]]) -> None:
        """The stable set on a wall is the limit of the stable sets beside it."""
        beside = [tuple(None if end is None else cell.value(end, p) for end in span) for span in cell.spans]
        here = [tuple(None if end is None else end.ball() for end in span) for span in found]
        if len(beside) != len(here) or not all(
            (a is None) == (b is None) and (a is None or b is None or close(a, b))
            for one, other in zip(beside, here, strict=True)
            for a, b in zip(one, other, strict=True)
        ):
            raise Rejected(f"the stable set on the wall at {p} is not that of its neighbours")

    def _points(self, left: _CellCheck) -> None:
        """No curve point over the cut, inside the stable set, carries a mode: curves may meet or touch here.

        The points are those over a rational value so near that what meets at the cut is together; balls around them hold
        the true ones.
        """
        near = NEARBY * max(abs(_exact(self.root.ball())), Fraction(1))
        p = _exact(self.root.ball()) - near
        judge = left.judge
        assert judge is not None
        levels = [r for curve in self.owner.curves for r in near_positive(curve, p)]
        for level in levels:
            radius = abs(level) * 2.0**-20
            below, above = (_exact(level.mid() + sign * radius) for sign in (-1, 1))
            if below > 0 and left.stated(p, below) and left.stated(p, above):
                self._point(judge, level)

    def _point(self, judge: Judge, level: arb) -> None:
        root = self.root

        def ends(bits: int) -> dict[str, acb]:
            return {"p": acb(root.ball(bits)), "lam": acb(arb(level.mid(), abs(float(level.mid())) * MEETING_RADIUS))}

        if judge.at_point(ends) != "stable":
            raise Rejected(f"a mode on the circle at {self.owner.parameter} = {root.ball().str(10)} is not stated")


def _same(one: fmpz_poly, other: fmpz_poly) -> bool:
    return one in (other, -other)
