"""A job in a process of its own, which can be ended at any moment.

The child is this interpreter, started afresh: no part of the caller's program runs in it. Messages are pickled, each
after its length. The child ends when its standard input is closed, so that it does not outlive a parent that was
killed.
"""

from __future__ import annotations

import os
import pickle
import select
import struct
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from time import monotonic
from typing import IO, Any

from gks.errors import GksError

_HEAD = struct.Struct("!Q")

_CHUNK = 1 << 16

Job = Callable[..., object]


def messages(
    job: Job, arguments: Sequence[object], limit: float | None, *, renewed: bool = False
) -> Iterator[object]:
    """What ``job(*arguments, report)`` reports, and last what it returns (None is not sent).

    ``job`` is a function of a module; a GksError that it raises is raised here. The stream just ends when ``limit``
    seconds are over, counted anew from every message where ``renewed``. RuntimeError where the child dies of something
    else. The child is gone when the generator is left, however that is.
    """
    clock = Clock(limit, renewed)
    with _started() as child:
        assert child.stdin is not None and child.stdout is not None
        try:
            send(child.stdin, (job.__module__, job.__qualname__, tuple(arguments)))
            for kind, content in received(child.stdout.fileno(), clock):
                if kind == "error":
                    raise content
                if kind == "end":
                    return
                yield content
            if not clock.over:
                raise RuntimeError(f"the process of a long computation ended with status {child.wait()}")
        finally:
            child.kill()


def bare(error: GksError) -> GksError:
    """The error without what it came through, which means nothing in another process."""
    error.__cause__ = error.__context__ = None
    return error.with_traceback(None)


def environment() -> dict[str, str]:
    """This process's environment, with its import path: what a fresh interpreter needs to import the same program."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}


def _started() -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-c", "from gks.bounds.subprocessing import child; child()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment(),
        start_new_session=True,  # Ctrl-C is for the parent, which then ends the child
    )


class Clock:
    """Seconds that run down, from every message anew where ``renewed``."""

    def __init__(self, limit: float | None, renewed: bool) -> None:
        self.limit, self.renewed = limit, renewed
        self._deadline = None if limit is None else monotonic() + limit

    def message(self) -> None:
        """Tells that one came."""
        if self.renewed and self.limit is not None:
            self._deadline = monotonic() + self.limit

    @property
    def left(self) -> float | None:
        """Seconds; None without a limit."""
        return None if self._deadline is None else self._deadline - monotonic()

    @property
    def over(self) -> bool:
        """Whether they have run down."""
        return self._deadline is not None and monotonic() >= self._deadline


def received(descriptor: int, clock: Clock) -> Iterator[tuple[str, Any]]:
    """Whole messages until the clock has run down or the stream ends."""
    waiting = b""
    while True:
        left = clock.left
        if left is not None and left <= 0:
            return
        if not select.select([descriptor], [], [], left)[0]:
            return
        part = os.read(descriptor, _CHUNK)
        if not part:
            return
        waiting += part
        while len(waiting) >= _HEAD.size and len(waiting) >= _HEAD.size + (size := _HEAD.unpack_from(waiting)[0]):
            clock.message()
            yield pickle.loads(waiting[_HEAD.size : _HEAD.size + size])
            waiting = waiting[_HEAD.size + size :]


def send(stream: IO[bytes], content: object) -> None:
    """One message, after its length."""
    data = pickle.dumps(content)
    stream.write(_HEAD.pack(len(data)) + data)
    stream.flush()


def child() -> None:
    """What the child runs: one job from standard input, its messages to standard output."""
    source, target = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # nothing that prints may come between two messages
    module, name, arguments = pickle.loads(source.read(_HEAD.unpack(source.read(_HEAD.size))[0]))
    threading.Thread(target=_end_with, args=(source,), daemon=True).start()
    job = getattr(__import__(module, fromlist=[name]), name)
    try:
        result = job(*arguments, lambda message: send(target, ("message", message)))
    except GksError as error:
        send(target, ("error", bare(error)))
        return
    if result is not None:
        send(target, ("message", result))
    send(target, ("end", None))


def _end_with(stream: IO[bytes]) -> None:
    stream.read(1)  # returns at the end of the stream, when the parent is gone
    os._exit(1)
