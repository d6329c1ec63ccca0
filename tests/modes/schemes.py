"""Scalar model schemes for u_t + u_x = 0 (speed 1, so lam is the CFL number) as polynomials F(z, kappa; lam)."""

from __future__ import annotations

from fractions import Fraction
from math import lcm

from flint import fmpq, fmpq_poly, fmpz_mpoly, fmpz_mpoly_ctx, fmpz_poly

from gks.modes.amplification import under_multistep, under_runge_kutta
from gks.scheme.integrators import integrator
from gks.scheme.operators import discrete_stencil, stencil

CONTEXT = fmpz_mpoly_ctx.get(("z", "kappa", "lam", "s"), "lex")
z, kappa, lam, s = CONTEXT.gens()


def symbol(space: str) -> fmpz_mpoly:
    """S(s, kappa) = sum_j (m_j s + d_j) kappa**j, cleared."""
    operator = stencil(space, True)
    offsets = {*operator.mass, *operator.derivative}
    clear = lcm(*(c.denominator for c in (*operator.mass.values(), *operator.derivative.values())))
    total = CONTEXT.constant(0)
    for j in offsets:
        mass, derivative = operator.mass.get(j, Fraction(0)), operator.derivative.get(j, Fraction(0))
        total += (int(clear * mass) * s + int(clear * derivative)) * kappa ** (j - min(offsets))
    return total


def lines(space: str, time: str) -> fmpz_mpoly:
    """The method of lines: a named operator under a named integrator."""
    method = integrator(time)
    if method.kind == "multistep":
        clear = lcm(*(c.denominator for c in (*method.rho, *method.sigma)))
        rho, sigma = ([int(clear * c) for c in part] for part in (method.rho, method.sigma))
        return under_multistep(symbol(space), fmpz_poly(rho), fmpz_poly(sigma), lam=lam)
    stability = fmpq_poly([fmpq(c.numerator, c.denominator) for c in method.stability])
    return under_runge_kutta(symbol(space), stability, lam=lam)


def discrete(name: str) -> fmpz_mpoly:
    """A named fully discrete scheme z = sum_j c_j(lam) kappa**j, cleared."""
    rows = discrete_stencil(name, True).coefficients
    clear = lcm(*(c.denominator for row in rows.values() for c in row))
    lowest = min(*rows, 0)
    total = clear * z * kappa**-lowest
    for j, row in rows.items():
        for power, c in enumerate(row):
            total -= int(clear * c) * lam**power * kappa ** (j - lowest)
    return total
