"""How far a long piece of work has come, on standard error: what is running, what is done, the time so far."""

from __future__ import annotations

import sys
from time import monotonic

from gks.reports.steps import Step


class Progress:
    """Told by the crew; a line for each step that ends, and on a terminal one that lives with what is running."""

    def __init__(self, title: str) -> None:
        self.title, self.began = title, monotonic()
        self.running: dict[str, float] = {}
        self.done = 0
        self.live = sys.stderr.isatty()

    def started(self, step: Step) -> None:
        """A worker has begun with the step."""
        self.running[step.name] = monotonic()
        self.tick()

    def finished(self, step: Step, seconds: float, found: str) -> None:
        """The step has a record; `found` says what is special about it."""
        self.running.pop(step.name, None)
        self.done += 1
        self._clear()
        note = f"  ({found})" if found else ""
        so_far = monotonic() - self.began
        print(f"{self.title}: {step.name:<12} {seconds:6.1f} s, {so_far:6.1f} s so far{note}", file=sys.stderr)
        self.tick()

    def tick(self) -> None:
        """Renew the line that lives."""
        if not self.live or not self.running:
            return
        now = monotonic()
        running = ", ".join(f"{name} {now - began:.0f} s" for name, began in self.running.items())
        print(f"\r\x1b[K{self.title}: {self.done} done; running: {running}"[:200], end="", file=sys.stderr, flush=True)

    def _clear(self) -> None:
        if self.live:
            print("\r\x1b[K", end="", file=sys.stderr)
