"""All roots of many complex polynomials of one small degree at once, in double precision; nothing is proved.

Formulas up to degree 3. From degree 4 on Ehrlich-Aberth iteration, which is right to rounding once it has converged
(Bini, Numer. Algorithms 13 (1996) 179-200). The polynomials are taken to come in an order in which neighbours are
alike: every fourth is solved first, by the same rule, and the others start from its roots. Where the iteration does not
settle (a multiple root) or cannot begin (a coefficient at an end that is next to nothing), companion matrices do it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gks.modes.inclusion import reciprocal, size_above

ComplexArray = NDArray[np.complex128]


def all_roots(coefficients: ComplexArray) -> ComplexArray:
    """The roots of polynomials (N, n + 1), ascending coefficients: (N, n), infinite where the leading one vanishes."""
    degree = coefficients.shape[1] - 1
    with np.errstate(all="ignore"):
        if degree < 1:
            return np.empty((len(coefficients), 0), complex)
        if degree == 1:
            return np.asarray(-coefficients[:, :1] / coefficients[:, 1:])
        if degree == 2:
            return _quadratic(coefficients)
        if degree == 3:
            return _cubic(coefficients)
        return _iterated(coefficients)


def _quadratic(coefficients: ComplexArray) -> ComplexArray:
    c, b, a = coefficients.T
    root = np.sqrt(b * b - 4 * a * c)
    half = -(b + np.where((b.conj() * root).real < 0, -root, root)) / 2
    return np.stack([half / a, np.where(half == 0, -half, c / half)], axis=1)


_THIRD_TURN = np.exp(2j * np.pi / 3 * np.arange(3))


def _cubic(coefficients: ComplexArray) -> ComplexArray:
    """Cardano's formula for the depressed cubic, then two Newton steps for what cancels in it: ten times as fast as
    companion matrices of so small a size.
    """
    swap = np.abs(coefficients[:, -1]) < np.abs(coefficients[:, 0])
    d, c, b, a = np.where(swap[:, None], coefficients[:, ::-1], coefficients).T
    shift = b / (3 * a)
    p = c / a - 3 * shift * shift
    q = 2 * shift**3 - shift * c / a + d / a
    root = np.sqrt(q * q / 4 + (p / 3) ** 3)
    cube = -q / 2 + np.where((q.conj() * root).real > 0, -root, root)
    one = cube ** (1 / 3)
    all_three = one[:, None] * _THIRD_TURN
    x = all_three - np.where(all_three == 0, 0, p[:, None] / (3 * all_three)) - shift[:, None]
    for _ in range(2):
        value = ((a[:, None] * x + b[:, None]) * x + c[:, None]) * x + d[:, None]
        slope = (3 * a[:, None] * x + 2 * b[:, None]) * x + c[:, None]
        step = value / slope
        # Next to a double root a Newton step is all rounding.
        x = np.where(np.abs(step) < 2.0**-10 * np.abs(x), x - step, x)
    return np.asarray(np.where(swap[:, None], 1 / x, x))


# From degree 4 on -----------------------------------------------------------------------------------------------------

STRIDE = 4
"""Polynomials from one that is solved first to the next."""
FEW = 32
"""So many are begun from a circle."""
CHUNK = 4096
"""Polynomials iterated together: their arrays stay in the cache."""
STEPS = 14
"""Aberth steps from a neighbour, where 5 are the rule; what takes longer has a cluster, or a neighbour unlike it."""
STEPS_FROM_A_CIRCLE = 40
"""10 to 20 are the rule."""
DONE = 2.0**-24
"""A relative correction below this leaves, as convergence is cubic, less than rounding."""
SPREAD = 2.0**-40
"""Least size of the coefficients at both ends, relative to the largest: roots below or above are lost in the steps."""


def _iterated(coefficients: ComplexArray) -> ComplexArray:
    roots, settled = _from_neighbours(coefficients.T)
    if not settled.all():
        roots[:, ~settled] = _companion(coefficients[~settled]).T
    return np.asarray(roots.T)


def _from_neighbours(terms: ComplexArray) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """Roots (n, N) of terms (n + 1, N), and for which they settled."""
    degree, count = len(terms) - 1, terms.shape[1]
    size = np.abs(terms)
    steps = STEPS
    if count <= FEW:
        steps = STEPS_FROM_A_CIRCLE
        middle = (size[0] / size[-1]) ** (1 / degree)
        # No symmetry about the real axis, as for Bini's starting points.
        start = middle * np.exp(1j * (2 * np.pi * np.arange(degree) / degree + 0.7))[:, None]
    else:
        coarse, _ = _from_neighbours(terms[:, ::STRIDE])
        start = np.repeat(coarse, STRIDE, axis=1)[:, :count]
    able = np.minimum(size[0], size[-1]) > SPREAD * size.max(axis=0)
    for begin in range(0, count, CHUNK):
        mine = slice(begin, begin + CHUNK)
        start[:, mine], done = _aberth(terms[:, mine], start[:, mine], steps)
        able[mine] &= done
    return start, able


def _aberth(terms: ComplexArray, start: ComplexArray, steps: int) -> tuple[ComplexArray, NDArray[np.bool_]]:
    """Ehrlich-Aberth steps; which polynomials have settled, all their roots at once."""
    degree, count = start.shape
    first, second = np.triu_indices(degree, 1)
    towards = np.zeros((degree, len(first)), complex)  # sums 1 / (x_i - x_j) over the pairs of each root
    towards[first, np.arange(len(first))], towards[second, np.arange(len(first))] = 1, -1
    result, settled = start.copy(), np.zeros(count, bool)
    active, x = np.arange(count), start
    for _ in range(steps):
        value, slope = terms[-1] * x, np.empty_like(x)
        value += terms[-2]
        slope[:] = terms[-1]
        for term in terms[-3::-1]:
            slope *= x
            slope += value
            value *= x
            value += term
        slope -= value * (towards @ reciprocal(x[first] - x[second]))
        correction = value * reciprocal(slope)
        x = x - correction
        done = (size_above(correction) <= DONE * size_above(x)).all(axis=0)
        result[:, active[done]], settled[active[done]] = x[:, done], True
        going = np.flatnonzero(~done & np.isfinite(x).all(axis=0))
        if not len(going):
            break
        if 4 * len(going) < 3 * len(active):
            active, x, terms = active[going], x[:, going], terms[:, going]
    return result, settled


def _companion(coefficients: ComplexArray) -> ComplexArray:
    """From the companion matrix of whichever end has the larger coefficient: the other may vanish."""
    degree = coefficients.shape[1] - 1
    swap = np.abs(coefficients[:, -1]) < np.abs(coefficients[:, 0])
    ordered = np.where(swap[:, None], coefficients[:, ::-1], coefficients)
    companion = np.zeros((len(ordered), degree, degree), complex)
    companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1
    companion[:, :, -1] = -ordered[:, :-1] / ordered[:, -1:]
    finite = np.asarray(np.isfinite(companion).all(axis=(1, 2)))
    roots = np.linalg.eigvals(np.where(finite[:, None, None], companion, 0))
    return np.where(finite[:, None], np.where(swap[:, None], 1 / roots, roots), np.nan)
