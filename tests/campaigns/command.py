"""The gks command in a process of its own, as campaigns are run and killed."""

from __future__ import annotations

import os
import subprocess
import sys
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
