"""Claimed bounds: stability for 0 < lam < bound, and loss of it just above, at every value the claim is made for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from gks.bounds.cfl import Interval, StableSet, stable_set
from gks.bounds.claimvalue import compare, printed_decimal, rounds_to, value_of
from gks.bounds.finding import Counterexample, Finding, Status, Values, exact_text, undecided, witness
from gks.bounds.samples import open_parameters, samples, simplest_between
from gks.errors import InputError, ParameterError
from gks.modes.algebraic import Root
from gks.modes.analysis import analyse
from gks.modes.numerals import exact_fraction, text_real
from gks.modes.verdict import Verdict
from gks.scheme.expression import Expr
from gks.scheme.model import Claim, Scheme

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


def hold_bound(scheme: Scheme, claim: Claim, formula: Expr) -> Finding:
    """Hold a claimed bound against the exact stable set at each of the sample values."""
    free = [parameter.name for parameter in open_parameters(scheme, claim)]
    points = [_held(scheme, claim, formula, values) for values in samples(scheme, claim)]
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


def _range(low: Fraction | None, high: Fraction | None) -> list[str]:
    return ["-oo" if low is None else str(low), "oo" if high is None else str(high)]


def _held(scheme: Scheme, claim: Claim, formula: Expr, values: Values) -> _Held:
    try:
        stable = stable_set(scheme, values)
    except InputError as error:
        return _Held(values, None, None, str(error))  # there is no scheme, or no route to it, at these values
    if stable.undecided is not None:
        return _Held(values, None, None, stable.undecided)
    if stable.lam_max is None:
        return _Held(values, stable, -1)
    try:
        printed = printed_decimal(claim.texts["bound"])
        sign = rounds_to(stable.lam_max, printed) if printed else compare(formula, values, stable.lam_max)
    except ParameterError as error:
        return _Held(values, stable, -1, str(error))  # the claim has no value where the scheme has a bound
    except InputError as error:
        return _Held(values, None, None, str(error))
    return _Held(values, stable, sign)


def _claimed(formula: Expr, values: Values) -> Fraction | None:
    try:
        return value_of(formula, values)
    except ParameterError:
        return None


def _number(root: Root | None) -> Fraction | None:
    if root is None:
        return None
    return exact_fraction(root.ball().real) if root.rational is None else root.rational


def _text(root: Root | None) -> str:
    number = _number(root)
    if number is None:
        return "oo"
    return exact_text(number) if root is not None and root.rational is not None else text_real(number)


def _derived(scheme: Scheme, point: _Held) -> str:
    return f"{scheme.cfl}_max = {_text(point.lam_max)}"


def _row(scheme: Scheme, formula: Expr, point: _Held, free: Sequence[str]) -> dict[str, object]:
    claimed = _claimed(formula, point.values)
    return {
        **{name: str(point.values[name]) for name in free},
        "claimed": None if claimed is None else text_real(claimed),
        "derived": _text(point.lam_max),
    }


def _telling(scheme: Scheme, formula: Expr, failing: Sequence[_Held], free: Sequence[str]) -> _Held:
    """The failing point that shows it best: clearly off, near the defaults, and claimed stable where it is not."""

    def rank(point: _Held) -> tuple[bool, bool, float]:
        claimed, derived = _claimed(formula, point.values), _number(point.lam_max)
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


# Counterexamples --------------------------------------------------------------------------------------------------------


def _counterexample(scheme: Scheme, claim: Claim, formula: Expr, point: _Held) -> Counterexample | None:
    """A CFL number between claim and derivation, where the scheme does what the claim says it does not."""
    claimed = _claimed(formula, point.values)
    if claimed is None:
        return Counterexample(dict(point.values), point.because, "no value of the claim", None, None)
    assert point.stable is not None
    said = f"claimed bound {claim.texts['bound']} = {text_real(claimed)}, derived {_text(point.lam_max)}"
    if point.sign == 1:
        low, high = _unstable_gap(point.stable, claimed)
        shows = f"{said}: not stable below the claimed bound"
        wanted = False
    else:
        top = _number(point.lam_max)
        low, high = max(claimed, Fraction(0)), 2 * max(claimed, Fraction(1)) if top is None else top
        shows = f"{said}: still stable above the claimed bound"
        wanted = True
    for lam in _inside(low, high):
        values = {**point.values, scheme.cfl: lam}
        if (analyse(scheme, values).verdict is Verdict.STABLE) is wanted:
            return witness(scheme, values, shows)
    return None


def _unstable_gap(stable: StableSet, claimed: Fraction) -> tuple[Fraction, Fraction]:
    """The stretch of the lam axis from lam_max up to the claim or to the next stable interval."""
    bottom = _number(stable.lam_max) or Fraction(0)
    later: Sequence[Interval] = [i for i in stable.intervals if i.low is not None]
    ends = [end for end in (_number(i.low) for i in later) if end is not None and end >= bottom]
    return bottom, min([claimed, *ends])


def _inside(low: Fraction, high: Fraction) -> list[Fraction]:
    """A few short fractions between two numbers, away from both; the number itself where they are one."""
    if low >= high:
        return [low] if low > 0 else []
    third = (high - low) / 3
    return [simplest_between(low + third, high - third), simplest_between(low + third / 4, low + third)]
