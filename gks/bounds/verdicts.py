"""The verdict at one set of values, within a time limit and, if asked for, proved."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from time import perf_counter
from typing import cast

from gks.bounds.timelimit import OverTime, limited
from gks.modes.analysis import analyse
from gks.modes.verdict import ModesResult, Verdict
from gks.scheme.model import Scheme


def verdict_within(
    scheme: Scheme, values: Mapping[str, Fraction], *, limit: float | None = None, certify: bool = False
) -> ModesResult:
    """As `analyse`; undecided where it takes over ``limit`` seconds, with ``certify`` also where it is not proved."""
    start = perf_counter()
    if limit is None:
        found = analyse(scheme, values)
    else:
        try:
            (message,) = limited(report_modes, (scheme, dict(values)), limit)
        except OverTime as late:
            return _undecided(scheme, values, str(late), perf_counter() - start)
        found = replace(cast(ModesResult, message), scheme=scheme)
    if certify and not found.certified and found.verdict is not Verdict.UNDECIDED:
        because = f"{found.verdict.value} by numbers that are not proved: {found.because}"
        return replace(found, verdict=Verdict.UNDECIDED, reason=found.reason or "closure", because=because)
    return found


def report_modes(scheme: Scheme, values: Mapping[str, Fraction], report: Callable[[object], None]) -> None:
    """Reports the result of `analyse`."""
    report(analyse(scheme, values))


def _undecided(scheme: Scheme, values: Mapping[str, Fraction], because: str, seconds: float) -> ModesResult:
    """Nothing is known but why."""
    at = dict(values)
    return ModesResult(scheme, at, Verdict.UNDECIDED, "closure", None, False, "exact", (), True, because, seconds)
