"""What the roots of a characteristic polynomial are, for many parameter values at once, in double precision.

A root is a mode where the closure, applied to the solutions that decay there, has a kernel: the smallest singular value
of the Kreiss matrix is of the size of rounding at a root that is a mode, and of the size of the largest one at a root
that is none. What lies between, and every point at which z or a spatial root is too close to the unit circle for
doubles, is left open here, for the exact judgement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import fmpz_mpoly
from numpy.typing import NDArray

from gks.modes.fibre import coefficients as powers_of
from gks.modes.kreiss import NormalModeProblem, kreiss_matrix, longest, newton_columns
from gks.modes.verdict import ModeKind

Complex = NDArray[np.complex128]

CIRCLE = 1e-6
"""Distance of a modulus from 1 below which doubles do not decide the side: roots of multiplicity up to two are
known to the root of the rounding error, 1e-8, and the companion matrix loses a little of that."""
KERNEL, FULL = 1e-9, 1e-5
"""Smallest singular values against the largest: a kernel below the first, none above the second. Roots are accurate to
rounding, 1e-16, whose root a nearly double zero may keep of it."""


@dataclass(frozen=True, slots=True)
class Kinds:
    """The spatial problem with one parameter free; ``names`` are the polynomials' variables for sigma and for it."""

    problem: NormalModeProblem
    names: tuple[str, str]

    def of(self, sigma: Complex, parameter: Complex, z: Complex) -> list[ModeKind | None]:
        """The kind of every root: sigma, the parameter and z are arrays of one length; None where that is left open."""
        found: list[ModeKind | None] = [None] * len(sigma)
        with np.errstate(all="ignore"):  # what overflows is left open
            spatial = [self._spatial(family.polynomial, sigma, parameter) for family in self.problem.families]
            clear = np.abs(np.abs(z) - 1) > CIRCLE
            inside = []
            for roots in spatial:
                size = np.abs(roots)
                clear &= (np.isfinite(size) & (np.abs(size - 1) > CIRCLE)).all(axis=1)
                inside.append((size < 1).sum(axis=1))
            counts = np.stack(inside, axis=1) if inside else np.zeros((len(sigma), 0), int)
            for combination in np.unique(counts[clear], axis=0):
                at = np.flatnonzero(clear & (counts == combination).all(axis=1))
                expected = [family.decaying for family in self.problem.families]
                outside = np.abs(z[at]) > 1
                if outside.any() and list(combination) != expected:
                    at = at[~outside]  # doubles have miscounted, or the interior is not Cauchy-stable
                if not len(at):
                    continue
                ratio = self._ratio([roots[at] for roots in spatial], combination, sigma[at], parameter[at])
                for k, value in zip(at, ratio, strict=True):
                    if value < KERNEL:
                        found[k] = ModeKind.GROWING if abs(z[k]) > 1 else ModeKind.DECAYING
                    elif value > FULL:
                        found[k] = ModeKind.INADMISSIBLE
        return found

    def evaluated(self, polynomial: fmpz_mpoly, sigma: Complex, parameter: Complex) -> Complex:
        """A polynomial in sigma and the parameter, in doubles: inf where a coefficient is beyond them."""
        places = [polynomial.context().variable_to_index(name) for name in self.names]
        total = np.zeros(sigma.shape, np.complex128)
        for powers, coefficient in polynomial.to_dict().items():
            try:
                weight = float(int(coefficient))
            except OverflowError:
                weight = np.inf
            total = total + weight * sigma ** int(powers[places[0]]) * parameter ** int(powers[places[1]])
        return total

    def _spatial(self, polynomial: fmpz_mpoly, sigma: Complex, parameter: Complex) -> Complex:
        """All spatial roots (N, degree), moduli ascending; not finite where the degree drops."""
        table = np.stack([self.evaluated(part, sigma, parameter) for part in powers_of(polynomial, "x")], axis=1)
        degree = table.shape[1] - 1
        if degree == 0:
            return np.empty((len(sigma), 0), np.complex128)
        companion = np.zeros((len(sigma), degree, degree), np.complex128)
        companion[:, np.arange(1, degree), np.arange(degree - 1)] = 1
        companion[:, :, -1] = -table[:, :-1] / table[:, -1:]
        good = np.isfinite(companion).all(axis=(1, 2))
        roots = np.full((len(sigma), degree), np.nan + 0j)
        roots[good] = np.linalg.eigvals(companion[good])
        return np.take_along_axis(roots, np.argsort(np.abs(roots), axis=1), axis=1)

    def _ratio(
        self, spatial: Sequence[Complex], counts: Sequence[int], sigma: Complex, parameter: Complex
    ) -> NDArray[np.float64]:
        """Smallest over largest singular value of the closure on the solutions inside; 0 where they outnumber it."""
        zero, one = np.zeros(sigma.shape, np.complex128), np.ones(sigma.shape, np.complex128)
        columns: list[list[list[Any]]] = []
        for k, block in enumerate(self.problem.blocks):
            roots = spatial[block.family]
            mine = [zero] * block.zeros + [roots[:, j] for j in range(counts[block.family])]
            columns.append(newton_columns(mine, longest(self.problem.rows, k), zero, one))
        rows: list[list[Any]] = kreiss_matrix(
            self.problem.rows, columns, lambda c: self.evaluated(c, sigma, parameter), zero
        )
        if len(rows[0]) > len(rows):
            return np.zeros(len(sigma))
        if not rows[0]:
            return np.ones(len(sigma))
        matrix = np.moveaxis(np.array(rows), 2, 0)
        for axis in (2, 1):
            size = np.abs(matrix).max(axis=axis, keepdims=True)
            matrix = matrix / np.where(size > 0, size, 1)
        good = np.isfinite(matrix).all(axis=(1, 2))
        ratio = np.full(len(sigma), np.nan)
        singular = np.linalg.svd(matrix[good], compute_uv=False)
        ratio[good] = singular[:, -1] / singular[:, 0]
        return ratio
