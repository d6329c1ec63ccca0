"""Two parameters at once, lam among them, and many independent points: each against the one-point analyses."""

from __future__ import annotations

import csv
import io
import json
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gks
from gks import catalogue
from gks.bounds.allroots import all_roots
from gks.bounds.along import verdicts_along
from gks.bounds.curve import curve
from gks.bounds.curvemap import CurveMap
from gks.bounds.independent import verdicts_at
from gks.bounds.radius import RadiusMap, radius_map
from gks.bounds.sweep import parse_sweep
from gks.bounds.sweeping import swept
from gks.catalogue.interfaces import COPIED, UPWIND, closure_lines, ghost_equations, two_media
from gks.errors import NotAnalysable, ParameterError
from gks.modes.analysis import analyse, quick_verdict
from gks.modes.verdict import ModeKind, Reason, Verdict
from gks.scheme.schemefile import parse_scheme
from tests.bounds.theorem_schemes import APART, upwind_flux
from tests.examples import examples
from tests.literature.closures import CLOSURES, half_line

WEIGHTED = parse_scheme(
    two_media(
        "two weights",
        'lam = { role = "cfl", default = 0.9 }\nalpha = 2\nbeta = 1',
        UPWIND,
        closure_lines(ghost_equations(1), {"u_I": "(beta*L.u[0] + R.u[0])/(1 + beta)", "s_I": "R.s[0]"}),
    ),
    "weighted",
)


def lax_wendroff(scheme: str = "lax-wendroff") -> gks.scheme.model.Scheme:
    """The traditional coupling with a named interior of second order; its closure repeats the interface value."""
    closure = closure_lines(ghost_equations(1, {"lax-wendroff": 1, "fromm": 2}[scheme], COPIED, COPIED))
    parameters = 'lam = { role = "cfl", default = "9/10" }\nalpha = 2'
    return parse_scheme(two_media(f"{scheme} interface", parameters, f'scheme = "{scheme}"', closure), scheme)


class TestMapOfLamMax:
    FOUND = swept(WEIGHTED, WEIGHTED.values({}), [parse_sweep("alpha=1:100:4:log"), parse_sweep("beta=0.5:2:3")])

    def test_a_row_is_the_curve_at_its_value(self) -> None:
        assert isinstance(self.FOUND, CurveMap)
        assert self.FOUND.lam_max.shape == (4, 3)
        for value, row in zip(self.FOUND.sweeps[0].values, self.FOUND.rows, strict=True):
            alone = curve(WEIGHTED, {**WEIGHTED.values({}), "alpha": Fraction(value)}, self.FOUND.sweeps[1])
            assert list(row) == list(alone.points)

    def test_json_points_carry_both_parameters(self) -> None:
        assert isinstance(self.FOUND, CurveMap)
        data = json.loads(self.FOUND.json_text())
        assert (data["schema"], data["sweep"], len(data["points"])) == ("gks.curve/1", ["alpha", "beta"], 12)
        keys = {"alpha", "beta", "lam_max", "limited_by", "stable_set", "error_bound", "status"}
        assert all(set(point) == keys for point in data["points"])
        assert [point["beta"] for point in data["points"][:4]] == [0.5, 1.25, 2.0, 0.5]

    def test_csv(self) -> None:
        assert isinstance(self.FOUND, CurveMap)
        rows = list(csv.DictReader(io.StringIO(self.FOUND.to_csv())))
        assert list(rows[0]) == ["alpha", "beta", "lam_max", "limited_by", "error_bound"]
        assert [float(row["lam_max"]) for row in rows] == self.FOUND.lam_max.ravel().tolist()

    def test_from_python(self) -> None:
        found = gks.load("traditional-1").curve(alpha=[1, 9], lam=[0.5, 0.75])
        assert isinstance(found, RadiusMap)
        assert found.verdict.tolist() == [["stable", "stable"], ["unstable", "unstable"]]
        assert "<svg" in found._repr_svg_()

    @pytest.mark.parametrize(
        "specs", [["alpha=1:2:2", "alpha=1:2:2"], ["alpha=1:2:2", "beta=1:2:2", "lam=0.1:1:2"], ["gamma=1:2:2"]]
    )
    def test_sweeps_that_make_no_sense(self, specs: list[str]) -> None:
        with pytest.raises(ParameterError):
            swept(WEIGHTED, WEIGHTED.values({}), [parse_sweep(spec) for spec in specs])


class TestModuli:
    """The largest modulus of a mode in doubles, against the exact analysis."""

    @pytest.mark.parametrize(
        "name", ["traditional-1", "traditional-2", "weighted-2", "implicit-1", "average-1", "weighted-2-unequal"]
    )
    def test_interfaces(self, name: str) -> None:
        scheme = catalogue.find(name)
        found = radius_map(scheme, scheme.values({}), parse_sweep("alpha=1e-2:1e2:5:log"), [0.05, 0.4, 0.99, 1.2])
        assert found.known.all()
        self.agrees(found)

    @pytest.mark.parametrize("interior", ["lax-wendroff", "lax-friedrichs", "leapfrog", "backward-euler"])
    @pytest.mark.parametrize("closure", ["space-1", "oblique-2", "one-sided"])
    def test_half_lines(self, interior: str, closure: str) -> None:
        self.agrees(radius_map(half_line(interior, CLOSURES[closure]), {}, None, [0.05, 0.4, 0.9, 1.7]))

    @pytest.mark.parametrize("interior", ["lax-wendroff", "lax-friedrichs", "backward-euler", "leapfrog"])
    @pytest.mark.parametrize("closure", ["space-0", "space-2", "oblique-1", "one-sided", "box"])
    def test_tiny_lam_where_delta_is_tiny_at_what_is_no_mode(self, interior: str, closure: str) -> None:
        """Delta = (1 - kappa)**3 of a decaying solution is 1e-18 at lam = 1e-6: z = 1 is no mode of modulus 1."""
        found = radius_map(half_line(interior, CLOSURES[closure]), {}, None, [1e-8, 1e-6, 1e-4, 1e-2])
        assert found.known[0, -1]
        self.agrees(found)

    @pytest.mark.parametrize("interior", ["lax-wendroff", "leapfrog", "crank-nicolson"])
    def test_nearly_multiple_roots(self, interior: str) -> None:
        """(1 - 2 kappa)(1 - c kappa)(1 + kappa/2) with 1/c next to 1/2, and a triple kappa."""
        for c in ("2 + 1/1000", "2 + 1/1000000", "2 + 1/1000000000", "2"):
            third = "2" if c == "2" else "-1/2"
            one, two, three = f"2 + ({c}) + ({third})", f"2*({c}) + (2 + ({c}))*({third})", f"2*({c})*({third})"
            closure = f"u[0] = ({one})*u[1] - ({two})*u[2] + ({three})*u[3]"
            self.agrees(radius_map(half_line(interior, closure), {}, None, [1e-6, 0.01, 0.3, 0.9]))

    def test_ratios_of_eight_orders(self) -> None:
        for name in ("traditional-2", "average-1"):
            scheme = catalogue.find(name)
            found = radius_map(scheme, scheme.values({}), parse_sweep("alpha=1e-8:1e8:9:log"), [1e-6, 0.4, 0.9])
            assert found.known.all()
            self.agrees(found)

    def test_a_mode_where_fewer_solutions_decay_than_outside_the_circle(self) -> None:
        lams = [0.05, 0.3, 0.45, 0.9]
        found = radius_map(APART, {}, None, lams)
        assert found.known[0, 0] and found.known[0, -1]
        for k, lam in enumerate(lams):
            modes = analyse(APART, {"lam": Fraction(lam)}).modes
            largest = max((float(m.modulus) for m in modes if m.kind is not ModeKind.INADMISSIBLE), default=0.0)
            assert not found.known[0, k] or found.radius[0, k] == pytest.approx(largest)

    def test_a_wide_stencil_is_analysed_point_by_point(self) -> None:
        scheme = catalogue.find("lax-wendroff-order-8-oblique")
        found = radius_map(scheme, scheme.values({}), None, [0.4, 0.8, 1.2])
        assert found.verdict.tolist() == [["stable", "stable", "unstable"]]

    @pytest.mark.parametrize("speed", ["a", "lam - a", "1 - 2*lam + a/9"])
    @pytest.mark.parametrize("closure", ["u[0]", "u[1]/2", "3*u[1]"])
    def test_upwinding_turns_round_where_a_speed_changes_its_sign(self, speed: str, closure: str) -> None:
        found = radius_map(upwind_flux(speed, closure), {}, parse_sweep("a=-2:2:7"), [0.5, 0.125, 0.25, 0.625, 0.75])
        assert "stable" in found.verdict
        self.agrees(found)

    def agrees(self, found: RadiusMap) -> None:
        scheme = found.scheme
        for i, value in enumerate(found.values):
            for k, lam in enumerate(found.lams):
                at = {**found.parameters, scheme.cfl: Fraction(float(lam))}
                if found.sweep is not None:
                    at[found.sweep.name] = Fraction(found.sweep.values[i])
                    assert float(found.sweep.values[i]) == value
                exact = analyse(scheme, at)
                reason: Reason | None = exact.reason
                assert found.interior[i, k] == (reason != "interior")
                if found.interior[i, k] and found.known[i, k]:
                    kept = [float(m.modulus) for m in exact.modes if m.kind is not ModeKind.INADMISSIBLE]
                    assert found.radius[i, k] == pytest.approx(max(kept, default=0.0), rel=1e-7)
                shown = found.verdict[i, k]
                assert shown == "near" or (shown == "stable") == (exact.verdict is Verdict.STABLE)


class TestIndependentPoints:
    @pytest.mark.parametrize("name", ["lax-wendroff", "fromm"])
    def test_against_the_exact_verdict(self, name: str) -> None:
        scheme = lax_wendroff(name)
        draw = np.random.default_rng(7)
        alpha, lam = 10 ** draw.uniform(-2, 2, 25), draw.uniform(0.05, 1.1, 25)
        found = verdicts_at(scheme, scheme.values({}), {"alpha": alpha, "lam": lam})
        assert found.resolved.mean() > 0.9
        assert (found.interior == (lam < 1)).all()
        for k in np.flatnonzero(found.resolved & found.interior):
            at = {"alpha": Fraction(alpha[k]), "lam": Fraction(lam[k])}
            assert found.stable[k] == (quick_verdict(scheme, at) is Verdict.STABLE)

    def test_next_to_neutral_nothing_is_said(self) -> None:
        """Neutral at alpha = 3 for every lam < 1."""
        scheme = lax_wendroff()
        alpha = np.array([3 - 1e-9, 3.0, 3 + 1e-9, 2.9, 3.1])
        found = verdicts_at(scheme, scheme.values({}), {"alpha": alpha, "lam": np.full(5, 0.9)})
        assert found.resolved.tolist() == [False, False, False, True, True]
        assert found.stable.tolist()[3:] == [True, False]

    def test_along_one_parameter_the_critical_value_comes_first(self) -> None:
        scheme = lax_wendroff()
        found = verdicts_along(scheme, scheme.values({"lam": "9/10"}), "alpha", Fraction(1, 100), Fraction(100))
        assert found.critical == pytest.approx([3.0], rel=1e-12)
        assert found.verdicts == (Verdict.STABLE, Verdict.UNSTABLE)
        points = np.array([0.5, 2.999, 3.0, 3.001])
        assert found.at(points) == [Verdict.STABLE, Verdict.STABLE, Verdict.UNDECIDED, Verdict.UNSTABLE]

    @pytest.mark.parametrize("interior", ["lax-wendroff", "lax-friedrichs", "backward-euler"])
    @pytest.mark.parametrize("closure", ["u[0] = p*u[1] - (p - 1)*u[2]", "u[0, n+1] = p*u[1] - (p - 1)*u[0]"])
    @pytest.mark.parametrize("lam", ["1/2", "1/1000000"])
    def test_next_to_a_critical_value_nothing_wrong_is_said(self, interior: str, closure: str, lam: str) -> None:
        """Critical values 0 and -2e-6 among them, known to 1e-10 only at the small lam."""
        plain = half_line(interior, "u[0] = u[1]").text
        text = plain.replace('default = "1/2" }', 'default = "1/2" }\np = "7/9"').replace("u[0] = u[1]", closure)
        scheme = parse_scheme(text, "one parameter")
        values = scheme.values({"lam": lam})
        found = verdicts_along(scheme, values, "p", Fraction(-3), Fraction(5))
        assert found.critical
        distances = (0.0, 1e-16, 1e-13, 1e-11, 1e-10, 1e-9, 1e-6)
        points = [c + side * d for c in found.critical for d in distances for side in (-1, 1)]
        told = found.at(np.array(points))
        for point, verdict in zip(points, told, strict=True):
            if verdict is not Verdict.UNDECIDED:
                assert verdict is quick_verdict(scheme, {**values, "p": Fraction(point)})
        assert Verdict.UNDECIDED not in found.at(np.array([c + 1e-8 for c in found.critical]))
        assert found.at(np.array(found.critical)) == [Verdict.UNDECIDED] * len(found.critical)

    def test_a_speed_that_changes_its_sign_with_lam_is_refused(self) -> None:
        with pytest.raises(NotAnalysable, match="changes its sign with lam"):
            verdicts_at(upwind_flux("1 - 2*lam"), {}, {"lam": np.array([0.25, 0.75])})

    def test_a_parameter_of_the_interior_is_refused(self) -> None:
        scheme = catalogue.find("weighted-2-unequal")
        name = next(p.name for p in scheme.parameters if p.role != "cfl" and p.name != "alpha")
        with pytest.raises(NotAnalysable):
            verdicts_along(scheme, scheme.values({}), name, Fraction(1, 2), Fraction(2))


@given(st.lists(st.complex_numbers(min_magnitude=1e-3, max_magnitude=1e3), min_size=1, max_size=5))
@examples(60)
def test_roots_in_batches_leave_a_residual_of_rounding_size(roots: list[complex]) -> None:
    coefficients = np.polynomial.polynomial.polyfromroots(roots)[None, :]
    found = all_roots(coefficients.astype(complex))
    assert found.shape == (1, len(roots))
    for x in found[0]:
        terms = np.abs(coefficients[0]) * np.abs(x) ** np.arange(len(roots) + 1)
        assert abs(np.polynomial.polynomial.polyval(x, coefficients[0])) <= 1e-9 * terms.sum()
