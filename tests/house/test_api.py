"""The library as a notebook uses it."""

import json
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from pkgutil import iter_modules
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import gks
import gks.modes
from gks.cli import main
from gks.errors import InputError, ParameterError
from tests.bounds.theorem_schemes import upwind_flux


def test_a_scheme_is_loaded_by_name_or_by_path() -> None:
    file = gks.catalogue.path("traditional-1")
    assert gks.load("traditional-1").scheme.text == gks.load(file).scheme.text == gks.load(Path(file)).scheme.text


def test_a_shipped_name_is_the_shipped_scheme_and_a_path_is_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = Path(gks.catalogue.path("weighted-1")).read_text()
    monkeypatch.chdir(tmp_path)
    for name in ("traditional-1", "mine"):
        Path(name).write_text(text)
    assert gks.load("traditional-1").scheme.source.startswith("Banks & Sjögreen, eq. (3.6)")
    for file in ("./traditional-1", Path("traditional-1"), "mine"):
        assert gks.load(file).scheme.source.startswith("Banks & Sjögreen, eq. (3.19)")


def test_neither_a_name_nor_a_file_says_so() -> None:
    with pytest.raises(InputError, match=r'"weighted-3" is neither .* did you mean "weighted-'):
        gks.load("weighted-3")


def test_every_way_to_write_a_value_is_the_same_value() -> None:
    scheme = gks.load("traditional-1")
    nine_tenths: list[Any] = ["9/10", "0.9", 0.9, Decimal("0.9"), Fraction(9, 10), np.float64(0.9)]
    five: Any = np.int64(5)
    assert {str(scheme.derive(lam=value, alpha=five).to_json()) for value in nine_tenths} == {
        str(scheme.derive({"lam": "9/10"}, alpha=5).to_json())
    }


def test_derive_keeps_what_is_not_given_as_a_symbol() -> None:
    scheme = gks.load("traditional-1")
    assert scheme.derive().characteristic_polynomial == "4*r**2 - 4*r + alpha + 1"
    assert "alpha" not in scheme.derive(alpha=3).characteristic_polynomial


def test_a_determinant_that_vanishes_nowhere_has_no_modes_to_print() -> None:
    derived = gks.LoadedScheme(upwind_flux("a", "3*u[1]")).derive(a=-1)
    assert str(derived).splitlines()[1] == "  no normal modes: the determinant vanishes nowhere"
    assert derived.to_json()["characteristic_polynomial"] == "1"


def test_modes_are_what_the_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    main(["modes", "traditional-1", "-p", "lam=9/10", "-p", "alpha=31/9", "--json"])
    printed = json.loads(capsys.readouterr().out)
    result = json.loads(json.dumps(gks.load("traditional-1").modes(lam="9/10", alpha="31/9").to_json()))
    printed.pop("time_s")
    result.pop("time_s")
    assert printed == result
    assert result["verdict"] == "neutral"


def test_a_loaded_scheme_prints_its_title_source_and_parameters() -> None:
    assert str(gks.load("traditional-1")).splitlines() == [
        "Traditional coupling, first order",
        "Banks & Sjögreen, eq. (3.6) in (3.2), interior (3.1)",
        "  lam = 9/10  (c dt/dx)",
        "  alpha = 1  (kappa_R/kappa_L = rho_R/rho_L)",
    ]


def test_a_curve_takes_an_array_a_text_or_a_sweep() -> None:
    scheme = gks.load("traditional-1")
    arrays: list[Any] = ["1:5:3", [1, "3", 5], np.linspace(1, 5, 3)]
    points = [scheme.curve(alpha=array).to_json()["points"] for array in arrays]
    points.append(scheme.curve(sweep="alpha=1:5:3").to_json()["points"])
    assert all(each == points[0] for each in points)


@pytest.mark.parametrize("arrays", [{"alpha": [1, float("nan")]}, {"alpha": []}, {"alpha": [1, 2], "lam": [-1, 2]}])
def test_an_array_at_fault_is_refused(arrays: dict[str, list[float]]) -> None:
    with pytest.raises(ParameterError):
        gks.load("traditional-1").curve(arrays)


def test_an_unknown_name_of_the_package_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'laod'"):
        _ = gks.laod  # type: ignore[attr-defined]


@pytest.mark.parametrize("package", [gks, gks.modes], ids=lambda each: str(each.__name__))
def test_every_public_name_is_there_whatever_was_imported_before(package: ModuleType) -> None:
    """A name that is fetched when it is first asked for is not that of a module below: importing that would hide it."""
    public = set(package.__all__)
    assert all(getattr(package, name) is not None for name in public)
    assert public & {each.name for each in iter_modules(package.__path__)} <= {"catalogue"}


def test_the_directory_of_names_has_the_public_ones() -> None:
    assert set(gks.__all__) <= set(dir(gks))
