"""Beam-Warming entering at x = 0 with the data on its first point and a rule of the field on the second.

For u_t + u_x = 0 the scheme reads u[i-1] and u[i-2]; u[0] is given (0 here) and u[1] needs a boundary scheme. Both
spatial roots decay for abs(z) > 1 (0 < lam < 2), so a solution is v_0 = 0, v_1 = 1 and

    (z - a) v_i = b v_(i-1) + c v_(i-2),    a = (1-lam)(2-lam)/2, b = lam(2-lam), c = -lam(1-lam)/2,

and what the rule asks of it is a polynomial in z. numpy's roots of that polynomial are all there is to know.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from gks.catalogue import find
from gks.modes import Verdict, analyse

Rule = dict[tuple[int, int], float]
"""Coefficient by (index, level)."""


def rules(lam: float) -> dict[str, Rule]:
    """Every shipped rule for u[1] as an equation, the new level being 1."""
    found: dict[str, Rule] = {}
    for order in range(4):
        signs = {k: (-1) ** k * comb(order + 1, k) for k in range(order + 2)}
        found[f"space-{order}"] = {(1 + k, 1): float(sign) for k, sign in signs.items()}
        found[f"oblique-{order}"] = {(1 + k, 1 - k): float(sign) for k, sign in signs.items()}
    found["one-sided"] = {(1, 1): 1, (1, 0): lam - 1, (0, 0): -lam}
    found["one-sided-implicit"] = {(1, 1): 1 + lam, (1, 0): -1, (0, 1): -lam}
    found["box"] = {(1, 1): 1 + lam, (0, 1): 1 - lam, (1, 0): lam - 1, (0, 0): -1 - lam}
    return found


def growth(rule: Rule, lam: float) -> float:
    """The largest abs(z) of a mode; roots z = a of the power of z - a that was multiplied in are none."""
    a, b, c = (1 - lam) * (2 - lam) / 2, lam * (2 - lam), -lam * (1 - lam) / 2
    z = np.polynomial.Polynomial([0.0, 1.0])
    y = z - a
    top, low = max(i for i, _ in rule), min(level for _, level in rule)
    v = [0 * z, z**0]  # v_i times y**(i - 1)
    for _ in range(top - 1):
        v.append(b * v[-1] + c * y * v[-2])
    total = 0 * z
    for (i, level), weight in rule.items():
        total = total + weight * z ** (level - low) * v[i] * y ** (top - max(i, 1))
    roots = total.trim(1e-12).roots()
    sizes = [abs(root) for root in map(complex, roots) if abs(root - a) > 1e-9]
    return max(sizes, default=0.0)


@pytest.mark.parametrize("name", sorted(rules(0.5)))
def test_the_shipped_scheme_has_the_modes_of_the_polynomial(name: str) -> None:
    scheme = find(f"beam-warming-{name}")
    for lam in (Fraction(1, 4), Fraction(1, 2), Fraction(4, 5), Fraction(5, 4), Fraction(8, 5), Fraction(19, 10)):
        found = analyse(scheme, {"lam": lam})
        expected = growth(rules(float(lam))[name], float(lam))
        assert abs(expected - 1) > 1e-6, "a sample on the edge says nothing"
        assert (found.verdict is Verdict.UNSTABLE) == (expected > 1)
        if expected > 1:
            largest = max(float(m.modulus) for m in found.modes if m.kind.value == "growing")
            np.testing.assert_allclose(largest, expected)
        else:
            assert found.verdict is Verdict.STABLE
