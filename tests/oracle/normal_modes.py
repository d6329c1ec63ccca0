"""The slow second way to a verdict: one scalar half-line, coefficients as numbers.

The candidates are the roots of two resultants, at most, and each is judged in 80 digits by what it is at z (1 + 1e-15):
the spatial roots inside there are the admissible ones, and the determinant over them is about 1e-8 or less at a zero
(spatial roots may move like a square root). No exact number, no ball, no group velocity; and no proof. Wave speeds and
gaps must not be as small as that: the tables it is used for keep lam between 1/2 and 5/2. One or two ghosts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from math import lcm
from typing import Any, cast

import numpy as np
from flint import acb, fmpz_mpoly_ctx, fmpz_poly
from mpmath import mp, mpc, mpf, polyroots

Equation = Mapping[tuple[int, int], Fraction]
"""Coefficient by (offset or index, time level)."""

DIGITS = 80
OUTWARD = mpf(10) ** -15
VANISHES = mpf(10) ** -6
"""Between the square root of OUTWARD and what a determinant of small rationals is where it is not zero."""
NEAR = mpf(10) ** -12
"""Distance from the circle within which a root lies on it: roots are good to DIGITS."""
WAVES = 720


def verdict(interior: Equation, closure: Sequence[Equation], ghosts: int) -> tuple[str, str | None]:
    """Verdict and reason of a right half-line whose lowest grid point has the index 0 and whose cells begin at
    ``ghosts``.
    """
    if not cauchy_stable(interior):
        return "unstable", "interior"
    with mp.workdps(DIGITS):
        kinds = {_kind(interior, closure, ghosts, z) for z in _candidates(interior, closure, ghosts)}
    for kind, name in (("growing", "unstable"), ("generalized", "generalized"), ("eigenvalue", "neutral")):
        if kind in kinds:
            return name, "closure"
    return "stable", None


def cauchy_stable(interior: Equation) -> bool:
    """Von Neumann's condition at many wave numbers, double roots on the circle counted as instability."""
    low = min(level for _, level in interior)
    rows = np.zeros((WAVES, 1 + max(level for _, level in interior) - low), dtype=complex)
    kappas = np.exp(2j * np.pi * np.arange(WAVES) / WAVES)
    for (offset, level), coefficient in interior.items():
        rows[:, level - low] += float(coefficient) * kappas**offset
    for row in rows:
        roots = np.roots(row[::-1])
        if np.abs(roots).max(initial=0) > 1 + 1e-9:
            return False
        if any(abs(a - b) < 1e-6 and abs(a) > 1 - 1e-6 for a, b in combinations(roots, 2)):
            return False
    return True


def spatial_roots(interior: Equation, z: Any) -> list[Any]:
    """All kappa with P(z, kappa) = 0, by size; roots 0 included."""
    left, low = min(offset for offset, _ in interior), min(level for _, level in interior)
    powers = [mpc(0)] * (1 + max(offset for offset, _ in interior) - left)
    for (offset, level), coefficient in interior.items():
        powers[offset - left] += _number(coefficient) * z ** (level - low)
    while powers and abs(powers[-1]) < NEAR**4:
        powers.pop()
    zeros = 0
    while powers and abs(powers[0]) < NEAR**4:
        powers, zeros = powers[1:], zeros + 1
    found = polyroots(powers[::-1], maxsteps=400, extraprec=400) if len(powers) > 1 else []
    return sorted([mpc(0)] * zeros + list(found), key=abs)


def _number(value: Fraction) -> Any:
    return mpf(value.numerator) / value.denominator


def _columns(kappas: Sequence[Any], count: int) -> list[list[Any]]:
    """Divided differences [k_1, ..., k_j] x**n, by their defining sum over monomials."""
    tables = [_homogeneous(kappas[:j], count, mpc(1)) for j in range(1, len(kappas) + 1)]
    return [[mpc(0)] * j + table[: count - j] for j, table in enumerate(tables)]


def _matrix(closure: Sequence[Equation], kappas: Sequence[Any], z: Any) -> Any:
    """Closure equations over the columns, each row divided by the sum of its coefficients' sizes."""
    count = 1 + max(index for equation in closure for index, _ in equation)
    columns = _columns(kappas, count)
    rows = []
    for equation in closure:
        low = min(level for _, level in equation)
        size = sum(abs(_number(c)) * abs(z) ** (level - low) for (_, level), c in equation.items())
        terms = [(i, _number(c) * z ** (level - low) / size) for (i, level), c in equation.items()]
        rows.append([sum(weight * column[i] for i, weight in terms) for column in columns])
    return mp.matrix(rows)


def _candidates(interior: Equation, closure: Sequence[Equation], ghosts: int) -> list[Any]:
    """The distinct roots of the norm, by resultants with P(k_0) and (two ghosts) (P(k_1) - P(k_0))/(k_1 - k_0).

    Where the norm is zero, a sheet of no interest solves everything: the closure's own branches are none either.
    """
    context = fmpz_mpoly_ctx.get(("z", "k0", "k1"), "lex")
    z, *kappas = context.gens()
    symbol = [context.constant(0)] * (1 + max(j for j, _ in interior) - min(j for j, _ in interior))
    scale, low = _denominator(interior), min(level for _, level in interior)
    for (offset, level), coefficient in interior.items():
        symbol[offset - min(j for j, _ in interior)] += int(coefficient * scale) * z ** (level - low)
    sums = [_homogeneous(kappas[: k + 1], len(symbol) + 8, context.constant(1)) for k in range(2)]
    rows = []
    for equation in closure:
        scale, low = _denominator(equation), min(level for _, level in equation)
        rows.append(
            [
                sum(
                    (
                        int(c * scale) * z ** (level - low) * sums[k][i - k]
                        for (i, level), c in equation.items()
                        if i >= k
                    ),
                    context.constant(0),
                )
                for k in range(ghosts)
            ]
        )
    delta = rows[0][0] if ghosts == 1 else rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    for k in reversed(range(ghosts)):
        relation = sum((c * sums[k][n - k] for n, c in enumerate(symbol) if n >= k), context.constant(0))
        delta = delta.resultant(relation, f"k{k}")
    if delta.is_zero():
        raise ArithmeticError("the norm is zero")
    powers = [0] * (1 + max(p[0] for p in delta.to_dict()))
    for power, whole in delta.to_dict().items():
        powers[power[0]] = int(whole)
    found = []
    for factor, _ in fmpz_poly(powers).factor()[1]:
        isolated = cast("list[tuple[acb, int]]", factor.complex_roots())
        rough = [complex(root) for root, _ in isolated]
        with mp.workdps(2 * DIGITS):
            found += [_polished([int(c) for c in factor], mpc(root)) for root in rough]
    return found


def _polished(powers: Sequence[int], z: Any) -> Any:
    """Newton's method for a simple root."""
    for _ in range(10):
        value, slope = mpc(0), mpc(0)
        for c in reversed(powers):
            value, slope = value * z + c, slope * z + value
        z -= value / slope
    return z


def _homogeneous(kappas: Sequence[Any], count: int, one: Any) -> list[Any]:
    """The complete homogeneous polynomials of degree 0, 1, ..."""
    table = [one] + [0 * one] * count
    for kappa in kappas:
        for power in range(1, count + 1):
            table[power] += kappa * table[power - 1]
    return table


def _denominator(equation: Equation) -> int:
    return lcm(*(c.denominator for c in equation.values()))


def _kind(interior: Equation, closure: Sequence[Equation], ghosts: int, z: Any) -> str | None:
    """What a root of the norm is; None for no mode with abs(z) >= 1."""
    size = abs(z)
    if size < 1 - NEAR:
        return None
    beyond = z if size > 1 + NEAR else z / size * (1 + OUTWARD)
    inside = [kappa for kappa in spatial_roots(interior, beyond) if abs(kappa) < 1]
    if len(inside) != ghosts:
        raise ArithmeticError(f"{len(inside)} spatial roots decay at z = {mp.nstr(z)}, and {ghosts} values are free")
    matrix = _matrix(closure, inside, beyond)
    if abs(mp.det(matrix)) > VANISHES:
        return None
    if size > 1 + NEAR:
        return "growing"
    return "generalized" if _has_a_wave(closure, inside, beyond) else "eigenvalue"


def _has_a_wave(closure: Sequence[Equation], kappas: Sequence[Any], z: Any) -> bool:
    """Whether some kernel vector has a component with abs(kappa) = 1: without those columns the kernel is smaller."""
    decaying = [kappa for kappa in kappas if abs(abs(kappa) - 1) >= VANISHES]
    return _nullity(closure, kappas, z) > _nullity(closure, decaying, z)


def _nullity(closure: Sequence[Equation], kappas: Sequence[Any], z: Any) -> int:
    if not kappas:
        return 0
    sizes = mp.svd_c(_matrix(closure, kappas, z), compute_uv=False)
    return sum(1 for size in sizes if size < VANISHES)
