"""Delta as a function of z and of the symbols of a problem, whatever its resolvent variable, in double precision.

Under the method of lines it is the product of Delta over the values lam*s that the integrator has at z, which has its
zeros where one of them is a mode and no branch points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

import numpy as np

from gks.bounds.allroots import all_roots
from gks.bounds.sampled import Array, ComplexArray, polynomial_at, sampled
from gks.errors import NotAnalysable
from gks.modes.kreiss import NormalModeProblem
from gks.scheme.integrators import Integrator

DeltaOfZ = Callable[..., ComplexArray]
"""Delta at points z and values of the problem's symbols, all (N,)."""


def delta_of_z(problem: NormalModeProblem) -> DeltaOfZ:
    """The function; the last symbol of the problem is lam. NotAnalysable where time is exact."""
    compiled = sampled(problem)
    if problem.variable == "z":
        return lambda z, *symbols: compiled.at(z, *symbols).determinant
    method = problem.resolvent.integrator
    assert method is not None
    if method.kind == "exact":
        raise NotAnalysable("the semi-discrete problem has no z")

    def delta(z: ComplexArray, *symbols: Array) -> ComplexArray:
        mu = _branches(method, z)
        count = mu.shape[1]
        flat = [np.repeat(each, count) for each in symbols]
        with np.errstate(all="ignore"):
            # On the circle Re s may vanish throughout: which waves decay is told as abs(z) grows.
            outwards = _outwards(method, z, mu).ravel()
            found = compiled.at(mu.ravel() / flat[-1], *flat, towards=outwards).determinant
        return np.asarray(found.reshape(mu.shape).prod(axis=1))

    return delta


def _branches(method: Integrator, z: ComplexArray) -> ComplexArray:
    """All lam*s at every z: (N, branches)."""
    with np.errstate(all="ignore"):
        if method.kind == "multistep":
            rho, sigma = (polynomial_at(row, z) for row in (method.rho, method.sigma))
            return np.asarray((rho / sigma)[:, None])
        rows = np.tile([complex(c) for c in method.stability], (len(z), 1))
        rows[:, 0] -= z
        return all_roots(rows)


def _outwards(method: Integrator, z: ComplexArray, mu: ComplexArray) -> ComplexArray:
    """The derivative of every lam*s by log z."""
    if method.kind == "multistep":
        rho, sigma, rho_z, sigma_z = (
            polynomial_at(row, z) for row in (method.rho, method.sigma, _derived(method.rho), _derived(method.sigma))
        )
        return np.asarray((z * (rho_z - rho * sigma_z / sigma) / sigma)[:, None])
    return np.asarray(z[:, None] / polynomial_at(_derived(method.stability), mu))


def _derived(row: Sequence[Fraction]) -> tuple[Fraction, ...]:
    return tuple(k * Fraction(c) for k, c in enumerate(row))[1:]
