"""Formula text cut into tokens, and the error that knows its place in the text."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from gks.errors import TooLarge, quoted
from gks.scheme.limits import TOKEN_WORK, Work


class FormulaError(Exception):
    """A formula is at fault at `offset` (characters from the start of its text). The reader adds file and line."""

    def __init__(self, offset: int, message: str, expected: str = "", mend: str = "") -> None:
        super().__init__(message)
        self.offset = offset
        self.message = message
        self.expected = expected
        self.mend = mend


class Token(NamedTuple):
    """A piece of a formula; `offset` counts characters from the start of its text."""

    kind: str  # "number", "name", "end" or the operator itself
    text: str
    offset: int


NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

_TOKEN = re.compile(
    r"[ \t\r\n]*(?:(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<operator>\*\*|[-+*/()\[\],.=]))"
)

_MENDS = {
    "^": "a power is written with **",
    "\u2212": "a minus sign is written -",
    "\u00d7": "a product is written with *",
    "\u00b7": "a product is written with *",
    "{": "group with parentheses",
    "'": "a formula holds no strings",
    '"': "a formula holds no strings",
}


def tokenize(text: str, work: Work) -> list[Token]:
    """The tokens of a formula with a closing "end". FormulaError for a character that has no place in one."""
    tokens: list[Token] = []
    place = 0
    while match := _TOKEN.match(text, place):
        kind = match.lastgroup or ""
        word = match[kind]
        tokens.append(Token(word if kind == "operator" else kind, word, match.end() - len(word)))
        place = match.end()
        try:
            work.spend(TOKEN_WORK)
        except TooLarge as error:
            raise FormulaError(tokens[-1].offset, str(error), mend="write fewer or shorter formulas") from None
    rest = text[place:].lstrip(" \t\r\n")
    if rest:
        offset = len(text) - len(rest)
        raise FormulaError(offset, f"{character(rest[0])} has no place in a formula", mend=_MENDS.get(rest[0], ""))
    tokens.append(Token("end", "", len(text)))
    return tokens


def character(char: str) -> str:
    """A character for a message; outside ASCII with its code point, since it may look like another."""
    if char.isascii():
        return quoted(char)
    return f"{quoted(char)} (U+{ord(char):04X} {unicodedata.name(char, 'without a name')})"


class Cursor:
    """A place in the tokens of a formula."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.tokens = tokens
        self.place = 0

    @property
    def token(self) -> Token:
        return self.tokens[self.place]

    def take(self, *kinds: str) -> Token | None:
        """Step over the next token if it is one of these."""
        token = self.tokens[self.place]
        if token.kind not in kinds:
            return None
        self.place += 1
        return token

    def expect(self, kind: str, where: str) -> Token:
        token = self.take(kind)
        if token is None:
            raise FormulaError(self.token.offset, f"found {self.found()} {where}", f'expected "{kind}"')
        return token

    def found(self) -> str:
        return "the end of the formula" if self.token.kind == "end" else quoted(self.token.text)


def listed(names: Iterable[str], most: int = 12) -> str:
    """A list of names for a message, cut short."""
    shown = list(names)
    return ", ".join(quoted(n, 30)[1:-1] for n in shown[:most]) + (", ..." if len(shown) > most else "") or "nothing"
