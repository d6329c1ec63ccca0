"""Claimed bounds: stability for 0 < lam < bound, and loss of it just above, at every value the claim is made for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from gks.bounds.cfl import StableSet, stable_set
from gks.bounds.claimvalue import both_sides, compare, number_of, printed_decimal, rounds_to, value_of
from gks.bounds.finding import Counterexample, Finding, Status, Values, exact_text, undecided, witness
from gks.bounds.samples import open_parameters, samples
from gks.errors import NotAnalysable, ParameterError, SchemeError
from gks.modes.algebraic import Root
from gks.modes.analysis import analyse
from gks.modes.numerals import text_real
from gks.modes.unimodular import simplest_between
from gks.modes.verdict import Verdict
from gks.scheme.expression import Expr
from gks.scheme.model import Claim, Scheme
from gks.scheme.numbers import fraction_text

SHOWN = 5
"""Parameter values at which a failing claim's numbers are listed."""

CLEAR = Fraction(5, 4)
"""A ratio between claim and derivation that a march or a reader sees at once."""


@dataclass(frozen=True, slots=True)
class _Held:
    """A claimed bound at one set of values: sign of claim - lam_max, or why there is none."""

    values: Values
    stable: StableSet | None
    sign: int | None
    because: str = ""

    @property
    def lam_max(self) -> Root | None:
        assert self.stable is not None
        return self.stable.lam_max


def hold_bound(scheme: Scheme, claim: Claim, formula: Expr, further: Sequence[Values] = ()) -> Finding:
    """Hold a claimed bound against the exact stable set at each of the sample values, and at ``further`` ones."""
    free = [parameter.name for parameter in open_parameters(scheme, claim)]
    points = _points(scheme, claim, formula, further)
    decided = [point for point in points if point.sign is not None]
    evidence: dict[str, object] = {
        "route": "exact stable sets",
        "values_checked": len(decided),
        "values_undecided": len(points) - len(decided),
        "over": {p.name: _range(p.low, p.high) for p in open_parameters(scheme, claim)},
    }
    if not decided:
        return undecided(points[0].because)
    failing = [point for point in decided if point.sign]
    if not failing:
        derived = f"{scheme.cfl}_max equals the claim at {len(decided)} exact values of {' and '.join(free)}"
        return Finding(Status.HOLDS, derived if free else _derived(scheme, decided[0]), None, evidence)
    evidence["values_failing"] = len(failing)
    evidence["failing"] = [_row(scheme, formula, point, free) for point in failing[:: -(-len(failing) // SHOWN)]]
    chosen = _telling(scheme, formula, failing, free)
    derived = _derived(scheme, chosen)
    if free:
        derived += f" at {', '.join(f'{name} = {exact_text(chosen.values[name])}' for name in free)}"
    return Finding(Status.FAILS, derived, _counterexample(scheme, claim, formula, chosen), evidence)


def _points(scheme: Scheme, claim: Claim, formula: Expr, further: Sequence[Values]) -> list[_Held]:
    """The claim held at every sample; at the first alone if the analysis doesn't reach the scheme there."""
    first, *others = samples(scheme, claim)
    try:
        beginning = _held(scheme, claim, formula, first)
    except NotAnalysable as error:
        return [_Held(first, None, None, str(error))]
    points = [beginning]
    for values in (*others, *further):
        try:
            points.append(_held(scheme, claim, formula, values))
        except NotAnalysable as error:
            points.append(_Held(values, None, None, str(error)))
    return points


def _range(low: Fraction | None, high: Fraction | None) -> list[str]:
    return ["-oo" if low is None else fraction_text(low), "oo" if high is None else fraction_text(high)]


def _held(scheme: Scheme, claim: Claim, formula: Expr, values: Values) -> _Held:
    """NotAnalysable where the analysis has no route to the scheme or the formula."""
    try:
        stable = stable_set(scheme, values)
    except (ParameterError, SchemeError) as error:
        return _Held(values, None, None, str(error))  # there is no scheme at these values
    if stable.undecided is not None:
        return _Held(values, None, None, stable.undecided)
    if stable.lam_max is None:
        return _Held(values, stable, -1)
    try:
        printed = printed_decimal(claim.texts["bound"])
        sign = rounds_to(stable.lam_max, printed) if printed else compare(formula, values, stable.lam_max)
    except ParameterError as error:
        return _Held(values, stable, -1, str(error))  # the claim has no value where the scheme has a bound
    return _Held(values, stable, sign)


def _claimed(formula: Expr, values: Values) -> Fraction | None:
    try:
        return value_of(formula, values)
    except ParameterError:
        return None


def _text(root: Root | None) -> str:
    if root is None:
        return "oo"
    return text_real(number_of(root)) if root.rational is None else exact_text(root.rational)


def _derived(scheme: Scheme, point: _Held) -> str:
    return f"{scheme.cfl}_max = {_text(point.lam_max)}"


def _row(scheme: Scheme, formula: Expr, point: _Held, free: Sequence[str]) -> dict[str, object]:
    claimed = _claimed(formula, point.values)
    return {
        **{name: fraction_text(point.values[name]) for name in free},
        "claimed": None if claimed is None else text_real(claimed),
        "derived": _text(point.lam_max),
    }


def _telling(scheme: Scheme, formula: Expr, failing: Sequence[_Held], free: Sequence[str]) -> _Held:
    """The failing point that shows it best: clearly off, near the defaults, and claimed stable where it is not."""

    def rank(point: _Held) -> tuple[bool, bool, float]:
        claimed = _claimed(formula, point.values)
        derived = None if point.lam_max is None else number_of(point.lam_max)
        sizes = [number for number in (claimed, derived) if number is not None and number > 0]
        clear = len(sizes) < 2 or max(sizes) >= CLEAR * min(sizes)
        return not clear, point.sign != 1, sum(_distance(scheme, name, point.values[name]) for name in free)

    return min(failing, key=rank)


def _distance(scheme: Scheme, name: str, value: Fraction) -> float:
    default = scheme.parameter(name).default or Fraction(1)
    ratio = value / default
    return abs(_log2(ratio)) if ratio > 0 else float("inf")


def _log2(ratio: Fraction) -> float:
    return ratio.numerator.bit_length() - ratio.denominator.bit_length()


# Counterexamples ------------------------------------------------------------------------------------------------------


def _counterexample(scheme: Scheme, claim: Claim, formula: Expr, point: _Held) -> Counterexample | None:
    """A CFL number between claim and derivation, where the scheme does what the claim says it does not.

    None only where the claim and the derivation differ by an isolated irrational lam.
    """
    claimed = _claimed(formula, point.values)
    if claimed is None:
        return Counterexample(dict(point.values), point.because, "the claim has no value", None, None)
    said = f"claimed bound {claim.texts['bound']} = {text_real(claimed)}, derived {_text(point.lam_max)}"
    if point.sign == 1:
        low, high = _unstable_gap(formula, point)
        shows, stable = f"{said}: not stable below the claimed bound", False
    else:
        low, high = _stable_gap(formula, point)
        shows, stable = f"{said}: still stable above the claimed bound", True
    for lam in _inside(low, high):
        values = {**point.values, scheme.cfl: lam}
        if (analyse(scheme, values).verdict is Verdict.STABLE) is stable:
            return witness(scheme, values, shows)
    return None


def _unstable_gap(formula: Expr, point: _Held) -> tuple[Fraction, Fraction]:
    """The stretch of lam from lam_max up to the claim or the next stable interval; low = high where it is one lam."""
    assert point.stable is not None
    assert point.lam_max is not None
    claimed, bottom = both_sides(formula, point.values, point.lam_max)
    for interval in point.stable.intervals:
        if interval.low is not None:
            return bottom, min(claimed, number_of(interval.low))
    return bottom, claimed


def _stable_gap(formula: Expr, point: _Held) -> tuple[Fraction, Fraction]:
    """The stretch from the claim (from 0, if that is negative) up to lam_max."""
    if point.lam_max is None:
        bottom = max(value_of(formula, point.values), Fraction(0))
        return bottom, 2 * max(bottom, Fraction(1))
    claimed, top = both_sides(formula, point.values, point.lam_max)
    return max(claimed, Fraction(0)), top


def _inside(low: Fraction, high: Fraction) -> list[Fraction]:
    """A few short fractions between two numbers, away from both; the number itself where they are one."""
    if low >= high:
        return [low] if low > 0 else []
    third = (high - low) / 3
    return [simplest_between(low + third, high - third), simplest_between(low + third / 4, low + third)]
