"""Coupled half-lines by the count of zeros, where the elimination is made to refuse them.

Zeros of the determinant hold all normal modes and those of the field w (`gks.modes.coupled`); only the ones that balls
tell from these are called modes, and a count of none is a proof that there is none.
"""

from __future__ import annotations

from random import Random

import pytest

from gks.errors import InputError
from gks.modes import Verdict, analyse
from gks.modes.kreiss import normal_mode_problem
from gks.scheme.model import Scheme
from tests.modes.random_drafts import random_draft


def coupled_schemes(count: int) -> list[Scheme]:
    found: list[Scheme] = []
    seed = 0
    while len(found) < count:
        seed += 1
        scheme = random_draft(Random(seed), 1).scheme()
        try:
            problem = normal_mode_problem(scheme, scheme.values({}))
        except InputError:
            continue
        if problem.coupled and problem.size:
            found.append(scheme)
    return found


def test_the_count_says_the_same_or_less(monkeypatch: pytest.MonkeyPatch) -> None:
    schemes = coupled_schemes(16)
    exact = [analyse(scheme, scheme.values({})) for scheme in schemes]
    monkeypatch.setattr("gks.modes.polynomial.beyond_elimination", lambda problem: True)
    counted = [analyse(scheme, scheme.values({})) for scheme in schemes]
    told = 0
    for one, other in zip(exact, counted, strict=True):
        assert other.tier != "exact" or not other.solvable
        if other.verdict is Verdict.UNDECIDED:
            assert other.because
            continue
        told += 1
        assert other.verdict is one.verdict
        mine = [float(m.modulus) for m in one.modes if m.kind.value == "growing"]
        theirs = [float(m.modulus) for m in other.modes if m.kind.value == "growing"]
        assert all(min(abs(a - b) for a in mine) < 1e-12 * b for b in theirs)
    assert told > len(schemes) // 2
    assert {one.verdict for one in exact} > {Verdict.STABLE}
