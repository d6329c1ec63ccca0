"""The proof itself: cells, formulas, certificate and its check, in the process that is asked.

``proof.prove`` runs it in a process of its own, which honours limits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from time import perf_counter

from gks.bounds.cells import decompose
from gks.bounds.certificate import certificate, constant_certificate
from gks.bounds.cfl import StableSet, stable_set
from gks.bounds.check import check
from gks.bounds.clearpoint import decays_at, eliminated
from gks.bounds.criticality import between
from gks.bounds.pieces import constant_piece, limits, pieces
from gks.bounds.pointverdict import NotProved, interior_holds, verdict_at
from gks.bounds.proof import Report, free_parameters, not_proved
from gks.bounds.region import Decomposition
from gks.bounds.signs import interior_sets
from gks.bounds.theorem import Theorem
from gks.errors import NotAnalysable
from gks.modes.algebraic import Root
from gks.modes.fibre import VanishesIdentically
from gks.modes.undecided import Undecided
from gks.modes.verdict import Verdict
from gks.scheme.model import Parameter, Scheme


def checked_region(scheme: Scheme, values: Mapping[str, Fraction], report: Report = lambda stage: None) -> Region:
    """A theorem is said to be proved only with a certificate that the independent checker accepts."""
    start = perf_counter()
    found = _region(scheme, values, report)
    theorem = found.theorem
    if not theorem.proved:
        return found
    report("check of the certificate")
    problem = check(theorem.certificate).problem
    if problem is None:
        return replace(found, theorem=replace(theorem, time_s=perf_counter() - start))
    reason = f"the certificate is not accepted by the check: {problem}"
    return Region(not_proved(scheme, theorem.parameter, reason, start), None)


def prove_here(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Theorem:
    """``prove`` in this process: without a limit, a check, or a curve where nothing is proved."""
    return _region(scheme, values, report).theorem


@dataclass(frozen=True, slots=True)
class Region:
    """A theorem with the cells it was read off: None where it has no parameter, or is not proved."""

    theorem: Theorem
    cells: Decomposition | None

    def to_json(self) -> Mapping[str, object]:
        return self.theorem.to_json()


def _region(scheme: Scheme, values: Mapping[str, Fraction], report: Report) -> Region:
    start = perf_counter()
    free = free_parameters(scheme, values)
    if len(free) > 1:
        names = ", ".join(p.name for p in free)
        reason = f"{len(free)} parameters are free ({names}) and a theorem has one; set the others"
        return Region(not_proved(scheme, None, reason, start), None)
    if any(half_line.time == "exact" for half_line in scheme.domains):
        reason = "time is exact, so that lam plays no part and nothing bounds it"
        return Region(not_proved(scheme, free[0].name if free else None, reason, start), None)
    fixed = scheme.values(values, free=[p.name for p in free])
    name = free[0].name if free else None
    try:
        found = _over_parameter(scheme, fixed, free[0], report) if free else Region(_constant(scheme, fixed), None)
    except (NotProved, Undecided) as why:
        return Region(not_proved(scheme, name, str(why), start), None)
    except NotAnalysable as why:
        return Region(not_proved(scheme, name, why.message, start), None)
    except VanishesIdentically:
        return Region(not_proved(scheme, name, "a boundary polynomial vanishes identically", start), None)
    return replace(found, theorem=replace(found.theorem, time_s=perf_counter() - start))


def _over_parameter(scheme: Scheme, fixed: Mapping[str, Fraction], parameter: Parameter, report: Report) -> Region:
    """Over the parameter's range, open and exact."""
    low, high = parameter.low, parameter.high
    found = decompose(scheme, fixed, parameter.name, low, high, report)
    report("formulas")
    words = found, parameter.name, scheme.cfl, low, high
    stated = pieces(*words), limits(*words)
    theorem = Theorem(scheme, parameter.name, *stated, {}, None, None, 0.0, _others(scheme, fixed))
    return Region(replace(theorem, certificate=certificate(theorem, found, fixed, low, high)), found)


def _others(scheme: Scheme, fixed: Mapping[str, Fraction]) -> dict[str, Fraction]:
    """The values of all parameters but lam."""
    return {name: value for name, value in fixed.items() if name != scheme.cfl}


def _constant(scheme: Scheme, fixed: Mapping[str, Fraction]) -> Theorem:
    """The exact stable set in lam."""
    found = stable_set(scheme, fixed)
    if found.undecided is not None:
        raise NotProved(found.undecided)
    piece = constant_piece(found, _on_bound(scheme, fixed, found), scheme.cfl)
    theorem = Theorem(scheme, None, (piece,), (), {}, None, None, 0.0, _others(scheme, fixed))
    return replace(theorem, certificate=constant_certificate(theorem, found, fixed))


def _on_bound(scheme: Scheme, fixed: Mapping[str, Fraction], found: StableSet) -> Verdict | None:
    """The verdict at lam_max: None where that is 0 or infinite.

    Where modes with abs(z) >= 1 begin there, one is there and none grows: it is neutral if it decays strictly.
    """
    top = found.lam_max
    if top is None or top.is_zero:
        return None
    if found.limited_by == "closure" and top not in interior_sets(scheme, {**fixed, scheme.cfl: Fraction(1)})[1]:
        below = {**fixed, scheme.cfl: between(Root.of(0), top)}
        elimination = eliminated(scheme, below, (scheme.cfl,))
        decays = elimination is not None and decays_at(elimination, {scheme.cfl: top})
        if decays and interior_holds(scheme, {**fixed, scheme.cfl: top}):
            return Verdict.NEUTRAL
    return verdict_at(scheme, {**fixed, scheme.cfl: top})
