"""README says what is so: its two commands, its scheme files, its list of commands."""

import argparse
import re
import runpy
import subprocess
import tomllib
from pathlib import Path

import pytest

from gks.cli import parser
from gks.scheme.schemefile import parse_scheme

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.DOTALL | re.MULTILINE)


def commands() -> set[str]:
    (action,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    return set(action.choices)


def test_the_two_commands_are_one_line_each_and_shell() -> None:
    shell = blocks("sh")
    assert len(shell) == 2
    for block in shell:
        assert block.count("\n") == 1
        subprocess.run(["bash", "-n", "-c", block], check=True)
    assert "gks modes" in shell[0]
    assert "gks report" in shell[0]
    assert "pytest" in shell[1]


def test_ci_runs_exactly_these_two() -> None:
    pattern = re.search(r"grep -E '(.*?)' README.md", (ROOT / ".ci" / "run").read_text())
    assert pattern is not None
    assert [f"{line}\n" for line in README.splitlines() if re.search(pattern[1], line)] == blocks("sh")


def test_the_first_command_s_arguments_are_accepted() -> None:
    runs = re.findall(r"\.venv/bin/gks ([^&\n]+)", blocks("sh")[0])
    assert [parser().parse_args(run.split()).command for run in runs] == ["modes", "report"]


def test_the_tests_can_be_set_up_by_the_second_command() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert "'.[test]'" in blocks("sh")[1]
    assert any(need.startswith("pytest-xdist") for need in extras["test"])  # for -n auto


def test_the_first_scheme_file_reads_as_it_stands() -> None:
    scheme = parse_scheme(blocks("toml")[0], "README.md")
    assert len(scheme.boundary_unknowns) == 4


def test_the_second_needs_only_a_title_and_a_cfl_number() -> None:
    head = 'title = "leapfrog"\nparameters = { lam = { role = "cfl", default = 0.5 } }\n'
    assert len(parse_scheme(head + blocks("toml")[1], "README.md").boundary_unknowns) == 1


def test_the_python_runs_and_prints_a_verdict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (program,) = blocks("python")
    (tmp_path / "program.py").write_text(program)
    names = runpy.run_path(str(tmp_path / "program.py"))
    assert "unstable: a normal mode grows" in capsys.readouterr().out
    assert names["theorem"].proved
    assert names["theorem"].bound([1e-10, 3, 1e10]) == pytest.approx([1, 1, 4 / (1 + 1e10)], rel=1e-15)


def test_the_table_of_commands_is_the_commands() -> None:
    assert set(re.findall(r"^\| `gks (\w+)", README, re.MULTILINE)) == commands()


def test_what_readme_links_to_is_there() -> None:
    targets = [target for target in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in target]
    assert targets
    assert [target for target in targets if not (ROOT / target).exists()] == []
