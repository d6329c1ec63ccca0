"""Which boundary values a closure has to give: counted from the formulas, one equation each."""

from __future__ import annotations

import re

import pytest

from gks.scheme.boundary import without_equation
from tests.scheme.examples import INTERFACE, LEAPFROG, changed, read, refusal

INTERIOR = "u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"
EQUATION = '"u[0, n+1] = u[1, n+1]"'


def unknowns(interior: str, first: int, closure: list[str], side: str = "right") -> list[str]:
    scheme = read(
        LEAPFROG,
        (INTERIOR, interior),
        ("first    = 1", f"first    = {first}"),
        (EQUATION, ", ".join(f'"{equation}"' for equation in closure)),
        ('"right"', f'"{side}"'),
    )
    return [str(value) for value in scheme.boundary_unknowns]


@pytest.mark.parametrize(
    ("interior", "first", "closure", "expected"),
    [
        ("u[i, n+1] = u[i-1]", 0, ["u[-1] = u[0]"], ["R.u[-1]"]),
        ("u[i, n+1] = u[i-1]", 1, ["u[0] = u[1]"], ["R.u[0]"]),
        ("u[i, n+1] = u[i-1]", -3, ["u[-4] = u[0]"], ["R.u[-4]"]),
        ("u[i, n+1] = u[i+1]", 0, [], []),
        # an offset of -2 reaches -2 and, one cell on, -1
        ("u[i, n+1] = u[i] + u[i-2]", 0, ["u[-1] = u[0]", "u[-2] = u[0]"], ["R.u[-2]", "R.u[-1]"]),
        # offsets count at every level and under dt
        ("u[i, n+1] = u[i] + u[i-1, n-3]", 0, ["u[-1] = u[0]"], ["R.u[-1]"]),
        ("u[i, n+1] = u[i] + (lam - 1)*u[i-1] + u[i-1] - lam*u[i-1]", 0, [], []),
        # a value that only a closure equation reads is one more
        ("u[i, n+1] = u[i-1]", 1, ["u[0] = u[-1]", "u[-1] = u[1]"], ["R.u[-1]", "R.u[0]"]),
        ("u[i, n+1] = u[i-1]", 1, ["u[0] = u[1] + (lam - lam)*u[-1]"], ["R.u[0]"]),
    ],
)
def test_boundary_unknowns_of_one_half_line(interior: str, first: int, closure: list[str], expected: list[str]) -> None:
    assert unknowns(interior, first, closure) == expected


def mirrored(formula: str) -> str:
    """Reflects x: offsets and indices change sign, levels stay."""
    return re.sub(r"\[(i?)([+-]?)(?=\d)", lambda m: f"[{m[1]}{'+' if m[2] == '-' else '-'}", formula)


@pytest.mark.parametrize(
    ("interior", "first", "closure"),
    [
        ("u[i, n+1] = u[i-1]", 0, ["u[-1] = u[0]"]),
        ("u[i, n+1] = u[i] + u[i-2]", 1, ["u[0] = u[2]", "u[-1] = u[0]"]),
        ("u[i, n+1] = u[i+1]", 2, []),
    ],
)
def test_the_left_half_line_is_the_mirror_image(interior: str, first: int, closure: list[str]) -> None:
    right = unknowns(interior, first, closure)
    left = unknowns(mirrored(interior), first, [mirrored(equation) for equation in closure], "left")
    assert [mirrored(value).replace("+", "").replace("-0", "0") for value in reversed(right)] == left


def test_zero_at_the_defaults_is_not_zero_as_a_formula() -> None:
    """Counted from the formulas: alpha - 1 vanishes at the default, and u[-1] is an unknown all the same."""
    text = changed(LEAPFROG, ("[domains.R]", "alpha = 1\n[domains.R]"), ("first    = 1", ""))
    scheme = read(text, ("u[i-1])", "u[i] + (alpha - 1)*u[i-1])"), (EQUATION, '"u[-1] = 0"'))
    assert [str(value) for value in scheme.boundary_unknowns] == ["R.u[-1]"]


def test_an_upwind_system_reads_both_ghosts_though_only_a_combination() -> None:
    assert [str(v) for v in read(INTERFACE).boundary_unknowns] == ["L.u[1]", "L.s[1]", "R.u[-1]", "R.s[-1]"]


def test_an_unknown_that_no_equation_holds_is_named_first() -> None:
    """Two equations for u[-1], none for s[-1] nor L.s[1]: the two left out are named, not the last ones."""
    message = refusal(
        INTERFACE,
        ('"L.s[1] = s_I",', ""),
        ('"R.u[-1] = u_I"', '"R.u[-1] = L.u[0]"'),
        ('"R.s[-1] = s_I"', '"R.u[-1] = u_I"'),
    )
    assert '"L.s[1]", "R.s[-1]", "R.u[-1]"' not in message
    assert '"L.s[1]", "R.s[-1]" have none' in message


def test_what_a_maximum_matching_leaves_over() -> None:
    """Where every unknown occurs, one equation too few leaves exactly one; no greedy choice blocks another."""
    scheme = read(
        LEAPFROG,
        (INTERIOR, "u[i, n+1] = u[i-3]"),
        ("first    = 1", "first    = 0"),
        (EQUATION, '"u[-3] + u[-2] = 0", "u[-3] + u[-1] = 0", "u[-3] = u[-2] + u[-1]"'),
    )
    for left_out in range(3):
        equations = [e for k, e in enumerate(scheme.closure.equations) if k != left_out]
        assert len(without_equation(scheme.boundary_unknowns, equations)) == 1
    assert without_equation(scheme.boundary_unknowns, scheme.closure.equations) == []
