"""A curve in chunks is the curve in one piece, byte for byte, whatever computes it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from concurrent.futures import Executor, ThreadPoolExecutor
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import gks
from gks.bounds.curve import Curve
from gks.bounds.point import CurvePoint, point_at
from gks.bounds.sweep import Point, parse_sweep
from gks.campaigns.conduct import Conduct
from gks.campaigns.executors import InProcess
from gks.campaigns.sweeps import campaign_curve, cut
from gks.errors import InputError, ParameterError
from gks.reports.notebook import PicturedCurve
from gks.scheme.model import Scheme
from tests.campaigns.command import run
from tests.examples import examples

SMALL = """
title = "half-line"
[parameters]
lam = { role = "cfl", default = 0.5 }
a = 1
[domains.R]
side = "right"
unknowns = ["u"]
interior = ["u[i, n+1] = u[i] + lam*(u[i+1] - u[i-1])/2 + lam**2/2*(u[i+1] - 2*u[i] + u[i-1])"]
first = 1
[closure]
equations = ["u[0] = u[1]/a + (1 - 1/a)*u[2]"]
"""


def without_time(curve: object) -> str:
    assert isinstance(curve, Curve)
    return json.dumps({**curve.to_json(), "time_s": None}, allow_nan=False)


SWEEPS = [
    ("traditional-1", "alpha=1e-4:1e4:150:log"),  # the batched route
    ("traditional-2", "alpha=1e-300:1e300:25:log"),  # the batch leaves points open
    ("weighted-1-unequal", "alpha=1/10:10:5"),
]


@pytest.mark.parametrize(("name", "sweep"), SWEEPS)
def test_chunks_give_the_points_of_the_whole_sweep(name: str, sweep: str) -> None:
    scheme = gks.load(name)
    whole, pieces = scheme.curve(sweep=sweep), scheme.curve(sweep=sweep, jobs=1)
    assert json.loads(without_time(pieces)) == json.loads(without_time(whole))
    assert without_time(pieces) == without_time(whole)
    assert pieces.to_csv() == whole.to_csv()
    assert (pieces.time_s, pieces.to_json()["time_s"]) == (None, None)


def test_any_number_of_workers_gives_the_same_bytes() -> None:
    scheme, sweep = gks.load("traditional-2"), "alpha=1e-3:1e3:20:log"
    assert len({scheme.curve(sweep=sweep, jobs=jobs).json_text() for jobs in (1, 2, 3)}) == 1


@pytest.mark.parametrize("executor", [InProcess(), ThreadPoolExecutor(2)])
def test_any_executor_will_do(executor: Executor) -> None:
    scheme, sweep = gks.load("traditional-1"), "alpha=1e-3:1e3:20:log"
    with executor:
        assert scheme.curve(sweep=sweep, executor=executor).json_text() == scheme.curve(sweep=sweep, jobs=1).json_text()


def test_a_point_without_a_scheme_is_flagged_in_its_place(tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    scheme = gks.load(path)
    pieces = scheme.curve(sweep="a=-1:1:3", jobs=1)
    assert isinstance(pieces, Curve)
    assert [point.resolved for point in pieces.points] == [True, False, True]
    assert without_time(pieces) == without_time(scheme.curve(sweep="a=-1:1:3"))
    with pytest.raises(InputError) as here:
        scheme.curve(a=[0, 0])
    with pytest.raises(InputError) as there:
        scheme.curve(a=[0, 0], jobs=1)
    assert str(here.value) == str(there.value)


def test_a_map_is_the_map_in_one_piece() -> None:
    from gks.bounds.curvemap import curve_map

    scheme = gks.load("weighted-1-unequal").scheme
    sweeps = [parse_sweep("alpha=1/2:2:5"), parse_sweep("c=1/2:2:3")]
    whole = curve_map(scheme, scheme.values(), sweeps)
    pieces = campaign_curve(scheme, scheme.values(), sweeps, Conduct(jobs=1))
    assert pieces.to_csv() == whole.to_csv()
    assert {**pieces.to_json(), "time_s": None} == {**whole.to_json(), "time_s": None}


@given(st.integers(1, 300), st.integers(2, 50))
@examples(50)
def test_pieces_are_the_points_in_order_and_none_is_alone(total: int, size: int) -> None:
    pieces = cut([float(k) for k in range(total)], size)
    assert [point for piece in pieces for point in piece] == [float(k) for k in range(total)]
    assert total == 1 or min(map(len, pieces)) >= 2
    assert max(map(len, pieces)) <= size + 1


WIDE = SMALL.replace("u[0] = u[1]/a + (1 - 1/a)*u[2]", "u[0] = (2*u[1] - u[2])/a + (1 - 1/a)*u[3]")


@pytest.mark.parametrize("jobs", [1, 2])
def test_chunks_honour_the_time_limit_of_a_point(jobs: int, tmp_path: Path) -> None:
    path = tmp_path / "wide.toml"
    path.write_text(WIDE)
    scheme = gks.load(path)
    (free, cut) = (scheme.curve(a=[1, 2, 3], jobs=jobs, limit=limit) for limit in (None, 1e-4))
    assert isinstance(free, PicturedCurve)
    assert isinstance(cut, PicturedCurve)
    assert all(point.resolved for point in free.points)
    points = cut.points
    assert [(point.resolved, point.because) for point in points] == [
        (False, "not done within the limit of 0.0001 s")
    ] * 3


def test_chunks_are_told_to_certify(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def noting(scheme: Scheme, values: Mapping[str, Fraction], value: Point | None, *, certify: bool) -> CurvePoint:
        asked.append(certify)
        return point_at(scheme, values, value, certify=certify)

    monkeypatch.setattr("gks.bounds.curve.point_at", noting)
    path = tmp_path / "wide.toml"
    path.write_text(WIDE)
    for certify in (False, True):
        gks.load(path).curve(a=[1, 2], jobs=1, certify=certify)
    assert asked == [False, False, True, True]


@pytest.mark.parametrize(
    "asked", [{"jobs": 2}, {"resume": "chunks"}, {"executor": InProcess()}, {"limit": 5.0}, {"certify": True}]
)
def test_what_moduli_over_lam_cannot_honour_is_refused(asked: dict[str, Any]) -> None:
    with pytest.raises(ParameterError, match="in one piece, in double precision"):
        gks.load("traditional-1").curve(sweep="lam=0.1:1:3", **asked)


def test_chunks_with_another_limit_are_another_campaign(tmp_path: Path) -> None:
    scheme, place = gks.load("traditional-1"), str(tmp_path / "chunks")
    scheme.curve(sweep="alpha=1:9:4", resume=place, limit=60)
    with pytest.raises(InputError, match=r'another campaign \("limit"'):
        scheme.curve(sweep="alpha=1:9:4", resume=place)
    with pytest.raises(InputError, match=r'another campaign \("certify"'):
        scheme.curve(sweep="alpha=1:9:4", resume=place, limit=60, certify=True)


# The folder -----------------------------------------------------------------------------------------------------------


def test_a_second_run_computes_nothing_and_gives_the_same_bytes(tmp_path: Path) -> None:
    scheme, sweep, place = gks.load("traditional-1"), "alpha=1e-3:1e3:40:log", str(tmp_path / "chunks")
    told: list[tuple[int, int]] = []
    first = scheme.curve(sweep=sweep, resume=place)
    again = scheme.curve(sweep=sweep, resume=place, progress=lambda *done: told.append(done))
    assert first.json_text() == again.json_text()
    assert told == [(40, 40)]


@pytest.mark.parametrize(
    ("sweep", "values"),
    [("alpha=1e-3:1e3:41:log", {}), ("alpha=1e-3:1e3:40", {}), ("alpha=1e-3:1e3:40:log", {"lam": 1})],
)
def test_another_sweep_in_the_same_folder_is_refused(sweep: str, values: dict[str, int], tmp_path: Path) -> None:
    scheme, place = gks.load("traditional-1"), str(tmp_path / "chunks")
    scheme.curve(sweep="alpha=1e-3:1e3:40:log", resume=place)
    with pytest.raises(InputError, match="another campaign"):
        scheme.curve(values, sweep=sweep, resume=place)
    with pytest.raises(InputError, match=r'another campaign \("scheme"'):
        gks.load("average-1").curve(sweep="alpha=1e-3:1e3:40:log", resume=place)


def test_workers_are_for_sweeps() -> None:
    with pytest.raises(ParameterError, match="no parameter runs"):
        gks.load("traditional-1").curve(jobs=2)


# The command ----------------------------------------------------------------------------------------------------------


def test_the_command_writes_the_same_files_whoever_computes_them(tmp_path: Path) -> None:
    written = []
    for jobs in ("1", "2"):
        out = tmp_path / f"{jobs}.json"
        assert run("curve", "traditional-1", "--sweep", "alpha=1:9:33", "--jobs", jobs, "-o", str(out)) == (
            0,
            f"{out}\n",
            "",
        )
        written.append(out.read_bytes())
    assert written[0] == written[1]


@pytest.mark.parametrize("asked", [("--limit", "5"), ("--certify",), ("--jobs", "2")])
def test_the_command_refuses_them_as_well(asked: tuple[str, ...]) -> None:
    status, printed, error = run("curve", "traditional-1", "--sweep", "lam=0.1:1:3", *asked)
    assert (status, printed, error.count("\n")) == (2, "", 1)
    assert "leave out --jobs" in error
    assert run("curve", "traditional-1", "--sweep", "lam=0.1:1:3")[0] == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--jobs", "0"), "'0' is not a whole number"),
        (("--jobs", "2", "--scheduler", "tcp://localhost:1"), "three ways"),
        (("--scheduler", "nonsense://x"), "expected tcp://HOST:PORT"),
        (("--scheduler", "tcp://localhost:1"), "no scheduler answers"),
        (("--resume", "/dev/null"), "not a folder"),
    ],
)
def test_input_at_fault_is_said_in_one_line(arguments: tuple[str, ...], said: str) -> None:
    status, printed, error = run("curve", "traditional-1", "--sweep", "alpha=1:9:3", *arguments)
    assert (status, printed) == (2, "")
    assert said in error
    assert error.count("\n") == 1
