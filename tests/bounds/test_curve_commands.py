"""`gks curve` and `gks modes` from the command line: two sweeps, time limits, proof asked for, progress."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import pytest

from gks import commands
from gks.cli import main

Capture = pytest.CaptureFixture[str]


def printed(capsys: Capture, *argv: str) -> str:
    assert main(argv) == 0
    return capsys.readouterr().out


def test_two_sweeps_make_a_map(capsys: Capture, tmp_path: Path) -> None:
    scheme = "weighted-1-unequal"
    sweeps = ("--sweep", "alpha=1:10:3:log", "--sweep", f"{other(scheme)}=1:2:2")
    files = [str(tmp_path / f"map.{ending}") for ending in ("csv", "json", "png", "svg", "pdf")]
    out = printed(capsys, "curve", scheme, *sweeps, *(part for file in files for part in ("-o", file)))
    assert out.split() == files
    rows = list(csv.reader((tmp_path / "map.csv").read_text().splitlines()))
    assert rows[0] == ["alpha", other(scheme), "lam_max", "limited_by", "error_bound"]
    assert len(rows) == 7
    assert json.loads((tmp_path / "map.json").read_text())["sweep"] == ["alpha", other(scheme)]


def other(scheme: str) -> str:
    """The parameter that is neither alpha nor the CFL number."""
    from gks.catalogue import find

    return next(p.name for p in find(scheme).parameters if p.role != "cfl" and p.name != "alpha")


def test_a_sweep_over_the_cfl_number_gives_the_moduli(capsys: Capture) -> None:
    data = json.loads(printed(capsys, "curve", "traditional-1", "-p", "alpha=9", "--sweep", "lam=0.2:0.8:3", "--json"))
    assert (data["schema"], data["sweep"], data["tier"]) == ("gks.radius/1", ["lam"], "numeric")
    # Theorem 3.1 has the bound 4/(1 + alpha) = 2/5.
    assert [point["verdict"] for point in data["points"]] == ["stable", "unstable", "unstable"]


def test_over_the_limit_a_verdict_is_undecided(capsys: Capture) -> None:
    data = json.loads(printed(capsys, "modes", "lax-wendroff-order-8-oblique", "--limit", "0.001", "--json"))
    assert (data["verdict"], data["modes"], data["certified"]) == ("undecided", [], False)
    assert "limit" in data["because"]


@pytest.mark.parametrize("name", ["traditional-1", "lax-wendroff-order-8-oblique"])
def test_proof_where_it_is_asked_for(capsys: Capture, name: str) -> None:
    data = json.loads(printed(capsys, "modes", name, "--certify", "--json"))
    assert (data["verdict"], data["certified"]) == ("stable", True)
    assert data["tier"] in ("exact", "certified")


def test_a_certified_curve(capsys: Capture) -> None:
    found = printed(capsys, "curve", "traditional-2", "--sweep", "alpha=1:10:5", "--certify", "--json")
    assert json.loads(found)["tier"] in ("exact", "certified")


def test_progress_goes_to_a_terminal_alone_and_is_wiped(capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(commands, "PAUSE", -1.0)
    printed(capsys, "curve", "leapfrog-space-0")
    with commands._counted_to_a_terminal("points") as told:
        assert told is None  # a captured stream is no terminal
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with pytest.raises(KeyboardInterrupt), commands._counted_to_a_terminal("points") as told:
        assert told is not None
        told(3, 12)
        raise KeyboardInterrupt
    err = capsys.readouterr().err
    assert "3 of 12 points" in err
    assert err.endswith("\r\x1b[K")
