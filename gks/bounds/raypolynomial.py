"""Where an integrator's stability changes along a ray mu = t s, t > 0: positive roots of one exact real polynomial.

With roots z_1 … z_k of pi(z, mu), the Schur-Cohn determinant is |lc|**(2k) prod_{i,j} (1 - z_i conj(z_j)). It
vanishes wherever some |z_i| = 1 (i = j) and also where z_i conj(z_j) = 1 for i != j, which only adds a cut at which
nothing changes. With mu = t s it is a real polynomial in t whose coefficients are polynomials in x = Re s and
n = |s|**2 with *exact* rational coefficients. So what cancels identically has cancelled before any number is put in:
forward Euler leaves -2 x - n t after division by t, and near the imaginary axis RK4 keeps its terms of high order,
t**6/72 - t**8/576, unspoilt.

For k = 1 the determinant is |pi_1|**2 - |pi_0|**2, positive exactly where the integrator is stable.

On the real axis, where pi is real, conjugate pairs make every factor but pi(1) pi(-1) a square; there the cuts are the
roots of pi(1), pi(-1) and of Jury's inner determinant, prod_{i<j} (1 - z_i z_j), one by one.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import permutations

from gks.scheme.integrators import Polynomial, integrator

_Pair = dict[tuple[int, int], Fraction]
"""A polynomial in mu and conj(mu): exponents (a, b) to coefficient."""

Monomial = tuple[int, int, Fraction]
"""(j, m, q): q x**j n**m."""


@dataclass(frozen=True, slots=True)
class RayPolynomial:
    """sum_k t**k sum_{(j, m, q) in terms[k]} q x**j n**m, with the factor t**v of the determinant divided out.

    first_sign_decides : k = 1: positive exactly where stable. Otherwise its roots are the only places of change.
    """

    terms: tuple[tuple[Monomial, ...], ...]
    first_sign_decides: bool

    @property
    def degree(self) -> int:
        return len(self.terms) - 1


@lru_cache(maxsize=32)
def ray_polynomial(name: str) -> RayPolynomial | None:
    """The polynomial of a named integrator; None where the product of all z has modulus >= 1 always: never stable.

    Raises ValueError for "exact", which has no pi.
    """
    method = integrator(name)
    pi = method.characteristic()
    if _product_is_never_inside(pi):
        return None
    powers = _by_power(_schur_cohn(pi))
    used = [k for k, terms in enumerate(powers) if terms]
    rows = tuple(powers[used[0] : used[-1] + 1])
    return RayPolynomial(rows, method.steps == 1)


@lru_cache(maxsize=32)
def real_axis_polynomials(name: str) -> tuple[Polynomial, ...]:
    """pi(1, mu), pi(-1, mu) and Jury's inner determinant as polynomials in a real mu, ascending."""
    pi = integrator(name).characteristic()
    at_one = _sum([list(row) for row in pi])
    at_minus_one = _sum([[c if k % 2 == 0 else -c for c in row] for k, row in enumerate(pi)])
    return tuple(tuple(p) for p in (at_one, at_minus_one, _jury_inner(pi)) if len(p) > 1)


def _product_is_never_inside(pi: tuple[Polynomial, ...]) -> bool:
    """Whether pi_0 and pi_k are constants with |pi_0| >= |pi_k| (leapfrog: z_1 z_2 = -1)."""
    first, last = pi[0], pi[-1]
    return len(first) == len(last) == 1 and abs(first[0]) >= abs(last[0])


def _schur_cohn(pi: tuple[Polynomial, ...]) -> _Pair:
    """det(A A* - B* B) for the triangular Toeplitz matrices A of pi_k, pi_{k-1}, … and B of pi_0, pi_1, …"""
    steps = len(pi) - 1
    plain: list[_Pair] = [{(power, 0): c for power, c in enumerate(row) if c} for row in pi]
    conjugate: list[_Pair] = [{(0, power): c for power, c in enumerate(row) if c} for row in pi]
    matrix: list[list[_Pair]] = [[{} for _ in range(steps)] for _ in range(steps)]
    for i in range(steps):
        for j in range(steps):
            for m in range(min(i, j) + 1):
                _add_product(matrix[i][j], plain[steps - i + m], conjugate[steps - j + m], 1)
                _add_product(matrix[i][j], conjugate[i - m], plain[j - m], -1)
    result: _Pair = {}
    for order in permutations(range(steps)):
        sign = (-1) ** sum(a > b for k, a in enumerate(order) for b in order[k + 1 :])
        product: _Pair = {(0, 0): Fraction(sign)}
        for i, j in enumerate(order):
            factor, product = product, {}
            _add_product(product, factor, matrix[i][j], 1)
        _add_product(result, product, {(0, 0): Fraction(1)}, 1)
    return result


def _by_power(symmetric: _Pair) -> list[tuple[Monomial, ...]]:
    """Collect by powers of t, in x and n: mu**a conj(mu)**b + conj = n**b 2 Re(s**(a - b)) t**(a + b) for a >= b."""
    degree = max(a + b for a, b in symmetric)
    rows: list[dict[tuple[int, int], Fraction]] = [{} for _ in range(degree + 1)]
    for (a, b), c in symmetric.items():
        if a < b:  # counted with its mirror image: the determinant is real, so the coefficients agree
            continue
        for (j, m), q in _twice_real_part(a - b).items():
            key = (j, m + b)
            rows[a + b][key] = rows[a + b].get(key, Fraction(0)) + (c * q if a > b else c * q / 2)
    return [tuple((j, m, q) for (j, m), q in sorted(row.items()) if q) for row in rows]


def _twice_real_part(power: int) -> dict[tuple[int, int], Fraction]:
    """2 Re(s**power) in x and n: V_0 = 2, V_1 = 2 x, V_m = 2 x V_{m-1} - n V_{m-2}."""
    before: dict[tuple[int, int], Fraction] = {(1, -1): Fraction(2)}  # V_{-1} = 2 Re(1/s) = 2 x / n
    current: dict[tuple[int, int], Fraction] = {(0, 0): Fraction(2)}
    for _ in range(power):
        following: dict[tuple[int, int], Fraction] = {}
        for (j, m), q in current.items():
            following[j + 1, m] = following.get((j + 1, m), Fraction(0)) + 2 * q
        for (j, m), q in before.items():
            following[j, m + 1] = following.get((j, m + 1), Fraction(0)) - q
        before, current = current, following
    return current


def _jury_inner(pi: tuple[Polynomial, ...]) -> list[Fraction]:
    """prod_{i<j} (1 - z_i z_j) times the power k - 1 of the leading coefficient, for k <= 3 (Jury's inner X - Y)."""
    steps = len(pi) - 1
    p = [list(row) for row in pi]
    if steps == 1:
        return [Fraction(1)]
    if steps == 2:
        return _sum([p[2], _scaled(p[0], -1)])
    if steps == 3:
        minus_first, minus_last = _scaled(p[1], -1), _scaled(p[0], -1)
        return _sum([_times(p[3], p[3]), _times(minus_first, p[3]), _times(p[0], p[2]), _times(minus_last, p[0])])
    raise ValueError(f"Jury's inner determinant is written out for at most 3 steps, not {steps}")


def _add_product(target: _Pair, first: _Pair, second: _Pair, factor: int) -> None:
    """target += factor * first * second, zeros dropped."""
    for (a, b), c in first.items():
        for (d, e), f in second.items():
            value = target.pop((a + d, b + e), Fraction(0)) + factor * c * f
            if value:
                target[a + d, b + e] = value


def _sum(polynomials: list[list[Fraction]]) -> list[Fraction]:
    length = max(map(len, polynomials))
    total = [sum((p[k] for p in polynomials if k < len(p)), Fraction(0)) for k in range(length)]
    while total and total[-1] == 0:
        total.pop()
    return total


def _scaled(polynomial: list[Fraction], factor: int) -> list[Fraction]:
    return [factor * c for c in polynomial]


def _times(first: list[Fraction], second: list[Fraction]) -> list[Fraction]:
    product = [Fraction(0)] * max(len(first) + len(second) - 1, 0)
    for i, a in enumerate(first):
        for j, b in enumerate(second):
            product[i + j] += a * b
    return product
