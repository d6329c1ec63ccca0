"""One step of the finite problem: by levels, by Runge-Kutta stages with the closure at each, or by the exponential."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from gks.solvers.exponential import exponential
from gks.solvers.matrices import Layout, onto_constraints, update_matrix
from gks.solvers.problem import Problem
from gks.solvers.relation import is_local, relation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from gks.scheme.integrators import Tableau

    Array = NDArray[Any]

__all__ = ["Marcher", "cost_per_value", "update_matrix"]


class Marcher:
    """The state of the finite problem (levels oldest first) and its advance by one step.

    The state is scaled by a power of two whenever it passes 2**200 or falls below 2**-200 as a whole, and `exponent`
    keeps account; entries below 2**-900 are zeroed now and then, since subnormal numbers cost a hundred times as much.
    """

    CEILING, DUST, SWEEP_EVERY = 2.0**200, 2.0**-900, 16

    def __init__(self, grid: Layout, levels: Sequence[Array]) -> None:
        import numpy

        self.grid, self.problem = grid, grid.problem
        dtype = complex if numpy.iscomplexobj(levels[0]) else float
        self.levels = [level.astype(dtype) for level in levels]
        self.spare = [numpy.zeros_like(self.levels[0]) for _ in range(self.problem.depth + 4)]
        self.exponent, self.taken = 0, 0
        stages = self.problem.stages
        if stages is not None:
            self.levels = [onto_constraints(grid, self.levels[0])]
        self.relation = relation(grid, dtype)
        if stages is not None and stages.kind == "exact":
            self.exponential = exponential(grid, self.relation)

    @property
    def state(self) -> Array:
        """The newest level, to be multiplied by 2**exponent."""
        return self.levels[-1]

    def step(self, source: Array | None = None) -> None:
        """Advance by one step; `source` (unscaled) is added as `Relation.newest` says, under stages to the result."""
        stages = self.problem.stages
        scaled = None if source is None else source * 2.0**-self.exponent
        if stages is None:
            new = self.relation.newest(self.levels, self.spare[0], scaled)
            self.spare[0] = self.levels[0]
            self.levels = [*self.levels[1:], new]
        else:
            if stages.tableau is not None:
                self._runge_kutta(stages.tableau)
            else:
                self.levels[0] = self.exponential(self.levels[0])
            if scaled is not None:
                self.levels[0] += scaled
        self.taken += 1
        if self.taken % self.SWEEP_EVERY == 0:
            self._tidy()

    def rescale(self, size: float) -> None:
        """Bring a state of the given size back to order one by a power of two."""
        import numpy

        power = int(numpy.frexp(size)[1])
        for level in self.levels:
            numpy.multiply(level, 2.0**-power, out=level)
        self.exponent += power

    def raise_fallen(self) -> bool:
        """Bring a state that has fallen below 1/CEILING as a whole back towards order one; whether there was one.

        Every level counts: the newest one may vanish for a step while an older one, which returns, does not. Exact
        zeros stay. DUST bounds the factor, which would overflow for subnormal numbers.
        """
        import numpy

        largest = max(float(numpy.abs(level).max()) for level in self.levels)
        fallen = 0.0 < largest < 1.0 / self.CEILING
        if fallen:
            self.rescale(max(largest, self.DUST))
        return fallen

    def _tidy(self) -> None:
        import numpy

        for level in self.levels:
            level[numpy.abs(level) < self.DUST] = 0.0

    def _rate(self, state: Array, slot: int) -> Array:
        return self.relation.newest([state], self.spare[slot])

    def _runge_kutta(self, tableau: Tableau) -> None:
        """Stages w_i = w + lam sum_j a_ij k_j, k_i = F w_i; then w + lam sum_i b_i k_i."""
        lam, start = self.problem.lam, self.levels[0]
        while len(self.spare) < len(tableau.b):
            self.spare.append(self.spare[0].copy())
        rates: list[Array] = []
        for row in tableau.a:
            stage = start
            for weight, rate in zip(row, rates, strict=False):
                if weight:
                    stage = stage + (lam * float(weight)) * rate
            rates.append(self._rate(stage, len(rates)))
        for weight, rate in zip(tableau.b, rates, strict=True):
            if weight:
                start += (lam * float(weight)) * rate


def cost_per_value(problem: Problem) -> float:
    """Work of one step per grid value, in units of an explicit one-level step (measured, to about a factor of two)."""
    stages = problem.stages
    if stages is not None and stages.tableau is not None:
        return 2.0 * len(stages.tableau.b)
    return 1.0 if is_local(problem) else 6.0
