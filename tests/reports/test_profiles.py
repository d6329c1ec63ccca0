"""Pictures of modes and of root maps: what is drawn is the data, and the same data gives the same bytes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from gks.api import load
from gks.cli import main
from gks.modes.verdict import ModeKind
from gks.reports.profiles import draw_profile, profile_image
from gks.reports.rootmaps import KINDS, draw_rootmap, rootmap_image

PROFILE = load("traditional-1").profile(alpha=5, cells=12)
ROOTS = load("traditional-1").roots(sweep="alpha=1:10:21")


def test_a_profile_draws_every_unknown_over_its_indices() -> None:
    figure = Figure()
    draw_profile(PROFILE, figure)
    left, right = figure.axes[:2]
    for axes, domain in ((left, "L"), (right, "R")):
        lines = {str(line.get_label()): line for line in axes.get_lines() if not str(line.get_label()).startswith("_")}
        assert set(lines) == {f"{domain}.u", f"{domain}.s"}
        for unknown in "us":
            line = lines[f"{domain}.{unknown}"]
            assert np.asarray(line.get_xdata()).tolist() == list(PROFILE.indices[domain])
            real = [float(v[0]) for v in PROFILE.shapes[0].values[domain][unknown]]
            assert np.asarray(line.get_ydata()).tolist() == real


def test_boundary_points_are_open_markers() -> None:
    figure = Figure()
    draw_profile(PROFILE, figure)
    opened = [line for line in figure.axes[1].get_lines() if line.get_markerfacecolor() == "white"]
    assert [np.asarray(line.get_xdata()).tolist() for line in opened] == [[-1], [-1]]


def test_kinds_are_told_apart_without_colour() -> None:
    looks = [(style["marker"], style["linestyle"], style["linewidth"]) for style in KINDS.values()]
    assert len(set(looks)) == len(looks) == len(ModeKind) + 1


def test_a_root_map_has_both_planes_and_an_arrow_along_the_parameter() -> None:
    figure = Figure()
    draw_rootmap(ROOTS, figure)
    assert [axes.get_xlabel() for axes in figure.axes] == [r"$\mathrm{Re}\,z$", r"$\mathrm{Re}\,r$"]
    arrows = [note for note in figure.axes[0].texts if note.arrow_patch is not None]  # type: ignore[attr-defined]
    assert len(arrows) >= len(ROOTS.tracks)
    upper = next(track for track in ROOTS.tracks if track.points[0] is not None and track.points[0].z.imag > 0)
    first = upper.points[0]
    assert first is not None
    marks = [line for line in figure.axes[0].get_lines() if line.get_markerfacecolor() == "none"]
    assert (first.z.real, first.z.imag) in [tuple(np.asarray(line.get_xydata())[0].tolist()) for line in marks]


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_the_same_data_gives_the_same_bytes(kind: str) -> None:
    assert profile_image(PROFILE, kind) == profile_image(PROFILE, kind)
    assert rootmap_image(ROOTS, kind) == rootmap_image(ROOTS, kind)


def test_a_generalized_mode_and_a_scheme_without_r_are_drawn() -> None:
    assert profile_image(load("leapfrog-space-0").profile(), "svg").startswith(b"<?xml")
    assert rootmap_image(load("leapfrog-space-0").roots(sweep="lam=1/10:9/10:3"), "svg").startswith(b"<?xml")


def test_commands_write_what_the_endings_say(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture, table, data = (tmp_path / name for name in ("p.svg", "p.csv", "p.json"))
    outputs = [part for path in (picture, table, data) for part in ("-o", str(path))]
    assert main(["profile", "traditional-1", "-p", "alpha=5", "--cells", "4", *outputs]) == 0
    assert capsys.readouterr().out.split() == [str(picture), str(table), str(data)]
    assert json.loads(data.read_text())["schema"] == "gks.profile/1"
    assert table.read_text().startswith("shape,domain,unknown,index,re,im,modulus\n")
    assert main(["roots", "traditional-1", "--sweep", "alpha=1:4:3", *outputs]) == 0
    capsys.readouterr()
    assert json.loads(data.read_text())["schema"] == "gks.roots/1"
    assert main(["roots", "traditional-1", "--sweep", "alpha=1:4:3", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["sweep"] == "alpha"


def test_commands_refuse_a_mode_that_there_is_not(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profile", "traditional-1", "--mode", "7"]) == 2
    assert "no mode 7" in capsys.readouterr().err
    assert main(["profile", "weighted-1"]) == 2
    assert "no mode" in capsys.readouterr().err
