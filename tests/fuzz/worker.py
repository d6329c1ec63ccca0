"""A worker: draws cases, by coverage where atheris is installed, and carries them out until it has done its share.

    python -m tests.fuzz.worker FOLDER COUNT SEED plain|guided

Before each case FOLDER/current holds it and FOLDER/done the number of cases behind it, so that the parent knows which
one ended the process. A case with a complaint is kept in FOLDER/found, with the complaint beside it.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from pathlib import Path
from random import Random

from tests.fuzz.case import MOST_BYTES, Case, parsed
from tests.fuzz.mutations import command_line, mutated

CORPUS = Path(__file__).parent / "corpus"
CATALOGUE = Path(__file__).parents[2] / "gks" / "catalogue"


def seeds(random: Random) -> list[Case]:
    """The shipped schemes, each under some command line, and the cases that were found before."""
    shipped = [Case(command_line(random), path.read_bytes()) for path in sorted(CATALOGUE.glob("*.toml"))]
    return shipped + [parsed(path.read_bytes()) for path in sorted(CORPUS.glob("*.case"))]


QUIET = ("-timeout=1000000", "-report_slow_units=1000000", "-rss_limit_mb=0", "-verbosity=0")
"""libFuzzer's own limits are off: the worker has its own, per case and in processor time."""
SLACK = 4
"""How many times the time and memory of the plain program an instrumented one may take."""


class Worker:
    """Carries out cases one by one and keeps the account of it."""

    def __init__(self, folder: Path, count: int, slack: int = 1) -> None:
        from tests.fuzz.sandbox import complaints, confine, warm_up

        self._complaints = complaints
        self._slack = slack
        self._folder = folder
        self._count = count
        self._done = 0
        self._inner = Path(tempfile.mkdtemp(dir=folder))
        (folder / "found").mkdir(exist_ok=True)
        warm_up()
        confine(slack)

    @property
    def left(self) -> int:
        """Cases that are still to be carried out."""
        return self._count - self._done

    def take(self, data: bytes) -> None:
        """One case, given as a file; none beyond the share: libFuzzer's own count has a few of its own."""
        if not self.left:
            return
        (self._folder / "current").write_bytes(data)
        (self._folder / "done").write_text(str(self._done))
        faults = self._complaints(parsed(data), self._inner, self._slack)
        self._done += 1
        if faults:
            keep(self._folder / "found", data, faults[0])
        if not self.left:
            (self._folder / "done").write_text(str(self._done))
            (self._folder / "current").unlink()


def keep(found: Path, data: bytes, fault: str) -> None:
    """Keeps a case, once for each last line of its complaint."""
    sign = hashlib.sha256(fault.strip().split("\n")[-1][:80].encode()).hexdigest()[:12]
    if not (found / f"{sign}.case").exists():
        (found / f"{sign}.case").write_bytes(data)
        (found / f"{sign}.txt").write_text(fault, errors="backslashreplace")


def plain(folder: Path, count: int, seed: int) -> None:
    """Edits of seeds, and of edits."""
    random = Random(seed)
    pool = seeds(random)
    worker = Worker(folder, count)
    while worker.left:
        try:
            case = mutated(random.choice(pool), random)
        except MemoryError:  # an edit that repeats a line of a megabyte: the program's limit holds for the worker too
            continue
        worker.take(case.data())
        if not random.randrange(20) and len(case.payload) < 20_000:
            pool[random.randrange(len(pool) // 2, len(pool))] = case


def guided(folder: Path, count: int, seed: int) -> None:
    """Edits of the cases that reached new code, by libFuzzer."""
    import atheris

    with atheris.instrument_imports(include=["gks"]):
        worker = Worker(folder, count, SLACK)

    def edited(data: bytes, most: int, number: int) -> bytes:
        random = Random(number)
        case = parsed(data)
        if not random.randrange(5):
            return Case(case.arguments, atheris.Mutate(case.payload, len(case.payload) + 100)).data()[:most]
        return mutated(case, random).data()[:most]

    begin = folder / "seeds"
    begin.mkdir(exist_ok=True)
    for k, case in enumerate(seeds(Random(seed))):
        (begin / str(k)).write_bytes(case.data())
    (folder / "corpus").mkdir(exist_ok=True)
    options = [f"-runs={count + 1000}", f"-seed={seed}", f"-max_len={MOST_BYTES}", *QUIET]
    atheris.Setup([sys.argv[0], str(folder / "corpus"), str(begin), *options], worker.take, custom_mutator=edited)
    atheris.Fuzz()


if __name__ == "__main__":
    place, number, start, how = sys.argv[1:]
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    (guided if how == "guided" else plain)(Path(place), int(number), int(start))
