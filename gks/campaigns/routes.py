"""A drawn interface judged by routes that share the reader of scheme files and no more.

exact        elimination, and algebra on the unit circle (`gks.modes`)
stable set   the verdict at the lam drawn against the stable set in lam (`gks.bounds.cfl`), for narrow interiors
spectrum     eigenvalues of the finite problem's one-step matrix: those outside the circle that stay where they are when
             cells are added are growing modes, and then their modulus is held against the exact one too
mode         inverse iteration on the finite problem, next to a z of the exact route, where the spectrum can't tell
count        zeros of the determinant counted and enclosed (`gks.modes.wide`), where neither could tell
march        growth per step, observed

Of all schemes a sample is put to the last two as well; which ones, their text decides.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from hashlib import sha256
from typing import Any, Literal

from gks.bounds.cfl import StableSet, stable_set
from gks.campaigns.draw import Draft
from gks.errors import GksError, InputError
from gks.modes import analyse
from gks.modes.algebraic import Root
from gks.modes.analysis import quick_verdict
from gks.modes.kreiss import normal_mode_problem
from gks.modes.verdict import Mode, ModeKind, Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme

Check = Literal["crash", "spectrum", "mode", "stable set", "count", "march"]

AGREES, OPEN = "agrees", "cannot tell"

COUNTED, MARCHED, MEASURED = 32, 128, 4
"""One scheme of so many is counted, one is marched; of those that aren't stable one in so many has its modulus compared
with the spectrum, and its lam with the stable set."""

CELLS = (10, 20, 40)
"""Cells a side of the finite problems: more are taken until the spectral radius is settled."""

SETTLED = 1e-6
"""Relative change of the spectral radius from one number of cells to twice as many at which it counts as settled: the
error of a mode falls as kappa**(2 cells), so that what is left is of the order of the square."""

OUTSIDE = 1e-3
"""What is outside the circle by less says nothing: rounding splits a Jordan block of order 4 on the circle (as large as
two media of two fields have) by (2**-52)**(1/4) = 1.2e-4 times the condition of the matrix."""

SAME = 1e-5
"""Relative difference of a settled spectral radius and the exact modulus: ten times SETTLED."""

RESONANT = 0.25
"""Power of n, less its uncertainty, above which a forced response grows: half of the least that a mode has."""

NEAR = 1e-7
"""Relative difference of the z found by inverse iteration and the exact one: a march of 240 steps tells it to 1e-9."""

CRASHES = (ArithmeticError, AssertionError, AttributeError, LookupError, NotImplementedError, TypeError, ValueError)
"""What no scheme may raise: the program is then at fault, and the scheme is worth a file."""


@dataclass(frozen=True, slots=True)
class Judged:
    """The exact verdict (or "refused", "crashed") and what each check says: AGREES, OPEN, or what is wrong.

    ``full_range`` says whether the closure leaves the interior's whole stable range; None where it wasn't asked.
    """

    verdict: str
    checks: Mapping[Check, str]
    full_range: bool | None = None

    @property
    def failed(self) -> Check | None:
        """The first check that contradicts the exact route."""
        return next((check for check, outcome in self.checks.items() if outcome not in (AGREES, OPEN)), None)

    @property
    def confirmed(self) -> bool:
        """Whether a route of another kind could tell, and agrees."""
        return self.failed is None and any(self.checks.get(c) == AGREES for c in SECOND)


SECOND: tuple[Check, ...] = ("spectrum", "mode", "count", "march")
"""The checks that share no code with elimination."""


def judge(draft: Draft, only: Check | None = None) -> Judged:
    """The draft put to the checks; with ``only`` to that one alone, whether it is of its sample or not."""
    scheme = parse_scheme(draft.text(), "draft")
    values = scheme.values()
    try:
        verdict = quick_verdict(scheme, values)
        if verdict is Verdict.UNDECIDED:
            return Judged(verdict.value, {})
        sample = int.from_bytes(sha256(scheme.text.encode()).digest()[:4])
        asked = only in ("stable set", "crash") or (
            only is None and (verdict is Verdict.STABLE or sample % MEASURED == 0)
        )
        found = stable_set(scheme, values) if draft.interior.narrow and asked else None
    except InputError:
        return Judged("refused", {})
    except CRASHES as error:
        return Judged("crashed", {"crash": f"{type(error).__name__}: {error}"})
    case = _Case(scheme, values, verdict, sample)
    checks = case.checks() if only is None else case.one(only)
    if found is None:
        return Judged(verdict.value, checks)
    return Judged(verdict.value, {"stable set": _set_check(found, values[scheme.cfl], verdict), **checks}, _full(found))


@dataclass(frozen=True, slots=True)
class _Case:
    scheme: Scheme
    values: dict[str, Fraction]
    verdict: Verdict
    sample: int

    def checks(self) -> dict[Check, str]:
        outcomes = self.one("spectrum")
        if self.verdict is Verdict.NEUTRAL or (self.verdict is Verdict.UNSTABLE and outcomes["spectrum"] == OPEN):
            outcomes |= self.one("mode")
        if AGREES not in outcomes.values() or self.sample % COUNTED == 0:
            outcomes |= self.one("count")
        if AGREES not in outcomes.values() and self.verdict is Verdict.GENERALIZED:
            outcomes |= self.one("mode")
        if self.sample % MARCHED == 0:
            outcomes |= self.one("march")
        return outcomes

    def one(self, check: Check) -> dict[Check, str]:
        """What that check says; a check that breaks down is worth a file as well as one that disagrees."""
        methods = {"spectrum": self.spectrum, "mode": self.mode, "count": self.count, "march": self.march}
        if check not in methods:
            return {}
        try:
            return {check: methods[check]()}
        except GksError:
            return {check: OPEN}
        except CRASHES as error:
            return {check: f"{type(error).__name__}: {error}"}

    def spectrum(self) -> str:
        radius = settled_radius(self.scheme, self.values)
        if radius is None:
            return OPEN
        grows = radius > 1 + OUTSIDE
        if self.verdict is not Verdict.UNSTABLE:
            return f"{self.verdict.value}, but the finite problem grows by {radius:.9g} a step" if grows else AGREES
        if not grows:
            return OPEN  # the mode grows by less than can be seen, or decays too slowly in space for these cells
        if self.sample % MEASURED:
            return AGREES
        exact = max((float(mode.modulus) for mode in self._modes(ModeKind.GROWING)), default=float("inf"))
        if exact == float("inf") or abs(exact - radius) <= SAME * exact:
            return AGREES
        return f"the mode has modulus {exact:.12g}, and the finite problem grows by {radius:.12g} a step"

    def mode(self) -> str:
        """The mode of largest modulus, sought where the exact route has it; a generalized one by forcing at its z."""
        from gks.solvers.problem import build
        from gks.solvers.runs import mode_march
        from gks.solvers.seeds import OutOfReach

        kinds = {Verdict.UNSTABLE: ModeKind.GROWING, Verdict.GENERALIZED: ModeKind.GENERALIZED}
        modes = self._modes(kinds.get(self.verdict, ModeKind.EIGENVALUE))
        if not modes:
            return OPEN
        if self.verdict is Verdict.GENERALIZED:
            return AGREES if any(self._resonates(mode.z_complex) for mode in modes) else OPEN
        z = max(modes, key=lambda mode: mode.modulus).z_complex
        try:
            found = mode_march(build(self.scheme, self.values), z)
        except OutOfReach:
            return OPEN
        # Where inverse iteration meets another eigenvalue first, or none that lives at the interface, nothing is said.
        return AGREES if found is not None and abs(found.z - z) <= NEAR * abs(z) else OPEN

    def _resonates(self, z: complex) -> bool:
        """Whether the response to forcing at z**n grows as a power of n: 1 at a simple pole of the resolvent, 1/2 at a
        glancing wave, 0 where there is no mode."""
        from gks.solvers.runs import forced_response

        found = forced_response(self.scheme, self.values, z / abs(z))
        return found.exponent - found.uncertainty > RESONANT

    def count(self) -> str:
        from gks.modes.wide import wide_modes

        found = wide_modes(normal_mode_problem(self.scheme, self.values))
        kinds = {mode.kind for mode in found.modes}
        if ModeKind.GROWING in kinds:
            counted = Verdict.UNSTABLE
        elif found.doubts:
            return OPEN
        elif ModeKind.GENERALIZED in kinds:
            counted = Verdict.GENERALIZED
        else:
            counted = Verdict.NEUTRAL if ModeKind.EIGENVALUE in kinds else Verdict.STABLE
        return AGREES if counted is self.verdict else f"{self.verdict.value}, but counted as {counted.value}"

    def march(self) -> str:
        from gks.solvers.march import march

        result = march(self.scheme, self.values)
        return AGREES if result.agrees else result.remark

    def _modes(self, kind: ModeKind) -> list[Mode]:
        return [mode for mode in analyse(self.scheme, self.values).modes if mode.kind is kind]


def settled_radius(scheme: Scheme, values: Mapping[str, Fraction]) -> float | None:
    """The spectral radius of one step of the finite problem where two numbers of cells agree on it, or on at most 1.

    None where they don't: waves of a nondissipative interior run to and fro between the ends, and what they gain at the
    interface fades only as 1/cells; where the closure determines no next level; and where rounding the matrix may have
    carried an eigenvalue across the circle.
    """
    import numpy

    from gks.solvers.update import update_matrix

    last = float("inf")
    for cells in CELLS:
        try:
            matrix = update_matrix(scheme, values, cells)
            radius = float(numpy.abs(numpy.linalg.eigvals(matrix)).max())
        except numpy.linalg.LinAlgError:
            return None
        if max(radius, last) <= 1 + OUTSIDE:
            return radius
        if abs(radius - last) <= SETTLED * radius:
            return radius if radius - _blur(matrix) > 1 else None
        last = radius
    return None


def _blur(matrix: Any) -> float:
    """How far rounding the entries moves the eigenvalue of largest modulus, to first order (Wilkinson, The Algebraic
    Eigenvalue Problem, 1965, ch. 2): u norm(A) / abs(y* x), x and y its right and left eigenvectors.
    """
    import numpy
    from scipy.linalg import eig

    values, left, right = eig(matrix, left=True, right=True)
    largest = int(numpy.abs(values).argmax())
    cosine = abs(numpy.vdot(left[:, largest], right[:, largest]))
    return float(numpy.finfo(float).eps * numpy.linalg.norm(matrix) / max(cosine, numpy.finfo(float).tiny))


def _set_check(found: StableSet, lam: Fraction, verdict: Verdict) -> str:
    if found.undecided is not None:
        return OPEN
    exact = Root.of(lam)
    for interval in found.intervals:
        if exact in (interval.low, interval.high):
            return OPEN  # the ends of the open intervals may be either
    inside = any(
        (each.low is None or each.low < exact) and (each.high is None or exact < each.high) for each in found.intervals
    )
    if inside == (verdict is Verdict.STABLE):
        return AGREES
    return f"{verdict.value} {'in' if inside else 'out'}side the stable set"


def _full(found: StableSet) -> bool | None:
    """Whether the one stable interval is that of the interior."""
    if found.undecided is not None:
        return None
    return len(found.intervals) == 1 and found.intervals[0].low is None and found.limited_by != "closure"
