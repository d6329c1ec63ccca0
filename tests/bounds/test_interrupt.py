"""Ctrl-C ends a long proof at once: exit status 130, no file, no process left behind."""

from __future__ import annotations

import signal
from pathlib import Path
from time import sleep

import pytest

from gks.reports.bench_theorems import interface
from tests.campaigns.command import interruptible

pytestmark = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes are told by /proc")


def children(parent: int) -> list[int]:
    found = []
    for folder in Path("/proc").iterdir():
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except (OSError, NotADirectoryError):
            continue
        if folder.name.isdigit() and int(fields[1]) == parent and fields[0] != "Z":
            found.append(int(folder.name))
    return found


def test_a_proof_that_is_interrupted_leaves_nothing(tmp_path: Path) -> None:
    scheme, out = tmp_path / "fromm.toml", tmp_path / "out.json"
    scheme.write_text(interface("Fromm", 2))
    with interruptible("prove", str(scheme), "-o", str(out)) as proof:
        while not (mine := children(proof.pid)):
            assert proof.poll() is None
            sleep(0.05)
        sleep(1)  # the child is deep in FLINT, which knows no interruption
        proof.send_signal(signal.SIGINT)
        _, errors = proof.communicate(timeout=60)
    assert proof.returncode == 130
    assert errors.decode().strip() == "gks: interrupted"
    assert not out.exists()
    assert list(tmp_path.iterdir()) == [scheme]
    assert not any(Path(f"/proc/{child}/stat").exists() for child in mine)
