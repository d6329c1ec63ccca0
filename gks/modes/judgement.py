"""What a root of the characteristic polynomial is: a growing mode, an eigenvalue, a generalized one, or none.

Balls decide nearly always (``spatialballs``) where no spatial root is on the circle: which ones decay is a strict
inequality. Where one is, or spatial roots collide, everything is exact: the fibre over the candidate, the direction in
which unimodular roots leave, the rank of the Kreiss matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import acb, ctx

from gks.modes.admissible import Admissible, Candidate, admissible, point_of
from gks.modes.algebraic import GUARD_BITS, Position, Root
from gks.modes.coefficients import value_ball
from gks.modes.conjugates import vanishes
from gks.modes.crossing import modes_at, regular_problem
from gks.modes.dependence import nullity
from gks.modes.fibre import fibre
from gks.modes.kreiss import NormalModeProblem, closure_matrix
from gks.modes.numerals import midpoint, modulus_of, radius_of
from gks.modes.order import vanishing_order
from gks.modes.rank import certain_rank
from gks.modes.sheets import Choice, only_vanishing
from gks.modes.spatialballs import BallSpace, NotTold, ball_space, by_block, has_kernel
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode, ModeKind

CHEAP_BITS = 256
"""Precision up to which balls alone are tried; only speed depends on it."""
OUTPUT_BITS = 80
"""Relative precision of the roots printed: beyond a double's 53 bits by enough to round correctly."""


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
    try:
        return _judged_by_balls(problem, candidate)
    except NotTold:
        pass
    families = [admissible(problem, family, candidate) for family in problem.families]
    space = _space(problem, families)
    kind = _kind(problem, candidate, families, space)
    return _mode(problem, candidate, kind, space if kind is not ModeKind.INADMISSIBLE else None)


def judged_exactly(problem: NormalModeProblem, candidate: Candidate) -> tuple[Mode, int]:
    """The same for a candidate of which it is not known that the norm vanishes there, with the dimension of the modes.

    Undecided where that takes too many bits, or a field of a coupled system has no basis of its own.
    """
    if problem.coupled:
        raise Undecided("the solutions of a coupled system where its branches meet are not told apart")
    point = point_of(problem, candidate)
    families = [admissible(problem, family, candidate) for family in problem.families]
    space = _space(problem, families)
    dimension = nullity(problem, point, [space.roots(k) for k in range(len(problem.blocks))])
    if not dimension:
        return _mode(problem, candidate, ModeKind.INADMISSIBLE, None), 0
    strict = [space.strict.roots(k) for k in range(len(problem.blocks))]
    decays = not any(space.limiting) or nullity(problem, point, strict) == dimension
    kind = _KIND[candidate.position] if decays else ModeKind.GENERALIZED
    return _mode(problem, candidate, kind, space), dimension


def judged_zero(problem: NormalModeProblem, candidate: Candidate) -> tuple[Mode, int]:
    """The same for a candidate on the circle whose spatial roots are likely to be off it: balls tell them then."""
    try:
        space = ball_space(problem, candidate)
    except NotTold:
        return judged_exactly(problem, candidate)
    roots = by_block(problem, space.inside)
    zero = vanishes(problem, candidate.sigma, roots) if sum(map(len, roots)) == problem.size else None
    if zero is None:
        raise Undecided("a determinant that vanishes to all digits was not proved to vanish")
    kind = _KIND[candidate.position] if zero else ModeKind.INADMISSIBLE
    found = _listed(problem, candidate, kind, lambda domain: _ball_kappas(problem, space, domain, admissible_only=zero))
    return found, int(zero)


def _judged_by_balls(problem: NormalModeProblem, candidate: Candidate) -> Mode:
    """The same for a candidate whose spatial roots are simple and off the circle; NotTold for others.

    So it may be on the circle itself: what decays there is the limit of what decays outside.
    """
    space = ball_space(problem, candidate)
    is_mode = has_kernel(problem, candidate, space, lambda: vanishing_order(problem, candidate))
    kind = _KIND[candidate.position] if is_mode else ModeKind.INADMISSIBLE
    return _listed(
        problem, candidate, kind, lambda domain: _ball_kappas(problem, space, domain, admissible_only=is_mode)
    )


def _kind(problem: NormalModeProblem, candidate: Candidate, families: Sequence[Admissible], space: _Space) -> ModeKind:
    roots = [space.roots(k) for k in range(len(problem.blocks))]
    regular = regular_problem(problem, candidate, roots) if problem.coupled else problem
    if regular is None:
        modes = modes_at(problem, candidate, families)
        decays = not any(space.limiting) or modes_at(problem, candidate, families, strict=True) == modes
    else:
        # Of other columns than those that were eliminated it is not known that some sheet vanishes.
        here = candidate if regular is problem else replace(candidate, sheets=(), rivals=())
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
    that no other choice vanishes; else the order of the determinant's zero; else the exact rank with its bound on
    algebraic numbers.
    """
    columns = _columns(space)
    roots = [space.roots(k) for k in range(len(problem.blocks))]
    point = point_of(problem, candidate)
    certain = certain_rank(lambda bits: closure_matrix(problem, point, roots, bits), CHEAP_BITS)
    if certain is not None:
        return columns > certain
    if columns == problem.size and only_vanishing(problem, candidate, _choice(problem, space)):
        return True
    order = vanishing_order(problem, candidate) if columns == problem.size else None
    return order > 0 if order is not None else columns > _rank(problem, candidate, space)


def _choice(problem: NormalModeProblem, space: _Space) -> Choice:
    """The nonzero roots of each family, as its first block has them."""
    blocks = [next(k for k, b in enumerate(problem.blocks) if b.family == f) for f in range(len(problem.families))]
    return tuple(space.roots(k)[problem.blocks[k].zeros :] for k in blocks)


def _kernel_decays(problem: NormalModeProblem, candidate: Candidate, space: _Space) -> bool:
    """Whether every vector of the kernel, which is not empty, has no share in the components on the circle.

    It is not so where the decaying columns are proved independent: none of them makes up the kernel. It is so when the
    others are independent of each other and of the decaying ones.
    """
    decaying = _columns(space.strict)
    point = point_of(problem, candidate)
    roots = [space.strict.roots(k) for k in range(len(problem.blocks))]
    if not decaying or certain_rank(lambda bits: closure_matrix(problem, point, roots, bits), CHEAP_BITS) == decaying:
        return False
    extra = sum(map(len, space.limiting))
    return _rank(problem, candidate, space) == _rank(problem, candidate, space.strict) + extra


def _rank(problem: NormalModeProblem, candidate: Candidate, space: _Space) -> int:
    if not _columns(space):
        return 0
    roots = [space.roots(k) for k in range(len(problem.blocks))]
    return _columns(space) - nullity(problem, point_of(problem, candidate), roots)


# Output ---------------------------------------------------------------------------------------------------------------


def z_ball(problem: NormalModeProblem, candidate: Candidate) -> acb:
    """The growth factor of a candidate to the precision printed."""
    if candidate.z is not None:
        return candidate.z.ball(OUTPUT_BITS)
    lam = problem.coefficients.values[problem.resolvent.cfl]
    return (candidate.sigma.ball(OUTPUT_BITS) * value_ball(lam, OUTPUT_BITS)).exp()


def _mode(problem: NormalModeProblem, candidate: Candidate, kind: ModeKind, space: _Space | None) -> Mode:
    return _listed(problem, candidate, kind, lambda domain: _kappas(problem, candidate, domain, space))


def _listed(
    problem: NormalModeProblem, candidate: Candidate, kind: ModeKind, kappas: Callable[[str], Iterable[acb]]
) -> Mode:
    """The mode as it is printed; ``kappas`` gives the spatial roots on the mirrored half-line, domain by domain."""
    with ctx.workprec(OUTPUT_BITS + GUARD_BITS):
        z = z_ball(problem, candidate)
        modulus = Fraction(1) if candidate.position is Position.ON else modulus_of(z)
        kappa = {
            half_line.name: tuple(
                midpoint(ball if half_line.side == "right" else 1 / ball) for ball in kappas(half_line.name)
            )
            for half_line in problem.scheme.domains
        }
        return Mode(midpoint(z), modulus, radius_of(z), candidate.multiplicity, kind, kappa)


def _kappas(problem: NormalModeProblem, candidate: Candidate, domain: str, space: _Space | None) -> Iterator[acb]:
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
                yield root.ball(OUTPUT_BITS)


def _ball_kappas(problem: NormalModeProblem, space: BallSpace, domain: str, *, admissible_only: bool) -> list[acb]:
    """The same from roots in balls; NotTold where two families may share one."""
    families = {
        block.family: None
        for block in problem.blocks
        if block.field.domain == domain and (admissible_only or block.width > block.zeros)
    }
    balls: list[acb] = []
    for family in families:
        roots = space.inside[family] if admissible_only else space.all[family]
        mine = [root.ball(OUTPUT_BITS) for root in roots]
        if any(ball.overlaps(other) for ball in mine for other in balls):
            raise NotTold
        balls += mine
    return balls
