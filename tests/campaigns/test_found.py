"""What campaigns have found and was mended, each reduced to the step that was wrong."""

from __future__ import annotations

import numpy as np
import pytest

from gks.campaigns.routes import settled_radius
from gks.catalogue.interfaces import UNIT, closure_lines, ghost_equations, own_value, two_media
from gks.modes.analysis import quick_verdict
from gks.modes.verdict import Verdict
from gks.modes.winding import Walk, seeds
from gks.scheme.schemefile import parse_scheme
from gks.solvers.update import update_matrix


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


def side(unknown: str, domain: str) -> str:
    """The value at the interface, extrapolated linearly from one side."""
    return own_value(domain, unknown, 2)


ROUNDED = two_media(
    "Interface: upwind1 ssprk3, order 2",
    'lam = { role = "cfl", default = "5/4" }',
    'space = "upwind1"\ntime = "ssprk3"',
    closure_lines(
        ghost_equations(2),
        {
            "u_I": f"(1000000/1000001)*({side('u', 'L')} + {side('s', 'L')} - {side('s', 'R')})"
            f" + (1/1000001)*{side('u', 'R')}",
            "s_I": f"(1000000/1000001)*{side('s', 'L')}"
            f" + (1/1000001)*({side('s', 'R')} + {side('u', 'R')} - {side('u', 'L')})",
        },
    ),
    (UNIT, ("-1000000", "-1/1000000")),
)


def test_rounding_a_matrix_is_no_evidence_of_growth() -> None:
    """Seed 2026, scheme of 20 000: with media 1 : 1e-6 the finite problem's matrix, of norm 2e6, has an eigenvalue
    1.0012 in doubles at any number of cells. Changing its entries by a rounding error each changes that in the fifth
    digit: it is the generalized eigenvalue z = 1, defective, that has been split."""
    scheme = parse_scheme(ROUNDED, "rounded")
    values = scheme.values({})
    assert quick_verdict(scheme, values) is Verdict.GENERALIZED
    matrix = update_matrix(scheme, values, 10)
    noise = np.random.default_rng(1).uniform(-1, 1, (4, *matrix.shape)) * np.finfo(float).eps
    radii = [np.abs(np.linalg.eigvals(matrix * (1 + each))).max() for each in noise]
    assert np.ptp(radii) > 1e-6
    assert settled_radius(scheme, values) is None
