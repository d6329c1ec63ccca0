"""Which route to the modes is the cheaper one: elimination, or counting zeros of Delta."""

from __future__ import annotations

from gks.modes.kreiss import NormalModeProblem

ELIMINATION_WORK = 600
"""Choices of spatial roots times equations, up to which elimination is tried first. A reach of three points to either
side (120 choices, 3 equations) takes it half a second; two fields on both sides of an interface with boundary rules at
four points (144 choices, 16 equations) take it minutes, and the count of zeros a second."""


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
