"""The checker's judges of one scheme: another one wherever the scheme itself is another. Part of the checker.

Upwinding follows the signs of the wave speeds, and the number of decaying roots is constant only where the interior is
Cauchy-stable without interruption. So each point asks for the judge of its own signs and counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from flint import fmpz_mpoly

from gks.bounds.checkcurves import curves
from gks.bounds.checkderive import Problem, derive
from gks.bounds.checkformula import Rejected
from gks.bounds.checkpoint import Judge, interior_holds
from gks.bounds.checkring import Unsupported
from gks.scheme.model import Scheme


class Judges:
    """All that have been asked for; ``parameter`` None: there is no p."""

    def __init__(self, scheme: Scheme, fixed: Mapping[str, Fraction], parameter: str | None) -> None:
        self.scheme, self.fixed, self.parameter = scheme, fixed, parameter
        self.known: dict[tuple[str, ...], Judge] = {}

    def at(self, p: Fraction, lam: Fraction) -> Judge | None:
        """For a rational point on no curve; None where the interior is not Cauchy-stable."""
        for judge in self.known.values():
            if self._holds(judge, p, lam):
                return judge if interior_holds(judge.problem, p, lam) else None
        why: Exception | None = None
        try:
            problem = derive(self.scheme, self.fixed, self.parameter, p, lam)
        except (Rejected, Unsupported) as reason:
            why, problem = reason, derive(self.scheme, self.fixed, self.parameter, p, lam, counted=False)
        if not interior_holds(problem, p, lam):
            return None
        if why is not None:
            raise why
        return self._judge(problem)

    def somewhere(self, p: Fraction, lam: Fraction) -> Judge:
        """For the signs at a point, whatever the interior there."""
        return self._judge(derive(self.scheme, self.fixed, self.parameter, p, lam))

    def curves(self) -> dict[str, fmpz_mpoly]:
        """The boundary curves of every judge."""
        found: dict[str, fmpz_mpoly] = {}
        for judge in self.known.values():
            found |= curves(judge.problem)
        return found

    @staticmethod
    def _holds(judge: Judge, p: Fraction, lam: Fraction) -> bool:
        try:
            return judge.problem.holds_at(p, lam)
        except Unsupported:
            return False

    def _judge(self, problem: Problem) -> Judge:
        key = (*(f"{f.whole}; {f.decaying}" for f in problem.families), str(problem.rows))
        if key not in self.known:
            self.known[key] = Judge(problem)
        return self.known[key]
