"""The roots of one factor of a characteristic polynomial at one parameter value, with bounds of their errors.

The roots sigma are isolated in balls. Where sigma is s, every z that the time integrator gives it is computed in double
precision, and enclosed in a disc (`gks.bounds.rootdiscs`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self, cast

import numpy as np
from flint import acb, fmpz_poly
from numpy.typing import NDArray

from gks.bounds.allroots import all_roots
from gks.bounds.rootdiscs import COMPLEX_STEP, RoundedPolynomials
from gks.bounds.sampled import Array, ComplexArray, polynomial_at
from gks.modes.doubledouble import UNIT
from gks.scheme.integrators import Integrator


@dataclass(frozen=True, slots=True)
class Images:
    """Arrays (N,): sigma, known to ``radius``, and an image z of it, known to ``error``; multiple roots repeated.

    ``root`` numbers the distinct roots at a value.
    """

    root: NDArray[np.intp]
    sigma: ComplexArray
    radius: Array
    z: ComplexArray
    error: Array

    @classmethod
    def none(cls) -> Self:
        """No roots."""
        return cls(np.empty(0, np.intp), np.empty(0, complex), np.empty(0), np.empty(0, complex), np.empty(0))

    def __len__(self) -> int:
        return len(self.sigma)


def joined(parts: Sequence[Images]) -> Images:
    """All of them, in order."""
    every = [Images.none(), *parts]
    return Images(
        np.concatenate([each.root for each in every]),
        np.concatenate([each.sigma for each in every]),
        np.concatenate([each.radius for each in every]),
        np.concatenate([each.z for each in every]),
        np.concatenate([each.error for each in every]),
    )


def isolated(polynomial: fmpz_poly) -> Images:
    """The roots that doubles can hold, each as its own image."""
    found = cast("list[tuple[acb, int]]", polynomial.complex_roots())
    balls = [(k, ball) for k, (ball, count) in enumerate(found) for _ in range(count)]
    root = np.array([k for k, _ in balls], np.intp)
    sigma = np.array([complex(ball) for _, ball in balls], np.complex128)
    radius = np.array([float(ball.rad()) for _, ball in balls]) + 2 * UNIT * np.abs(sigma)
    finite = np.isfinite(sigma)
    root, sigma, radius = root[finite], sigma[finite], radius[finite]
    return Images(root, sigma, radius, sigma, radius)


def growth_factors(method: Integrator, roots: Images, lam: float) -> Images:
    """Each sigma with every z that the integrator gives lam*sigma, those that doubles can hold."""
    with np.errstate(all="ignore"):
        mu, spread = lam * roots.sigma, lam * roots.radius
        if method.kind == "exact":
            z = np.exp(mu)[:, None]
            # exp is right to two units, and takes the rounding of mu as a relative one.
            error = np.abs(z) * (np.expm1(spread + 2 * UNIT * np.abs(mu)) + 4 * UNIT)[:, None]
        else:
            polynomials = _in_z(method, mu, spread)
            if method.kind == "runge-kutta":  # z - R(mu)
                z, error = -polynomials.coefficients[:, :1], polynomials.rounding * polynomials.sizes[:, :1]
            else:
                z = all_roots(polynomials.coefficients)
                error = polynomials.discs(z)
    finite = np.isfinite(z).ravel()
    source = np.repeat(np.arange(len(roots)), z.shape[1])[finite]
    own = roots.root[source], roots.sigma[source], roots.radius[source]
    return Images(*own, z.ravel()[finite], error.ravel()[finite])


def _in_z(method: Integrator, mu: ComplexArray, spread: Array) -> RoundedPolynomials:
    """pi(z, mu) for every mu, which is known to ``spread``."""
    rows = method.characteristic()
    degree = max(map(len, rows)) - 1
    # A term: its coefficient, lam and lam*sigma in every factor, the products and sums, the rounding of the difference
    # below; then Horner's scheme.
    operations = 1 + degree * (2 + COMPLEX_STEP + 2) + COMPLEX_STEP * (len(rows) - 1)
    rounding = operations * UNIT
    size = np.abs(mu)
    moduli = [[abs(c) for c in row] for row in rows]
    coefficients, sizes, wider = (
        np.stack([polynomial_at(row, x) for row in each], axis=1)
        for each, x in ((rows, mu), (moduli, size), (moduli, size + spread))
    )
    # What moves within the disc of mu counts as rounding.
    return RoundedPolynomials(coefficients, sizes.real + (wider - sizes).real / rounding, rounding)
