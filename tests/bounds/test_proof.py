"""Theorems: the paper's bounds come out, agree with exact verdicts at any point, and evaluate to the last digits."""

from __future__ import annotations

import os
from fractions import Fraction

import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from gks import catalogue
from gks.api import load
from gks.bounds.cfl import stable_set
from gks.bounds.curve import curve
from gks.bounds.pointverdict import verdict_at
from gks.bounds.proof import prove
from gks.bounds.proving import checked_region, prove_here
from gks.bounds.sweep import of_values
from gks.bounds.theorem import Piece, Theorem
from gks.catalogue import find
from gks.errors import ParameterError
from gks.modes.analysis import analyse
from gks.modes.numerals import exact_fraction
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import (
    BACKWARD_EULER,
    CRANK_NICOLSON,
    LAX_WENDROFF,
    LEAPFROG,
    LEAPFROG_OUTFLOW,
    advection_interface,
    half_line,
    interface,
    upwind_flux,
    upwind_interface,
    weighted_interface,
)
from tests.examples import examples


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


@pytest.mark.parametrize("name", [*PAPER, "traditional-2", "traditional-1-mirror", "characteristic-1"])
def test_bounds_are_the_curve_s_at_a_thousand_values_over_twenty_decades(name: str) -> None:
    scheme = find(name)
    values = [float(v) for v in 10.0 ** np.random.default_rng(1).uniform(-10, 10, 1000)]
    swept = curve(scheme, scheme.values({}), of_values("alpha", [Fraction(v) for v in values]))
    assert np.allclose(theorem(scheme).bound(values), swept.lam_max, rtol=1e-12, atol=0)


RANGES = {
    ("1e-4", "1e4"): [("1/10000", "3", "1"), ("3", "10000", "4/(alpha + 1)")],
    ("1", "3"): [("1", "3", "1")],
    ("-5", "-1"): [("-5", "-1", "0")],
    ("-2", "7"): [
        ("-2", "-1", "0"),
        ("-1", "0", "1"),
        ("0", "0", "0"),
        ("0", "3", "1"),
        ("3", "7", "4/(alpha + 1)"),
    ],
    ("-inf", "0"): [("-oo", "-1", "0"), ("-1", "0", "1")],
}


@pytest.mark.parametrize("ends", RANGES)
def test_a_theorem_speaks_of_exactly_the_range(ends: tuple[str, str]) -> None:
    found = theorem(upwind_interface(*ends))
    stated = [(p["from"], p["to"], p["bound"]) for p in (piece.to_json() for piece in found.pieces)]
    assert [each for each in stated if each != ("-1", "-1", "0")] == RANGES[ends]
    assert not found.limits


def test_bounds_that_fall_off_are_told_at_both_infinite_ends() -> None:
    scheme = upwind_interface(
        "0", "inf", "t*L.u[0] + (1 - t)*R.u[0]", "t*R.s[0] + (1 - t)*L.s[0]", "t = {range = [-inf, inf]}"
    )
    found = theorem(scheme, alpha="3")
    assert [text for text, _ in found.limits] == [
        "the bound ~ 3/(4*t**2) as t -> -oo",
        "the bound ~ 3/(4*t**2) as t -> oo",
    ]
    assert "alpha = 3: stable exactly for" in found.statement


def test_where_two_bounds_meet_the_mode_on_them_is_its_own() -> None:
    found = theorem(find("traditional-1"))
    assert [p.to_json()["at_bound_except"] for p in found.pieces] == [[["3", "generalized"]]] * 2
    values = {"alpha": Fraction(3), "lam": Fraction(1)}
    assert analyse(found.scheme, found.scheme.values(values)).verdict is Verdict.GENERALIZED
    assert "at lam = 1: stable, generalized at alpha = 3" in found.statement


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
        "at_bound_except": [],
        "stable_set": [["0", "1"]],
        "closed_form": True,
    }


def test_setting_the_parameter_leaves_the_stable_set_there() -> None:
    (piece,) = theorem(find("traditional-1"), alpha="31/9").pieces
    assert (piece.bound.text, piece.at_bound) == ("9/10", "neutral")


@pytest.mark.parametrize(
    ("name", "alpha", "limit"), [("traditional-2", "1e20", Fraction(20, 27)), ("average-1", "1e300", Fraction(16))]
)
def test_ratios_far_beyond_double_precision_are_proved_as_well(name: str, alpha: str, limit: Fraction) -> None:
    """lam_max alpha -> 20/27 and 16; nested roots cancel to three times as many digits as alpha has."""
    found = theorem(find(name), alpha=alpha)
    assert found.proved, found.reason
    product = sympy.sympify(found.pieces[0].bound.text) * sympy.Rational(alpha)
    assert abs(sympy.N(product, 30, maxn=2000) - sympy.Rational(str(limit))) < 1e-15


SCHEMES = int(os.environ.get("GKS_SCHEMES", "200"))
"""Random schemes with a weighted interface; more of them for a thorough run."""

WEIGHTS = st.fractions(-2, 2, max_denominator=2)
PLACES = st.fractions(Fraction(1, 20), 50, max_denominator=20)


@examples(SCHEMES)
@given(weights=st.tuples(*[WEIGHTS] * 4), place=PLACES, share=st.fractions(Fraction(1, 9), 2, max_denominator=9))
def test_any_interface_weights_agree_with_the_modes_on_and_off_the_bound(
    weights: tuple[Fraction, ...], place: Fraction, share: Fraction
) -> None:
    agrees_with_the_modes(advection_interface(weights), "p", place, share)


@examples(SCHEMES // 40)
@given(weights=st.tuples(*[WEIGHTS] * 6), place=PLACES, share=st.fractions(Fraction(1, 9), 2, max_denominator=9))
def test_any_weights_between_media_agree_with_the_modes_on_and_off_the_bound(
    weights: tuple[Fraction, ...], place: Fraction, share: Fraction
) -> None:
    agrees_with_the_modes(weighted_interface(weights), "alpha", place, share)


def agrees_with_the_modes(scheme: Scheme, name: str, place: Fraction, share: Fraction) -> None:
    """At a value of the parameter: lam a share of the bound, and the bound itself where it is rational."""
    found = theorem(scheme)
    assert found.proved, found.reason
    exact = stable_set(scheme, scheme.values({name: place}))
    top = exact.lam_max
    bound = float(found.bound([float(place)])[0])
    if top is None:
        assert bound == np.inf
        return
    assert bound == pytest.approx(float(exact_fraction(top.ball().real)), rel=1e-12, abs=0)
    piece = next(p for p in sorted(found.pieces, key=lambda p: not p.is_point) if _holds(p, place))
    lam = Fraction(bound).limit_denominator(1000) * share
    if bound > 0.01 and (share < 1 or (share > 1 and len(piece.stable_set) < 2)):
        assert (verdict_at(scheme, scheme.values({name: place, "lam": lam})) is Verdict.STABLE) is (share < 1)
    if top.rational:
        exceptions = {edge.text: told for edge, told in piece.exceptions}
        told = analyse(scheme, scheme.values({name: place, "lam": top.rational})).verdict.value
        assert told == exceptions.get(str(place), piece.at_bound)


def _holds(piece: Piece, value: Fraction) -> bool:
    """Where two pieces meet both hold, unless a piece of one value stands between them."""
    assert piece.start is not None
    assert piece.end is not None
    start, end = (float(str(edge.value).replace("oo", "inf")) for edge in (piece.start, piece.end))
    return start <= value <= end


HALF_LINES = {
    (BACKWARD_EULER, "u[0] + a*(u[1] - u[0])"): ["oo", "-a*(a - 2)/(a - 1)", "0"],
    (BACKWARD_EULER, "u[0] + a*lam*(u[1] - u[0])"): ["(2*a + 1)/(a*(a + 1))"],
    (CRANK_NICOLSON, "a*u[1]"): ["oo", "2", "4*a/(a**2 + 1)"],
    (LEAPFROG, "a*u[1]"): ["1", "2*a/(a**2 + 1)"],
    (LAX_WENDROFF, "u[0] + a*lam*(u[1] - u[0])"): ["1", "(2*a - 1)/(a**2 - a + 1)"],
}


@pytest.mark.parametrize(("interior", "closure"), HALF_LINES)
def test_one_boundary_with_a_weight(interior: str, closure: str) -> None:
    found = checked_region(half_line(interior, closure), {}).theorem
    assert found.proved, found.reason
    bounds = [piece.bound.text for piece in found.pieces]
    assert [b for k, b in enumerate(bounds) if k == 0 or b != bounds[k - 1]] == HALF_LINES[interior, closure]


def test_a_stable_set_need_not_begin_at_zero_nor_be_one_interval() -> None:
    found = checked_region(half_line(LAX_WENDROFF, "u[1]/(a - 1)"), {}).theorem
    assert found.proved, found.reason
    first, degenerate, two, split, one = found.pieces
    assert first.to_json()["stable_set"] == [["-a/(a - 2)", "1"]]
    assert (first.bound.text, degenerate.stable_set) == ("0", ())
    assert len(two.stable_set) == 2
    middle = "(sqrt(6) - sqrt(2))/2"
    assert split.to_json()["stable_set"] == [["0", middle], [middle, "1"]]
    assert one.to_json()["stable_set"] == [["0", "1"]]


def test_a_wave_speed_may_change_its_sign_with_the_parameter() -> None:
    found = checked_region(upwind_flux("a"), {}).theorem
    assert found.proved, found.reason
    assert [(p["from"], p["to"], p["bound"]) for p in (each.to_json() for each in found.pieces)] == [
        ("-oo", "0", "-1/a"),
        ("0", "0", "oo"),
        ("0", "oo", "0"),
    ]


def test_a_wave_speed_may_change_its_sign_with_lam() -> None:
    """Outflow while lam < a, stable up to lam*(a - lam) = 1; inflow above, where the closure feeds the mode z = 1."""
    found = checked_region(upwind_flux("lam - a"), {}).theorem
    assert found.proved, found.reason
    sets = [(p["from"], p["stable_set"]) for p in (each.to_json() for each in found.pieces)]
    low, high = "(a - sqrt(a**2 - 4))/2", "(a + sqrt(a**2 - 4))/2"
    assert [each for each in sets if each[1]] == [
        ("0", [["0", "a"]]),
        ("2", [["0", "2"]]),
        ("2", [["0", low], [high, "a"]]),
    ]
    assert found.bound([1.0, 2.0, 2.5]).tolist() == [1.0, 2.0, 0.5]


WIDE = ("lax-wendroff-order-6-oblique", "lax-wendroff-order-8-oblique", "sbp-4-interface")
"""Shipped schemes beyond an exact elimination in seconds."""


@pytest.mark.parametrize("name", [name for name in catalogue.names() if name not in WIDE])
def test_every_shipped_scheme_of_a_narrow_stencil_has_a_theorem(name: str) -> None:
    found = checked_region(find(name), {}).theorem
    assert found.proved, found.reason
    assert Verdict.UNDECIDED.value not in [piece.at_bound for piece in found.pieces]


def test_what_the_check_does_not_reach_is_not_said_to_be_proved() -> None:
    found = checked_region(half_line(LAX_WENDROFF, "u[0] + sqrt(2)*a*lam*(u[1] - u[0])"), {}).theorem
    assert not found.proved
    assert "not accepted by the check: irrational numbers" in str(found.reason)


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


def test_the_cfl_number_takes_no_value_in_a_theorem() -> None:
    with pytest.raises(ParameterError, match=r"^lam: it is what the theorem bounds; leave it out$"):
        load("traditional-1").prove(lam="1/7")


def test_prove_in_its_own_process_gives_the_same() -> None:
    stages: list[str] = []
    found = prove(find("traditional-1"), {}, limit=60, progress=stages.append)
    assert found == theorem(find("traditional-1"))
    assert "formulas" in stages
