"""What a theorem states can be taken at its word: formulas are sympy's and LaTeX's, and give the derived numbers."""

from __future__ import annotations

import re
import subprocess
from fractions import Fraction
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy
from matplotlib.mathtext import MathTextParser

from gks.bounds.cfl import stable_set
from gks.bounds.proving import prove_here
from gks.bounds.theorem import Piece, Theorem
from gks.catalogue import find
from gks.errors import ParameterError
from gks.scheme.model import Scheme
from tests.bounds.theorem_schemes import LAX_WENDROFF, half_line, upwind_flux
from tests.wanted import NEEDS_LATEX, pdflatex

NAMES = ("traditional-1", "traditional-2", "average-1", "implicit-1", "gap", "speed", "in lam", "roots")

DIGITS = 40
"""Of mpmath, against enclosures of 128 bits."""


def scheme_of(name: str) -> Scheme:
    """Shipped ones, two stable intervals with ends of every kind, speeds that change sign, roots without a formula."""
    if name == "gap":
        return half_line(LAX_WENDROFF, "u[1]/(a - 1)")
    if name == "speed":
        return upwind_flux("a")
    if name == "in lam":
        return upwind_flux("lam - a")
    if name == "roots":
        return half_line(LAX_WENDROFF, "u[0]/2 + a*lam*(u[2] - u[0])")
    return find(name)


@cache
def theorem(name: str) -> Theorem:
    found = prove_here(scheme_of(name), {}, lambda stage: None)
    assert found.proved, found.reason
    return found


def value(text: str, names: dict[str, mpmath.mpf], lam: str) -> mpmath.mpf:
    """A formula, or the k-th positive root in lam of a polynomial, by sympy and mpmath alone."""
    root = re.fullmatch(r"(-?)root\((.*), (\d+)\)", text)
    if text == "oo":
        return mpmath.inf
    if root is None:
        formula = sympy.sympify(text)
        assert {str(s) for s in formula.free_symbols} <= set(names)
        return mpmath.mpf(sympy.lambdify(list(names), formula, "mpmath")(*names.values()))
    unknown = sympy.Symbol(lam)
    poly = sympy.Poly(sympy.sympify(root[2]), unknown)
    parts = [sympy.lambdify(list(names), c, "mpmath")(*names.values()) for c in poly.all_coeffs()]
    zeros = mpmath.polyroots(parts, maxsteps=200, extraprec=400)
    real = sorted(z.real for z in zeros if abs(z.imag) < mpmath.mpf(10) ** -20 and z.real > 0)
    return -real[int(root[3]) - 1] if root[1] else real[int(root[3]) - 1]


def places(piece: Piece, parameter: str) -> list[Fraction]:
    """Values inside a piece; none where it is a single irrational value."""
    assert piece.start is not None
    assert piece.end is not None
    with mpmath.workdps(DIGITS):
        ends = [value(edge.text.replace("-oo", "-1000"), {}, parameter) for edge in (piece.start, piece.end)]
    low, high = (Fraction(str(min(max(end, -1000), 1000))) for end in ends)
    if low == high:
        return [low] if "r" not in piece.start.text else []
    return [low + (high - low) * share for share in (Fraction(1, 100), Fraction(2, 5), Fraction(9, 10))]


@pytest.mark.parametrize("name", NAMES)
def test_every_formula_is_the_end_of_a_stable_interval(name: str) -> None:
    found = theorem(name)
    assert found.parameter is not None
    for piece in found.pieces:
        for p in places(piece, found.parameter):
            try:
                exact = stable_set(found.scheme, found.scheme.values({found.parameter: p})).intervals
            except ParameterError:
                exact = ()  # there is no scheme at this value
            assert len(exact) == len(piece.stable_set)
            for (low, high), interval in zip(piece.stable_set, exact, strict=True):
                for end, derived in ((low, interval.low), (high, interval.high)):
                    if derived is None:
                        assert end.text in ("0", "oo")
                        continue
                    with mpmath.workdps(DIGITS):
                        names = {found.parameter: mpmath.mpf(p.numerator) / p.denominator}
                        own = value(end.text, names, found.scheme.cfl)
                        told = mpmath.mpf(derived.ball(128).real.str(38, radius=False))
                        assert mpmath.almosteq(own, told, 1e-25)


@pytest.mark.parametrize("name", NAMES)
def test_edges_have_their_values(name: str) -> None:
    found = theorem(name)
    for piece in found.pieces:
        for edge in (piece.start, piece.end):
            assert edge is not None
            if "oo" not in edge.text:
                assert float(value(edge.text, {}, str(found.parameter))) == pytest.approx(edge.value, rel=1e-14)


def test_the_examples_hold_formulas_of_every_kind() -> None:
    texts = [end.text for name in NAMES for p in theorem(name).pieces for span in p.stable_set for end in span]
    edges = [edge.text for name in NAMES for p in theorem(name).pieces for edge in (p.start, p.end) if edge]
    assert any(text.startswith("root(") for text in texts)
    assert any("sqrt" in text for text in texts)
    assert any(text.startswith("root(") for text in edges)


# LaTeX --------------------------------------------------------------------------------------------------------------


def width(latex: str) -> float:
    """Of what matplotlib's reader of TeX mathematics makes of it; ValueError where it cannot read it."""
    return float(MathTextParser("path").parse(f"${latex}$").width)


@pytest.mark.parametrize("name", NAMES)
def test_formulas_are_tex(name: str) -> None:
    formulas = [end.latex for piece in theorem(name).pieces for span in piece.stable_set for end in span]
    assert formulas
    assert all(width(tex) > 0 for tex in formulas)


@pytest.mark.parametrize("name", NAMES)
def test_a_statement_is_one_line_of_cases_in_two_columns(name: str) -> None:
    text = theorem(name).latex
    assert text.isprintable()
    assert text.count(r"\begin{cases}") == text.count(r"\end{cases}") == 1
    body = text.split(r"\begin{cases}")[1].split(r"\end{cases}")[0]
    assert all(row.count("&") == 1 for row in body.split(r" \\ "))
    depth = 0
    for brace in re.sub(r"\\[{}]", "", text):
        depth += {"{": 1, "}": -1}.get(brace, 0)
        assert depth >= 0
    assert depth == 0


@NEEDS_LATEX
def test_statements_compile(tmp_path: Path) -> None:
    body = "\n".join(rf"\[{theorem(name).latex}\]" for name in NAMES)
    text = "\\documentclass{article}\\usepackage{amsmath}\\begin{document}\n" + body + "\n\\end{document}\n"
    (tmp_path / "theorems.tex").write_text(text)
    command = [pdflatex(), "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "theorems.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]


# Evaluation ---------------------------------------------------------------------------------------------------------


def test_a_formula_that_cancels_is_not_what_is_evaluated() -> None:
    """The printed formula of the second-order coupling loses half its digits at 1e10; the bound loses none."""
    found = theorem("traditional-2")
    formula = sympy.lambdify("alpha", sympy.sympify(found.pieces[-1].bound.text), "numpy")
    points = np.array([1e10, 1e100])
    with mpmath.workdps(250):
        exact = sympy.lambdify("alpha", sympy.sympify(found.pieces[-1].bound.text), "mpmath")
        true = np.array([float(exact(mpmath.mpf(p))) for p in points])
    assert np.all(np.abs(found.bound(points) - true) <= 1e-15 * true)
    assert np.all(np.abs(formula(points) - true) > 1e-9 * true)


@pytest.mark.parametrize("name", ["traditional-1", "traditional-2", "average-1"])
def test_a_bound_over_an_array_is_exact_to_the_last_digits_anywhere(name: str) -> None:
    found = theorem(name)
    points = np.concatenate([np.geomspace(1e-10, 1e10, 21), [1e-100, 1e100]])
    for p, bound in zip(points, found.bound(points), strict=True):
        here = stable_set(found.scheme, found.scheme.values({"alpha": Fraction(float(p))})).lam_max
        assert here is not None
        assert bound == pytest.approx(float(here.ball(80).real.mid()), rel=1e-15, abs=0)


def test_bounds_keep_the_shape_of_what_they_are_asked_for() -> None:
    bound = theorem("traditional-1").bound
    assert bound(np.full((3, 2), 7.0)).tolist() == [[0.5, 0.5]] * 3
    assert np.isnan(bound([-1.0, float("nan")])).all()
