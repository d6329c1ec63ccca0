"""Steps in processes of their own: limits hold, refusals are told, an interrupt leaves nobody behind."""

import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

from gks.reports.crew import run
from gks.reports.steps import Step
from tests.campaigns.command import interruptible
from tests.reports.example import TEXT, Silent

SOURCE = (TEXT, "example", None)
VALUES = {"lam": "9/10", "alpha": "4"}


def modes(name: str, values: dict[str, str]) -> Step:
    return Step(name, "steps.modes", {"values": values}, SOURCE)


def records(steps: list[Step], jobs: int) -> dict[str, Any]:
    found: dict[str, Any] = {}
    run(steps, jobs, Silent(), lambda step, record: found.update({step.name: record}))
    return found


def test_results_do_not_depend_on_the_number_of_workers() -> None:
    steps = [modes(f"at {alpha}", {"lam": "9/10", "alpha": str(alpha)}) for alpha in (1, 3, 5)]
    one, two = (records(steps, jobs) for jobs in (1, 2))
    assert {name: record["result"] for name, record in one.items()} == {n: r["result"] for n, r in two.items()}
    assert one["at 5"]["result"]["verdict"] == "unstable"


def test_a_refusal_is_told_and_the_others_go_on() -> None:
    found = records([modes("wrong", {**VALUES, "nosuch": "1"}), modes("right", VALUES)], 1)
    assert "nosuch" in found["wrong"]["refused"]
    assert found["right"]["result"]["verdict"] == "unstable"


def test_a_step_over_its_limit_is_ended_and_the_others_go_on() -> None:
    slow = Step("slow", "steps.curve", {"values": VALUES, "sweep": "alpha=1:2:2000000"}, SOURCE, limit=1.0)
    found = records([slow, modes("next", VALUES)], 1)
    assert found["slow"] == {"refused": "it took over 1 s", "over_limit": True, "seconds": 1.0}
    assert "result" in found["next"]


def test_a_fault_of_the_program_is_no_refusal(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(RuntimeError, match="broken"):
        records([Step("broken", "steps.nosuch", {})], 1)
    assert "nosuch" in capfd.readouterr().err


def test_an_interrupt_ends_the_workers() -> None:
    pids: list[int] = []

    class Impatient(Silent):
        def tick(self) -> None:
            children = subprocess.run(["ps", "-o", "pid=", "--ppid", str(os.getpid())], capture_output=True, text=True)
            pids.extend(int(pid) for pid in children.stdout.split())
            raise KeyboardInterrupt

    slow = Step("slow", "steps.curve", {"values": VALUES, "sweep": "alpha=1:2:2000000"}, SOURCE)
    with pytest.raises(KeyboardInterrupt):
        run([slow], 1, Impatient(), lambda step, record: None)
    assert pids
    time.sleep(0.2)
    alive = [pid for pid in pids if Path(f"/proc/{pid}/cmdline").exists() and b"crew" in cmdline(pid)]
    assert alive == []


def cmdline(pid: int) -> bytes:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return b""


def test_ctrl_c_ends_the_command_with_130_and_leaves_no_half_written_page(tmp_path: Path) -> None:
    scheme, out = tmp_path / "slow.toml", tmp_path / "out"
    scheme.write_text(TEXT, encoding="utf-8")
    with interruptible("report", str(scheme), "-o", str(out)) as process:
        assert process.stderr is not None
        assert any(b"slow: " in line for line in process.stderr)  # one step is done, others run
        process.send_signal(signal.SIGINT)
        output, complaint = process.communicate(timeout=60)
    assert process.returncode == 130
    assert output == b""
    assert b"gks: interrupted" in complaint
    assert b"Traceback" not in complaint
    assert [path.name for path in out.iterdir() if path.suffix in (".html", ".json", ".csv")] == []
    assert not [path for path in out.rglob("*") if path.name.startswith(".gks-") and path.is_file()]
