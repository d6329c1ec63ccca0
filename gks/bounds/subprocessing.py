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


def messages(job: Job, arguments: Sequence[object], limit: float | None) -> Iterator[object]:
    """What ``job(*arguments, report)`` reports, and last what it returns (None is not sent).

    ``job`` is a function of a module; a GksError that it raises is raised here. The stream just ends when ``limit``
    seconds are over. RuntimeError where the child dies of something else. The child is gone when the generator is
    left, however that is.
    """
    deadline = None if limit is None else monotonic() + limit
    with _started() as child:
        assert child.stdin is not None and child.stdout is not None
        try:
            _send(child.stdin, (job.__module__, job.__qualname__, tuple(arguments)))
            for kind, content in _received(child.stdout, deadline):
                if kind == "error":
                    raise content
                if kind == "end":
                    return
                yield content
            if deadline is None or monotonic() < deadline:
                raise RuntimeError(f"the process of a long computation ended with status {child.wait()}")
        finally:
            child.kill()


def _started() -> subprocess.Popen[bytes]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}
    return subprocess.Popen(
        [sys.executable, "-c", "from gks.bounds.subprocessing import child; child()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment,
        start_new_session=True,  # Ctrl-C is for the parent, which then ends the child
    )


def _received(stream: IO[bytes], deadline: float | None) -> Iterator[tuple[str, Any]]:
    """Whole messages until the deadline or the end of the stream."""
    descriptor = stream.fileno()
    waiting = b""
    while True:
        left = None if deadline is None else deadline - monotonic()
        if left is not None and left <= 0:
            return
        if not select.select([descriptor], [], [], left)[0]:
            return
        part = os.read(descriptor, _CHUNK)
        if not part:
            return
        waiting += part
        while len(waiting) >= _HEAD.size and len(waiting) >= _HEAD.size + (size := _HEAD.unpack_from(waiting)[0]):
            yield pickle.loads(waiting[_HEAD.size : _HEAD.size + size])
            waiting = waiting[_HEAD.size + size :]


def _send(stream: IO[bytes], content: object) -> None:
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
        result = job(*arguments, lambda message: _send(target, ("message", message)))
    except GksError as error:
        _send(target, ("error", error))
        return
    if result is not None:
        _send(target, ("message", result))
    _send(target, ("end", None))


def _end_with(stream: IO[bytes]) -> None:
    stream.read(1)  # returns at the end of the stream, when the parent is gone
    os._exit(1)
