"""``prove``: the exact stable region of a scheme over one parameter, as a theorem.

The work is done in a process of its own: FLINT cannot be interrupted from within, so only ending the process honours
a time limit, or Ctrl-C, at once. What is not proved says at which stage it stopped, and carries a certified curve
instead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from time import perf_counter

from gks.bounds import subprocessing
from gks.bounds.cells import decompose
from gks.bounds.certificate import certificate, constant_certificate
from gks.bounds.cfl import stable_set
from gks.bounds.check import check
from gks.bounds.curve import Curve, curve
from gks.bounds.pieces import constant_piece, limits, pieces
from gks.bounds.point import CurvePoint
from gks.bounds.pointverdict import NotProved, verdict_at
from gks.bounds.region import Decomposition
from gks.bounds.sweep import of_values
from gks.bounds.theorem import Theorem
from gks.errors import InputError, NotAnalysable
from gks.modes.fibre import VanishesIdentically
from gks.modes.undecided import Undecided
from gks.scheme.model import Parameter, Scheme

Report = Callable[[str], None]

CURVE_SHARE = 0.25
"""The share of a time limit that is kept for the curve of what is not proved."""

CURVE_POINTS = 33


def prove(
    scheme: Scheme,
    values: Mapping[str, Fraction],
    limit: float | None = None,
    progress: Report | None = None,
) -> Theorem:
    """The theorem over the ranged parameter that ``values`` leaves free; other parameters take their defaults.

    ``limit`` is in seconds; ``progress`` is told the stages. Raises InputError where the input is at fault; what
    cannot be proved comes back as a theorem whose status says so.
    """
    start = perf_counter()
    share = None if limit is None else limit * (1 - CURVE_SHARE)
    theorem = _proved(scheme, values, share, progress, start)
    if not theorem.proved:
        left = None if limit is None else limit - (perf_counter() - start)
        theorem = replace(theorem, curve=_certified_curve(scheme, values, left))
    return replace(theorem, time_s=perf_counter() - start)


def _proved(
    scheme: Scheme, values: Mapping[str, Fraction], limit: float | None, progress: Report | None, start: float
) -> Theorem:
    stage = "start"
    for message in subprocessing.messages(_prove_job, (scheme, dict(values)), limit):
        if isinstance(message, Theorem):
            return message
        stage = str(message)
        if progress is not None:
            progress(stage)
    free = _free(scheme, values)
    name = free[0].name if len(free) == 1 else None
    return _open(scheme, name, f"the time limit was reached, at the stage: {stage}", start)


def _prove_job(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Theorem:
    return checked_region(scheme, values, report).theorem


def checked_region(scheme: Scheme, values: Mapping[str, Fraction], report: Report = lambda stage: None) -> Region:
    """A theorem is said to be proved only with a certificate that the independent checker accepts."""
    start = perf_counter()
    found = _region(scheme, values, report)
    theorem = found.theorem
    if not theorem.proved:
        return found
    report("check of the certificate")
    problem = check(theorem.certificate).problem
    if problem is None:
        return replace(found, theorem=replace(theorem, time_s=perf_counter() - start))
    reason = f"the certificate is not accepted by the check: {problem}"
    return Region(_open(scheme, theorem.parameter, reason, start), None)


def prove_here(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Theorem:
    """``prove`` in this process: without a limit, a check, or a curve where nothing is proved."""
    return _region(scheme, values, report).theorem


@dataclass(frozen=True, slots=True)
class Region:
    """A theorem with the cells it was read off: None where it has no parameter, or is not proved."""

    theorem: Theorem
    cells: Decomposition | None

    def to_json(self) -> Mapping[str, object]:
        return self.theorem.to_json()


def _region(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Region:
    start = perf_counter()
    free = _free(scheme, values)
    if len(free) > 1:
        names = ", ".join(p.name for p in free)
        reason = f"{len(free)} parameters are free ({names}) and a theorem has one; set the others"
        return Region(_open(scheme, None, reason, start), None)
    fixed = scheme.values(values, free=[p.name for p in free])
    name = free[0].name if free else None
    try:
        found = _over_parameter(scheme, fixed, free[0], report) if free else Region(_constant(scheme, fixed), None)
    except (NotProved, Undecided) as why:
        return Region(_open(scheme, name, str(why), start), None)
    except NotAnalysable as why:
        return Region(_open(scheme, name, why.message, start), None)
    except VanishesIdentically:
        return Region(_open(scheme, name, "a boundary polynomial vanishes identically", start), None)
    return replace(found, theorem=replace(found.theorem, time_s=perf_counter() - start))


def _free(scheme: Scheme, values: Mapping[str, Fraction]) -> list[Parameter]:
    return [p for p in scheme.parameters if p.ranged and p.role is None and p.name not in values]


def _open(scheme: Scheme, parameter: str | None, reason: str, start: float) -> Theorem:
    return Theorem(scheme, parameter, (), (), {}, reason, None, perf_counter() - start)


def _over_parameter(scheme: Scheme, fixed: Mapping[str, Fraction], parameter: Parameter, report: Report) -> Region:
    """Over the parameter's range, open and exact."""
    low, high = parameter.low, parameter.high
    found = decompose(scheme, fixed, parameter.name, low, high, report)
    report("formulas")
    words = found, parameter.name, scheme.cfl, low, high
    stated = pieces(*words), limits(*words)
    theorem = Theorem(scheme, parameter.name, *stated, {}, None, None, 0.0, _others(scheme, fixed))
    return Region(replace(theorem, certificate=certificate(theorem, found, fixed, low, high)), found)


def _others(scheme: Scheme, fixed: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """The values of all parameters but lam."""
    return {name: value for name, value in fixed.items() if name != scheme.cfl}


def _constant(scheme: Scheme, fixed: Mapping[str, Fraction]) -> Theorem:
    """The exact stable set in lam."""
    found = stable_set(scheme, fixed)
    if found.undecided is not None:
        raise NotProved(found.undecided)
    top = found.lam_max
    at_bound = None if top is None or top.is_zero else verdict_at(scheme, {**fixed, scheme.cfl: top})
    piece = constant_piece(found, at_bound, scheme.cfl)
    theorem = Theorem(scheme, None, (piece,), (), {}, None, None, 0.0, _others(scheme, fixed))
    return replace(theorem, certificate=constant_certificate(theorem, found, fixed))


# Instead of a proof -------------------------------------------------------------------------------------------------


def _certified_curve(scheme: Scheme, values: Mapping[str, Fraction], limit: float | None) -> Curve | None:
    """Exact stable sets at points of the first free parameter, as many as the time allows; None if there are none."""
    start = perf_counter()
    free = _free(scheme, values)
    if not free or (limit is not None and limit <= 0):
        return None
    fixed = scheme.values(values, free=[free[0].name])
    places = _places(free[0])
    found: list[CurvePoint] = []
    try:
        for message in subprocessing.messages(_curve_job, (scheme, fixed, free[0].name, places), limit):
            if isinstance(message, CurvePoint):
                found.append(message)
    except InputError:
        return None
    if not found:
        return None
    return Curve(scheme, fixed, of_values(free[0].name, places[: len(found)]), found, perf_counter() - start)


def _curve_job(
    scheme: Scheme, fixed: Mapping[str, Fraction], name: str, places: list[Fraction], report: Callable[[object], None]
) -> None:
    for place in places:
        report(curve(scheme, {**fixed, name: place}, of_values(name, [place])).points[0])


def _places(parameter: Parameter) -> list[Fraction]:
    return list(_spread(parameter.low, parameter.high))


def _spread(low: Fraction | None, high: Fraction | None) -> Iterator[Fraction]:
    """Points inside a range: by equal factors where positive, else by equal steps; infinite ends come in to 1e4."""
    if low is not None and low >= 0 and (high is None or low == 0 or high / low > 100):
        top = high if high is not None else max(Fraction(10**4), 10**8 * low)
        bottom = low or top / 10**8
        decades = [Fraction(10.0 ** (k / 4)).limit_denominator(10**6) for k in range(CURVE_POINTS)]
        yield from (bottom * d for d in decades if bottom < bottom * d < top)
        return
    first = low if low is not None else (high or Fraction(0)) - 10
    last = high if high is not None else first + 20
    yield from (first + (last - first) * Fraction(k, CURVE_POINTS + 1) for k in range(1, CURVE_POINTS + 1))
