"""Curves over a sweep: the batched route against the exact one, flagged points, and the forms they are printed in."""

from __future__ import annotations

import csv
import io
import json
from fractions import Fraction
from typing import cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks import catalogue
from gks.bounds.batch import batch
from gks.bounds.cfl import stable_set
from gks.bounds.curve import curve
from gks.bounds.point import CurvePoint
from gks.bounds.sweep import of_values, parse_sweep
from gks.errors import InputError, NotAnalysable, ParameterError
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.examples import examples
from tests.oracle.scheme_texts import WEIGHTED, interface

NAMES = ["traditional-1", "traditional-2", "average-1", "weighted-1", "weighted-2", "characteristic-2", "implicit-1"]


def points(scheme: Scheme, spec: str) -> list[CurvePoint]:
    return list(curve(scheme, scheme.values({}), parse_sweep(spec)).points)


def agrees(scheme: Scheme, name: str, point: CurvePoint, value: Fraction) -> None:
    """A point of a curve against the exact set at the same value, within the error it states."""
    exact = stable_set(scheme, {**scheme.values({}), name: value})
    assert point.resolved
    assert point.limited_by == exact.limited_by
    assert len(point.stable_set) == len(exact.intervals)
    for (low, high), interval in zip(point.stable_set, exact.intervals, strict=True):
        for shown, end, empty in ((low, interval.low, 0.0), (high, interval.high, "oo")):
            if end is None:
                assert shown == empty
                continue
            assert isinstance(shown, float)
            truth = (
                end.rational if end.rational is not None else Fraction(end.ball(120).real.mid().str(30, radius=False))
            )
            assert abs(Fraction(shown) - truth) <= Fraction(point.error_bound) * truth


class TestBatchAgainstExact:
    @given(st.sampled_from(NAMES), st.lists(st.floats(-9, 9), min_size=3, max_size=3))
    @examples(12)
    def test_shipped_schemes_at_random_ratios(self, name: str, exponents: list[float]) -> None:
        scheme = catalogue.find(name)
        values = [Fraction(10.0**e) for e in exponents]
        found = curve(scheme, scheme.values({}), of_values("alpha", values))
        for point, value in zip(found.points, values, strict=True):
            agrees(scheme, "alpha", point, value)

    @pytest.mark.parametrize(
        "time", ["forward-euler", "backward-euler", "rk2", "ssprk3", "rk4", "ab2", "crank-nicolson", "bdf2"]
    )
    def test_every_integrator_with_random_weights(self, time: str) -> None:
        scheme = interface(
            WEIGHTED, time, parameters='a = "1/3"\nb = "3/4"\nc = "-1/5"\nd = "1/2"\ne = "1/3"\nf = "2/7"'
        )
        values = [Fraction(n, 7) for n in (1, 3, 8, 40)]
        taken = batch(scheme, scheme.values({}), "alpha", values)
        assert taken is not None
        found = curve(scheme, scheme.values({}), of_values("alpha", values))
        for point, value in zip(found.points, values, strict=True):
            agrees(scheme, "alpha", point, value)

    def test_the_batch_says_what_it_does_not_know(self) -> None:
        """At alpha = 3 closure and interior meet at lam = 1, and at 1e300 squares overflow; the exact route takes
        over.
        """
        scheme = catalogue.find("traditional-1")
        values = [Fraction(2), Fraction(3), Fraction(10) ** 300, Fraction(10) ** 400]
        taken = batch(scheme, scheme.values({}), "alpha", values)
        assert taken is not None
        assert taken.stable.resolved[0]
        assert not taken.stable.resolved[3]
        found = curve(scheme, scheme.values({}), of_values("alpha", values)).points
        assert [p.lam_max for p in found[:3]] == [1.0, 1.0, 4e-300]
        assert found[3].lam_max == "4e-400"
        assert [p.limited_by for p in found] == ["interior", "interior", "closure", "closure"]

    def test_wide_stencils_take_the_exact_route(self) -> None:
        scheme = interface(
            'equations = ["L.u[1] = L.u[0]", "L.s[1] = R.s[0]", "R.u[-1] = L.u[0]", "R.s[-1] = R.s[0]"]',
            space="central2",
            time="leapfrog",
        )
        assert batch(scheme, scheme.values({}), "alpha", [Fraction(1), Fraction(2)]) is None


HALF_LINE = """
title = "t"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
alpha = {{ default = 2, range = [-inf, inf] }}
[domains.R]
side = "right"
unknowns = ["u"]
{interior}
[closure]
equations = ["{closure}"]
"""
INTERIORS = {
    "lines": 'interior = ["dt(u[i]) = -(u[i] - u[i-1])"]\ntime = "forward-euler"',
    "discrete": 'interior = ["u[i, n+1] = u[i] - lam*(u[i] - u[i-1])"]',
}


@pytest.mark.parametrize("interior", INTERIORS.values(), ids=list(INTERIORS))
class TestPointsWithoutAScheme:
    @pytest.mark.parametrize(
        "closure",
        ["u[-1] = u[0]/(alpha - 1)", "(alpha - 1)*u[-1] = (alpha - 1)*u[0]", "u[-1] = (alpha - 1)/(alpha - 1)*u[0]/2"],
    )
    def test_are_flagged_and_the_others_stand(self, interior: str, closure: str) -> None:
        scheme = parse_scheme(HALF_LINE.format(interior=interior, closure=closure), "t")
        found = points(scheme, "alpha=0:2:5")
        assert [p.resolved for p in found] == [True, True, False, True, True]
        flagged = found[2]
        assert (flagged.value, flagged.lam_max, flagged.stable_set) == (1.0, None, ())
        assert "zero" in flagged.because or "degenerate" in flagged.because

    def test_a_level_that_is_not_determined_is_unstable_and_no_error(self, interior: str) -> None:
        scheme = parse_scheme(HALF_LINE.format(interior=interior, closure="(alpha - 1)*u[-1] = u[0]"), "t")
        found = points(scheme, "alpha=0:1:3")
        assert [p.lam_max for p in found] == [1.0, pytest.approx(2 / 3, rel=1e-15), 0.0]
        assert all(p.resolved for p in found)

    def test_nowhere_a_scheme_is_an_error(self, interior: str) -> None:
        scheme = parse_scheme(HALF_LINE.format(interior=interior, closure="u[-1] = u[0]/sqrt(alpha)"), "t")
        with pytest.raises(ParameterError, match="negative"):
            points(scheme, "alpha=-3:-1:4")


def test_the_number_sought_cannot_be_swept() -> None:
    scheme = catalogue.find("traditional-1")
    with pytest.raises(ParameterError, match="bound is sought"):
        points(scheme, "lam=0.1:1:3")


def test_a_zero_of_the_impedance_is_one_flagged_point() -> None:
    found = points(catalogue.find("traditional-1"), "alpha=-1:1:5")
    assert [p.resolved for p in found] == [True, True, False, True, True]


class TestSweeps:
    @pytest.mark.parametrize(
        "text",
        [
            "alpha",
            "alpha=1:2",
            "alpha=1:2:3:cubic",
            "alpha=1:2:0",
            "alpha=1:2:x",
            "alpha=1:two:3",
            "alpha=1:2:1e3",
            "alpha=-1:2:3:log",
            "alpha=0:2:3:log",
            "alpha=1:2:99999999999",
            "=1:2:3:4:5",
            "alpha=1:nan:3",
        ],
    )
    def test_refused(self, text: str) -> None:
        with pytest.raises(ParameterError) as caught:
            parse_sweep(text)
        assert caught.value.message

    def test_an_unknown_parameter(self) -> None:
        with pytest.raises(InputError, match="beta"):
            points(catalogue.find("traditional-1"), "beta=1:2:3")

    def test_ends_and_decades_are_hit_exactly(self) -> None:
        sweep = parse_sweep("alpha=1e-4:1e4:401:log")
        assert len(sweep.values) == 401
        decades = {Fraction(10) ** k for k in range(-4, 5)}
        assert decades <= {Fraction(value) for value in sweep.values}
        assert list(sweep.values) == sorted(sweep.values)

    def test_linear_points_are_exact(self) -> None:
        assert parse_sweep("a=0:1:4").values == (0, Fraction(1, 3), Fraction(2, 3), 1)

    def test_ends_beyond_the_doubles(self) -> None:
        values = [Fraction(v) for v in parse_sweep("a=1e-400:1e400:5:log").values]
        assert values == [Fraction(10) ** k for k in (-400, -200, 0, 200, 400)]


class TestForms:
    FOUND = curve(
        catalogue.find("traditional-1"), catalogue.find("traditional-1").values({}), parse_sweep("alpha=1e-2:1e2:5:log")
    )

    def test_json(self) -> None:
        data = json.loads(self.FOUND.json_text())
        assert (data["schema"], data["sweep"], len(data["points"])) == ("gks.curve/1", "alpha", 5)
        assert data["tier"] == "certified"
        keys = {"alpha", "lam_max", "limited_by", "stable_set", "error_bound", "status"}
        assert all(set(point) == keys for point in data["points"])
        last = data["points"][-1]
        assert last["stable_set"] == [[0.0, last["lam_max"]]]
        assert (last["limited_by"], last["status"]) == ("closure", "resolved")
        assert last["lam_max"] == pytest.approx(4 / 101, rel=1e-15)

    def test_csv(self) -> None:
        rows = list(csv.DictReader(io.StringIO(self.FOUND.to_csv())))
        assert list(rows[0]) == ["alpha", "lam_max", "limited_by", "error_bound"]
        assert [float(row["alpha"]) for row in rows] == pytest.approx([0.01, 0.1, 1, 10, 100])

    def test_unbounded_is_oo_and_inf(self) -> None:
        scheme = interface(WEIGHTED, "backward-euler", parameters='a="1/2"\nb="1/2"\nc=0\nd="1/2"\ne="1/2"\nf=0')
        found = curve(scheme, scheme.values({}), parse_sweep("alpha=1:1:1"))
        (point,) = found.points
        assert (point.lam_max, point.limited_by) == ("oo", None)
        assert found.to_csv().splitlines()[1].split(",")[1] == "inf"

    def test_one_point_without_a_sweep(self) -> None:
        scheme = catalogue.find("traditional-1")
        data = curve(scheme, scheme.values({"alpha": "31/9"})).to_json()
        assert data["sweep"] is None
        point = cast("list[dict[str, float]]", data["points"])[0]
        assert "alpha" not in point
        assert point["lam_max"] == 0.9
        # 9/10 is no double: the number shown is its rounding, and says so.
        assert 0 < point["error_bound"] < 2.0**-52

    def test_semi_discrete_has_no_lam_max(self) -> None:
        scheme = interface(WEIGHTED, "exact", parameters='a="1/2"\nb="1/2"\nc=0\nd="1/2"\ne="1/2"\nf=0')
        try:
            (point,) = curve(scheme, scheme.values({})).points
        except NotAnalysable:
            return
        assert point.lam_max is None
