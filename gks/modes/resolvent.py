"""The resolvent variable: s where the spatial problem does not know the integrator, else z.

Under the method of lines with a closure at one time level the modes are the zeros s of one spatial determinant, found
once, and the integrator maps each to the roots z of pi(z, lam*s) = 0. Closures over several levels, written updates and
half-lines with different integrators tie the spatial problem to the time step: then the variable is z itself, and a
multistep half-line has s = rho(z) / (lam * sigma(z)).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from flint import fmpz_mpoly

from gks.errors import NotAnalysable
from gks.modes.coefficients import Coefficients, Ratio
from gks.scheme.integrators import Integrator, integrator
from gks.scheme.model import LinearForm, Scheme


@dataclass(frozen=True, slots=True)
class Resolvent:
    """How a scheme's equations depend on the resolvent variable.

    ``in_z`` says which variable it is; ``integrator`` is the common one where the variable is s; ``derivative`` gives
    each method-of-lines domain the factor that stands for dt.
    """

    cfl: str
    in_z: bool
    z: Ratio
    integrator: Integrator | None
    derivative: Mapping[str, Ratio]

    @property
    def name(self) -> str:
        return "z" if self.in_z else "s"

    def of(self, domain: str) -> Ratio:
        return self.derivative[domain]

    def power(self, coefficients: Coefficients, level: int) -> Ratio:
        """The factor of a value ``level`` levels above the lowest one of its equation."""
        return coefficients.power(self.z, level) if self.in_z else coefficients.number(Fraction(1))


def resolvent_of(scheme: Scheme, coefficients: Coefficients) -> Resolvent:
    """Chooses the variable; NotAnalysable where a Runge-Kutta half-line meets another clock."""
    times = {half_line.name: half_line.time for half_line in scheme.domains}
    z = coefficients.of(coefficients.gens["z"])
    one_clock = len(set(times.values())) == 1 and None not in times.values()
    if one_clock and all(_one_level(equation.form) for equation in scheme.closure.equations):
        s = coefficients.of(coefficients.gens["s"])
        method = integrator(next(t for t in times.values() if t is not None))
        return Resolvent(scheme.cfl, False, z, method, dict.fromkeys(times, s))
    derivative: dict[str, Ratio] = {}
    for name, time in times.items():
        if time is None:
            continue
        method = integrator(time)
        if method.kind != "multistep":
            raise NotAnalysable(
                f"domain {name} is advanced by {time} and is coupled to values at other time levels or to another "
                "integrator",
                expected="one Runge-Kutta method for all domains and closures at one level",
            )
        rho = _in_z(method.rho, coefficients)
        sigma = _in_z(method.sigma, coefficients)
        derivative[name] = rho / (coefficients.symbol(scheme.cfl) * sigma)
    return Resolvent(scheme.cfl, True, z, None, derivative)


def _one_level(form: LinearForm) -> bool:
    first, last = form.levels
    return first == last


def _in_z(polynomial: tuple[Fraction, ...], coefficients: Coefficients) -> Ratio:
    z = coefficients.of(coefficients.gens["z"])
    return coefficients.add([coefficients.number(c) * coefficients.power(z, k) for k, c in enumerate(polynomial)])


def characteristic(method: Integrator, coefficients: Coefficients, cfl: str) -> fmpz_mpoly:
    """pi(z, lam*s) as an integer polynomial in z, s and, where it is symbolic, lam."""
    mu = coefficients.symbol(cfl) * coefficients.of(coefficients.gens["s"])
    z = coefficients.of(coefficients.gens["z"])
    terms = []
    for k, in_mu in enumerate(method.characteristic()):
        for power, c in enumerate(in_mu):
            terms.append(coefficients.number(c) * coefficients.power(mu, power) * coefficients.power(z, k))
    return coefficients.add(terms).num
