"""Largest stable CFL numbers held against marches: below it nothing may grow, above it something must.

How near to the derived lam_max a march can tell is not guessed. At lam_max (1 + eps) the derived modulus, of the modes
or of the interior's own waves, says how fast the growth is to be, and the least eps is taken at which it is fast
enough to be seen. Where nothing grows above, only an eigenvalue or a generalized eigenvalue stands on the unit circle,
forcing at its z tells: a response that grows as a power of n above and stays bounded below.

Growth is observed in the norm over all cells, from data that fill them: waves of an unstable interior may be carried
away.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

from gks.solvers.farends import growth_factors
from gks.solvers.problem import Problem, build
from gks.solvers.runs import AGREEMENT, filled_march, forced_march

if TYPE_CHECKING:
    from gks.modes import ModesResult
    from gks.scheme.model import Scheme

STEPS = 400

TELLING = 1.02
"""A growth per step that STEPS steps raise to a factor 3e3, beyond what a transient of slow waves makes."""

DISTANCES = (*(Fraction(1, 4**k) for k in range(5, 0, -1)), Fraction(1, 2), Fraction(1))
"""eps tried in turn."""

BOUNDED, GROWING = 0.15, 0.4
"""Exponents of a forced response: 0 where z is no eigenvalue, 1/2 at a glancing point, 1 or more at the others."""

WAVE_NUMBERS = 257
"""On the upper half of the unit circle: the interior's fastest wave is then missed by at most 1e-4 of its excess."""

Means = Literal["growth", "forcing", "none"]


@dataclass(frozen=True, slots=True)
class Look:
    """One march: at lam, the derived largest modulus, what was observed and the half-width of its 99 % interval.

    Under forcing, `observed` is the exponent of n, and `derived` is None.
    """

    lam: Fraction
    derived: float | None
    observed: float
    uncertainty: float


@dataclass(frozen=True, slots=True)
class Bracket:
    """A derived limit between two marches. means : how they tell; reason : why they cannot, or how they contradict.

    below, above : None where there is nothing on that side to look at.
    """

    limit: Fraction | None
    means: Means
    below: Look | None
    above: Look | None
    reason: str

    @property
    def holds(self) -> bool | None:
        """Whether the marches bracket the limit; None where no march can tell."""
        return None if self.means == "none" else not self.reason


def bracket(
    scheme: Scheme, values: Mapping[str, Fraction], stable: Fraction, unstable: Fraction | None = None
) -> Bracket:
    """Hold marches against a derived threshold: stable up to `stable`, not stable at (or just above) `unstable`.

    `unstable` is lam_max itself where it is known exactly, and then the same as `stable`; None where there is no
    limit. A limit of 0 (never stable) has nothing below: the parameter values' own lam is looked at alone.
    """
    if unstable is None:
        look, why = _quiet(scheme, values, stable)
        return Bracket(None, "growth", look, None, why) if why else Bracket(None, "none", look, None, "no limit")
    if stable == 0:
        return _never_stable(scheme, values)
    for eps in DISTANCES:
        above = unstable * (1 + eps)
        derived = _derived(scheme, _at(scheme, values, above))
        if derived >= TELLING:
            return _by_growth(scheme, values, stable, (stable * (1 - min(eps, Fraction(1, 2))), above), derived)
    return _by_forcing(scheme, values, stable, _circle_candidates(scheme, values, unstable))


def _at(scheme: Scheme, values: Mapping[str, Fraction], lam: Fraction) -> dict[str, Fraction]:
    return {**values, scheme.cfl: lam}


def _analysed(scheme: Scheme, values: Mapping[str, Fraction]) -> ModesResult:
    from gks.modes import analyse

    return analyse(scheme, dict(values))


def _derived(scheme: Scheme, values: Mapping[str, Fraction]) -> float:
    """The largest modulus of the interior's waves and, unless those grow fast, of the growing modes; at least 1."""
    fastest = _interior_modulus(build(scheme, values))
    if fastest >= TELLING:
        return fastest
    modes = _analysed(scheme, values).modes
    return max([1.0, fastest, *(float(mode.modulus) for mode in modes if mode.kind.value == "growing")])


def _interior_modulus(problem: Problem) -> float:
    import numpy

    kappa = numpy.exp(1j * numpy.linspace(0.0, math.pi, WAVE_NUMBERS))
    return max(float(growth_factors(problem, side, kappa).max()) for side in problem.sides)


def _quiet(scheme: Scheme, values: Mapping[str, Fraction], lam: Fraction) -> tuple[Look, str]:
    """A march that must not grow, and what contradicts."""
    found = filled_march(build(scheme, _at(scheme, values, lam)), STEPS)
    look = Look(lam, 1.0, found.growth.rate, found.growth.uncertainty)
    grows = found.growth.exceeds(math.exp(1.0 / found.steps))
    return look, f"random data grow by {look.observed:.6g} at lam = {float(lam):.6g}, below the limit" if grows else ""


def _by_growth(
    scheme: Scheme, values: Mapping[str, Fraction], limit: Fraction, places: tuple[Fraction, Fraction], derived: float
) -> Bracket:
    """Nothing may grow at the lower place; at the higher something must, and no faster than derived.

    That it grows as fast as derived is `march`'s to say: of an unstable interior a whole band of waves grows, and their
    sum lags behind the fastest by a power of n.
    """
    low, high = places
    below, why = _quiet(scheme, values, low)
    found = filled_march(build(scheme, _at(scheme, values, high)), STEPS).growth
    above = Look(high, derived, found.rate, found.uncertainty)
    if not found.exceeds(1.0):
        why = why or f"nothing is seen to grow at lam = {float(high):.6g}, above the limit"
    elif found.rate > derived + max(found.uncertainty, AGREEMENT * derived):
        why = why or f"{found.rate:.6g} is observed where {derived:.6g} is derived"
    return Bracket(limit, "growth", below, above, why)


def _circle_candidates(
    scheme: Scheme, values: Mapping[str, Fraction], limit: Fraction
) -> Iterator[tuple[Fraction, complex]]:
    """(lam, z) of eigenvalues and generalized eigenvalues on the unit circle, at or above the limit."""
    for lam in (limit * (1 + DISTANCES[-3]), limit):
        for mode in _analysed(scheme, _at(scheme, values, lam)).modes:
            if mode.kind.value in ("eigenvalue", "generalized"):
                yield lam, mode.z_complex / abs(mode.z_complex)


def _forced(scheme: Scheme, values: Mapping[str, Fraction], lam: Fraction, z: complex) -> Look:
    found = forced_march(build(scheme, _at(scheme, values, lam)), z)
    return Look(lam, None, found.exponent, found.uncertainty)


def _by_forcing(
    scheme: Scheme, values: Mapping[str, Fraction], limit: Fraction, candidates: Iterator[tuple[Fraction, complex]]
) -> Bracket:
    for lam, z in candidates:
        above = _forced(scheme, values, lam, z)
        below = _forced(scheme, values, limit * (1 - DISTANCES[-3]), z)
        if above.observed > GROWING and below.observed < BOUNDED:
            return Bracket(limit, "forcing", below, above, "")
        why = f"forced responses grow as n**{below.observed:.2f} below and n**{above.observed:.2f} above"
        return Bracket(limit, "forcing", below, above, why)
    return Bracket(limit, "none", None, None, "nothing grows above the limit and nothing stands on the unit circle")


def _never_stable(scheme: Scheme, values: Mapping[str, Fraction]) -> Bracket:
    """Growth, or a forced response that grows, at the parameter values' own lam."""
    lam = values[scheme.cfl]
    derived = _derived(scheme, values)
    if derived >= TELLING:
        found = filled_march(build(scheme, values), STEPS).growth
        why = "" if found.exceeds(1.0) else f"nothing is seen to grow at lam = {float(lam):.6g}"
        return Bracket(Fraction(0), "growth", None, Look(lam, derived, found.rate, found.uncertainty), why)
    for mode in _analysed(scheme, values).modes:
        if mode.kind.value in ("eigenvalue", "generalized"):
            above = _forced(scheme, values, lam, mode.z_complex / abs(mode.z_complex))
            why = "" if above.observed > GROWING else f"the forced response grows as n**{above.observed:.2f}"
            return Bracket(Fraction(0), "forcing", None, above, why)
    return Bracket(Fraction(0), "none", None, None, "nothing grows and nothing stands on the unit circle")
