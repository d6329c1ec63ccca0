"""What earlier runs computed, kept beside the page: used only where it is provably what would be computed again.

An entry is known by a key made of everything it depends on: the step with its arguments, the scheme's text, this
package's code, shipped schemes and style of pictures, and the versions of Python and of the packages below it. It holds
that key once more and a digest of its content; an entry that does not bear out both is no entry.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from functools import cache
from typing import Any

import gks
from gks.files import write_text
from gks.reports.provenance import versions
from gks.reports.steps import Step

FOLDER = ".gks-cache"

LARGEST = 200_000_000
"""Bytes of an entry that is read."""


class Store:
    """The entries of one folder. `fresh` stores look nothing up."""

    def __init__(self, folder: str, *, fresh: bool = False) -> None:
        self.folder, self.fresh = os.path.join(folder, FOLDER), fresh

    def find(self, step: Step) -> Mapping[str, Any] | None:
        """The record of a step, if there is one that holds."""
        if self.fresh:
            return None
        try:
            with open(self._path(step), "rb") as file:
                entry = json.loads(file.read(LARGEST))
        except (OSError, ValueError, RecursionError):
            return None
        if not isinstance(entry, dict) or entry.get("key") != key_of(step):
            return None
        record = entry.get("record")
        return record if isinstance(record, dict) and entry.get("digest") == digest(record) else None

    def keep(self, step: Step, record: Mapping[str, Any]) -> None:
        """Write a step's record, whole or not at all."""
        os.makedirs(self.folder, exist_ok=True)
        entry = {"key": key_of(step), "digest": digest(record), "record": record}
        write_text(self._path(step), json.dumps(entry, allow_nan=False) + "\n")

    def _path(self, step: Step) -> str:
        return os.path.join(self.folder, key_of(step)[:32] + ".json")


def key_of(step: Step) -> str:
    """Everything that a step's result depends on, as one digest."""
    text = None if step.source is None else step.source[:2]
    return digest([versions(), code(), step.kind, dict(step.arguments), text])


def digest(content: object) -> str:
    """SHA-256 of JSON data, whatever the order of its keys."""
    return hashlib.sha256(json.dumps(content, sort_keys=True, allow_nan=False).encode()).hexdigest()


SOURCES = (".py", ".toml", ".mplstyle")
"""Endings of the files that results depend on: code, shipped schemes that steps load by name, the style of pictures."""


@cache
def code() -> str:
    """A digest of this package's own source: a version alone would outlive a change to the code."""
    total = hashlib.sha256()
    for package in ("", "scheme", "modes", "bounds", "catalogue", "solvers", "reports"):
        folder = os.path.join(os.path.dirname(os.path.abspath(gks.__file__)), package)
        if not os.path.isdir(folder):  # installed from the tree by reference: solvers and reports lie beside gks
            folder = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(gks.__file__))), package)
        for name in sorted(os.listdir(folder)):
            if name.endswith(SOURCES):
                with open(os.path.join(folder, name), "rb") as file:
                    total.update(name.encode() + b"\0" + hashlib.sha256(file.read()).digest())
    return total.hexdigest()
