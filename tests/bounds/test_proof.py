"""Theorems: the paper's bounds come out, agree with exact verdicts at any point, and evaluate to the last digits."""

from __future__ import annotations

import os
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gks.bounds.cfl import stable_set
from gks.bounds.curve import curve
from gks.bounds.proof import prove, prove_here
from gks.bounds.sweep import of_values
from gks.bounds.theorem import Theorem
from gks.catalogue import find
from gks.modes.algebraic import Root
from gks.modes.analysis import analyse
from gks.modes.numerals import exact_fraction
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import LEAPFROG_OUTFLOW, interface, weighted_interface


def theorem(scheme: Scheme, **values: str) -> Theorem:
    return prove_here(scheme, {n: Fraction(v) for n, v in values.items()}, lambda stage: None)


PAPER = {
    "traditional-1": [("0", "3", "1", "stable"), ("3", "oo", "4/(alpha + 1)", "neutral")],
    "weighted-1": [("0", "oo", "1", "stable")],
    "weighted-2": [("0", "oo", "1", "stable")],
    "implicit-1": [("0", "oo", "oo", None)],
    "weighted-1-unequal": [("0", "oo", "1/2", "stable")],
    "weighted-2-unequal": [("0", "oo", "1/2", "stable")],
    "average-1": [
        ("0", "7 - 4*sqrt(3)", "16*alpha/(alpha + 1)**2", "neutral"),
        ("7 - 4*sqrt(3)", "7 + 4*sqrt(3)", "1", "stable"),
        ("7 + 4*sqrt(3)", "oo", "16*alpha/(alpha + 1)**2", "neutral"),
    ],
}


@pytest.mark.parametrize("name", PAPER)
def test_what_the_paper_s_schemes_prove(name: str) -> None:
    pieces = [p.to_json() for p in theorem(find(name)).pieces]
    assert [(p["from"], p["to"], p["bound"], p["at_bound"]) for p in pieces] == PAPER[name]


def test_the_second_order_theorem_has_nested_roots_and_an_exact_end() -> None:
    found = theorem(find("traditional-2"))
    first, second = found.pieces
    assert first.end is not None
    assert first.end.text == "sqrt(17) - 4"
    assert second.bound.text == (
        "3/2 - sqrt(18*alpha**2 + 4*alpha - 14 + 2*(alpha + 1)*sqrt(81*alpha**2 + 130*alpha + 49))/(4*(alpha + 1))"
    )
    assert found.limits[0][0] == "the bound ~ 20/(27*alpha) as alpha -> oo"


def test_a_bound_that_cancels_as_printed_is_evaluated_to_the_last_digits() -> None:
    bound = theorem(find("traditional-2")).bound
    assert bound([1e10])[0] == 7.407407406856882e-11
    assert bound([1e300])[0] == pytest.approx(20 / 27 * 1e-300, rel=1e-15)


@pytest.mark.parametrize("name", ["traditional-1", "traditional-2", "average-1"])
def test_bounds_are_the_curve_s(name: str) -> None:
    scheme = find(name)
    values = [float(v) for v in 10.0 ** np.random.default_rng(1).uniform(-10, 10, 300)]
    swept = curve(scheme, scheme.values({}), of_values("alpha", [Fraction(v) for v in values]))
    assert np.allclose(theorem(scheme).bound(values), swept.lam_max, rtol=1e-12, atol=0)


def test_the_wide_interface_is_stable_below_a_ratio_of_three_and_nowhere_on_it() -> None:
    found = theorem(interface("lax-wendroff"))
    assert [(p.bound.text, p.is_point) for p in found.pieces] == [("1", False), ("0", True), ("0", False)]
    assert found.bound([2.999, 3.0, 3.001]).tolist() == [1.0, 0.0, 0.0]
    assert "if 3 <= alpha" in found.statement


def test_without_a_parameter_the_stable_set_in_lam() -> None:
    scheme = parse_scheme(LEAPFROG_OUTFLOW, "outflow")
    (piece,) = theorem(scheme).pieces
    assert piece.to_json() == {
        "from": None,
        "to": None,
        "from_value": None,
        "to_value": None,
        "bound": "1",
        "at_bound": "unstable",
        "stable_set": [["0", "1"]],
        "closed_form": True,
    }


def test_setting_the_parameter_leaves_the_stable_set_there() -> None:
    (piece,) = theorem(find("traditional-1"), alpha="31/9").pieces
    assert (piece.bound.text, piece.at_bound) == ("9/10", "neutral")


@settings(max_examples=int(os.environ.get("GKS_SCHEMES", "12")), deadline=None)  # GKS_SCHEMES=200 for a thorough run
@given(
    weights=st.tuples(*[st.fractions(-2, 2, max_denominator=4)] * 6),
    alpha=st.fractions(Fraction(1, 20), 50, max_denominator=20),
)
def test_any_interface_weights_agree_with_the_modes_on_and_off_the_bound(
    weights: tuple[Fraction, ...], alpha: Fraction
) -> None:
    scheme = weighted_interface(weights)
    found = theorem(scheme)
    assert found.proved, found.reason
    exact = stable_set(scheme, scheme.values({"alpha": alpha}))
    top = exact.lam_max
    bound = found.bound([float(alpha)])[0]
    if top is None:
        assert bound == np.inf
        return
    assert bound == pytest.approx(float(exact_fraction(top.ball().real)), rel=1e-12, abs=0)
    if top.rational:
        piece = next(p for p in found.pieces if _holds(p, Root.of(alpha)))
        assert analyse(scheme, scheme.values({"alpha": alpha, "lam": top.rational})).verdict.value == piece.at_bound


def _holds(piece: object, value: Root) -> bool:
    start, end = (float(str(getattr(piece, side).value).replace("oo", "inf")) for side in ("start", "end"))
    here = float(value.ball().real.mid())
    return start < here < end or start == here == end


def test_several_free_parameters_are_not_proved_and_say_so() -> None:
    text = (
        interface("lax-wendroff")
        .text.replace("[domains.L]", '[definitions]\nextra = "beta"\n[domains.L]', 1)
        .replace("alpha =", "beta = { default = 1, range = [1, 2] }\nalpha =")
    )
    found = theorem(parse_scheme(text, "two"))
    assert (found.status, found.pieces) == ("not-proved", ())
    assert "beta" in str(found.reason)


def test_a_square_root_of_the_parameter_is_not_proved_unless_it_disappears() -> None:
    text = find("traditional-1").text.replace('"-1/alpha"', '"-1/sqrt(alpha)"')
    assert "square root" in str(theorem(parse_scheme(text, "root")).reason)


def test_a_time_limit_ends_the_work_and_leaves_a_curve_or_nothing() -> None:
    found = prove(interface("lax-wendroff"), {}, limit=0.01)
    assert not found.proved
    assert "time limit" in str(found.reason)
    assert found.to_json()["status"] == "not-proved"


def test_prove_in_its_own_process_gives_the_same() -> None:
    stages: list[str] = []
    found = prove(find("traditional-1"), {}, limit=60, progress=stages.append)
    assert found == theorem(find("traditional-1"))
    assert "formulas" in stages
