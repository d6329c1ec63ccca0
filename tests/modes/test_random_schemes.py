"""Random closures over known interiors: the exact verdict against the spectrum of the finite update matrix.

Eigenvalues outside the circle of a truncated problem converge geometrically to the growing modes; what does not
converge is
the spectrum of the truncated interior, whose excess over 1 fades with the number of cells.
"""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, assume, given, settings

from gks.errors import InputError
from gks.modes import ModesResult, Verdict, analyse
from gks.scheme.model import Scheme
from tests.oracle.finite_matrix import largest_modulus
from tests.strategies import Draft, interface_drafts, scalar_drafts

QUIET = [HealthCheck.too_slow, HealthCheck.filter_too_much, HealthCheck.data_too_large]


def examples(share: float) -> settings:
    """That share of the examples of the profile that is loaded."""
    return settings(max_examples=max(1, int(share * settings.default.max_examples)), suppress_health_check=QUIET)  # type: ignore[union-attr]


def judged(draft: Draft) -> tuple[Scheme, ModesResult]:
    scheme = draft.scheme()
    try:
        return scheme, analyse(scheme, scheme.values({}))
    except InputError:
        assume(False)
        raise


def growing(found: ModesResult) -> float:
    """The largest modulus outside the circle, 1 where none is."""
    return max((float(m.modulus) for m in found.modes if m.kind.value == "growing"), default=1.0)


def agree(draft: Draft, cells: int) -> None:
    scheme, found = judged(draft)
    assert found.reason != "interior", "the interiors drawn are Cauchy-stable"
    assert found.verdict is not Verdict.UNDECIDED
    if not found.solvable:
        return
    predicted = growing(found)
    assert (found.verdict is Verdict.UNSTABLE) == (predicted > 1)
    coarse, fine = (largest_modulus(scheme, scheme.values({}), n) for n in (cells, 2 * cells))
    settled = abs(coarse - fine) < 1e-8 * fine
    if predicted == 1:
        # What settles outside is a mode. (A Jordan block on the circle splits by the root of the rounding.)
        assert not (settled and fine > 1 + 1e-4)
    elif settled:
        assert np.isclose(fine, predicted, rtol=1e-5)
    else:
        # A mode that hardly decays in space is seen late, but from more cells it is never further away.
        assert predicted < 1.1 or abs(fine - predicted) < abs(coarse - predicted) + 1e-8


@given(scalar_drafts())
@examples(1.0)
def test_one_half_line(draft: Draft) -> None:
    agree(draft, 24)


@given(interface_drafts())
@examples(0.5)
def test_an_interface(draft: Draft) -> None:
    agree(draft, 10)
