"""How a time integrator turns the symbol of a space discretisation into an amplification polynomial.

With q_t = Q q the spatial mode kappa**i has the symbols s, the roots of S(s, kappa) = 0. A linear integrator maps each
to the roots z of rho(z) = lam s sigma(z) (multistep) or to z = R(lam s) (Runge-Kutta), and S becomes an F(z, kappa).
"""

from __future__ import annotations

from flint import fmpq_poly, fmpz_mpoly, fmpz_poly

from gks.modes.fibre import coefficients, embed


def under_multistep(
    symbol: fmpz_mpoly, rho: fmpz_poly, sigma: fmpz_poly, *, lam: fmpz_mpoly, s: str = "s", z: str = "z"
) -> fmpz_mpoly:
    """F(z, kappa) of the multistep method rho, sigma: ``symbol`` at s = rho(z)/(lam sigma(z)), cleared.

    ``lam`` is a polynomial of the symbol's context (a generator, or a constant); ``z`` is one of its generators.
    """
    context = symbol.context()
    top, bottom = embed(rho, context, z), lam * embed(sigma, context, z)
    parts = coefficients(symbol, s)
    degree = len(parts) - 1
    return sum((part * top**k * bottom ** (degree - k) for k, part in enumerate(parts)), context.constant(0))


def under_runge_kutta(
    symbol: fmpz_mpoly, stability: fmpq_poly, *, lam: fmpz_mpoly, s: str = "s", z: str = "z"
) -> fmpz_mpoly:
    """F(z, kappa) of a Runge-Kutta method: s eliminated from ``symbol`` and z = R(lam s), R the stability polynomial.

    For a symbol of degree 1 in s the map is one to one and nothing foreign enters.
    """
    context = symbol.context()
    argument = lam * context.gen(context.variable_to_index(s))
    denominator = stability.denom()
    image = context.constant(0)
    for coefficient in reversed(list(stability.numer())):
        image = image * argument + coefficient
    relation = denominator * context.gen(context.variable_to_index(z)) - image
    return relation.resultant(symbol, s)
