"""The command line's manners: exit statuses, one message, nothing on standard output that is not the result."""

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from gks import commands
from gks.cli import main, parser
from gks.outputs import json_text

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a command in this process: its status, standard output and standard error."""

    def run(*argv: str) -> tuple[int, str, str]:
        try:
            status = main(argv)
        except SystemExit as leave:
            status = leave.code if isinstance(leave.code, int) else 1
        out, err = capsys.readouterr()
        return status, out, err

    return run


ENTRY = "from gks.cli import entry; entry()"


def process(
    *argv: str, code: str = ENTRY, stdout: int | None = subprocess.PIPE, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run a command in a process of its own, as the installed `gks` does."""
    return subprocess.run(
        [sys.executable, "-c", code, *argv],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
        check=False,
    )


def test_every_command_that_is_offered_is_carried_out() -> None:
    (offered,) = (action.choices for action in parser()._actions if isinstance(action, argparse._SubParsersAction))
    assert set(offered) == set(commands._COMMANDS)


# --- 2: the input is at fault


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["modes", "tradtional-1"], 'did you mean "traditional-1"?'),
        (["modes", "no/such/file.toml"], "no/such/file.toml"),
        (["modes", "traditional-1", "-p", "alpha"], "expected NAME=VALUE"),
        (["modes", "traditional-1", "-p", "=3"], "expected NAME=VALUE"),
        (["modes", "traditional-1", "-p", "alpha=1", "-p", "alpha=2"], "twice"),
        (["modes", "traditional-1", "-p", "alhpa=1"], 'did you mean "alpha"?'),
        (["modes", "traditional-1", "-p", "alpha=nan"], "alpha"),
        (["modes", "traditional-1", "-p", "lam=0"], "positive"),
        (["modes", "traditional-1", "-p", "alpha=1/0"], "alpha"),
        (["curve", "traditional-1", "-o", "curve.doc"], "expected .csv, .json, .png, .svg or .pdf"),
        (["curve", "traditional-1", "-o", "curve"], "no ending"),
        (["curve", "traditional-1", "-o", "no/such/folder/curve.csv"], "no folder"),
        (["new", ""], "printable"),
        (["new", "no/such/folder/mine"], "no folder"),
        (["march", "traditional-1", "--cells", "0"], "--cells"),
        (["march", "traditional-1", "--steps", "many"], "--steps"),
        (["curve"], "FILE"),
        (["curve", "traditional-1", "--swep", "alpha=1:2:3"], "--swep"),
        (["mode", "traditional-1"], "invalid choice"),
        ([], "COMMAND"),
    ],
)
def test_an_input_at_fault_is_one_line_and_status_2(run: Run, argv: list[str], said: str) -> None:
    status, out, err = run(*argv)
    assert (status, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1


def test_a_fault_in_the_file_begins_with_its_place(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('title = "no more than that"\nsuorce = "?"\n')
    status, out, err = run("modes", str(file))
    assert (status, out) == (2, "")
    assert err.startswith(f"{file}:2:1: ")


def test_a_refused_output_costs_no_computation_and_leaves_no_file(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("curve", "traditional-1", "-o", "good.csv", "-o", "bad.doc")[0] == 2
    assert os.listdir(tmp_path) == []


# --- 1: anything else


def test_a_full_disk_is_one_line_and_status_1() -> None:
    with open("/dev/full", "w") as full:
        ended = process("list", stdout=full.fileno())
    assert ended.returncode == 1
    assert ended.stderr == "gks: standard output: No space left on device\n"


def test_a_reader_that_leaves_is_not_complained_about() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ended = process("list", stdout=writing)
    os.close(writing)
    assert (ended.returncode, ended.stderr) == (1, "")


FAULTY = "import gks.commands; from gks.cli import entry; gks.commands._COMMANDS['list'] = lambda _: [][1]; entry()"


def test_a_fault_of_the_program_is_one_line_and_status_1() -> None:
    ended = process("list", code=FAULTY)
    assert (ended.returncode, ended.stdout) == (1, "")
    assert ended.stderr.startswith("gks: internal error: IndexError: list index out of range (")
    assert ended.stderr.count("\n") == 1


def test_the_traceback_is_there_for_who_asks() -> None:
    ended = process("list", code=FAULTY, GKS_TRACEBACK="1")
    assert ended.returncode == 1
    assert ended.stderr.startswith("Traceback")


def test_an_interrupted_run_says_so(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: object) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr("gks.commands.carry_out", interrupted)
    assert run("list") == (130, "", "gks: interrupted\n")


# --- 0: it worked


def test_json_is_one_object_and_nothing_else(run: Run) -> None:
    status, out, err = run("list", "--json")
    assert (status, err) == (0, "")
    assert json.loads(out)["schema"] == "gks.list/1"


@pytest.mark.parametrize("number", [float("nan"), float("inf"), -float("inf")])
def test_json_never_holds_a_nan_or_an_infinity(number: float) -> None:
    class Careless:
        def to_json(self) -> dict[str, object]:
            return {"lam_max": number}

    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text(Careless())


def test_a_terminal_without_the_letters_still_gets_the_answer() -> None:
    ended = process("list", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert ended.returncode == 0
    assert "Banks & Sj\\xf6green" in ended.stdout


@pytest.mark.parametrize("start", [["-m", "gks"], ["-c", ENTRY]])
def test_every_way_to_start_it_is_the_same_program(start: list[str]) -> None:
    ended = subprocess.run([sys.executable, *start, "--version"], capture_output=True, text=True, check=True)
    assert ended.stdout.startswith("gks ")


# --- gks curve -o


class Numbers:
    """Stands for a curve, so that writing it is tested apart from computing it."""

    def __str__(self) -> str:
        return "a table"

    def to_json(self) -> dict[str, object]:
        return {"schema": "gks.curve/1"}

    def to_csv(self) -> str:
        return "alpha,lam_max\n1,1\n"


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Let every curve be `Numbers`, in a folder of its own."""
    monkeypatch.setattr("gks.api.LoadedScheme.curve", lambda *_, **__: Numbers())
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("computed")
def test_without_o_the_curve_is_printed(run: Run) -> None:
    assert run("curve", "traditional-1") == (0, "a table\n", "")


def test_with_o_it_is_written_and_the_file_is_named(run: Run, computed: Path) -> None:
    assert run("curve", "traditional-1", "-o", "c.csv", "-o", "c.JSON") == (0, "c.csv\nc.JSON\n", "")
    assert (computed / "c.csv").read_text() == "alpha,lam_max\n1,1\n"
    assert json.loads((computed / "c.JSON").read_text()) == {"schema": "gks.curve/1"}
    assert sorted(os.listdir(computed)) == ["c.JSON", "c.csv"]


def test_with_o_and_json_it_is_both(run: Run, computed: Path) -> None:
    status, out, err = run("curve", "traditional-1", "-o", "c.csv", "--json")
    assert (status, json.loads(out), err) == (0, {"schema": "gks.curve/1"}, "")
    assert (computed / "c.csv").exists()


# --- gks new


def test_new_writes_a_file_and_says_its_name(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "mine"
    assert run("new", str(path)) == (0, f"{path}.toml\n", "")
    assert (tmp_path / "mine.toml").read_text().startswith('title = "mine"\n')


def test_new_never_overwrites(run: Run, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("all my work")
    status, out, err = run("new", str(tmp_path / "mine.toml"))
    assert (status, out) == (2, "")
    assert "exists" in err
    assert (tmp_path / "mine.toml").read_text() == "all my work"


@pytest.mark.parametrize("name", ["mine", 'in "quotes"', "back\\slash", "Sjögreen's"])
def test_the_starter_runs_as_it_is(run: Run, tmp_path: Path, name: str) -> None:
    run("new", str(tmp_path / name))
    status, out, err = run("modes", str(tmp_path / f"{name}.toml"), "--json")
    assert (status, err) == (0, "")
    assert json.loads(out)["verdict"] == "stable"
