"""The fuzz campaign: the same schemes whoever draws them, a planted fault found and shrunk, real verdicts confirmed."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

import pytest

from gks.campaigns import routes
from gks.campaigns.conduct import Conduct
from gks.campaigns.draw import INTERIORS, Draft, Interior
from gks.campaigns.fuzz import CHUNK, fuzz, fuzz_chunk
from gks.campaigns.routes import AGREES, OPEN, Check, judge, settled_radius
from gks.campaigns.search import drawn
from gks.errors import InputError
from gks.modes import analyse
from gks.modes.algebraic import Root
from gks.modes.analysis import quick_verdict
from gks.modes.interior import interior_limits
from gks.modes.kreiss import spatial_problem
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.campaigns.command import ROOT, run


def interface(interior: Interior, order: int, *numbers: str | int | Fraction) -> Draft:
    """ratio, speed, a, b, x, y and lam as numbers."""
    ratio, speed, a, b, x, y, lam = (Fraction(number) for number in numbers)
    return Draft(interior, order, ratio, speed, a, b, x, y, lam)


def traditional(ratio: str, lam: str = "9/10") -> Draft:
    """Velocity from the left, stress from the right: (3.6) of Banks & Sjögreen."""
    return interface(INTERIORS[0], 1, ratio, 1, 1, 0, 0, 0, lam)


# Drawing --------------------------------------------------------------------------------------------------------------


def test_draws_are_a_function_of_seed_and_chunk() -> None:
    assert drawn(3, 0, 30) == drawn(3, 0, 30)
    assert drawn(3, 0, 30) != drawn(4, 0, 30)
    assert drawn(3, 0, 30) != drawn(3, 1, 30)


def test_draws_do_not_depend_on_the_process() -> None:
    code = "from gks.campaigns.search import drawn; print([d.text() for d in drawn(3, 7, 20)])"
    found = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert found.stdout.strip() == str([draft.text() for draft in drawn(3, 7, 20)])


def test_drafts_are_different_and_as_many_as_asked_for() -> None:
    found = drawn(1, 0, CHUNK)
    assert len(set(found)) == len(found) == CHUNK
    assert len({draft.interior for draft in found}) > 8
    assert {draft.order for draft in found} == {1, 2}


@pytest.mark.parametrize("interior", INTERIORS, ids=lambda each: each.name)
def test_interiors_are_cauchy_stable_up_to_the_limit_drawn(interior: Interior) -> None:
    draft = interface(interior, 1, 2, 1, 1, 0, 0, 0, interior.limit)
    scheme = parse_scheme(draft.text(), "draft")
    for each in interior_limits(spatial_problem(scheme, scheme.values(), ("lam",))):
        assert each.contains(Root.of(interior.limit))
        assert each.contains(Root.of(interior.limit / 100))


def test_a_draft_says_what_it_is_in_a_scheme_file() -> None:
    scheme = parse_scheme(traditional("31/9").text('found by "fuzz"'), "draft")
    assert scheme.title == "Interface: upwind1 forward-euler, order 1"
    assert scheme.notes == "found by fuzz"
    assert [equation.text for equation in scheme.closure.equations][2:] == ["R.u[-1] = u_I", "R.s[-1] = s_I"]


# Judging --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ratio", "verdict", "full"),
    [("31/9", "neutral", False), ("4", "unstable", False), ("3", "stable", True)],
)
def test_theorem_3_1_is_confirmed(ratio: str, verdict: str, full: bool) -> None:
    """Stable for lam < min(1, 4/(1 + alpha)), alpha the ratio of the densities; here lam = 9/10."""
    found = judge(traditional(ratio))
    assert (found.verdict, found.failed, found.confirmed) == (verdict, None, True)
    assert (found.full_range is True) == full


def test_a_settled_radius_is_that_of_the_mode() -> None:
    """4 r**2 - 4 r + alpha + 1 = 0 and z = 1 + lam (r - 1): z = 1 - lam/2 +- i lam sqrt(alpha)/2."""
    scheme = parse_scheme(traditional("9", "1/2").text(), "draft")
    assert settled_radius(scheme, scheme.values()) == pytest.approx(abs(complex(3 / 4, 3 / 4)), rel=1e-9)


def test_nothing_is_settled_where_waves_run_to_and_fro() -> None:
    leapfrog = next(each for each in INTERIORS if each.name == "central2 leapfrog")
    draft = interface(leapfrog, 1, 5, 1, "1/4", "-1", "1/4", 0, "57/80")
    scheme = parse_scheme(draft.text(), "draft")
    radius = settled_radius(scheme, scheme.values())
    assert radius is None or radius > 1 + routes.OUTSIDE


def test_a_generalized_eigenvalue_that_no_spectrum_shows_is_met_by_forcing() -> None:
    """Leapfrog on equal media with u_I and s_I both from the left: bounded, but not where it is forced at its own z."""
    leapfrog = next(each for each in INTERIORS if each.name == "central2 leapfrog")
    draft = interface(leapfrog, 1, 1, 1, 1, 1, 0, 0, "19/40")
    assert judge(draft, only="spectrum").checks == {"spectrum": OPEN}
    found = judge(draft, only="mode")
    assert (found.verdict, found.checks) == ("generalized", {"mode": AGREES})


# A fault is found and shrunk ------------------------------------------------------------------------------------------


def test_a_wrong_verdict_is_found_and_shrunk_to_a_minimal_scheme(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fault planted: what is unstable at second order is said to be neutral."""
    right = quick_verdict

    def faulty(scheme: Scheme, values: Mapping[str, Fraction]) -> Verdict:
        found = right(scheme, values)
        return Verdict.NEUTRAL if found is Verdict.UNSTABLE and "order 2" in scheme.title else found

    monkeypatch.setattr(routes, "quick_verdict", faulty)
    found = fuzz_chunk(11, 0, 15)["disagreements"]
    assert {each["check"] for each in found} == {"spectrum"}
    (text,) = {each["scheme"] for each in found}
    least = parse_scheme(text, "least")
    assert least.title == "Interface: upwind1 forward-euler, order 2"
    assert least.notes.startswith("exact route: neutral. spectrum: neutral, but the finite problem grows by ")
    assert right(least, least.values()) is Verdict.UNSTABLE


def test_a_crash_is_found_and_shrunk(monkeypatch: pytest.MonkeyPatch) -> None:
    def crashing(scheme: Scheme, values: Mapping[str, Fraction]) -> Verdict:
        if "order 2" in scheme.title:
            raise ZeroDivisionError("planted")
        return Verdict.UNDECIDED

    monkeypatch.setattr(routes, "quick_verdict", crashing)
    found = fuzz_chunk(11, 0, 25)["disagreements"]
    assert {(each["check"], each["found"]) for each in found} == {("crash", "ZeroDivisionError: planted")}
    (least,) = {each["scheme"] for each in found}
    # Simplest in every table: the first interior, equal media, a = b = 1, no cross weights, half the limit.
    simplest = interface(INTERIORS[0], 2, 1, 1, 1, 1, 0, 0, "1/2")
    assert least == simplest.text("exact route: crashed. crash: ZeroDivisionError: planted.")


@pytest.mark.parametrize("check", ["spectrum", "count", "march"])
def test_every_second_route_says_no_to_a_wrong_verdict(check: Check, monkeypatch: pytest.MonkeyPatch) -> None:
    stable = parse_scheme(traditional("1").text(), "draft")
    assert judge(traditional("100"), only=check).failed is None
    monkeypatch.setattr(routes, "quick_verdict", lambda *_: Verdict.STABLE)
    if check == "march":  # it is held against the modes and not the verdict: they are those of the stable one
        others = analyse(stable, stable.values())
        monkeypatch.setattr("gks.modes.analyse", lambda *_: others)
    assert judge(traditional("100"), only=check).failed == check


def test_a_check_that_breaks_down_is_a_disagreement(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> float:
        raise ValueError("infs or NaNs")

    monkeypatch.setattr(routes, "settled_radius", broken)
    found = judge(traditional("1"))
    assert (found.failed, found.checks["spectrum"]) == ("spectrum", "ValueError: infs or NaNs")


def test_the_stable_set_says_no_to_a_wrong_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(routes, "quick_verdict", lambda *_: Verdict.UNSTABLE)
    assert judge(traditional("1"), only="stable set").failed == "stable set"


# The campaign ---------------------------------------------------------------------------------------------------------


def test_the_result_is_the_same_with_any_workers_and_from_a_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gks.campaigns.fuzz.CHUNK", 5)
    results, place = [], tmp_path / "chunks"
    for jobs, resume in ((1, place), (2, None), (1, place)):
        conduct = Conduct(jobs=jobs, resume=None if resume is None else str(resume))
        results.append(json.dumps(fuzz(12, 5, conduct).to_json()))
        (place / "00000001.json").write_text("torn")
    assert results[0] == results[1] == results[2]
    found = json.loads(results[0])
    assert (found["schema"], found["schemes"], found["disagreements"]) == ("gks.fuzz/1", 12, [])
    assert sum(found["verdicts"].values()) == 12
    assert not {"refused", "crashed"} & set(found["verdicts"])
    assert not found["unconfirmed"]
    assert found["full_range"]


def test_the_command_prints_progress_apart_and_writes_what_it_is_asked_for(tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    status, printed, error = run("fuzz", "--count", "12", "--seed", "3", "-o", str(out), "--save", str(tmp_path))
    assert (status, printed) == (0, f"{out}\n")
    assert "12 of 12 schemes, " in error
    assert json.loads(out.read_text())["schemes"] == 12
    assert [file.name for file in tmp_path.iterdir()] == ["out.json"]


def test_without_hypothesis_the_command_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "hypothesis", None)
    with pytest.raises(InputError, match=r"gks-stability\[fuzz\]"):
        fuzz(1, 0, Conduct())
