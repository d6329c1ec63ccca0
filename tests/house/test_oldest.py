"""The oldest versions tested are the lower bounds that pyproject.toml states, each of them and nothing else."""

import importlib.util
import tomllib
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.fixture(scope="module")
def oldest() -> ModuleType:
    specification = importlib.util.spec_from_file_location("oldest", ROOT / ".ci" / "oldest.py")
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_every_requirement_is_pinned_to_its_bound(oldest: ModuleType) -> None:
    stated = [
        *PROJECT["dependencies"],
        *(each for extra in PROJECT["optional-dependencies"].values() for each in extra),
    ]
    bounds = {"==".join(part.strip() for part in requirement.split(">=")) for requirement in stated}
    assert set(oldest.constraints(PROJECT)) == bounds


def test_the_package_depends_on_few_others() -> None:
    assert len(PROJECT["dependencies"]) <= 5


@pytest.mark.parametrize("requirement", ["numpy", "numpy == 2.0", "numpy >= 2.0, < 3", "numpy > 2", "numpy >= x"])
def test_a_requirement_without_a_lower_bound_is_noticed(oldest: ModuleType, requirement: str) -> None:
    with pytest.raises(ValueError, match="is not"):
        oldest.constraints({"dependencies": [requirement]})


def test_two_bounds_of_one_requirement_are_noticed(oldest: ModuleType) -> None:
    with pytest.raises(ValueError, match="numpy has the bounds"):
        oldest.constraints({"dependencies": ["numpy >= 2.0"], "optional-dependencies": {"x": ["numpy >= 2.1"]}})
