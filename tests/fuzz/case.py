"""One fuzzed input: a file of any bytes, and the command line that it is thrown at.

A case is kept as one file: the command line as a comment, `# ["modes", "FILE", "--json"]`, then the bytes of the scheme
file as they are. So a case that holds text opens in an editor as what it is.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

FILE = "FILE"
"""Stands for the scheme file on a command line."""

COMMANDS = ("derive", "modes", "curve", "prove", "audit", "march")
OUTPUTS = (
    "out.csv",
    "out.json",
    "out.toml",
    "out",
    "",
    ".csv",
    "nowhere/out.csv",
    ".",
    "o\x00ut.csv",
    "ö" * 200 + ".csv",
)
"""Where -o may point: nothing else is tried, since a fuzzer that makes up paths would write to them."""
MOST_BYTES = 1_100_000
"""A little above the largest scheme file."""


@dataclass(frozen=True, slots=True)
class Case:
    """``arguments`` are a command and its options, with FILE among them; ``payload`` is what the file holds."""

    arguments: tuple[str, ...]
    payload: bytes

    def data(self) -> bytes:
        """The case as a file."""
        return b"# " + json.dumps(self.arguments).encode() + b"\n" + self.payload

    @property
    def stored(self) -> bool:
        """Whether it may be run: a command that is listed, an output that is listed, a file of bounded size."""
        where = [k for k, text in enumerate(self.arguments) if text == "-o"]
        outputs = all(k + 1 < len(self.arguments) and self.arguments[k + 1] in OUTPUTS for k in where)
        attached = any(text.startswith("-o") and text != "-o" for text in self.arguments)
        known = bool(self.arguments) and self.arguments[0] in COMMANDS and self.arguments.count(FILE) == 1
        return known and outputs and not attached and len(self.payload) <= MOST_BYTES


def parsed(data: bytes) -> Case:
    """The case that a file holds; bytes without a command line that may be run are a scheme file for `gks modes`."""
    first, _, payload = data.partition(b"\n")
    if first.startswith(b"# ["):
        try:
            arguments = json.loads(first[2:])
        except (ValueError, RecursionError):
            arguments = None
        if isinstance(arguments, list) and all(isinstance(text, str) for text in arguments):
            case = Case(tuple(arguments), payload)
            if case.stored:
                return case
    return Case(("modes", FILE, "--json"), data[:MOST_BYTES])
