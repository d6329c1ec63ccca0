"""How fast: curves, verdicts and certified counts, beside the two ways that need no analysis.

The baselines answer the same question at the same points, in the same process: the spectral radius of the finite update
matrix, bisected in the CFL number, and `numpy.roots` on the derived polynomial, one point after the other. The `gks`
command keeps BLAS on one thread. Seconds are those of the processor, the median of the repetitions: on one thread they
are what a clock shows on a machine with nothing else to do.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from statistics import median
from time import process_time

import numpy as np

from gks.bounds.along import verdicts_along
from gks.bounds.batch import batch
from gks.bounds.curve import curve
from gks.bounds.independent import verdicts_at
from gks.bounds.sweep import parse_sweep
from gks.catalogue import find, names
from gks.catalogue.interfaces import COPIED, closure_lines, ghost_equations, two_media
from gks.modes.analysis import analyse, quick_verdict
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import ModeKind
from gks.modes.wide import WideModes, wide_modes
from gks.reports.tables import Cell, Table
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.update import update_matrix
from gks.solvers.work_precision import machine

REPEATS = 3
CELLS = 12
"""Cells a side of the finite matrix: fewer would not tell a mode from a far end."""
BISECTIONS = 20
"""Spectral radii for one lam_max: an error of 1e-6, ten digits short of the other ways."""
POINTS = 2000
"""Independent points of a wide stencil, judged in one call."""
DISTANCE = Fraction(1, 10**12)
"""From neutral, relative to the parameter."""
LAX_WENDROFF_NEUTRAL = Fraction(3)
"""The alpha at which the Lax-Wendroff interface is neutral for every lam < 1 (`gks prove` shows it)."""
NEUTRAL_STEPS = 12
"""Secant steps to a neutral value: from a coarse bracket to far below DISTANCE."""

COLUMNS = ("what", "points", "seconds", "points/s", "baseline", "times the baseline", "target", "met")


@dataclass(frozen=True, slots=True)
class _Timed:
    """So many points in so many seconds."""

    points: int
    seconds: float

    @property
    def rate(self) -> float:
        return self.points / self.seconds


def measure(progress: Callable[[str], None]) -> Table:
    """The table; about a minute."""
    rows: list[tuple[Cell, ...]] = []
    for part in (_curves, _verdicts, _wide, _catalogue, _certified):
        for each in part():
            rows.append(each)
            progress(str(each[0]))
    return Table(
        "Speed, in one process",
        COLUMNS,
        tuple(rows),
        (
            f"seconds of the processor, median of {REPEATS} repetitions (slow ways: one)",
            f"BLAS threads: {os.environ.get('OPENBLAS_NUM_THREADS', 'not set')}",
            f"finite matrix: spectral radius on {CELLS} cells a side, bisected {BISECTIONS} times for a lam_max",
            "numpy.roots: the derived polynomial's coefficients and roots in a plain loop",
            str(machine()),
        ),
    )


def timed(points: int, work: Callable[[], object], repeats: int = REPEATS) -> _Timed:
    """The median time of a piece of work that answers so many points."""
    seconds = []
    for _ in range(repeats):
        start = process_time()
        work()
        seconds.append(process_time() - start)
    return _Timed(points, median(seconds))


def row(
    what: str, mine: _Timed, baseline: str = "", other: _Timed | None = None, rate: float | None = None,
    limit: float | None = None,
) -> tuple[Cell, ...]:  # fmt: skip
    """One row: against a baseline, and a target as a rate or as a limit in seconds."""
    ratio = None if other is None else mine.rate / other.rate
    target = None if rate is None and limit is None else f"{rate:.0e} points/s" if rate is not None else f"{limit:g} s"
    met: bool | None = None
    if rate is not None:
        met = mine.rate >= rate
    elif limit is not None:
        met = mine.seconds / mine.points <= limit
    return (what, mine.points, mine.seconds, mine.rate, baseline or None, ratio, target, met)


# Curves ---------------------------------------------------------------------------------------------------------------


def _curves() -> Iterator[tuple[Cell, ...]]:
    scheme = find("traditional-1")
    values = scheme.values()
    matrix = timed(2, lambda: [_scanned(scheme, {**values, "alpha": Fraction(a)}) for a in (4, 9)], 1)
    loop = timed(2000, lambda: [_looped(alpha) for alpha in np.logspace(-4, 4, 2000)])
    sweep = parse_sweep("alpha=1e-4:1e4:100001:log")
    mine = timed(len(sweep.values), lambda: curve(scheme, values, sweep))
    what = "lam_max, first-order interface, along alpha"
    yield row(what, mine, "finite matrix", matrix, rate=2e5)
    yield row(what, mine, "numpy.roots", loop, rate=2e5)
    arrays = timed(len(sweep.values), lambda: batch(scheme, values, "alpha", sweep.values))
    yield row("the same as arrays, without an object a point", arrays, "numpy.roots", loop, rate=2e5)
    wide = find("lax-wendroff-order-8-oblique")
    one = timed(1, lambda: curve(wide, wide.values()))
    slow = timed(1, lambda: _scanned(wide, wide.values()), 1)
    yield row("lam_max, Lax-Wendroff of order 8, its ends certified", one, "finite matrix", slow)


def _scanned(scheme: Scheme, values: Mapping[str, Fraction]) -> float:
    """lam_max in (0, 2) by bisecting the spectral radius of the finite matrix, as one does without an analysis."""
    low, high = 0.0, 2.0
    for _ in range(BISECTIONS):
        middle = low / 2 + high / 2
        matrix = update_matrix(scheme, {**values, scheme.cfl: Fraction(middle)}, CELLS)
        stable = np.abs(np.linalg.eigvals(matrix)).max() <= 1 + 1e-9
        low, high = (middle, high) if stable else (low, middle)
    return low


def _looped(alpha: float) -> float:
    """lam_max of the first-order traditional coupling from numpy.roots of 4 r**2 - 4 r + alpha + 1."""
    limit = 1.0
    for r in np.roots([4.0, -4.0, alpha + 1.0]):
        if abs(r) > 1:
            limit = min(limit, -2 * (1 / (r - 1)).real)
    return limit


# Verdicts -------------------------------------------------------------------------------------------------------------


def _verdicts() -> Iterator[tuple[Cell, ...]]:
    scheme = find("traditional-1")
    values = scheme.values()
    ratios = [Fraction(k, 7) for k in range(1, 41)]
    radius = timed(1, lambda: _radius(scheme, values))
    mine = timed(len(ratios), lambda: [quick_verdict(scheme, {**values, "alpha": a}) for a in ratios])
    yield row("verdict, first-order interface", mine, "spectral radius", radius, limit=1e-4)
    mine = timed(len(ratios), lambda: [analyse(scheme, {**values, "alpha": a}) for a in ratios])
    yield row("verdict and modes, first-order interface", mine, "spectral radius", radius)
    wide = find("lax-wendroff-order-8-oblique")
    lams = [Fraction(k, 40) for k in range(20, 40)]
    radius = timed(1, lambda: _radius(wide, wide.values()))
    mine = timed(1, lambda: analyse(wide, wide.values()))
    yield row("verdict, modes and winding, Lax-Wendroff of order 8", mine, "spectral radius", radius, limit=0.1)
    mine = timed(len(lams), lambda: [quick_verdict(wide, {**wide.values(), wide.cfl: lam}) for lam in lams])
    yield row("verdict, Lax-Wendroff of order 8, certified", mine, "spectral radius", radius)


def _wide() -> Iterator[tuple[Cell, ...]]:
    """Order 8 with a weight in its closure: many points at once, and along the weight."""
    scheme = weighted_order_8()
    values = scheme.values()
    source = np.random.default_rng(0)
    at = {"lam": source.uniform(0.2, 0.95, POINTS), "a": source.uniform(0.1, 3.0, POINTS)}
    radius = timed(1, lambda: _radius(scheme, values))
    mine = timed(POINTS, lambda: verdicts_at(scheme, values, at), 1)
    yield row("verdicts, Lax-Wendroff of order 8, independent, at once", mine, "spectral radius", radius, rate=2e3)
    along = np.linspace(0.1, 3.0, 100_001)
    low, high = Fraction(1, 10), Fraction(3)
    mine = timed(len(along), lambda: verdicts_along(scheme, values, "a", low, high).at(along), 1)
    yield row("verdicts, Lax-Wendroff of order 8, along one parameter", mine, "spectral radius", radius, rate=1e5)


def weighted_order_8() -> Scheme:
    """The shipped scheme with a weight in the last closure equation, at which it loses its stability."""
    text, _, _ = find("lax-wendroff-order-8-oblique").text.partition("[[claims]]")
    text = text.replace("[parameters]", "[parameters]\na = { default = 1 }")
    return parse_scheme(text.replace('"u[3, n+1] = u[4]"', '"u[3, n+1] = u[4] + (a - 1)*u[3]"'), "weighted")


def _radius(scheme: Scheme, values: Mapping[str, Fraction]) -> float:
    return float(np.abs(np.linalg.eigvals(update_matrix(scheme, values, CELLS))).max())


def _catalogue() -> Iterator[tuple[Cell, ...]]:
    schemes = [find(name) for name in names()]
    mine = timed(1, lambda: [analyse(scheme, scheme.values()) for scheme in schemes], 1)
    yield row(f"the whole catalogue, {len(schemes)} schemes", mine, limit=20)


# Certified counts next to a neutral value ----------------------------------------------------------------------------


def _certified() -> Iterator[tuple[Cell, ...]]:
    """One row a CFL number: its cost grows as lam -> 0, where branch points come to the unit circle."""
    for name, lams in (("lax-wendroff", (19, 14, 10, 4, 2, 1)), ("fromm", (19, 14, 10, 4))):
        scheme = interface(name)
        for twentieths in lams:
            lam = Fraction(twentieths, 20)
            what = f"certified at 1e-12 from neutral, {name} interface, lam = {float(lam):g}"
            alpha = LAX_WENDROFF_NEUTRAL if name == "lax-wendroff" else neutral(scheme, lam)
            if alpha is None:
                yield (what + " (no neutral alpha was found)", None, None, None, None, None, None, None)
                continue
            yield _beside(what, scheme, {scheme.cfl: lam, "alpha": alpha * (1 + DISTANCE)})


def _beside(what: str, scheme: Scheme, values: Mapping[str, Fraction]) -> tuple[Cell, ...]:
    """The certified count at one set of values, held against the matrix that would have to tell them from neutral."""
    problem = normal_mode_problem(scheme, values)
    found: list[WideModes] = []
    mine = timed(1, lambda: found.append(wide_modes(problem)))
    radius = timed(1, lambda: _radius(scheme, values), 1)
    name = what if found[0].certified else what + " (left open)"
    return row(name, mine, "spectral radius", radius, limit=1 if values[scheme.cfl] >= Fraction(1, 2) else None)


def interface(name: str) -> Scheme:
    """Two wave systems, coupled by the left velocity and the right stress, under a fully discrete scheme."""
    depth = 1 if name == "lax-wendroff" else 2
    title = f"{name} interface, traditional coupling"
    parameters = 'lam = { role = "cfl", default = 0.5 }\nalpha = 1'
    copied = closure_lines(ghost_equations(1, depth, COPIED, COPIED))
    return parse_scheme(two_media(title, parameters, f'scheme = "{name}"', copied), name)


def neutral(scheme: Scheme, lam: Fraction) -> Fraction | None:
    """The alpha at which the growing mode of large alpha becomes neutral, to far below DISTANCE; None if none is found.

    Secant steps on the largest modulus, which the certified count gives to 28 digits, from the unstable side.
    """
    first, second = Fraction(12), Fraction(11)
    growth = [_growth(scheme, lam, first), _growth(scheme, lam, second)]
    for _ in range(NEUTRAL_STEPS):
        a, b = growth
        if a is None or b is None or a == b:
            return None
        step = b * (second - first) / (b - a)
        # A secant step is off by about the product of the last two steps over alpha: so much is left, to stay above.
        left = abs(step * (first - second)) / second
        if left < second * DISTANCE / 1000:
            return (second - step).limit_denominator(10**24)
        following = (second - step + left).limit_denominator(10**30)
        after = _growth(scheme, lam, following)
        while after is None and abs(following - second) > DISTANCE:
            following = (following + second) / 2
            after = _growth(scheme, lam, following)
        first, second, growth = second, following, [b, after]
    return None


def _growth(scheme: Scheme, lam: Fraction, alpha: Fraction) -> Fraction | None:
    """abs(z)**2 - 1 of the mode of largest modulus, None where no mode was found."""
    found = wide_modes(normal_mode_problem(scheme, {scheme.cfl: lam, "alpha": alpha})).modes
    sizes = [m.z[0] ** 2 + m.z[1] ** 2 - 1 for m in found if m.kind is not ModeKind.INADMISSIBLE]
    return max(sizes, default=None)
