"""The unit circle in kappa, cut at algebraic points: exact unimodular roots and rational points between them.

Real polynomials take conjugate values at conjugate kappas, so the closed upper half circle stands for the whole. On it
t = tan(theta/2) runs from 0 (kappa = 1) to infinity (kappa = -1), and a rational t gives a point with rational real and
imaginary parts: kappa = (1 + i t)/(1 - i t).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from flint import acb, arb, ctx, fmpz_poly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root, isolated_roots, primitive, reciprocal


def unimodular_roots(poly: fmpz_poly) -> list[Root]:
    """The distinct roots of a nonzero ``poly`` with abs = 1 and imaginary part >= 0, from kappa = 1 to kappa = -1."""
    on_circle: list[Root] = []
    for factor, _ in primitive(poly).factor()[1]:
        # An irreducible polynomial with one root on the circle is, up to sign, its own reciprocal.
        if primitive(reciprocal(factor)) == primitive(factor):
            roots = isolated_roots(factor, is_square_free=True)
            on_circle += [root for root in roots if _upper(root) and root.position is Position.ON]
    # Distinct points of the closed upper half circle have distinct real parts.
    return by_real_part(on_circle)[::-1]


def _upper(root: Root) -> bool:
    if root.is_real:
        return True
    bits = START_BITS
    while True:
        imaginary = root.ball(bits).imag
        if imaginary > 0 or imaginary < 0:
            return bool(imaginary > 0)
        bits *= 2


def by_real_part(roots: Sequence[Root]) -> list[Root]:
    """Numbers with distinct real parts, ascending in these: balls are refined until they are apart."""
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            ordered = sorted((rational_ends(root.ball(bits).real), k) for k, root in enumerate(roots))
        if all(one[1] < other[0] for (one, _), (other, _) in pairwise(ordered)):
            return [roots[k] for _, k in ordered]
        bits *= 2


def arc_samples(roots: Sequence[Root]) -> list[Root]:
    """A rational point in each open arc of the half circle between ``roots``, listed as ``unimodular_roots`` does."""
    inner = [root for root in roots if not root.is_real]
    bits = START_BITS
    while True:
        with ctx.workprec(bits + GUARD_BITS):
            slopes = [(Fraction(0), Fraction(0)), *(_half_angle(root.ball(bits)) for root in inner)]
        if all(one[1] < other[0] for one, other in pairwise(slopes)):
            samples = [simplest_between(one[1], other[0]) for one, other in pairwise(slopes)]
            return [circle_point(t) for t in (*samples, simplest_between(slopes[-1][1], None))]
        bits *= 2


def _half_angle(kappa: acb) -> tuple[Fraction, Fraction]:
    """Rational ends of an interval around tan(theta/2) = im/(1 + re); (0, 0) where the ball is too wide for any."""
    slope = kappa.imag / (1 + kappa.real)
    return rational_ends(slope) if slope.is_finite() else (Fraction(0), Fraction(0))


def circle_point(t: Fraction) -> Root:
    """kappa = (1 + i t)/(1 - i t) for rational t > 0, as the upper root of its quadratic."""
    p, q = t.numerator, t.denominator
    return Root(primitive(fmpz_poly([q * q + p * p, 2 * (p * p - q * q), q * q + p * p])), 0)


def rational_ends(ball: arb) -> tuple[Fraction, Fraction]:
    """The two ends of a finite real ball, exactly (outwards to the working precision)."""
    return _exact(ball.lower()), _exact(ball.upper())


def _exact(number: arb) -> Fraction:
    mantissa, exponent = number.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def simplest_between(low: Fraction, high: Fraction | None) -> Fraction:
    """The fraction of least denominator in the open interval (low, high), 0 <= low; ``high`` None is infinity.

    Continued fractions: the walk down the Stern-Brocot tree, a run of equal turns at a time.
    """
    wholes: list[int] = []
    while True:
        whole = low.numerator // low.denominator
        if high is None or whole + 1 < high:
            break
        # Here whole <= low < high <= whole + 1, so the answer is whole + 1/y with y between the inverted remainders.
        wholes.append(whole)
        low, high = 1 / (high - whole), (1 / (low - whole) if low > whole else None)
    answer = Fraction(whole + 1)
    for earlier in reversed(wholes):
        answer = earlier + 1 / answer
    return answer
