"""Which route to the modes is the cheaper one: elimination, or counting zeros of Delta."""

from __future__ import annotations

from math import comb

from gks.modes.cauchy import degree_in
from gks.modes.interior import field_symbol
from gks.modes.kreiss import NormalModeProblem

ELIMINATION_WORK = 600
"""Choices of spatial roots times equations, up to which elimination is tried first. A reach of three points to either
side (120 choices, 3 equations) takes it half a second; two fields on both sides of an interface with boundary rules at
four points (144 choices, 16 equations) take it minutes, and the count of zeros a second."""


FEW_CHOICES = 12
"""Sets of decaying spatial roots below which elimination takes tenths of a second at most, with any coefficients."""
MANY_CHOICES = 30
"""Sets above which it takes many seconds even with the shortest: two fields of reach two on one side have 36."""
LABOUR = 700
"""Sets times the closure's degree in z times bits of the longest coefficient, above which the count of zeros is tried
first. Of 600 random schemes of reach two those above take elimination 0.3 s to over 6 s, those below 0.6 s at most; one
field of reach three with 3 ghosts takes 0.3 s at 660, 4 s at 3100 and 40 s at 14000."""


def laborious(problem: NormalModeProblem) -> bool:
    """Whether elimination can be done and is likely to take longer than the count of zeros."""
    choices = 1
    for family in problem.families:
        choices *= comb(family.degree, min(family.decaying, family.degree - family.decaying))
    if problem.coupled or choices < FEW_CHOICES:
        return False
    return choices > MANY_CHOICES or choices * _degree(problem) * _bits(problem) > LABOUR


def _degree(problem: NormalModeProblem) -> int:
    """The degree of the closure's determinant in the problem's variable, at most."""
    return sum(max((degree_in(t.coefficient, problem.variable) for t in row), default=0) for row in problem.rows)


def _bits(problem: NormalModeProblem) -> int:
    symbols = [field_symbol(block.field, problem.coefficients) for block in problem.blocks]
    closure = [term.coefficient for row in problem.rows for term in row]
    return max(int(abs(int(c))).bit_length() for each in (*symbols, *closure) for c in each.coeffs())


def beyond_elimination(problem: NormalModeProblem) -> bool:
    """Whether counting zeros is the cheaper route by far."""
    return elimination_work(problem) > ELIMINATION_WORK


def elimination_work(problem: NormalModeProblem) -> int:
    """Choices of spatial roots times equations."""
    choices = 1
    for family in problem.families:
        for k in range(min(family.decaying, family.degree - family.decaying)):
            choices *= family.degree - k
    return choices * problem.size
