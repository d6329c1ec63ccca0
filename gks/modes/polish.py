"""From rough zeros of Delta to proved ones.

All seeds of one region move together by Ehrlich-Aberth steps in w, in double precision, so that two never run into the
same zero. Then each is proved by an interval Newton step at growing precision, until its growth factor is clear of the
unit circle; where zeros coincide, a walk round their common place counts them instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import acb, arb, ctx

from gks.modes.algebraic import GUARD_BITS
from gks.modes.chart import Chart
from gks.modes.coefficients import value_ball
from gks.modes.discs import ComplexArray, Discs
from gks.modes.enclosure import Dual, NotEnclosed, SpatialRoots, Zero, enclose, kappas
from gks.modes.kreiss import NormalModeProblem
from gks.modes.kreissdiscs import Region, Start, patch
from gks.modes.tables import DiscTables, Tables, ball_tables
from gks.modes.winding import full_circle, walk

STEPS = 40
"""Aberth steps from moments good to a percent: 5 to 8 for simple zeros; a multiple one gains a bit a step, up to the
point where its cluster is recognised."""
DIFFERENCE = 2.0**-20
"""Step of the difference quotient that stands for Delta', relative to the disc's radius: exact for a linear Delta, and
off by its square otherwise."""
INNERMOST = 1 - 2.0**-30
"""Where only abs(w) < 1 makes sense, seeds are kept this far inside: decaying roots can still be told by modulus."""
TOGETHER = 2.0**-12
"""Seeds this close after all steps are looked at as one multiple zero, if they are not proved one by one."""
CLUSTER = 2.0**-16
"""Radius of the circle on which a multiple zero is counted, and of its enclosure: at a double zero Delta there is near
the square root of the rounding error."""
PRECISIONS = (96, 192, 384, 768)
"""Bits tried in turn for one zero: 96 print every digit of a double, 768 tell a distance of 1e-230 from the circle."""


@dataclass(frozen=True, slots=True)
class Found:
    """A zero of Delta: its growth factor in a ball, its multiplicity, its spatial roots (decaying, by family).

    ``proved``: the ball holds exactly that many zeros. ``w`` is its place in the chart, ``mu`` the value of lam*s (or
    z) at a simple zero. ``clear``: over the whole ball ``roots`` are inside the circle and all others outside.
    """

    w: complex
    z: acb
    multiplicity: int
    roots: tuple[tuple[acb, ...], ...]
    proved: bool
    mu: acb | None = None
    clear: bool = False

    def sigma(self, problem: NormalModeProblem) -> acb | None:
        """The problem's variable at a simple zero, as sharp as ``mu`` whatever precision is in force."""
        if self.mu is None or problem.variable != "s":
            return self.mu
        bits = max(self.mu.rel_accuracy_bits(), 0) + GUARD_BITS
        with ctx.workprec(bits):
            return self.mu / value_ball(problem.coefficients.values[problem.resolvent.cfl], bits)


class Polisher:
    """Finds the zeros near seeds of one problem; balls of its coefficients are kept by precision."""

    def __init__(self, problem: NormalModeProblem, chart: Chart, tables: DiscTables) -> None:
        self.problem, self.chart, self.tables = problem, chart, tables
        self._balls: dict[int, Tables] = {}

    def balls(self, bits: int) -> Tables:
        """The problem's tables at a precision."""
        if bits not in self._balls:
            self._balls[bits] = ball_tables(self.problem, bits)
        return self._balls[bits]

    def polish(self, seeds: Sequence[complex], region: Region | None, radius: float = 1.0) -> list[Found]:
        """The zeros near the seeds, proved where that succeeds; those that are not found are left out.

        The seeds lie in a disc of that radius, over which the region is known.
        """
        if not seeds:
            return []
        places = self._settled(np.array(seeds), region, radius)
        found: list[Found] = []
        left = []
        for w in places:
            zero = self.simple(complex(w), region)
            if zero is None or any(zero.z.overlaps(other.z) for other in found):
                left.append(complex(w))
            else:
                found.append(zero)
        while left:
            group = [w for w in left if abs(w - left[0]) < TOGETHER]
            left = [w for w in left if abs(w - left[0]) >= TOGETHER]
            cluster = self._cluster(group, region)
            if cluster is not None:
                found.append(cluster)
        return found

    def _settled(self, w: ComplexArray, region: Region | None, radius: float) -> ComplexArray:
        """Aberth steps until the seeds stand still."""
        # Two real seeds may stand for a conjugate pair, which real arithmetic would never find.
        w = w * np.exp(1j * 2.0**-10 * radius * np.arange(1, len(w) + 1))
        apart_by = DIFFERENCE * radius
        start: Start | None = None
        for _ in range(STEPS):
            w = w if region is not None else w * np.minimum(1.0, INNERMOST / np.maximum(np.abs(w), 0.5))
            points = np.concatenate([w, w + apart_by * _inward(w), w - apart_by * _inward(w)])
            node = points if region is not None else points * np.minimum(1, INNERMOST / np.maximum(np.abs(points), 0.5))
            values = patch(self.tables, self.chart, Discs.exact(node), node, start, region)
            logs = (values.log.sum(axis=1) + 1j * values.phase).reshape(3, -1)
            at, ahead, behind = node.reshape(3, -1)
            with np.errstate(all="ignore"):  # Delta may be zero to rounding: nothing is left to gain there
                slope = (np.exp(logs[1] - logs[0]) - np.exp(logs[2] - logs[0])) / (ahead - behind)
                apart = at[:, None] - at[None, :]
                np.fill_diagonal(apart, np.inf)
                step = 1 / (slope - (1 / apart).sum(axis=1))
            step = np.where(np.isfinite(step), step, 0)
            w = at - step * np.minimum(1, 0.25 * radius / np.maximum(np.abs(step), 2.0**-1000))
            start = values.start if (np.abs(step) < 2.0**-5 * radius).all() else None
            if (np.abs(step) < 2.0**-36 * radius).all():
                break
        return w

    def simple(self, w: complex, region: Region | None) -> Found | None:
        """A simple zero, proved; None where the proof fails."""
        mu, hints = self._hints(w, region)
        found = None
        for bits in PRECISIONS:
            with ctx.workprec(bits + GUARD_BITS):
                try:
                    zero = enclose(self.balls(bits), acb(mu), hints, bits)
                    z = self.chart.growth(zero.mu, w)
                except NotEnclosed:
                    return found
                clear = all(roots.told_by_modulus() for roots in zero.roots)
                proved = clear or self._continues(zero, region)
                found = Found(w, z, 1, kappas(self.balls(bits), zero.roots), proved, zero.mu, clear)
                if abs(z) > 1 or abs(z) < 1:
                    return found
        return found

    def _hints(self, w: complex, region: Region | None) -> tuple[complex, list[list[complex]]]:
        """lam*s (or z) on the branch on which Delta is smallest, and all spatial roots there."""
        node = np.array([w])
        values = patch(self.tables, self.chart, Discs.exact(node), node, None, region)
        branch = int(np.argmin(values.log[0]))
        stage = complex(values.start.stages[0, branch]) if values.start.stages.size else 0j
        return self.chart.value(w, stage), [[complex(x) for x in f[0, branch]] for f in values.start.spatial]

    def _continues(self, zero: Zero, region: Region | None) -> bool:
        """Whether the roots called decaying continue the decaying ones."""
        if region is None:
            return False
        return all(
            region.continues(k, [_disc(x.value) for x in roots.decaying], [_disc(x) for x in roots.others])
            for k, roots in enumerate(zero.roots)
        )

    def _cluster(self, group: Sequence[complex], region: Region | None) -> Found | None:
        """A multiple zero, counted on a small circle round the seeds' mean."""
        centre = sum(group) / len(group)
        if abs(centre.imag) < CLUSTER:
            centre = complex(centre.real)
        if region is None and abs(centre) + 2 * CLUSTER >= 1:
            return None
        around = walk(self.tables, self.chart, full_circle(centre, CLUSTER), CLUSTER * 2.0**-12, region)
        _, hints = self._hints(centre, region)
        roots = kappas(
            self.balls(PRECISIONS[0]),
            [
                SpatialRoots(tuple(Dual(acb(y), acb(0)) for y in hint[: symbol.decaying]), ())
                for hint, symbol in zip(hints, self.tables.symbols, strict=True)
            ],
        )
        reach = arb(0, CLUSTER)
        z = self.chart.growth_at(acb(arb(centre.real) + reach, arb(centre.imag) + reach))
        proved = not around.stuck and round(around.zeros) == len(group)
        return Found(centre, z, len(group), roots, proved)


def _inward(w: ComplexArray) -> ComplexArray:
    """Directions along which a difference quotient stays within abs(w) < 1: tangential."""
    return np.asarray(1j * np.exp(1j * np.angle(w)))


def _disc(value: acb) -> tuple[complex, float]:
    return complex(value), float(value.rad()) * (1 + 2.0**-40) + 2.0**-50 * abs(complex(value))
