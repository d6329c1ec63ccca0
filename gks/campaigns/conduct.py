"""How a campaign is carried out: by which workers, from which folder, and who is told how far it has come."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

from gks.campaigns.checkpoint import Key, folder
from gks.campaigns.chunks import Job, run_chunks
from gks.campaigns.executors import workers

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Conduct:
    """What has no influence on the result, each None where it isn't asked for.

    jobs, scheduler, executor  the workers, as `workers` takes them: one way of the three at most
    resume                     the folder in which finished chunks are kept and looked for
    progress                   told how much is done, of how much
    """

    jobs: int | None = None
    scheduler: str | None = None
    executor: Executor | None = None
    resume: str | None = None
    progress: Progress | None = None

    def results(self, job: Job, arguments: Sequence[tuple[object, ...]], key: Key, told: Progress | None) -> list[Any]:
        """The results of all chunks, in order (`run_chunks`); ``told`` counts chunks, ``key`` says whose they are."""
        with (
            workers(self.jobs, self.scheduler, self.executor) as staff,
            nullcontext() if self.resume is None else folder(self.resume, key) as place,
        ):
            return run_chunks(job, arguments, staff, place, told)
