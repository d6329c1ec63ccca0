"""Numbers beyond the range of doubles: exact where the answer is exact, one clear message where doubles are needed."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

from gks import catalogue
from gks.bounds.checkformula import Rejected
from gks.bounds.checknumbers import fraction
from gks.bounds.finding import exact_z
from gks.cli import main
from gks.modes.analysis import analyse
from gks.scheme.schemefile import parse_scheme


def test_a_mode_beyond_doubles_is_found_again_as_an_exact_number() -> None:
    """Traditional coupling, density ratio 1e1000: abs(z) is near its root, 1e500."""
    scheme = catalogue.find("traditional-1")
    values = scheme.values({"alpha": "1e1000"})
    mode = max(analyse(scheme, values).modes, key=lambda each: each.modulus)
    assert mode.modulus > 10**400
    found = exact_z(scheme, values, mode)
    assert found is not None
    assert abs(found.ball()) > 10**400


@pytest.mark.parametrize("size", ["1e400", "1e-400", "1e9999", "1e-9999"])
@pytest.mark.parametrize(
    "command",
    [
        ["march", "traditional-1", "-p", "lam=SIZE"],
        ["roots", "traditional-1", "--sweep", "lam=SIZE:1:3"],
        ["roots", "traditional-1", "-p", "lam=SIZE", "--sweep", "alpha=1:2:3"],
    ],
)
def test_what_is_computed_in_doubles_says_so(
    command: list[str], size: str, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [text.replace("SIZE", size) for text in command]
    assert main(arguments) == 2
    assert "doubles" in capsys.readouterr().err


@pytest.mark.parametrize("size", ["1e400", "1e9999"])
def test_theorems_hold_numbers_of_any_length(size: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever they say of them: the statement, its LaTeX and what the check reads are written out."""
    assert main(["prove", "traditional-1", "-p", f"alpha={size}", "--json", "--limit", "5"]) == 0
    assert json.loads(capsys.readouterr().out)["status"] in ("proved", "not-proved")


@pytest.mark.parametrize(("text", "value"), [("-3/7", Fraction(-3, 7)), ("1" + "0" * 9999, Fraction(10**9999))])
def test_the_check_reads_numbers_of_any_length(text: str, value: Fraction) -> None:
    assert fraction(text) == value


@pytest.mark.parametrize("text", ["1e999999999", "2/4", "3/1", "-0", "01", "1/0", "1_0", " 1", "\u0661"])
def test_the_check_reads_lowest_terms_alone(text: str) -> None:
    with pytest.raises(Rejected):
        fraction(text)


def test_a_speed_that_nearly_cancels_has_its_sign() -> None:
    """Wave speeds (N +- sqrt(N**2 + 4))/2: of N = 10**2600 the smaller is -1e-2600, told from 0 by 17300 bits."""
    text = catalogue.find("average-1").text.replace('["-alpha", "0"]', f'["-alpha", "1{"0" * 2600}"]')
    scheme = parse_scheme(text, "skewed")
    assert text != catalogue.find("average-1").text
    assert analyse(scheme, scheme.values({})).reason == "interior"


@pytest.mark.parametrize("size", ["1e400", "1e-9999"])
def test_modes_are_exact_and_print_the_number(size: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "leapfrog-space-0", "-p", f"lam={size}", "--json"]) == 0
    assert '"lam": "1' in capsys.readouterr().out
