"""Von Neumann's condition the slow, obvious way: the roots z at many wave numbers, in double precision."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from flint import fmpz_mpoly


def largest_modulus(poly: fmpz_mpoly, values: Mapping[str, float], wave_numbers: int = 720) -> float:
    """The largest abs(z) over F(z, exp(i theta)) = 0 for equally spaced theta in [0, pi]; inf where F loses a root."""
    names = poly.context().names()
    level = names.index("z")
    kappas = np.exp(1j * np.linspace(0, np.pi, wave_numbers + 1))
    rows = np.zeros((kappas.size, int(poly.degrees()[level]) + 1), dtype=complex)
    for powers, coefficient in poly.to_dict().items():
        term = np.full(kappas.size, complex(int(coefficient)))
        for name, power in zip(names, powers, strict=True):
            if name != "z" and power:
                term *= (kappas if name == "kappa" else values[name]) ** int(power)
        rows[:, int(powers[level])] += term
    if np.any(np.abs(rows[:, -1]) < 1e-12 * np.abs(rows).max(axis=1)):
        return float("inf")
    return max(float(np.abs(np.roots(row[::-1])).max(initial=0.0)) for row in rows)
