"""Where keys and values stand in a TOML text: whatever tomllib finds has a place, and its costs are capped."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.scheme.limits import MAX_ENTRIES, MAX_KEY_PARTS, MAX_TOML_NESTING
from gks.scheme.toml_positions import Path, TooMuch, scan

TEXT = """\
# a comment = [1, 2
title = "a # b"   # c
a.b = [1, "x]", [2.5]]
"q.\\u0041" = 'lit"eral'

[t . "u v"]
when = 1979-05-27 07:32:00
inline = { x = 1, y.z = [ { w = true } ] }
many = '''
'''''

[[t.list]]
k = \"\"\"two
lines\"\"\"
[[t.list]]
[t.list.sub]
k = -inf
[[t.list]]
"""


def paths(value: object, path: Path = ()) -> set[Path]:
    """The path of everything in a parsed document."""
    found = {path} if path else set()
    if isinstance(value, dict):
        return found.union(*(paths(v, (*path, k)) for k, v in value.items()))
    if isinstance(value, list):
        return found.union(*(paths(v, (*path, k)) for k, v in enumerate(value)))
    return found


def test_everything_has_a_place() -> None:
    positions = scan(TEXT)
    assert set(positions.keys) | set(positions.values) == paths(tomllib.loads(TEXT))


@pytest.mark.parametrize(
    ("path", "line", "column", "raw"),
    [
        (("title",), 2, 9, '"a # b"'),
        (("a", "b"), 3, 7, '[1, "x]", [2.5]]'),
        (("a", "b", 1), 3, 11, '"x]"'),
        (("a", "b", 2, 0), 3, 18, "2.5"),
        (("q.A",), 4, 14, "'lit\"eral'"),
        (("t", "u v", "when"), 7, 8, "1979-05-27 07:32:00"),
        (("t", "u v", "inline", "y", "z", 0, "w"), 8, 33, "true"),
        (("t", "u v", "many"), 9, 8, "'''\n'''''"),
        (("t", "list", 0, "k"), 13, 5, '"""two\nlines"""'),
        (("t", "list", 1, "sub", "k"), 17, 5, "-inf"),
    ],
)
def test_places_of_values(path: Path, line: int, column: int, raw: str) -> None:
    positions = scan(TEXT)
    assert positions.line_column(positions.value_offset(path)) == (line, column)
    assert positions.raw(path) == raw


@pytest.mark.parametrize(
    ("path", "line", "column"),
    [
        (("a",), 3, 1),
        (("t", "u v"), 6, 2),
        (("t", "list", 0), 12, 3),
        (("t", "list", 1), 15, 3),
        (("t", "list", 1, "sub"), 16, 2),
        (("t", "u v", "inline", "x"), 8, 12),
        (("t", "list", 2, "no such key"), 18, 3),
        (("nowhere",), 1, 1),
    ],
)
def test_places_of_keys(path: Path, line: int, column: int) -> None:
    positions = scan(TEXT)
    assert positions.line_column(positions.key_offset(path)) == (line, column)


@pytest.mark.parametrize(
    ("value", "column"),
    [
        ("'abc'", 8),
        ('"abc"', 8),
        ("'''abc'''", 10),
        ('"""abc"""', 10),
        ('"a\\tbc"', 5),
    ],
)
def test_characters_inside_strings(value: str, column: int) -> None:
    """Exact where nothing is escaped, else the start of the string."""
    positions = scan(f"k = {value}")
    assert positions.line_column(positions.inside(("k",), 2)) == (1, column)


def test_characters_inside_strings_of_several_lines() -> None:
    positions = scan("k = '''\nab\ncd'''")
    assert positions.line_column(positions.inside(("k",), 4)) == (3, 2)


# --- any document --------------------------------------------------------------------------------------------------

words = st.text(alphabet="ab_-.\"'\\ é[]#=\n", max_size=5)
values = st.recursive(
    st.one_of(words, st.integers(), st.booleans(), st.floats()),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(words, inner, max_size=3)),
    max_leaves=8,
)


def written(value: object, draw: st.DrawFn) -> str:
    """A value as TOML, in one of the ways there are."""
    gap = draw(st.sampled_from(["", " ", "\t"]))
    if isinstance(value, dict):
        return "{" + gap + ", ".join(f"{quote(k)}{gap}={gap}{written(v, draw)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        comma = draw(st.sampled_from([",", " , ", ",\n", ", # ]\n"]))
        return "[" + gap + comma.join(written(v, draw) for v in value) + gap + "]"
    if isinstance(value, str):
        ways = [quote(value), '"""' + quote(value)[1:-1] + '"""', '"""\n' + quote(value)[1:-1] + '"""']
        if "'" not in value and "\n" not in value:
            ways += [f"'{value}'", f"'''{value}'''"]
        return draw(st.sampled_from(ways))
    return str(value).lower()


def quote(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


@st.composite
def documents(draw: st.DrawFn) -> str:
    lines = []
    tables = st.tuples(words, st.booleans(), st.dictionaries(words, values, max_size=3))
    for name, is_array, entries in draw(st.lists(tables, max_size=4)):
        brackets = ("[[", "]]") if is_array else ("[", "]")
        lines.append(f"{brackets[0]} {quote(name)} . {quote('x')} {brackets[1]} # comment")
        lines += [f"{quote(k)} = {written(v, draw)}" for k, v in entries.items()]
    return "\n".join(lines)


@given(documents())
def test_every_valid_document_is_scanned_in_full(text: str) -> None:
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:  # a table twice
        return
    positions = scan(text)
    assert set(positions.keys) | set(positions.values) == paths(data)
    for path in positions.values:
        raw = tomllib.loads("v = " + positions.raw(path))["v"]
        there: object = data
        for part in path:
            there = there[part]  # type: ignore[index]
        assert repr(raw) == repr(there)


@given(st.text(alphabet="ab.=[]{}\"'\\,#\n 1", max_size=60))
def test_no_text_upsets_the_scanner(text: str) -> None:
    scan(text)


# --- limits --------------------------------------------------------------------------------------------------------


def nested(depth: int) -> str:
    return "a = " + "[" * depth + "]" * depth


@pytest.mark.parametrize(
    ("fits", "too_much"),
    [
        (nested(MAX_TOML_NESTING), nested(MAX_TOML_NESTING + 1)),
        ("[" + ".".join("a" * MAX_KEY_PARTS) + "]", "[" + ".".join("a" * (MAX_KEY_PARTS + 1)) + "]"),
        ("a = [" + "1," * (MAX_ENTRIES - 2) + "]", "a = [" + "1," * (MAX_ENTRIES - 1) + "]"),
        ("a = " + "1" * 4000, "a = " + "1" * 4001),
    ],
)
def test_limits(fits: str, too_much: str) -> None:
    scan(fits)
    with pytest.raises(TooMuch):
        scan(too_much)


def test_brackets_that_never_close_are_refused_too() -> None:
    with pytest.raises(TooMuch):
        scan("a = " + "[" * 500_000)
