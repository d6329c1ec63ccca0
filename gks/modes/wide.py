"""The normal modes of schemes too wide for elimination: zeros of Delta counted, found and proved one by one.

The number of zeros in abs(w) < 1 and in pockets across the unit circle (`gks.modes.pockets`) is proved by walks that
leave nothing between their steps. Moments along the same walks say roughly where the zeros are; Newton's method in balls
polishes each and proves it (`gks.modes.enclosure`). Zeros at z = 1 and z = -1 are judged exactly (`gks.modes.exactpoint`).
When the zeros that were proved make up the numbers counted, there are no others.

What does not close is said: a zero whose ball meets the circle, a number that is not made up. Such a doubt forbids every
verdict but ``unstable``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import lru_cache
from typing import Literal

import numpy as np
from flint import acb, arb, ctx, fmpq

from gks.modes.algebraic import GUARD_BITS, Root
from gks.modes.chart import Chart, chart_of
from gks.modes.discs import Discs
from gks.modes.enclosure import NotEnclosed, Zero, enclose, newton_step
from gks.modes.exactpoint import ExactPoint, exact_point, rational_candidate
from gks.modes.growth import growth_of
from gks.modes.kreiss import NormalModeProblem
from gks.modes.kreissdiscs import Region, patch
from gks.modes.numerals import exact_fraction, midpoint, modulus_of, radius_of
from gks.modes.pockets import Circle, Pocket, circled
from gks.modes.tables import Tables, ball_tables, disc_tables
from gks.modes.undecided import Undecided
from gks.modes.verdict import Mode, ModeKind
from gks.modes.winding import full_circle, seeds, walk
