"""What can go wrong, said so that the reader knows where, what was found, what was expected and what would mend it."""

from __future__ import annotations

from dataclasses import dataclass


class GksError(Exception):
    """Every error this package raises on purpose."""


@dataclass(frozen=True, slots=True)
class Where:
    """A place in a file; lines and columns count characters from 1, as editors do."""

    file: str
    line: int | None = None
    column: int | None = None

    def __str__(self) -> str:
        return ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)


class InputError(GksError):
    """The input is at fault (exit status 2).

    message   what was found
    where     the file, line and column, if there is a file
    path      the entry of the file ("closure.equations[2]") or the parameter ("alpha")
    expected  what would have been right
    mend      what to do about it

    str() is one line: `half_step.toml:14:9: closure.equations[2]: <message>; <expected>; <mend>`.
    """

    def __init__(
        self, message: str, *, where: Where | None = None, path: str = "", expected: str = "", mend: str = ""
    ) -> None:
        super().__init__(message)
        self.message = message
        self.where = where
        self.path = path
        self.expected = expected
        self.mend = mend

    def __str__(self) -> str:
        place = [str(self.where)] if self.where is not None else []
        entry = [one_line(self.path)] if self.path else []
        words = "; ".join(shortened(part, LONGEST) for part in (self.message, self.expected, self.mend) if part)
        return one_line(": ".join([*place, *entry, words]))

    def __reduce__(self) -> tuple[object, ...]:
        """Pickled with all its fields, so that a worker process can report it as it was."""
        return _rebuild, (type(self), self.message, self.where, self.path, self.expected, self.mend)


class SchemeError(InputError):
    """The scheme file is at fault."""


class ParameterError(InputError):
    """A value given for a parameter is at fault."""


class NotAnalysable(InputError):
    """The scheme is valid, but this analysis does not apply to it or does not exist."""


class IrrationalValue(GksError):
    """A square root that is not rational at the values given, where an exact rational was asked for."""


class TooLarge(InputError):
    """A formula or number beyond the fixed limits of gks.scheme.limits."""


def _rebuild(
    kind: type[InputError], message: str, where: Where | None, path: str, expected: str, mend: str
) -> InputError:
    return kind(message, where=where, path=path, expected=expected, mend=mend)


def one_line(text: str) -> str:
    """The text with every control and unprintable character escaped, so that a message stays one line."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def counted(number: int, noun: str) -> str:
    """`1 row`, `3 rows`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


LONGEST = 500
"""Characters of each part of a message; what is longer quotes numbers or formulas that nobody reads to the end."""


def shortened(text: str, most: int) -> str:
    """The text, shortened in the middle to `most` characters."""
    half = (most - 3) // 2
    return text if len(text) <= most else text[:half] + "..." + text[-half:]


def quoted(text: str, most: int = 60) -> str:
    """User text for a message: in quotes, on one line, shortened in the middle to `most` characters."""
    return '"' + one_line(shortened(text, most)) + '"'
