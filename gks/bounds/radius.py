"""The largest modulus of an admissible mode over a parameter and lam, in double precision: data for maps.

The characteristic polynomial is eliminated once with both as symbols. Its roots at every point are polished by Newton's
method, enclosed in discs (`gks.bounds.rootdiscs`), and kept where Delta of their own decaying solutions vanishes
(`gks.bounds.deltazeros`). A point at which that is in doubt is masked; on and next to the unit circle the numbers
decide nothing, and `gks modes` has the verdict.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from time import perf_counter
from typing import Literal

import numpy as np
from flint import fmpz_mpoly
from numpy.typing import NDArray

from gks.bounds.allroots import all_roots
from gks.bounds.deltazeros import judged
from gks.bounds.located import close_to
from gks.bounds.rootdiscs import gaps, rounded
from gks.bounds.sampled import Array, ComplexArray, polynomial_at, polynomial_of, sampled
from gks.bounds.signs import interior_sets, signs_stand
from gks.bounds.sweep import Sweep
from gks.errors import InputError, NotAnalysable, ParameterError
from gks.modes.analysis import analyse
from gks.modes.cauchy import degree_in
from gks.modes.cauchy_set import CauchySet
from gks.modes.interior import field_symbol
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem
from gks.modes.polynomial import Degenerate, characteristic_factors
from gks.modes.route import elimination_work
from gks.modes.solvable import degenerate_closure
from gks.modes.verdict import ModeKind, Verdict
from gks.scheme.integrators import Integrator
from gks.scheme.model import Scheme

Mask = NDArray[np.bool_]

MAP_WORK = 64
"""`elimination_work` up to which a problem is eliminated with two symbols: two second-order fields on either side take
a fraction of a second."""
NEAR = 1e-9
"""Error, absolute or relative, of a modulus that counts as known, and with it the distance from 1 at which it is on a
side. A choice: what double precision gives a simple root of moderate condition, with some digits to spare. Every error
is computed (`gks.bounds.rootdiscs`), and a point where one is larger is masked."""

Shown = Literal["stable", "unstable", "near"]


@dataclass(frozen=True, slots=True)
class RadiusMap:
    """Arrays over the values of a parameter (rows; one row where none runs) and over lam (columns).

    radius : the largest modulus of an admissible mode; 0 where there is none or it is not known.
    known : where it was found without doubt.
    interior : where the interior scheme is Cauchy-stable; elsewhere the modes mean nothing and are not looked at.
    """

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    sweep: Sweep | None
    values: Array
    lams: Array
    radius: Array
    known: Mask
    interior: Mask
    time_s: float = field(compare=False)

    @property
    def verdict(self) -> NDArray[np.str_]:
        """ "stable", "unstable", "near" (the unit circle, or not known)."""
        found = np.where(self.radius < 1 - NEAR, "stable", np.where(self.radius > 1 + NEAR, "unstable", "near"))
        return np.where(self.interior, np.where(self.known, found, "near"), "unstable")

    @property
    def names(self) -> tuple[str, ...]:
        """The parameter, if one runs, and the CFL number."""
        return (*((self.sweep.name,) if self.sweep else ()), self.scheme.cfl)

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.radius/1",
            "sweep": list(self.names),
            "points": [dict(zip((*self.names, "radius", "verdict"), row, strict=True)) for row in self._rows()],
            "tier": "numeric",
            "time_s": self.time_s,
        }

    def json_text(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)

    def to_csv(self) -> str:
        """Columns: the parameter, the CFL number, radius (empty where it is not known), verdict."""
        lines = [",".join([*self.names, "radius", "verdict"])]
        lines += [",".join("" if entry is None else str(entry) for entry in row) for row in self._rows()]
        return "\n".join(lines) + "\n"

    def _rows(self) -> list[list[object]]:
        rows: list[list[object]] = []
        verdict = self.verdict
        for i, value in enumerate(self.values.tolist()):
            for k, lam in enumerate(self.lams.tolist()):
                head = [value, lam] if self.sweep else [lam]
                known = self.known[i, k] and self.interior[i, k]
                rows.append([*head, float(self.radius[i, k]) if known else None, str(verdict[i, k])])
        return rows

    def __str__(self) -> str:
        verdict = self.verdict
        counts = {word: int((verdict == word).sum()) for word in ("stable", "unstable", "near")}
        shape = " x ".join(str(n) for n in self.radius.shape if self.sweep or n > 1)
        return "\n".join(
            [
                self.scheme.title,
                f"  largest admissible modulus over {' and '.join(self.names)}",
                f"  stable {counts['stable']}, unstable {counts['unstable']}, "
                f"too near the unit circle to tell {counts['near']}",
                f"  ({shape} points, {self.time_s:.3g} s; -o writes them, --json prints them)",
            ]
        )


def radius_map(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    sweep: Sweep | None,
    lam_values: Sequence[Fraction | float],
    progress: Callable[[int, int], None] | None = None,
) -> RadiusMap:
    """The map; ``sweep`` None for one row at the values given. InputError as the analyses raise it.

    Where the characteristic polynomial is out of reach with both as symbols the points are analysed one by one, which
    takes about a tenth of a second each; ``progress`` is told of these.
    """
    start = perf_counter()
    exact = [Fraction(v) for v in sweep.values] if sweep else [Fraction(0)]
    if not all(lam > 0 for lam in lam_values):
        raise ParameterError("a CFL number that is not positive", path=scheme.cfl, expected="positive numbers")
    lams = np.array([float(v) for v in lam_values])
    symbols = (*((sweep.name,) if sweep else ()), scheme.cfl)
    problem = _problem(scheme, values, sweep, exact, [Fraction(lam) for lam in lam_values], symbols)
    interior = _interior(problem, values, sweep, exact, lams)
    column = np.array([float(v) for v in exact])
    arguments = (np.repeat(column, len(lams)), np.tile(lams, len(column)))
    try:
        radius, known = _largest(problem, arguments if sweep else arguments[1:])
        derived = np.repeat(_as_derived(problem, sweep, exact), len(lams))
    except NotAnalysable:
        radius, known, derived = (np.zeros(interior.size, kind) for kind in (float, bool, bool))

    def point(k: int) -> Mapping[str, Fraction]:
        row, place = divmod(k, len(lams))
        return {**values, **({sweep.name: exact[row]} if sweep else {}), scheme.cfl: Fraction(lam_values[place])}

    _one_by_one(scheme, point, interior.ravel() & ~derived, radius, known, progress)
    shape = (len(column), len(lams))
    radius, known = radius.reshape(shape), known.reshape(shape)
    radius = np.where(known & interior, radius, 0.0)
    return RadiusMap(scheme, dict(values), sweep, column, lams, radius, known, interior, perf_counter() - start)


def _problem(
    scheme: Scheme, values: Mapping[str, Fraction], sweep: Sweep | None, exact: Sequence[Fraction],
    lams: Sequence[Fraction], symbols: Sequence[str],
) -> NormalModeProblem:  # fmt: skip
    """With the parameter and lam as symbols, at the first values for which there is a scheme and no speed vanishes."""
    fault: InputError | None = None
    for lam in (lams[0], lams[-1]):
        for k in (len(exact) // 2, len(exact) // 3, 0):
            at = {**values, scheme.cfl: lam, **({sweep.name: exact[k]} if sweep else {})}
            try:
                return normal_mode_problem(scheme, at, symbols)
            except InputError as error:
                fault = error
    assert fault is not None
    raise fault


# Interior -------------------------------------------------------------------------------------------------------------


def _interior(
    problem: NormalModeProblem,
    values: Mapping[str, Fraction],
    sweep: Sweep | None,
    exact: Sequence[Fraction],
    lams: Array,
) -> Mask:
    """Where the interior is Cauchy-stable, exactly but for the rounding of lam: (values, lams)."""
    scheme = problem.scheme
    rows = []
    for value in exact:
        at = {**values, scheme.cfl: Fraction(1), **({sweep.name: value} if sweep else {})}
        try:
            rows.append(within(interior_sets(scheme, at)[0], lams))
        except InputError:
            rows.append(np.zeros(len(lams), bool))
        if sweep is None or not in_interior(problem, sweep.name):
            return np.tile(rows[0], (len(exact), 1))
    return np.stack(rows)


def _as_derived(problem: NormalModeProblem, sweep: Sweep | None, exact: Sequence[Fraction]) -> Mask:
    """The rows in which upwinding takes the same sides at every lam as where the problem was derived."""
    if sweep is None:
        return np.array([signs_stand(problem, problem.scheme.cfl, Fraction(1))])
    return np.array([signs_stand(problem, sweep.name, value) for value in exact])


def in_interior(problem: NormalModeProblem, name: str) -> bool:
    """Whether the parameter enters a field's symbol."""
    variable = problem.coefficients.variable(name)
    symbols = (field_symbol(block.field, problem.coefficients) for block in problem.blocks)
    return any(degree_in(symbol, variable) for symbol in symbols) or bool(problem.coefficients.generators)


def within(interior: Sequence[CauchySet], lams: Array) -> Mask:
    """Which lam are in all of the sets."""
    good = np.ones(len(lams), bool)
    for each in interior:
        mine = np.zeros(len(lams), bool)
        for interval in each.intervals:
            low, high = (np.inf if end is None else float(close_to(end)) for end in (interval.low, interval.high))
            mine |= (lams > low) & (lams < high)
            mine |= interval.high_stable & (lams == high)
            mine |= interval.low_stable & (lams == low)
        good &= mine
    return good


# Modes ----------------------------------------------------------------------------------------------------------------


def _largest(problem: NormalModeProblem, symbols: Sequence[Array]) -> tuple[Array, Mask]:
    """The largest modulus of a mode (0 where there is none) and whether it is known; ``symbols`` end with lam."""
    if elimination_work(problem) > MAP_WORK:
        raise NotAnalysable("the characteristic polynomial is out of reach with two symbols")
    try:
        elimination = characteristic_factors(problem)
    except Degenerate:
        raise degenerate_closure(problem) from None
    factors = [factor.polynomial for factor in (*elimination.factors, *elimination.clearing)]
    with np.errstate(all="ignore"):  # what is not finite is not known
        return _of_factors(problem, factors, symbols)


def _one_by_one(
    scheme: Scheme,
    point: Callable[[int], Mapping[str, Fraction]],
    chosen: Mask,
    radius: Array,
    known: Mask,
    progress: Callable[[int, int], None] | None,
) -> None:
    """The same from the modes, written in at the points chosen."""
    places = np.flatnonzero(chosen).tolist()
    for done, k in enumerate(places, 1):
        radius[k], known[k] = 0.0, False
        with suppress(InputError):  # no scheme at these values
            found = analyse(scheme, point(k))
            kept = [float(m.modulus) for m in found.modes if m.kind is not ModeKind.INADMISSIBLE]
            radius[k], known[k] = max(kept, default=0.0), found.verdict is not Verdict.UNDECIDED
        if progress is not None:
            progress(done, len(places))


def _of_factors(
    problem: NormalModeProblem, factors: Sequence[fmpz_mpoly], symbols: Sequence[Array]
) -> tuple[Array, Mask]:
    """The same. Where the roots are s and none moves with lam they are found once for every value of the parameter."""
    lam = symbols[-1]
    symbol = problem.coefficients.variable(problem.resolvent.cfl)
    once = problem.variable == "s" and not any(degree_in(factor, symbol) for factor in factors)
    first = np.flatnonzero(lam == lam[0]) if once else np.arange(len(lam))
    some = [each[first] for each in symbols]
    sigma, radii = _roots(problem, factors, some)
    axis = np.abs(sigma.real) if problem.variable == "s" else np.abs(np.abs(sigma) - 1)
    degree = sigma.shape[1]
    found = judged(
        sampled(problem), sigma.ravel(), radii.ravel(), gaps(sigma, radii).ravel(), (axis <= NEAR / 2).ravel(),
        [np.repeat(each, degree) for each in some],
    )  # fmt: skip
    repeat = len(lam) // len(first)
    sigma, radii = np.repeat(sigma, repeat, axis=0), np.repeat(radii, repeat, axis=0)
    mode, unsure, limit = (
        np.repeat(each.reshape(len(first), degree), repeat, axis=0) for each in (found.mode, found.unsure, found.limit)
    )
    modulus = _growth(problem, sigma, lam)
    error = _error(problem, sigma, lam, modulus, radii)
    # Where time integration damps it, a wave that does not decay in space is no limit of decaying ones.
    doubt = mode & (~(error <= NEAR * np.maximum(1, modulus)) | (limit & (modulus < 1 - NEAR)))
    mode, unsure = mode & ~doubt, unsure | doubt
    largest = np.where(mode, modulus, 0.0).max(axis=1, initial=0.0)
    # A root in doubt does not matter below a modulus that is certain, nor at z = 0.
    most = modulus + error
    doubtful = (unsure & ~((most < largest[:, None]) | (most == 0))).any(axis=1)
    return largest, ~doubtful & np.isfinite(largest)


def _roots(
    problem: NormalModeProblem, factors: Sequence[fmpz_mpoly], symbols: Sequence[Array]
) -> tuple[ComplexArray, Array]:
    """The roots of all factors at every point, and the radii of their discs."""
    roots, radii = [np.empty((len(symbols[0]), 0), complex)], [np.empty((len(symbols[0]), 0))]
    for factor in factors:
        polynomials = rounded(polynomial_of(problem, factor), *symbols)
        roots.append(_polished(polynomials.coefficients, all_roots(polynomials.coefficients)))
        radii.append(polynomials.discs(roots[-1]))
    return np.concatenate(roots, axis=1), np.concatenate(radii, axis=1)


def _error(problem: NormalModeProblem, sigma: ComplexArray, lam: Array, modulus: Array, distance: Array) -> Array:
    """What the modulus changes by at most, to first order, over such a distance in sigma."""
    if problem.variable == "z":
        return distance
    moved = [np.abs(_growth(problem, sigma + distance * unit, lam) - modulus) for unit in (1, 1j)]
    return np.asarray(moved[0] + moved[1])


def _polished(coefficients: ComplexArray, roots: ComplexArray) -> ComplexArray:
    """Two Newton steps, where they make the residual smaller: companion matrices lose small roots beside large ones."""
    slopes = coefficients[:, 1:] * np.arange(1, coefficients.shape[1])
    for _ in range(2):
        value, slope = _at(coefficients, roots), _at(slopes, roots)
        moved = roots - value / slope
        better = np.abs(_at(coefficients, moved)) < np.abs(value)
        roots = np.where(better, moved, roots)
    return roots


def _at(coefficients: ComplexArray, x: ComplexArray) -> ComplexArray:
    value = np.zeros_like(x)
    for c in coefficients.T[::-1]:
        value = value * x + c[:, None]
    return value


def _growth(problem: NormalModeProblem, sigma: ComplexArray, lam: Array) -> Array:
    """The largest abs(z) of every root: sigma itself, or what the integrator makes of lam*s."""
    if problem.variable == "z":
        return np.abs(sigma)
    method = problem.resolvent.integrator
    assert method is not None
    return _amplified(method, lam[:, None] * sigma)


def _amplified(method: Integrator, mu: ComplexArray) -> Array:
    if method.kind == "exact":
        return np.exp(mu.real)
    rows = [polynomial_at(row, mu) for row in method.characteristic()]
    coefficients = np.stack([row.ravel() for row in rows], axis=1)
    return np.asarray(np.abs(all_roots(coefficients)).max(axis=1).reshape(mu.shape))
