"""Isolating the roots of a polynomial whose roots cluster, as amplification factors do near z = 1 when lam = 1e-300.

A root finder that starts from the whole polynomial approaches a cluster linearly, one bit a step. Here a cluster of m
roots is found as the simple root of the (m-1)-th derivative nearby (Newton, quadratically), the polynomial is expanded
there, and its Newton polygon tells at which scale the cluster falls apart; the parts are treated alike. Nothing of this
needs to be right: the approximations are proved afterwards, by the discs of B. T. Smith, J. ACM 17 (1970) 661-674. With
n distinct numbers x_i and d_i = n abs(p(x_i)/(c prod_{j != i} (x_i - x_j))), c the leading coefficient, the discs of
radius d_i around x_i hold all roots of p, and a disc disjoint from the others holds exactly one.
"""

from __future__ import annotations

from itertools import combinations, pairwise
from math import inf, isfinite

import numpy as np
from flint import acb, acb_poly, arb, ctx, fmpz_poly

#: Numbers of size 1 closer than this are handled as a cluster. Double precision gives an m-fold root to 2**(-53/m), so
#: this gathers up to sixfold ones; gathering too much or too little costs time, or the proof fails and nothing is lost.
GATHER = 2.0**-8

#: Sizes whose log2 differ by less are found together: double precision covers them, and no root is taken twice.
APART = 24.0

#: Relative size of a coefficient that cannot move a double-precision root of size 1 (the square of the rounding unit).
NEGLIGIBLE = 2.0**-106

#: Ratio of coefficients that a companion matrix in doubles holds, with room for its eigenvalue solver to square it.
LARGEST = 2.0**500

#: Attempts at a proof that may fail before the approximations are given up.
DOUBTS = 2

#: Newton steps: quadratic convergence from a few bits reaches any precision in use within these.
STEPS = 24


def isolate(poly: fmpz_poly, bits: int) -> list[acb] | None:
    """Proved disjoint balls around all roots of a square-free ``poly``, or None where none were found.

    Real roots first, ascending and with an exact zero imaginary part, then conjugate pairs, the upper one leading.
    Radii are at most ``2**-bits`` relative.
    """
    # A cluster of m roots at distance eps shows in coefficients of size eps**m, which the integers hold in full.
    highest = 4 * (bits + poly.height_bits() * max(1, poly.degree()))
    working = bits + poly.height_bits()
    doubts = 0
    while working <= highest and doubts < DOUBTS:
        with ctx.workprec(working):
            found = _near(acb_poly(poly), poly.degree(), centred=False)
            if found is not None:
                balls = _proved(poly, found)
                if balls is not None and all(ball.rel_accuracy_bits() >= bits for ball in balls):
                    return balls
                # Complete but unproved: either a little more precision proves it or the approximations are wrong.
                doubts += 1
        working *= 2
    return None


def _near(taylor: acb_poly, count: int, *, centred: bool) -> list[acb] | None:
    """Approximations to the ``count`` roots nearest 0 of a polynomial; None where the precision gives out.

    ``centred``: their mean is close to 0 by their own scale, so a precision that shows them at all shows them apart.
    """
    logs = [_log2(c) for c in taylor.coeffs()]
    found: list[acb] = []
    first = 0
    if logs[0] == -inf:
        found, first = [acb(0)], 1
        # Of two distinct roots none is at their mean, so there the zero is rounding error.
        if (count > 1 and logs[1] == -inf) or (centred and count == 2):
            return None
    for begin, end in _polygon(logs, first, count):
        exponent = round(_exponent(logs, begin, end))
        scaled = _roots_of_size_one(taylor, exponent, begin, end)
        if scaled is None:
            return None
        for members in _gathered(scaled):
            if centred and len(members) == count:
                return None
            start = acb(complex(np.mean(members))) * arb(2) ** exponent
            parts = _resolved(taylor, start, len(members))
            if parts is None:
                return None
            found += parts
    return found if len(found) == count else None


def _resolved(taylor: acb_poly, start: acb, size: int) -> list[acb] | None:
    """The ``size`` roots near ``start``: expand at the nearby root of the (size-1)-th derivative and look closer."""
    derivative = taylor
    for _ in range(size - 1):
        derivative = derivative.derivative()
    slope = derivative.derivative()
    center = start
    for _ in range(STEPS):
        step = derivative(center) / slope(center)
        if not step.is_finite():
            return None
        center = (center - step).mid()
        if _log2(step.mid()) < _log2(center) - ctx.prec / 2:
            break
    if size == 1:
        return [center]
    # The balls stay: a coefficient that is all rounding error holds 0 and tells that the precision gives out.
    around = _near(taylor(acb_poly([center, 1])), size, centred=True)
    return None if around is None else [(center + each).mid() for each in around]


def _polygon(logs: list[float], first: int, last: int) -> list[tuple[int, int]]:
    """The edges of the upper hull of (k, logs[k]), first <= k <= last: an edge of length m is m roots of one size.

    Edges whose sizes are not well apart are joined.
    """
    hull: list[int] = []
    for k in range(first, last + 1):
        if logs[k] == -inf:
            continue
        while len(hull) > 1 and (logs[k] - logs[hull[-1]]) * (hull[-1] - hull[-2]) >= (
            logs[hull[-1]] - logs[hull[-2]]
        ) * (k - hull[-1]):
            hull.pop()
        hull.append(k)
    merged: list[tuple[int, int]] = []
    for begin, end in pairwise(hull):
        if merged and abs(_exponent(logs, *merged[-1]) - _exponent(logs, begin, end)) < APART:
            merged[-1] = (merged[-1][0], end)
        else:
            merged.append((begin, end))
    return merged


def _exponent(logs: list[float], begin: int, end: int) -> float:
    """log2 of the (mean) size of the roots of an edge."""
    return (logs[begin] - logs[end]) / (end - begin)


def _roots_of_size_one(taylor: acb_poly, exponent: int, begin: int, end: int) -> list[complex] | None:
    """The roots of an edge, divided by 2**exponent, in double precision."""
    scaled = [c * arb(2) ** (exponent * k) for k, c in enumerate(taylor.coeffs())]
    largest = max(abs(c).mid() for c in scaled[begin : end + 1])
    doubles = [complex((c / largest).mid()) for c in scaled]
    if not all(isfinite(abs(c)) for c in doubles):
        return None
    # Beyond the edge, coefficients far below it belong to roots of other sizes and only upset the eigenvalue solver.
    for k, c in enumerate(doubles):
        if (k < begin and abs(c) < NEGLIGIBLE * abs(doubles[begin])) or (
            k > end and abs(c) < NEGLIGIBLE * abs(doubles[end])
        ):
            doubles[k] = 0.0
    lead = next((abs(c) for c in reversed(doubles) if c), 0.0)
    if not lead or max(map(abs, doubles)) / LARGEST > lead:
        return None  # the companion matrix would overflow
    roots = sorted(np.roots(doubles[::-1]), key=abs)
    chosen = roots[begin:end]
    return [complex(r) for r in chosen] if len(chosen) == end - begin else None


def _gathered(numbers: list[complex]) -> list[list[complex]]:
    """Groups linked by distances below GATHER."""
    groups: list[list[complex]] = []
    for number in numbers:
        near = [g for g in groups if any(abs(number - other) < GATHER for other in g)]
        groups = [g for g in groups if g not in near]
        groups.append([number, *(other for g in near for other in g)])
    return groups


def _proved(poly: fmpz_poly, found: list[acb]) -> list[acb] | None:
    """Smith's discs around the approximations, made symmetric about the real axis; None if two of them overlap."""
    found = [each.mid() for each in found]
    radii = _radii(poly, found)
    if radii is None:
        return None
    real = [acb(x.real) for x, r in zip(found, radii, strict=True) if not abs(x.imag) > r]
    upper = [x for x, r in zip(found, radii, strict=True) if x.imag > r]
    if len(real) + 2 * len(upper) != poly.degree():
        return None
    real.sort(key=lambda x: x.real.mid())
    centers = [*real, *(each for x in upper for each in (x, x.conjugate()))]
    radii = _radii(poly, centers)
    if radii is None:
        return None
    for (x, r), (y, s) in combinations(list(zip(centers, radii, strict=True)), 2):
        if not abs(x - y) > r + s:
            return None
    # A disc around a real center that holds one root of a real polynomial holds a real one.
    balls = [acb(arb(x.real, r)) for x, r in zip(real, radii, strict=False)]
    for x, r in zip(centers[len(real) :], radii[len(real) :], strict=True):
        balls.append(acb(arb(x.real, r), arb(x.imag, r)))
    return balls if _disjoint(balls) else None


def _disjoint(balls: list[acb]) -> bool:
    return not any(a.overlaps(b) for a, b in combinations(balls, 2))


def _radii(poly: fmpz_poly, centers: list[acb]) -> list[arb] | None:
    """Upper bounds of Smith's radii; None where two centers coincide."""
    radii: list[arb] = []
    lead = poly.leading_coefficient()
    for k, x in enumerate(centers):
        product = acb(lead)
        for other in (*centers[:k], *centers[k + 1 :]):
            product *= x - other
        radius = (poly.degree() * abs(poly(x) / product)).upper()
        if not radius.is_finite():
            return None
        radii.append(radius)
    return radii


def _log2(number: acb) -> float:
    """log2 of the size of a ball, -inf where it may be zero."""
    if number.contains(0):
        return -inf
    with ctx.workprec(64):  # a double's worth, whatever the precision around it
        return float(abs(number).mid().log() / arb(2).log())
