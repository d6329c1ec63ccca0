"""The experiments of Section 4 of Banks & Sjögreen as data: Figures 4 to 9, each line with its predicted growth.

alpha = kappa_R/kappa_L = rho_R/rho_L. The text prints its inverse throughout, but its own first-order determinant has
the roots r = 1/2 +- (i/2) sqrt(kappa_R/kappa_L), and only alpha = the number printed gives the growth that the text
and its figures report: at a ratio of 0.25 under the fully second order scheme the inverse, alpha = 4, ends at 1e12 on
the coarsest grid, where Figure 9 has a converging error. So each ratio printed as rho_L/rho_R is taken here as alpha.

What else differs from print: Section 4 gives Figure 8's moduli in the wrong order (the unstable line has 1.0104), and
the traditional condition at the ratio 1e10 passes 1e8 at step 3 in stress (8.8e8) and step 4 in velocity (2.3e8), not
at step 2, where they are 3.6 and 0.11 (rho_L = 1, c = sqrt(3)). The growth is lam sqrt(alpha)/2 = 4.5e4 a step, but it
starts from the little that the pulse has at the interface. The second-order condition, Fromm's interior, rho_R = 1 in
place of rho_L, a pulse at +1/2: none passes 1e8 before step 3 in stress or step 4 in velocity. A pulse on the interface
itself has 1e10 in stress at step 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from gks.solvers.acoustics import History, Setting, march
from gks.solvers.coupling import TRADITIONAL, WEIGHTED, Condition, coupling_scheme
from gks.solvers.growth import Growth, envelope
from gks.solvers.waves import Interface

Array = NDArray[np.float64]

CFL = 0.9
END = 5.0
"""Figures 5 to 8 run until long after the pulses have left."""

NEUTRAL_FIRST = 4 / CFL - 1
"""alpha at which the traditional first-order condition is neutral: 4 dx/(c dt) - 1."""

NEUTRAL_SECOND = 0.1876
"""The same at second order, as printed; the text moves 0.01 to either side of both."""

RESOLUTIONS = (50, 100, 200, 400, 800)
CONVERGENCE_END = 0.5

SETTLED = 1.5
"""The pulse has crossed 2 lengths at 2/c = 1.15; by this time nothing but the interface's own modes is left."""


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a figure.

    predicted : modulus of the largest admissible mode, None where there is none; growth : observed in the velocity
    error. root : modulus of the largest root of the characteristic polynomial, admissible or not: the paper's black
    lines. A root
        whose mode grows away from the interface is no mode of the half-line, but a grid of finite length holds it, and
        decays as it does once all waves have left. None for wide stencils, whose polynomial has foreign roots as well.
    printed : what the text prints for the modulus, None where nothing.
    """

    history: History
    predicted: float | None
    root: float | None
    growth: Growth
    printed: float | None

    @property
    def alpha(self) -> float:
        return self.history.setting.interface.right.density


@dataclass(frozen=True, slots=True)
class Profiles:
    """Figure 4: u and sigma over x at a few times; shapes (times, points)."""

    alpha: float
    times: tuple[float, ...]
    x: Array
    velocity: Array
    stress: Array


@dataclass(frozen=True, slots=True)
class Convergence:
    """Figure 9: histories by resolution, the largest velocity error at t = 0.5, and the rate over each doubling."""

    lines: tuple[Line, ...]
    dx: Array
    errors: Array

    @property
    def rates(self) -> Array:
        return np.log2(self.errors[:-1] / self.errors[1:])


def figure_4(points: int = 801) -> Profiles:
    """The exact solution at the neutral ratio, at t = 0, 0.375 and 0.75."""
    interface = Interface.of_ratio(NEUTRAL_FIRST)
    x, times = np.linspace(-1.0, 1.0, points), (0.0, 0.375, 0.75)
    solutions = [interface.exact(x, t) for t in times]
    velocity, stress = (np.stack(column) for column in zip(*solutions, strict=True))
    return Profiles(NEUTRAL_FIRST, times, x, velocity, stress)


def figure_5() -> tuple[Line, ...]:
    """Traditional condition, first order, on either side of neutral: blue (unstable), red (stable)."""
    ratios = ((NEUTRAL_FIRST + 0.01, 1.001012), (NEUTRAL_FIRST - 0.01, 0.9989870))
    return tuple(line(TRADITIONAL, alpha, printed=printed) for alpha, printed in ratios)


def figure_6() -> tuple[Line, ...]:
    """Impedance-weighted condition at the same two ratios."""
    return tuple(line(WEIGHTED, alpha) for alpha in (NEUTRAL_FIRST + 0.01, NEUTRAL_FIRST - 0.01))


def figure_7(condition: Condition = WEIGHTED) -> tuple[Line, ...]:
    """Ratios 1e10 and 1e-10: the weighted condition as drawn, or the traditional one as told in the text."""
    return tuple(line(condition, alpha) for alpha in (1e10, 1e-10))


def figure_8(condition: Condition = TRADITIONAL) -> tuple[Line, ...]:
    """Second-order conditions, first-order interior: traditional (left) or weighted (right); blue, red."""
    known = condition is TRADITIONAL
    ratios = ((NEUTRAL_SECOND + 0.01, 0.9893), (NEUTRAL_SECOND - 0.01, 1.0104))
    return tuple(line(condition, alpha, 2, printed=printed if known else None) for alpha, printed in ratios)


def figure_9(condition: Condition, interior: str = "fromm", resolutions: tuple[int, ...] = RESOLUTIONS) -> Convergence:
    """The fully second-order scheme at alpha = 0.25 over five resolutions; see `acoustics` on the interior scheme."""
    lines = tuple(line(condition, 0.25, 2, interior, cells, CONVERGENCE_END) for cells in resolutions)
    errors = np.array([each.history.velocity_error[-1] for each in lines])
    return Convergence(lines, 1.0 / np.array(resolutions, dtype=float), errors)


def line(
    condition: Condition,
    alpha: float,
    order: int = 1,
    interior: str = "upwind1",
    cells: int = 50,
    end: float = END,
    printed: float | None = None,
) -> Line:
    """March one setting of Section 4 and put prediction and observation side by side."""
    history = march(Setting(Interface.of_ratio(alpha), condition, order, interior, CFL, cells), end)
    admissible, largest = predicted_moduli(condition, alpha, order, interior)
    root = largest if interior == "upwind1" else None
    return Line(history, admissible, root, observed_growth(history), printed)


@cache
def predicted_moduli(
    condition: Condition, alpha: float, order: int = 1, interior: str = "upwind1", cfl: float = CFL
) -> tuple[float | None, float | None]:
    """(largest modulus of an admissible mode, largest of all roots) at equal speeds; None where there is none."""
    from gks.modes import analyse

    scheme = coupling_scheme(condition, order, interior)
    modes = analyse(scheme, scheme.values({"lam": cfl, "alpha": alpha})).modes
    admissible = [float(mode.modulus) for mode in modes if mode.kind.value != "inadmissible"]
    return max(admissible, default=None), max((float(mode.modulus) for mode in modes), default=None)


def observed_growth(history: History) -> Growth:
    """Growth per step of the velocity error: after SETTLED, or over the last half where the march ends before."""
    steps = len(history.times)
    settled = int(np.searchsorted(history.times, SETTLED))
    start = settled if settled < steps - 16 else max(steps // 2, 1)
    with np.errstate(divide="ignore"):
        logs = np.log(history.velocity_error[start:])
    return envelope(logs, start)
