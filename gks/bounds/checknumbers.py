"""Numbers of a certificate: rationals, real roots of polynomials, and balls around them. Part of the checker."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from hashlib import sha256
from itertools import pairwise
from typing import Any, cast

from flint import acb, arb, ctx, fmpq, fmpz, fmpz_mpoly, fmpz_poly

from gks.bounds.checkformula import Rejected
from gks.bounds.checkring import parts_of, put

BITS = 256
"""Working precision of comparisons: far beyond the doubles and the printed numbers they hold."""

LIMIT = 2.0**-30
"""Relative distance within which an end beside a wall counts as tending to an end on it."""


def digest(certificate: Mapping[str, Any]) -> str:
    """SHA-256 of everything else in the certificate, so that a slip of the file is told from a false proof."""
    rest = {key: value for key, value in certificate.items() if key != "digest"}
    return sha256(json.dumps(rest, sort_keys=True, allow_nan=False).encode()).hexdigest()


def fraction(text: object) -> Fraction:
    """A rational number in lowest terms."""
    match = _FRACTION.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        raise Rejected(f"{text!r} is no number")
    top, bottom = (int(fmpz(part)) for part in match.groups(default="1"))  # of any length
    value = Fraction(top, bottom)
    if value.numerator != top or (match[2] is not None and bottom == 1):
        raise Rejected(f"{text!r} is not in lowest terms")
    return value


_FRACTION = re.compile(r"(0|-?[1-9][0-9]*)(?:/([1-9][0-9]*))?", re.ASCII)


def ball_of(value: Fraction) -> arb:
    """A real ball around a rational number."""
    return arb(fmpq(value.numerator, value.denominator))


def complex_of(value: Fraction) -> acb:
    """A complex ball around a rational number."""
    return acb(fmpq(value.numerator, value.denominator))


def exact(value: arb) -> Fraction:
    """The midpoint."""
    mantissa, exponent = value.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def isolated(poly: fmpz_poly) -> list[acb]:
    """The distinct roots of each irreducible factor, in disjoint balls; real ones with no imaginary part."""
    return [root for g, _ in poly.factor()[1] for root in roots_of(g)]


def roots_of(poly: fmpz_poly) -> list[acb]:
    """The roots of a square-free polynomial."""
    return [root for root, _ in cast("list[tuple[acb, int]]", poly.complex_roots())]


def real_roots(poly: fmpz_poly) -> list[arb]:
    """The distinct real roots, ascending, in disjoint balls."""
    found = [root.real for root in isolated(poly) if root.imag == 0]
    found.sort(key=exact)
    for one, other in pairwise(found):
        if not one < other:
            raise Rejected("real roots are not told apart at the precision of the check")
    return found


class Real:
    """A real root of an irreducible polynomial, by its place among the real ones: a ball at any precision."""

    def __init__(self, poly: fmpz_poly, place: int) -> None:
        self.poly, self.place = poly, place

    def ball(self, bits: int = BITS) -> arb:
        with ctx.workprec(bits):
            return real_roots(self.poly)[self.place - 1]

    @property
    def nearest(self) -> Fraction:
        """The number itself where it is rational, else one that nothing of moderate size tells from it."""
        own = self.rational
        return exact(self.ball()) if own is None else own

    @property
    def rational(self) -> Fraction | None:
        if self.poly.degree() != 1:
            return None
        constant, slope = list(self.poly)
        return Fraction(-int(constant), int(slope))


def univariate(polynomial: fmpz_mpoly, name: str) -> fmpz_poly:
    """A polynomial in one variable of the ring, as such."""
    return fmpz_poly([int(c.leading_coefficient()) if not c.is_zero() else 0 for c in parts_of(polynomial, name)])


def over(curve: fmpz_mpoly, p: Fraction) -> fmpz_poly:
    """A curve over a rational p, as a polynomial in lam."""
    return univariate(put(curve, "p", p), "lam")


def positive(curve: fmpz_mpoly, p: Fraction) -> list[arb]:
    """The positive roots in lam over p, ascending."""
    return [root for root in real_roots(over(curve, p)) if root > 0]


def near_positive(curve: fmpz_mpoly, p: Fraction) -> list[arb]:
    """Positive real parts of the roots that are real, or nearly: a pair that meets at a real point close by."""
    found = []
    for root in isolated(over(curve, p)):
        if root.real > 0 and root.imag.abs_upper() <= root.real.abs_lower() * LIMIT:
            found.append(root.real)
    return found


def real_root_of(curve: fmpz_mpoly, p: Fraction, place: int) -> Real:
    """The place-th positive root over p, over its irreducible polynomial."""
    here = positive(curve, p)[place - 1]
    for g, _ in over(curve, p).factor()[1]:
        for k, root in enumerate(real_roots(g)):
            if root.overlaps(here):
                return Real(g, k + 1)
    raise Rejected("a root of a curve is lost")


def gaps_between(levels: Sequence[arb]) -> list[Fraction]:
    """A positive rational below, between and above ascending positive numbers, short ones."""
    if not levels:
        return [Fraction(1)]
    ends = [Fraction(0), *(exact(level) for level in levels)]
    inner = []
    for k, (one, other) in enumerate(pairwise(ends)):
        middle = (one + other) / 2
        short = middle.limit_denominator(max(2, int(8 / (other - one)) + 2)) if other - one > 0 else middle
        choice = short if _strictly(levels, k, short) else middle
        if not _strictly(levels, k, choice):
            raise Rejected("two curves are not told apart")
        inner.append(choice)
    return [
        *inner,
        Fraction(int(ends[-1]) + 1) if _strictly(levels, len(levels), Fraction(int(ends[-1]) + 1)) else ends[-1] + 1,
    ]


def _strictly(levels: Sequence[arb], k: int, value: Fraction) -> bool:
    here = ball_of(value)
    return bool(value > 0 and (k == 0 or levels[k - 1] < here) and (k == len(levels) or here < levels[k]))


def close(one: arb, other: arb) -> bool:
    """Whether two numbers agree to LIMIT."""
    return bool(abs(one - other) <= LIMIT * abs(other))


def simplest(low: Fraction | None, high: Fraction | None) -> Fraction:
    """The rational of least denominator in an open interval, the one nearest 0 among integers; None is infinite."""
    if (low is None or low < 0) and (high is None or high > 0):
        return Fraction(0)
    if low is None or low < 0:
        assert high is not None
        return -simplest(-high, None if low is None else -low)
    whole = low.numerator // low.denominator
    if high is None or whole + 1 < high:
        return Fraction(whole + 1)
    above = None if low == whole else 1 / (low - whole)
    return whole + 1 / simplest(1 / (high - whole), above)
