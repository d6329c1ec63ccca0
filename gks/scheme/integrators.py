"""Named time integrators, exactly: what `time = "…"` in a scheme file stands for.

For dt q' = mu q (mu = lam * s, s an eigenvalue of the space operator) every integrator is one
polynomial condition pi(z, mu) = 0 between mu and the growth factor z of a step:

- linear multistep: pi = rho(z) - mu * sigma(z);
- one-step Runge-Kutta: pi = z - R(mu), R the stability polynomial, which follows from the tableau;
- "exact", the semi-discrete problem itself: z = exp(mu), not a polynomial condition.

All coefficients are Fractions, ascending in their variable, and every integrator names its source.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

Kind = Literal["multistep", "runge-kutta", "exact"]
Polynomial = tuple[Fraction, ...]


@dataclass(frozen=True, slots=True)
class Tableau:
    """Butcher tableau of an explicit method: `a` strictly lower triangular (rows of length stages), weights `b`."""

    a: tuple[tuple[Fraction, ...], ...]
    b: tuple[Fraction, ...]

    @property
    def c(self) -> tuple[Fraction, ...]:
        """Abscissae: the row sums of `a`."""
        return tuple(sum(row, Fraction(0)) for row in self.a)

    def stability(self) -> Polynomial:
        """R(mu) = 1 + sum_k mu**k b a**(k-1) 1, ascending: the tableau applied to q' = mu q.

        The growth of stage i is Y_i = 1 + mu sum_j a_ij Y_j, which forward substitution makes a polynomial.
        """
        stages: list[list[Fraction]] = []
        for row in self.a:
            stages.append(_one_plus_mu_times(row[: len(stages)], stages))
        return _trimmed(_one_plus_mu_times(self.b, stages))


@dataclass(frozen=True, slots=True)
class Integrator:
    """A named time integrator.

    rho, sigma : multistep only (else empty): rho(z) - mu sigma(z) = 0, ascending in z.
    stability, tableau : Runge-Kutta only (else empty, None): z = R(mu), ascending in mu.
    order : order of accuracy; None for "exact", which has no error.
    """

    name: str
    kind: Kind
    rho: Polynomial
    sigma: Polynomial
    stability: Polynomial
    tableau: Tableau | None
    order: int | None
    source: str

    @property
    def steps(self) -> int:
        """How many roots z belong to one mu: the number of steps of a multistep method, otherwise 1."""
        return len(self.rho) - 1 if self.kind == "multistep" else 1

    @property
    def explicit(self) -> bool:
        """Whether level n+1 follows without solving: sigma of lower degree than rho, or an explicit tableau."""
        return self.kind == "runge-kutta" or (self.kind == "multistep" and len(self.sigma) < len(self.rho))

    def characteristic(self) -> tuple[Polynomial, ...]:
        """pi(z, mu) as coefficients of z**0, z**1, …, each ascending in mu, without trailing zeros.

        Raises ValueError for "exact", where z = exp(mu) is no polynomial condition.
        """
        if self.kind == "exact":
            raise ValueError('"exact" has no characteristic polynomial: z = exp(mu)')
        if self.kind == "runge-kutta":
            return tuple(-c for c in self.stability), (Fraction(1),)
        sigma = self.sigma + (Fraction(0),) * (len(self.rho) - len(self.sigma))
        return tuple(_trimmed([r, -s]) for r, s in zip(self.rho, sigma, strict=True))


def integrator(name: str) -> Integrator:
    """The integrator of that name; KeyError if there is none (see `INTEGRATORS`)."""
    return INTEGRATORS[name]


def _one_plus_mu_times(weights: tuple[Fraction, ...], stages: list[list[Fraction]]) -> list[Fraction]:
    """1 + mu * sum_j weights[j] stages[j](mu), ascending in mu."""
    result = [Fraction(1)] + [Fraction(0)] * max((len(stage) for stage in stages), default=0)
    for weight, stage in zip(weights, stages, strict=True):
        for power, coefficient in enumerate(stage):
            result[power + 1] += weight * coefficient
    return result


def _trimmed(coefficients: list[Fraction]) -> Polynomial:
    """Without trailing zeros (the zero polynomial is empty)."""
    end = len(coefficients)
    while end and coefficients[end - 1] == 0:
        end -= 1
    return tuple(coefficients[:end])


def _polynomial(*coefficients: int | str) -> Polynomial:
    return tuple(Fraction(c) for c in coefficients)


def _multistep(name: str, order: int, source: str, rho: Polynomial, sigma: Polynomial) -> Integrator:
    return Integrator(name, "multistep", rho, sigma, (), None, order, source)


def _runge_kutta(name: str, order: int, source: str, a: tuple[Polynomial, ...], b: Polynomial) -> Integrator:
    square = tuple(row + (Fraction(0),) * (len(b) - len(row)) for row in a)
    tableau = Tableau(square, b)
    return Integrator(name, "runge-kutta", (), (), tableau.stability(), tableau, order, source)


_ALL = (
    _multistep(
        "forward-euler", 1, "Euler, Institutionum calculi integralis I (1768), sec. 650",
        rho=_polynomial(-1, 1), sigma=_polynomial(1),
    ),
    _multistep(
        "backward-euler", 1, "Hairer & Wanner, Solving Ordinary Differential Equations II, sec. IV.1 (1.13)",
        rho=_polynomial(-1, 1), sigma=_polynomial(0, 1),
    ),
    _multistep(
        "crank-nicolson", 2, "Crank & Nicolson, Proc. Camb. Phil. Soc. 43 (1947) 50-67",
        rho=_polynomial(-1, 1), sigma=_polynomial("1/2", "1/2"),
    ),
    _multistep(
        "leapfrog", 2, "Courant, Friedrichs & Lewy, Math. Ann. 100 (1928) 32-74",
        rho=_polynomial(-1, 0, 1), sigma=_polynomial(0, 2),
    ),
    _multistep(
        "ab2", 2, "Bashforth & Adams, Theories of Capillary Action (1883)",
        rho=_polynomial(0, -1, 1), sigma=_polynomial("-1/2", "3/2"),
    ),
    _multistep(
        "ab3", 3, "Bashforth & Adams, Theories of Capillary Action (1883)",
        rho=_polynomial(0, 0, -1, 1), sigma=_polynomial("5/12", "-4/3", "23/12"),
    ),
    _multistep(
        "bdf2", 2, "Curtiss & Hirschfelder, Proc. Natl. Acad. Sci. 38 (1952) 235-243",
        rho=_polynomial("1/2", -2, "3/2"), sigma=_polynomial(0, 0, 1),
    ),
    _runge_kutta(
        "rk2", 2, "Heun, Z. Math. Phys. 45 (1900) 23-38",
        a=(_polynomial(), _polynomial(1)), b=_polynomial("1/2", "1/2"),
    ),
    _runge_kutta(
        "ssprk3", 3, "Shu & Osher, J. Comput. Phys. 77 (1988) 439-471",
        a=(_polynomial(), _polynomial(1), _polynomial("1/4", "1/4")), b=_polynomial("1/6", "1/6", "2/3"),
    ),
    _runge_kutta(
        "rk4", 4, "Kutta, Z. Math. Phys. 46 (1901) 435-453",
        a=(_polynomial(), _polynomial("1/2"), _polynomial(0, "1/2"), _polynomial(0, 0, 1)),
        b=_polynomial("1/6", "1/3", "1/3", "1/6"),
    ),
    Integrator("exact", "exact", (), (), (), None, None, "the semi-discrete problem itself: z = exp(lam s)"),
)  # fmt: skip

INTEGRATORS: dict[str, Integrator] = {each.name: each for each in _ALL}
