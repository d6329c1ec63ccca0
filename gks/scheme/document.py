"""A TOML file as nodes that know their place, so that whoever reads them can say where and what is wrong."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf

from gks.errors import SchemeError, TooLarge, Where, one_line, quoted
from gks.scheme.limits import MAX_DIGITS, MAX_FILE_BYTES
from gks.scheme.numbers import rational
from gks.scheme.suggest import nearest
from gks.scheme.tokens import NAME, FormulaError
from gks.scheme.toml_positions import Path, Positions, TooMuch, scan


@dataclass(frozen=True, slots=True)
class Real:
    """A TOML float as it is spelled: 0.9 stays nine tenths."""

    text: str


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a UTF-8 file of at most MAX_FILE_BYTES, without a byte order mark. SchemeError if there is none."""
    name = os.fspath(path)
    where = Where(one_line(name))
    try:
        with open(path, "rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SchemeError(f"the file can't be read: {reason}", where=where) from None
    if len(data) > MAX_FILE_BYTES:
        raise SchemeError(f"the file has over {MAX_FILE_BYTES} bytes", where=where, expected="a scheme file is short")
    try:
        return data.decode("utf-8").removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8")
        place = Where(where.file, before.count("\n") + 1, len(before) - before.rfind("\n"))
        raise SchemeError("the file is not UTF-8 text", where=place, mend="save it as UTF-8") from None


class Document:
    """A parsed TOML text with the positions of everything in it."""

    def __init__(self, text: str, file: str) -> None:
        """SchemeError, with line and column, if the text is no TOML or over the limits."""
        self.file = one_line(file)
        text = text.replace("\r\n", "\n")
        if len(text) > MAX_FILE_BYTES:
            raise SchemeError(f"the file has over {MAX_FILE_BYTES} bytes", where=Where(self.file))
        self.positions = Positions(text)
        try:
            self.positions = scan(text)
            data = tomllib.loads(text, parse_float=Real)
        except TooMuch as error:
            raise self.error(error.offset, (), error.message) from None
        except tomllib.TOMLDecodeError as error:
            raise self._no_toml(str(error)) from None
        except ValueError as error:  # an integer too long for Python, which tomllib lets pass
            raise SchemeError(f"it is not valid TOML: {one_line(str(error))}", where=Where(self.file)) from None
        self.root = Node(data, (), self)

    def error(self, offset: int, path: Path, message: str, expected: str = "", mend: str = "") -> SchemeError:
        where = Where(self.file, *self.positions.line_column(offset))
        return SchemeError(message, where=where, path=path_text(path), expected=expected, mend=mend)

    def _no_toml(self, words: str) -> SchemeError:
        """tomllib's error, whose words end in (at line 3, column 7) or (at end of document)."""
        message, _, place = words.rpartition(" (at ")
        numbers = [int(number) for number in re.findall("[0-9]+", place)]
        line, column = numbers if len(numbers) == 2 else self.positions.line_column(len(self.positions.text))
        found = one_line(message[:1].lower() + message[1:200])
        return SchemeError(f"it is not valid TOML: {found}", where=Where(self.file, line, column))


def path_text(path: Path) -> str:
    """closure.equations[2]; keys that are no names are quoted."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += ("." if text else "") + (part if NAME.fullmatch(part) and len(part) < 60 else quoted(part))
    return text


@dataclass(frozen=True, slots=True)
class Node:
    """A value of the document and its path. The methods that expect something raise SchemeError with its place."""

    value: object
    path: Path
    document: Document

    def error(self, message: str, expected: str = "", mend: str = "") -> SchemeError:
        """An error at the value."""
        return self.document.error(self.document.positions.value_offset(self.path), self.path, message, expected, mend)

    def key_error(self, message: str, expected: str = "", mend: str = "") -> SchemeError:
        """An error at the key."""
        return self.document.error(self.document.positions.key_offset(self.path), self.path, message, expected, mend)

    def formula_error(self, fault: FormulaError) -> SchemeError:
        """An error inside a formula, at the very character where the string holds no escapes."""
        offset = self.document.positions.inside(self.path, fault.offset)
        return self.document.error(offset, self.path, fault.message, fault.expected, fault.mend)

    @property
    def line_column(self) -> tuple[int, int]:
        return self.document.positions.line_column(self.document.positions.value_offset(self.path))

    def table(self, known: Sequence[str] | None = None) -> dict[str, Node]:
        """The entries of a table, in file order; an error for a key that is not known (None: any key will do)."""
        if not isinstance(self.value, dict):
            raise self.error(f"found {self.kind}", "expected a table")
        entries = {key: Node(value, (*self.path, key), self.document) for key, value in self.value.items()}
        for key, node in entries.items():
            if known is not None and key not in known:
                expected = f"the keys here are {', '.join(known)}"
                raise node.key_error(f"unknown key {quoted(key)}", expected, nearest(key, known))
        return entries

    def array(self) -> list[Node]:
        if not isinstance(self.value, list):
            raise self.error(f"found {self.kind}", "expected an array [...]")
        return [Node(value, (*self.path, index), self.document) for index, value in enumerate(self.value)]

    def string(self) -> str:
        if not isinstance(self.value, str):
            raise self.error(f"found {self.kind}", 'expected a string "..."')
        return self.value

    def boolean(self) -> bool:
        if not isinstance(self.value, bool):
            raise self.error(f"found {self.kind}", "expected true or false")
        return self.value

    def integer(self) -> int:
        if not isinstance(self.value, int) or isinstance(self.value, bool):
            raise self.error(f"found {self.kind}", "expected an integer")
        return self.value

    def number(self) -> Fraction | float:
        """An exact number, or an infinite float."""
        if isinstance(self.value, int) and not isinstance(self.value, bool):
            if abs(self.value) >= 10**MAX_DIGITS:
                raise self.error(f"a number of over {MAX_DIGITS} digits")
            return Fraction(self.value)
        if not isinstance(self.value, Real):
            raise self.error(f"found {self.kind}", "expected a number")
        text = self.value.text.replace("_", "")
        if text.endswith("inf"):
            return -inf if text.startswith("-") else inf
        if text.endswith("nan"):
            raise self.error("found nan", "expected a number")
        try:
            return rational(text)
        except TooLarge as error:
            raise self.error(str(error)) from None

    def formula(self) -> str:
        """The text of a formula: a string, or a finite number as it is spelled."""
        if isinstance(self.value, str):
            return self.value
        if isinstance(self.value, int | Real) and not isinstance(self.value, bool):
            number = self.number()
            if isinstance(number, Fraction):
                return self.value.text.replace("_", "") if isinstance(self.value, Real) else str(self.value)
        raise self.error(f"found {self.kind}", 'expected a formula "..." or a number')

    @property
    def kind(self) -> str:
        """What the value is, for a message."""
        match self.value:
            case dict():
                return "a table"
            case list():
                return "an array"
            case str():
                return f"the string {quoted(self.value)}"
            case bool():
                return str(self.value).lower()
            case Real():
                return quoted(self.value.text)[1:-1]
            case int():
                return quoted(self.document.positions.raw(self.path))[1:-1]
        return "a date or time"
