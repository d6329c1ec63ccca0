"""Claims from the literature, held against what is derived.

Nothing here knows what any publication says. A claim is a bound on the CFL number, a verdict or a modulus; each kind is
derived in one way and compared exactly. A claim that fails comes with exact parameter values at which it does, the root
that shows it, and a march there, if the caller gives a marcher (`gks.solvers.march.march`). A bound is held at exact
values all over its range, which can refute it and can't prove it; with a prover the theorem decides over all of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from time import perf_counter
from typing import TYPE_CHECKING, Protocol

from gks.bounds.boundclaim import hold_bound
from gks.bounds.finding import Finding, Status, point_text, undecided
from gks.bounds.pointclaim import hold_modulus, hold_verdict
from gks.bounds.samples import interval_text, open_parameters
from gks.errors import GksError, InputError
from gks.scheme.model import Claim, Parameter, Scheme

if TYPE_CHECKING:
    from gks.bounds.region import Decomposition


class Result(Protocol):
    """What a marcher or a prover gives: the object of gks.march/1, of gks.theorem/1."""

    def to_json(self) -> Mapping[str, object]: ...


Route = Callable[[Scheme, Mapping[str, Fraction]], Result]
"""A second way to look at a scheme, given by the caller: a march at these values, a theorem with these values set."""


@dataclass(frozen=True, slots=True)
class Held:
    """A claim and what became of it."""

    claim: Claim
    finding: Finding

    @property
    def status(self) -> Status:
        return self.finding.status

    def to_json(self) -> dict[str, object]:
        example = self.finding.counterexample
        return {
            "source": self.claim.source,
            "holds": self.status is Status.HOLDS,
            "derived": self.finding.derived,
            "counterexample": None if example is None else example.to_json(),
            "evidence": {"status": self.status.value, "claimed": statement(self.claim), **self.finding.evidence},
        }

    def __str__(self) -> str:
        name = "holds" if self.status is Status.HOLDS else self.status.value.upper()
        lines = [f"  {name:<10} {self.claim.source}", f"  {'':<10}   claimed  {statement(self.claim)}"]
        lines.append(f"  {'':<10}   derived  {self.finding.derived}")
        if self.finding.counterexample is not None:
            lines.append(f"  {'':<10}   shown    {self.finding.counterexample}")
        theorem = self.finding.evidence.get("theorem")
        if isinstance(theorem, Mapping) and theorem.get("status") == "proved":
            first, *others = str(theorem["statement"]).splitlines()
            lines += [f"  {'':<10}   proved   {first}", *(f"  {'':<10}            {line}" for line in others)]
        march = self.finding.evidence.get("march")
        if isinstance(march, Mapping):
            lines.append(f"  {'':<10}   march    {_march_text(march)}")
        return "\n".join(lines)


@dataclass(frozen=True, slots=True)
class Audit:
    """All claims of one scheme file, in its order."""

    scheme: Scheme
    held: tuple[Held, ...]
    time_s: float = field(compare=False)

    def to_json(self) -> dict[str, object]:
        """The object of gks.audit/1."""
        return {"schema": "gks.audit/1", "claims": [each.to_json() for each in self.held], "time_s": self.time_s}

    def __str__(self) -> str:
        lines = [self.scheme.title, *(str(each) for each in self.held)]
        return "\n".join([*lines, f"  ({_count(self.held)}, {self.time_s:.3g} s)"])


@dataclass(frozen=True, slots=True)
class CatalogueAudit:
    """The audits of several schemes as one table."""

    audits: tuple[Audit, ...]

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.audits/1",
            "schemes": [{"name": each.scheme.name, **each.to_json(), "schema": "gks.audit/1"} for each in self.audits],
        }

    def __str__(self) -> str:
        rows = [(audit.scheme.name, held) for audit in self.audits for held in audit.held]
        width = max((len(name) for name, _ in rows), default=0)
        lines = [f"{'scheme':<{width}}  {'status':<9}  claim"]
        for name, held in rows:
            status = "holds" if held.status is Status.HOLDS else held.status.value.upper()
            lines.append(f"{name:<{width}}  {status:<9}  {held.claim.source}")
            if held.status is not Status.HOLDS:
                lines.append(f"{'':<{width}}  {'':<9}    claimed  {statement(held.claim)}")
                lines.append(f"{'':<{width}}  {'':<9}    derived  {held.finding.derived}")
        total = sum(audit.time_s for audit in self.audits)
        return "\n".join([*lines, f"({_count([held for _, held in rows])}, {total:.3g} s)"])


def audit(scheme: Scheme, marcher: Route | None = None, prover: Route | None = None) -> Audit:
    """Hold every claim of a scheme against the derivation.

    A claim that the analysis does not reach is undecided, with the reason; it never holds or fails for that.
    """
    start = perf_counter()
    held = []
    for claim in scheme.claims:
        region, told = _region(scheme, claim, prover)
        finding = _throughout(scheme, claim, _finding(scheme, claim, region), region)
        if told is not None:
            finding = replace(finding, evidence={**finding.evidence, "theorem": told})
        held.append(Held(claim, _marched(scheme, finding, marcher)))
    return Audit(scheme, tuple(held), perf_counter() - start)


def audit_catalogue(
    marcher: Route | None = None, prover: Route | None = None, progress: Callable[[str], None] | None = None
) -> CatalogueAudit:
    """The audits of all shipped schemes that carry claims; `progress` is told the name of each before it begins."""
    from gks import catalogue

    def audits() -> Iterator[Audit]:
        for name in catalogue.names():
            if progress is not None:
                progress(name)
            scheme = catalogue.find(name)
            if scheme.claims:
                yield audit(scheme, marcher, prover)

    return CatalogueAudit(tuple(audits()))


def statement(claim: Claim) -> str:
    """What a claim says, with its parameter values."""
    parts = [f"bound {claim.texts['bound']}"] if claim.bound is not None else []
    if claim.stable is not None:
        parts.append("stable" if claim.stable else "not stable")
    if claim.modulus is not None:
        parts.append(f"abs(z) = {claim.texts['modulus']}")
    return " and ".join(parts) + (f" at {point_text(claim.at)}" if claim.at else "")


def _finding(scheme: Scheme, claim: Claim, region: Result | None) -> Finding:
    """The finding for a claim; one that states several things holds if all of them do."""
    findings = []
    try:
        if claim.bound is not None:
            findings.append(hold_bound(scheme, claim, claim.bound, _cell_samples(scheme, claim, region)))
        if claim.stable is not None:
            findings.append(hold_verdict(scheme, claim))
        if claim.modulus is not None:
            findings.append(hold_modulus(scheme, claim, claim.modulus))
    except InputError as error:
        return undecided(error)
    return _together(findings)


def _together(findings: Sequence[Finding]) -> Finding:
    if len(findings) == 1:
        return findings[0]
    order = [Status.FAILS, Status.UNDECIDED, Status.HOLDS]
    worst = min(findings, key=lambda finding: order.index(finding.status))
    evidence = {key: value for finding in findings for key, value in finding.evidence.items()}
    return replace(worst, derived="; ".join(finding.derived for finding in findings), evidence=evidence)


def _region(scheme: Scheme, claim: Claim, prover: Route | None) -> tuple[Result | None, Mapping[str, object] | None]:
    """The theorem for a bound's values, with what is told of it, or the reason for none."""
    if prover is None or claim.bound is None:
        return None, None
    try:
        region = prover(scheme, {name: value for name, value in claim.at.items() if name != scheme.cfl})
    except GksError as error:
        return None, {"refused": str(error)}
    theorem = region.to_json()
    return region, {key: theorem.get(key) for key in ("status", "statement")}


def _over_parameter(scheme: Scheme, claim: Claim, region: Result | None) -> tuple[Decomposition, Parameter] | None:
    """The theorem's cells, and its parameter, where that is the one that the claim leaves open."""
    from gks.bounds.proving import Region

    free = open_parameters(scheme, claim)
    if not isinstance(region, Region) or region.cells is None:
        return None
    return (region.cells, free[0]) if [p.name for p in free] == [region.theorem.parameter] else None


def _cell_samples(scheme: Scheme, claim: Claim, region: Result | None) -> list[dict[str, Fraction]]:
    """Values in every cell of the theorem."""
    found = _over_parameter(scheme, claim, region)
    if found is None:
        return []
    cells, parameter = found
    values = scheme.values(dict(claim.at), [parameter.name])
    return [{**values, parameter.name: cell.sample} for cell in cells.cells]


def _throughout(scheme: Scheme, claim: Claim, finding: Finding, region: Result | None) -> Finding:
    """A bound that held wherever it was looked at, held for every value of the theorem's parameter."""
    found = _over_parameter(scheme, claim, region)
    if finding.status is not Status.HOLDS or claim.bound is None or found is None:
        return finding
    from gks.bounds.claimproof import holds_throughout

    cells, parameter = found
    values = scheme.values(dict(claim.at), [parameter.name])
    if not holds_throughout(claim.bound, cells, parameter.name, values, (parameter.low, parameter.high)):
        return finding
    derived = f"{scheme.cfl}_max equals the claim for every {parameter.name} in {interval_text(parameter)}: proved"
    return replace(finding, derived=derived, evidence={**finding.evidence, "route": "theorem"})


def _marched(scheme: Scheme, finding: Finding, marcher: Route | None) -> Finding:
    """A failing claim's finding with a march at its counterexample, or with the reason why there is none."""
    if marcher is None or finding.counterexample is None:
        return finding
    try:
        march: Mapping[str, object] = marcher(scheme, finding.counterexample.parameters).to_json()
    except GksError as error:
        march = {"refused": str(error)}
    return replace(finding, evidence={**finding.evidence, "march": march})


def _march_text(march: Mapping[str, object]) -> str:
    if "refused" in march:
        return f"none: {march['refused']}"
    observed, predicted, uncertainty = (march[key] for key in ("observed", "predicted", "uncertainty"))
    text = f"growth per step {_short(observed)} ± {_short(uncertainty, 2)}"
    if predicted is None:
        return f"{text}; no mode is admissible, none predicted"
    return f"{text}, {'as' if march['agrees'] else 'NOT as'} predicted ({_short(predicted)})"


def _short(number: object, digits: int = 7) -> str:
    return f"{number:.{digits}g}" if isinstance(number, float) else str(number)


def _count(held: Sequence[Held]) -> str:
    numbers = [(status.value, sum(each.status is status for each in held)) for status in Status]
    said = ", ".join(f"{number} {name}" for name, number in numbers if number)
    return f"{len(held)} claim{'s' * (len(held) != 1)}: {said or 'none'}"
