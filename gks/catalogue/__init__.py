"""The shipped schemes: one TOML file each in this folder, known by the file's name without its ending."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gks.errors import InputError
    from gks.scheme.model import Scheme

_FOLDER = os.path.dirname(os.path.abspath(__file__))
_ENDING = ".toml"


@dataclass(frozen=True, slots=True)
class Entry:
    """What `gks list` shows of a shipped scheme."""

    name: str
    title: str
    source: str


class Listing:
    """All shipped schemes with title and source, read without analysing their formulas."""

    def __init__(self) -> None:
        self.entries = tuple(_entry(name) for name in names())

    def to_json(self) -> dict[str, object]:
        return {"schema": "gks.list/1", "schemes": [asdict(entry) for entry in self.entries]}

    def __str__(self) -> str:
        width = max(len(entry.name) for entry in self.entries)
        return "\n".join(f"{e.name:{width}}  {e.title}\n{'':{width}}  {e.source}" for e in self.entries)


def names() -> tuple[str, ...]:
    """The names of the shipped schemes, in alphabetical order."""
    return tuple(sorted(file.removesuffix(_ENDING) for file in os.listdir(_FOLDER) if file.endswith(_ENDING)))


def path(name: str) -> str:
    """The file of a shipped scheme; KeyError for a name that is not one of `names()`."""
    if name not in names():
        raise KeyError(name)
    return os.path.join(_FOLDER, name + _ENDING)


def find(name_or_path: str | os.PathLike[str]) -> Scheme:
    """The scheme of that name or in that file; InputError if it is neither, SchemeError if the file is at fault.

    A shipped name means the shipped scheme, whatever lies in the current folder (`./traditional-1` is a file).
    """
    from gks.scheme.schemefile import read_scheme

    text = os.fspath(name_or_path)
    if isinstance(name_or_path, str) and text in names():
        return read_scheme(path(text))
    meant_as_file = text.endswith(_ENDING) or os.path.basename(text) != text
    if not meant_as_file and not os.path.lexists(text):
        raise _unknown(text)
    return read_scheme(text)


def _unknown(name: str) -> InputError:
    from gks.errors import InputError, quoted
    from gks.scheme.suggest import nearest

    return InputError(
        f"{quoted(name)} is neither a file nor a shipped scheme",
        mend=nearest(name, names()) or "`gks list` shows the shipped schemes, `gks new` writes a file",
    )


def _entry(name: str) -> Entry:
    import tomllib

    with open(path(name), "rb") as file:
        data = tomllib.load(file)
    return Entry(name, data["title"], data["source"])
