"""Where the keys and values of a TOML text stand, which tomllib does not tell.

The scanner reads the text before tomllib does and refuses what would cost tomllib quadratic time or deep recursion
(brackets within brackets, keys of many parts). It is lenient: at the first thing that is no TOML it stops, and
tomllib, which stops there too, says what is wrong.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from contextlib import suppress
from dataclasses import dataclass, field

from gks.scheme.limits import MAX_DIGITS, MAX_ENTRIES, MAX_KEY_PARTS, MAX_TOML_NESTING

Path = tuple[str | int, ...]
"""Keys and array indices from the root, as ("closure", "equations", 2)."""


class TooMuch(Exception):
    """The text at `offset` is over a limit."""

    def __init__(self, offset: int, message: str) -> None:
        super().__init__(message)
        self.offset = offset
        self.message = message


@dataclass(slots=True)
class Positions:
    """Offsets of keys (table headers included) and spans of values in a text whose line ends are \\n."""

    text: str
    keys: dict[Path, int] = field(default_factory=dict)
    values: dict[Path, tuple[int, int]] = field(default_factory=dict)
    _lines: list[int] = field(default_factory=list)

    def line_column(self, offset: int) -> tuple[int, int]:
        """Line and column, from 1, counted in characters."""
        if not self._lines:
            self._lines = [0, *(match.end() for match in re.finditer("\n", self.text))]
        line = bisect_right(self._lines, offset)
        return line, offset - self._lines[line - 1] + 1

    def key_offset(self, path: Path) -> int:
        """Where the key stands; for an array element its value; for what is not in the file what holds it."""
        while path:
            if path in self.keys:
                return self.keys[path]
            if path in self.values:
                return self.values[path][0]
            path = path[:-1]
        return 0

    def value_offset(self, path: Path) -> int:
        return self.values[path][0] if path in self.values else self.key_offset(path)

    def raw(self, path: Path) -> str:
        """The value as it is spelled, "" if it is a table with a header."""
        start, end = self.values.get(path, (0, 0))
        return self.text[start:end]

    def inside(self, path: Path, offset: int) -> int:
        """The offset in the text of a character of a string value; the start of the string where escapes shift it."""
        start, end = self.values.get(path, (self.key_offset(path), 0))
        raw = self.text[start:end]
        if raw[:1] not in ('"', "'"):
            return start + min(offset, max(len(raw) - 1, 0))
        if "\\" in raw and raw[0] == '"':
            return start
        opening = 3 if raw[:3] in ('"""', "'''") else 1
        if opening == 3 and raw[3:4] == "\n":
            opening = 4  # the first line break after the quotes does not count
        return start + opening + offset


def scan(text: str) -> Positions:
    """Positions of everything up to the first thing that is no TOML. TooMuch beyond the limits."""
    scanner = _Scanner(text)
    with suppress(_NoToml):
        scanner.document()
    return scanner.positions


class _NoToml(Exception):
    """Here tomllib will find an error."""


_BLANK = re.compile(r"(?:[ \t\n]++|#[^\n]*+)*+")
_SPACE = re.compile(r"[ \t]*+")
_KEY = re.compile(r"""[A-Za-z0-9_-]++|"(?:[^"\\\n]++|\\.)*+"|'[^'\n]*+'""")
_DOT = re.compile(r"[ \t]*+\.[ \t]*+")
_STRING = re.compile(
    r'''"""(?:[^"\\]++|\\[\s\S]|"(?!""))*+"{3,5}'''
    r"""|'''(?:[^']++|'(?!''))*+'{3,5}"""
    r"""|"(?:[^"\\\n]++|\\.)*+"|'[^'\n]*+'"""
)
_SCALAR = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2} [0-9]{2}:[^,\]}\s#]*+|[^,\]}\s#]++")


class _Scanner:
    def __init__(self, text: str) -> None:
        self.text = text
        self.place = 0
        self.positions = Positions(text)
        self.arrays: dict[Path, int] = {}  # arrays of tables, with their lengths
        self.entries = 0

    def document(self) -> None:
        table: Path = ()
        while self.skip(_BLANK) < len(self.text):
            if self.text.startswith("[", self.place):
                table = self.header()
            else:
                self.key_value(table, ())

    def skip(self, pattern: re.Pattern[str]) -> int:
        match = pattern.match(self.text, self.place)
        self.place = match.end() if match else self.place
        return self.place

    def expect(self, literal: str) -> None:
        if not self.text.startswith(literal, self.place):
            raise _NoToml
        self.place += len(literal)

    def count(self, offset: int) -> None:
        self.entries += 1
        if self.entries > MAX_ENTRIES:
            raise TooMuch(offset, f"over {MAX_ENTRIES} keys and values")

    def header(self) -> Path:
        """[table] or [[array of tables]]; the path of the table that it opens."""
        double = self.text.startswith("[[", self.place)
        self.place += 2 if double else 1
        offset = self.skip(_SPACE)
        parts = self.key()
        self.skip(_SPACE)
        self.expect("]]" if double else "]")
        path: Path = ()
        for part in parts[:-1]:
            self.positions.keys.setdefault((*path, part), offset)
            path = self.latest((*path, part))
        path = (*path, parts[-1])
        if double:
            self.arrays[path] = self.arrays.get(path, 0) + 1
            self.positions.keys.setdefault(path, offset)
        path = self.latest(path)
        self.positions.keys[path] = offset
        return path

    def latest(self, path: Path) -> Path:
        """The path itself, or that of the last table if it is an array of tables."""
        return (*path, self.arrays[path] - 1) if path in self.arrays else path

    def key(self) -> list[str]:
        """A dotted key, its parts unquoted."""
        start = self.place
        parts: list[str] = []
        while True:
            match = _KEY.match(self.text, self.place)
            if match is None:
                raise _NoToml
            self.place = match.end()
            parts.append(_unquoted(match[0]))
            self.count(start)
            dot = _DOT.match(self.text, self.place)
            if dot is None:
                break
            self.place = dot.end()
            if len(parts) == MAX_KEY_PARTS:
                raise TooMuch(start, f"a key of over {MAX_KEY_PARTS} parts")
        return parts

    def key_value(self, table: Path, nesting: tuple[str, ...]) -> None:
        start = self.place
        path = table
        for part in self.key():
            path = (*path, part)
            self.positions.keys.setdefault(path, start)
        self.skip(_SPACE)
        self.expect("=")
        self.skip(_SPACE)
        self.value(path, nesting)

    def value(self, path: Path, nesting: tuple[str, ...]) -> None:
        """One value of any kind; `nesting` holds the closing brackets that are open."""
        start = self.place
        self.count(start)
        opening = self.text[start : start + 1]
        if opening in ("[", "{"):
            if len(nesting) == MAX_TOML_NESTING:
                raise TooMuch(start, f"brackets nested over {MAX_TOML_NESTING} deep")
            self.place += 1
            self.members(path, (*nesting, "]" if opening == "[" else "}"))
        else:
            match = (_STRING if opening in ("'", '"') else _SCALAR).match(self.text, start)
            if match is None:
                raise _NoToml
            if opening not in ("'", '"') and len(match[0]) > MAX_DIGITS:
                raise TooMuch(start, f"a value of {len(match[0])} characters, and numbers have at most {MAX_DIGITS}")
            self.place = match.end()
        self.positions.values[path] = (start, self.place)

    def members(self, path: Path, nesting: tuple[str, ...]) -> None:
        """The inside of an array or inline table up to and with its closing bracket."""
        index = 0
        while True:
            self.skip(_BLANK)
            if self.text.startswith(nesting[-1], self.place):
                break
            if nesting[-1] == "]":
                self.value((*path, index), nesting)
            else:
                self.key_value(path, nesting)
            index += 1
            self.skip(_BLANK)
            if not self.text.startswith(",", self.place):
                break
            self.place += 1
        self.expect(nesting[-1])


def _unquoted(key: str) -> str:
    if key[0] == "'":
        return key[1:-1]
    if key[0] != '"':
        return key
    if "\\" not in key:
        return key[1:-1]
    try:
        return str(tomllib.loads(f"key = {key}")["key"])
    except tomllib.TOMLDecodeError:
        raise _NoToml from None
