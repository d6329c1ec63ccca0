# ruff: noqa: E501 - pieces and formulas, one a line
"""Files written to break the reader: always a scheme or one located message, in bounded time and memory."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from gks.errors import SchemeError
from gks.scheme.schemefile import parse_scheme, read_scheme
from tests.scheme.examples import IN_LINES, INTERFACE, LEAPFROG, changed

LINES = changed(LEAPFROG, IN_LINES)
VALID = [INTERFACE, LEAPFROG, LINES]


def survives(text: str) -> None:
    """A scheme, or a one-line message with a line and a column."""
    try:
        parse_scheme(text, "hostile")
    except SchemeError as error:
        assert str(error).isprintable() and len(str(error)) < 2000
        assert error.where is not None and error.where.line is not None and error.where.column is not None


# --- fuzzing -------------------------------------------------------------------------------------------------------

PIECES = [
    *'"\'[]{}().,=#+-*/^\n\\', '"""', "'''", "[[", "]]", "**", "==", " ", "\t", "\r", "\0", "\ufeff", "\ud800", "é", "λ", "−",
    "0", "1", "65", "-1", "1e9", "1e99999", "0x1F", "inf", "nan", "true", "1979-05-27", "1/0", "sqrt(", "dt(", "min(",
    "i", "n", "n+1", "i+1", "u", "u[0]", "L.u[1]", "lam", "alpha", "__import__('os')", "{}", "[]", "u_I", "s_I",
    "title", "[parameters]", "[interior]", "[domains.R]", "[closure]", "[definitions]", "[[claims]]", "first = 1",
    'space = "upwind2"', 'scheme = "fromm"', 'time = "rk4"', "role", "default", "range = [1, 2]", "let", "equations = []",
]  # fmt: skip

edits = st.lists(
    st.tuples(st.floats(0, 1), st.integers(0, 12), st.sampled_from(PIECES) | st.text(max_size=3)),
    min_size=1,
    max_size=4,
)


@given(st.sampled_from(VALID), edits)
def test_edited_files(text: str, changes: list[tuple[float, int, str]]) -> None:
    for place, removed, inserted in changes:
        start = int(place * len(text))
        text = text[:start] + inserted + text[start + removed :]
    survives(text)


@given(st.sampled_from(VALID), st.integers(0, 900))
def test_truncated_files(text: str, length: int) -> None:
    survives(text[:length])


@given(st.lists(st.sampled_from(PIECES), max_size=30).map("".join))
def test_formulas_of_pieces(formula: str) -> None:
    quoted = "'''" + formula.replace("'", "") + "'''"
    survives(changed(LINES, ('"u[0, n+1] = u[1, n+1]"', quoted)))
    survives(changed(INTERFACE, ('"-1/alpha"', quoted), ('"min(1, 4/(1 + 1/alpha))"', quoted)))


def spliced(text: str) -> st.SearchStrategy[bytes]:
    return st.binary(max_size=9).map(lambda data: text[:300].encode() + data + text[300:].encode())


@given(st.binary(max_size=200) | st.sampled_from(VALID).flatmap(spliced))
@example(b"\xff\xfe")
def test_bytes(data: bytes) -> None:
    with tempfile.NamedTemporaryFile(suffix=".toml") as file:
        file.write(data)
        file.flush()
        try:
            read_scheme(file.name)
        except SchemeError as error:
            assert str(error).isprintable() and str(error).startswith(file.name)


# --- files that cost too much --------------------------------------------------------------------------------------

HEAD = 'title = "x"\n[parameters]\nlam = { role = "cfl", default = 0.5 }\nalpha = 2\n'
DOMAIN = '[domains.R]\nside = "right"\nunknowns = ["u"]\ninterior = ["u[i,n+1] = u[i] + lam*(u[i+1] - u[i-1])"]\n'
FULL = 950_000


def filled(part: Callable[[int], str], separator: str = ",") -> str:
    """As many parts as nearly fill the largest file."""
    parts: list[str] = []
    size = 0
    while size < FULL:
        parts.append(part(len(parts)))
        size += len(parts[-1]) + len(separator)
    return separator.join(parts)


def closure(equations: str) -> str:
    return f"{HEAD}{DOMAIN}[closure]\nequations = [{equations}]\n"


def definitions(lines: str) -> str:
    return f"{HEAD}[definitions]\n{lines}\n{DOMAIN}"


def flux(size: int, entry: Callable[[int], str]) -> str:
    unknowns = ", ".join(f'"u{k}"' for k in range(size))
    rows = ", ".join("[" + ", ".join(f'"{entry(i * j)}"' for j in range(size)) + "]" for i in range(size))
    interior = '[interior]\nspace = "upwind2"\ntime = "rk4"\n'
    return f'{HEAD}{interior}[domains.R]\nside = "right"\nunknowns = [{unknowns}]\nflux = [{rows}]\n'


COSTLY = {
    "a sum of 1e5 terms": closure('"u[-1] = ' + filled(lambda k: f"u[{k % 60}]", "+") + '"'),
    "thousands of equations": closure(filled(lambda k: f'"u[-1] = {k}*u[0]"')),
    "thousands of denominators": closure(filled(lambda k: f'"u[-1] = u[0]/(lam + {k}*alpha)"')),
    "thousands of roots": closure(filled(lambda k: f'"u[-1] = (sqrt((lam + {k})**2) - lam - {k})*u[0]"')),
    "high powers that cancel": closure(filled(lambda k: f'"u[-1] = ((9*lam+alpha+{k})**1000 - ({k}+alpha+9*lam)**1000)*u[0]"')),
    "numbers of 10000 digits": closure(filled(lambda k: f'"u[-1] = (1e{9999 - k % 99} + 1e-{9999 - k % 98})*u[0]"')),
    "definitions that double": definitions("\n".join(f'a{k} = "a{k + 1} + a{k + 1}"' for k in range(9000)) + '\na9000 = "lam"'),
    "definitions in a circle": definitions("\n".join(f'a{k} = "a{(k + 1) % 12000}"' for k in range(12000))),
    "brackets that never close": "a = " + "[" * FULL,
    "a key of many parts": "a." * (FULL // 2) + "a = 1",
    "many keys of many parts": filled(lambda k: f"[a{k}." + ".".join("b" * 18) + "]", "\n"),
    "minus signs": closure('"u[-1] = ' + "-" * FULL + 'u[0]"'),
    "a dense flux": flux(16, lambda k: f"{k % 7}*alpha - {k % 5}"),
    "a flux of high degree": flux(4, lambda k: f"(alpha + {k}*lam)**1000"),
    "a flux of long sums": flux(2, lambda k: "+".join(f"alpha/{j + k + 1}" for j in range(8000))),
}  # fmt: skip


@pytest.mark.parametrize("name", COSTLY)
def test_costly_files(name: str, tmp_path: Path) -> None:
    """Under two seconds of processor time and 500 MB, held by the operating system."""
    path = tmp_path / "costly.toml"
    path.write_text(COSTLY[name])
    assert path.stat().st_size <= 1_000_000

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (3, 3))  # start-up included, on a machine that may be busy
        resource.setrlimit(resource.RLIMIT_DATA, (500_000_000, 500_000_000))

    program = (
        "import sys\nfrom gks.errors import SchemeError\nfrom gks.scheme.schemefile import read_scheme\n"
        "try: read_scheme(sys.argv[1])\nexcept SchemeError as error: print(error)\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, preexec_fn=limited, check=False
    )  # fmt: skip
    assert run.returncode == 0, run.stderr[-500:]
    assert run.stdout.count("\n") == 1 and run.stdout.startswith(f"{path}:")


def test_nothing_in_a_formula_is_executed(tmp_path: Path) -> None:
    target = tmp_path / "executed"
    for code in (f"__import__('os').system('touch {target}')", f"open('{target}', 'w')", "exec('1')", "u.__class__"):
        survives(changed(INTERFACE, ('"-1/alpha"', f'"{code}"')))
        survives(changed(LEAPFROG, ('"u[0, n+1] = u[1, n+1]"', f'"{code}"')))
    assert not target.exists()
