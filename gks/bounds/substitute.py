"""What a theorem that is not proved carries instead: exact stable sets at points of its parameter."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from time import perf_counter

from gks.bounds import subprocessing
from gks.bounds.curve import Curve, curve
from gks.bounds.point import CurvePoint
from gks.bounds.proof import free_parameters
from gks.bounds.sweep import of_values
from gks.errors import InputError
from gks.scheme.model import Parameter, Scheme

CURVE_POINTS = 33


def certified_curve(scheme: Scheme, values: Mapping[str, Fraction], limit: float | None) -> Curve | None:
    """Exact stable sets at points of the first free parameter, as many as the time allows; None if there are none."""
    start = perf_counter()
    free = free_parameters(scheme, values)
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
