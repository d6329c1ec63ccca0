"""Predicted beside observed growth over random schemes: they agree wherever a mode is admissible, growing or decaying.

Where none is admissible nothing is claimed, and random data do not grow.
"""

from __future__ import annotations

import json
from fractions import Fraction

import pytest
from hypothesis import given

from gks.catalogue import find, names
from gks.errors import NotAnalysable
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.march import MarchResult, march
from tests.examples import examples
from tests.oracle.scheme_texts import constructs
from tests.solvers.random_interfaces import interface_texts
from tests.strategies import Draft, scalar_drafts

STEPS = 128


def marched(scheme: Scheme) -> MarchResult | None:
    """None where the closure does not determine the next level at these parameters, which is no disagreement."""
    try:
        return march(scheme, scheme.values({}), steps=STEPS)
    except NotAnalysable as refused:
        assert "do not determine" in str(refused)
        return None


def explained(found: MarchResult | None) -> None:
    """Agreement to 1e-3 or the uncertainty stated; silence where nothing was predicted; or the reason in words."""
    if found is None:
        return
    assert found.agrees, str(found)
    if found.predicted is None:
        assert found.relative_difference is None
    elif "cannot tell" not in found.remark:
        difference = abs(found.observed - found.predicted)
        assert difference <= max(found.uncertainty, 1e-3 * found.predicted), str(found)


@given(text=interface_texts())
@examples(300)
def test_random_interface_weights(text: str) -> None:
    explained(marched(parse_scheme(text, "random")))


@given(text=interface_texts(fastest=10_000))
@examples(15)
def test_wave_speeds_far_apart(text: str) -> None:
    explained(marched(parse_scheme(text, "random")))


@given(draft=scalar_drafts())
@examples(40)
def test_random_boundary_closures(draft: Draft) -> None:
    explained(marched(draft.scheme()))


@pytest.mark.parametrize("name", names())
def test_every_shipped_scheme(name: str) -> None:
    explained(marched(find(name)))


@pytest.mark.parametrize("name", constructs())
def test_every_construct_of_the_format(name: str) -> None:
    """What is printed is JSON without NaN or infinities, wherever there is something to march."""
    found = marched_or_refused(constructs()[name])
    if found is None:
        assert name in ("mixed integrators", "lines beside a discrete scheme")
        return
    explained(found)
    assert json.loads(json.dumps(found.to_json(), allow_nan=False))["agrees"] is True


def marched_or_refused(scheme: Scheme) -> MarchResult | None:
    """None where one half-line reads at its stages what the other never computes."""
    try:
        return march(scheme, scheme.values({}), steps=STEPS)
    except NotAnalysable as refused:
        assert "never computes" in str(refused)
        return None


def test_both_growing_and_decaying_modes_are_met() -> None:
    """The same weights on either side of neutral: the traditional coupling at alpha = 31/9 (1 ± 1/10)."""
    for alpha, side in (("31/10", -1), ("341/90", 1)):
        scheme = find("traditional-1")
        found = march(scheme, scheme.values({"alpha": alpha, "lam": Fraction(9, 10)}))
        assert found.predicted is not None and (found.predicted - 1) * side > 0 and (found.observed - 1) * side > 0
