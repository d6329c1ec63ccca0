"""The stress table: its quick cases are right, its expected answers hold by other means, and a wrong answer is seen."""

from dataclasses import replace
from fractions import Fraction

import pytest

from gks.reports.bench_stress import COLUMNS, MOST_DIGITS, agreeing, row
from gks.reports.stress_cases import Case, cases, coupling_limit, shown

QUICK = [case for case in cases() if "ghosts" not in case.name or case.name.startswith("1 points")]


def column(name: str, found: tuple[object, ...]) -> object:
    return found[COLUMNS.index(name)]


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.name)
def test_a_case_is_right(case: Case) -> None:
    found = row(case)
    assert column("right", found) == "yes", found


def test_the_table_reaches_the_extremes_it_promises() -> None:
    every = cases()
    sizes = [abs(value) for case in every for value in case.values.values() if value]
    assert min(sizes) <= Fraction(1, 10**300) and max(sizes) >= 10**300
    assert max(case.multiplicity or 0 for case in every) == 8
    assert any(case.name.startswith("9 points a side") for case in every)
    assert any(case.name.startswith("six fields") for case in every)


def test_the_formula_of_the_interface_is_the_papers_where_the_paper_has_one() -> None:
    """Equal speeds: min(1, 4/(1 + alpha)), neutral at alpha = 31/9, lam = 9/10."""
    one = Fraction(1)
    assert coupling_limit(Fraction(31, 9), one, one) == Fraction(9, 10)
    assert coupling_limit(Fraction(1), one, one) == 1


def test_a_wrong_answer_is_seen() -> None:
    stable = next(case for case in QUICK if case.verdict == "stable")
    assert column("right", row(replace(stable, verdict="unstable"))) == "NO"
    bound = next(case for case in QUICK if case.lam_max is not None)
    assert bound.lam_max is not None
    assert column("right", row(replace(bound, lam_max=bound.lam_max * (1 + Fraction(1, 10**9))))) == "NO"


def test_a_wrong_root_or_multiplicity_is_seen() -> None:
    mode = next(case for case in QUICK if case.multiplicity == 8)
    assert mode.z is not None
    assert column("right", row(replace(mode, multiplicity=7))) == "NO"
    assert column("right", row(replace(mode, z=mode.z + Fraction(1, 10**9)))) == "NO"


@pytest.mark.parametrize(
    ("found", "exact", "digits"),
    [(1, 1, MOST_DIGITS), (Fraction(1001, 1000), 1, 3.0), (0, 0, MOST_DIGITS), (5, 1, 0.0)],
)
def test_digits(found: Fraction, exact: Fraction, digits: float) -> None:
    assert agreeing(Fraction(found), Fraction(exact)) == pytest.approx(digits)


def test_a_value_is_shown_by_its_distance_from_a_simple_one() -> None:
    assert [shown(Fraction(v)) for v in (1, Fraction(3, 2), 1 - Fraction(1, 10**14))] == ["1", "3/2", "1 - 1e-14"]
    assert shown(Fraction(10) ** 300) == "1e300"
