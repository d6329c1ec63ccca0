"""Extremes: each case's verdict or lam_max beside the exact answer of `gks.reports.stress_cases`."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import log10
from time import perf_counter

from gks.bounds.curve import curve
from gks.errors import GksError
from gks.modes import ModesResult, analyse
from gks.reports.stress_cases import Case, cases
from gks.reports.tables import Cell, Table
from gks.scheme.model import Scheme
from gks.scheme.numbers import decimal_text
from gks.scheme.schemefile import parse_scheme
from gks.solvers.work_precision import machine

COLUMNS = ("case", "answer", "expected", "right", "digits", "seconds", "tier", "reason")
MOST_DIGITS = 17.0
"""What a double prints: an exact answer is given so many."""

RIGHT, UNDECIDED, WRONG = "yes", "undecided", "NO"


def measure(progress: Callable[[str], None]) -> Table:
    """All cases; a row is right, undecided with the reason, or wrong."""
    rows = []
    for case in cases():
        progress(case.name)
        rows.append(row(case))
    counts = {what: sum(each[3] == what for each in rows) for what in (RIGHT, UNDECIDED, WRONG)}
    slowest = max(rows, key=lambda each: float(each[5] or 0))
    notes = (
        f"{len(rows)} cases: {counts[RIGHT]} right, {counts[UNDECIDED]} undecided, {counts[WRONG]} wrong; "
        f"the longest took {slowest[5]:.3g} s",
        "digits: significant digits of the leading root, or of lam_max, that agree with the exact value",
        str(machine()),
    )
    return Table("Extremes: verdicts and bounds against exact formulas", COLUMNS, tuple(rows), notes)


def row(case: Case) -> tuple[Cell, ...]:
    """One row: what was answered, what is right, how many digits agree, how long it took, by which tier, and why."""
    scheme = parse_scheme(case.text, "stress")
    began = perf_counter()
    try:
        answered = _bound(scheme, case) if case.lam_max is not None else _verdict(scheme, case)
    except GksError as error:
        answered = ("refused", _expected(case), UNDECIDED, None, "", str(error))
    answer, expected, right, digits, tier, reason = answered
    return case.name, answer, expected, right, digits, perf_counter() - began, tier, reason


_Answer = tuple[Cell, Cell, str, float | None, str, str]


def _expected(case: Case) -> Cell:
    return case.verdict if case.lam_max is None else decimal_text(case.lam_max)


def _bound(scheme: Scheme, case: Case) -> _Answer:
    assert case.lam_max is not None
    (point,) = curve(scheme, case.values).points
    if not point.resolved or point.lam_max is None:
        return "undecided", _expected(case), UNDECIDED, None, "", point.because
    if point.lam_max == "oo":  # every case has a bound
        return "oo", _expected(case), WRONG, None, "", ""
    found = Fraction(str(point.lam_max))
    digits = agreeing(found, case.lam_max)
    # Within the stated bound, and a printed double's own rounding.
    within = abs(found - case.lam_max) <= case.lam_max * (Fraction(point.error_bound) + Fraction(1, 2**52))
    return decimal_text(found), _expected(case), RIGHT if within else WRONG, digits, "", ""


def _verdict(scheme: Scheme, case: Case) -> _Answer:
    result = analyse(scheme, case.values)
    name = result.verdict.value
    right = RIGHT if name == case.verdict else UNDECIDED if name == "undecided" else WRONG
    digits = None
    if case.z is not None and right == RIGHT:
        digits, whole = _leading(result, case)
        right = right if whole else WRONG
    return name, case.verdict, right, digits, result.tier, result.because if right != RIGHT else ""


def _leading(result: ModesResult, case: Case) -> tuple[float | None, bool]:
    """Digits of the expected root that the nearest mode has; and whether its multiplicity and its radius are right.

    A mode inside the circle need not be listed beyond the exact route, so that none is no fault there.
    """
    assert case.z is not None
    exact = case.z
    near = min(result.modes, key=lambda mode: abs(mode.z[0] - exact) + abs(mode.z[1]), default=None)
    if near is None:
        return None, abs(exact) < 1
    off = abs(near.z[0] - exact) + abs(near.z[1])
    enclosed = off <= 2 * near.radius + abs(exact) * Fraction(1, 2**52)
    return agreeing(exact + off, exact), enclosed and case.multiplicity in (None, near.multiplicity)


def agreeing(found: Fraction, exact: Fraction) -> float:
    """Significant digits in which two numbers agree: -log10 of the relative difference, at most MOST_DIGITS."""
    off = abs(found - exact) / abs(exact) if exact else abs(found)
    if off < Fraction(1, 10 ** int(MOST_DIGITS)):
        return MOST_DIGITS
    return max(0.0, -log10(off)) if off < 10**300 else 0.0
