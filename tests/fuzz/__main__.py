"""Fuzzes the command line: `python -m tests.fuzz --count 100000`.

Guided by coverage with atheris (`pip install atheris`), or by `--plain` without. Cases that are taken wrongly are kept,
and the exit status is 1 if there are any.
"""

from __future__ import annotations

import argparse
import importlib.util
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.fuzz.replay import HANG_SECONDS, faults
from tests.fuzz.worker import keep

REPORT_SECONDS = 20.0
POLL_SECONDS = 0.2


@dataclass(slots=True)
class Share:
    """What one worker has to do: its folder, the cases left, the seed of the next start."""

    folder: Path
    left: int
    seed: int
    how: str
    process: subprocess.Popen[bytes] | None = None
    at: int = 0
    since: float = 0.0
    ended: list[str] = field(default_factory=list)

    def start(self) -> None:
        (self.folder / "done").write_text("0")
        command = [
            sys.executable,
            "-m",
            "tests.fuzz.worker",
            str(self.folder),
            str(self.left),
            str(self.seed),
            self.how,
        ]
        with (self.folder / "log").open("ab") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log)
        self.at, self.since = 0, time.monotonic()

    @property
    def finished(self) -> bool:
        return self.process is None and self.left <= 0

    def look(self) -> None:
        """Takes account of how far the worker is, ends it if it hangs, starts it again if it has died."""
        assert self.process is not None
        now = int((self.folder / "done").read_text() or self.at)  # empty while it is being written
        if now != self.at:
            self.at, self.since = now, time.monotonic()
        elif time.monotonic() - self.since > HANG_SECONDS:
            self.process.kill()
        status = self.process.poll()
        if status is None:
            return
        self.process = None
        current = self.folder / "current"
        if not current.exists():
            if status:
                raise SystemExit((self.folder / "log").read_text(errors="replace")[-2000:])
            self.left = 0
            return
        name = signal.Signals(-status).name if status < 0 else f"exit status {status}"
        reason = {"SIGPROF": "over its processor time", "SIGKILL": f"over {HANG_SECONDS:.0f} s"}.get(name, name)
        keep(self.folder / "found", current.read_bytes(), f"the process ended: {reason} (case {self.seed}:{now})")
        self.ended.append(reason)
        self.left -= now + 1
        self.seed += 1_000
        current.unlink()
        if self.left > 0:
            self.start()


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=100_000, help="how many inputs (100000)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="processes (2)")
    parser.add_argument("--plain", action="store_true", help="without coverage")
    parser.add_argument("--keep", type=Path, help="folder for what is found (default: a new one)")
    return parser.parse_args()


def _watch(shares: Sequence[Share], count: int) -> None:
    """Looks after the workers until all have done their share."""
    began = said = time.monotonic()
    while not all(share.finished for share in shares):
        time.sleep(POLL_SECONDS)
        for share in shares:
            if share.process is not None:
                share.look()
        if time.monotonic() - said > REPORT_SECONDS:
            said = time.monotonic()
            left = sum(max(share.left - share.at, 0) for share in shares if share.process is not None)
            print(f"{count - left} of {count} after {said - began:.0f} s", file=sys.stderr)


def main() -> int:
    """Runs the workers to their end and says what was found."""
    given = options()
    if not given.plain and importlib.util.find_spec("atheris") is None:
        print("fuzzing by coverage needs atheris: pip install atheris (or --plain)", file=sys.stderr)
        return 2
    place = given.keep or Path(tempfile.mkdtemp(prefix="gks-fuzz-"))
    shares = []
    for k in range(given.jobs):
        (place / str(k) / "found").mkdir(parents=True, exist_ok=True)
        part = given.count // given.jobs + (k < given.count % given.jobs)
        shares.append(Share(place / str(k), part, given.seed + k, "plain" if given.plain else "guided"))
        shares[-1].start()
    began = time.monotonic()
    try:
        _watch(shares, given.count)
    finally:
        for share in shares:
            if share.process is not None:
                share.process.kill()
    took = time.monotonic() - began
    suspects = {path.name: path for path in sorted(place.glob("*/found/*.case"))}
    found = faults(list(suspects.values()))
    for name, wrong in found.items():
        print(f"{suspects[name]}: {wrong[0].strip().splitlines()[-1][:300]}")
    print(f"{given.count} inputs in {took:.0f} s, {len(found)} kinds of fault; kept in {place}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
