"""A computation that takes too long is ended, whatever it is doing, and what it had found is kept."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from gks import catalogue
from gks.bounds import timelimit
from gks.bounds.curve import curve
from gks.bounds.sweep import parse_sweep
from gks.bounds.timelimit import OverTime, limited
from gks.bounds.verdicts import verdict_within
from gks.cli import main
from gks.errors import ParameterError
from gks.modes.verdict import Verdict

Report = Callable[[object], None]


def count(upto: int, seconds: float, report: Report) -> None:
    """Reports its process's number and then 0, 1, ..., and then sleeps."""
    report(os.getpid())
    for k in range(upto):
        report(k)
    time.sleep(seconds)


def at_fault(report: Report) -> None:
    report("so far")
    raise ParameterError("no such thing", path="alpha")


def aborted(report: Report) -> None:
    """As FLINT ends a process that gets no more memory."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    os.abort()


def out_of_memory(report: Report) -> None:
    raise MemoryError


def mistaken(report: Report) -> None:
    raise KeyError("a fault of the program")


class TestProcessesThatDie:
    """Each in a process of its own, which has one thread and is copied."""

    @pytest.mark.parametrize(
        ("job", "told"), [("aborted", "Died"), ("out_of_memory", "Died"), ("mistaken", "RuntimeError")]
    )
    def test_no_memory_is_told_from_a_fault_of_the_program(self, job: str, told: str) -> None:
        run = alone(
            f"""
            from tests.bounds.test_timelimit import {job}, limited
            try:
                list(limited({job}, (), 60))
            except Exception as error:
                print(type(error).__name__)
            """
        )
        assert run.stdout.split() == [told]
        assert ("a fault of the program" in run.stderr) is (told == "RuntimeError")

    def test_a_command_says_it_in_one_line(self) -> None:
        run = alone(
            """
            import os, sys
            from gks import cli, commands
            commands._report_text = lambda arguments, report: os.abort()
            sys.exit(cli.main(["derive", "traditional-1"]))
            """
        )
        assert run.returncode == 2
        assert "more memory than there is" in run.stderr


def alone(program: str) -> subprocess.CompletedProcess[str]:
    """A program of a few lines in an interpreter of its own."""
    command = [sys.executable, "-c", textwrap.dedent(program)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=Path(__file__).parents[2])


@pytest.fixture(params=["forked", "started afresh"])
def _way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    if request.param == "forked" and threading.active_count() > 1:
        pytest.skip("this process has threads, and is not copied")
    monkeypatch.setattr(timelimit, "can_fork", lambda: request.param == "forked")
    yield


@pytest.mark.usefixtures("_way")
class TestLimited:
    def test_everything_is_reported_in_order(self) -> None:
        number, *rest = limited(count, (3, 0.0), 60)
        assert number != os.getpid()
        assert rest == [0, 1, 2]

    def test_what_came_in_time_is_kept_and_the_process_is_gone(self) -> None:
        stream = limited(count, (2, 100.0), 6)
        child, *found = next(stream), next(stream), next(stream)
        assert isinstance(child, int)
        assert found == [0, 1]
        with pytest.raises(OverTime, match="limit of 6 s"):
            next(stream)
        with pytest.raises(ProcessLookupError):
            os.kill(child, 0)

    def test_errors_of_the_input_come_through(self) -> None:
        stream = limited(at_fault, (), 60)
        assert next(stream) == "so far"
        with pytest.raises(ParameterError, match="no such thing"):
            next(stream)


def test_a_verdict_over_the_limit_is_undecided() -> None:
    scheme = catalogue.find("lax-wendroff-order-8-oblique")
    found = verdict_within(scheme, scheme.values({}), limit=1e-3)
    assert found.verdict is Verdict.UNDECIDED
    assert "limit of 0.001 s" in found.because
    assert found.to_json()["modes"] == []


def test_a_verdict_within_the_limit_is_the_same() -> None:
    scheme = catalogue.find("traditional-1")
    assert verdict_within(scheme, scheme.values({}), limit=60) == verdict_within(scheme, scheme.values({}))


def test_points_over_the_limit_are_flagged_and_the_next_one_is_tried() -> None:
    scheme = catalogue.find("leapfrog-space-0")
    (point,) = curve(scheme, scheme.values({}), limit=1e-3).points
    assert not point.resolved
    assert "limit" in point.because
    (point,) = curve(scheme, scheme.values({}), limit=60).points
    assert point.resolved


def test_points_of_the_batch_need_no_limit() -> None:
    scheme = catalogue.find("traditional-2")
    found = curve(scheme, scheme.values({}), parse_sweep("alpha=1:10:50"), limit=1e-3)
    assert all(point.resolved for point in found.points)


WHOLE_COMMANDS = [
    ("derive", "traditional-2"),
    ("profile", "leapfrog-space-0"),
    ("roots", "traditional-1", "--sweep", "alpha=1:9:3"),
    ("audit", "traditional-1"),
    ("march", "traditional-1"),
]


@pytest.mark.parametrize("command", WHOLE_COMMANDS, ids=lambda command: str(command[0]))
def test_a_command_over_its_time_says_so_in_one_line(
    command: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*command, "--limit", "0.001"]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err == "gks: not done within the limit of 0.001 s; --limit SECONDS allows more\n"


@pytest.mark.parametrize("command", WHOLE_COMMANDS[:2], ids=lambda command: str(command[0]))
def test_a_command_within_its_time_prints_what_it_would(
    command: tuple[str, ...], capsys: pytest.CaptureFixture[str]
) -> None:
    texts = []
    for limit in ((), ("--limit", "300")):
        assert main([*command, *limit]) == 0
        texts.append(re.sub(r"[\d.e-]+ s\)", "s)", capsys.readouterr().out))
    assert texts[0] == texts[1] != ""


def test_what_is_at_fault_is_said_as_without_a_limit(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["derive", "traditional-1", "-p", "beta=1", "--limit", "300"]) == 2
    assert '"beta"' in capsys.readouterr().err
