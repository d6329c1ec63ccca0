"""Root maps: where z moves with a parameter, against formulas known by hand and the analysis of single points."""

from __future__ import annotations

import csv
import io
import json
from fractions import Fraction

import numpy as np
import pytest

from gks.api import LoadedScheme, load
from gks.bounds.rootpaths import RootMap
from gks.bounds.roottracks import assignment, follow
from gks.errors import InputError
from gks.modes.verdict import ModeKind
from tests.bounds.theorem_schemes import upwind_flux
from tests.modes.test_coupled import YEE
from tests.modes.test_coupled import half_line as system
from tests.modes.test_wide import INFLOW, lax_wendroff, written
from tests.oracle.scheme_texts import LEAPFROG, half_line


def kinds(found: RootMap, track: int) -> list[ModeKind | None]:
    return [None if p is None else p.kind for p in found.tracks[track].points]


def test_theorem_3_1_as_a_map() -> None:
    # (3.6): r = 1/2 +- i sqrt(alpha)/2 and z = 1 + lam (r - 1); a mode where abs(r) > 1, growing above alpha = 31/9.
    found = load("traditional-1").roots(sweep="alpha=1:4:31")
    assert len(found.tracks) == 2 and found.has_r
    for track, sign in zip(found.tracks, (1, -1), strict=True):
        for value, point in zip(found.sweep.values, track.points, strict=True):
            assert point is not None and point.r is not None
            r = complex(0.5, sign * float(value) ** 0.5 / 2)
            assert point.r == pytest.approx(r, abs=1e-14)
            assert point.z == pytest.approx(1 + 0.9 * (r - 1), abs=1e-14)
            expected = ModeKind.INADMISSIBLE
            if value > 3:
                expected = ModeKind.GROWING if value > Fraction(31, 9) else ModeKind.DECAYING
            assert point.kind is expected


def test_the_neutral_value_itself_is_judged_exactly() -> None:
    found = load("traditional-1").roots({"alpha": [3, Fraction(31, 9), 4]})
    assert kinds(found, 0) == [ModeKind.INADMISSIBLE, ModeKind.EIGENVALUE, ModeKind.GROWING]


@pytest.mark.parametrize(
    ("name", "sweep"),
    [
        ("traditional-2", "alpha=1/10:10:7:log"),
        ("weighted-1-unequal", "alpha=1/10:10:5:log"),
        ("traditional-1", "lam=1/10:2:5"),
        ("implicit-1", "lam=1/10:9:5"),
        ("leapfrog-oblique-1", "lam=1/10:11/10:5"),
        ("beam-warming-inverse-3-1", "lam=1/10:2:5"),
        ("lax-wendroff-order-8-oblique", "lam=1/2:11/10:2"),
    ],
)
def test_every_value_has_the_roots_and_kinds_of_its_own_analysis(name: str, sweep: str) -> None:
    scheme = load(name)
    found = scheme.roots(sweep=sweep)
    for k, value in enumerate(found.sweep.values):
        single = scheme.modes({found.sweep.name: Fraction(value)})
        theirs = {(complex(round(m.z_complex.real, 9), round(m.z_complex.imag, 9)), m.kind) for m in single.modes}
        points = [p for track in found.tracks if (p := track.points[k]) is not None]
        ours = {(complex(round(p.z.real, 9), round(p.z.imag, 9)), p.kind) for p in points}
        assert ours == theirs


def test_tracks_are_continuous() -> None:
    found = load("traditional-2").roots(sweep="alpha=1e-2:1e2:41:log")
    fine = load("traditional-2").roots(sweep="alpha=1e-2:1e2:161:log")
    assert len(found.tracks) == len(fine.tracks) == 4
    ends = {track.points[0].z: track.points[-1].z for track in fine.tracks if track.points[0] and track.points[-1]}
    for track in found.tracks:
        first, last = track.points[0], track.points[-1]
        assert first is not None and last is not None
        nearest = min(ends, key=lambda z: abs(z - first.z))
        assert ends[nearest] == pytest.approx(last.z)


# Schemes that the polynomial route is not for -------------------------------------------------------------------------


def test_schemes_without_a_polynomial_are_followed_by_their_modes() -> None:
    closure = [f"u[{-k}] = 2*u[{-k + 1}] - u[{-k + 2}]/3" for k in (1, 2, 3)] + ["u[-4] = 4*u[0]"]
    schemes = [system(YEE, ("s[-1] = s[0]", "u[-1] = 3*u[0]")), written(lax_wendroff(4, INFLOW), closure)]
    for scheme, sweep in zip(schemes, ("lam=1/4:3/4:3", "lam=1/2:9/10:3"), strict=True):
        found = LoadedScheme(scheme).roots(sweep=sweep)
        growing = [p for track in found.tracks for p in track.points if p is not None and p.kind is ModeKind.GROWING]
        assert growing
        for p in growing:
            assert abs(p.z) > 1


def test_an_upwinding_that_turns_round_is_not_taken_from_the_sample() -> None:
    scheme = LoadedScheme(upwind_flux("a", "3*u[0]"))
    found = scheme.roots(sweep="a=-1:1:4")
    for k, value in enumerate(found.sweep.values):
        single = sorted((m.z_complex.real, m.kind) for m in scheme.modes(a=value).modes)
        points = [p for track in found.tracks if (p := track.points[k]) is not None]
        assert [p.z.real for p in points] == pytest.approx([z for z, _ in single])
        assert [p.kind for p in points] == [kind for _, kind in single]


def test_a_value_without_a_scheme_is_a_fault_and_not_an_error() -> None:
    scheme = half_line(LEAPFROG, '"u[0, n+1] = u[1, n+1]"', 1)
    assert not LoadedScheme(scheme).roots(sweep="lam=1/2:1/4:2").faults
    found = load("traditional-1").roots({"alpha": [0, 1]})
    assert list(found.faults) == [0] and [track.points[0] for track in found.tracks] == [None, None]
    with pytest.raises(InputError):
        load("traditional-1").roots({"alpha": [0]})


def test_refusals() -> None:
    for sweep in ("lam=0:1:3", "lam=-1:1:3", "alpha=1:2:30000", "beta=1:2:3"):
        with pytest.raises(InputError):
            load("traditional-1").roots(sweep=sweep)
    with pytest.raises(InputError, match="0 parameters run"):
        load("traditional-1").roots(alpha=1)


# Following ------------------------------------------------------------------------------------------------------------


def crossing(t: float) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """Two roots that pass close by each other: +-(s + i/1000) with s = 2 t - 1."""
    s = complex(2 * t - 1, 1e-3)
    return np.array([s, -s])


def test_close_passing_roots_are_not_exchanged() -> None:
    before, after = crossing(0.0), crossing(1.0)
    assert assignment(before, after) == [1, 0]  # one step alone takes each root for the other
    assert follow(crossing, before, after, 0.0, 1.0, 12) == [0, 1]


def test_roots_that_come_from_infinity_begin_a_track() -> None:
    assert assignment(np.array([1.0 + 0j]), np.array([1e9 + 0j, 1.1 + 0j])) == [1]
    assert assignment(np.array([1.0 + 0j, 1e12]), np.array([1.0 + 0j])) == [0, None]


# Output ---------------------------------------------------------------------------------------------------------------


def test_json_and_csv_hold_the_same_points() -> None:
    found = load("traditional-1").roots(sweep="alpha=1:4:3")
    data = json.loads(found.json_text())
    assert data["schema"] == "gks.roots/1" and data["values"] == [1.0, 2.5, 4.0]
    rows = list(csv.DictReader(io.StringIO(found.to_csv())))
    assert len(rows) == 6
    for row in rows:
        at = data["values"].index(float(row["alpha"]))
        assert data["tracks"][int(row["track"])]["z"][at] == [float(row["re"]), float(row["im"])]
        assert data["tracks"][int(row["track"])]["kind"][at] == row["kind"]
    assert "growing" in str(found)
