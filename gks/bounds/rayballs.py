"""The stable lam of one mode in ball arithmetic: every end enclosed, at any precision.

The scalar way of `gks.bounds.rays`, for points that the batched arithmetic leaves open and for its tables. lam > 0 is
cut at the positive roots of the exact polynomials of `gks.bounds.raypolynomial`; in each piece the Schur-Cohn recursion
decides at one point. What a ball cannot decide is None, never a guess: ask again with more bits.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

from flint import acb, acb_poly, arb, arb_poly, ctx, fmpq

from gks.bounds.raypolynomial import RayPolynomial, ray_polynomial, real_axis_polynomials
from gks.scheme.integrators import Integrator

Interval = tuple[arb, arb | None]
"""An open interval of lam, None for an infinite end."""


def stable_intervals_ball(method: Integrator, s: acb, bits: int) -> list[Interval] | None:
    """All lam > 0 for which every root z of pi(z, lam s) has abs(z) < 1, as open intervals, ascending.

    A part of s that is exactly zero is taken as exact: s then lies on an axis, where the crossings are found there.
    None where the ball of s, at this precision, leaves a sign or the simplicity of a crossing open.
    """
    with ctx.workprec(bits):
        if s.contains(0):
            return [] if s == 0 else None
        if method.kind == "exact":
            return _where_real_part_is_negative(s)
        polynomial = ray_polynomial(method.name)
        if polynomial is None or (polynomial.first_sign_decides and _vanishes(polynomial, s)):
            return []
        cuts = _cuts(method, polynomial, s)
        return None if cuts is None else _stable_pieces(method, s, cuts)


def _where_real_part_is_negative(s: acb) -> list[Interval] | None:
    if s.real < 0:
        return [(arb(0), None)]
    return [] if s.real >= 0 else None


def _cuts(method: Integrator, polynomial: RayPolynomial, s: acb) -> list[arb] | None:
    """The lam at which stability may change, ascending and disjoint; None if they are not told apart."""
    if s.imag == 0:
        rows = [[_rational(c) * s.real**k for k, c in enumerate(p)] for p in real_axis_polynomials(method.name)]
    else:
        square = s.real * s.real + s.imag * s.imag
        rows = [
            [sum((_rational(q) * s.real**j * square**m for j, m, q in row), arb(0)) for row in polynomial.terms]
        ]
    found: list[arb] = []
    for coefficients in rows:
        some = positive_roots(coefficients)
        if some is None:
            return None
        found += some
    found.sort(key=lambda root: float(root.mid()))
    apart = all(first < second for first, second in pairwise(found))
    return found if apart else None


def _vanishes(polynomial: RayPolynomial, s: acb) -> bool:
    """Whether abs(z) = 1 all along the ray: Crank-Nicolson on the imaginary axis."""
    return s.real == 0 and all(j > 0 for row in polynomial.terms for j, _, _ in row)


def positive_roots(coefficients: Sequence[arb]) -> list[arb] | None:
    """The positive roots of a real polynomial (ascending coefficients), all enclosed; None unless all roots are simple.

    Exact zeros at either end are taken off first: a root at exactly 0 is no positive one.
    """
    kept = list(coefficients)
    while kept and kept[-1] == 0:
        kept.pop()
    while kept and kept[0] == 0:
        kept.pop(0)
    if not kept or kept[-1].contains(0):
        return None
    if len(kept) == 1:
        return []
    try:
        every = acb_poly(kept).roots()
    except ValueError:  # FLINT: not square-free, or not enough precision to tell
        return None
    real = [root for root in every if root.imag.contains(0)]
    if any(root.real.contains(0) or not _is_its_own_conjugate(root, every) for root in real):
        return None
    return [_sharpened(arb_poly(kept), root.real) for root in real if root.real > 0]


def _is_its_own_conjugate(root: acb, every: Sequence[acb]) -> bool:
    """A root of a real polynomial in an isolating ball is real if the mirror image of the ball meets no other ball."""
    return sum(bool(root.conjugate().overlaps(other)) for other in every) == 1


def _sharpened(polynomial: arb_poly, root: arb) -> arb:
    """Interval Newton: contract an isolating ball until it no longer shrinks."""
    slope = polynomial.derivative()
    while True:
        centre = root.mid()
        step = centre - polynomial(centre) / slope(root)
        if not step.is_finite() or not step.overlaps(root):
            return root
        smaller = root.intersection(step)
        if not smaller.rad() < root.rad() / 2:
            return smaller
        root = smaller


def _stable_pieces(method: Integrator, s: acb, cuts: Sequence[arb]) -> list[Interval] | None:
    """Decide each piece between the cuts at a rational point."""
    ends: list[arb | None] = [*cuts, None]
    low, pieces = arb(0), []
    for high in ends:
        sample = (2 * low.mid() + 1 if low > 0 else _size_of_one(s)) if high is None else (low.mid() + high.mid()) / 2
        stable = _all_inside(method, s * sample)
        if stable is None:
            return None
        if stable:
            pieces.append((low, high))
        if high is not None:
            low = high
    return pieces


def _size_of_one(s: acb) -> arb:
    """Some lam with abs(lam s) about 1."""
    return arb(1) / abs(s).mid()


def _all_inside(method: Integrator, mu: acb) -> bool | None:
    """Schur-Cohn: all roots of a_0 + … + a_k z**k lie inside the circle iff |a_0| < |a_k| and the same holds for
    (conj(a_k) p - a_0 p*) / z, of one degree less."""
    p = [sum((_rational(c) * mu**k for k, c in enumerate(row)), acb(0)) for row in method.characteristic()]
    while len(p) > 1:
        gap = _square(p[-1]) - _square(p[0])
        if gap < 0:
            return False
        if not gap > 0:
            return None
        reverse = [c.conjugate() for c in reversed(p)]
        p = [p[-1].conjugate() * a - p[0] * b for a, b in zip(p, reverse, strict=True)][1:]
    return True


def _square(z: acb) -> arb:
    return z.real * z.real + z.imag * z.imag


def _rational(value: Fraction) -> fmpq:
    return fmpq(value.numerator, value.denominator)
