"""Numbers beyond the range of doubles: exact where the answer is exact, one clear message where doubles are needed."""

from __future__ import annotations

import pytest

from gks import catalogue
from gks.bounds.finding import exact_z
from gks.cli import main
from gks.modes.analysis import analyse


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


@pytest.mark.parametrize("size", ["1e400", "1e-9999"])
def test_modes_are_exact_and_print_the_number(size: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "leapfrog-space-0", "-p", f"lam={size}", "--json"]) == 0
    assert '"lam": "1' in capsys.readouterr().out
