"""What is kept for the next run is used only where it is provably what would be computed; else it is computed again."""

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

import gks
from gks.reports import store as stores
from gks.reports.report import computed
from gks.reports.steps import Step
from gks.reports.store import FOLDER, Store, digest, key_of
from tests.reports.example import TEXT, Silent

STEP = Step("modes", "steps.modes", {"values": {"lam": "9/10", "alpha": "4"}}, (TEXT, "example", None))


def entry_of(folder: Path) -> Path:
    (path,) = (folder / FOLDER).iterdir()
    return path


def modulus(folder: Path, watcher: Silent, step: Step = STEP, *, fresh: bool = False) -> float:
    records = computed([step], Store(str(folder), fresh=fresh), watcher)
    found: float = records["modes"]["result"]["modes"][0]["modulus"]
    return found


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    """A folder that holds one entry, with the truth in it."""
    modulus(tmp_path, Silent())
    return tmp_path


def test_a_second_run_finds_what_the_first_kept(kept: Path) -> None:
    watcher = Silent()
    assert modulus(kept, watcher) == pytest.approx(1.1125**0.5, rel=1e-12)
    assert (watcher.computed, watcher.kept) == ([], ["modes"])


def test_fresh_looks_at_nothing_and_keeps_anew(kept: Path) -> None:
    watcher = Silent()
    modulus(kept, watcher, fresh=True)
    assert watcher.computed == ["modes"]
    modulus(kept, watcher)
    assert watcher.kept == ["modes"]


def spoil(path: Path, how: str) -> None:
    data = path.read_bytes()
    entry = json.loads(data)
    match how:
        case "a wrong number":
            entry["record"]["result"]["modes"][0]["modulus"] = 0.5
        case "a wrong number and its own digest, under another key":
            entry["record"]["result"]["modes"][0]["modulus"] = 0.5
            entry["digest"], entry["key"] = digest(entry["record"]), "0" * 64
        case "no record":
            entry = {"key": entry["key"], "digest": digest(None), "record": None}
        case "another kind of JSON":
            entry = [1, 2]
        case "half of it":
            path.write_bytes(data[: len(data) // 2])
            return
        case "nothing":
            path.write_bytes(b"")
            return
        case "no text":
            path.write_bytes(b"\xff\xfe" + data)
            return
        case _:
            path.write_text("[" * 100_000)
            return
    path.write_text(json.dumps(entry))


@pytest.mark.parametrize(
    "how",
    [
        "a wrong number",
        "a wrong number and its own digest, under another key",
        "no record",
        "another kind of JSON",
        "half of it",
        "nothing",
        "no text",
        "brackets",
    ],
)
def test_a_spoilt_entry_costs_a_computation_and_no_wrong_number(kept: Path, how: str) -> None:
    spoil(entry_of(kept), how)
    store = Store(str(kept))
    assert store.find(STEP) is None
    right = {"result": {"modes": [{"modulus": 1.5}]}, "seconds": 0.1}
    store.keep(STEP, right)
    assert store.find(STEP) == right


def test_the_key_holds_all_that_the_result_depends_on(monkeypatch: pytest.MonkeyPatch) -> None:
    others = [
        replace(STEP, arguments={"values": {"lam": "9/10", "alpha": "5"}}),
        replace(STEP, kind="steps.march"),
        replace(STEP, source=(TEXT + "\n", "example", None)),
    ]
    keys = {key_of(step) for step in (STEP, *others)}
    monkeypatch.setattr(gks, "__version__", "0.0.0")
    keys.add(key_of(STEP))
    monkeypatch.undo()
    monkeypatch.setattr(stores, "code", lambda: "another program")
    keys.add(key_of(STEP))
    monkeypatch.undo()
    monkeypatch.setattr(stores, "versions", lambda: (("gks", gks.__version__), ("numpy", "0.0")))
    keys.add(key_of(STEP))
    assert len(keys) == 7


@pytest.mark.parametrize("file", ["steps.py", "gks.mplstyle", "traditional-1.toml"])
def test_the_code_is_all_that_steps_read(file: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shipped schemes and the style of pictures too: steps take them by name."""
    folders: list[str] = []
    real = os.listdir

    def without(folder: str) -> list[str]:
        folders.append(folder)
        return [name for name in real(folder) if name != file]

    monkeypatch.setattr("gks.reports.store.os.listdir", without)
    assert stores.code.__wrapped__() != stores.code()
    assert {Path(folder).name for folder in folders} >= {"bounds", "catalogue", "reports"}


def test_the_key_does_not_hold_what_changes_nothing() -> None:
    assert key_of(replace(STEP, name="other", limit=1.0, command="gks", source=(TEXT, "example", "/x"))) == key_of(STEP)
