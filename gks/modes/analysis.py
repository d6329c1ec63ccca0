"""From a scheme and its values to the verdict, by the exact route."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from time import perf_counter
from typing import Literal

from gks.errors import InputError
from gks.modes.admissible import Candidate
from gks.modes.algebraic import Position, Root, primitive
from gks.modes.candidates import candidates_of
from gks.modes.cauchy import degree_in
from gks.modes.fibre import univariate
from gks.modes.foreign import ForeignZeros, genuine
from gks.modes.interior import interior_stability
from gks.modes.judgement import judge, z_ball
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem, require_square, spatial_problem
from gks.modes.numerals import modulus_of, text_real
from gks.modes.order import multiplicity
from gks.modes.polynomial import Degenerate, Elimination, TooWide, characteristic_factors
from gks.modes.route import beyond_elimination, laborious
from gks.modes.solvable import degenerate_closure, determines_next_level, independent_at_sample
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode, ModeKind, ModesResult, Reason, Verdict, text_modulus
from gks.scheme.model import Scheme


def analyse(scheme: Scheme, values: Mapping[str, Fraction]) -> ModesResult:
    """The verdict of a scheme at one set of parameter values.

    Raises InputError where the input is at fault (a degenerate closure, a division by zero at these values) or the
    scheme is beyond this analysis.
    """
    start = perf_counter()
    problem = spatial_problem(scheme, values)
    interior, undecided = _interior(problem)
    if interior is None:
        require_square(problem)
    solvable = determines_next_level(problem) if interior is None else True
    found = _modes_beside(interior, problem)
    verdict, reason, because = _judge(interior, solvable, found.modes, found.doubts)
    if undecided is not None and verdict is not Verdict.UNSTABLE:
        verdict, reason, because = Verdict.UNDECIDED, "interior", f"whether it is Cauchy-stable is open: {undecided}"
    listed = tuple(sorted(found.modes, key=_order))
    kept = [mode.modulus for mode in listed if mode.kind is not ModeKind.INADMISSIBLE]
    margin = 1 - max(kept) if kept else None
    on_circle = any(mode.kind in (ModeKind.EIGENVALUE, ModeKind.GENERALIZED) for mode in listed)
    if on_circle and margin is not None and margin > 0:
        margin = Fraction(0)
    return ModesResult(
        scheme,
        dict(values),
        verdict,
        reason,
        margin,
        found.certified,
        found.tier,
        listed,
        solvable,
        because,
        perf_counter() - start,
    )


def _interior(problem: NormalModeProblem) -> tuple[str | None, str | None]:
    """How the interior fails to be Cauchy-stable, and what keeps that from being decided; None where nothing does."""
    try:
        return interior_stability(problem), None
    except Undecided as open_question:
        return None, str(open_question)


def quick_verdict(scheme: Scheme, values: Mapping[str, Fraction | Root], *, at_length: bool = True) -> Verdict:
    """The verdict alone, with no mode inside the circle looked at; a value may be algebraic.

    The interior is taken to be Cauchy-stable at these values: the caller has asked. Without ``at_length`` what the
    count of zeros leaves open stays so where elimination would take long.
    """
    problem = normal_mode_problem(scheme, values)
    if not determines_next_level(problem):
        return Verdict.UNSTABLE
    found = _modes_found(problem, inner=False, at_length=at_length)
    return _judge(None, True, found.modes, found.doubts)[0]


def _order(mode: Mode) -> tuple[bool, Fraction, Fraction, Fraction]:
    """Admissible modes first, the largest modulus first, a conjugate pair with the upper root first."""
    return mode.kind is ModeKind.INADMISSIBLE, -mode.modulus, -mode.z[0], -mode.z[1]


def _judge(
    interior: str | None, solvable: bool, modes: Sequence[Mode], doubts: Sequence[str]
) -> tuple[Verdict, Reason | None, str]:
    if interior is not None:
        return Verdict.UNSTABLE, "interior", f"the interior scheme is not Cauchy-stable: {interior}"
    if not solvable:
        return Verdict.UNSTABLE, "closure", "the closure does not determine the next time level (a mode at z = oo)"
    kinds = {mode.kind for mode in modes}
    if ModeKind.GROWING in kinds:
        worst = max((m for m in modes if m.kind is ModeKind.GROWING), key=lambda m: m.modulus)
        return Verdict.UNSTABLE, "closure", f"a normal mode grows, abs(z) = {text_modulus(worst)}"
    if doubts:
        return Verdict.UNDECIDED, "closure", "; ".join(doubts)
    if ModeKind.GENERALIZED in kinds:
        return (
            Verdict.GENERALIZED,
            "closure",
            "a generalized eigenvalue has abs(z) = 1: one of its components does not decay",
        )
    if ModeKind.EIGENVALUE in kinds:
        return Verdict.NEUTRAL, "closure", "an eigenvalue with decaying components has abs(z) = 1 exactly"
    return Verdict.STABLE, None, "no eigenvalue and no generalized eigenvalue has abs(z) >= 1"


# Candidates -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Found:
    """The modes, what stayed open, and by which route they were found."""

    modes: Sequence[Mode]
    doubts: Sequence[str]
    certified: bool
    tier: Literal["exact", "numeric", "certified"]


def _modes_beside(interior: str | None, problem: NormalModeProblem) -> _Found:
    """The modes; where the interior is unstable they are a courtesy: what keeps them from being found is no fault, and
    they are not worth minutes.
    """
    if interior is None:
        return _modes_found(problem)
    if laborious(problem):
        return _Found([], [], True, "exact")
    try:
        require_square(problem)
        modes, doubts = _modes(problem)
    except InputError:
        return _Found([], [], True, "exact")
    return _Found(modes, doubts, not doubts, "exact")


def _modes_found(problem: NormalModeProblem, *, inner: bool = True, at_length: bool = True) -> _Found:
    """By elimination, or by counting zeros where there are too many roots to judge each, or the scheme is too wide.

    What the count leaves open the elimination decides after all, where it can be done.
    """
    eliminable = problem.coupled or not beyond_elimination(problem)
    if eliminable and laborious(problem):
        counted = _counted(problem, inner=inner)
        return counted if counted.certified or not at_length else _eliminated(problem, inner=inner)
    if eliminable:
        try:
            found = _eliminated(problem, inner=inner, most=MANY_ROOTS)
            if found.certified:
                return found
            return _counted_after(problem, found, inner=inner)
        except TooWide:
            pass
        except _ManyRoots:
            counted = _counted(problem, inner=inner)
            return counted if counted.certified else _eliminated(problem, inner=inner)
    return _counted(problem, inner=inner)


MANY_ROOTS = 80
"""Roots of the characteristic polynomial beyond which a count of zeros is the cheaper way: judging them all takes
seconds then, the count some tenths of one."""


class _ManyRoots(ArithmeticError):
    """The characteristic polynomial has more roots than one would judge."""


def _eliminated(problem: NormalModeProblem, *, inner: bool, most: int | None = None) -> _Found:
    modes, doubts = _modes(problem, inner=inner, most=most)
    return _Found(modes, doubts, not doubts, "exact")


def _counted(problem: NormalModeProblem, *, inner: bool) -> _Found:
    from gks.modes.wide import VanishingDeterminant, wide_modes  # numpy, which elimination does without

    try:
        wide = wide_modes(problem, inner=inner)
    except VanishingDeterminant:
        if not _surely_independent(problem):
            raise degenerate_closure(problem) from None
        return _Found([], ["in double precision the determinant is not told from zero"], False, "numeric")
    if problem.coupled:
        wide = genuine(problem, wide)
    return _Found(wide.modes, wide.doubts, wide.certified, "certified" if wide.certified else "numeric")


def _counted_after(problem: NormalModeProblem, found: _Found, *, inner: bool) -> _Found:
    """What elimination left open, where the count of zeros settles it."""
    try:
        counted = _counted(problem, inner=inner)
    except InputError:  # elimination has seen that Delta is not identically zero, whatever its size
        return found
    return counted if counted.certified else found


def _surely_independent(problem: NormalModeProblem) -> bool:
    """Whether Delta is proved not to vanish identically."""
    try:
        return independent_at_sample(problem)
    except Undecided:
        return False


def _modes(problem: NormalModeProblem, *, inner: bool = True, most: int | None = None) -> tuple[list[Mode], list[str]]:
    """Every root of the characteristic polynomial, judged; and what stayed open.

    Without ``inner`` the roots with abs(z) < 1 are passed over. _ManyRoots where there are more than ``most``.
    """
    found, doubts = judged(problem, inner=inner, most=most)
    return [mode for mode, _ in found], doubts


def judged(
    problem: NormalModeProblem, *, inner: bool = True, most: int | None = None
) -> tuple[list[tuple[Mode, Candidate]], list[str]]:
    """The same, each mode with the candidate that it is."""
    modes: list[tuple[Mode, Candidate]] = []
    doubts: list[str] = []
    elimination = eliminated(problem)
    if most is not None and sum(degree_in(f.polynomial, problem.variable) for f in elimination.factors) > most:
        raise _ManyRoots
    # Where only a denominator was cleared there is nothing to list, unless it is a mode all the same.
    listed = [(factor, False) for factor in elimination.factors]
    listed += [(replace(factor, multiplicity=1, sheets=()), True) for factor in elimination.clearing]
    foreign = ForeignZeros(problem)
    rivals = tuple(primitive(univariate(factor.polynomial, problem.variable)) for factor, _ in listed)
    for factor, clears in listed:
        last: tuple[Mode, Candidate] | None = None
        for found in candidates_of(problem, factor):
            candidate = replace(found, rivals=rivals)
            if not inner and candidate.position is Position.INSIDE:
                continue
            try:
                mode = _mirrored(last, candidate) or _counted_once(problem, candidate, judge(problem, candidate))
                last = mode, candidate
            except Undecided as reason:
                if candidate.position is not Position.INSIDE:
                    doubts.append(f"{reason} (at abs(z) = {_modulus_text(problem, candidate)})")
            else:
                idle = mode.kind in (ModeKind.INADMISSIBLE, ModeKind.DECAYING)
                if mode.kind is ModeKind.INADMISSIBLE and clears:
                    continue
                if not (problem.coupled and idle and foreign.hold(candidate, factor.polynomial)):
                    modes.append((mode, candidate))
    return modes, doubts


def _counted_once(problem: NormalModeProblem, candidate: Candidate, mode: Mode) -> Mode:
    """The mode with its own multiplicity, where the norm counts zeros of other choices of spatial roots as well."""
    if mode.multiplicity == 1 or mode.kind is ModeKind.INADMISSIBLE:
        return mode
    return replace(mode, multiplicity=multiplicity(problem, candidate))


def _mirrored(last: tuple[Mode, Candidate] | None, candidate: Candidate) -> Mode | None:
    """The conjugate of the mode before, where this is the candidate's conjugate: all coefficients are real.

    A root of the upper half-plane comes right before its conjugate (``Isolation``).
    """
    if last is None or not (candidate.z is None or candidate.z is candidate.sigma):
        return None
    mode, before = last
    if before.sigma.index != candidate.sigma.index - 1 or not before.sigma.ball().imag > 0:
        return None
    return mode.conjugate()


def eliminated(problem: NormalModeProblem) -> Elimination:
    """The characteristic polynomial; SchemeError where the closure is degenerate at these values."""
    try:
        elimination = characteristic_factors(problem)
    except Degenerate:
        raise degenerate_closure(problem) from None
    if elimination.lost_sheet and not independent_at_sample(problem):
        raise degenerate_closure(problem)
    return elimination


def _modulus_text(problem: NormalModeProblem, candidate: Candidate) -> str:
    return text_real(modulus_of(z_ball(problem, candidate)))
