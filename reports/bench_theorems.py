"""The time of every theorem: the paper's, and those of the traditional couplings under wider interiors.

Each row is two commands as a user gives them, in processes of their own: `gks prove` under a limit, and `gks check` on
the certificate it wrote. What is not proved within the limit says the stage that was reached.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from gks.bounds.subprocessing import environment
from gks.catalogue.interfaces import closure_lines, ghost_equations, own_value, two_media
from gks.reports.tables import Table
from gks.solvers.work_precision import machine

LIMIT = 60
"""Seconds that `gks prove` may take for a row."""

PAPER = (
    "traditional-1",
    "traditional-1-mirror",
    "implicit-1",
    "weighted-1",
    "average-1",
    "characteristic-1",
    "traditional-2",
    "weighted-2",
    "characteristic-2",
    "weighted-1-unequal",
    "weighted-2-unequal",
)
"""Shipped schemes: the paper's linear theorems, and its couplings that no theorem of it speaks of."""

INTERIORS = {
    "Lax-Wendroff": ('scheme = "lax-wendroff"', 1),
    "leapfrog": ('space = "central2"\ntime = "leapfrog"', 1),
    "Crank-Nicolson": ('space = "central2"\ntime = "crank-nicolson"', 1),
    "Beam-Warming": ('scheme = "beam-warming"', 2),
    "Fromm": ('scheme = "fromm"', 2),
    "second-order upwind, forward Euler": ('space = "upwind2"\ntime = "forward-euler"', 2),
    "second-order upwind, backward Euler": ('space = "upwind2"\ntime = "backward-euler"', 2),
}
"""Wider interiors, with the number of points beyond the interface that they read."""

LONGEST = 48
"""Characters of a formula or a reason that a row shows."""


@dataclass(frozen=True, slots=True)
class Run:
    """One command: its exit status, standard output, and seconds of wall clock and of processors, children included."""

    status: int
    output: str
    wall: float
    cpu: float


def interface(name: str, order: int) -> str:
    """The traditional coupling of order 1 or 2 under an interior of INTERIORS, as the text of a scheme file."""
    interior, depth = INTERIORS[name]
    title = f"{name}, traditional coupling, order {order}"
    parameters = 'lam = { role = "cfl", default = 0.5 }\nalpha = { default = 1, range = [0, inf] }'
    let = {"u_I": own_value("L", "u", order), "s_I": own_value("R", "s", order)}
    return two_media(title, parameters, interior, closure_lines(ghost_equations(order, depth), let))


def measure(progress: Callable[[str], None], limit: float = LIMIT, schemes: Mapping[str, str] | None = None) -> Table:
    """The table; ``schemes`` are names with the text of a file, or "" for a shipped scheme (default: all of them)."""
    rows = []
    with TemporaryDirectory() as folder:
        for name, text in (all_schemes() if schemes is None else dict(schemes)).items():
            progress(name)
            rows.append(_row(Path(folder), name, text, limit))
    columns = ("scheme", "status", "pieces", "bound", "stage", "prove_s", "prove_cpu_s", "check_s", "check")
    notes = (
        f"prove has {limit:g} s a scheme; seconds are those of whole processes, cpu_s of all their children",
        _where(),
    )
    return Table("Theorems: gks prove, and gks check of its certificate", columns, tuple(rows), notes)


def all_schemes() -> dict[str, str]:
    """The shipped schemes and the interfaces."""
    return {**dict.fromkeys(PAPER, ""), **{f"{n}, order {k}": interface(n, k) for n in INTERIORS for k in (1, 2)}}


def _where() -> str:
    return str(machine())


def _row(folder: Path, name: str, text: str, limit: float) -> tuple[str | int | float | None, ...]:
    path, certificate = folder / "scheme.toml", folder / "certificate.json"
    certificate.unlink(missing_ok=True)
    path.write_text(text)
    proof = run(["prove", str(path) if text else name, "--limit", f"{limit:g}", "--json", "-o", str(certificate)])
    if proof.status:
        return name, f"exit {proof.status}", None, None, None, proof.wall, proof.cpu, None, None
    theorem = json.loads(proof.output)
    pieces = theorem["pieces"]
    if not certificate.exists():
        return name, theorem["status"], None, None, _short(theorem["reason"]), proof.wall, proof.cpu, None, None
    check = run(["check", str(certificate)])
    verdict = "rejected" if check.status else "accepted"
    shown = _short("; ".join(_bounds(pieces)))
    return name, theorem["status"], len(pieces), shown, None, proof.wall, proof.cpu, check.wall, verdict


def _bounds(pieces: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """The bounds, each once while it goes on."""
    last = None
    for piece in pieces:
        if piece["bound"] != last:
            last = piece["bound"]
            yield last


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def run(arguments: Sequence[str]) -> Run:
    """`gks` with these arguments, in a fresh process."""
    before, start = os.times(), perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "gks", *arguments], env=environment(), stdout=subprocess.PIPE, text=True, check=False
    )
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return Run(done.returncode, done.stdout, perf_counter() - start, cpu)
