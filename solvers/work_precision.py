"""Error against run time, measured: the reference solver of Section 4, and every route to lam_max.

The solver's problem is the pulse of `waves` at alpha = 0.05, where every condition is stable at both orders; its
error is the largest velocity error over all cells at t = 0.5. The analyser's problem is lam_max of the traditional
second-order coupling (Theorem 3.4) near equal densities; its error is relative, against the exact route's algebraic
number.

Each repetition of an analyser's route takes another alpha, 1 + k/1024: nothing found for one can be reused for the
next. A proof holds for every alpha at once: its seconds are those of the whole theorem, or, once that is proved, of
evaluating it. The times are wall-clock seconds, the error is the largest of the repetitions. The finite matrix has the
mode of an upwind interior exactly on any number of cells (nothing comes back to the interface), so its error is the
bisection's and only its time tells; on other interiors its error falls with the cells.
"""

from __future__ import annotations

import csv
import io
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple, dataclass, fields
from fractions import Fraction
from importlib import metadata
from itertools import chain, count
from statistics import median
from time import perf_counter
from typing import TYPE_CHECKING

from gks.solvers.acoustics import Setting, final_error
from gks.solvers.coupling import CHARACTERISTIC, TRADITIONAL, WEIGHTED
from gks.solvers.wave_figures import CFL, CONVERGENCE_END
from gks.solvers.waves import Interface

if TYPE_CHECKING:
    from flint import acb

    from gks.bounds.theorem import Theorem
    from gks.scheme.model import Scheme

ALPHA = 0.05
"""The solver's density ratio rho_R/rho_L."""

SOLVER_NORM = "largest velocity error at t = 0.5"
ANALYSER_NORM = "relative error of lam_max"

LOW, HIGH = Fraction(1, 5), Fraction(1)
"""Where the slow routes bisect: lam_max is 0.4397 at alpha = 1, and the interior's limit is 1."""

Solve = Callable[[Fraction], tuple[Fraction, Fraction]]
"""lam_max at one alpha, and a bound of its error where the route proves one (0 elsewhere)."""


@dataclass(frozen=True, slots=True)
class Row:
    """One measurement: the error in the norm named, and median, fastest and slowest repetition in seconds."""

    subject: str
    method: str
    setting: str
    norm: str
    error: float
    seconds: float
    fastest: float
    slowest: float
    repeats: int


@dataclass(frozen=True, slots=True)
class Machine:
    """Where it was measured."""

    processor: str
    cores: int
    system: str
    versions: tuple[tuple[str, str], ...]

    def __str__(self) -> str:
        versions = ", ".join(f"{name} {version}" for name, version in self.versions)
        return f"{self.processor}, {self.cores} cores, {self.system}; {versions}"


@dataclass(frozen=True, slots=True)
class WorkPrecision:
    """The table, and the machine it was measured on."""

    rows: tuple[Row, ...]
    machine: Machine

    def to_csv(self) -> str:
        """A line for the machine, behind #, then a header and one line a row."""
        text = io.StringIO()
        text.write(f"# {self.machine}\n")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([field.name for field in fields(Row)])
        writer.writerows(astuple(row) for row in self.rows)
        return text.getvalue()

    def __str__(self) -> str:
        lines = [
            str(self.machine),
            f"{'':9} {'method':<28} {'setting':<16} {'error':>9} {'seconds':>9}  fastest..slowest",
        ]
        lines += [
            f"{row.subject:9} {row.method:<28} {row.setting:<16} {row.error:9.2e} {row.seconds:9.2e}"
            f"  {row.fastest:.2e}..{row.slowest:.2e}"
            for row in self.rows
        ]
        return "\n".join(lines)


def work_precision(
    resolutions: Sequence[int] = (50, 100, 200, 400, 800),
    steps: Sequence[int] = (16, 64, 256),
    cells: Sequence[int] = (2, 4, 8, 16),
    points: Sequence[int] = (1, 100, 10_000),
    bits: Sequence[int] = (53, 128, 333),
    evaluations: Sequence[int] = (1, 10_000),
    repeats: int = 3,
    progress: Callable[[Row], None] | None = None,
) -> WorkPrecision:
    """Measure everything; an empty sequence leaves that route out. `progress` is told of each row as it is found.

    resolutions : 1/dx of the reference solver. steps : of the marches that are bisected. cells : a side, of the finite
    matrices. points : of a sweep on the numeric route, whose seconds are per point. bits : of the certified answer.
    evaluations : points at which the theorem is evaluated: 1 for the proof itself with one point, else per point.
    """
    rows = []
    for row in chain(
        _solver_rows(resolutions, repeats), _analyser_rows(steps, cells, points, bits, evaluations, repeats)
    ):
        if progress is not None:
            progress(row)
        rows.append(row)
    return WorkPrecision(tuple(rows), machine())


def machine() -> Machine:
    """This machine: its processor where the system tells, cores, system, and the versions that matter."""
    versions = [("Python", platform.python_version())]
    versions += [(name, metadata.version(name)) for name in ("numpy", "scipy", "python-flint")]
    return Machine(_processor(), os.cpu_count() or 1, f"{platform.system()} {platform.machine()}", tuple(versions))


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as file:
            names = [line.partition(":")[2].strip() for line in file if line.startswith("model name")]
    except OSError:  # not a Linux system
        names = []
    return names[0] if names else platform.processor() or "processor unknown"


# The reference solver -------------------------------------------------------------------------------------------------


def _solver_rows(resolutions: Sequence[int], repeats: int) -> Iterator[Row]:
    interface = Interface.of_ratio(ALPHA)
    for condition in (TRADITIONAL, WEIGHTED, CHARACTERISTIC):
        for order, interior in ((1, "upwind1"), (2, "fromm")):
            for resolution in resolutions:
                setting = Setting(interface, condition, order, interior, CFL, resolution)
                seconds = []
                for _ in range(repeats):
                    began = perf_counter()
                    error = final_error(setting, CONVERGENCE_END)
                    seconds.append(perf_counter() - began)
                name = f"{condition.name}, order {order}"
                yield _row("solver", name, f"dx = 1/{resolution}", SOLVER_NORM, error, seconds)


def _row(subject: str, method: str, setting: str, norm: str, error: float, seconds: Sequence[float]) -> Row:
    return Row(subject, method, setting, norm, error, median(seconds), min(seconds), max(seconds), len(seconds))


def marching_speed(cells: int = 8000, steps: int = 1000, repeats: int = 3) -> float:
    """Cells (with both unknowns) advanced a second by the general solver: the upwind scheme of `traditional-1`.

    The best of the repetitions. At 8000 cells a side all levels fit in half a megabyte, a second-level cache; on a few
    hundred cells the calls themselves take most of the time.
    """
    from gks.catalogue import find
    from gks.solvers.matrices import layout
    from gks.solvers.problem import build
    from gks.solvers.seeds import random_levels
    from gks.solvers.update import Marcher

    scheme = find("traditional-1")
    grid = layout(build(scheme, scheme.values({})), (cells, cells))
    seconds = []
    for _ in range(repeats):
        marcher = Marcher(grid, random_levels(grid, 0))
        began = perf_counter()
        for _ in range(steps):
            marcher.step()
        seconds.append(perf_counter() - began)
    return 2 * cells * steps / min(seconds)


# The analyser's routes ------------------------------------------------------------------------------------------------


def _analyser_rows(
    steps: Sequence[int],
    cells: Sequence[int],
    points: Sequence[int],
    bits: Sequence[int],
    evaluations: Sequence[int],
    repeats: int,
) -> Iterator[Row]:
    from gks.catalogue import find

    scheme, numbers = find("traditional-2"), count()
    routes: list[tuple[str, str, Solve, int]] = []
    routes += [("march, bisected", f"{n} steps", _by_march(scheme, n), 1) for n in steps]
    routes += [("finite matrix, bisected", f"{n} cells a side", _by_matrix(scheme, n), 1) for n in cells]
    routes += [("numeric, a point of a sweep", f"{n} points", _by_sweep(scheme, n), n) for n in points]
    routes += [("certified", f"{n} bits", _exactly(scheme, n), 1) for n in bits]
    if 1 in evaluations:
        routes += [("proof, for all alpha", "1 point", _by_proof(scheme), 1)]
    evaluated = [n for n in evaluations if n > 1]
    if evaluated:
        theorem = _theorem(scheme)
        routes += [("proved, a point of many", f"{n} points", _by_theorem(theorem, n), n) for n in evaluated]
    for method, setting, solve, share in routes:
        found, seconds = [], []
        for _ in range(repeats):
            alpha = 1 + Fraction(next(numbers), 1024)
            began = perf_counter()
            answer = solve(alpha)
            seconds.append((perf_counter() - began) / share)
            found.append((alpha, answer))
        error = max(_error(scheme, alpha, *answer) for alpha, answer in found)
        yield _row("analyser", method, setting, ANALYSER_NORM, error, seconds)


REFERENCE_BITS = 2048


def _error(scheme: Scheme, alpha: Fraction, value: Fraction, radius: Fraction) -> float:
    """The relative error of a value, with what its route leaves open."""
    exact, _ = _exactly(scheme, REFERENCE_BITS)(alpha)
    return float((abs(value - exact) + radius) / exact)


def _bisected(stable: Callable[[Fraction], bool], halvings: int) -> tuple[Fraction, Fraction]:
    low, high = LOW, HIGH
    for _ in range(halvings):
        middle = (low + high) / 2
        low, high = (middle, high) if stable(middle) else (low, middle)
    return (low + high) / 2, Fraction(0)


HALVINGS_MARCH, HALVINGS_MATRIX = 24, 50
"""Down to 1e-7 and 1e-15: what is left of the error is the route's own."""


def _by_march(scheme: Scheme, steps: int) -> Solve:
    from gks.solvers.runs import march_growth

    def solve(alpha: Fraction) -> tuple[Fraction, Fraction]:
        def stable(lam: Fraction) -> bool:
            return march_growth(scheme, scheme.values({"lam": lam, "alpha": alpha}), steps=steps).growth.rate <= 1

        return _bisected(stable, HALVINGS_MARCH)

    return solve


def _by_matrix(scheme: Scheme, cells: int) -> Solve:
    import numpy as np

    from gks.solvers.update import update_matrix

    def solve(alpha: Fraction) -> tuple[Fraction, Fraction]:
        def stable(lam: Fraction) -> bool:
            matrix = update_matrix(scheme, scheme.values({"lam": lam, "alpha": alpha}), cells)
            return bool(np.abs(np.linalg.eigvals(matrix)).max() <= 1)

        return _bisected(stable, HALVINGS_MATRIX)

    return solve


def _by_sweep(scheme: Scheme, points: int) -> Solve:
    from gks.bounds.curve import curve
    from gks.bounds.sweep import of_values

    def solve(alpha: Fraction) -> tuple[Fraction, Fraction]:
        values = [alpha * (1 + Fraction(k, 100 * points)) for k in range(points)]
        point = curve(scheme, scheme.values({}), of_values("alpha", values)).points[0]
        if not isinstance(point.lam_max, float):
            raise ArithmeticError(f"lam_max at alpha = {alpha} is {point.lam_max}")
        return Fraction(point.lam_max), Fraction(0)

    return solve


def _theorem(scheme: Scheme) -> Theorem:
    from gks.bounds.proof import prove

    theorem = prove(scheme, scheme.values({}, ["alpha"]))
    if not theorem.proved:
        raise ArithmeticError(f"lam_max over alpha is not proved: {theorem.reason}")
    return theorem


def _by_proof(scheme: Scheme) -> Solve:
    return lambda alpha: _by_theorem(_theorem(scheme), 1)(alpha)


def _by_theorem(theorem: Theorem, points: int) -> Solve:
    import numpy as np

    def solve(alpha: Fraction) -> tuple[Fraction, Fraction]:
        bounds = theorem.bound(float(alpha) * (1 + np.arange(points) / (100 * points)))
        return Fraction(float(bounds[0])), Fraction(0)

    return solve


def _exactly(scheme: Scheme, bits: int) -> Solve:
    from gks.bounds.cfl import stable_set

    def solve(alpha: Fraction) -> tuple[Fraction, Fraction]:
        root = stable_set(scheme, scheme.values({"alpha": alpha})).lam_max
        if root is None:
            raise ArithmeticError(f"lam_max at alpha = {alpha} is unbounded")
        return _centre_and_radius(root.ball(bits))

    return solve


def _centre_and_radius(ball: acb) -> tuple[Fraction, Fraction]:
    centre, radius = (
        Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
        for mantissa, exponent in (ball.real.mid().man_exp(), ball.real.rad().man_exp())
    )
    return centre, radius
