"""Which spatial roots belong to a normal mode at a given point, exactly.

Off the circle a solution is admissible when abs(x) < 1 (x the spatial root of the mirrored half-line). At a point with
abs(z) = 1 the admissible space is the limit of the decaying one as abs(z) -> 1+, so a root on the circle counts when it
is the end of a branch that comes from inside.

For a scalar field that is Cauchy stable, P and its z-derivative do not vanish together on abs(z) = abs(x) = 1 (roots z
there are simple). With q the multiplicity of x0 the branches near (z0, x0) are, to leading order in eps = z/z0 - 1,

    eta**q = -(b / a) eps,    x = x0 (1 + eta),    a = x0**q P_{x..x} / q!,    b = z0 dP/dz,

and eps > 0 moves a branch inside when Re eta < 0. For q = 1 this is the sign of the group velocity (Trefethen, J.
Comput.
Phys. 49 (1983), eq. 3.4), for q > 1 a glancing point. A branch with Re eta = 0 to leading order would leave the circle
sideways and break Cauchy stability, so the sign is always decided by balls at some precision.

For a system several branches may cross: P vanishes to order d in eps alone, in eta alone and in both together. The
terms of total degree d then split into d branches eta = v eps with real v, the inverse group velocities; those with
v < 0 count.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb, factorial

from flint import acb, arb, ctx, fmpz_mpoly, fmpz_poly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root
from gks.modes.fibre import FibreRoot, VanishesIdentically, at_balls, fibre, is_zero
from gks.modes.kreiss import Family, NormalModeProblem
from gks.modes.undecided import Undecided

DIRECTION_BITS = 1 << 13
"""Precision at which a direction that is still open is given up: no Cauchy-stable field needs it."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A point at which Delta may vanish: sigma, and the growth factor z (None under `exact`, where z = exp(lam s))."""

    sigma: Root
    z: Root | None
    multiplicity: int
    position: Position
    """Of z relative to the unit circle."""
    sheets: tuple[frozenset[int], ...] = ()
    """Sets of families, for each of which a factor of the determinant that has their roots alone is known to vanish at
    sigma for some choice of them."""
    images: int = 1
    """How many times z is an image of sigma under the integrator's map."""
    rivals: tuple[fmpz_poly, ...] = ()
    """Square-free polynomials that have all zeros of the norm among their roots; none where these are not known."""


@dataclass(frozen=True, slots=True)
class Admissible:
    """The admissible spatial roots of one family: those inside, and those that the circle contributes."""

    inside: tuple[FibreRoot, ...]
    limiting: tuple[tuple[FibreRoot, int], ...]
    """Roots on the circle with the number of their branches that come from inside."""

    @property
    def count(self) -> int:
        return sum(r.multiplicity for r in self.inside) + sum(count for _, count in self.limiting)

    def strictly(self) -> list[Root]:
        """The roots inside, repeated by multiplicity."""
        return [r.root for r in self.inside for _ in range(r.multiplicity)]

    def on_circle(self) -> list[Root]:
        return [r.root for r, count in self.limiting for _ in range(count)]


def point_of(problem: NormalModeProblem, candidate: Candidate) -> dict[str, Root]:
    """Coordinates of everything a field's symbol holds."""
    return {**problem.coefficients.point(), problem.variable: candidate.sigma}


def point_with_z(problem: NormalModeProblem, candidate: Candidate) -> dict[str, Root]:
    """The same and z, where that is algebraic: what the levels of the closure are powers of."""
    return point_of(problem, candidate) | ({} if candidate.z is None else {"z": candidate.z})


def admissible(problem: NormalModeProblem, family: Family, candidate: Candidate) -> Admissible:
    """Splits the spatial roots at a candidate; Undecided where a direction stays open."""
    point = point_of(problem, candidate)
    try:
        roots = fibre(point, family.polynomial, "x")
    except VanishesIdentically:
        raise Undecided("every spatial factor solves the interior scheme at this z") from None
    inside = tuple(r for r in roots if r.position is Position.INSIDE)
    circle = [r for r in roots if r.position is Position.ON]
    if candidate.position is not Position.ON or not circle:
        return Admissible(inside, ())
    limiting = [(r, _incoming_branches(problem, family, candidate, r)) for r in circle]
    found = Admissible(inside, tuple((r, count) for r, count in limiting if count))
    if found.count != family.decaying:
        raise Undecided(
            f"{found.count} admissible spatial roots were found where {family.decaying} decay outside the circle"
        )
    return found


def outward(problem: NormalModeProblem) -> tuple[fmpz_mpoly, fmpz_mpoly]:
    """d sigma / d eps for z = z0 (1 + eps), as a quotient of polynomials in sigma and z.

    With the variable s, ds/dz = -pi_z / pi_s; under `exact` z ds/dz = 1/lam, whose size is of no account.
    """
    gens, one = problem.coefficients.gens, problem.coefficients.context.constant(1)
    if problem.variable == "z":
        return gens["z"], one
    pi = problem.time_map
    if pi is None:
        return one, one
    return -gens["z"] * pi.derivative("z"), pi.derivative("s")


def _point_on_circle(problem: NormalModeProblem, candidate: Candidate, root: Root) -> dict[str, Root]:
    """Coordinates of a spatial root at a candidate; Undecided where the growth factor does not move with sigma."""
    point = {**point_with_z(problem, candidate), "x": root}
    if any(is_zero(point, part) for part in outward(problem)):
        raise Undecided("z does not move with the resolvent variable at a point on the circle")
    return point


def _incoming_branches(problem: NormalModeProblem, family: Family, candidate: Candidate, root: FibreRoot) -> int:
    q = root.multiplicity
    point = _point_on_circle(problem, candidate, root.root)
    slope = family.polynomial.derivative(problem.variable)
    if is_zero(point, slope):
        return sum(count for speed, count in crossing_slopes(problem, family, candidate, root) if _negative(speed))
    bend = family.polynomial
    for _ in range(q):
        bend = bend.derivative("x")
    top, bottom = outward(problem)
    bits = START_BITS
    while bits <= DIRECTION_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            at = {name: each.ball(bits) for name, each in point.items()}
            a = at["x"] ** q * at_balls(bend, at) / factorial(q)
            b = at_balls(slope, at) * at_balls(top, at) / at_balls(bottom, at)
            count = _inward(-b / a, q)
        if count is not None:
            return count
        bits *= 2
    raise Undecided("the direction of a spatial root on the circle is open")


def crossing_slopes(
    problem: NormalModeProblem, family: Family, candidate: Candidate, root: FibreRoot
) -> list[tuple[Root, int]]:
    """The slopes v of the branches eta = v eps that cross at a spatial root on the circle, with multiplicity.

    Undecided where the point is no plain crossing: a branch of zero group velocity among others, or one that bends.
    """
    d = root.multiplicity
    point = _point_on_circle(problem, candidate, root.root)
    top, bottom = outward(problem)
    x, v = problem.coefficients.gens["x"], problem.coefficients.gens["k0"]
    form = problem.coefficients.context.constant(0)
    across = family.polynomial
    for k in range(d + 1):
        entry = across
        for _ in range(d - k):
            if not is_zero(point, entry):
                raise Undecided("branches that meet on the circle do not cross")
            entry = entry.derivative(problem.variable)
        form += comb(d, k) * entry * top ** (d - k) * (bottom * x * v) ** k
        across = across.derivative("x")
    found = [(each.root, each.multiplicity) for each in fibre(point, form, "k0")]
    if sum(count for _, count in found) < d or any(not slope.is_real or slope.is_zero for slope, _ in found):
        raise Undecided("a branch that crosses others on the circle does not move with z, or not along the circle")
    return found


def _negative(slope: Root) -> bool:
    return bool(slope.ball().real < 0)


def _inward(ratio: acb, q: int) -> int | None:
    """How many q-th roots have a negative real part; None where one is not told at this precision."""
    if not ratio.is_finite() or ratio.contains(0):
        return None
    if q == 1:
        return None if ratio.real.contains(0) else int(ratio.real < 0)
    # A principal root near the cut is as good as any other: all q of them are looked at.
    turned = ratio if not (ratio.real < 0 and ratio.imag.contains(0)) else -ratio
    phase = acb(0) if turned is ratio else acb(arb(1) / q)
    first = turned ** (acb(1) / q)
    count = 0
    for k in range(q):
        branch = (first * (acb(2 * k) / q + phase).exp_pi_i()).real
        if branch.contains(0):
            return None
        count += int(branch < 0)
    return count
