"""The computations that reports are made of, each by name: plain data in, plain data out.

A step is a function of a scheme and of arguments that JSON can hold; so is what it gives. That is why a step can run in
any process, be kept for the next run, and be run again by whoever doubts a number.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from importlib import import_module
from typing import TYPE_CHECKING, Any

from gks.errors import NotAnalysable
from gks.scheme.model import Scheme

if TYPE_CHECKING:
    from gks.solvers.march import History

Result = dict[str, Any]

Source = tuple[str, str, str | None]
"""A scheme as its text, its name and its path."""

LIMIT = 60.0
"""Seconds that a step may take before the report goes on without it."""


@dataclass(frozen=True, slots=True)
class Step:
    """One computation of a report.

    name       what the report's record calls it
    kind       the function that does it: `module.function` under gks.reports, or under gks.reports.steps
    arguments  what it is given, as JSON
    source     the scheme, where it is about one
    command    what a user types for the same, "" where no command gives it
    limit      seconds it may take
    """

    name: str
    kind: str
    arguments: Mapping[str, Any]
    source: Source | None = None
    command: str = ""
    limit: float = LIMIT


def carry_out(kind: str, arguments: Mapping[str, Any], source: Source | None) -> Result:
    """Run a step here and now; raises what the analysis raises."""
    module, _, function = kind.rpartition(".")
    job: Callable[..., Result] = getattr(import_module(f"gks.reports.{module}"), function)
    if source is None:
        return job(**arguments)
    from gks.scheme.schemefile import parse_scheme

    return job(parse_scheme(*source), **arguments)


Values = Mapping[str, str]
"""Parameter values as text, exact."""


def _exact(scheme: Scheme, values: Values) -> dict[str, Fraction]:
    return scheme.values(dict(values))


def _untimed(result: Mapping[str, Any]) -> Result:
    """Without the time it took, which the record has once for every step."""
    return {key: value for key, value in result.items() if key != "time_s"}


def derive(scheme: Scheme) -> Result:
    """The object of gks.derive/1."""
    from gks.modes.derivation import derive as derivation

    return _untimed(derivation(scheme, {}).to_json())


def modes(scheme: Scheme, values: Values) -> Result:
    """The object of gks.modes/1."""
    from gks.modes import analyse

    return _untimed(analyse(scheme, _exact(scheme, values)).to_json())


def curve(scheme: Scheme, values: Values, sweep: str | None) -> Result:
    """The object of gks.curve/1; `because` stands with the points that are undecided."""
    from gks.bounds.curve import curve as found
    from gks.bounds.sweep import parse_sweep

    result = found(scheme, _exact(scheme, values), parse_sweep(sweep) if sweep else None)
    data = _untimed(result.to_json())
    for point, shown in zip(result.points, data["points"], strict=True):
        shown["stable_set"] = [list(span) for span in point.stable_set]
        if not point.resolved:
            shown["because"] = point.because
    return data


def profile(scheme: Scheme, values: Values) -> Result:
    """The object of gks.profile/1 for the admissible mode of largest modulus; {"index": None} where there is none."""
    from gks.modes import ModeKind, analyse
    from gks.modes.profile import profile as shape_of

    result = analyse(scheme, _exact(scheme, values))
    admissible = [k for k, mode in enumerate(result.modes) if mode.kind is not ModeKind.INADMISSIBLE]
    if not admissible:
        return {"index": None}
    worst = max(admissible, key=lambda k: result.modes[k].modulus)
    return _untimed(shape_of(result, worst).to_json())


def roots(scheme: Scheme, values: Values, sweep: str) -> Result:
    """The object of gks.roots/1."""
    from gks.bounds.rootmap import rootmap
    from gks.bounds.sweep import parse_sweep

    over = parse_sweep(sweep)
    return _untimed(rootmap(scheme, scheme.values(dict(values), [over.name]), over).to_json())


GRID, COARSE, ALONG = (61, 50), (9, 8), 121
"""Points of a map over (parameter, lam): where they cost nothing each, and where each is analysed by itself; points of
a line over lam alone."""
HEADROOM = 1.25
"""How far beyond the largest stable lam a map reaches."""


def radius(scheme: Scheme, values: Values, sweep: str | None) -> Result:
    """The largest modulus of an admissible mode over the parameter that runs, if one does, and over lam."""
    from gks.bounds.cfl import stable_set
    from gks.bounds.radius import radius_map
    from gks.bounds.sweep import parse_sweep

    exact = _exact(scheme, values)
    end = stable_set(scheme, exact).lam_max
    limit = Fraction(0) if end is None else Fraction(float(end.ball(64).real.mid()))
    top = Fraction(HEADROOM) * max(exact[scheme.cfl], limit)

    def dense(done: int, total: int) -> None:
        raise NotAnalysable(f"each of {total} points by itself")

    for points in (GRID, COARSE):
        count = points[1] if sweep else ALONG if points is GRID else 4 * COARSE[1]
        lams = [top * (k + 1) / count for k in range(count)]
        over = parse_sweep(_thinned(sweep, points[0])) if sweep else None
        try:
            found = radius_map(scheme, exact, over, lams, dense if points is GRID else None)
        except NotAnalysable:
            if points is COARSE:
                raise
            continue
        return {
            "sweep": _thinned(sweep, points[0]) if sweep else None,
            "values": found.values.tolist(),
            "lams": found.lams.tolist(),
            "radius": found.radius.tolist(),
            "known": found.known.tolist(),
            "interior": found.interior.tolist(),
        }
    raise AssertionError("one of the two grids gives a map or raises")


def _thinned(sweep: str, points: int) -> str:
    name, low, high, _, *scale = sweep.replace("=", ":", 1).split(":")
    return f"{name}={':'.join([low, high, str(points), *scale])}"


def theorem(scheme: Scheme, values: Values, limit: float) -> Result:
    """The object of gks.theorem/1, with the reserve of each piece's verdict, and what the checker says of it."""
    from gks.bounds.check import check
    from gks.bounds.proof import prove

    free = [p.name for p in scheme.parameters if p.name not in values]
    proved = prove(scheme, scheme.values(dict(values), free), limit)
    data = _untimed(proved.to_json())
    for piece, shown in zip(proved.pieces, data["pieces"], strict=True):
        shown["reserve"] = piece.reserve if piece.at_bound else ""
    if proved.proved:
        verdict = check(dict(proved.certificate))
        data["checked"] = {"accepted": verdict.accepted, "problem": verdict.problem}
    if data.get("curve"):
        data["curve"] = _untimed(data["curve"])
    return data


def audit(scheme: Scheme) -> Result:
    """The object of gks.audit/1."""
    from gks.bounds.audit import audit as held
    from gks.solvers.march import march

    data = _untimed(held(scheme, march).to_json())
    for claim in data["claims"]:
        if "march" in claim["evidence"]:
            claim["evidence"] = {**claim["evidence"], "march": _untimed(claim["evidence"]["march"])}
    return data


MOST_STEPS = 2000
"""Steps of a history that a record keeps; longer ones are thinned evenly."""


def march(scheme: Scheme, values: Values) -> Result:
    """The object of gks.march/1, with the history of every march behind it, the observed one first."""
    from gks.solvers.march import march as marched

    result = marched(scheme, _exact(scheme, values))
    return {
        **_untimed(result.to_json()),
        "method": result.method,
        "remark": result.remark,
        "cells": list(result.cells),
        "steps": result.steps,
        "histories": [_history(each) for each in result.histories],
    }


def _history(history: History) -> Result:
    logs = history.log_sizes
    stride = max(1, -(-len(logs) // MOST_STEPS))
    chosen = range(0, len(logs), stride)
    return {
        "name": history.name,
        "rate": history.growth.rate,
        "steps": list(chosen),
        "log10_size": [_finite(logs[n] / LN10) for n in chosen],
    }


LN10 = 2.302585092994046


def _finite(value: float) -> float | None:
    """The number, None for the logarithm of zero."""
    return value if abs(value) < float("inf") else None
