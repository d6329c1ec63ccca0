"""Irreducible factors of integer polynomials in several variables."""

from __future__ import annotations

from flint import fmpq_mpoly_ctx, fmpz_mpoly


def irreducible_factors(polynomial: fmpz_mpoly) -> list[tuple[fmpz_mpoly, int]]:
    """The irreducible factors with their multiplicities; constants are left out."""
    return factored(polynomial)[1]


def factored(polynomial: fmpz_mpoly) -> tuple[int, list[tuple[fmpz_mpoly, int]]]:
    """The constant with its sign, and the irreducible factors with their multiplicities.

    python-flint 0.9 sorts the factors of an fmpz_mpoly by coefficients that it squeezes into machine integers, and
    raises OverflowError where they do not fit. The rational twin of the polynomial is sorted without that.
    """
    try:
        constant, factors = polynomial.factor()
    except OverflowError:
        context = polynomial.context()
        rational = fmpq_mpoly_ctx.get(context.names(), context.ordering()).from_dict(polynomial.to_dict())
        lead, twins = rational.factor()
        constant = lead.p  # an integer, as the factors are primitive
        factors = [(_integral(context, factor), multiplicity) for factor, multiplicity in twins]
    return int(constant), list(factors)


def _integral(context: object, factor: object) -> fmpz_mpoly:
    """A factor that FLINT returns primitive over the integers, as an integer polynomial."""
    terms = {powers: int(c.p) for powers, c in factor.to_dict().items() if c.q == 1}  # type: ignore[attr-defined]
    if len(terms) != len(factor):  # type: ignore[arg-type]
        raise ArithmeticError(f"{factor} has coefficients that are not integers")
    return context.from_dict(terms)  # type: ignore[attr-defined,no-any-return]
