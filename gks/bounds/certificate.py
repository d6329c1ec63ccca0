"""The certificate of a theorem: everything that an independent check has to look at, as plain text and integers.

It holds the scheme's text, the values that were fixed, the boundary curves, the polynomials whose roots cut the axis, a
sample and its stable intervals for every cell, what was decided on every cut, and the pieces as they are stated.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from hashlib import sha256

from flint import fmpz_mpoly

from gks.bounds.boundary import PLANE
from gks.bounds.cfl import StableSet
from gks.bounds.region import Branch, Cell, Cut, Decomposition, End
from gks.bounds.theorem import Theorem
from gks.modes.algebraic import Root, isolated_roots
from gks.modes.fibre import embed
from gks.modes.printing import polynomial_text
from gks.scheme.numbers import fraction_text

SCHEMA = "gks.certificate/1"


def certificate(
    theorem: Theorem, found: Decomposition, fixed: Mapping[str, Fraction], low: Fraction | None, high: Fraction | None
) -> dict[str, object]:
    """For a theorem over a parameter."""
    name, lam = theorem.parameter, theorem.scheme.cfl
    assert name is not None
    return _signed(
        {
            **_head(theorem, fixed),
            "domain": ["-oo" if low is None else fraction_text(low), "oo" if high is None else fraction_text(high)],
            "curves": [_text(curve, name, lam) for curve in found.boundary.curves],
            "walls": [_text(embed(wall, PLANE, "p"), name, lam) for wall in found.boundary.walls],
            "cells": [_cell(cell) for cell in found.cells],
            "cuts": [_cut(cut, name, lam) for cut in found.cuts],
            "pieces": [piece.to_json() for piece in theorem.pieces],
        }
    )


def constant_certificate(theorem: Theorem, found: StableSet, fixed: Mapping[str, Fraction]) -> dict[str, object]:
    """For a stable set in lam alone."""
    return _signed(
        {
            **_head(theorem, fixed),
            "stable_set": [
                [_root(i.low, theorem.scheme.cfl), _root(i.high, theorem.scheme.cfl)] for i in found.intervals
            ],
            "pieces": [piece.to_json() for piece in theorem.pieces],
        }
    )


def _signed(content: dict[str, object]) -> dict[str, object]:
    """With the SHA-256 of its sorted JSON, so that a slip of the file is told from a false proof."""
    text = json.dumps(content, sort_keys=True, allow_nan=False)
    return {**content, "digest": sha256(text.encode()).hexdigest()}


def _head(theorem: Theorem, fixed: Mapping[str, Fraction]) -> dict[str, object]:
    return {
        "schema": SCHEMA,
        "name": theorem.scheme.name,
        "scheme": theorem.scheme.text,
        "parameter": theorem.parameter,
        "values": {name: fraction_text(value) for name, value in fixed.items() if name != theorem.scheme.cfl},
    }


def _text(curve: fmpz_mpoly, parameter: str, lam: str) -> str:
    return polynomial_text(curve, {"p": parameter, "lam": lam}, "lam")


def _cell(cell: Cell) -> dict[str, object]:
    return {
        "sample": fraction_text(cell.sample),
        "stable_set": [[_end(span.low), _end(span.high)] for span in cell.spans],
        "at_bound": None if cell.at_bound is None else cell.at_bound.value,
    }


def _end(end: End) -> list[int] | None:
    """A branch as curve and index; None at 0 and at infinity."""
    assert not isinstance(end, Root)
    return None if end is None else [end.curve, end.k]


def _cut(cut: Cut, parameter: str, lam: str) -> dict[str, object]:
    spans = None
    if cut.spans is not None:
        spans = [[_number(span.low, lam), _number(span.high, lam)] for span in cut.spans]
    return {
        "at": _root(cut.root, parameter),
        "stable_set": spans,
        "at_bound": None if cut.at_bound is None else cut.at_bound.value,
    }


def _number(end: End, lam: str) -> list[object] | None:
    assert not isinstance(end, Branch)
    return _root(end, lam)


def _root(root: Root | None, name: str) -> list[object] | None:
    """An algebraic number as its irreducible polynomial and the place among its real roots, from 1."""
    if root is None:
        return None
    mine = root.minimal
    real = [r for r in isolated_roots(mine.poly, is_square_free=True) if r.is_real]
    return [polynomial_text(embed(mine.poly, PLANE, "lam"), {"lam": name}, "lam"), 1 + real.index(mine)]


__all__ = ["SCHEMA", "Branch", "certificate", "constant_certificate"]
