"""One case carried out in this process and held to what must be true of any input.

Exit status 0 with the result, or 2 with one message that says where; nothing run, nothing read or written but the
scheme file, the program's own files and the output asked for. Time and memory are held by the operating system: a
processor timer that nothing in the program answers to, and a limit on private memory.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import os
import pkgutil
import re
import resource
import signal
import sys
import traceback
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import gks
from gks.cli import main
from gks.errors import SchemeError
from gks.scheme.schemefile import read_scheme
from tests.fuzz.case import FILE, Case

MEMORY = 500_000_000
"""Bytes of private memory."""
READING_SECONDS = 2.0
"""Processor time that reading a file may take."""
COMMAND_SECONDS = 5.0
"""Processor time of a whole command with `--limit 1`: what is not under the limit (start-up, writing) included."""

NAME = "scheme.toml"
MESSAGE = re.compile(rf"({re.escape(NAME)}(:\d+:\d+)?|gks( [a-z]+)?): .")
LONGEST = 3000
"""Characters of a message."""
ROOT = Path(__file__).parents[2]


def confine(slack: int = 1) -> None:
    """Limits this process's memory, for good: to so many times what the plain program may take."""
    resource.setrlimit(resource.RLIMIT_DATA, (slack * MEMORY, slack * MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


@contextlib.contextmanager
def processor_time(seconds: float) -> Iterator[None]:
    """Ends this process, by a signal that it does not handle, when the block takes longer."""
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def complaints(case: Case, folder: Path, slack: int = 1) -> list[str]:
    """What is wrong with how the program takes the case; ``folder`` is empty before and afterwards.

    ``slack`` is how many times the plain program's time may pass.
    """
    file = folder / NAME
    file.write_bytes(case.payload)
    back = os.getcwd()
    os.chdir(folder)
    try:
        with WATCH.over(folder):
            found = _reading(slack) + _command([NAME if text == FILE else text for text in case.arguments], slack)
        found += WATCH.seen
        if file.read_bytes() != case.payload:
            found.append("the scheme file was changed")
        asked = {case.arguments[k + 1] for k, text in enumerate(case.arguments) if text == "-o"}
        left = {path.name for path in folder.iterdir()} - {NAME}
        found += [f"{name!r} was written" for name in sorted(left - asked)]
    finally:
        os.chdir(back)
        for path in folder.iterdir():
            path.unlink()
    return found


class Caught:
    """Lets a block end with whatever it raises, and keeps that."""

    fault: BaseException | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> bool:
        self.fault = fault
        return True

    def told(self, what: str) -> list[str]:
        """The traceback as a complaint, if there is one."""
        return [] if self.fault is None else [f"{what}: {''.join(traceback.format_exception(self.fault))}"]


def _reading(slack: int) -> list[str]:
    """Reads the file alone, under the reader's own limit of time."""
    with processor_time(slack * READING_SECONDS), Caught() as caught:
        read_scheme(NAME)
    if isinstance(caught.fault, SchemeError):
        return [] if str(caught.fault).startswith(NAME) else [f"a message without its place: {caught.fault}"]
    return caught.told("reading")


def _command(arguments: Sequence[str], slack: int) -> list[str]:
    out, err = io.StringIO(), io.StringIO()
    status: object = None
    quiet = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
    with quiet[0], quiet[1], Caught() as caught, processor_time(slack * COMMAND_SECONDS):
        status = main(arguments)
    if isinstance(caught.fault, SystemExit):
        status = caught.fault.code
    elif caught.fault is not None:
        return caught.told(" ".join(arguments))
    return answer_faults(status, out.getvalue(), err.getvalue(), as_json="--json" in arguments)


def answer_faults(status: object, out: str, err: str, *, as_json: bool) -> list[str]:
    """What is wrong with an answer: its status, the result on standard output, the message on standard error."""
    if status == 0:
        found = [] if not err else [f"status 0 and a message: {err[:LONGEST]}"]
        return found + (json_faults(out) if as_json else [] if out.strip() else ["status 0 and nothing printed"])
    if status != 2:
        return [f"status {status}: {err[-LONGEST:]}"]
    found = [] if not out else [f"status 2 and a result: {out[:200]}"]
    line = err.removesuffix("\n")
    if not (line.isprintable() and MESSAGE.match(line) and len(line) <= LONGEST):
        found.append(f"not one message with its place: {err[:LONGEST]!r}")
    return found


def json_faults(text: str) -> list[str]:
    """Nothing where the text is one JSON object with no NaN and no Infinity."""

    def refuse(name: str) -> float:
        raise ValueError(f"{name} in JSON")

    try:
        found = json.loads(text, parse_constant=refuse)
    except ValueError as error:
        return [f"no JSON: {error}"]
    return [] if isinstance(found, dict) and "schema" in found else ["JSON, but no object with a schema"]


class Watch:
    """Sees what the process does outside of itself while a case runs, by Python's audit events."""

    RUN = frozenset(
        (
            "os.system",
            "os.exec",
            "os.posix_spawn",
            "os.spawn",
            "os.startfile",
            "pty.spawn",
            "socket.connect",
            "socket.bind",
        )
    )
    CHANGE = frozenset(
        f"os.{name}" for name in ("remove", "rename", "rmdir", "mkdir", "link", "symlink", "truncate", "chmod", "chown")
    )
    READABLE = tuple(
        {sys.prefix, sys.base_prefix, os.path.realpath(sys.prefix), str(ROOT), os.devnull, "/proc/", "/sys/"}
    )

    def __init__(self) -> None:
        self.seen: list[str] = []
        self._folder: str | None = None
        self._added = False

    @contextlib.contextmanager
    def over(self, folder: Path) -> Iterator[None]:
        """Watches during the block; files in the folder are the program's to read and write."""
        if not self._added:
            sys.addaudithook(self._hook)  # for good: a hook can't be taken away
            self._added = True
        self.seen = []
        self._folder = os.path.realpath(folder)
        try:
            yield
        finally:
            self._folder = None

    def _hook(self, event: str, arguments: tuple[object, ...]) -> None:
        if self._folder is None:
            return
        if event in self.RUN or (event == "subprocess.Popen" and not _own_child(arguments)):
            self.seen.append(f"{event} {arguments!r}"[:LONGEST])
        elif event == "open":
            self._opened(*arguments)
        elif event == "compile" and not _from_a_file(arguments):
            self.seen.append(f"text was compiled: {arguments!r}"[:LONGEST])
        elif event in self.CHANGE and not self._inside(arguments[0]):
            self.seen.append(f"{event} {arguments!r}"[:LONGEST])

    def _opened(self, path: object, mode: object = None, flags: object = 0) -> None:
        if self._inside(path) or not isinstance(path, str | bytes | os.PathLike):
            return
        writes = isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC)
        name = os.path.realpath(os.fsdecode(path))
        cached = name.endswith((".pyc",)) or "__pycache__" in name
        if (writes and name != os.devnull and not cached) or not name.startswith(self.READABLE):
            self.seen.append(f"opened {name!r} ({mode}, {flags})")

    def _inside(self, path: object) -> bool:
        if not isinstance(path, str | bytes | os.PathLike):
            return isinstance(path, int)  # a descriptor: what it names was seen when it was opened
        try:
            return os.path.realpath(os.fsdecode(path)).startswith(f"{self._folder}/")
        except ValueError:  # a NUL: nothing is opened
            return True


def _own_child(arguments: tuple[object, ...]) -> bool:
    """Whether a process to be started is the one in which long computations run."""
    return arguments[0] == sys.executable and "gks.bounds.subprocessing" in str(arguments[1])


def _from_a_file(arguments: tuple[object, ...]) -> bool:
    """Whether what is compiled is a file of Python, or a line that an extension module compiles for its own errors."""
    name = str(arguments[1])
    return os.path.isfile(name) or name.startswith("<frozen") or name.endswith(".pyx")


def warm_up() -> None:
    """Imports whatever a case may lead to: modules that write classes as text while they load do so now."""
    for module in pkgutil.walk_packages(gks.__path__, "gks."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    for module_name in (
        "scipy.sparse.linalg",
        "scipy.linalg",
        "scipy.optimize",
        "sympy",
        "mpmath",
        "json",
        "traceback",
        "multiprocessing.pool",
    ):
        importlib.import_module(module_name)
    for command in ("derive", "modes", "prove", "march"):
        with contextlib.redirect_stdout(io.StringIO()):
            main([command, "traditional-1"])
    with contextlib.redirect_stdout(io.StringIO()):
        main(["audit", "leapfrog-space-0"])  # of few claims: auditing an interface takes seconds


WATCH = Watch()
"""One a process, as audit hooks are."""
