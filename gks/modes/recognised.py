"""The algebraic number that a zero of Delta known to many digits seems to be.

Lattice reduction (Lenstra, Lenstra & Lovász, Math. Ann. 261 (1982) 515-534) finds the integer polynomial of a given
degree with the shortest coefficients that is small at the number. A number that is no root of a short one gives
coefficients that use up all its digits. What is found proposes; exact algebra decides whether Delta vanishes there.
"""

from __future__ import annotations

from flint import acb, arb, ctx, fmpz_mat, fmpz_poly

from gks.modes.admissible import Candidate
from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root, primitive
from gks.modes.candidates import candidates_of
from gks.modes.fibre import embed
from gks.modes.kreiss import NormalModeProblem
from gks.modes.polynomial import Factor

DEGREES = (1, 2, 4, 8, 12, 16)
"""Degrees tried in turn: that of 16 takes a tenth of a second at the precision that zeros are polished to."""
SPARE_BITS = 2 * START_BITS
"""Digits that a recognised polynomial leaves unused: by chance one does so once in 2**128."""


def candidate_at(problem: NormalModeProblem, sigma: acb, z: acb) -> Candidate | None:
    """The point on the unit circle that balls of the problem's variable and of z seem to hold; None where none does."""
    polynomial = _shortest(sigma)
    if polynomial is None:
        return None
    factor = Factor(embed(polynomial, problem.coefficients.context, problem.variable), 1)
    for candidate in candidates_of(problem, factor):
        on_circle = candidate.position is Position.ON and (candidate.z is None or candidate.z.ball().overlaps(z))
        if on_circle and holds(sigma, candidate.sigma):
            return candidate
    return None


def holds(ball: acb, root: Root) -> bool:
    """Whether a ball is seen to hold an algebraic number."""
    bits = ball.rel_accuracy_bits() + START_BITS
    return bool(ball.contains(root.ball(bits)))


def _shortest(number: acb) -> fmpz_poly | None:
    bits = number.rel_accuracy_bits()
    for degree in DEGREES:
        with ctx.workprec(bits + GUARD_BITS):
            scale = arb(2) ** (bits - GUARD_BITS)
            rows = [[int(j == k) for j in range(degree + 1)] for k in range(degree + 1)]
            power = acb(1)
            for row in rows:
                row += [int((part.mid() * scale).floor().mid().unique_fmpz() or 0) for part in (power.real, power.imag)]
                power *= number
        found = fmpz_mat(rows).lll()
        coefficients = [int(found[0, k]) for k in range(degree + 1)]
        if sum(abs(c).bit_length() for c in coefficients) + SPARE_BITS < bits - GUARD_BITS:
            with ctx.workprec(bits + GUARD_BITS):
                for factor, _ in fmpz_poly(coefficients).factor()[1]:
                    if factor.degree() and factor(number).contains(0):
                        return primitive(factor)
    return None
