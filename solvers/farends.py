"""How far away the ends of the computation must be.

A half-line is cut after d cells and held at zero beyond. What that changes near the boundary has travelled d cells out
and d cells back. With rho(R) the largest abs(z) of the interior symbol over abs(kappa) = R, Cauchy's estimate on that
circle bounds what n steps carry over d cells, relative to a signal that itself grows by g a step, by

    outward:  (rho(R)/g)**n R**d  for every R < 1,      back:  (rho(R')/g)**n R'**(-d)  for every R' > 1.

The n steps are shared by the two ways, m out and n - m back. For each pair of circles the product is a linear function
of m in its logarithm, so its largest value over m is at an end, max(rho(R), rho(R'), g)**n in place of the powers of
rho; the least over all pairs is the bound, and it is asked to stay below `SILENCE`. The circles lie between the unit
circle and the first pole of the symbol (implicit schemes have poles, explicit ones none). So an explicit scheme needs
about n/2 times its signal speed, and a growing mode (g > 1) a distance that stays finite as n -> oo, set by the
mode's own decay. Constants (the condition of the symbol's eigenvectors) are covered by the margin of SILENCE against
rounding; the tests compare d with 2 d.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gks.solvers.coefficients import beyond_doubles
from gks.solvers.problem import Problem, Side

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]

Profile = tuple[tuple[Any, Any], tuple[Any, Any]]
"""(t, log rho) on circles inside (abs(kappa) = exp(-t)) and outside (exp(t)) the unit circle."""

SILENCE = 2.0**-53 * 1e-6
"""What may come back from a far end: a millionth of rounding."""

RADII, ANGLES, FARTHEST = 28, 17, 400.0
"""Circles R = exp(±t), t from 1e-4 to log FARTHEST in geometric steps; ANGLES samples on the upper half of each."""


def interior_blocks(problem: Problem, side: Side, kappa: Array) -> list[Array]:
    """A_0..A_depth of the interior at each kappa: shape (len(kappa), unknowns, unknowns)."""
    import numpy

    size = len(side.unknowns)
    levels = [numpy.zeros((len(kappa), size, size), dtype=complex) for _ in range(problem.depth + 1)]
    with numpy.errstate(over="ignore", invalid="ignore"):
        for equation, row in enumerate(side.rows):
            for level, slot, value in row.terms:
                levels[level][:, equation, slot.unknown] += value * kappa**slot.place
    if not all(numpy.isfinite(level).all() for level in levels):
        raise beyond_doubles(f"the interior coefficients of {side.name} add up to more than the largest double")
    return levels


def growth_factors(problem: Problem, side: Side, kappa: Array) -> Array:
    """The largest abs(z) of the interior's waves at each kappa: shape (len(kappa),); inf where z is infinite."""
    import numpy

    levels = interior_blocks(problem, side, kappa)
    size = levels[0].shape[1]
    top = levels[-1]
    regular = numpy.abs(numpy.linalg.det(top)) > 0
    companion = numpy.zeros((len(kappa), size * problem.depth, size * problem.depth), dtype=complex)
    companion[:, : size * (problem.depth - 1), size:] = numpy.eye(size * (problem.depth - 1))
    safe = numpy.where(regular[:, None, None], top, numpy.eye(size))
    for level, block in enumerate(levels[:-1]):
        companion[:, -size:, level * size : (level + 1) * size] = numpy.linalg.solve(safe, -block)
    z: Array = numpy.linalg.eigvals(companion)
    stages = problem.stages
    if stages is not None:
        with numpy.errstate(over="ignore"):
            if stages.kind == "exact":
                z = numpy.exp(problem.lam * z)
            else:
                z = numpy.polyval([float(c) for c in stages.stability[::-1]], problem.lam * z)
    return numpy.where(regular, numpy.abs(z).max(axis=1), numpy.inf)


def _poles(problem: Problem, side: Side) -> list[float]:
    """Moduli of the kappas where det A_depth vanishes: the singularities of the symbol."""
    import numpy

    reach = len(side.unknowns) * max(side.inward_reach, side.outward_reach)
    count = 2 * reach + 1
    roots_of_unity = numpy.exp(2j * numpy.pi * numpy.arange(count) / count)
    samples = numpy.linalg.det(interior_blocks(problem, side, roots_of_unity)[-1])
    laurent = numpy.real(numpy.fft.fftshift(numpy.fft.fft(samples))) / count  # from kappa**-reach to kappa**reach
    # Below the rounding errors of the interpolation a coefficient is zero: it would make roots out of nothing.
    laurent[numpy.abs(laurent) < 64 * count * numpy.finfo(float).eps * numpy.abs(laurent).max()] = 0.0
    return [float(abs(root)) for root in numpy.roots(laurent[::-1]) if root != 0]


def _profile(problem: Problem, side: Side) -> Profile:
    """(t, log rho(exp(-t))) and (t, log rho(exp(t))), cut off at the first pole."""
    import numpy

    t = numpy.geomspace(1e-4, math.log(FARTHEST), RADII)
    angles = numpy.exp(1j * numpy.linspace(0.0, math.pi, ANGLES))
    poles = [math.log(modulus) for modulus in _poles(problem, side)]
    profiles = []
    for sign in (-1.0, 1.0):
        barrier = min((sign * pole for pole in poles if sign * pole > 0), default=math.inf)
        inside = t[t < barrier]
        if barrier < t[-1]:  # circles close to the pole, where the bound turns infinite, are the sharp ones
            inside = numpy.unique(numpy.concatenate([inside, barrier * (1 - 2.0 ** -numpy.arange(1.0, 8.0))]))
        kappa = (numpy.exp(sign * inside)[:, None] * angles[None, :]).ravel()
        factors = growth_factors(problem, side, kappa).reshape(len(inside), ANGLES).max(axis=1)
        with numpy.errstate(divide="ignore"):
            profiles.append((inside, numpy.log(factors)))
    return profiles[0], profiles[1]


def _silent(profile: Profile, steps: int, log_growth: float, cells: int) -> bool:
    """Whether the far end, `cells` away, stays below SILENCE for so many steps."""
    import numpy

    (out, log_out), (back, log_back) = profile
    fastest = numpy.maximum(numpy.maximum(log_out[:, None], log_back[None, :]) - log_growth, 0.0)
    distance = (out[:, None] + back[None, :]) * cells
    return bool((steps * fastest - distance).min() < math.log(SILENCE))


def _least(fits: Any, most: int) -> int:
    """The least n in 1..most with fits(n), by doubling and bisection (fits is monotone); most + 1 if there is none."""
    high = 1
    while high < most and not fits(high):
        high *= 2
    high = min(high, most)
    if not fits(high):
        return most + 1
    low = high // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if fits(middle) else (middle, high)
    return high


def cells_needed(problem: Problem, steps: int, growth: float = 1.0, most: int = 2**20) -> tuple[int, ...]:
    """Cells a side for which the far ends are silent for so many steps, beside a signal growing by `growth` a step.

    A side that needs more than `most` gets most + 1.
    """
    log_growth = math.log(growth)
    found = []
    for side in problem.sides:
        profile = _profile(problem, side)
        found.append(_least(lambda cells, p=profile: _silent(p, steps, log_growth, cells), most) + problem.near)
    return tuple(found)


def steps_allowed(problem: Problem, cells: Sequence[int], most: int, growth: float = 1.0) -> int:
    """The largest number of steps up to `most` for which ends so many cells away are silent; 0 if there is none."""
    log_growth = math.log(growth)
    allowed = most
    for side, count in zip(problem.sides, cells, strict=True):
        profile = _profile(problem, side)

        def loud(steps: int, p: Any = profile, d: int = count - problem.near) -> bool:
            return not _silent(p, steps, log_growth, d)

        allowed = min(allowed, _least(loud, allowed + 1) - 1)
    return allowed
