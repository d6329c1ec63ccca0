"""From a scheme and its values to the verdict, by the exact route."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from time import perf_counter
from typing import Literal

from flint import acb, ctx

from gks.errors import InputError
from gks.modes.admissible import Admissible, Candidate, admissible, point_of
from gks.modes.algebraic import GUARD_BITS, Position, Root, Side, isolated_roots
from gks.modes.coefficients import value_ball
from gks.modes.crossing import foreign, modes_at, regular_problem
from gks.modes.fibre import VanishesIdentically, fibre, univariate
from gks.modes.height import zero_exponent
from gks.modes.interior import interior_stability
from gks.modes.kreiss import NormalModeProblem, closure_matrix, normal_mode_problem, require_square, spatial_problem
from gks.modes.numerals import midpoint, modulus_of, radius_of
from gks.modes.polynomial import Degenerate, Elimination, Factor, TooWide, characteristic_factors
from gks.modes.rank import certain_rank, exact_rank
from gks.modes.route import beyond_elimination
from gks.modes.sheets import Choice, only_vanishing
from gks.modes.solvable import degenerate_closure, determines_next_level, independent_at_sample
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode, ModeKind, ModesResult, Reason, Verdict
from gks.scheme.model import Scheme

CHEAP_BITS = 256
"""Precision up to which balls alone are tried; only speed depends on it."""
OUTPUT_BITS = 80
"""Relative precision of the roots printed: beyond a double's 53 bits by enough to round correctly."""


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


def quick_verdict(scheme: Scheme, values: Mapping[str, Fraction | Root]) -> Verdict:
    """The verdict alone, with no mode inside the circle looked at; a value may be algebraic.

    The interior is taken to be Cauchy-stable at these values: the caller has asked.
    """
    problem = normal_mode_problem(scheme, values)
    if not determines_next_level(problem):
        return Verdict.UNSTABLE
    found = _modes_found(problem, inner=False)
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
        worst = max(
            float(m.modulus) if m.modulus < 10**300 else float("inf") for m in modes if m.kind is ModeKind.GROWING
        )
        return Verdict.UNSTABLE, "closure", f"a normal mode grows, abs(z) = {worst:.15g}"
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
    """The modes; where the interior is unstable they are a courtesy, and what keeps them from being found is no
    fault.
    """
    if interior is None:
        return _modes_found(problem)
    try:
        require_square(problem)
        modes, doubts = _modes(problem)
    except InputError:
        return _Found([], [], True, "exact")
    return _Found(modes, doubts, not doubts, "exact")


def _modes_found(problem: NormalModeProblem, *, inner: bool = True) -> _Found:
    """By elimination, or by counting zeros where the scheme is too wide for it."""
    if problem.coupled or not beyond_elimination(problem):
        try:
            modes, doubts = _modes(problem, inner=inner)
        except TooWide as too_wide:
            if problem.coupled:
                # The zeros of the determinant that the numeric route counts are not all modes of a coupled system.
                return _Found([], [f"the interior is coupled, and {too_wide}"], False, "exact")
        else:
            return _Found(modes, doubts, not doubts, "exact")
    from gks.modes.wide import VanishingDeterminant, wide_modes  # numpy, which elimination does without

    try:
        wide = wide_modes(problem)
    except VanishingDeterminant:
        raise degenerate_closure(problem) from None
    return _Found(wide.modes, wide.doubts, wide.certified, "certified" if wide.certified else "numeric")


def _modes(problem: NormalModeProblem, *, inner: bool = True) -> tuple[list[Mode], list[str]]:
    """Every root of the characteristic polynomial, judged; and what stayed open.

    Without ``inner`` the roots with abs(z) < 1 are passed over.
    """
    modes: list[Mode] = []
    doubts: list[str] = []
    elimination = eliminated(problem)
    # Where only a denominator was cleared there is nothing to list, unless it is a mode all the same.
    listed = [(factor, False) for factor in elimination.factors]
    for factor, clears in [*listed, *((replace(factor, multiplicity=1), True) for factor in elimination.clearing)]:
        for candidate in candidates_of(problem, factor, on_some_sheet=not (clears or elimination.lost_sheet)):
            if not inner and candidate.position is Position.INSIDE:
                continue
            try:
                mode = judge(problem, candidate)
            except Undecided as reason:
                if candidate.position is not Position.INSIDE:
                    doubts.append(f"{reason} (at abs(z) = {_modulus_text(problem, candidate)})")
            else:
                if not _unlisted(problem, candidate, mode, clears):
                    modes.append(mode)
    return modes, doubts


def _unlisted(problem: NormalModeProblem, candidate: Candidate, mode: Mode, clears: bool) -> bool:
    """Whether a root is there for what was cleared or substituted, and is not one of the closure's."""
    if mode.kind is ModeKind.INADMISSIBLE and clears:
        return True
    idle = mode.kind in (ModeKind.INADMISSIBLE, ModeKind.DECAYING)
    return problem.coupled and idle and foreign(problem, candidate)


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
    return f"{float(modulus_of(_z_ball(problem, candidate))):.15g}"


def candidates_of(problem: NormalModeProblem, factor: Factor, *, on_some_sheet: bool = False) -> Iterator[Candidate]:
    """The points at which a factor vanishes: z itself, or s with every z that the integrator gives it.

    ``on_some_sheet`` says that the norm the factor comes from has lost no sheet.
    """
    for sigma in isolated_roots(univariate(factor.polynomial, problem.variable), is_square_free=True):
        if problem.variable == "z":
            yield Candidate(sigma, sigma, factor.multiplicity, sigma.position, on_some_sheet)
        elif problem.time_map is None:
            yield Candidate(sigma, None, factor.multiplicity, _POSITION[sigma.side], on_some_sheet)
        else:
            try:
                images = fibre({**problem.coefficients.point(), "s": sigma}, problem.time_map, "z")
            except VanishesIdentically:
                continue
            for image in images:
                yield Candidate(
                    sigma, image.root, factor.multiplicity * image.multiplicity, image.position, on_some_sheet
                )


_POSITION = {Side.LEFT: Position.INSIDE, Side.AXIS: Position.ON, Side.RIGHT: Position.OUTSIDE}
"""z = exp(lam s) lies inside the circle when Re s < 0."""


# Judgement ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Space:
    """The admissible solutions at a candidate: for each block its roots, those inside first."""

    inside: tuple[tuple[Root, ...], ...]
    limiting: tuple[tuple[Root, ...], ...]

    @property
    def strict(self) -> _Space:
        return replace(self, limiting=tuple(() for _ in self.limiting))

    def roots(self, block: int) -> tuple[Root, ...]:
        return self.inside[block] + self.limiting[block]


def judge(problem: NormalModeProblem, candidate: Candidate) -> Mode:
    """What a root of the characteristic polynomial is.

    There is a normal mode when the closure, applied to the admissible solutions, has a kernel; on the circle it is
    generalized when a kernel vector needs a component that does not decay.
    """
    families = [admissible(problem, family, candidate) for family in problem.families]
    space = _space(problem, families)
    kind = _kind(problem, candidate, families, space)
    return _mode(problem, candidate, kind, space if kind is not ModeKind.INADMISSIBLE else None)


def _kind(
    problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible], space: _Space
) -> ModeKind:
    roots = [space.roots(k) for k in range(len(problem.blocks))]
    regular = regular_problem(problem, candidate, roots) if problem.coupled else problem
    if regular is None:
        modes = modes_at(problem, candidate, families)
        decays = not any(space.limiting) or modes_at(problem, candidate, families, strict=True) == modes
    else:
        # Of other columns than those that were eliminated it is not known that some sheet vanishes.
        here = candidate if regular is problem else replace(candidate, on_some_sheet=False)
        modes = int(_has_kernel(regular, here, space))
        decays = not modes or not any(space.limiting) or _kernel_decays(regular, here, space)
    if not modes:
        return ModeKind.INADMISSIBLE
    return _KIND[candidate.position] if decays else ModeKind.GENERALIZED


_KIND = {
    Position.OUTSIDE: ModeKind.GROWING,
    Position.ON: ModeKind.EIGENVALUE,
    Position.INSIDE: ModeKind.DECAYING,
}


def _space(problem: NormalModeProblem, families: Sequence[Admissible]) -> _Space:
    inside, limiting = [], []
    for block in problem.blocks:
        family = families[block.family]
        inside.append(tuple([Root.of(0)] * block.zeros + family.strictly()))
        limiting.append(tuple(family.on_circle()))
    return _Space(tuple(inside), tuple(limiting))


def _columns(space: _Space) -> int:
    return sum(map(len, space.inside)) + sum(map(len, space.limiting))


def _has_kernel(problem: NormalModeProblem, candidate: Candidate, space: _Space) -> bool:
    """Whether the closure annihilates an admissible solution, by the cheapest proof.

    Balls that leave no doubt; else, where the admissible solutions are one of the choices that the norm runs over,
    that no
    other choice vanishes; else the exact rank with its bound on algebraic numbers.
    """
    columns = _columns(space)
    roots = [space.roots(k) for k in range(len(problem.blocks))]
    point = point_of(problem, candidate)
    certain = certain_rank(lambda bits: closure_matrix(problem, point, roots, bits), CHEAP_BITS)
    if certain is not None:
        return columns > certain
    if columns == problem.size and only_vanishing(problem, candidate, _choice(problem, space)):
        return True
    return columns > _rank(problem, candidate, space)


def _choice(problem: NormalModeProblem, space: _Space) -> Choice:
    """The nonzero roots of each family, as its first block has them."""
    blocks = [next(k for k, b in enumerate(problem.blocks) if b.family == f) for f in range(len(problem.families))]
    return tuple(space.roots(k)[problem.blocks[k].zeros :] for k in blocks)


def _kernel_decays(problem: NormalModeProblem, candidate: Candidate, space: _Space) -> bool:
    """Whether every kernel vector has no share in the components on the circle.

    That is so when these columns are independent of each other and of the decaying ones.
    """
    extra = sum(map(len, space.limiting))
    return _rank(problem, candidate, space) == _rank(problem, candidate, space.strict) + extra


def _rank(problem: NormalModeProblem, candidate: Candidate, space: _Space) -> int:
    if not _columns(space):
        return 0
    roots = [space.roots(k) for k in range(len(problem.blocks))]
    return exact_rank(
        lambda bits: closure_matrix(problem, point_of(problem, candidate), roots, bits),
        lambda: zero_exponent(problem, candidate.sigma),
    )


# Output ---------------------------------------------------------------------------------------------------------------


def _z_ball(problem: NormalModeProblem, candidate: Candidate) -> acb:
    if candidate.z is not None:
        return candidate.z.ball(OUTPUT_BITS)
    lam = problem.coefficients.values[problem.resolvent.cfl]
    return (candidate.sigma.ball(OUTPUT_BITS) * value_ball(lam, OUTPUT_BITS)).exp()


def _mode(problem: NormalModeProblem, candidate: Candidate, kind: ModeKind, space: _Space | None) -> Mode:
    with ctx.workprec(OUTPUT_BITS + GUARD_BITS):
        z = _z_ball(problem, candidate)
        modulus = Fraction(1) if candidate.position is Position.ON else modulus_of(z)
        kappa = {
            half_line.name: tuple(_kappas(problem, candidate, half_line.name, half_line.side == "right", space))
            for half_line in problem.scheme.domains
        }
        return Mode(midpoint(z), modulus, radius_of(z), candidate.multiplicity, kind, kappa)


def _kappas(
    problem: NormalModeProblem, candidate: Candidate, domain: str, right: bool, space: _Space | None
) -> Iterator[tuple[Fraction, Fraction]]:
    """The spatial factors of a mode; of a root that is none, those of its families that do not decay as well."""
    seen: set[Root] = set()
    for k, block in enumerate(problem.blocks):
        if block.field.domain != domain:
            continue
        if space is not None:
            roots = list(space.roots(k))
        elif block.width > block.zeros:
            roots = [
                r.root for r in fibre(point_of(problem, candidate), problem.families[block.family].polynomial, "x")
            ]
        else:
            roots = []
        for root in roots:
            if not root.is_zero and root not in seen:
                seen.add(root)
                ball = root.ball(OUTPUT_BITS)
                yield midpoint(ball if right else 1 / ball)
