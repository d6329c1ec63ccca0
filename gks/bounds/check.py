"""``check``: a certificate verified from scratch.

Nothing of the prover is used: the scheme is read, its curves are derived and its verdicts found by this checker's own
means (``checkderive``, ``checkpoint``), and every number of the certificate is held against them:

1. every curve that the checker derives is in the certificate;
2. the cuts are exactly the roots, in the domain, of the leading and last coefficients, the discriminants and the
   resultants of the certificate's curves, and of its walls;
3. over every cell, at its sample, the verdict between any two neighbouring curves is what the stable set says, and
   curves inside a stable interval are harmless;
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

from flint import arb, ctx, fmpz_mpoly

from gks.bounds.checkcells import CellCheck
from gks.bounds.checkcuts import CutCheck
from gks.bounds.checkformula import Rejected
from gks.bounds.checkjudges import Judges
from gks.bounds.checkline import verify_line
from gks.bounds.checknumbers import BITS, Real, ball_of, digest, fraction, real_roots, univariate
from gks.bounds.checkpieces import verify_pieces, verify_single
from gks.bounds.checkring import Unsupported, degree, factors, irreducible, parts_of
from gks.errors import GksError, counted
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme


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
    """Verify a certificate, as ``to_json`` of a theorem gives it. Never raises for what it says, however it is
    altered.
    """
    start = perf_counter()
    steps: list[str] = []
    problem = None
    try:
        with ctx.workprec(BITS):
            _Checker(certificate, steps).run()
    except (Rejected, Unsupported, GksError) as reason:
        problem = str(reason)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, ZeroDivisionError, OverflowError) as reason:
        problem = f"the certificate is malformed ({type(reason).__name__}: {reason})"
    return Check(problem, tuple(steps), perf_counter() - start)


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
        self.judges = Judges(self.scheme, self.fixed, self.parameter)

    def run(self) -> None:
        if self.parameter is None:
            self.domain: tuple[Fraction | None, Fraction | None] = (None, None)
            spans = self.intervals(self.data["stable_set"])
            pieces = self.data["pieces"]
            if len(pieces) != 1 or any(pieces[0][key] is not None for key in ("from", "to", "from_value", "to_value")):
                raise Rejected("a theorem without a parameter has one piece")
            verify_line(self.scheme, self.fixed, spans, pieces[0]["at_bound"])
            verify_single(pieces[0], spans, self.scheme.cfl)
            self.steps.append("the stable set derived and verified anew")
            return
        bottom, top = self.data["domain"]
        self.domain = (None if bottom == "-oo" else fraction(bottom), None if top == "oo" else fraction(top))
        self.curves = [self.polynomial(text, "lam") for text in self.data["curves"]]
        self.walls = [self.polynomial(text, "p") for text in self.data["walls"]]
        self.cuts = [CutCheck(self, entry) for entry in self.data["cuts"]]
        self.cells = [CellCheck(self, k, entry) for k, entry in enumerate(self.data["cells"])]
        if len(self.cells) != len(self.cuts) + 1:
            raise Rejected("cells and cuts do not alternate")
        self.all_cuts()
        for cell in self.cells:
            cell.inside()
        self.all_curves()
        for cell in self.cells:
            cell.verdicts()
        self.steps.append(f"{counted(len(self.cells), 'cell')}: every verdict verified at the samples")
        for k, cut in enumerate(self.cuts):
            cut.verify(self.cells[k], self.cells[k + 1])
        self.steps.append(f"{counted(len(self.cuts), 'cut')} verified")
        verify_pieces(self.data["pieces"], self)
        self.steps.append(f"{counted(len(self.data['pieces']), 'piece')}: formulas and numbers verified")

    # Reading --------------------------------------------------------------------------------------------------------

    def polynomial(self, text: object, main: str) -> fmpz_mpoly:
        """A boundary curve, or a wall: an irreducible polynomial that holds ``main``, walls no lam."""
        found = irreducible(text, {self.scheme.cfl: "lam", str(self.parameter): "p"})
        if not degree(found, main) or (main == "p" and degree(found, "lam")):
            raise Rejected(f"{text!r} is not a polynomial in the right variables")
        return found

    def root(self, entry: Sequence[Any], name: str) -> Real:
        """An algebraic number: an irreducible polynomial in ``name`` and its place among the real roots."""
        text, place = entry
        poly = univariate(irreducible(text, {name: "x"}), "x")
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

    # Curves and cuts ------------------------------------------------------------------------------------------------

    def all_curves(self) -> None:
        given = {str(c) for c in (*self.curves, *self.walls)}
        if len(given) != len(self.curves) + len(self.walls):
            raise Rejected("a curve is listed twice")
        for cell in self.cells:
            cell.call(self.judges)
        own = self.judges.curves()
        for text in own:
            if text not in given:
                raise Rejected(f"the boundary curve {text} is missing")
        self.steps.append(f"{counted(len(own), 'boundary curve')} derived anew, all of them in the certificate")

    def all_cuts(self) -> None:
        """The cuts are exactly the critical parameters of the curves."""
        critical = {str(wall): wall for wall in self.walls}
        for curve in self.curves:
            parts = parts_of(curve, "lam")
            loci = [parts[-1], parts[0]] + ([curve.discriminant("lam")] if len(parts) > 2 else [])
            critical |= {str(f): f for locus in loci for f, _ in factors(locus) if degree(f, "p")}
        for one, other in combinations(self.curves, 2):
            critical |= {str(f): f for f, _ in factors(one.resultant(other, "lam")) if degree(f, "p")}
        places = []
        for poly in (univariate(each, "p") for each in critical.values()):
            places += [(poly, k + 1, r) for k, r in enumerate(real_roots(poly)) if self.in_domain(r)]
        found = {(tuple(int(c) for c in list(poly)), k) for poly, k, _ in places}
        given = [(tuple(int(c) for c in list(cut.root.poly)), cut.root.place) for cut in self.cuts]
        if found != set(given) or len(given) != len(found):
            raise Rejected("the cuts are not the critical parameters of the curves")
        for left, right in pairwise(self.cuts):
            if not left.root.ball() < right.root.ball():
                raise Rejected("the cuts are not in order")
        self.steps.append(f"{counted(len(found), 'critical parameter')} found anew, the cuts of the certificate")
