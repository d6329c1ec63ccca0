"""What the roots of a characteristic polynomial are, for many parameter values at once, in double precision.

A root is a mode where Delta of the decaying solutions vanishes, which computed error bounds decide
(`gks.bounds.deltazeros`). What they leave in doubt is left open here, for the exact judgement: z or a spatial root next
to the unit circle, roots that are not told apart.
"""

from __future__ import annotations

import numpy as np

from gks.bounds.deltazeros import judged
from gks.bounds.rootimages import Images
from gks.bounds.sampled import Array, Sampled
from gks.modes.doubledouble import UNIT
from gks.modes.verdict import ModeKind


def kinds(compiled: Sampled, roots: Images, gap: Array, parameter: Array) -> list[ModeKind | None]:
    """The kind of every root, None where that is left open; ``gap`` is the distance from any other root sigma.

    The problem has one symbol, the parameter. A root that another may coincide with (``gap`` 0) is left open.
    """
    with np.errstate(all="ignore"):  # what overflows is left open
        found = judged(compiled, roots.sigma, roots.radius, gap, np.zeros(len(roots), bool), [parameter])
        size = np.abs(roots.z)
        error = roots.error + 2 * UNIT * size  # that of the modulus itself
        inside, outside = size - 1 < -error, size - 1 > error
    # Where others decay outside the circle the interior is not Cauchy-stable: the exact analysis has the word.
    told = ~found.unsure & (inside | (outside & found.expected)) & (gap > 0)
    return [
        None if not known else (ModeKind.GROWING if beyond else ModeKind.DECAYING) if mode else ModeKind.INADMISSIBLE
        for known, mode, beyond in zip(told.tolist(), found.mode.tolist(), outside.tolist(), strict=True)
    ]
