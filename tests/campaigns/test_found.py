"""What campaigns have found and was mended, each reduced to the step that was wrong."""

from __future__ import annotations

import numpy as np
import pytest

from gks.modes.winding import Walk, seeds


def test_a_node_that_falls_on_a_zero_does_not_spoil_the_seeds() -> None:
    """Interface of central2 under ssprk3, second order, a = 7/8, b = 1/4, x = 3/4, y = 1/4, ratio 1/3, lam = 153/160:
    a step near z = 1 was given up with its node on a zero, and the moments of the others came out as nan."""
    zeros = np.array([0.3 + 0.4j, 0.3 - 0.4j])
    node = np.exp(1j * np.linspace(0.001, np.pi - 0.001, 4001))
    delta = (node - zeros[0]) * (node - zeros[1])
    log = np.log(np.abs(delta))
    log[7] = -np.inf
    size = np.ones(len(node))
    walk = Walk(node, np.angle(delta), log, size, size, (complex(node[7]),), False)
    found = seeds(walk, 0j, 1.0, 2)
    assert sorted(found, key=lambda w: w.imag) == pytest.approx(sorted(zeros, key=lambda w: w.imag), abs=1e-3)
