"""The folder of a campaign: one file a chunk, written whole, with what it belongs to and a digest of what it holds.

    DIR/campaign.json    what is computed: the key
    DIR/00000042.json    two lines: {"campaign": digest of the key, "chunk": 42, "sha256": digest of line 2}, the result

A file that isn't what it says (torn by a power cut, of another campaign) counts as not there, and its chunk is computed
again. Files are JSON and never pickles: a folder that came from elsewhere can say something wrong, but runs nothing.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from typing import Any

from gks.errors import InputError, quoted
from gks.files import write_text

Key = Mapping[str, str | int]
"""What a campaign computes, entry by entry: the program's version, what it is given, how that is cut into chunks."""

CAMPAIGN = "campaign.json"
LOCK = "lock"
_CHUNK = re.compile(r"\d{8,}\.json", re.ASCII)
_DRAFT = re.compile(r"\.gks-.*\.json", re.ASCII)
"""What `gks.files` calls a file that isn't whole yet; one that is left belongs to a run that was killed."""


class Folder:
    """The finished chunks of one campaign."""

    def __init__(self, path: str, key: Key) -> None:
        self.path = path
        self._digest = _digest(_text(key))

    def results(self, chunks: int) -> dict[int, Any]:
        """The results of the chunks that are there, whole and of this campaign."""
        found: dict[int, Any] = {}
        for name in sorted(os.listdir(self.path)):
            number = int(name.removesuffix(".json")) if _CHUNK.fullmatch(name) else chunks
            if number < chunks and (line := self._checked(name, number)) is not None:
                found[number] = json.loads(line)
        return found

    def keep(self, chunk: int, result: object) -> None:
        """Write the result of a chunk, whole or not at all; OSError where there is no room."""
        line = _text(result)
        head = _text({"campaign": self._digest, "chunk": chunk, "sha256": _digest(line)})
        write_text(os.path.join(self.path, f"{chunk:08d}.json"), f"{head}\n{line}\n")

    def _checked(self, name: str, chunk: int) -> str | None:
        """The line that holds the result; None where the file is not what it says."""
        with open(os.path.join(self.path, name), encoding="utf-8", errors="replace", newline="\n") as file:
            head, _, rest = file.read().partition("\n")
        line = rest.removesuffix("\n")
        expected = _text({"campaign": self._digest, "chunk": chunk, "sha256": _digest(line)})
        return line if head == expected and rest.endswith("\n") else None


@contextmanager
def folder(path: str, key: Key) -> Iterator[Folder]:
    """The campaign's folder, made if it isn't there, this run's alone for the time of the block.

    InputError where it holds something else than chunks, another campaign's, or another run is at work in it.
    """
    try:
        os.makedirs(path, exist_ok=True)
    except (FileExistsError, NotADirectoryError):
        raise InputError(f"{quoted(path)} is not a folder", path="--resume", expected="a folder for chunks") from None
    with _locked(path):
        for name in os.listdir(path):
            if _DRAFT.fullmatch(name):
                os.unlink(os.path.join(path, name))
        _claim(path, key)
        yield Folder(path, key)


def _claim(path: str, key: Key) -> None:
    """Write the key into a new folder; InputError where one is there and differs."""
    place = os.path.join(path, CAMPAIGN)
    if not os.path.exists(place):
        if set(os.listdir(path)) - {LOCK}:
            raise InputError(f"{quoted(path)} holds other files", path="--resume", mend="name a new folder")
        write_text(place, json.dumps(dict(key), indent=1) + "\n")
        return
    with open(place, encoding="utf-8", errors="replace") as file:
        try:
            found = json.load(file)
        except ValueError:
            found = None
    if not isinstance(found, dict):
        raise InputError(f"{quoted(place)} can't be read", path="--resume", mend="name a new folder")
    different = [name for name in {**found, **key} if found.get(name) != key.get(name)]
    if different:
        what = ", ".join(f"{quoted(name)}: {quoted(str(found.get(name)))} there" for name in different[:3])
        raise InputError(
            f"{quoted(path)} holds the chunks of another campaign ({what})",
            path="--resume",
            mend="name a new folder, or give the same input",
        )


@contextmanager
def _locked(path: str) -> Iterator[None]:
    """The lock goes with the process that holds it, so that none is left behind by one that was killed."""
    try:
        from fcntl import LOCK_EX, LOCK_NB, flock
    except ModuleNotFoundError:  # no such thing on this system: two runs then compute the same chunks twice
        yield
        return
    with open(os.path.join(path, LOCK), "w", encoding="utf-8") as file:
        try:
            flock(file, LOCK_EX | LOCK_NB)
        except BlockingIOError:
            found = f"another run is at work in {quoted(path)}"
            raise InputError(found, path="--resume", mend="wait for it, or name another folder") from None
        yield


def _text(content: object) -> str:
    """JSON in one line, one way to write it for each content."""
    return json.dumps(content, allow_nan=False, separators=(",", ":"))


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()
