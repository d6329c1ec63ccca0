"""The fuzz campaign: random interfaces drawn from a seed, each judged by independent routes; what disagrees is shrunk.

A chunk draws from a seed of its own, made of the campaign's seed and its number, so the schemes are the same whoever
computes which chunk.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from typing import Any

import gks
from gks.campaigns.checkpoint import Key
from gks.campaigns.conduct import Conduct, Progress
from gks.campaigns.draw import Draft
from gks.campaigns.routes import AGREES, OPEN, Check, Judged, judge
from gks.campaigns.search import drawn, hypothesis_version, shrunk
from gks.errors import counted

CHUNK = 100
"""Schemes of a chunk: some seconds of work, which is what a run that is ended loses."""

SHOWN = 8
"""Interfaces with the full stable range that the printed result shows; the JSON has all."""


def fuzz(count: int, seed: int, conduct: Conduct) -> FuzzResult:
    """So many random interfaces from the seed, judged; progress is told in schemes.

    InputError where hypothesis isn't installed, or the folder to resume from is another campaign's.
    """
    key: Key = {
        "campaign": "gks.fuzz/1",
        "version": gks.__version__,
        "hypothesis": hypothesis_version(),
        "seed": seed,
        "count": count,
        "chunk": CHUNK,
    }
    arguments = [(seed, number, min(CHUNK, count - number * CHUNK)) for number in range(-(-count // CHUNK))]
    told = None if conduct.progress is None else _in_schemes(conduct.progress, count)
    return _together(seed, conduct.results(fuzz_chunk, arguments, key, told))


def _in_schemes(progress: Progress, count: int) -> Progress:
    return lambda done, chunks: progress(min(count, done * CHUNK), count)


def fuzz_chunk(seed: int, number: int, size: int) -> dict[str, Any]:
    """One chunk: what was counted, the interfaces with the full range, the disagreements with their minimal schemes."""
    judged = {draft: judge(draft) for draft in drawn(seed, number, size)}
    verdicts: dict[str, Counter[str]] = {}
    checks: dict[str, Counter[str]] = {}
    for draft, found in judged.items():
        verdicts.setdefault(draft.family, Counter())[found.verdict] += 1
        for check, outcome in found.checks.items():
            checks.setdefault(check, Counter())[outcome if outcome in (AGREES, OPEN) else "disagrees"] += 1
    return {
        "verdicts": {family: dict(found) for family, found in verdicts.items()},
        "checks": {check: dict(found) for check, found in checks.items()},
        "unconfirmed": [
            {**_written(draft), "lam": str(draft.lam), "verdict": found.verdict}
            for draft, found in judged.items()
            if not found.confirmed and found.failed is None
        ],
        "full_range": [_written(draft) for draft, found in judged.items() if found.full_range],
        "disagreements": _disagreements(judged, seed, number, size),
    }


def _written(draft: Draft) -> dict[str, str]:
    return {"family": draft.family, **draft.weights()}


def _disagreements(judged: Mapping[Draft, Judged], seed: int, number: int, size: int) -> list[dict[str, str]]:
    """Those of the chunk; what fails the same check is shrunk once."""
    minimal: dict[Check, Draft] = {}
    failed = {draft: found.failed for draft, found in judged.items()}
    listed: list[dict[str, str]] = []
    for draft, found in judged.items():
        check = found.failed
        if check is None:
            continue
        if check not in minimal:
            minimal[check] = shrunk(seed, number, size, draft, partial(_fails, check=check, known=failed))
        least = minimal[check]
        outcome = judge(least, only=None if check == "crash" else check)
        notes = f"exact route: {outcome.verdict}. {check}: {outcome.checks.get(check, found.checks[check])}."
        listed.append(
            {
                "check": check,
                "verdict": found.verdict,
                "found": found.checks[check],
                **_written(draft),
                "lam": str(draft.lam),
                "scheme": least.text(notes),
            }
        )
    return listed


def _fails(draft: Draft, check: Check, known: Mapping[Draft, Check | None]) -> bool:
    if draft in known:
        return known[draft] == check
    return judge(draft, only=check).failed == check


# The result -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class FuzzResult:
    """What a campaign found; it carries no time, and is the same whatever computed it.

    verdicts       by family of interfaces, how many have which verdict of the exact route
    checks         by check, how many agree, cannot tell, and disagree
    unconfirmed    the schemes on whose verdict no route without elimination could tell
    full_range     the interfaces that leave the interior its whole stable range, each once
    disagreements  what each scheme drawn is and what was found, with a minimal scheme that shows the same
    """

    seed: int
    verdicts: Mapping[str, Mapping[str, int]]
    checks: Mapping[str, Mapping[str, int]]
    unconfirmed: tuple[Mapping[str, str], ...]
    full_range: tuple[Mapping[str, str], ...]
    disagreements: tuple[Mapping[str, str], ...]

    @property
    def schemes(self) -> int:
        return sum(sum(found.values()) for found in self.verdicts.values())

    @property
    def total(self) -> Mapping[str, int]:
        """How many have which verdict, over all families."""
        summed: Counter[str] = Counter()
        for found in self.verdicts.values():
            summed.update(found)
        return dict(sorted(summed.items()))

    def minimal_schemes(self) -> dict[str, str]:
        """Scheme files that show the disagreements, by a file name made of what is wrong and what they hold."""
        found = {(each["check"].replace(" ", "-"), each["scheme"]) for each in self.disagreements}
        return {f"disagreement-{c}-{sha256(text.encode()).hexdigest()[:8]}.toml": text for c, text in sorted(found)}

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.fuzz/1",
            "seed": self.seed,
            "schemes": self.schemes,
            "verdicts": self.total,
            "families": self.verdicts,
            "checks": self.checks,
            "unconfirmed": list(self.unconfirmed),
            "full_range": list(self.full_range),
            "disagreements": list(self.disagreements),
        }

    def to_csv(self) -> str:
        """The interfaces with the full stable range, one a line."""
        columns = ("family", "ratio", "speed", "a", "b", "x", "y")
        rows = [",".join(columns)]
        rows += [",".join(f'"{each[c]}"' if c == "family" else each[c] for c in columns) for each in self.full_range]
        return "\n".join(rows) + "\n"

    def __str__(self) -> str:
        lines = [f"{counted(self.schemes, 'random interface')} from seed {self.seed}", ""]
        lines += [f"  {verdict:<14} {number}" for verdict, number in self.total.items()]
        lines += ["", f"  {'check':<14} {AGREES:>9} {OPEN:>12} {'disagrees':>10}"]
        for check, found in self.checks.items():
            lines.append(
                f"  {check:<14} {found.get(AGREES, 0):>9} {found.get(OPEN, 0):>12} {found.get('disagrees', 0):>10}"
            )
        confirmed = self.schemes - len(self.unconfirmed) - len(self.disagreements)
        lines += ["", f"  {counted(confirmed, 'verdict')} confirmed by a route without elimination"]
        lines.append(f"  {counted(len(self.full_range), 'interface')} with the full stable range of the interior")
        lines += [f"    {_line(each)}" for each in self.full_range[:SHOWN]]
        lines += ["    ..."] if len(self.full_range) > SHOWN else []
        lines.append(f"  {counted(len(self.disagreements), 'disagreement')}")
        for each in self.disagreements:
            lines.append(f"    {each['check']}: {each['found']} ({_line(each)}, lam = {each['lam']})")
        return "\n".join(lines)


def _line(each: Mapping[str, str]) -> str:
    media = f"ratio {each['ratio']}, speed {each['speed']}"
    return f"{each['family']}: {media}, a = {each['a']}, b = {each['b']}, x = {each['x']}, y = {each['y']}"


def _together(seed: int, results: list[dict[str, Any]]) -> FuzzResult:
    """Chunks in their order; families and checks sorted, interfaces with the full range once each."""
    verdicts: dict[str, Counter[str]] = {}
    checks: dict[str, Counter[str]] = {}
    full: dict[tuple[str, ...], Mapping[str, str]] = {}
    for result in results:
        for name, whole in (("verdicts", verdicts), ("checks", checks)):
            for kind, found in result[name].items():
                whole.setdefault(kind, Counter()).update(found)
        full.update({tuple(each.values()): each for each in result["full_range"]})
    return FuzzResult(
        seed,
        {family: dict(sorted(verdicts[family].items())) for family in sorted(verdicts)},
        {check: dict(sorted(checks[check].items())) for check in sorted(checks)},
        tuple(each for result in results for each in result["unconfirmed"]),
        tuple(full.values()),
        tuple(each for result in results for each in result["disagreements"]),
    )
