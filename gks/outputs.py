"""The files that commands write: which results are written as what, by the ending of the name."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from gks.errors import InputError, quoted

if TYPE_CHECKING:
    from gks.bounds.curve import Curve
    from gks.bounds.curvemap import CurveMap
    from gks.bounds.radius import RadiusMap
    from gks.bounds.rootpaths import RootMap
    from gks.modes.profile import Profile


class Result(Protocol):
    """What every analysis gives: a text for people (`str`) and the contract's JSON object."""

    def to_json(self) -> Mapping[str, object]: ...


class Tabular(Protocol):
    """A result that is a table as well."""

    def to_csv(self) -> str: ...


def json_text(result: Result) -> str:
    """The one JSON object of a result; ValueError for a NaN or an infinity, which the contract spells as strings."""
    import json

    return json.dumps(result.to_json(), allow_nan=False)


LONGEST_NAME = 200
"""Bytes of an output file's name: file systems allow 255, and its draft beside it has a longer one."""


def writer(
    path: str,
    endings: Sequence[str] = (".csv", ".json", ".png", ".svg", ".pdf"),
    draw: Callable[[Any, str], None] | None = None,
) -> Callable[[Any, str], None]:
    """What writes a result to a file of that name, by its ending; InputError if nothing does or there is no folder.

    ``draw`` makes a picture of it, unless it is a curve.
    """
    if "\0" in path or len(os.fsencode(os.path.basename(path))) > LONGEST_NAME:
        expected = f"expected a name of at most {LONGEST_NAME} bytes"
        raise InputError(f"-o {quoted(path)} can't name a file", expected=expected)
    ending = os.path.splitext(path)[1].lower()
    if ending not in endings:
        found = f"nothing is written as {quoted(ending)}" if ending else "its name has no ending"
        listed = " or ".join(filter(None, [", ".join(endings[:-1]), endings[-1]]))
        raise InputError(f"-o {quoted(path)}: {found}", expected=f"expected {listed}")
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise InputError(f"-o {quoted(path)}: no folder {quoted(folder)}", mend="make it first")
    if os.path.isdir(path):
        raise InputError(f"-o {quoted(path)} is a folder", expected="expected the name of a file")
    writers: dict[str, Callable[[Any, str], None]] = {".csv": _write_csv, ".json": _write_json}
    return writers.get(ending, _draw if draw is None else draw)


def _write_csv(result: Tabular, path: str) -> None:
    from gks.files import write_text

    write_text(path, result.to_csv())


def _write_json(result: Result, path: str) -> None:
    from gks.files import write_text

    write_text(path, json_text(result) + "\n")


def _draw(result: Curve | CurveMap | RadiusMap, path: str) -> None:
    from gks.reports.maps import save

    save(result, path)


def draw_profile(profile: Profile, path: str) -> None:
    """A mode's profile as a picture, the format by the name's ending."""
    from gks.reports.profiles import save_profile

    save_profile(profile, path)


def draw_roots(found: RootMap, path: str) -> None:
    """A root map as a picture, the format by the name's ending."""
    from gks.reports.rootmaps import save_rootmap

    save_rootmap(found, path)
