"""Each command imports what its input needs and no more."""

import subprocess
import sys
from pathlib import Path

import pytest

SLOW = {"numpy", "scipy", "sympy", "matplotlib", "mpmath", "flint"}
PROBE = """
import atexit, sys
atexit.register(lambda: print("LOADED", *sys.modules, file=sys.stderr))
from gks.cli import main
sys.exit(main(sys.argv[1:]))
"""


def loaded(*argv: str, folder: Path | None = None) -> set[str]:
    """The modules loaded when a command has ended well."""
    ended = subprocess.run([sys.executable, "-c", PROBE, *argv], capture_output=True, text=True, check=True, cwd=folder)
    (line,) = (line for line in ended.stderr.splitlines() if line.startswith("LOADED"))
    return set(line.split()[1:])


@pytest.mark.parametrize("option", ["--version", "--help"])
def test_version_and_help_load_the_argument_parser_alone(option: str) -> None:
    modules = loaded(option)
    assert {name for name in modules if name.split(".")[0] == "gks"} == {"gks", "gks.cli"}
    assert modules.isdisjoint(SLOW | {"dataclasses", "inspect", "fractions", "decimal", "json", "tomllib"})


def test_list_loads_nothing_slow() -> None:
    assert loaded("list").isdisjoint(SLOW)


def test_new_loads_nothing_slow(tmp_path: Path) -> None:
    assert loaded("new", str(tmp_path / "mine")).isdisjoint(SLOW)


def test_importing_the_package_imports_nothing_of_it() -> None:
    show = "import gks, sys; print(*(m for m in sys.modules if m.startswith('gks')))"
    ended = subprocess.run([sys.executable, "-c", show], capture_output=True, text=True, check=True)
    assert ended.stdout.split() == ["gks"]


def test_modes_of_a_shipped_scheme_need_no_computer_algebra_and_no_pictures() -> None:
    assert loaded("modes", "traditional-1").isdisjoint({"sympy", "mpmath", "matplotlib", "scipy"})


def test_a_curve_as_numbers_needs_no_pictures(tmp_path: Path) -> None:
    output = tmp_path / "curve.csv"
    modules = loaded("curve", "traditional-1", "--sweep", "alpha=1e-2:1e2:11:log", "-o", str(output))
    assert modules.isdisjoint({"sympy", "mpmath", "matplotlib"})


def test_a_picture_needs_the_picture_writer_alone(tmp_path: Path) -> None:
    modules = loaded("curve", "traditional-1", "--sweep", "alpha=1e-2:1e2:11:log", "-o", str(tmp_path / "curve.svg"))
    assert "matplotlib" in modules
    assert modules.isdisjoint({"sympy", "matplotlib.pyplot"})
