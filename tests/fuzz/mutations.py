# ruff: noqa: E501 - tables of pieces
"""From one case to another: edits of every kind that a stranger's file or a slip of the hand may hold.

All of them draw from the `Random` given, which may be hypothesis's own, so that a case found in the suite shrinks.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from random import Random

from tests.fuzz.case import COMMANDS, FILE, MOST_BYTES, OUTPUTS, Case

LIMITED = COMMANDS
"""The commands that take --limit, all of them: a scheme for which an analysis is long is no fault."""

Mutation = Callable[[str, Random], str]

WEIGHTS = (3, 8, 3, 1, 1, 2)
"""How often each of COMMANDS is tried: `modes` is what the others begin with, and a proof or an audit takes longest."""

NUMBERS = (
    "0", "-0", "1", "-1", "2/3", "1/0", "0/0", "65", "64", "1001", "1e300", "1e-300", "1e9999", "1e-9999", "1e10001", "1e999999999999", "0x1F",
    "1_000", "inf", "-inf", "nan", "+1", "١٢", "1e", ".5", "5.", "1.0000000000000001", "0.99999999999999999999999999", "9" * 4000, "9" * 4001,
    "0." + "3" * 3990, "1e-308", "5e-324", "true", "1979-05-27", "0.1e-400/3", "1j", "sqrt(2)", "1e400", "-1e-400",
)  # fmt: skip
WORDS = (
    *'"\'[]{}().,=#+-*/^\n\\:;%&|~<>!@$', '"""', "'''", "[[", "]]", "**", "==", "->", " ", "\t", "\r\n", "\0", "\ufeff", "\x1b[2J", "é", "λ", "−",
    "аlpha", "ｕ", "ℓam", "\u202e", "\u200b", "𝑢", "i", "n", "n+1", "n-64", "i+1", "i+64", "i-65", "u", "u[0]", "u[i]", "L.u[1]", "R.u[-1, n+1]",
    "lam", "alpha", "dt(", "sqrt(", "min(", "max(", "abs(", "lambda x: x", "__import__", "u.__class__", "{}", "[]", "title", "[parameters]",
    "[interior]", "[domains.R]", "[domains.L]", "[closure]", "[definitions]", "[[claims]]", "first = 64", 'side = "left"', 'space = "central6"',
    'space = "compact4"', 'scheme = "fromm"', 'time = "rk4"', 'time = "exact"', 'time = "bdf2"', "role", "default", "range = [-inf, inf]", "let",
    "equations = []", "at = {}", "bound", "stable = true", "modulus", "\\u0000", "\\ud800", "\\x41", "../../etc/passwd", "/dev/zero", "file:///etc/passwd",
)  # fmt: skip
CODE = (
    "__import__('os').system('touch executed')", "open('executed', 'w')", "exec('1')", "eval('1')", "u.__class__.__mro__", "().__class__", "u[0].__init__",
    "[x for x in (1,)]", "(lambda: 1)()", "u[0]; 1", "u[0] if 1 else 2", "f'{alpha}'", "alpha := 1", "'a'*9**9", "9**9**9", "u[0]\nimport os", "${HOME}",
    "`ls`", "%s%n", "{{7*7}}", "\\input{/etc/passwd}",
)  # fmt: skip


def _nested(random: Random) -> str:
    depth = random.choice((3, 60, 198, 201, 5000, 100_000))
    left, right = random.choice(
        (("(", ")"), ("sqrt(", ")"), ("-", ""), ("1/(1+", ")"), ("(alpha+", ")**2"), ("[", "]"), ("sqrt(alpha+", ")"))
    )
    return left * depth + "alpha" + right * depth


def _tower(random: Random) -> str:
    base = random.choice(("2", "alpha", "(1+alpha)", "(alpha+lam+1)", "1e9999", "(1/3)"))
    return base + random.choice(
        ("**1000", "**-1000", "**9**9**9", "**(2**(2**2))", "**1000**1000", "**1001", "**0", "**lam", "**0.5")
    )


def _sum(random: Random) -> str:
    terms = random.choice((5, 100, 3000, 60_000))
    form = random.choice(
        (
            "u[{0}]/{1}",
            "{1}*u[{0}]",
            "u[0, n-{0}]",
            "(alpha+{1})*u[{0}]",
            "u[0]/(alpha+{1})",
            "sqrt(alpha+{1})*u[0]",
            "alpha/{1}",
        )
    )
    return "+".join(form.format(k % 64, k + 1) for k in range(terms))


def _product(random: Random) -> str:
    factors = random.choice((3, 50, 1000))
    form = random.choice(("(alpha+{0})", "sqrt(alpha+{0})", "(1+lam/{0})**20", "1e9999", "1e-9999", "({0}/7)**900"))
    return "*".join(form.format(k + 1) for k in range(factors))


MAKERS: Sequence[Callable[[Random], str]] = (_nested, _tower, _sum, _product, lambda r: r.choice(CODE + NUMBERS))
PLACES = (
    "{}", "u[-1] = {}", "u[-1] = ({})*u[0]", "u[0, n+1] = u[1] + {}", "dt(u[0]) = {}", "u[i, n+1] = u[i] + {}*(u[i+1]-u[i-1])",
)  # fmt: skip


def _formula(random: Random) -> str:
    place: str = random.choice(PLACES)
    return place.format(random.choice(MAKERS)(random))


def _place(text: str, random: Random) -> int:
    return random.randint(0, len(text))


def _insert(text: str, random: Random) -> str:
    at = _place(text, random)
    word: str = random.choice(WORDS)
    return text[:at] + word + text[at + random.choice((0, 0, 1, 5)) :]


def _number(text: str, random: Random) -> str:
    found = list(re.finditer(r"(?<![\w.])[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?", text))
    if not found:
        return text
    spot = random.choice(found)
    return text[: spot.start()] + random.choice(NUMBERS) + text[spot.end() :]


def _quoted(text: str, random: Random) -> str:
    found = list(re.finditer(r'"[^"\n]*"', text))
    if not found:
        return text
    spot = random.choice(found)
    return text[: spot.start()] + '"' + _formula(random) + '"' + text[spot.end() :]


def _lines(text: str, random: Random) -> str:
    lines = text.split("\n")
    at, other = random.randrange(len(lines)), random.randrange(len(lines))
    kind = random.randrange(4)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines[at], lines[other] = lines[other], lines[at]
    else:
        lines[at:at] = [lines[other]] * random.choice((1, 1, 2, 50, 3000))
    return "\n".join(lines)


def _words(text: str, random: Random) -> str:
    """One name for another of the same file: wrong unknowns, wrong indices, cycles of definitions."""
    found = list(re.finditer(r"[A-Za-z_]\w*(?:\[[^\]\n]*\])?", text))
    if not found:
        return text
    spot, other = random.choice(found), random.choice(found)
    return text[: spot.start()] + other.group() + text[spot.end() :]


def _many(text: str, random: Random) -> str:
    """Thousands of parameters, definitions, equations or claims."""
    count = random.choice((3, 60, 199, 5000))
    head, form = random.choice(
        (
            ("[parameters]", "p{0} = {0}"),
            ("[definitions]", 'd{0} = "d{1}"'),
            ("[definitions]", 'd{0} = "d{1} + d{1}"\n'),
            ("equations = [", '"u[-{1}] = {1}*u[0]",'),
            ("equations = [", '"u[{0}, n+1] = u[{1}] + lam*(u[{1}] - u[{0}])",'),
            ("[closure]", '[[claims]]\nsource = "{0}"\nbound = "1/{1}"\n[closure]'),
        )
    )
    filled = "\n".join(form.format(k, k + 1) for k in range(count))
    return text.replace(head, f"{head}\n{filled}\n", 1) if head in text else f"{text}\n{head}\n{filled}\n"


TEXT: Sequence[Mutation] = (_insert, _insert, _number, _number, _quoted, _quoted, _lines, _words, _words, _many)


def _bytes(data: bytes, random: Random) -> bytes:
    """What no text editor writes: cut short, not UTF-8, a byte order mark, NUL, line ends of another system."""
    at = random.randint(0, len(data))
    kind = random.randrange(7)
    if kind == 0:
        return data[:at]
    if kind == 1:
        return data[:at] + bytes(random.randrange(256) for _ in range(random.choice((1, 2, 9)))) + data[at:]
    if kind == 2:
        return random.choice((b"\xef\xbb\xbf", b"\xff\xfe", b"\x00", b"\xef\xbb\xbf\xef\xbb\xbf")) + data
    if kind == 3:
        return data.replace(b"\n", random.choice((b"\r\n", b"\r", b"\n\r", b"\x0b", b"\xe2\x80\xa8")))
    if kind == 4:
        return data.decode("utf-8", "replace").encode(
            random.choice(("utf-16", "utf-32", "latin-1", "utf-7")), "replace"
        )
    if kind == 5:
        return bytes(random.randrange(256) for _ in range(random.choice((0, 1, 40))))
    return data[:at] + b"\x00" + data[at + 1 :]


def command_line(random: Random) -> tuple[str, ...]:
    """A command with options that are right, or of a stranger's making."""
    command = random.choices(COMMANDS, WEIGHTS)[0]
    options: list[str] = [] if random.randrange(3) else ["--json"]
    if command != "audit":
        for _ in range(random.choice((0, 0, 1, 1, 2))):
            name = random.choice(("alpha", "lam", "lam", "beta", "λ", "", "l am", "a=b"))
            options += ["-p", f"{name}={random.choice(NUMBERS)}"]
    if command == "curve":
        ends = (random.choice(("1e-2", "1", *NUMBERS)), random.choice(("2", "1e2", *NUMBERS)))
        count = random.choice(("1", "2", "5", "5", "0", "-1", "1e12", "99999999", "٣", "", "2.5"))
        options += ["--sweep", f"alpha={ends[0]}:{ends[1]}:{count}" + random.choice(("", ":log", ":lin", ":x"))]
    if command == "march":
        options += ["--cells", random.choice(("1", "2", "20", "40", "999999999", "1000000000", "0", "-5", "٣"))]
        options += ["--steps", random.choice(("1", "2", "20", "60", "999999999", "0", "x"))]
    if command in ("curve", "prove") and not random.randrange(3):
        options += ["-o", random.choice(OUTPUTS)]
    if command in LIMITED:
        options += ["--limit", "1"]
    return (command, FILE, *options)


def mutated(case: Case, random: Random) -> Case:
    """The case after one to four edits, of its file or its command line; at most MOST_BYTES."""
    arguments, payload = case.arguments, case.payload
    if not random.randrange(4):
        arguments = command_line(random)
    for _ in range(random.choice((1, 1, 2, 4))):
        if random.randrange(8):
            payload = random.choice(TEXT)(payload.decode("utf-8", "surrogateescape"), random).encode(
                "utf-8", "surrogateescape"
            )
        else:
            payload = _bytes(payload, random)
        payload = payload[:MOST_BYTES]
    return Case(arguments, payload)
