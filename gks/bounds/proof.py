"""``prove``: the exact stable region of a scheme over one parameter, as a theorem.

The work is done in a process of its own: FLINT cannot be interrupted from within, so only ending the process honours
a time limit, or Ctrl-C, at once. What is not proved says at which stage it stopped, and carries a certified curve
instead. This process imports nothing that analyses: the other one does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from time import perf_counter

from gks.bounds import subprocessing
from gks.bounds.theorem import Theorem
from gks.scheme.model import Parameter, Scheme

Report = Callable[[str], None]

CURVE_SHARE = 0.25
"""The share of a time limit that is kept for the curve of what is not proved."""


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
        from gks.bounds.substitute import certified_curve

        theorem = replace(theorem, curve=certified_curve(scheme, values, left))
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
    free = free_parameters(scheme, values)
    name = free[0].name if len(free) == 1 else None
    return not_proved(scheme, name, f"the time limit was reached, at the stage: {stage}", start)


def _prove_job(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Theorem:
    from gks.bounds.proving import checked_region

    return checked_region(scheme, values, report).theorem


def free_parameters(scheme: Scheme, values: Mapping[str, Fraction]) -> list[Parameter]:
    """The ranged parameters that have no value."""
    return [p for p in scheme.parameters if p.ranged and p.role is None and p.name not in values]


def not_proved(scheme: Scheme, parameter: str | None, reason: str, start: float) -> Theorem:
    """That nothing is proved, and why."""
    return Theorem(scheme, parameter, (), (), {}, reason, None, perf_counter() - start)
