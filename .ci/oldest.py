"""Prints a pip constraints file that pins every requirement of pyproject.toml to its lower bound.

The bounds stand in pyproject.toml alone. Each requirement is a name and one bound, `numpy >= 2.0`; extras are taken in
as well. ValueError for a requirement of another form, and for one with two bounds.
"""

import re
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path

REQUIREMENT = re.compile(r"([A-Za-z0-9][A-Za-z0-9._-]*)\s*>=\s*([0-9][0-9.]*)")


def constraints(project: dict[str, object]) -> list[str]:
    """`name==lowest` for each requirement of the [project] table, its extras included, in alphabetical order."""
    extras = project.get("optional-dependencies", {})
    lists: list[Iterable[str]] = [project.get("dependencies", []), *extras.values()]  # type: ignore[attr-defined, list-item]
    pinned: dict[str, str] = {}
    for requirement in (each for every in lists for each in every):
        match = REQUIREMENT.fullmatch(requirement.strip())
        if match is None:
            raise ValueError(f"{requirement!r} is not `name >= version`")
        name, lowest = match.groups()
        if pinned.setdefault(name, lowest) != lowest:
            raise ValueError(f"{name} has the bounds {pinned[name]} and {lowest}")
    return [f"{name}=={lowest}" for name, lowest in sorted(pinned.items())]


if __name__ == "__main__":
    path = Path(sys.argv[1] if len(sys.argv) > 1 else "pyproject.toml")
    print("\n".join(constraints(tomllib.loads(path.read_text(encoding="utf-8"))["project"])))
