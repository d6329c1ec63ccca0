"""The interior's Cauchy-stable lam, also where the formula of a wave speed holds lam.

Upwinding follows the sign of a speed, so that the interior is another scheme wherever a speed changes its sign. The
positive lam axis is cut there, each piece has its own Cauchy limits, and at the cuts an exact verdict decides.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from flint import fmpq, fmpz_mpoly, fmpz_poly

from gks.errors import InputError, NotAnalysable
from gks.modes.algebraic import Root
from gks.modes.cauchy import degree_in
from gks.modes.cauchy_set import CauchyInterval, CauchySet, rationals_between
from gks.modes.critical import positive_roots
from gks.modes.fibre import univariate
from gks.modes.interior import field_symbol, interior_limits, interior_stability
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem, spatial_problem
from gks.modes.unimodular import by_real_part
from gks.scheme.model import Scheme

SAMPLES = 8
"""Values of lam at which the speeds are looked at: they vanish at few."""


def interior_sets(scheme: Scheme, sample: Mapping[str, Fraction]) -> tuple[list[CauchySet], list[Root]]:
    """Stable are the lam that all sets contain; and the lam, ascending, at which a wave speed changes its sign.

    ``sample`` gives lam a value too, which has no influence.
    """
    problem = with_signs(scheme, sample)
    method = problem.resolvent.integrator
    if method is not None and method.kind == "exact" and holds_lam(field_symbols(problem), problem):
        raise NotAnalysable(
            f"time is exact and {scheme.cfl} enters the interior scheme", expected=f"an interior without {scheme.cfl}"
        )
    zeros = _speed_zeros(problem)
    if not zeros:
        return interior_limits(problem), []
    pieces = [
        interior_limits(spatial_problem(scheme, {**sample, scheme.cfl: lam}, (scheme.cfl,)))
        for lam in rationals_between(zeros)
    ]
    return [_joined(scheme, sample, zeros, pieces)], zeros


def holds_lam(polynomials: Iterable[fmpz_mpoly], problem: NormalModeProblem) -> bool:
    """Whether lam, a symbol of the problem, enters one of some polynomials."""
    lam = problem.coefficients.variable(problem.resolvent.cfl)
    free = {g.name for g in problem.coefficients.generators if g.root is None and degree_in(g.relation, lam)}
    return any(degree_in(each, name) for each in polynomials for name in (lam, *free))


def field_symbols(problem: NormalModeProblem) -> list[fmpz_mpoly]:
    """The symbol of every field."""
    return [field_symbol(block.field, problem.coefficients) for block in problem.blocks]


def space_holds_lam(problem: NormalModeProblem) -> bool:
    """Whether the spatial problem, interior or closure, depends on lam, which is a symbol of it.

    Under the method of lines its zeros s move with lam then.
    """
    closure = [term.coefficient for row in problem.rows for term in row]
    return holds_lam([*field_symbols(problem), *closure], problem)


def signs_stand(problem: NormalModeProblem, name: str, value: Fraction) -> bool:
    """Whether at this value of a symbol, and at all lam, every speed has the sign that the problem was derived with.

    False also where that is not looked into: a speed that moves with lam or through an adjoined root.
    """
    coefficients = problem.coefficients
    free = [coefficients.variable(problem.resolvent.cfl), *(g.name for g in coefficients.generators if g.root is None)]
    symbol = coefficients.variable(name)
    for block in problem.blocks:
        speed = block.field.speed
        if speed is None:
            continue
        if any(degree_in(part, each) for part in (speed.num, speed.den) for each in free):
            return False
        if degree_in(speed.num, symbol) or degree_in(speed.den, symbol):
            parts = [univariate(coefficients.norm(part), symbol) for part in (speed.num, speed.den)]
            top, bottom = (part(fmpq(value.numerator, value.denominator)) for part in parts)
            if top * bottom * coefficients.sign(speed) <= 0:
                return False
    return True


def _speed_zeros(problem: NormalModeProblem) -> list[Root]:
    """The positive lam at which a wave speed vanishes or has a pole, ascending; lam is a symbol of the problem."""
    lam = problem.coefficients.variable(problem.resolvent.cfl)
    found: list[fmpz_poly] = []
    for block in problem.blocks:
        speed = block.field.speed
        if speed is not None and not speed.is_zero():
            parts = map(problem.coefficients.norm, (speed.num, speed.den))
            found += [univariate(part, lam) for part in parts if degree_in(part, lam)]
    return by_real_part(list(dict.fromkeys(root.minimal for root in positive_roots(found))))


def with_signs(scheme: Scheme, sample: Mapping[str, Fraction]) -> NormalModeProblem:
    """With lam as a symbol, at a lam where no speed vanishes."""
    lam = sample[scheme.cfl]
    for k in range(SAMPLES):
        try:
            return spatial_problem(scheme, {**sample, scheme.cfl: lam + Fraction(k, 2 * k + 1)}, (scheme.cfl,))
        except NotAnalysable:
            if k == SAMPLES - 1:
                raise
    raise AssertionError("unreachable")


def _joined(
    scheme: Scheme, sample: Mapping[str, Fraction], zeros: Sequence[Root], pieces: Sequence[Sequence[CauchySet]]
) -> CauchySet:
    """One set: between two zeros what all sets of that piece contain."""
    inner = [end for sets in pieces for each in sets for i in each.intervals for end in (i.low, i.high)]
    cuts = by_real_part(list(dict.fromkeys([*zeros, *(e.minimal for e in inner if e is not None and not e.is_zero)])))
    ends: list[Root | None] = [Root.of(0), *cuts, None]

    def holds(lam: Root) -> bool:
        if lam in zeros:
            return _stable_at(scheme, sample, lam)
        return all(each.contains(lam) for each in pieces[sum(zero < lam for zero in zeros)])

    intervals: list[CauchyInterval] = []
    for low, high, lam in zip(ends, ends[1:], rationals_between(cuts), strict=False):
        assert low is not None
        if not holds(Root.of(lam)):
            continue
        at_low = not low.is_zero and holds(low)
        at_high = high is not None and holds(high)
        if at_low and intervals and intervals[-1].high is low:
            intervals[-1] = CauchyInterval(intervals[-1].low, high, intervals[-1].low_stable, at_high)
        else:
            intervals.append(CauchyInterval(low, high, at_low, at_high))
    return CauchySet(tuple(intervals))


def _stable_at(scheme: Scheme, sample: Mapping[str, Fraction], lam: Root) -> bool:
    exact = lam.rational
    values: dict[str, Fraction | Root] = {**sample, scheme.cfl: lam if exact is None else exact}
    try:
        return interior_stability(normal_mode_problem(scheme, values)) is None
    except NotAnalysable:
        raise
    except InputError:
        return False  # there is no scheme at this value
