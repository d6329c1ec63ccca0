"""Every z with abs(z) >= 1 as the image of one closed disc abs(w) <= 1, for every kind of resolvent variable.

- z itself: z = 1/w.
- s under a linear multistep method: z = 1/w and lam*s = rho(z)/sigma(z), with no pole for abs(z) > 1.
- s under a Runge-Kutta method: z = 1/w and lam*s one of the roots mu of R(mu) = z. The set abs(R) > 1 is connected (R
  has no pole, so by the maximum principle each of its components reaches infinity), and a product over all the roots mu
  is a function of w that has no branch points.
- s for the semi-discrete problem: lam*s = (1 - w)/(1 + w), which takes the disc to Re s >= 0 and w = 1 to s = 0.

The point at infinity is a point like any other, since values of lam*s (or z) are quotients a/b: a polynomial of degree
d in the variable is evaluated as sum_i c_i a**i b**(d-i). The pair (a, b) is analytic for abs(w) < 1 and has no common
zeros, so it adds no zeros to a determinant. (For Runge-Kutta b = 1/(mu + 1): the product of all mu + 1 is z - R(-1) up
to a constant, and abs(R(-1)) < 1.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import acb, fmpq

from gks.modes.discs import ComplexArray, Discs, Jets, joined, linear_combination, powers
from gks.modes.enclosure import root_near
from gks.modes.kreiss import NormalModeProblem
from gks.modes.rootdiscs import approximate, branches, root_discs
from gks.scheme.integrators import Integrator


@dataclass(frozen=True, slots=True)
class Chart:
    """``method`` is None where the variable is z. The variable of the tables is lam*s, or z."""

    method: Integrator | None

    @property
    def branches(self) -> int:
        """How many values of the variable belong to one w."""
        return len(self.method.stability) - 1 if self.method is not None and self._runge_kutta else 1

    @property
    def _runge_kutta(self) -> bool:
        return self.method is not None and self.method.kind == "runge-kutta"

    def stages(self, node: ComplexArray, start: ComplexArray | None = None) -> ComplexArray:
        """The roots mu of R(mu) = 1/w at points w (N,), approximately: (N, branches), empty but for Runge-Kutta.

        From a ``start`` nearby they come in its order.
        """
        if not self._runge_kutta:
            return np.empty((len(node), 0), complex)
        return approximate(self._over(Jets.exact(node)).value.mid, start)

    def images(self, w: Jets, stages: ComplexArray) -> tuple[Jets, Jets]:
        """The pair (a, b) over discs w (N,), all branches one after the other; ``stages`` belong to points in them."""
        one = Jets.exact(np.ones(w.value.mid.shape, complex))
        if self.method is None:
            return one, w
        if self.method.kind == "exact":
            return one - w, one + w
        if self.method.kind == "multistep":
            table = powers(w, self.method.steps + 1)[::-1]
            return _polynomial(self.method.rho, table), _polynomial(self.method.sigma, table)
        coefficients = self._over(w)
        found = branches(coefficients, root_discs(coefficients.value, stages))
        mu = found.apply(lambda each: each.T.ravel())
        scale = (mu + Jets.exact(np.ones(mu.value.mid.shape, complex))).reciprocal()
        return mu * scale, scale

    def covers(self, w: Discs, stages: ComplexArray) -> Discs | None:
        """Disjoint discs (branches,) around the roots mu over one disc of w (1,); None where they are not disjoint."""
        if not self._runge_kutta:
            return Discs.exact(np.empty(0, complex))
        found = root_discs(self._over(Jets(w, Discs.exact(np.ones(1, complex)))).value, stages)
        if found.joined.sum() > self.branches:
            return None
        return Discs(found.centre[0], found.cover[0])

    def _over(self, w: Jets) -> Jets:
        """The coefficients of w R(mu) - 1, ascending: (N, branches + 1)."""
        assert self.method is not None
        table = [w.scaled(constant_of(c)) for c in self.method.stability]
        table[0] = table[0] - Jets.exact(np.ones(w.value.mid.shape, complex))
        return joined(table, lambda parts: np.stack(parts, 1))

    def value(self, w: complex, stage: complex) -> complex:
        """lam*s (or z) at one w, on the branch of the root ``stage`` of a Runge-Kutta method."""
        if self.method is None:
            return 1 / w
        if self.method.kind == "exact":
            return (1 - w) / (1 + w)
        if self.method.kind == "multistep":
            return _at(self.method.rho, 1 / w) / _at(self.method.sigma, 1 / w)
        return stage

    def growth(self, mu: acb, w: complex) -> acb:
        """The growth factor z of a ball of lam*s (or z): of several the one near 1/w. Raises NotEnclosed."""
        if self.method is None:
            return mu
        if self.method.kind == "exact":
            return mu.exp()
        if self.method.kind == "multistep":
            rows = [[acb(fmpq(c.numerator, c.denominator)) for c in row] for row in self.method.characteristic()]
            coefficients = [_horner(row, mu) for row in rows]
            starts = np.roots([complex(c) for c in reversed(coefficients)])
            return root_near(coefficients, [complex(z) for z in starts], 1 / w)
        return _horner([acb(fmpq(c.numerator, c.denominator)) for c in self.method.stability], mu)

    def growth_at(self, w: acb) -> acb:
        """The growth factor at a ball of w."""
        if self.method is not None and self.method.kind == "exact":
            return ((1 - w) / (1 + w)).exp()
        return 1 / w


def chart_of(problem: NormalModeProblem) -> Chart:
    """The chart of a problem's resolvent variable."""
    return Chart(problem.resolvent.integrator if problem.variable == "s" else None)


def constant_of(value: Fraction) -> Discs:
    """A rational as a disc of shape (), as wide as one rounding."""
    mid = np.asarray(complex(float(value)))
    return Discs(mid, np.abs(mid) * 2.0**-52)


def _polynomial(coefficients: Sequence[Fraction], table: list[Jets]) -> Jets:
    """sum_i coefficients[i] table[i]."""
    return linear_combination([constant_of(c) for c in coefficients], table[: len(coefficients)])


def _at(coefficients: Sequence[Fraction], z: complex) -> complex:
    return sum((float(c) * z**i for i, c in enumerate(coefficients)), 0j)


def _horner(coefficients: Sequence[acb], x: acb) -> acb:
    value = acb(0)
    for c in reversed(coefficients):
        value = value * x + c
    return value
