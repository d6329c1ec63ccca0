"""The gks command in a process of its own, as campaigns are run and killed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]


def start(*arguments: str, before: str = "pass") -> subprocess.Popen[bytes]:
    """`gks ARGUMENTS`, started; ``before`` is Python that its process runs first."""
    code = f"import sys; sys.argv = ['gks', *{list(arguments)!r}]; {before}; import gks.cli; gks.cli.entry()"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        [sys.executable, "-c", code], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def run(*arguments: str, before: str = "pass") -> tuple[int, str, str]:
    """Exit status, standard output and standard error of `gks ARGUMENTS`."""
    process = start(*arguments, before=before)
    out, error = process.communicate(timeout=120)
    return process.returncode, out.decode(), error.decode()


@contextmanager
def interruptible(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    """`gks ARGUMENTS`, started, as at a terminal: a shell that runs the tests in the background has them, and what they
    start, ignore Ctrl-C. Gone when the block is left, so that a failure is not waited for.
    """
    heeds = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    with start(*arguments, before=heeds) as process:
        try:
            yield process
        finally:
            process.kill()
