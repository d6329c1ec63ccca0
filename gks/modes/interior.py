"""Cauchy stability of the interiors of a scheme at its parameter values."""

from __future__ import annotations

from math import lcm

from flint import fmpq, fmpq_poly, fmpz_mpoly, fmpz_poly

from gks.errors import NotAnalysable
from gks.modes.algebraic import Root
from gks.modes.amplification import under_multistep, under_runge_kutta
from gks.modes.cauchy import CauchyResult, Instability, cauchy_stable, degree_in, semi_discrete_stable
from gks.modes.cauchy_set import CauchyInterval, CauchySet, cauchy_set
from gks.modes.coefficients import Coefficients, common_denominator
from gks.modes.coupled import CoupledField
from gks.modes.field import Field
from gks.modes.kreiss import NormalModeProblem
from gks.modes.numerals import modulus_of, text_real
from gks.modes.resolvent import Resolvent
from gks.modes.semisimple import DoubleRoots
from gks.modes.undecided import Undecided
from gks.scheme.integrators import Polynomial


def interior_stability(problem: NormalModeProblem) -> str | None:
    """None where every field of every domain is Cauchy-stable, else which is not and how."""
    seen: set[tuple[str, str]] = set()
    for block in problem.blocks:
        symbol = field_symbol(block.field, problem.coefficients)
        key = (block.field.domain, str(symbol))
        if key in seen:
            continue
        seen.add(key)
        result = _judge(symbol, block.field, problem)
        if not result.stable:
            return (
                f"in domain {block.field.domain}, {_WORDS[result.reason]}{_where(result)}"
                if result.reason
                else "unstable"
            )
    return None


_WORDS = {
    Instability.GROWING: "a wave grows",
    Instability.DOUBLE_ROOT: "a double root z lies on the unit circle",
    Instability.LEADING_COEFFICIENT: "the new time level is not determined for a wave",
}


def _where(result: CauchyResult) -> str:
    parts = []
    if result.kappa is not None:
        parts.append(f"kappa = {_text(complex(result.kappa))}")
    if result.z is not None:
        parts.append(f"abs(z) = {text_real(modulus_of(result.z.ball()))}")
    return f" ({', '.join(parts)})" if parts else ""


def _text(value: complex) -> str:
    return f"{value.real:.6g}{value.imag:+.6g}i" if value.imag else f"{value.real:.6g}"


def field_symbol(field: Field, coefficients: Coefficients) -> fmpz_mpoly:
    """sum_j c_j x**j cleared of denominators and negative powers of x; nothing that depends on sigma is cancelled."""
    clear = common_denominator(list(field.stencil.values()), coefficients.context.constant(1))
    lowest = min(field.stencil)
    x = coefficients.gens["x"]
    total = coefficients.context.constant(0)
    for offset, value in field.stencil.items():
        total += value.num * (clear / value.den) * x ** (offset - lowest)
    return total


def amplification(symbol: fmpz_mpoly, coefficients: Coefficients, resolvent: Resolvent) -> fmpz_mpoly:
    """F(z, x): the symbol itself where the variable is z, else with s mapped by the integrator."""
    if resolvent.in_z:
        return symbol
    method = resolvent.integrator
    assert method is not None
    lam = coefficients.symbol(resolvent.cfl)
    cfl, scale = lam.num, int(lam.den.leading_coefficient())
    # With lam = num/scale and s = scale*s', lam*s is num*s'.
    symbol = _rescaled(symbol, scale)
    if method.kind == "multistep":
        return under_multistep(symbol, *_integers(method.rho, method.sigma), lam=cfl)
    stability = fmpq_poly([fmpq(c.numerator, c.denominator) for c in method.stability])
    return under_runge_kutta(symbol, stability, lam=cfl)


def _integers(rho: Polynomial, sigma: Polynomial) -> tuple[fmpz_poly, fmpz_poly]:
    """Both over their common denominator."""
    clear = lcm(*(c.denominator for c in (*rho, *sigma)))
    return fmpz_poly([int(c * clear) for c in rho]), fmpz_poly([int(c * clear) for c in sigma])


def _rescaled(symbol: fmpz_mpoly, scale: int) -> fmpz_mpoly:
    """The symbol as a polynomial in s' with s = scale * s'."""
    names = symbol.context().names()
    index = names.index("s")
    return symbol.context().from_dict(
        {powers: int(c) * scale ** int(powers[index]) for powers, c in symbol.to_dict().items()}
    )


def _rule(field: Field, problem: NormalModeProblem) -> DoubleRoots | None:
    """What judges multiple roots on the circle: a coupled system may have some, a scalar field none."""
    return DoubleRoots(problem, field.system) if isinstance(field, CoupledField) else None


def _undetermined(field: Field, symbol: fmpz_mpoly, problem: NormalModeProblem) -> bool:
    """Whether the leading coefficients of a coupled system leave the new level open for every wave."""
    if not isinstance(field, CoupledField):
        return False
    return degree_in(symbol, problem.variable) < field.system.row_degree(problem.variable)


def _judge(symbol: fmpz_mpoly, field: Field, problem: NormalModeProblem) -> CauchyResult:
    if _undetermined(field, symbol, problem):
        return CauchyResult(False, Instability.LEADING_COEFFICIENT, Root.of(1))
    point, rule = problem.coefficients.point(), _rule(field, problem)
    method = problem.resolvent.integrator
    if method is not None and method.kind == "exact":
        return semi_discrete_stable(symbol, point, kappa="x", harmless=rule)
    polynomial = amplification(symbol, problem.coefficients, problem.resolvent)
    return cauchy_stable(polynomial, point, kappa="x", harmless=rule)


def interior_limits(problem: NormalModeProblem) -> list[CauchySet]:
    """The Cauchy-stable lam of every field; ``problem`` has lam as a symbol.

    Under `exact` lam plays no part: the set is everything or nothing. NotAnalysable where a coupled system stays open.
    """
    try:
        return list(_limits(problem).values())
    except Undecided as reason:
        raise NotAnalysable(f"the Cauchy stability of the interior is not decided: {reason}") from None


def _limits(problem: NormalModeProblem) -> dict[tuple[bool, str], CauchySet]:
    method = problem.resolvent.integrator
    lam = problem.coefficients.variable(problem.resolvent.cfl)
    sets: dict[tuple[bool, str], CauchySet] = {}
    for block in problem.blocks:
        symbol = field_symbol(block.field, problem.coefficients)
        key = isinstance(block.field, CoupledField), str(symbol)
        if key in sets:
            continue
        if method is not None and method.kind == "exact":
            stable = _judge(symbol, block.field, problem).stable
            sets[key] = CauchySet((CauchyInterval(Root.of(0), None, False, False),) if stable else ())
        elif _undetermined(block.field, symbol, problem):
            sets[key] = CauchySet(())
        else:
            polynomial = amplification(symbol, problem.coefficients, problem.resolvent)
            point, rule = problem.coefficients.point(), _rule(block.field, problem)
            sets[key] = cauchy_set(polynomial, point, kappa="x", lam=lam, harmless=rule)
    return sets
