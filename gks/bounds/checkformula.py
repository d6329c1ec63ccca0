"""Formulas of a certificate, read straight into an algebra: numbers, names, + - * / **, parentheses and sqrt.

Part of the checker: it shares nothing with what writes the formulas.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Protocol

from flint import fmpz

_TOKEN = re.compile(r"\s*(?:(\d+)|([^\W\d]\w*)|(\*\*|[-+*/()]))")

DEEPEST = 100
"""Parentheses within parentheses that a certificate may hold."""


class Rejected(Exception):
    """The certificate does not hold; the message says where."""


class Reading(Protocol):
    """What a formula is read into: integers become elements, and elements support + - * / and integer powers."""

    def integer(self, value: int, /) -> Any: ...
    def sqrt(self, value: Any, /) -> Any: ...


def read(text: object, reading: Reading, names: Mapping[str, Any]) -> Any:
    """The value of a formula. Rejected where it is none."""
    if not isinstance(text, str):
        raise Rejected(f"{text!r} is no formula")
    reader = _Reader(text, reading, names)
    value = reader.sum(0)
    if reader.peek() is not None:
        raise Rejected(f"{text!r} is no formula")
    return value


class _Reader:
    def __init__(self, text: str, reading: Reading, names: Mapping[str, Any]) -> None:
        self.text, self.reading, self.names = text, reading, names
        self.tokens: list[str] = []
        place = 0
        while text[place:].strip():
            match = _TOKEN.match(text, place)
            if match is None:
                raise Rejected(f"{text!r} is no formula")
            self.tokens.append(match[1] or match[2] or match[3])
            place = match.end()
        self.place = 0

    def peek(self) -> str | None:
        return self.tokens[self.place] if self.place < len(self.tokens) else None

    def take(self, *wanted: str) -> str | None:
        token = self.peek()
        if token is None or (wanted and token not in wanted):
            return None
        self.place += 1
        return token

    def sum(self, depth: int) -> Any:
        value = -self.product(depth) if self.take("-") else self.product(depth)
        while sign := self.take("+", "-"):
            value = value + self.product(depth) if sign == "+" else value - self.product(depth)
        return value

    def product(self, depth: int) -> Any:
        value = self.power(depth)
        while sign := self.take("*", "/"):
            value = value * self.power(depth) if sign == "*" else value / self.power(depth)
        return value

    def power(self, depth: int) -> Any:
        base = self.atom(depth)
        if self.take("**"):
            exponent = self.take()
            if exponent is None or not exponent.isdigit() or len(exponent) > 4:
                raise Rejected(f"{self.text!r}: an exponent is not a whole number")
            base = base ** int(exponent)
        return base

    def atom(self, depth: int) -> Any:
        token = self.take()
        if token is None or depth > DEEPEST:
            raise Rejected(f"{self.text!r} is no formula")
        if token.isdigit():
            return self.reading.integer(int(fmpz(token)))  # of any length
        if token == "(" or (token == "sqrt" and self.take("(")):
            value = self.sum(depth + 1)
            if not self.take(")"):
                raise Rejected(f"{self.text!r}: a parenthesis is not closed")
            return self.reading.sqrt(value) if token == "sqrt" else value
        if token in self.names:
            return self.names[token]
        raise Rejected(f"{self.text!r}: {token!r} means nothing here")
