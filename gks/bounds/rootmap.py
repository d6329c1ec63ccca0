"""Where the roots z of the characteristic polynomial move as one parameter runs.

Where elimination is in reach the polynomial is derived once, with the parameter as a symbol; at each value its roots
are isolated in balls, mapped to z, and judged in doubles, exactly where doubles leave a doubt (`rootkinds`). Roots of
one irreducible factor are followed from value to value (`roottracks`). Elsewhere every value is analysed by itself, and
the tracks are those of the modes that are listed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from time import perf_counter

import numpy as np
from flint import fmpz_mpoly

from gks.bounds.rootdiscs import separations
from gks.bounds.rootimages import Images, growth_factors, isolated, joined
from gks.bounds.rootkinds import kinds
from gks.bounds.rootpaths import RootMap, RootPoint, Track
from gks.bounds.roottracks import follow
from gks.bounds.sampled import Array, ComplexArray, sampled
from gks.bounds.sweep import Sweep
from gks.errors import InputError, ParameterError
from gks.modes.analysis import analyse
from gks.modes.derivation import common_speed
from gks.modes.doubledouble import UNIT
from gks.modes.fibre import specialise, univariate
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.numerals import to_double
from gks.modes.polynomial import Degenerate, Factor, TooWide, characteristic_factors
from gks.modes.verdict import ModeKind
from gks.scheme.model import Scheme
from gks.scheme.numbers import decimal_text

Progress = Callable[[int, int], None]

DIVISIONS, COSTLY_DIVISIONS = 12, 3
"""Halvings of one step of the sweep: where roots are cheap, and where each means an analysis of the scheme."""
MOST_POINTS = 20_000
"""Values of a root map: more than any picture shows."""


def rootmap(scheme: Scheme, values: Mapping[str, Fraction], over: Sweep, progress: Progress | None = None) -> RootMap:
    """Follows every root over a sweep of a parameter, the CFL number included.

    Raises InputError where there is no scheme at any value; single values without one are ``faults``.
    """
    start = perf_counter()
    scheme.parameter(over.name)
    if len(over.values) > MOST_POINTS:
        raise ParameterError(f"{len(over.values)} values", path="--sweep", expected=f"at most {MOST_POINTS}")
    if over.name == scheme.cfl and min(over.values) <= 0:
        raise ParameterError(f"{over.name} runs to {min(over.values)}", path="--sweep", expected="dt/dx is positive")
    for value in (*over.values, *values.values()):
        if to_double(Fraction(value)) is None:
            text = decimal_text(Fraction(value))
            raise ParameterError(f"a value of {text}", expected="roots are followed in doubles")
    exact = _Exact(scheme, values, over)
    polynomial = _polynomial(scheme, values, over, exact)
    if polynomial is None:
        tracks = _joined(exact.group(progress))
    else:
        tracks = [track for group in polynomial.groups() for track in _joined(group)]
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
    between: Callable[[int, float], ComplexArray]
    depth: int


def _joined(group: _Group) -> list[Track]:
    """Tracks through the roots of all values; a root that has no continuation ends a track, a new one begins one."""
    count = len(group.roots)
    tracks: list[list[RootPoint | None]] = []
    live: list[int] = []
    before: ComplexArray = np.empty(0, np.complex128)
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
                RootPoint(z, mode.kind, error=float(mode.radius) + 2 * UNIT * abs(z))
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

    def _between(self, k: int, t: float) -> ComplexArray:
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


class _Polynomial:
    """The irreducible factors in sigma and the parameter, their roots at every value."""

    def __init__(self, problem: NormalModeProblem, factors: Sequence[Factor], over: Sweep, exact: _Exact) -> None:
        self.problem, self.factors, self.over, self.exact = problem, factors, over, exact
        self.symbol = problem.coefficients.variable(over.name)
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
        """Whether the exact analysis at a value lists the same roots, each within both errors."""
        value = Fraction(self.over.values[place])
        mine = joined([self.images(f.polynomial, value) for f in self.factors])
        theirs = self.exact.at(place)
        if place in self.exact.faults:
            return True
        z, error = np.array([p.z for p in theirs], np.complex128), np.array([p.error for p in theirs])
        bound = mine.error[:, None] + error
        same = (np.abs(mine.z[:, None] - z) <= bound) & np.isfinite(bound)
        return bool(same.any(axis=0).all() and same.any(axis=1).all())

    def images(self, factor: fmpz_mpoly, value: Fraction) -> Images:
        """All roots of a factor at a value, finite ones."""
        polynomial = univariate(specialise(factor, {self.symbol: value}), self.problem.variable)
        if not polynomial:
            return Images.none()
        roots = isolated(polynomial)
        if self.problem.variable == "z":
            return roots
        method = self.problem.resolvent.integrator
        assert method is not None
        lam = value if self.over.name == self.problem.resolvent.cfl else self._lam()
        return growth_factors(method, roots, float(lam))

    def _lam(self) -> Fraction:
        lam = self.problem.coefficients.values[self.problem.resolvent.cfl]
        assert isinstance(lam, Fraction)
        return lam

    def groups(self) -> Iterator[_Group]:
        """The roots of every factor, judged."""
        found = [[self.images(f.polynomial, Fraction(value)) for value in self.over.values] for f in self.factors]
        gaps = [self._gaps(here) for here in zip(*found, strict=True)]
        compiled = sampled(self.problem)
        for k, factor in enumerate(self.factors):
            roots = joined(found[k])
            place = np.repeat(np.arange(len(found[k])), [len(each) for each in found[k]])
            parameter = np.array([float(v) for v in self.over.values])[place]
            told = kinds(compiled, roots, np.concatenate([each[k] for each in gaps]), parameter)
            points: list[list[RootPoint]] = [[] for _ in found[k]]
            numbers = zip(place.tolist(), roots.z.tolist(), roots.error.tolist(), strict=True)
            for (at, z, error), kind, r in zip(numbers, told, self._r(roots.sigma, parameter), strict=True):
                judged = kind if kind is not None else self._exactly(at, z, error)
                points[at].append(RootPoint(z, judged, r, error))
            yield _Group(factor.multiplicity, points, partial(self._between, factor), DIVISIONS)

    def _gaps(self, here: Sequence[Images]) -> list[Array]:
        """The distance of every root sigma from any other, for the roots of all factors at a value.

        Two factors' roots are two, though they may coincide at single values.
        """
        distinct = [np.unique(each.root, return_index=True, return_inverse=True)[1:] for each in here]
        sigma, radius = (
            np.concatenate([getattr(each, name)[first] for each, (first, _) in zip(here, distinct, strict=True)])
            for name in ("sigma", "radius")
        )
        ends = np.cumsum([len(first) for first, _ in distinct])[:-1]
        apart = np.split(separations(sigma, radius), ends)
        return [mine[back] for mine, (_, back) in zip(apart, distinct, strict=True)]

    def _between(self, factor: Factor, k: int, t: float) -> ComplexArray:
        return self.images(factor.polynomial, _value_between(self.over, k, t)).z

    def _exactly(self, place: int, z: complex, error: float) -> ModeKind | None:
        """The kind that the exact analysis gives the root; None where it lists roots of several that may be this."""
        near = {p.kind for p in self.exact.at(place) if abs(p.z - z) <= p.error + error}
        return near.pop() if len(near) == 1 else None

    def _r(self, sigma: ComplexArray, parameter: Array) -> list[complex | None]:
        """r = 1 + s/c where every decaying solution is r**(-n); None where there is no such c."""
        if self.speed is None:
            return [None] * len(sigma)
        top, bottom = (self._evaluated(part, sigma, parameter) for part in (self.speed.num, self.speed.den))
        with np.errstate(all="ignore"):
            found = 1 + sigma * bottom / top
        return [complex(r) if np.isfinite(r) else None for r in found]

    def _evaluated(self, polynomial: fmpz_mpoly, sigma: ComplexArray, parameter: Array) -> ComplexArray:
        """A polynomial in sigma and the parameter, in doubles: inf where a coefficient is beyond them."""
        places = [polynomial.context().variable_to_index(name) for name in (self.problem.variable, self.symbol)]
        total = np.zeros(sigma.shape, np.complex128)
        for powers, coefficient in polynomial.to_dict().items():
            try:
                weight = float(int(coefficient))
            except OverflowError:
                weight = np.inf
            total = total + weight * sigma ** int(powers[places[0]]) * parameter ** int(powers[places[1]])
        return total
