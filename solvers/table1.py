"""Section 2 of Banks & Sjögreen as data: Table 1, Figures 2, 10 and 11, and the linear theory beside them.

The theory is that of two acoustic half-lines with unequal speeds (`coupling`), linearised at the state between the
waves of the exact Riemann solution: rho_L = rho_s, c_L = c_s, rho_R = rho*, c_R = sqrt(gamma p*/rho*), u* - s = 0. It
predicts all 18 entries.

A threshold density is compared in three ways: predicted; observed with a small disturbance of the star state, which
is the situation of the theory; and observed with the Riemann data and the criterion of Table 1. Measured:

    condition  stable       predicted   disturbed   Riemann data
    (2.3)      below        7.628       7.63        4.0
    (2.4)      above        0.1912      0.191       0.21
    (2.5)      above        0.03637     0.0364      0.039
    (2.5)      below       37.46       37.46       21.6

Theory and small disturbances agree within the interval asked for. With Riemann data a light solid's slow decay counts
as instability until the run is long enough: on 400 cells 0.193 and 0.0366 come out. Heavy solids lose stability early
for another reason. From 4.0 to 7.6 and from 21.6 to 37.5 the star state is stable to small disturbances and not to
the start, a velocity jump of 1 in a gas of less than half the impedance (at which the theory has 3.06 and 13.6): the
oscillation that it sets off keeps itself up or ends in negative pressure. Table 1 has no entry there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from gks.solvers.coupled_riemann import CoupledRiemann, Solid, coupled_riemann, gas
from gks.solvers.coupling import AVERAGE, MIRROR, TRADITIONAL, WEIGHTED, Condition, coupling_scheme
from gks.solvers.euler_elastic import CFL, END, Cause, Coupled, Outcome, Profile, Run, march, profile
from gks.solvers.growth import Growth, Trace, observe
from gks.solvers.riemann import primitive

Array = NDArray[np.float64]

DENSITIES = (0.005, 0.04, 0.125, 2.0, 20.0, 50.0)

PRINTED: Mapping[Condition, tuple[bool, ...]] = {
    MIRROR: (True, True, True, True, False, False),
    TRADITIONAL: (False, False, False, True, True, True),
    AVERAGE: (False, True, True, True, True, False),
}
"""Table 1: whether (2.3), (2.4) and (2.5) are printed as stable at each density."""

EXTREMES = tuple(10.0**power for power in range(-10, 11, 2))
"""Densities at which (4.3) is said to be stable."""

BRACKETS = ((MIRROR, 2.0, 20.0), (TRADITIONAL, 0.125, 2.0), (AVERAGE, 0.005, 0.04), (AVERAGE, 20.0, 50.0))
"""Neighbouring entries of Table 1 that differ."""

PRINTED_24A = Condition("traditional, as printed", "(2.4a) with u_0^(f) in the solid's ghost", "1", "0", left_ghost="0")
PRINTED_43A = Condition(
    "weighted, as printed", "(4.3a) with the velocity weights printed", "e_L/(e_L + e_R)", "e_L/(e_L + e_R)"
)
"""(2.4a) and (4.3a) as they stand in the text; see `euler_elastic`."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of Table 1: what is printed (None for (4.3), which has no row) and how the run ended."""

    condition: Condition
    density: float
    printed: bool | None
    outcome: Outcome

    @property
    def agrees(self) -> bool:
        return self.printed is None or self.printed is self.outcome.stable


@dataclass(frozen=True, slots=True)
class Prediction:
    """The linear theory at the star state: its parameters, and the largest admissible modulus (None: no mode)."""

    lam: float
    alpha: float
    speed_ratio: float
    stable: bool
    modulus: float | None


@dataclass(frozen=True, slots=True)
class Threshold:
    """A density at which stability changes, as intervals: predicted, disturbed a little, and with Riemann data."""

    condition: Condition
    predicted: tuple[float, float]
    disturbed: tuple[float, float]
    observed: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Departure:
    """A reading of the text that was not taken, and how many of Table 1's 18 entries it gives (None: no matter)."""

    reading: str
    agreeing: int | None
    consequence: str


@dataclass(frozen=True, slots=True)
class RiemannFigure:
    """Figures 2, 10, 11: a numerical profile, and the exact (x, u, sigma) of either side."""

    run: Run
    profile: Profile
    exact_solid: tuple[Array, Array, Array]
    exact_gas: tuple[Array, Array, Array]


def table_1(end: float = END, conditions: Mapping[Condition, Sequence[bool]] = PRINTED) -> tuple[Entry, ...]:
    """All entries, row by row, marched as one batch."""
    cells = [
        (each, rho, stable) for each, row in conditions.items() for rho, stable in zip(DENSITIES, row, strict=True)
    ]
    outcomes = march([Run(condition, Solid(rho)) for condition, rho, _ in cells], end)
    return tuple(
        Entry(condition, rho, printed, outcome)
        for (condition, rho, printed), outcome in zip(cells, outcomes, strict=True)
    )


def weighted_entries(densities: Sequence[float] = (*DENSITIES, *EXTREMES), cfl: float = CFL) -> tuple[Entry, ...]:
    """(4.3) at the densities of Table 1 and at extreme ones."""
    outcomes = march([Run(WEIGHTED, Solid(rho)) for rho in densities], cfl=cfl)
    return tuple(Entry(WEIGHTED, rho, None, outcome) for rho, outcome in zip(densities, outcomes, strict=True))


def departures(table: Sequence[Entry] | None = None) -> tuple[Departure, ...]:
    """What the other readings of the text lead to, measured beside `table`, or beside `table_1()`.

    See `euler_elastic` for the readings taken.
    """
    table, early = table or table_1(), table_1(end=0.4)
    kept = tuple(entry for entry in table if entry.condition is not TRADITIONAL)
    literal = kept + table_1(conditions={PRINTED_24A: PRINTED[TRADITIONAL]})
    by_pressure = [(entry.outcome.cause is not Cause.NEGATIVE_PRESSURE) is entry.printed for entry in table]
    light = march([Run(PRINTED_43A, Solid(1e-6))])[0]
    exact = coupled_riemann(Solid(1e-6), gas()).velocity
    return (
        Departure("(2.4a) as printed", _agreeing(literal), "(2.4) is stable at the density 0.125"),
        Departure("final time 0.4", _agreeing(early), "(2.5) at the density 0.04 has not settled"),
        Departure("unstable by negative pressure alone", sum(by_pressure), "light solids saturate and pass for stable"),
        Departure(
            "(4.3a) as printed",
            None,
            f"stable, but at rho_s = 1e-6 the interface moves {light.interface_velocity / exact:.3g} times too fast",
        ),
    )


def _agreeing(entries: Sequence[Entry]) -> int:
    return sum(entry.agrees for entry in entries)


# The linear theory ----------------------------------------------------------------------------------------------------


def prediction(condition: Condition, density: float, cfl: float = CFL) -> Prediction:
    """Stability of the condition at the star state of the paper's Riemann problem."""
    from gks.modes import Verdict, analyse

    solution = coupled_riemann(Solid(density), gas())
    star, sound = solution.star_gas, float(solution.star_gas.sound_speed())
    solid = solution.solid
    lam = cfl * solid.speed / max(solid.speed, sound, _ahead(solution))
    alpha, ratio = float(star.density) / density, sound / solid.speed
    scheme = coupling_scheme(condition)
    result = analyse(scheme, scheme.values({"lam": lam, "alpha": alpha, "c": ratio}))
    admissible = [float(mode.modulus) for mode in result.modes if mode.kind.value != "inadmissible"]
    return Prediction(lam, alpha, ratio, result.verdict is Verdict.STABLE, max(admissible, default=None))


def _ahead(solution: CoupledRiemann) -> float:
    """abs(u - s) + c of the undisturbed gas, which limits dt while it is on the grid."""
    return abs(float(solution.fluid.velocity) - solution.velocity) + float(solution.fluid.sound_speed())


AMPLITUDE, LINEAR, ROUNDING = 1e-8, 1e-4, 1e-14
"""Disturbance of the star state, and the sizes at which it leaves the linear range or sinks into rounding errors."""


def disturbed_growth(
    condition: Condition, densities: Sequence[float], steps: int = 300, cells: int = 60
) -> list[Growth]:
    """Growth per step of a small disturbance next to the interface, from the star state of each density."""
    solutions = [coupled_riemann(Solid(density), gas()) for density in densities]
    runs = [
        Run(
            condition,
            Solid(each.solid.density, each.solid.speed, each.velocity, -each.pressure),
            each.star_gas,
            fastest=_ahead(each),
        )
        for each in solutions
    ]
    batch = Coupled(runs, cells)
    batch.velocity[:, -1] += AMPLITUDE  # of both: one alone may leave the mode out, as u does under (2.3)
    batch.stress[:, -1] *= 1 + AMPLITUDE
    base = np.array([[each.velocity, each.pressure] for each in solutions])
    seen = [_deviation(batch, base)]
    for _ in range(steps):
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            batch.step(np.inf)
        seen.append(_deviation(batch, base))
    return [_growth(np.array([values[row] for values in seen])) for row in range(len(runs))]


def _deviation(batch: Coupled, base: Array) -> Array:
    """Deviations from the star state beside the interface, (runs, 4): velocity and relative stress of solid and gas."""
    now = primitive(batch.fluid)
    u, p = base.T
    values = (
        batch.velocity[:, -1] - u,
        batch.stress[:, -1] / p + 1,
        now.velocity[:, 0] - u,
        now.pressure[:, 0] / p - 1,
    )
    return np.stack(values, axis=1)


def _growth(values: Array) -> Growth:
    sizes = np.abs(values).max(axis=1)
    outside = np.flatnonzero(~((sizes < LINEAR) & (sizes > ROUNDING)))
    stop = int(outside[0]) if len(outside) else len(sizes)
    return observe(Trace(values[:stop], np.zeros(stop, dtype=int)))


# Thresholds -----------------------------------------------------------------------------------------------------------


def threshold(condition: Condition, low: float, high: float) -> Threshold:
    """The density between low and high at which stability changes, in the three ways of the module's docstring."""

    def predicted(densities: Array) -> list[bool]:
        return [prediction(condition, float(rho)).stable for rho in densities]

    def disturbed(densities: Array) -> list[bool]:
        return [growth.rate < 1 for growth in disturbed_growth(condition, list(map(float, densities)))]

    def observed(densities: Array) -> list[bool]:
        return [outcome.stable for outcome in march([Run(condition, Solid(float(rho))) for rho in densities])]

    return Threshold(
        condition,
        section(predicted, low, high, 1, 1e-6),
        section(disturbed, low, high, 8, 1e-3),
        section(observed, low, high, 12, 2e-2),
    )


def thresholds() -> tuple[Threshold, ...]:
    """Wherever neighbouring entries of Table 1 differ."""
    return tuple(threshold(*bracket) for bracket in BRACKETS)


def section(
    stable: Callable[[Array], Sequence[bool]], low: float, high: float, points: int, width: float
) -> tuple[float, float]:
    """The interval in which `stable` changes, shrunk by so many points at a time until log(high/low) < width.

    ValueError if the ends do not differ. Of several changes the one nearest to `low` is followed.
    """
    at_low, at_high = stable(np.array([low, high]))
    if at_low is at_high:
        raise ValueError(f"stable at {low} and at {high} alike: {at_low}")
    while log(high / low) > width:
        inner = np.geomspace(low, high, points + 2)
        answers = [at_low, *stable(inner[1:-1]), not at_low]
        first = next(k for k, answer in enumerate(answers) if answer is not at_low)
        low, high = float(inner[first - 1]), float(inner[first])
    return low, high


# Figures --------------------------------------------------------------------------------------------------------------


def figure_2() -> RiemannFigure:
    """(2.4) with rho_s = 2, at t = 0.4."""
    return _figure(Run(TRADITIONAL, Solid(2.0)))


def figure_10() -> RiemannFigure:
    """(4.3) with rho_s = 0.001."""
    return _figure(Run(WEIGHTED, Solid(0.001)))


def figure_11() -> RiemannFigure:
    """(4.3) with rho_s = 1000."""
    return _figure(Run(WEIGHTED, Solid(1000.0)))


def _figure(run: Run, time: float = 0.4, points: int = 2001) -> RiemannFigure:
    solution = coupled_riemann(run.solid, run.fluid)
    solid = solution.solid_profile(np.linspace(-1.0, 0.0, points), time)
    x = solution.velocity * time + np.linspace(0.0, 1.0, points)
    state = solution.gas_profile(x, time)
    return RiemannFigure(run, profile(run, time), solid, (x, state.velocity, -state.pressure))
