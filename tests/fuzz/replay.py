"""A case in a process of its own, under the plain program's limits.

This is what the corpus is tested with, and what confirms a fault that a worker met: a worker guided by coverage is
slower and larger than the program it tests.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.fuzz.case import parsed

ROOT = Path(__file__).parents[2]

HANG_SECONDS = 60.0
"""Wall time of one case: for what waits or starts others; processor time is limited in the process itself."""


PROGRAM = "from tests.fuzz.replay import main; main()"


def faults(paths: Sequence[Path], program: str = PROGRAM) -> dict[str, list[str]]:
    """What is wrong with how each case is taken, by the case's name; nothing for those that are taken well."""
    found: dict[str, list[str]] = {}
    waiting = list(paths)
    while waiting:
        done, reason = _carried_out(waiting, program)
        found |= {name: said for name, said in done.items() if said}
        waiting = waiting[len(done) :]
        if waiting:  # the process ended on the first of those left
            found[waiting[0].name] = [reason]
            waiting = waiting[1:]
    return found


def _carried_out(paths: Sequence[Path], program: str) -> tuple[dict[str, list[str]], str]:
    """The complaints about the first of the cases, as far as one process came, and what ended it."""
    command = [sys.executable, "-c", program, *map(str, paths)]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
    try:
        run = subprocess.run(
            command, capture_output=True, text=True, check=False, env=environment, timeout=HANG_SECONDS * len(paths)
        )
        out, status, said = run.stdout, run.returncode, run.stderr
    except subprocess.TimeoutExpired as late:
        out, status, said = (late.stdout or b"").decode() if isinstance(late.stdout, bytes) else "", -signal.SIGALRM, ""
    done = dict(json.loads(line) for line in out.splitlines() if line.startswith("["))
    if status == -signal.SIGPROF:
        return done, "over its processor time"
    return done, f"the process ended with status {status}: {said[-1000:]}"


def main() -> None:
    """Prints a line [name, complaints] after each case."""
    from tests.fuzz.sandbox import complaints, confine, warm_up

    warm_up()
    confine()
    with tempfile.TemporaryDirectory() as folder:
        for path in map(Path, sys.argv[1:]):
            print(json.dumps([path.name, complaints(parsed(path.read_bytes()), Path(folder))]), flush=True)
