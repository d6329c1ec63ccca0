"""The wheel holds what the folders hold: every file of gks, solvers and reports, each once, and nothing else."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
INSTALLED_AS = {"gks": "gks", "solvers": "gks/solvers", "reports": "gks/reports"}


def source_files(root: Path) -> list[str]:
    """What the folders hold, by the path to install it at; the links gks/solvers and gks/reports aren't entered."""
    return sorted(
        f"{home}/{file.relative_to(root / folder)}"
        for folder, home in INSTALLED_AS.items()
        for file in (root / folder).rglob("*")
        if file.is_file() and "__pycache__" not in file.parts and file.suffix != ".pyc"
        if not (folder == "gks" and file.relative_to(root / folder).parts[0] in ("solvers", "reports"))
    )


def wheel_files(root: Path, out: Path) -> list[str]:
    """What the wheel built from `root` holds, without its own records."""
    build = f"from setuptools.build_meta import build_wheel; build_wheel({str(out)!r})"
    subprocess.run([sys.executable, "-c", build], cwd=root, check=True, capture_output=True)
    (wheel,) = out.glob("gks_stability-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        return sorted(name for name in archive.namelist() if ".dist-info/" not in name)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """A copy of what a build reads, so that the build leaves nothing behind and finds nothing left from another one."""
    root = tmp_path / "source"
    root.mkdir()
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, root)
    for name in INSTALLED_AS:
        shutil.copytree(ROOT / name, root / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
    return root


def test_every_file_is_in_the_wheel_once(copy: Path, tmp_path: Path) -> None:
    assert wheel_files(copy, tmp_path) == source_files(copy)


def test_a_subfolder_that_pyproject_does_not_list_is_noticed(copy: Path, tmp_path: Path) -> None:
    (copy / "solvers" / "extra").mkdir()
    (copy / "solvers" / "extra" / "__init__.py").touch()
    assert set(source_files(copy)) - set(wheel_files(copy, tmp_path)) == {"gks/solvers/extra/__init__.py"}


def test_a_tree_without_the_links_gives_the_same_wheel(copy: Path, tmp_path: Path) -> None:
    for name in ("solvers", "reports"):
        (copy / "gks" / name).unlink()
    assert wheel_files(copy, tmp_path) == source_files(copy)


@pytest.mark.parametrize("name", ["solvers", "reports"])
def test_the_links_are_relative_and_lead_to_the_rooms(name: str) -> None:
    link = ROOT / "gks" / name
    assert link.is_symlink()
    assert str(link.readlink()) == f"../{name}"
