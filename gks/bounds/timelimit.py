"""A computation that ends by a time limit, with what it had found by then.

FLINT can't be interrupted, so the computation runs in a process of its own. A process that has one thread is forked,
which costs a few milliseconds; any other starts a fresh interpreter (`gks.bounds.subprocessing`).
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence

from gks.bounds.subprocessing import Clock, Job, bare, messages, received, send
from gks.errors import GksError

PATIENCE = 60.0
"""Seconds that the commands allow a verdict or a point of a curve unless told otherwise."""


class OverTime(Exception):
    """No message came within the limit."""

    def __init__(self, limit: float) -> None:
        super().__init__(f"not done within the limit of {limit:g} s")


class Died(OverTime):
    """The process of the computation was ended, by FLINT or the system: there is no more memory, nearly always."""

    def __init__(self) -> None:
        Exception.__init__(self, "the computation was ended before its time: it needs more memory than there is")


NO_MEMORY = 3
"""Exit status of a process that Python has told that there is no more memory."""


def can_fork() -> bool:
    """Whether this process can be copied: another thread might hold a lock that its copy would wait for."""
    return hasattr(os, "fork") and threading.active_count() == 1


def limited(job: Job, arguments: Sequence[object], limit: float) -> Iterator[object]:
    """What ``job(*arguments, report)`` reports, each within ``limit`` seconds of the one before.

    ``job`` is a function of a module. OverTime where one takes longer, or the job its end; what it raises is raised.
    """
    if can_fork():
        yield from _forked(job, arguments, limit)
        return
    whole = messages(_marked, (job, tuple(arguments)), limit, renewed=True)
    for message in whole:
        if message == _END:
            return
        yield message
    raise OverTime(limit)


_END = "end of the messages"


def _marked(job: Job, arguments: Sequence[object], report: object) -> str:
    """The job, with an end that can be told from a time limit."""
    job(*arguments, report)
    return _END


def _forked(job: Job, arguments: Sequence[object], limit: float) -> Iterator[object]:
    source, target = os.pipe()
    child = os.fork()
    if not child:
        os.close(source)
        _run(job, arguments, target, limit)
    os.close(target)
    clock = Clock(limit, renewed=True)
    try:
        for kind, content in received(source, clock):
            if kind == "error":
                raise content
            if kind == "end":
                return
            yield content
        if clock.over:
            raise OverTime(limit)
        ended, child = os.waitpid(child, 0)[1], 0
        if os.WIFSIGNALED(ended) or os.WEXITSTATUS(ended) == NO_MEMORY:
            raise Died
        raise RuntimeError("the process of a long computation died")
    finally:
        os.close(source)
        if child:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)


def _run(job: Job, arguments: Sequence[object], target: int, limit: float) -> None:
    """What the copy does; it never returns. A fault of the program is told on standard error."""
    status = 1
    try:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent, which then ends the child
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        with os.fdopen(target, "wb") as stream:

            def report(message: object) -> None:
                send(stream, ("message", message))
                signal.alarm(int(limit) + 2)  # should the parent be gone by then

            signal.alarm(int(limit) + 2)
            try:
                job(*arguments, report)
            except GksError as error:
                send(stream, ("error", bare(error)))
            except MemoryError:
                os._exit(NO_MEMORY)
            else:
                send(stream, ("end", None))
        status = 0
    finally:
        if status:
            sys.excepthook(*sys.exc_info())
        os._exit(status)
