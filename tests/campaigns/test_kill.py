"""A run that is killed or finds the disk full loses no finished chunk, leaves no torn file and ends as undisturbed."""

from __future__ import annotations

import json
import random
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.campaigns.command import run, start

SWEEP = ("curve", "traditional-2", "--sweep", "alpha=1e-3:1e3:640:log")


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The result of a run that nothing happens to."""
    out = tmp_path_factory.mktemp("undisturbed") / "out.json"
    assert run(*SWEEP, "--jobs", "1", "-o", str(out))[0] == 0
    return out.read_bytes()


def kept(place: Path) -> dict[str, bytes]:
    """The chunks in a folder; each must be whole."""
    found = {file.name: file.read_bytes() for file in place.glob("[0-9]*.json")}
    for content in found.values():
        head, line = content.decode().removesuffix("\n").split("\n")
        assert len(json.loads(head)["sha256"]) == 64
        json.loads(line)
    return found


@pytest.mark.parametrize(("jobs", "number"), [("1", 14), ("2", 6)])
def test_a_run_killed_again_and_again_ends_as_if_undisturbed(
    jobs: str, number: int, undisturbed: bytes, tmp_path: Path
) -> None:
    source, out, place = random.Random(number), tmp_path / "out.json", tmp_path / "chunks"
    command = (*SWEEP, "--jobs", jobs, "--resume", str(place), "-o", str(out))
    before: dict[str, bytes] = {}
    killed = 0
    for _ in range(number):
        process = start(*command)
        try:
            process.wait(source.uniform(0.2, 1.6))
        except subprocess.TimeoutExpired:
            process.kill()
            killed += 1
        process.communicate()
        now = kept(place)
        assert before.items() <= now.items()
        if out.exists():  # it came to its end before the kill: the next ones get a campaign from its beginning
            assert out.read_bytes() == undisturbed
            out.unlink()
            shutil.rmtree(place)
            now = {}
        before = now
    assert killed > 0
    status, _, error = run(*command)
    assert (status, error) == (0, "")
    assert out.read_bytes() == undisturbed
    assert sorted(file.name for file in tmp_path.iterdir()) == ["chunks", "out.json"]


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="processes are looked up in /proc")
def test_worker_processes_do_not_outlive_one_that_is_killed(tmp_path: Path) -> None:
    process = start(*SWEEP, "--jobs", "2", "--resume", str(tmp_path / "chunks"))
    while process.poll() is None and not kept(tmp_path / "chunks"):
        time.sleep(0.02)
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    process.kill()
    process.communicate()
    assert children
    until = time.monotonic() + 30
    while time.monotonic() < until and any(_runs(child) for child in children):
        time.sleep(0.02)
    assert not any(_runs(child) for child in children)


def _runs(pid: str) -> bool:
    """Whether the process is there and not just waiting for someone to take note of its end."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


# Full disks -----------------------------------------------------------------------------------------------------------


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 kB, where this user may mount one."""
    place = tmp_path / "small"
    place.mkdir()
    try:
        mounted = subprocess.run(
            ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(place)], capture_output=True, check=False
        )
    except FileNotFoundError:
        pytest.skip("there is no command to mount a small file system")
    if mounted.returncode:
        pytest.skip(f"no small file system can be mounted here: {mounted.stderr.decode().strip()}")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


@pytest.mark.parametrize("jobs", ["2"])
def test_a_full_disk_is_said_and_made_room_on_the_run_resumes(
    jobs: str, undisturbed: bytes, small_disk: Path, tmp_path: Path
) -> None:
    place, out = small_disk / "chunks", tmp_path / "out.json"
    status, printed, error = run(*SWEEP, "--jobs", jobs, "--resume", str(place), "-o", str(out))
    assert (status, printed) == (1, "")
    assert "No space left on device" in error
    assert error.count("\n") == 1
    finished = kept(place)
    assert 0 < len(finished) < 64
    assert {file.name for file in place.iterdir()} <= {"campaign.json", "lock", *finished}
    assert not out.exists()
    shutil.copytree(place, tmp_path / "moved")
    assert run(*SWEEP, "--jobs", jobs, "--resume", str(tmp_path / "moved"), "-o", str(out))[0] == 0
    assert out.read_bytes() == undisturbed
    assert finished.items() <= kept(tmp_path / "moved").items()


def test_an_output_file_that_does_not_fit_is_not_there(small_disk: Path, tmp_path: Path) -> None:
    out = small_disk / "out.json"
    status, printed, error = run(*SWEEP, "--jobs", "1", "--resume", str(tmp_path / "chunks"), "-o", str(out))
    assert (status, printed) == (1, "")
    assert "No space left on device" in error
    assert list(small_disk.iterdir()) == []


def test_a_file_size_limit_is_met_as_a_full_disk_is(undisturbed: bytes, tmp_path: Path) -> None:
    """Where no disk can be mounted: every write beyond 512 bytes fails, which no chunk survives."""
    command = (*SWEEP, "--jobs", "1", "--resume", str(tmp_path / "chunks"), "-o", str(tmp_path / "out.json"))
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (512, 512))"
    status, printed, error = run(*command, before=limit)
    assert (status, printed) == (1, "")
    assert "File too large" in error
    assert kept(tmp_path / "chunks") == {}
    assert {file.name for file in (tmp_path / "chunks").iterdir()} <= {"campaign.json", "lock"}
    assert run(*command)[0] == 0
    assert (tmp_path / "out.json").read_bytes() == undisturbed
