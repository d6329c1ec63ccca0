"""Chunks on a Dask cluster: a scheduler and two workers, each a process of its own, one of which is killed mid-run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

import gks
from gks.campaigns.checkpoint import folder
from gks.campaigns.chunks import run_chunks
from gks.campaigns.executors import workers
from tests.campaigns.command import ROOT, run
from tests.campaigns.jobs import slow_square, where

pytest.importorskip("distributed")


@dataclass
class Cluster:
    address: str
    processes: list[subprocess.Popen[bytes]]

    def kill_a_worker(self) -> None:
        """As an out-of-memory killer does it; a nanny that would start another is not there."""
        self.processes[-1].kill()


def launch(*arguments: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    file = tmp_path / "scheduler.json"
    here = ("--scheduler-file", str(file))
    processes = [launch("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", *here)]
    try:
        processes += [launch("worker", *here, "--nthreads", "1", "--no-nanny", "--no-dashboard") for _ in range(2)]
        until = time.monotonic() + 120
        while not file.exists() and time.monotonic() < until:
            time.sleep(0.05)
        address = json.loads(file.read_text())["address"]
        _wait_for_workers(address)
        yield Cluster(address, processes)
    finally:
        for process in processes:
            process.kill()
            process.wait()


def _wait_for_workers(address: str) -> None:
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(2, timeout=120)


def test_a_worker_killed_mid_run_costs_time_only(cluster: Cluster, tmp_path: Path) -> None:
    told: list[int] = []

    def progress(done: int, total: int) -> None:
        told.append(done)
        if done == 5:
            cluster.kill_a_worker()

    arguments = [(k, 0.05) for k in range(30)]
    with workers(scheduler=cluster.address) as staff, folder(str(tmp_path / "chunks"), {"k": 1}) as place:
        assert len(set(run_chunks(where, [(k,) for k in range(8)], staff))) == 2
        assert run_chunks(slow_square, arguments, staff, place, progress) == [[k, k * k] for k in range(30)]
        assert len(set(run_chunks(where, [(k,) for k in range(8)], staff))) == 1
        assert place.results(30) == {k: [k, k * k] for k in range(30)}
    assert told == list(range(31))


def test_the_command_gives_the_bytes_that_one_process_gives(cluster: Cluster, tmp_path: Path) -> None:
    sweep = ("curve", "traditional-1", "--sweep", "alpha=1e-3:1e3:30:log", "-o", str(tmp_path / "there.json"))
    status, _, error = run(*sweep, "--scheduler", cluster.address)
    assert (status, error) == (0, "")
    here = gks.load("traditional-1").curve(sweep="alpha=1e-3:1e3:30:log", jobs=1)
    assert (tmp_path / "there.json").read_text() == here.json_text() + "\n"
