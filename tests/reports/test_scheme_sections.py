"""What a scheme's page says where there is little to say, or less than one would like."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from gks.catalogue import find
from gks.reports import steps
from gks.reports.document import Strong
from gks.reports.formulas import plain
from gks.reports.markdown import markdown, text_markdown
from gks.reports.report import write
from gks.reports.scheme_answers import stated
from gks.reports.scheme_page import build
from gks.reports.scheme_plan import plan
from gks.reports.store import Store
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import LEAPFROG_OUTFLOW
from tests.reports.example import Silent

Records = dict[str, dict[str, Any]]


def records(scheme: Scheme, *names: str) -> Records:
    """The records of these steps of the scheme's report."""
    wanted = {step.name: step for step in plan(scheme) if step.name in names}
    found: Records = {}
    for name in names:
        step = wanted[name]
        result = getattr(steps, name)(scheme, **step.arguments)
        given = {"kind": step.kind, "arguments": dict(step.arguments), "scheme": scheme.name, "command": step.command}
        found[name] = {**given, "result": result, "seconds": 0.0}
    return found


def page(scheme: Scheme, given: Mapping[str, Mapping[str, Any]]) -> str:
    """Its page from these records alone."""
    return markdown(build(scheme, "page", given))


def leapfrog(closure: str) -> Scheme:
    return parse_scheme(LEAPFROG_OUTFLOW.replace("u[0, n+1] = u[1, n]", closure), "page")


def test_a_closure_that_does_not_determine_the_next_level_has_a_mode_at_infinity() -> None:
    scheme = leapfrog("(2*lam - 1)*u[0, n+1] = u[1, n]")
    given = records(scheme, "modes", "profile")
    assert given["modes"]["result"]["modes"][0]["z"] == "oo"
    text = page(scheme, given)
    assert "**unstable**: the closure does not determine the next time level" in text
    assert "The admissible one of largest modulus is growing, with modulus ∞." in text
    assert "| ∞ | ∞ | 1 | growing |" in text
    assert "mode of largest finite modulus" in text


def test_a_march_that_could_not_have_disagreed_does_not_agree() -> None:
    scheme = find("leapfrog-oblique-1")
    given = records(scheme, "march")
    assert given["march"]["result"]["agrees"]
    assert not given["march"]["result"]["told"]
    text = page(scheme, given)
    assert "| a march | **not contradicted**: the march cannot tell" in text
    assert "| comparison | **not contradicted**: the march cannot tell" in text
    assert "agrees" not in text


def test_a_march_says_what_its_agreement_rests_on() -> None:
    scheme = find("crank-nicolson-box")
    text = page(scheme, records(scheme, "march"))
    assert text.count("**agrees**: no mode was predicted, and random data do not grow") == 2


@pytest.fixture(scope="module")
def unequal() -> Records:
    return records(find("weighted-2-unequal"), "theorem", "curve")


def test_a_theorem_and_a_curve_say_which_values_they_are_for(unequal: Records) -> None:
    text = page(find("weighted-2-unequal"), unequal)
    assert "With $c = 2$: **stable exactly for**" in text
    assert "below which all are stable, at $c = 2$ (proved for the whole range below)." in text


def test_nothing_is_proved_by_a_certificate_that_was_rejected(unequal: Records) -> None:
    theorem = unequal["theorem"]
    checked = {"accepted": False, "problem": "a sign is wrong"}
    rejected = {**unequal, "theorem": {**theorem, "result": {**theorem["result"], "checked": checked}}}
    text = page(find("weighted-2-unequal"), rejected)
    assert "**not proved**; see [the theorem](#theorem)" in text
    assert "**Not proved**: the certificate was rejected" in text
    assert "a sign is wrong" in text
    assert "table exactly for" not in text
    assert "(121 of 121 points resolved)" in text


def test_the_verdict_on_a_bound_keeps_its_reserve(unequal: Records) -> None:
    theorem = unequal["theorem"]
    pieces = [{**piece, "reserve": " (at isolated values perhaps neutral)"} for piece in theorem["result"]["pieces"]]
    given = {"theorem": {**theorem, "result": {**theorem["result"], "pieces": pieces}}}
    assert "| stable (at isolated values perhaps neutral) |" in page(find("weighted-2-unequal"), given)


def test_the_end_of_a_piece_equals_its_decimal_or_is_near_it(unequal: Records) -> None:
    theorem = unequal["theorem"]
    (piece,) = theorem["result"]["pieces"]
    ends = {"from": "1/8", "from_value": 0.125, "to": "1/3", "to_value": 1 / 3}
    given = {"theorem": {**theorem, "result": {**theorem["result"], "pieces": [{**piece, **ends}]}}}
    text = page(find("weighted-2-unequal"), given)
    assert r"| $\frac{1}{8}$ = 0.125 | $\frac{1}{3}$ ≈ 0.333333 |" in text


def test_a_title_may_have_several_lines() -> None:
    text = LEAPFROG_OUTFLOW.replace("Leapfrog, outflow by oblique extrapolation", "Leap\\nfrog")
    assert page(parse_scheme(text, "page"), {}).startswith("# Leap frog\n")
    rows, tails = stated(
        "Leap\nfrog: stable exactly for\n  0 < lam < 1  if 0 < a; at lam = 1: neutral\n  no lam  if a = 0"
    )
    assert [plain(what) for what, _ in rows] == ["0 < λ < 1", "no λ"]
    assert tails == []


def test_a_table_of_many_roots_says_that_it_is_not_all_of_them() -> None:
    wide = LEAPFROG_OUTFLOW.replace("u[i, n-1] + lam*(u[i+1] - u[i-1])", "(1 + lam)/2*u[i+1] + (1 - lam)/2*u[i-1]")
    scheme = parse_scheme(wide.replace("= u[1, n]", "= 1/2*u[1, n] + 1/3*u[45, n] - 1/5*u[3, n-1]"), "page")
    given = records(scheme, "modes")
    count = len(given["modes"]["result"]["modes"])
    assert count > 40
    text = page(scheme, given)
    assert f"The first 40 of {count} roots, each as a double." in text


def test_a_page_without_a_single_result_is_a_page() -> None:
    scheme = leapfrog("u[0, n+1] = u[1, n]")
    refused = {
        step.name: {"kind": step.kind, "arguments": {}, "refused": "no time", "seconds": 1.0} for step in plan(scheme)
    }
    text = page(scheme, refused)
    assert "Not analysed: no time." in text
    assert "Not proved: no time." in text


def test_a_picture_that_took_too_long_elsewhere_is_on_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    late = {"refused": "it took over 60 s", "over_limit": True}
    monkeypatch.setattr("gks.reports.report.computed", lambda steps, *_: {step.name: late for step in steps})
    report = build(leapfrog("u[0, n+1] = u[1, n]"), "page", {})
    (path,) = write(report, str(tmp_path), ("html",), Store(str(tmp_path)), Silent())
    assert Path(path).read_text(encoding="utf-8").count("<svg") == 1


def test_strong_words_of_markdown_keep_white_space_outside() -> None:
    assert text_markdown((Strong("The ratio. "), "It is")) == "**The ratio.** It is"
    assert text_markdown(("a", Strong(" b*"))) == r"a **b\***"
