"""The paper's experiments as steps of its report: each gives what its figure, table or number shows, as plain data."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite, log10
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from gks.solvers.table1 import Entry, RiemannFigure
    from gks.solvers.wave_figures import Line

    Array = NDArray[np.float64]

Data = dict[str, Any]


def _plain(values: Array) -> list[float | None]:
    """Doubles as JSON has them; what is not finite is left out."""
    return [value if isfinite(value) else None for value in values.tolist()]


def riemann(figure: int) -> Data:
    """Figure 2, 10 or 11: (x, u, sigma) of solid and gas, numerical and exact."""
    from gks.solvers import table1

    draws: dict[int, Callable[[], RiemannFigure]] = {
        2: table1.figure_2, 10: table1.figure_10, 11: table1.figure_11,
    }  # fmt: skip
    found = draws[figure]()
    # The exact solution on a tenth of its points: it is piecewise smooth, and the marks are a hundred a side.
    exact = [tuple(column[::10] for column in side) for side in (found.exact_solid, found.exact_gas)]
    sides = (found.profile.solid, found.profile.gas, *exact)
    names = ("solid", "gas", "exact_solid", "exact_gas")
    return {
        "density": found.run.solid.density,
        "time": found.profile.time,
        **{
            name: {key: _plain(column) for key, column in zip(("x", "velocity", "stress"), side, strict=True)}
            for name, side in zip(names, sides, strict=True)
        },
    }


def table_1() -> Data:
    """Table 1: each entry as printed and as it came out, and the same for (4.3), which the text says is stable."""
    from gks.solvers import table1

    return {
        "entries": [_entry(entry) for entry in table1.table_1()],
        "weighted": [_entry(entry) for entry in table1.weighted_entries()],
    }


def _entry(entry: Entry) -> Data:
    from gks.solvers.table1 import prediction

    theory = prediction(entry.condition, entry.density)
    return {
        "condition": entry.condition.name,
        "source": entry.condition.source,
        "density": entry.density,
        "printed": entry.printed,
        "stable": entry.outcome.stable,
        "cause": entry.outcome.cause.value,
        "time": entry.outcome.time,
        "steps": entry.outcome.steps,
        "jump": entry.outcome.jump if isfinite(entry.outcome.jump) else None,
        "predicted_stable": theory.stable,
        "predicted_modulus": theory.modulus,
        "agrees": entry.agrees,
    }


def readings() -> Data:
    """What other readings of Section 2's text lead to."""
    from gks.solvers.table1 import departures

    return {
        "readings": [
            {"reading": each.reading, "agreeing": each.agreeing, "consequence": each.consequence}
            for each in departures()
        ]
    }


def exact_waves() -> Data:
    """Figure 4: the exact velocity and stress at three times."""
    from gks.solvers.wave_figures import figure_4

    found = figure_4(401)
    return {
        "alpha": found.alpha,
        "times": list(found.times),
        "x": _plain(found.x),
        "velocity": [_plain(each) for each in found.velocity],
        "stress": [_plain(each) for each in found.stress],
    }


def errors(figure: str) -> Data:
    """Figures 5 to 8 ("5", "6", "7", "8-traditional", "8-weighted", and "7-traditional", of which the text tells)."""
    from gks.solvers import wave_figures as figures
    from gks.solvers.coupling import TRADITIONAL, WEIGHTED

    draws: dict[str, Callable[[], tuple[Line, ...]]] = {
        "5": figures.figure_5,
        "6": figures.figure_6,
        "7": figures.figure_7,
        "7-traditional": lambda: figures.figure_7(TRADITIONAL),
        "8-traditional": figures.figure_8,
        "8-weighted": lambda: figures.figure_8(WEIGHTED),
    }
    return {"lines": [_line(line) for line in draws[figure]()]}


def _line(line: Line) -> Data:
    history = line.history
    return {
        "alpha": line.alpha,
        "cells": history.setting.cells,
        "predicted": line.predicted,
        "root": line.root,
        "observed": line.growth.rate,
        "uncertainty": line.growth.uncertainty if isfinite(line.growth.uncertainty) else None,
        "printed": line.printed,
        "dt": history.setting.dt,
        "times": _plain(history.times),
        "velocity_error": _plain(history.velocity_error),
        "stress_error": _plain(history.stress_error),
    }


def convergence(condition: str) -> Data:
    """Figure 9, for the "traditional" or the "weighted" condition: histories, errors at t = 0.5 and their rates."""
    from gks.solvers.coupling import CONDITIONS
    from gks.solvers.wave_figures import figure_9

    found = figure_9(CONDITIONS[condition])
    return {
        "lines": [_line(line) for line in found.lines],
        "dx": _plain(found.dx),
        "errors": _plain(found.errors),
        "rates": _plain(found.rates),
    }


def left_at_the_end() -> Data:
    """The weighted fully second-order scheme marched to t = 5: what is left of the error."""
    from gks.solvers.coupling import WEIGHTED
    from gks.solvers.wave_figures import END, line

    found = line(WEIGHTED, 0.25, 2, "fromm", 50, END)
    error = float(found.history.velocity_error[-1])
    return {"velocity_error": error, "log10": log10(error), "time": float(found.history.times[-1])}


def neutral_ratios() -> Data:
    """alpha at which the traditional conditions are neutral at lam = 9/10; lam_max at alpha = 1; where the full range
    of the second-order one ends, and the inverse of that, where its mirror image's does."""
    from fractions import Fraction

    from gks.bounds.cfl import stable_set
    from gks.catalogue import find
    from gks.modes import Verdict
    from gks.modes.analysis import quick_verdict
    from gks.modes.numerals import exact_fraction

    def passed(name: str, lam: Fraction, low: Fraction, high: Fraction) -> float:
        """alpha at which lam ceases to be stable, to 1e-14 of an interval of length 1."""
        scheme, ends = find(name), [low, high]
        for _ in range(48):
            middle = (ends[0] + ends[1]) / 2
            verdict = quick_verdict(scheme, scheme.values({"lam": lam, "alpha": middle}))
            ends[verdict is not Verdict.STABLE] = middle
        return float((ends[0] + ends[1]) / 2)

    at, one = Fraction(9, 10), Fraction(1)
    full = passed("traditional-2", one, Fraction(1, 10), one)
    scheme = find("traditional-2")
    top = stable_set(scheme, scheme.values({"alpha": one})).lam_max
    if top is None:
        raise ArithmeticError("traditional-2 has no largest lam at alpha = 1")
    return {
        "neutral": {
            "traditional-1": passed("traditional-1", at, Fraction(3), Fraction(4)),
            "traditional-2": passed("traditional-2", at, Fraction(1, 10), one),
        },
        "lam_max_at_1": float(exact_fraction(top.ball(120).real)),
        "full_range": full,
        "full_range_mirrored": 1 / full,
    }


def thresholds(conditions: Sequence[Sequence[Any]]) -> Data:
    """Densities at which the nonlinear problem changes: predicted, disturbed a little, and with Riemann data."""
    from gks.solvers.coupling import CONDITIONS
    from gks.solvers.table1 import threshold

    rows = []
    for name, low, high in conditions:
        found = threshold(CONDITIONS[name], low, high)
        rows.append(
            {
                "condition": name,
                "between": [low, high],
                "predicted": list(found.predicted),
                "disturbed": list(found.disturbed),
                "observed": list(found.observed),
            }
        )
    return {"thresholds": rows}


def work_precision() -> Data:
    """The object of gks.table/1 for error against run time."""
    from gks.reports.bench_precision import measure

    return dict(measure(lambda said: None).to_json())
