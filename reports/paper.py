"""`gks report --paper`: the whole paper redone, each part beside what is printed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from gks.catalogue import find
from gks.reports.crew import Watcher
from gks.reports.document import Block, Link, Paragraph, Report, Result, Strong, Table, Text
from gks.reports.paper_analysis import analysis_section, audit_section
from gks.reports.paper_experiments import introduction_section, waves_section
from gks.reports.paper_numbers import differences_section, numbers_section, work_section
from gks.reports.printed import OTHERS, THEOREMS, TITLE, UNEQUAL
from gks.reports.provenance import provenance
from gks.reports.report import computed, ready, write
from gks.reports.scheme_answers import detached, proved
from gks.reports.scheme_plan import PROOF_LIMIT, swept
from gks.reports.steps import LIMIT, Step
from gks.reports.store import Store
from gks.scheme.model import Scheme

NAME = "paper"

FIGURE_3 = "alpha=1e-2:1e3:201:log"

ERRORS = ("5", "6", "7", "7-traditional", "8-traditional", "8-weighted")

BRACKETS = (("mirror", 2.0, 20.0), ("traditional", 0.125, 2.0), ("average", 0.005, 0.04), ("average", 20.0, 50.0))
"""Neighbouring entries of Table 1 that differ."""


def paper_report(
    folder: str, watcher: Watcher, formats: Sequence[str] = ("html",), *, fresh: bool = False
) -> list[str]:
    """Write the paper's report into the folder; the paths of its pages."""
    store = Store(ready(folder), fresh=fresh)
    records = computed(plan(), store, watcher)
    # Alone: what is timed shares the machine with nothing of ours.
    records |= computed([Step("work", "paper_steps.work_precision", {}, limit=3 * LIMIT)], store, watcher)
    return write(build(records), folder, formats, store, watcher)


def plan() -> tuple[Step, ...]:
    """All computations but the timed ones, the longest first."""
    steps = [
        Step(f"threshold-{k + 1}", "paper_steps.thresholds", {"conditions": [list(bracket)]}, limit=2 * LIMIT)
        for k, bracket in enumerate(BRACKETS)
    ]
    steps += [
        Step("table-1", "paper_steps.table_1", {}, limit=2 * LIMIT),
        Step("readings", "paper_steps.readings", {}, limit=2 * LIMIT),
    ]
    for name in _schemes():
        scheme = find(name)
        source = scheme.text, name, None
        steps.append(Step(f"audit-{name}", "steps.audit", {}, source, f"gks audit {name}", 2 * LIMIT))
        if name not in OTHERS:
            arguments = {"values": _fixed(scheme), "limit": PROOF_LIMIT}
            limit = LIMIT + PROOF_LIMIT
            steps.append(Step(f"theorem-{name}", "steps.theorem", arguments, source, f"gks prove {name}", limit))
            steps.append(Step(f"derive-{name}", "steps.derive", {}, source, f"gks derive {name}"))
    for name in ("traditional-1", "traditional-2", "weighted-2"):
        scheme = find(name)
        curve = {"values": {p.name: str(p.default) for p in scheme.parameters}, "sweep": FIGURE_3}
        command = f"gks curve {name} --sweep {FIGURE_3}"
        steps.append(Step(f"curve-{name}", "steps.curve", curve, (scheme.text, name, None), command))
    for condition in ("traditional", "weighted"):
        steps.append(Step(f"convergence-{condition}", "paper_steps.convergence", {"condition": condition}))
    steps += [Step(f"figure-{figure}", "paper_steps.errors", {"figure": figure}) for figure in ERRORS]
    steps += [Step(f"figure-{figure}", "paper_steps.riemann", {"figure": figure}) for figure in (2, 10, 11)]
    steps += [
        Step("figure-4", "paper_steps.exact_waves", {}),
        Step("left", "paper_steps.left_at_the_end", {}),
        Step("neutral", "paper_steps.neutral_ratios", {}),
    ]
    return tuple(steps)


def _schemes() -> tuple[str, ...]:
    return (*(theorem.scheme for theorem in THEOREMS), *UNEQUAL, *OTHERS)


def _fixed(scheme: Scheme) -> dict[str, str]:
    """The defaults of all parameters but lam and the one that the theorem is over."""
    free = swept(scheme)
    return {p.name: str(p.default) for p in scheme.parameters if p.role is None and p != free}


def build(records: Mapping[str, Mapping[str, Any]]) -> Report:
    """The report from the records of its steps."""
    attachments: dict[str, str] = {}
    kept = {}
    for key, record in records.items():
        kept[key] = detached(record, f"{NAME}-{key}-certificate.json", attachments)
    results = {key: Result(key, record) for key, record in kept.items()}
    sections = (
        introduction_section(NAME, results),
        analysis_section(NAME, results),
        waves_section(NAME, results),
        numbers_section(results),
        differences_section(results),
        audit_section(results),
        work_section(NAME, results),
        provenance(kept),
    )
    return Report(NAME, "Numerical interface conditions for fluid/structure interaction, redone", _summary(results),
                  sections, kept, {name: find(name).text for name in _schemes()}, attachments)  # fmt: skip


def _summary(results: Mapping[str, Result]) -> tuple[Block, ...]:
    theorems = [results[f"theorem-{theorem.scheme}"] for theorem in THEOREMS]
    stand = sum(result.refused is None and proved(result) for result in theorems)
    entries = results["table-1"].get("entries") if results["table-1"].refused is None else []
    agreeing = sum(entry["agrees"] for entry in entries)
    statuses = [
        claim["evidence"]["status"]
        for name, result in results.items()
        if name.startswith("audit-") and result.refused is None
        for claim in result.get("claims")
    ]
    rows: tuple[tuple[Text, ...], ...] = (
        (("Theorems 3.1 to 3.5",), (Strong(f"{stand} of {len(THEOREMS)} proved", _tone(stand, len(THEOREMS))),
                                    ", each with a certificate; see ", Link("Section 3", "#analysis"))),
        (("Table 1",), (Strong(f"{agreeing} of {len(entries)} entries as printed", _tone(agreeing, len(entries))),
                        "; see ", Link("Section 2", "#introduction"))),
        (("statements held",), (f"{statuses.count('holds')} hold as printed, {statuses.count('fails')} fail; nearly "
                                "all that fail are due to one inverted ratio; see ",
                                Link("the differences", "#differences"))),
    )  # fmt: skip
    source: Text = ("After J. W. Banks and B. Sjögreen, ", f"“{TITLE}”: its figures, its table, its theorems and its "
                    "numbers, derived, proved, marched and audited here, each beside what is printed.")  # fmt: skip
    return (Paragraph(source), Table((), ((), ()), rows))


def _tone(count: int, of: int) -> str:
    return "good" if count == of else "bad"
