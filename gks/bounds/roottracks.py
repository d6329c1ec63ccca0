"""Roots followed from one parameter value to the next: the assignment of least total distance on the Riemann sphere.

Where a root moves as far as its neighbours are apart, or a step pairs roots otherwise than its two halves do, it is
divided, so that two roots are not exchanged; where they really meet, halving ends after a fixed number of times and
either continuation is a true one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]

DOUBT = 0.25
"""Share of the distance to the nearest other root that a root may move in a step that is not divided."""


def assignment(before: Complex, after: Complex) -> list[int | None]:
    """The pairing of least total chordal distance."""
    from scipy.optimize import linear_sum_assignment

    found: list[int | None] = [None] * len(before)
    if len(before) and len(after):
        rows, columns = linear_sum_assignment(chordal(before[:, None], after[None, :]))
        for i, j in zip(rows, columns, strict=True):
            found[int(i)] = int(j)
    return found


def follow(
    at: Callable[[float], Complex], before: Complex, after: Complex, low: float, high: float, depth: int
) -> list[int | None]:
    """The same with steps divided where it is doubtful, at most ``depth`` times.

    ``at`` gives the roots at a place between 0 and 1; ``before`` and ``after`` are those at ``low`` and ``high``. A
    step stands when its two halves pair the roots as it does, and neither is doubtful.
    """
    found = assignment(before, after)
    if depth == 0 or max(len(before), len(after)) <= 1:
        return found
    half = low / 2 + high / 2
    inner = at(half)
    first, second = assignment(before, inner), assignment(inner, after)
    doubtful = _doubtful(before, inner, first) or _doubtful(inner, after, second)
    if doubtful or _composed(first, second) != found:
        first = follow(at, before, inner, low, half, depth - 1)
        second = follow(at, inner, after, half, high, depth - 1)
    return _composed(first, second)


def _composed(first: Sequence[int | None], second: Sequence[int | None]) -> list[int | None]:
    return [None if j is None else second[j] for j in first]


def _doubtful(before: Complex, after: Complex, found: Sequence[int | None]) -> bool:
    """Whether a root moves by more than a share of its distance from the others."""
    for roots in (before, after):
        apart = chordal(roots[:, None], roots[None, :])
        np.fill_diagonal(apart, np.inf)
        nearest = apart.min(axis=1, initial=np.inf)
        for i, j in enumerate(found):
            if j is None:
                continue
            k = i if roots is before else j
            if chordal(before[i], after[j]) > DOUBT * nearest[k] > 0:
                return True
    return False


def chordal(a: Complex, b: Complex) -> NDArray[np.float64]:
    """Half the distance on the Riemann sphere: bounded, and a root that goes to infinity comes to a point."""
    first, second = np.hypot(1, np.abs(a)), np.hypot(1, np.abs(b))
    return np.asarray(np.abs(a / first - b / first) / second)
