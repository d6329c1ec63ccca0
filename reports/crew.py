"""Steps carried out by a few processes at a time, each of which can be ended at any moment.

A worker is this interpreter started afresh; it is given one step after the other, as lines of JSON. It ends when its
standard input is closed, so that none outlives the report; one that passes a step's limit is ended and replaced.
"""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Mapping
from queue import SimpleQueue
from time import monotonic
from typing import Any, Protocol

from gks.errors import GksError
from gks.reports.steps import Step, carry_out

Record = Mapping[str, Any]

TICK = 0.2
"""Seconds between two looks at the clock."""


class Watcher(Protocol):
    """Is told how far the work has come."""

    def started(self, step: Step) -> None: ...
    def finished(self, step: Step, seconds: float, found: str) -> None: ...
    def tick(self) -> None: ...


class _Worker:
    """A process, and the step that it is at."""

    def __init__(self) -> None:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p or os.getcwd() for p in sys.path)}
        for variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
            environment.setdefault(variable, "1")
        self.process = subprocess.Popen(
            [sys.executable, "-c", "from gks.reports.crew import work; work()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            start_new_session=True,  # Ctrl-C is for the parent, which then ends the workers
        )
        self.step: Step | None = None
        self.began, self.answer = 0.0, b""

    def begin(self, step: Step) -> None:
        assert self.process.stdin is not None
        self.step, self.began, self.answer = step, monotonic(), b""
        request = [step.kind, dict(step.arguments), step.source]
        self.process.stdin.write(json.dumps(request).encode() + b"\n")
        self.process.stdin.flush()

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                try:
                    stream.close()
                except BrokenPipeError:
                    continue  # the process is gone, and what was meant for it with it


def run(steps: Iterable[Step], jobs: int, watcher: Watcher, done: Callable[[Step, Record], None]) -> None:
    """Carry out all steps, in their order as workers become free; `done` is given each record as it comes.

    A record has "result", or "refused" with the reason, and "seconds". RuntimeError where a worker fails otherwise.
    """
    waiting = list(steps)
    with selectors.DefaultSelector() as selector:
        workers: list[_Worker] = []
        try:
            while waiting or workers:
                while waiting and len(workers) < jobs:
                    workers.append(_hired(selector))
                    _assign(workers[-1], waiting, watcher)
                _listen(selector, workers, waiting, watcher, done)
        finally:
            for worker in workers:
                worker.end()


def _hired(selector: selectors.BaseSelector) -> _Worker:
    worker = _Worker()
    assert worker.process.stdout is not None
    selector.register(worker.process.stdout, selectors.EVENT_READ, worker)
    return worker


def _assign(worker: _Worker, waiting: list[Step], watcher: Watcher) -> None:
    step = waiting.pop(0)
    watcher.started(step)
    worker.begin(step)


def _listen(
    selector: selectors.BaseSelector,
    workers: list[_Worker],
    waiting: list[Step],
    watcher: Watcher,
    done: Callable[[Step, Record], None],
) -> None:
    """Take what the workers have to say, for a tick at most; end those that are over their limit or have no more."""

    def dismiss(worker: _Worker) -> None:
        assert worker.process.stdout is not None
        selector.unregister(worker.process.stdout)
        workers.remove(worker)
        worker.end()

    for key, _ in selector.select(TICK):
        worker: _Worker = key.data
        assert worker.step is not None
        part = os.read(key.fd, 1 << 16)
        if not part:
            raise RuntimeError(f"the process of the step {worker.step.name} ended by itself")
        worker.answer += part
        if worker.answer.endswith(b"\n"):
            step, seconds = worker.step, monotonic() - worker.began
            record = {**json.loads(worker.answer), "seconds": seconds}
            watcher.finished(step, seconds, str(record.get("refused", "")))
            done(step, record)
            if waiting:
                _assign(worker, waiting, watcher)
            else:
                dismiss(worker)
    for worker in [w for w in workers if w.step is not None and monotonic() - w.began > w.step.limit]:
        assert worker.step is not None
        step, reason = worker.step, f"it took over {worker.step.limit:.0f} s"
        dismiss(worker)
        watcher.finished(step, step.limit, reason)
        done(step, {"refused": reason, "over_limit": True, "seconds": step.limit})
    watcher.tick()


# In the worker --------------------------------------------------------------------------------------------------------


def work() -> None:
    """What a worker runs: steps from standard input, their records to standard output."""
    target = sys.stdout
    sys.stdout = sys.stderr  # nothing that prints may come between two records
    requests: SimpleQueue[str] = SimpleQueue()
    threading.Thread(target=_read, args=(requests,), daemon=True).start()
    while True:
        kind, arguments, source = json.loads(requests.get())
        try:
            record: Record = {"result": carry_out(kind, arguments, None if source is None else tuple(source))}
        except GksError as error:
            record = {"refused": str(error)}
        target.write(json.dumps(record, allow_nan=False) + "\n")
        target.flush()


def _read(requests: SimpleQueue[str]) -> None:
    for line in sys.stdin:
        requests.put(line)
    os._exit(0)  # the parent is gone, or has no more for us
