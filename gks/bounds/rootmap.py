"""Where the roots z of the characteristic polynomial move as one parameter runs.

Where elimination is in reach the polynomial is derived once, with the parameter as a symbol; at each value its roots
are isolated in balls, mapped to z, and judged in doubles, exactly where doubles leave a doubt (`rootkinds`). Roots of
one irreducible factor are followed from value to value (`roottracks`). Elsewhere every value is analysed by itself, and
the tracks are those of the modes that are listed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from time import perf_counter
from typing import cast

import numpy as np
from flint import acb, fmpz_mpoly
from numpy.typing import NDArray

from gks.bounds.rootkinds import Kinds
from gks.bounds.rootpaths import RootMap, RootPoint, Track
from gks.bounds.roottracks import chordal, follow
from gks.bounds.sweep import Sweep
from gks.errors import InputError, ParameterError
from gks.modes.analysis import analyse
from gks.modes.derivation import common_speed
from gks.modes.fibre import specialise, univariate
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.polynomial import Degenerate, Factor, TooWide, characteristic_factors
from gks.modes.verdict import ModeKind
from gks.scheme.model import Scheme

Complex = NDArray[np.complex128]
Progress = Callable[[int, int], None]

DIVISIONS, COSTLY_DIVISIONS = 12, 3
"""Halvings of one step of the sweep: where roots are cheap, and where each means an analysis of the scheme."""
SAME = 1e-7
"""Chordal distance within which the polynomial's root and the exact analysis' root are the same one: double roots of
the analysis are exact, and the polynomial's are computed as one root with multiplicity."""
MOST_POINTS = 20_000
"""Values of a root map: more than any picture shows."""


def rootmap(
    scheme: Scheme, values: Mapping[str, Fraction], over: Sweep, progress: Progress | None = None
) -> RootMap:
    """Follows every root over a sweep of a parameter, the CFL number included.

    Raises InputError where there is no scheme at any value; single values without one are ``faults``.
    """
    start = perf_counter()
    scheme.parameter(over.name)
    if len(over.values) > MOST_POINTS:
        raise ParameterError(f"{len(over.values)} values", path="--sweep", expected=f"at most {MOST_POINTS}")
    if over.name == scheme.cfl and min(over.values) <= 0:
        raise ParameterError(f"{over.name} runs to {min(over.values)}", path="--sweep", expected="dt/dx is positive")
    exact = _Exact(scheme, values, over)
    polynomial = _polynomial(scheme, values, over, exact)
    if polynomial is None:
        tracks = _joined(exact.group(progress))
    else:
        tracks = [track for factor in polynomial.factors for track in _joined(polynomial.group(factor))]
    if len(exact.faults) == len(over.values):
        raise next(iter(exact.faults.values()))
    faults = {at: str(fault) for at, fault in exact.faults.items()}
    return RootMap(scheme, dict(values), over, tuple(tracks), faults, perf_counter() - start)


# Groups of roots that are followed together ---------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Group:
    """The roots at every value, and how to find them at a place t between value k and the next."""

    multiplicity: int
    roots: Sequence[Sequence[RootPoint]]
    between: Callable[[int, float], Complex]
    depth: int


def _joined(group: _Group) -> list[Track]:
    """Tracks through the roots of all values; a root that has no continuation ends a track, a new one begins one."""
    count = len(group.roots)
    tracks: list[list[RootPoint | None]] = []
    live: list[int] = []
    before = _NONE
    for k, points in enumerate(group.roots):
        after = np.array([p.z for p in points], np.complex128)
        pairing = follow(partial(group.between, k - 1), before, after, 0.0, 1.0, group.depth) if k else []
        here: dict[int, int] = {}
        for i, j in enumerate(pairing):
            if j is not None and j not in here:
                here[j] = live[i]
        for j in range(len(points)):
            if j not in here:
                here[j] = len(tracks)
                tracks.append([None] * count)
            tracks[here[j]][k] = points[j]
        live, before = [here[j] for j in range(len(points))], after
    return [Track(group.multiplicity, tuple(points)) for points in tracks]


# Every value by itself ------------------------------------------------------------------------------------------------


class _Exact:
    """The exact analysis at single values of the sweep."""

    def __init__(self, scheme: Scheme, values: Mapping[str, Fraction], over: Sweep) -> None:
        self.scheme, self.values, self.over = scheme, values, over
        self.faults: dict[int, InputError] = {}
        self._known: dict[Fraction, list[RootPoint]] = {}

    def at(self, place: int) -> list[RootPoint]:
        """The roots listed at one value of the sweep, multiple ones repeated; none where there is no scheme."""
        try:
            return self.of(Fraction(self.over.values[place]))
        except InputError as fault:
            self.faults[place] = fault
            return []

    def of(self, value: Fraction) -> list[RootPoint]:
        """The same at any value; InputError where there is no scheme."""
        if value not in self._known:
            found = analyse(self.scheme, {**self.values, self.over.name: value})
            self._known[value] = [
                RootPoint(z, mode.kind)
                for mode in found.modes
                for z in [_double(mode.z)] * mode.multiplicity
                if np.isfinite(z)
            ]
        return self._known[value]

    def group(self, progress: Progress | None) -> _Group:
        """All roots that are listed, as one group."""
        roots = []
        for k in range(len(self.over.values)):
            roots.append(self.at(k))
            if progress is not None:
                progress(k + 1, len(self.over.values))
        return _Group(1, roots, self._between, COSTLY_DIVISIONS)

    def _between(self, k: int, t: float) -> Complex:
        try:
            found = self.of(_value_between(self.over, k, t))
        except InputError:
            found = []
        return np.array([p.z for p in found], np.complex128)


def _double(z: tuple[Fraction, Fraction]) -> complex:
    try:
        return complex(float(z[0]), float(z[1]))
    except OverflowError:
        return complex("nan")


def _value_between(over: Sweep, k: int, t: float) -> Fraction:
    low, high = Fraction(over.values[k]), Fraction(over.values[k + 1])
    return low + Fraction(t) * (high - low)


# The polynomial with the parameter as a symbol ------------------------------------------------------------------------


def _polynomial(scheme: Scheme, values: Mapping[str, Fraction], over: Sweep, exact: _Exact) -> _Polynomial | None:
    """The derivation with the parameter free; None where there is none, or where it does not hold over the sweep."""
    middle = Fraction(over.values[len(over.values) // 2])
    try:
        problem = normal_mode_problem(scheme, {**values, over.name: middle}, (over.name,))
        if problem.coupled or problem.coefficients.generators:
            return None
        found = characteristic_factors(problem)
    except (InputError, Degenerate, TooWide):
        return None
    if found.lost_sheet or found.clearing:
        return None
    polynomial = _Polynomial(problem, found.factors, over, exact)
    if not all(polynomial.same_branch(Fraction(value)) for value in over.values):
        return None
    places = sorted({0, len(over.values) // 3, len(over.values) // 2, len(over.values) - 1})
    return polynomial if all(polynomial.holds(place) for place in places) else None


_NONE: Complex = np.empty(0, np.complex128)


class _Polynomial:
    """The irreducible factors in sigma and the parameter, their roots at every value."""

    def __init__(
        self, problem: NormalModeProblem, factors: Sequence[Factor], over: Sweep, exact: _Exact
    ) -> None:
        self.problem, self.factors, self.over, self.exact = problem, factors, over, exact
        self.symbol = problem.coefficients.variable(over.name)
        self.kinds = Kinds(problem, (problem.variable, self.symbol))
        self.speed = common_speed(problem) if problem.variable == "s" else None

    def same_branch(self, value: Fraction) -> bool:
        """Whether nothing that was divided by vanishes and every speed has the sign it was derived with."""
        coefficients = self.problem.coefficients
        at = {self.symbol: value}
        if any(specialise(each, at).is_zero() for each in coefficients.inverted.values()):
            return False
        speeds = [block.field.speed for block in self.problem.blocks if block.field.speed is not None]
        for speed in speeds:
            top, bottom = (specialise(part, at) for part in (speed.num, speed.den))
            if not (top.is_constant() and bottom.is_constant()) or top.is_zero() or bottom.is_zero():
                return False
            if (coefficients.sign(speed) or 1) * top.leading_coefficient() * bottom.leading_coefficient() <= 0:
                return False
        return True

    def holds(self, place: int) -> bool:
        """Whether the exact analysis at a value lists the same roots."""
        value = Fraction(self.over.values[place])
        mine = np.concatenate([self.images(f.polynomial, value)[1] for f in self.factors] or [_NONE])
        theirs = {p.z for p in self.exact.at(place)}
        if place in self.exact.faults:
            return True
        return all((chordal(mine, np.asarray(z)) < SAME).any() for z in theirs) and all(
            any(chordal(np.asarray(z), np.asarray(other)) < SAME for other in theirs) for z in mine
        )

    def images(self, factor: fmpz_mpoly, value: Fraction) -> tuple[Complex, Complex]:
        """(sigma, z) of all roots of a factor at a value, finite ones."""
        polynomial = univariate(specialise(factor, {self.symbol: value}), self.problem.variable)
        if not polynomial:
            return _NONE, _NONE
        found = cast("list[tuple[acb, int]]", polynomial.complex_roots())
        sigma = np.array([complex(ball) for ball, count in found for _ in range(count)], np.complex128)
        sigma = sigma[np.isfinite(sigma)]
        if self.problem.variable == "z":
            return sigma, sigma
        lam = value if self.over.name == self.problem.resolvent.cfl else self._lam()
        return self._mapped(sigma, float(lam))

    def _lam(self) -> Fraction:
        lam = self.problem.coefficients.values[self.problem.resolvent.cfl]
        assert isinstance(lam, Fraction)
        return lam

    def _mapped(self, sigma: Complex, lam: float) -> tuple[Complex, Complex]:
        """Each sigma with every z that the integrator gives it."""
        method = self.problem.resolvent.integrator
        assert method is not None
        if method.kind == "exact":
            with np.errstate(all="ignore"):
                z = np.exp(lam * sigma)
            return sigma[np.isfinite(z)], z[np.isfinite(z)]
        rows = method.characteristic()
        repeated, images = [], []
        for s in sigma:
            powers = [sum(float(c) * (lam * complex(s)) ** p for p, c in enumerate(row)) for row in rows]
            for z in np.roots(powers[::-1]) if np.isfinite(powers).all() else []:
                repeated.append(s)
                images.append(z)
        return np.array(repeated, np.complex128), np.array(images, np.complex128)

    def group(self, factor: Factor) -> _Group:
        """The roots of one factor, judged."""
        found = [self.images(factor.polynomial, Fraction(value)) for value in self.over.values]
        sigma = np.concatenate([s for s, _ in found])
        z = np.concatenate([z for _, z in found])
        place = np.repeat(np.arange(len(found)), [len(z) for _, z in found])
        parameter = np.array([float(v) for v in self.over.values], np.complex128)
        kinds = self.kinds.of(sigma, parameter[place], z)
        roots: list[list[RootPoint]] = [[] for _ in found]
        for at, image, kind, r in zip(place, z, kinds, self._r(sigma, parameter[place]), strict=True):
            judged = kind if kind is not None else self._exactly(int(at), complex(image))
            roots[at].append(RootPoint(complex(image), judged, r))
        return _Group(factor.multiplicity, roots, lambda k, t: self._between(factor, k, t), DIVISIONS)

    def _between(self, factor: Factor, k: int, t: float) -> Complex:
        return self.images(factor.polynomial, _value_between(self.over, k, t))[1]

    def _exactly(self, place: int, z: complex) -> ModeKind | None:
        """The kind that the exact analysis gives the root; the worst of those that are not told from it."""
        near = [p.kind for p in self.exact.at(place) if chordal(np.asarray(p.z), np.asarray(z)) < SAME]
        return min(filter(None, near), key=list(ModeKind).index, default=None)

    def _r(self, sigma: Complex, parameter: Complex) -> list[complex | None]:
        """r = 1 + s/c where every decaying solution is r**(-n); None where there is no such c."""
        if self.speed is None:
            return [None] * len(sigma)
        top, bottom = (self.kinds.evaluated(part, sigma, parameter) for part in (self.speed.num, self.speed.den))
        with np.errstate(all="ignore"):
            found = 1 + sigma * bottom / top
        return [complex(r) if np.isfinite(r) else None for r in found]
