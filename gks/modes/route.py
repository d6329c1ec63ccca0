"""Which route to the modes is the cheaper one: elimination, or counting zeros of Delta."""

from __future__ import annotations

from gks.modes.interior import field_symbol
from gks.modes.kreiss import NormalModeProblem

ELIMINATION_WORK = 600
"""Choices of spatial roots times equations, up to which elimination is tried first. A reach of three points to either
side (120 choices, 3 equations) takes it half a second; two fields on both sides of an interface with boundary rules at
four points (144 choices, 16 equations) take it minutes, and the count of zeros a second."""


LABOUR = 10_000
"""Work of more than `LIGHT` times bits of the longest coefficient, from which the count of zeros is tried first: with
a reach of three points to either side elimination takes a third of a second at 11 bits, 4 s at 52 and 40 s at 230."""
LIGHT = 100
"""Work that coefficients of any length leave in milliseconds."""


def laborious(problem: NormalModeProblem) -> bool:
    """Whether long coefficients make elimination the dearer route, though it can be done."""
    work = elimination_work(problem)
    return not problem.coupled and work > LIGHT and work * _bits(problem) > LABOUR


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
