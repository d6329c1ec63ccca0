"""The points at which a factor of a polynomial in the resolvent variable vanishes, with their growth factors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from gks.modes.admissible import Candidate
from gks.modes.algebraic import Position, Root, Side, isolated_roots
from gks.modes.fibre import VanishesIdentically, fibre, univariate
from gks.modes.kreiss import NormalModeProblem
from gks.modes.polynomial import Factor

_POSITION = {Side.LEFT: Position.INSIDE, Side.AXIS: Position.ON, Side.RIGHT: Position.OUTSIDE}
"""z = exp(lam s) lies inside the circle when Re s < 0."""


def candidates_of(problem: NormalModeProblem, factor: Factor) -> Iterator[Candidate]:
    """The points at which a factor vanishes: z itself, or s with every z that the integrator gives it."""
    for sigma in isolated_roots(univariate(factor.polynomial, problem.variable), is_square_free=True):
        if problem.variable == "z":
            yield Candidate(sigma, sigma, factor.multiplicity, sigma.position, factor.sheets)
        elif problem.time_map is None:
            yield Candidate(sigma, None, factor.multiplicity, _POSITION[sigma.side], factor.sheets)
        else:
            try:
                images = fibre({**problem.coefficients.point(), "s": sigma}, problem.time_map, "z")
            except VanishesIdentically:
                continue
            for image in images:
                many = image.multiplicity
                yield Candidate(sigma, image.root, factor.multiplicity * many, image.position, factor.sheets, many)


def conjugate(candidate: Candidate) -> Candidate:
    """The complex conjugate of a point."""
    z = None if candidate.z is None else _mirrored(candidate.z)
    return replace(candidate, sigma=_mirrored(candidate.sigma), z=z)


def _mirrored(root: Root) -> Root:
    """A root of the upper half-plane comes right before its conjugate (``Isolation``)."""
    if root.is_real:
        return root
    return Root(root.poly, root.index + (1 if root.ball().imag > 0 else -1))
