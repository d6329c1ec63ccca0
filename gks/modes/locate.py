"""From a mode that was listed back to the point it was found at, and to the solutions there."""

from __future__ import annotations

from gks.errors import NotAnalysable
from gks.modes.admissible import Candidate
from gks.modes.analysis import judged
from gks.modes.decoupling import decoupled
from gks.modes.eigenspace import Eigenspace, direct_sum, enclosed_space, exact_space
from gks.modes.kreiss import NormalModeProblem, spatial_problem
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode, ModesResult
from gks.modes.wide import modes_of_part


def space_of(result: ModesResult, mode: Mode) -> tuple[Eigenspace, bool]:
    """The space of a mode of the result, and whether it is proved to be one; NotAnalysable where it stays open."""
    problem = spatial_problem(result.scheme, result.parameters)
    try:
        return _exact(problem, mode) if result.tier == "exact" else _counted(problem, mode)
    except Undecided as reason:
        raise NotAnalysable(f"the solutions of this mode stay open: {reason}") from None


def _exact(problem: NormalModeProblem, mode: Mode) -> tuple[Eigenspace, bool]:
    found, _ = judged(problem)
    candidate = next((candidate for each, candidate in found if each.meets(mode)), None)
    if candidate is None:
        raise NotAnalysable("the mode is none of this scheme at these values")
    return exact_space(problem, candidate), True


def _counted(problem: NormalModeProblem, mode: Mode) -> tuple[Eigenspace, bool]:
    spaces: list[Eigenspace] = []
    proved = True
    for part in decoupled(problem):
        wide = modes_of_part(part, inner=True)
        place = next((place for each, place in zip(wide.modes, wide.places, strict=True) if each.meets(mode)), None)
        if isinstance(place, Candidate):
            return exact_space(problem, place), True
        if place is not None:
            space = enclosed_space(part, place)
            if space is None:
                raise NotAnalysable("this mode is one of several that are not told apart, or its spatial roots are not")
            spaces.append(space)
            proved &= place.proved
    if not spaces:
        raise NotAnalysable("the mode is none of this scheme at these values")
    return direct_sum(problem, spaces), proved
