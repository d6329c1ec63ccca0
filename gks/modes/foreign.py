"""Zeros of a coupled problem's determinant that belong to the field w and not to the closure.

Where c(x) vanishes at a spatial root, w gives no solution there (``coupled``), its column of the Kreiss matrix is zero,
and so is the determinant, whatever the closure says.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from flint import acb, ctx, fmpz_mpoly

from gks.modes.admissible import Candidate, point_of
from gks.modes.algebraic import Root
from gks.modes.coupled import CoupledField
from gks.modes.fibre import VanishesIdentically, at_balls, fibre
from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import Block, NormalModeProblem
from gks.modes.numerals import text_complex

if TYPE_CHECKING:
    from gks.modes.polish import Found
    from gks.modes.wide import WideModes

OUTPUT_BITS = 80
"""Precision of the coordinates at which c is looked at; only whether it is told from 0 depends on it."""


class ForeignZeros:
    """Where the determinant of a coupled problem vanishes for a reason of its own: some c does, at a spatial root.

    With t an indeterminate, sum_u t**u c_u(x) is zero for all t at a common root x of D and all c_u, and only there; so
    there is one exactly when the resultant with D in x is zero as a polynomial in t.
    """

    def __init__(self, problem: NormalModeProblem) -> None:
        self._problem = problem
        self._loci: list[_Locus] | None = None

    def hold(self, candidate: Candidate, factor: fmpz_mpoly) -> bool:
        """Whether a candidate, a zero of the irreducible ``factor``, is such a point."""
        if self._problem.coefficients.generators:
            return _foreign(self._problem, candidate)
        if self._loci is None:
            self._loci = [_locus(self._problem, b) for b in self._problem.blocks if isinstance(b.field, CoupledField)]
        for locus in self._loci:
            if divmod(locus.lead, factor)[1].is_zero():
                return _foreign(self._problem, candidate)
            if any(all(divmod(p, factor)[1].is_zero() for p in parts) for parts in locus.alternatives):
                return True
        return False


@dataclass(frozen=True, slots=True)
class _Locus:
    """One of the ``alternatives`` vanishes entirely where c vanishes at a spatial root, unless ``lead`` does."""

    lead: fmpz_mpoly
    alternatives: tuple[tuple[fmpz_mpoly, ...], ...]


def _locus(problem: NormalModeProblem, block: Block) -> _Locus:
    assert isinstance(block.field, CoupledField)
    symbol = problem.families[block.family].polynomial
    t = problem.coefficients.gens["k0"]
    mixed = sum((c * t**u for u, c in enumerate(block.field.column)), problem.coefficients.context.constant(0))
    alternatives = [tuple(powers_of(symbol.resultant(mixed, "x"), "k0"))]
    if block.zeros:
        alternatives.append(tuple(powers_of(c, "x")[0] for c in block.field.column if not c.is_zero()))
    return _Locus(powers_of(symbol, "x")[-1], tuple(alternatives))


def _foreign(problem: NormalModeProblem, candidate: Candidate) -> bool:
    """The same by the spatial roots themselves."""
    point = point_of(problem, candidate)
    for block in problem.blocks:
        if isinstance(block.field, CoupledField):
            zeros = [Root.of(0)] if block.zeros else []
            try:
                roots = [each.root for each in fibre(point, problem.families[block.family].polynomial, "x")]
            except VanishesIdentically:
                return True
            if any(block.field.vanishes(point, root) for root in zeros + roots):
                return True
    return False


def genuine(problem: NormalModeProblem, counted: WideModes) -> WideModes:
    """What a count of zeros says of a coupled problem: without the zeros that may be the field's, which become doubts.

    A mode makes the determinant vanish all the same, so no zero means no mode.
    """
    kept = replace(counted, modes=[], places=[], doubts=list(counted.doubts))
    for mode, place in zip(counted.modes, counted.places, strict=True):
        if not isinstance(place, Candidate) and _gives_solutions(problem, place):
            kept.modes.append(mode)
            kept.places.append(place)
        elif mode.modulus >= 1:
            kept.certified = False
            kept.doubts.append(f"the interior is coupled, and a zero at z = {text_complex(mode.z)} may be no mode")
    return kept


def _gives_solutions(problem: NormalModeProblem, place: Found) -> bool:
    """Whether balls prove that no c vanishes at a decaying spatial root."""
    sigma = place.sigma(problem)
    if sigma is None:
        return False
    with ctx.workprec(OUTPUT_BITS):
        at = {name: root.ball(OUTPUT_BITS) for name, root in problem.coefficients.point().items()}
        at[problem.variable] = sigma
        return not any(
            all(at_balls(c, {**at, "x": x}).contains(0) for c in block.field.column)
            for block in problem.blocks
            if isinstance(block.field, CoupledField)
            for x in (*place.roots[block.family], *([acb(0)] if block.zeros else []))
        )
