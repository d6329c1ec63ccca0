"""Where the chunks of a campaign run: in this process, in several, on a Dask cluster, or on an executor handed in.

All four are a ``concurrent.futures.Executor``; what differs is how many chunks are under way at once, what the loss of
a worker looks like, and whether there is a fresh executor to be had after one.
"""

from __future__ import annotations

import os
import re
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import contextmanager
from typing import TYPE_CHECKING, ParamSpec, TypeVar

from gks.errors import InputError, NotAnalysable, quoted

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing.connection import Connection

P = ParamSpec("P")
T = TypeVar("T")

HANDED_IN = 32
"""Chunks under way at once on an executor whose size isn't known: enough for its workers not to wait for each other."""

PER_PROCESS = 2
"""Chunks under way for each process: one that it computes and the next one, already there."""

PER_THREAD = 4
"""The same on a cluster, where the way to the worker is longer."""

CONNECT_S = 10
"""Seconds in which a scheduler must answer."""


class Workers:
    """An executor with the number of chunks to keep under way; this plain kind is for one handed in."""

    def __init__(self, executor: Executor, window: int = HANDED_IN) -> None:
        self.executor = executor
        self.window = window

    def replace(self) -> bool:
        """Whether there is an executor to go on with after a worker was lost."""
        return False


@contextmanager
def workers(
    jobs: int | None = None, scheduler: str | None = None, executor: Executor | None = None
) -> Iterator[Workers]:
    """The workers asked for: one way of the three at most, this process where there is none.

    InputError for two ways at once, for a scheduler that doesn't answer, or where its package isn't installed.
    Processes end with the block, however it is left; a cluster and an executor handed in stay.
    """
    if sum(each is not None for each in (jobs, scheduler, executor)) > 1:
        raise InputError("jobs, a scheduler and an executor are three ways to run", mend="leave one of them")
    if executor is not None:
        yield Workers(executor)
    elif scheduler is not None:
        with _cluster(scheduler) as cluster:
            yield cluster
    elif jobs is not None and jobs > 1:
        processes = _Processes(jobs)
        try:
            yield processes
        finally:
            processes.end()
    else:
        yield Workers(InProcess(), window=1)


def is_loss(error: BaseException) -> bool:
    """Whether a chunk failed because its worker went away, and not by its own fault."""
    if isinstance(error, BrokenExecutor | CancelledError):
        return True
    distributed = sys.modules.get("distributed")  # only if it is loaded can the error be one of its own
    return distributed is not None and isinstance(error, distributed.KilledWorker)


class InProcess(Executor):
    """Runs what is submitted at once, in the caller's own thread."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """A finished future; an exception of ``fn`` is kept in it, an interrupt is not."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except BaseException as error:
            if not isinstance(error, Exception):
                raise
            future.set_exception(error)
        return future


# Processes ------------------------------------------------------------------------------------------------------------


class _Processes(Workers):
    """A pool of processes started afresh (spawned: nothing of this process is in them), and a new one when one dies.

    Each process holds the reading end of a pipe of which this one holds the other: when the pipe is closed, because the
    campaign is over or because this process was killed, they end at once.
    """

    def __init__(self, jobs: int) -> None:
        from multiprocessing import get_context

        self.jobs = jobs
        self._context = get_context("spawn")
        self._started: ProcessPoolExecutor | None = None
        super().__init__(self._pool(), PER_PROCESS * jobs)

    def _pool(self) -> ProcessPoolExecutor:
        from concurrent.futures import ProcessPoolExecutor

        reading, self._lifeline = self._context.Pipe(duplex=False)
        self._started = ProcessPoolExecutor(self.jobs, self._context, _begin, (reading,))
        self._reading = reading
        return self._started

    def replace(self) -> bool:
        self.end()
        self.executor = self._pool()
        return True

    def end(self) -> None:
        """End the processes: those that wait at once, those that compute as well."""
        if self._started is not None:
            self._lifeline.close()
            self._reading.close()
            self._started.shutdown(wait=True, cancel_futures=True)
            self._started = None


def _begin(lifeline: Connection) -> None:
    """In a worker process, before its first chunk."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then closes the pipe
    # As in gks.cli: BLAS threads cost small matrices several times what they give.
    for variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    threading.Thread(target=_end_with, args=(lifeline,), daemon=True).start()


def _end_with(lifeline: Connection) -> None:
    try:
        lifeline.recv_bytes()  # nothing is ever sent: it returns when the other end is closed
    except (EOFError, OSError):
        os._exit(1)


# A Dask cluster -------------------------------------------------------------------------------------------------------


@contextmanager
def _cluster(address: str) -> Iterator[Workers]:
    """A client of the scheduler at that address; its workers must have this version of gks."""
    try:
        from distributed import Client  # untyped
    except ModuleNotFoundError:
        raise InputError("a cluster needs the package distributed", mend="pip install 'gks-stability[dask]'") from None
    _must_answer(address)
    with Client(address, timeout=CONNECT_S, set_as_default=False) as client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise NotAnalysable(f"the scheduler at {quoted(address)} has no workers", mend="start some first")
        # pure: a chunk is a function of its arguments, but nothing is gained by the scheduler's hashing them.
        yield _Cluster(client.get_executor(pure=False), PER_THREAD * threads)


def _must_answer(address: str) -> None:
    """InputError where nothing listens there; asked first, since a client that can't connect says so at length."""
    found = _ADDRESS.fullmatch(address)
    if found is None:
        raise InputError(f"{quoted(address)} is no address of a scheduler", expected="expected tcp://HOST:PORT")
    try:
        socket.create_connection((found["host"].strip("[]"), int(found["port"])), CONNECT_S).close()
    except (OSError, OverflowError) as error:  # OverflowError: no such port
        raise InputError(f"no scheduler answers at {quoted(address)}: {error}", mend="check its address") from None


_ADDRESS = re.compile(r"(tcp|tls)://(?P<host>[^/:]+|\[[0-9a-fA-F:]+\]):(?P<port>[0-9]{1,9})/?", re.ASCII)


class _Cluster(Workers):
    """Its scheduler gives a lost worker's chunks to another; it gives one up that took several workers with it."""

    def replace(self) -> bool:
        return True
