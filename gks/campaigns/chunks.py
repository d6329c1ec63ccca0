"""Chunks: independent pieces of a campaign, computed by workers in any order and put together in their own.

What a chunk computes depends on its arguments alone, and how a campaign is cut into chunks never on the workers. So the
results are the same whatever ran them, however often, and wherever a run that came before was ended.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from typing import Any

import gks
from gks.campaigns.checkpoint import Folder
from gks.campaigns.executors import Workers, is_loss
from gks.errors import GksError

Job = Callable[..., object]
"""A function of a module, of arguments that pickle, whose result JSON gives back unchanged: lists, no tuples."""

Progress = Callable[[int, int], None]
"""Told how many chunks are finished, of how many."""

LOSSES = 3
"""Times in a row that workers may die with no chunk finished in between: a chunk that kills what computes it would go
round for ever."""


class WorkersLost(GksError):
    """Workers died and took chunks with them, more often than chance explains or with no others to go on with."""


def run_chunks(
    job: Job,
    arguments: Sequence[tuple[object, ...]],
    workers: Workers,
    folder: Folder | None = None,
    progress: Progress | None = None,
) -> list[Any]:
    """``job(*arguments[k])`` for every k, in order.

    With a folder, chunks that it holds are not computed again and the others are kept in it as they finish. Chunks of
    lost workers are computed again. An exception of a job, and a failure to keep a result, end the campaign:
    what was kept stays.
    """
    results: dict[int, Any] = {} if folder is None else folder.results(len(arguments))
    run = _Run(job, arguments, workers, deque(k for k in range(len(arguments)) if k not in results))
    if progress is not None:
        progress(len(results), len(arguments))
    while run.unfinished:
        run.submit()
        for k, result in run.finished():
            if folder is not None:
                folder.keep(k, result)
            results[k] = result
            if progress is not None:
                progress(len(results), len(arguments))
    return [results[k] for k in range(len(arguments))]


class _Run:
    """The chunks that wait and those under way."""

    def __init__(
        self, job: Job, arguments: Sequence[tuple[object, ...]], workers: Workers, waiting: deque[int]
    ) -> None:
        self.job, self.arguments, self.workers, self.waiting = job, arguments, workers, waiting
        self.flying: dict[Future[object], int] = {}
        self.losses = 0

    @property
    def unfinished(self) -> bool:
        return bool(self.waiting or self.flying)

    def submit(self) -> None:
        """Fill the workers' window."""
        while self.waiting and len(self.flying) < self.workers.window:
            k = self.waiting.popleft()
            try:
                future = self.workers.executor.submit(_checked, gks.__version__, self.job, *self.arguments[k])
            except BrokenExecutor as error:
                self.waiting.appendleft(k)
                self._lose(error)
            else:
                self.flying[future] = k

    def finished(self) -> list[tuple[int, object]]:
        """Waits for chunks and returns them with their numbers; lost ones wait again."""
        done, _ = wait(self.flying, return_when=FIRST_COMPLETED)
        found: list[tuple[int, object]] = []
        loss: BaseException | None = None
        for future in sorted(done, key=self.flying.__getitem__):
            error = future.exception() if not future.cancelled() else None
            if error is not None and not is_loss(error):
                raise error
            k = self.flying.pop(future)
            if future.cancelled() or error is not None:
                self.waiting.appendleft(k)
                loss = error
            else:
                found.append((k, future.result()))
        if found:
            self.losses = 0
        if len(found) < len(done):
            self._lose(loss)
        return found

    def _lose(self, cause: BaseException | None) -> None:
        """Go on with fresh workers; WorkersLost where there are none, or they died too often."""
        self.losses += 1
        if self.losses > LOSSES or not self.workers.replace():
            k = min([*self.waiting, *self.flying.values()]) + 1
            times = f"{self.losses} times in a row" if self.losses > 1 else "and there are no others"
            raise WorkersLost(
                f"workers died {times}, the last at chunk {k} of {len(self.arguments)} or another under way; "
                "finished chunks are kept where --resume names a folder"
            ) from cause
        # A pool that lost one process gives up all that it was given; what it had finished comes with the next wait.
        for future, k in list(self.flying.items()):
            if future.done() and (future.cancelled() or future.exception() is not None):
                del self.flying[future]
                self.waiting.appendleft(k)


def _checked(version: str, job: Job, *arguments: object) -> object:
    """In a worker: the job, by the same version of the program as asked for it."""
    if version != gks.__version__:
        raise GksError(f"a worker has gks {gks.__version__}, not {version}: install the same version everywhere")
    return job(*arguments)
