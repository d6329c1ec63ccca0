"""Long runs: schemes and points a second, with one process and with two, and what that comes to for a billion schemes.

Processes are started and have loaded what they need before the clock runs: a campaign pays for that once.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from gks.bounds.batch import samples
from gks.bounds.sweep import Point, parse_sweep
from gks.campaigns.chunks import Job, run_chunks
from gks.campaigns.executors import workers
from gks.campaigns.fuzz import fuzz_chunk
from gks.campaigns.sweeps import chunk
from gks.catalogue import find
from gks.reports.tables import Cell, Table
from gks.solvers.work_precision import machine

Arguments = list[tuple[object, ...]]

FUZZ_CHUNKS, FUZZ_SIZE = 8, 20
"""Chunks and schemes a chunk: half a minute in one process."""

CURVE_CHUNKS, CURVE_SIZE = 16, 20_000
"""Chunks of the largest size that campaigns use."""

BILLION = 10**9


def measure(progress: Callable[[str], None]) -> Table:
    """One row a kind of campaign: items a second in one process and in two, the ratio, hours of a core for 1e9."""
    rows: list[tuple[Cell, ...]] = []
    for name, job, arguments, items in (_fuzz(), _curve()):
        rates = []
        for jobs in (1, 2):
            progress(f"{name}, {jobs} process" + "es" * (jobs > 1))
            rates.append(items / _seconds(job, arguments, jobs))
        rows.append((name, items, rates[0], rates[1], rates[1] / rates[0], BILLION / rates[0] / 3600))
    columns = ("campaign", "items", "a second, 1 process", "a second, 2 processes", "ratio", "core hours for 1e9")
    return Table("Long runs", columns, tuple(rows), (str(machine()),))


def _seconds(job: Job, arguments: Arguments, jobs: int) -> float:
    with workers(jobs) as staff:
        run_chunks(job, arguments[: 2 * jobs], staff)  # the processes start with their first chunks
        start = perf_counter()
        run_chunks(job, arguments, staff)
        return perf_counter() - start


def _fuzz() -> tuple[str, Job, Arguments, int]:
    return (
        "fuzz: random interfaces",
        fuzz_chunk,
        [(1, k, FUZZ_SIZE) for k in range(FUZZ_CHUNKS)],
        FUZZ_CHUNKS * FUZZ_SIZE,
    )


def _curve() -> tuple[str, Job, Arguments, int]:
    scheme = find("traditional-1")
    total = CURVE_CHUNKS * CURVE_SIZE
    over = parse_sweep(f"alpha=1e-4:1e4:{total}:log")
    at = samples(over.values)

    def piece(k: int) -> tuple[Point, ...]:
        return over.values[k * CURVE_SIZE : (k + 1) * CURVE_SIZE]

    arguments: Arguments = [
        (scheme, over.name, [(scheme.values(), piece(k))], True, None, False, at) for k in range(CURVE_CHUNKS)
    ]
    return "curve: traditional-1 over alpha", chunk, arguments, total
