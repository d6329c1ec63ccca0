"""Claims are held against derivations: each kind can hold, can fail either way, and can stay undecided."""

import json
from collections.abc import Iterator, Mapping
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.bounds.audit import Audit, Held, audit, audit_catalogue
from gks.bounds.cfl import stable_set
from gks.bounds.finding import Status
from gks.bounds.proving import checked_region
from gks.bounds.samples import open_parameters, samples
from gks.catalogue import find
from gks.errors import NotAnalysable
from gks.modes.analysis import analyse
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.examples import examples

LEAPFROG = """
title = "Leapfrog, u_t = u_x, outflow"
parameters = { lam = { role = "cfl", default = 0.5 } }
[domains.R]
side     = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"]
first    = 1
[closure]
equations = ["u[0, n+1] = %s"]
"""


@pytest.fixture(autouse=True, scope="module")
def few_values() -> Iterator[None]:
    """Hold bounds at a quarter of the values: enough for what is tested here, where wrong bounds are wrong widely."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gks.bounds.samples.SPREAD", 4)
        yield


def claiming(scheme: Scheme | str, *claims: str) -> Audit:
    """The audit of a scheme with claims of the test's own in the place of the file's."""
    text = scheme if isinstance(scheme, str) else scheme.text.partition("[[claims]]")[0]
    return audit(
        parse_scheme(text + "".join(f'\n[[claims]]\nsource = "a test"\n{claim}\n' for claim in claims), "claims.toml")
    )


def single(scheme: Scheme | str, claim: str) -> Held:
    (held,) = claiming(scheme, claim).held
    return held


FIRST, SECOND, IMPLICIT = find("traditional-1"), find("traditional-2"), find("implicit-1")

NESTED = (
    "min(1, 3/2 - sqrt(2)/4*sqrt((-7 + 2*alpha + 9*alpha**2 + sqrt((49 + 81*alpha)*(alpha + 1)**3))/(alpha + 1)**2){})"
)


# --- bounds


@pytest.mark.parametrize(
    ("scheme", "bound"),
    [(FIRST, "min(1, 4/(1 + alpha))"), (SECOND, NESTED.format("")), (find("weighted-1"), "1")],
)
def test_a_right_bound_holds_over_the_whole_range(scheme: Scheme, bound: str) -> None:
    held = single(scheme, f'bound = "{bound}"')
    assert held.status is Status.HOLDS
    assert held.finding.counterexample is None
    assert held.finding.evidence["values_undecided"] == 0
    assert held.finding.evidence["over"] == {"alpha": ["0", "oo"]}
    assert held.finding.evidence["route"] == "exact stable sets"


@pytest.mark.parametrize(
    ("scheme", "bound"),
    [(FIRST, "min(1, 4/(1 + alpha))"), (SECOND, NESTED.format("")), (find("weighted-1"), "1")],
)
def test_with_a_theorem_a_right_bound_holds_for_every_value(scheme: Scheme, bound: str) -> None:
    text = scheme.text.partition("[[claims]]")[0] + f'\n[[claims]]\nsource = "a test"\nbound = "{bound}"\n'
    (held,) = audit(parse_scheme(text, "claims.toml"), prover=checked_region).held
    assert held.status is Status.HOLDS
    assert held.finding.derived == "lam_max equals the claim for every alpha in (0, oo): proved"
    assert held.finding.evidence["route"] == "theorem"


@pytest.mark.parametrize(
    ("bound", "stable"),
    [
        ("min(1, 4/(1 + 1/alpha))", False),  # too large where alpha is large
        ("min(1/2, 4/(1 + alpha))", True),  # too small where alpha is small
        ("min(1, 4/(1 + alpha) + 1/10**30)", False),  # by less than any double shows
        ("1", False),
        ("sqrt(alpha - 1)", False),  # no value below 1, wrong above
    ],
)
def test_a_wrong_bound_fails_either_way_and_its_counterexample_shows_it(bound: str, stable: bool) -> None:
    held = single(FIRST, f'bound = "{bound}"')
    assert held.status is Status.FAILS
    example = held.finding.counterexample
    assert example is not None
    assert (analyse(FIRST, example.parameters).verdict is Verdict.STABLE) is stable


def test_the_counterexamples_lam_lies_between_claim_and_derivation() -> None:
    held = single(SECOND, f'bound = "{NESTED.format(" + 1/10**60")}"')
    assert held.finding.counterexample is not None
    values = held.finding.counterexample.parameters
    lam_max = stable_set(SECOND, values).lam_max
    assert lam_max is not None
    assert (
        0
        < Fraction(values["lam"]) - Fraction(str(lam_max.ball(400).real.mid().str(110, radius=False)))
        < Fraction(1, 10**60)
    )


@pytest.mark.parametrize(
    ("bound", "holds"),
    [("0.4357", True), ("0.43568", True), ("0.4356", False), ("0.4397", False), ("0.44", True), ("2/5", False)],
)
def test_a_decimal_bound_is_held_to_its_digits(bound: str, holds: bool) -> None:
    held = single(SECOND, f'bound = "{bound}"\nat = {{ alpha = 1 }}')
    assert (held.status is Status.HOLDS) is holds
    assert held.finding.derived == "lam_max = 0.435677577734398"


def test_a_bound_where_there_is_none_fails() -> None:
    held = single(IMPLICIT, 'bound = "1"')
    assert held.status is Status.FAILS
    assert held.finding.derived.startswith("lam_max = oo")


def test_an_unstable_lam_between_stable_ones_ends_the_bound() -> None:
    """Where the scheme is stable on both sides of the claimed bound, the claim of loss above it is wrong as well."""
    held = single(LEAPFROG % "u[1, n]", 'bound = "1/2"')
    assert held.status is Status.FAILS
    assert "still stable above" in str(held.finding.counterexample and held.finding.counterexample.shows)


def test_a_one_sided_scheme_has_its_bound_held_at_a_point() -> None:
    assert single(LEAPFROG % "u[1, n]", 'bound = "1"').status is Status.HOLDS
    held = single(LEAPFROG % "u[1, n+1]", 'bound = "1"')
    assert (held.status, held.finding.derived) == (Status.FAILS, "lam_max = 0")


# --- verdicts


@pytest.mark.parametrize(
    ("claim", "status"),
    [
        ("stable = true\nat = { lam = 0.9, alpha = 3 }", Status.HOLDS),
        ("stable = false\nat = { lam = 0.9, alpha = 3 }", Status.FAILS),
        ("stable = true\nat = { lam = 0.9, alpha = 4 }", Status.FAILS),
        ("stable = false\nat = { lam = 0.9, alpha = 4 }", Status.HOLDS),
        ('stable = true\nat = { lam = 0.9, alpha = "31/9" }', Status.FAILS),  # neutral is not stable
        ('stable = false\nat = { lam = 0.9, alpha = "31/9" }', Status.HOLDS),
        ("stable = false\nat = { lam = 1.1, alpha = 1 }", Status.HOLDS),  # the interior's fault, and a fault
    ],
)
def test_stable_means_the_kreiss_condition(claim: str, status: Status) -> None:
    assert single(FIRST, claim).status is status


# --- moduli


@pytest.mark.parametrize(
    ("scheme", "modulus", "at", "holds"),
    [
        (FIRST, "sqrt(lam**2/4*(alpha + 1) + 1 - lam)", 'lam = 0.9, alpha = "7/2"', True),
        (FIRST, "sqrt(lam**2/4*(1/alpha + 1) + 1 - lam)", 'lam = 0.9, alpha = "7/2"', False),
        (FIRST, "1", 'lam = 0.9, alpha = "31/9"', True),  # exactly neutral
        (FIRST, "1 + 1/10**40", 'lam = 0.9, alpha = "31/9"', False),
        (FIRST, "1.001012", 'lam = 0.9, alpha = "3109/900"', True),
        (FIRST, "1.0010121", 'lam = 0.9, alpha = "3109/900"', False),
        (IMPLICIT, "2/sqrt((2 + lam)**2 + lam**2*alpha)", "lam = 1, alpha = 2", True),
        (find("weighted-1"), "1 - lam/2", "lam = 0.9, alpha = 2", True),
    ],
)
def test_a_modulus_is_compared_exactly(scheme: Scheme, modulus: str, at: str, holds: bool) -> None:
    held = single(scheme, f'modulus = "{modulus}"\nat = {{ {at} }}')
    assert held.status is (Status.HOLDS if holds else Status.FAILS)


def test_admissible_roots_come_first_and_the_evidence_says_which_were_meant() -> None:
    none = single(find("weighted-1"), 'modulus = "1 - lam/2"\nat = { lam = 0.9, alpha = 2 }')
    assert none.finding.evidence["roots"] == "no root is admissible: largest of all"
    some = single(FIRST, 'modulus = "1"\nat = { lam = 0.9, alpha = "31/9" }')
    assert some.finding.evidence["roots"] == "largest admissible"


def test_a_claim_of_two_things_needs_both() -> None:
    both = 'stable = true\nmodulus = "{}"\nat = {{ lam = 0.9, alpha = 0.1776 }}'
    assert single(SECOND, both.format("0.9893")).status is Status.HOLDS
    assert single(SECOND, both.format("0.9894")).status is Status.FAILS


# --- undecided, marches, output


def test_what_the_analysis_does_not_reach_neither_holds_nor_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    def beyond(*_: object) -> None:
        raise NotAnalysable("too wide")

    for module, name in [("boundclaim", "stable_set"), ("pointclaim", "analyse")]:
        monkeypatch.setattr(f"gks.bounds.{module}.{name}", beyond)
    result = claiming(FIRST, 'bound = "1"', "stable = true\nat = { alpha = 1 }", 'modulus = "1"\nat = { alpha = 1 }')
    assert [held.status for held in result.held] == [Status.UNDECIDED] * 3
    assert {held.finding.derived for held in result.held} == {"undecided: too wide"}
    assert all(not claim["holds"] for claim in result.to_json()["claims"])  # type: ignore[attr-defined]


class Marched:
    """A marcher that notes where it was sent."""

    def __init__(self) -> None:
        self.sent: list[Mapping[str, Fraction]] = []

    def __call__(self, scheme: Scheme, values: Mapping[str, Fraction]) -> "Marched":
        self.sent.append(values)
        if values["alpha"] > 10:
            raise NotAnalysable("too steep")
        return self

    def to_json(self) -> dict[str, object]:
        return {"predicted": 1.5, "observed": 1.5, "uncertainty": 0.1, "agrees": True}


def test_a_march_stands_beside_each_claim_that_fails_and_no_other() -> None:
    marcher = Marched()
    claims = [
        "stable = true\nat = { alpha = 4 }",
        "stable = true\nat = { alpha = 40 }",
        "stable = true\nat = { alpha = 1 }",
    ]
    text = FIRST.text.partition("[[claims]]")[0] + "".join(f'[[claims]]\nsource = "a"\n{claim}\n' for claim in claims)
    result = audit(parse_scheme(text, "claims.toml"), marcher)
    assert [values["alpha"] for values in marcher.sent] == [4, 40]
    assert result.held[0].finding.evidence["march"] == marcher.to_json()
    assert result.held[1].finding.evidence["march"] == {"refused": "too steep"}
    assert "march" not in result.held[2].finding.evidence
    assert "as predicted (1.5)" in str(result)
    assert "none: too steep" in str(result)


class Proved:
    def __init__(self, status: str) -> None:
        self.status = status

    def __call__(self, scheme: Scheme, values: Mapping[str, Fraction]) -> "Proved":
        assert "lam" not in values
        return self

    def to_json(self) -> dict[str, object]:
        return {"status": self.status, "statement": "stable for lam < 4/(1 + alpha)", "pieces": []}


@pytest.mark.parametrize("status", ["proved", "not-proved"])
def test_a_theorem_stands_beside_a_bound_and_is_printed_only_if_proved(status: str) -> None:
    text = (
        FIRST.text.partition("[[claims]]")[0] + '[[claims]]\nsource = "a"\nbound = "1"\nat = { alpha = 4, lam = 1 }\n'
    )
    (held,) = audit(parse_scheme(text, "claims.toml"), prover=Proved(status)).held
    assert held.finding.evidence["theorem"] == {"status": status, "statement": "stable for lam < 4/(1 + alpha)"}
    assert ("stable for lam" in str(held)) is (status == "proved")
    assert held.finding.derived == "lam_max = 4/5"


def test_the_json_is_the_contract_s_and_exact_where_it_says_so() -> None:
    result = claiming(FIRST, 'bound = "1"', "stable = true\nat = { alpha = 1 }")
    printed = json.loads(json.dumps(result.to_json(), allow_nan=False))
    assert printed["schema"] == "gks.audit/1"
    wrong, right = printed["claims"]
    assert {"source", "holds", "derived", "counterexample", "evidence"} <= set(wrong)
    assert (wrong["holds"], right["holds"], right["counterexample"]) == (False, True, None)
    example = wrong["counterexample"]
    values = {name: Fraction(value) for name, value in example["parameters"].items()}
    z = complex(*example["z"])
    assert abs(abs(z) - example["modulus"]) < 1e-15 * abs(z)
    assert analyse(FIRST, values).verdict is Verdict.UNSTABLE
    polynomial = example["z_is_a_root_of"].replace("- ", "-").replace("+ ", "+").split()
    total = sum(complex(float(eval_term(term, z).real), float(eval_term(term, z).imag)) for term in polynomial)
    assert abs(total) < 1e-9 * sum(abs(eval_term(term, z)) for term in polynomial)


def eval_term(term: str, z: complex) -> complex:
    """One term like +12*z**2 of a polynomial in z."""
    head, _, power = term.partition("z")
    coefficient = {"": 1, "+": 1, "-": -1}.get(head.rstrip("*")) or int(head.rstrip("*"))
    degree = 0 if "z" not in term else int(power.removeprefix("**") or 1)
    return coefficient * z**degree


# --- where a bound is looked at


def test_a_claim_is_held_on_both_sides_of_where_its_formula_switches() -> None:
    claim = claiming(FIRST, 'bound = "min(1, 4/(1 + alpha))"').held[0].claim
    values = [each["alpha"] for each in samples(FIRST, claim)]
    assert Fraction(3) in values
    assert any(3 - Fraction(1, 100) < value < 3 for value in values)
    assert any(3 < value < 3 + Fraction(1, 100) for value in values)
    assert all(Fraction(1, 10**6) < value < 10**6 for value in values)


def test_a_parameter_that_the_formula_names_is_open_though_it_has_no_range() -> None:
    scheme = find("weighted-1-unequal")
    claim = claiming(scheme, 'bound = "min(1, 1/c)"').held[0].claim
    assert [parameter.name for parameter in open_parameters(scheme, claim)] == ["alpha", "c"]
    assert single(scheme, 'bound = "min(1, 1/c)"').status is Status.HOLDS
    assert single(scheme, 'bound = "1"').status is Status.FAILS  # c is at its default, 2


@examples(6)
@given(st.fractions(min_value=Fraction(1, 50), max_value=50, max_denominator=50))
def test_the_exact_bound_holds_and_any_other_fails(alpha: Fraction) -> None:
    bound = min(Fraction(1), 4 / (1 + alpha))
    scales = (Fraction(1), Fraction(99, 100), Fraction(101, 100))
    claims = [f'bound = "{bound * scale}"\nat = {{ alpha = "{alpha}" }}' for scale in scales]
    assert [held.status for held in claiming(FIRST, *claims).held] == [Status.HOLDS, Status.FAILS, Status.FAILS]


# --- the catalogue


def test_the_catalogue_is_one_table_and_every_failure_in_it_has_a_counterexample_that_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    names, told = ("average-1", "implicit-1", "weighted-1-unequal"), list[str]()
    monkeypatch.setattr("gks.catalogue.names", lambda: names)
    result = audit_catalogue(progress=told.append)
    assert tuple(told) == names
    rows = [(each.scheme, held) for each in result.audits for held in each.held]
    failing = [(scheme, held) for scheme, held in rows if held.status is not Status.HOLDS]
    assert failing
    for scheme, held in failing:
        example = held.finding.counterexample
        assert example is not None
        assert analyse(scheme, example.parameters).verdict.value == example.verdict.split()[0]
    text = str(result)
    assert all(held.claim.source in text for _, held in rows)
    assert text.count("FAILS") == len(failing)
