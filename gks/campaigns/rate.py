"""Progress and rate of a long run, on standard error: often where someone is looking, now and then in a log."""

from __future__ import annotations

import sys
from time import monotonic

AT_TERMINAL_S, IN_LOG_S = 2.0, 60.0
"""Seconds between two lines."""


class Rate:
    """Called with the number done and the number there are; the last call always prints a line.

    The first call says what an earlier run has left, which does not count for the rate.
    """

    def __init__(self, what: str) -> None:
        self.what = what
        self.before: int | None = None
        self.start = self.last = monotonic()

    def __call__(self, done: int, total: int) -> None:
        now = monotonic()
        if self.before is None:
            self.before = done
            self.start = self.last = now
            if done:
                print(f"{done} of {total} {self.what} are there already", file=sys.stderr, flush=True)
            return
        if done < total and now - self.last < (AT_TERMINAL_S if sys.stderr.isatty() else IN_LOG_S):
            return
        self.last = now
        passed = max(now - self.start, 1e-9)  # the clock's own step, should it not have moved
        rate = (done - self.before) / passed
        left = f", {(total - done) / rate:.0f} s left" if done < total and rate else ""
        print(f"{done} of {total} {self.what}, {rate:.3g} a second{left}", file=sys.stderr, flush=True)
