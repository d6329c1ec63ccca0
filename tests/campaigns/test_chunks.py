"""Chunks give the same results in the same order whatever computes them, and lost workers cost time only."""

from __future__ import annotations

from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

import pytest

import gks
from gks.campaigns.checkpoint import folder
from gks.campaigns.chunks import WorkersLost, run_chunks
from gks.campaigns.executors import InProcess, Workers, workers
from gks.errors import GksError, InputError
from tests.campaigns.jobs import dies, dies_once, refuses, slow_square, square, where

TWENTY = [(k,) for k in range(20)]

SQUARES = [[k, k * k] for k in range(20)]


@pytest.mark.parametrize("jobs", [None, 1, 2, 3])
def test_results_are_in_order(jobs: int | None) -> None:
    with workers(jobs) as staff:
        assert run_chunks(square, TWENTY, staff) == SQUARES


def test_chunks_that_finish_out_of_order_are_put_in_order() -> None:
    late_first = [(k, 0.002 * (20 - k)) for k in range(20)]
    with ThreadPoolExecutor(4) as pool:
        assert run_chunks(slow_square, late_first, Workers(pool)) == SQUARES


def test_processes_share_the_work() -> None:
    with workers(2) as staff:
        assert len(set(run_chunks(where, TWENTY, staff))) == 2


def test_no_chunks_no_results() -> None:
    with workers() as staff:
        assert run_chunks(square, [], staff) == []


def test_progress_counts_every_chunk_and_those_that_were_there(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    with folder(str(tmp_path / "c"), {"k": 1}) as place, workers() as staff:
        place.keep(3, [3, 9])
        assert run_chunks(square, TWENTY[:5], staff, place, lambda *done: told.append(done)) == SQUARES[:5]
    assert told == [(k, 5) for k in range(1, 6)]


def test_a_kept_chunk_is_not_computed_again(tmp_path: Path) -> None:
    with folder(str(tmp_path / "c"), {"k": 1}) as place, workers() as staff:
        run_chunks(square, TWENTY, staff, place)
        assert run_chunks(refuses, TWENTY, staff, place) == SQUARES


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_fault_ends_the_run_as_it_was_and_what_was_finished_is_kept(jobs: int, tmp_path: Path) -> None:
    with folder(str(tmp_path / "c"), {"k": 1}) as place:
        with pytest.raises(InputError, match=r"^here: no such thing$"), workers(jobs) as staff:
            run_chunks(refuses, TWENTY, staff, place)
        found = place.results(20)
        assert all(found[k] == SQUARES[k] for k in found)
        assert 2 not in found


# Workers that die -----------------------------------------------------------------------------------------------------


def test_chunks_of_processes_that_die_are_computed_again(tmp_path: Path) -> None:
    with workers(2) as staff:
        assert run_chunks(dies_once, [(k, str(tmp_path)) for k in range(9)], staff) == SQUARES[:9]
    assert len(list(tmp_path.iterdir())) == 3


def test_a_chunk_that_kills_whatever_computes_it_ends_the_run_with_what_to_do() -> None:
    with pytest.raises(WorkersLost, match=r"times in a row, .* of 4 .*--resume"), workers(2) as staff:
        run_chunks(dies, TWENTY[:4], staff)


def test_an_executor_handed_in_is_not_replaced() -> None:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(1, get_context("spawn")) as pool, pytest.raises(WorkersLost, match="no others"):
        run_chunks(dies, TWENTY[:2], Workers(pool))


def test_another_version_on_a_worker_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Elsewhere(InProcess):
        def submit(self, fn, /, version, *args, **kwargs):  # type: ignore[no-untyped-def, override]
            return super().submit(fn, version + ".dev", *args, **kwargs)

    with pytest.raises(GksError, match=f"has gks {gks.__version__}, not"):
        run_chunks(square, TWENTY, Workers(Elsewhere()))


def test_ways_to_run_exclude_each_other() -> None:
    pool: Executor = InProcess()
    with pytest.raises(InputError, match="three ways"), workers(2, executor=pool):
        pass


def test_an_interrupt_is_not_taken_for_a_result() -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        InProcess().submit(interrupted)
