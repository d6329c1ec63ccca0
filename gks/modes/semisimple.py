"""Cauchy stability of a coupled system where several roots z meet on the unit circle.

For a scalar field a double root on the circle is a growing wave. A system may have one: it only must not be defective,
and the bound on the powers must hold uniformly for the wave numbers near by. Let d roots z meet at (z0, kappa0),
kappa = kappa0 (1 + i theta + ...).

* M(z0, kappa0) must have a kernel of dimension d. The group of d roots is then z0 (I + theta W + O(theta**2)), analytic
  in theta, with W a matrix whose eigenvalues w are the group velocities, eps = w eta.
* Distinct w keep the eigenvectors apart as theta -> 0: the powers are bounded as soon as all abs(z) <= 1.
* If W is defective, z0**-n times the n-th power tends to exp(t W) as theta -> 0 with n theta = t, which has no bound in
  t: the system is not stable.
* Equal w with a full set of eigenvectors are left open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import comb

from flint import fmpz_mpoly

from gks.modes.algebraic import Root
from gks.modes.coupled import System
from gks.modes.crossing import clean
from gks.modes.fibre import fibre, is_zero, value
from gks.modes.kreiss import NormalModeProblem
from gks.modes.undecided import Undecided

Point = Mapping[str, Root]


@dataclass(frozen=True, slots=True)
class DoubleRoots:
    """Answers ``cauchy``'s question at a double root on the circle: is it harmless for this system?"""

    problem: NormalModeProblem
    system: System

    def __call__(self, point: Point, kappa: Root, z: Root) -> bool:
        """Whether powers stay bounded near the wave number ``kappa``; Undecided where first order does not tell."""
        here = {**self.problem.coefficients.point(), **point, "x": kappa}
        found = self._resolvents(here, z)
        if self._integrator_doubles(here, z, [sigma for sigma, _ in found]):
            return False
        return all(
            clean(self.system, at, self.problem.variable, multiplicity) and self._apart(at, multiplicity)
            for sigma, multiplicity in found
            if multiplicity > 1
            for at in [{**here, self.problem.variable: sigma}]
        )

    def _resolvents(self, here: Point, z: Root) -> list[tuple[Root, int]]:
        """The values of the resolvent variable behind z, with the multiplicity that D has there."""
        problem = self.problem
        method = problem.resolvent.integrator
        roots = [(r.root, r.multiplicity) for r in fibre(here, self.system.symbol, problem.variable)]
        if method is None:
            return [(sigma, count) for sigma, count in roots if sigma == z]
        if method.kind == "exact":
            # Here z is the Cayley image of s.
            s = problem.coefficients.gens["s"]
            sigma = value({"s": z}, s - 1, s + 1)
            return [(root, count) for root, count in roots if root == sigma]
        pi = problem.time_map
        assert pi is not None
        found = [(s, count) for s, count in roots if is_zero({**here, "s": s, "z": z}, pi)]
        if not found:
            raise Undecided("a root on the circle belongs to an infinite value of the resolvent variable")
        return found

    def _integrator_doubles(self, here: Point, z: Root, sigmas: Sequence[Root]) -> bool:
        """Whether a multistep method has z as a double root of its own; Undecided where s does not move z at all."""
        pi = self.problem.time_map
        if pi is None:
            return False
        points = [{**here, "s": s, "z": z} for s in sigmas]
        if any(is_zero(point, pi.derivative("z")) for point in points):
            return True
        if any(is_zero(point, pi.derivative("s")) for point in points):
            raise Undecided("a root on the circle does not move with the resolvent variable")
        return False

    def _apart(self, at: Point, d: int) -> bool:
        """Whether group velocities keep d branches apart; False where they share a solution to first order."""
        context = self.problem.coefficients.context
        form = _form(self.system.symbol, self.problem.variable, d, context.gens()[context.names().index("k0")])
        repeated = [root for root in fibre(at, form, "k0") if root.multiplicity > 1]
        for root in repeated:
            speed = {**at, "k0": root.root}
            if not _full(self.system, self.problem.variable, d, root.multiplicity, speed):
                return False
        if not repeated:
            return True
        raise Undecided("waves of one group velocity meet on the circle in a coupled interior")


def _form(symbol: fmpz_mpoly, variable: str, d: int, w: fmpz_mpoly) -> fmpz_mpoly:
    """d! times the terms of degree d of D in (d sigma, eta) with d sigma = w eta: a polynomial in w of degree d."""
    context = symbol.context()
    x = context.gens()[context.names().index("x")]
    total = context.constant(0)
    across = symbol
    for k in range(d + 1):
        entry = across
        for _ in range(d - k):
            entry = entry.derivative(variable)
        total += comb(d, k) * entry * w ** (d - k) * x**k
        across = across.derivative("x")
    return total


def _full(system: System, variable: str, d: int, multiplicity: int, at: Point) -> bool:
    """Whether W has as many eigenvectors to its eigenvalue at ``at`` as that counts: adj of the pencil vanishes there
    to all orders below multiplicity - 1.
    """
    context = system.symbol.context()
    w = context.gens()[context.names().index("k0")]
    for column in system.adjugate():
        for entry in column:
            form = _form(entry, variable, d - 1, w)
            for _ in range(multiplicity - 1):
                if not is_zero(at, form):
                    return False
                form = form.derivative("k0")
    return True
