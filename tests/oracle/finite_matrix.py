"""The slow second way to growing modes: eigenvalues of the finite problem's one-step matrix.

Eigenvalues outside the unit circle of a truncated problem tend to the admissible modes as the truncation moves away,
while those of the interior (its symbol curve) stay inside for a Cauchy-stable scheme. Inside the circle the finite
matrix shows its own spectrum, which is no one's mode, so nothing is said there.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from gks.scheme.model import Scheme
from gks.solvers.update import update_matrix


def largest_modulus(scheme: Scheme, values: Mapping[str, Fraction], cells: int) -> float:
    """The spectral radius of one step on so many cells a side."""
    return float(np.abs(np.linalg.eigvals(update_matrix(scheme, values, cells))).max())


def growing_modulus(scheme: Scheme, values: Mapping[str, Fraction], cells: int = 12) -> float | None:
    """The largest modulus of a mode with abs(z) > 1; None where two truncations do not agree on one to 1e-6."""
    coarse, fine = largest_modulus(scheme, values, cells), largest_modulus(scheme, values, 2 * cells)
    return fine if fine > 1 and abs(coarse - fine) < 1e-6 * fine else None
