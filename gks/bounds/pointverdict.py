"""The exact verdict at one point of the plane of a parameter and lam, both algebraic numbers perhaps."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from gks.errors import GksError, InputError, NotAnalysable, ParameterError, SchemeError
from gks.modes.algebraic import Root
from gks.modes.analysis import quick_verdict
from gks.modes.interior import interior_stability
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import Verdict
from gks.scheme.model import Scheme


class NotProved(GksError):
    """The theorem stays open; the message says why."""


def verdict_at(scheme: Scheme, values: Mapping[str, Fraction | Root]) -> Verdict:
    """The exact verdict at a point; UNSTABLE where no scheme exists (a division by zero, a degenerate closure)."""
    try:
        if not interior_holds(scheme, values):
            return Verdict.UNSTABLE
        return quick_verdict(scheme, _exact(values))
    except NotAnalysable:
        return Verdict.UNDECIDED
    except InputError:
        return Verdict.UNSTABLE


def interior_holds(scheme: Scheme, values: Mapping[str, Fraction | Root]) -> bool:
    """Whether there is a scheme at a point, with a Cauchy-stable interior, exactly."""
    try:
        return interior_stability(normal_mode_problem(scheme, _exact(values))) is None
    except (ParameterError, SchemeError):
        return False


def _exact(values: Mapping[str, Fraction | Root]) -> dict[str, Fraction | Root]:
    return {n: v if isinstance(v, Fraction) or v.rational is None else v.rational for n, v in values.items()}
