""".ci/run carries out README's commands and fails when any step does."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STEPS = ["browser", "main job", "tests", "ruff", "mypy", "oldest versions"]
PREPARED = "oldest versions: environment"
"""The one that runs beside another."""


def ci(root: Path, *broken: str) -> subprocess.CompletedProcess[str]:
    """Run a copy of the script where every step is a stand-in that records its name, and fails if it is broken."""
    (root / ".ci").mkdir()
    shutil.copy(ROOT / ".ci" / "run", root / ".ci" / "run")
    (root / ".venv" / "bin").mkdir(parents=True)
    for step in STEPS:
        name = step.split()[0]
        command = root / ".ci" / name if name in ("browser", "oldest") else root / ".venv" / "bin" / name
        prepared = f'[ "$1" != prepare ] || {{ touch prepared; exit {int(PREPARED in broken)}; }}'
        record = f"echo {step} >> steps\necho '3 passed in 1 s'\nexit {int(step in broken)}"
        command.write_text(f"#!/bin/sh\n{prepared}\n{record}\n")
        command.chmod(0o755)
    commands = (f"python3 -m venv --help > /dev/null && .venv/bin/{name}\n" for name in ("main", "tests"))
    (root / "README.md").write_text("# Two commands\n" + "".join(commands))
    return subprocess.run(["bash", ".ci/run"], cwd=root, capture_output=True, text=True, check=False)


def test_it_runs_the_second_command_ruff_mypy_the_first_command_and_the_oldest_versions(tmp_path: Path) -> None:
    ended = ci(tmp_path)
    assert ended.returncode == 0
    expected = ["browser", "tests", "ruff", "mypy", "main job", "oldest versions"]
    assert (tmp_path / "steps").read_text().splitlines() == expected
    assert (tmp_path / "prepared").exists()
    assert "== pytest said: 3 passed in 1 s" in ended.stdout


@pytest.mark.parametrize("step", [*STEPS, PREPARED])
def test_any_step_that_fails_fails_the_run_and_the_others_still_run(tmp_path: Path, step: str) -> None:
    ended = ci(tmp_path, step)
    assert ended.returncode == 1
    assert f"== failed: {step}\n" in ended.stdout
    assert len((tmp_path / "steps").read_text().splitlines()) == len(STEPS)


def test_it_is_executable() -> None:
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111
