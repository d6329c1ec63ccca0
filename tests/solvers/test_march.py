"""Marches of whole schemes: against the finite matrix, against the normal modes, and in the traps."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import gks.modes
from gks.catalogue import find
from gks.errors import NotAnalysable, ParameterError
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.growth import Growth, Trace
from gks.solvers.march import (
    March,
    _agrees,
    _nothing_claimed,
    _told,
    forced_response,
    march,
    march_growth,
    mode_march,
)
from gks.solvers.problem import build
from tests.oracle.finite_matrix import growing_modulus
from tests.oracle.scheme_texts import BACKWARD_CENTRED, CRANK_NICOLSON, LEAPFROG, half_line, traditional, weighted

WEIGHTS = st.tuples(*[st.integers(-20, 20).map(lambda k: Fraction(k, 10)) for _ in range(6)])
WEIGHTED = {time: weighted(time) for time in ("forward-euler", "backward-euler", "rk4", "ab2")}
LAM = dict.fromkeys(WEIGHTED, "0.6") | {"ab2": "0.4"}
"""Below the interior's own limit (1/2 for ab2): what grows inside and is carried off is no eigenvalue of the matrix."""


def weighted_values(scheme: Scheme, weights: tuple[Fraction, ...], lam: str) -> dict[str, Fraction]:
    return scheme.values(dict(zip("abcdef", weights, strict=True)) | {"lam": lam, "alpha": "2"})


class TestAgainstTheFiniteMatrix:
    """No normal mode analysis: growth of random data is the spectral radius of one step, where that exceeds 1."""

    @pytest.mark.parametrize("time", WEIGHTED)
    @given(weights=WEIGHTS)
    @settings(max_examples=12)
    def test_random_interface_weights(self, time: str, weights: tuple[Fraction, ...]) -> None:
        scheme = WEIGHTED[time]
        values = weighted_values(scheme, weights, LAM[time])
        modulus = growing_modulus(scheme, values)
        assume(modulus is not None and modulus > 1.05)
        assert modulus is not None
        found = march_growth(scheme, values, steps=256).growth
        assert abs(found.rate - modulus) <= max(found.uncertainty, 1e-3 * modulus)
        assert found.exceeds(1.0)

    def test_modes_found_from_their_z_march_with_it(self) -> None:
        scheme = traditional()
        values = scheme.values({"alpha": 5})
        # 4 r**2 - 4 r + alpha + 1 = 0, z = 1 + lam (r - 1): Theorem 3.1, derived by hand.
        z = 1 + 0.9 * (complex(1, math.sqrt(5)) / 2 - 1)
        found = mode_march(build(scheme, values), z)
        assert found is not None
        assert found.z == pytest.approx(z, rel=1e-9)
        assert found.growth.rate == pytest.approx(abs(z), rel=1e-9)
        assert found.start.outside < 1e-6

    def test_a_wrong_z_is_not_marched_as_if_it_were_right(self) -> None:
        """Off by 5 %: inverse iteration converges to what is there, or to nothing near the boundary."""
        scheme = traditional()
        problem = build(scheme, scheme.values({"alpha": 5}))
        wrong = 1.05 * (1 + 0.9 * (complex(1, math.sqrt(5)) / 2 - 1))
        found = mode_march(problem, wrong)
        assert found is None or abs(found.growth.rate - abs(wrong)) > 1e-2


class TestAgainstTheNormalModes:
    """Predicted beside observed."""

    @pytest.mark.parametrize("alpha", ["3.2", "3.41", "31/9", "3.5", "5", "1e10"])
    def test_traditional_coupling_around_its_neutral_ratio(self, alpha: str) -> None:
        scheme = find("traditional-1")
        values = scheme.values({"lam": "0.9", "alpha": alpha})
        found = march(scheme, values)
        r = complex(1, math.sqrt(float(values["alpha"]))) / 2
        assert found.predicted == pytest.approx(abs(1 + 0.9 * (r - 1)), rel=1e-12)
        assert found.agrees and found.relative_difference is not None and found.relative_difference < 1e-9

    @pytest.mark.parametrize("alpha", ["1", "1e-10"])
    def test_nothing_is_claimed_where_no_mode_is_admissible(self, alpha: str) -> None:
        scheme = find("traditional-1")
        found = march(scheme, scheme.values({"alpha": alpha}))
        assert found.predicted is None and found.relative_difference is None
        assert found.agrees and found.observed < 1

    @given(weights=WEIGHTS, implicit=st.booleans())
    @settings(max_examples=10)
    def test_random_interface_weights(self, weights: tuple[Fraction, ...], implicit: bool) -> None:
        scheme = WEIGHTED["backward-euler" if implicit else "forward-euler"]
        values = weighted_values(scheme, weights, "0.7")
        try:
            found = march(scheme, values, steps=256)
        except NotAnalysable as refused:
            assert "do not determine" in str(refused)
            return
        assert found.agrees, str(found)

    def test_a_neutral_eigenvalue_is_not_told_from_one(self) -> None:
        """Backward Euler, centred, lam = 3/2: z = -1 with abs(kappa) = 1/3."""
        scheme = half_line(BACKWARD_CENTRED, '"u[0, n+1] = u[0] + lam*(u[1] - u[0])"', 1)
        for lam, modulus in (("1.4", 0.8), ("1.5", 1.0), ("1.6", 1.2)):
            found = march(scheme, scheme.values({"lam": lam}))
            assert found.observed == pytest.approx(modulus, rel=1e-9)
            assert found.agrees
            assert ("cannot tell" in found.remark) == (lam == "1.5")


class TestGeneralized:
    """Leapfrog with space extrapolation: bounded under random data, linear growth when forced by (-1)**n."""

    EXTRAPOLATED = half_line(LEAPFROG, '"u[0, n+1] = u[1, n+1]"', 1)
    LAGGED = half_line(LEAPFROG, '"u[0, n+1] = u[1]"', 1)

    def test_random_data_do_not_show_it(self) -> None:
        found = march_growth(self.EXTRAPOLATED, self.EXTRAPOLATED.values({}))
        assert found.growth.rate == pytest.approx(1.0, abs=1e-4)
        assert np.exp(found.trace.log_sizes()).max() < 20

    def test_forcing_at_its_z_does(self) -> None:
        values = self.EXTRAPOLATED.values({})
        assert forced_response(self.EXTRAPOLATED, values, -1).exponent == pytest.approx(1.0, abs=0.05)
        assert forced_response(self.EXTRAPOLATED, values, 0.6 + 0.8j).exponent == pytest.approx(0.0, abs=0.05)

    def test_the_closure_that_looks_alike_stays_bounded(self) -> None:
        assert forced_response(self.LAGGED, self.LAGGED.values({}), -1).exponent == pytest.approx(0.0, abs=0.05)

    def test_march_says_so(self) -> None:
        found = march(self.EXTRAPOLATED, self.EXTRAPOLATED.values({}))
        assert found.predicted == pytest.approx(1.0) and found.agrees
        assert "forced at z" in found.remark

    def test_crank_nicolson_does_not_grow_where_its_finite_matrix_does(self) -> None:
        scheme = half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1]"', 1)
        found = march_growth(scheme, scheme.values({"lam": "2.1"})).growth
        assert not found.exceeds(1.0 + 1e-5) and found.uncertainty < 1e-3


class TestAgreement:
    """`agrees` can say no, and says why."""

    @staticmethod
    def random(rate: float, uncertainty: float = 0.01, steps: int = 1000) -> March:
        return March(Growth(rate, uncertainty, "random"), Trace(np.ones((2, 1)), np.zeros(2)), (9, 9), steps)

    def test_a_difference_beyond_the_uncertainty(self) -> None:
        assert _agrees(1.2, Growth(1.2005, 1e-6, ""), self.random(0.9))[0]
        agrees, why = _agrees(1.2, Growth(1.21, 1e-6, ""), self.random(0.9))
        assert not agrees and "differ by" in why
        assert _agrees(1.2, Growth(1.21, 0.02, ""), self.random(0.9))[0]

    def test_different_sides_of_the_circle_never_agree(self) -> None:
        agrees, why = _agrees(0.9998, Growth(1.0003, 1e-6, ""), self.random(0.9))
        assert not agrees and "different sides" in why

    def test_random_data_must_not_outgrow_the_prediction(self) -> None:
        agrees, why = _agrees(0.9, Growth(0.9, 1e-9, ""), self.random(1.1))
        assert not agrees and "faster than any mode" in why
        assert _agrees(0.9, Growth(0.9, 1e-9, ""), self.random(1.1, 0.2))[0]

    def test_growth_too_slow_for_the_march_to_tell_from_a_transient(self) -> None:
        assert _nothing_claimed(self.random(1.0005, 1e-6, steps=1000), interior=False)[0]
        assert not _nothing_claimed(self.random(1.0005, 1e-6, steps=10000), interior=False)[0]
        assert _nothing_claimed(self.random(1.5), interior=True)[0]

    def test_fast_waves_beside_slow_ones_are_no_growth(self) -> None:
        """Speeds 1 : 1e4, so that a thousand steps are a tenth of the slow side's time scale."""
        scheme = find("weighted-1-unequal")
        assert march(scheme, scheme.values({"c": "1e4", "lam": "9e-5"})).agrees

    @pytest.mark.parametrize(
        ("modes", "agrees"),
        [
            ([], False),  # an analysis that overlooks the growing mode
            ([(1.3, "growing")], False),  # one that misplaces it
            ([(0.7, "decaying")], False),  # one that sees another instead
            ([(1.1467344941179716, "growing"), (2.0, "inadmissible")], True),
        ],
    )
    def test_a_wrong_analysis_is_caught(
        self, monkeypatch: pytest.MonkeyPatch, modes: list[tuple[float, str]], agrees: bool
    ) -> None:
        z = (1 + 0.9 * (complex(1, math.sqrt(5)) / 2 - 1)) / 1.1467344941179716
        listed = [SimpleNamespace(z_complex=m * z, modulus=m, kind=SimpleNamespace(value=k)) for m, k in modes]
        monkeypatch.setattr(gks.modes, "analyse", lambda scheme, values: SimpleNamespace(modes=listed, reason=None))
        scheme = traditional()
        found = march(scheme, scheme.values({"alpha": 5}), steps=256)
        assert found.agrees is agrees
        assert ("DISAGREES" in str(found)) is not agrees


class TestHistory:
    """What a march saw, as plain numbers to draw."""

    def test_a_growing_mode_in_random_data(self) -> None:
        scheme = traditional()
        found = march(scheme, scheme.values({"alpha": 5}), steps=256)
        history = found.history
        assert (history.name, history.growth.rate) == ("random data", found.observed)
        assert len(history.log_sizes) == found.steps + 1
        assert history.line is not None
        c, slope = history.line
        assert slope == pytest.approx(math.log(found.observed))
        assert found.predicted == pytest.approx(math.exp(slope), rel=1e-9)
        first, last = history.growth.window
        assert 0 < first < last == 256
        assert max(abs(history.log_sizes[n] - c - slope * n) for n in range(first, last + 1)) < 1.0

    def test_a_decaying_mode_is_marched_by_itself_and_random_data_beside_it(self) -> None:
        scheme = find("traditional-1")
        found = march(scheme, scheme.values({"lam": "0.9", "alpha": "3.2"}), steps=256)
        assert [history.name for history in found.histories] == ["from the mode", "random data"]
        assert found.history.line is not None and found.history.line[1] < 0

    def test_a_forced_response(self) -> None:
        scheme = TestGeneralized.EXTRAPOLATED
        found = march(scheme, scheme.values({}), steps=256)
        forced = found.histories[-1]
        assert forced.name == "forced at z" and forced.line is None
        assert forced.log_sizes[-1] - forced.log_sizes[len(forced.log_sizes) // 2] == pytest.approx(
            math.log(2), rel=0.1
        )


class TestInsideTheCurveOfTheWaves:
    """There every z is an eigenvalue of a truncated matrix but for rounding; the half-line's own mode is the observed
    one.
    """

    @pytest.mark.parametrize("name", ["lax-wendroff-oblique-2", "lax-wendroff-order-4-oblique"])
    def test_oblique_extrapolation(self, name: str) -> None:
        """u = kappa**(j + n) with kappa = z, where P(z, z) = 0: 1/5 at second order, lam = 1/2."""
        scheme = find(name)
        found = march(scheme, scheme.values({}))
        assert found.agrees and found.method == "from the mode"
        assert found.relative_difference is not None and found.relative_difference < 1e-9

    def test_a_wrong_z_is_no_mode_there(self) -> None:
        scheme = find("lax-wendroff-oblique-2")
        found = mode_march(build(scheme, scheme.values({})), 0.25)
        assert found is None or abs(found.growth.rate - 0.25) > 1e-2


IMPLICIT_OUTFLOW = """
title = "implicit outflow"
[parameters]
lam = { role = "cfl", default = "3" }
[interior]
space = "upwind2"
time = "crank-nicolson"
[domains.A]
side = "right"
unknowns = ["u"]
flux = [["1"]]
first = 3
[closure]
equations = ["u[2] = 0*u[3]", "u[1] = 0*u[3]"]
"""


class TestDecayOverHundredsOfOrders:
    """A state that falls as a whole is scaled up again: only zeros are zero."""

    @pytest.mark.parametrize("steps", [200, 1024])
    def test_the_rate_does_not_depend_on_where_doubles_end(self, steps: int) -> None:
        """Diagonal of the step: (1 - 3 lam/4)/(1 + 3 lam/4), -5/13 at lam = 3; (5/13)**1024 is 1e-425."""
        scheme = parse_scheme(IMPLICIT_OUTFLOW, "implicit outflow")
        found = march_growth(scheme, scheme.values({}), steps=steps)
        assert abs(found.growth.rate - 5 / 13) <= found.growth.uncertainty < 0.01
        assert found.steps == steps
        last = found.trace.log_sizes()[-1]
        assert last == pytest.approx(steps * math.log(5 / 13), abs=0.1 * steps)

    def test_a_fall_by_more_than_the_ceiling_in_one_step(self) -> None:
        scheme = half_line("u[i, n+1] = 10**-130*u[i]", '"u[-1] = 0*u[0]"')
        found = march_growth(scheme, scheme.values({}), steps=40)
        assert found.trace.log_sizes()[-1] == pytest.approx(-40 * 130 * math.log(10), rel=1e-3)

    def test_what_is_zero_after_a_few_steps_stays_zero(self) -> None:
        """u[i, n+1] = u[i+1]: all of it has left after as many steps as it filled cells."""
        scheme = half_line("u[i, n+1] = u[i+1]", '"u[-1] = 0*u[0]"')
        found = march_growth(scheme, scheme.values({}))
        assert (found.growth.rate, found.growth.uncertainty) == (0.0, 0.0)


class TestWhatAnAgreementRestsOn:
    def test_an_interior_that_grows_is_named_beside_a_boundary_mode_that_agrees(self) -> None:
        """Forward Euler, fourth order centred, unstable at every lam; the closure has a decaying mode of its own."""
        text = """
title = "unstable interior"
[parameters]
lam = { role = "cfl", default = "1" }
[interior]
space = "central4"
time = "forward-euler"
[domains.A]
side = "right"
unknowns = ["u"]
flux = [["-1"]]
first = 1
[closure]
equations = ["dt(u[0]) = 1*(u[1] - u[0])", "dt(u[-1]) = 1*(u[0] - u[-1])"]
"""
        scheme = parse_scheme(text, "unstable interior")
        found = march(scheme, scheme.values({}), steps=256)
        assert found.agrees and found.predicted is not None and found.predicted < 1
        assert any(line.startswith("interior ") and "not Cauchy-stable" in line for line in str(found).splitlines())
        assert "not Cauchy-stable" in str(found.to_json()["because"])

    def test_a_stable_interior_is_not_mentioned(self) -> None:
        found = march(traditional(), traditional().values({"alpha": 5}), steps=256)
        assert found.told and "interior" not in str(found)

    def test_a_program_can_tell_an_agreement_from_the_lack_of_a_contradiction(self) -> None:
        scheme = traditional()
        resolved = march(scheme, scheme.values({"alpha": 1})).to_json()
        too_short = march(scheme, scheme.values({"alpha": 1}), steps=1).to_json()
        assert (resolved["agrees"], resolved["told"]) == (True, True)
        assert (too_short["agrees"], too_short["told"]) == (True, False)
        assert "cannot tell" in str(too_short["because"])

    def test_the_uncertainty_must_resolve_the_rate(self) -> None:
        assert _told(1.2, Growth(1.2, 1e-4, ""), 1000, interior=False)
        assert not _told(1.2, Growth(1.2, 0.1, ""), 1000, interior=False)
        assert _told(None, Growth(0.9, 0.05, ""), 1000, interior=False)
        assert not _told(None, Growth(0.9, 0.2, ""), 1000, interior=False)
        assert not _told(None, Growth(1.0005, 1e-6, ""), 1000, interior=False)
        assert _told(None, Growth(1.5, 0.1, ""), 1000, interior=True)
        assert not _told(None, Growth(0.9, 0.01, ""), 1000, interior=True)


class TestSizes:
    @pytest.mark.parametrize("sizes", [{"cells": 10**8}, {"steps": 10**8}, {"cells": 200_000, "steps": 10**8}])
    def test_a_huge_march_is_refused(self, sizes: dict[str, int]) -> None:
        with pytest.raises(NotAnalysable, match=r"room for|reach farther|ten minutes"):
            march_growth(traditional(), traditional().values({}), **sizes)

    def test_a_single_step_tells_nothing_and_says_so(self) -> None:
        found = march(traditional(), traditional().values({"alpha": 1}), steps=1)
        assert found.uncertainty == math.inf and "cannot tell" in found.remark

    def test_the_march_is_cut_short_where_the_far_ends_would_be_felt(self) -> None:
        scheme = traditional()
        found = march_growth(scheme, scheme.values({"alpha": 5}), cells=100, steps=5000)
        assert max(found.cells) == 100 and 100 < found.steps < 260

    def test_too_few_cells_for_one_step(self) -> None:
        scheme = half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1]"', 1)
        with pytest.raises(NotAnalysable, match="far ends are felt"):
            march_growth(scheme, scheme.values({"lam": "1e6"}), cells=20)

    @pytest.mark.parametrize("lam", ["1e-8", "1", "0.9"])
    @pytest.mark.parametrize("alpha", ["1e-300", "1e-10", "1", "1e10", "1e140"])
    def test_extreme_values_are_finite_or_refused(self, lam: str, alpha: str) -> None:
        scheme = traditional()
        found = march_growth(scheme, scheme.values({"lam": lam, "alpha": alpha}), steps=64).growth
        assert math.isfinite(found.rate)
        if alpha == "1e140":
            # r = (1 + i sqrt(alpha))/2: abs(z) = lam sqrt(alpha)/2 to rounding.
            assert found.rate == pytest.approx(float(Fraction(lam)) * 0.5e70, rel=1e-6)

    @pytest.mark.parametrize("sizes", [{"cells": 0}, {"steps": 0}, {"cells": -5}])
    def test_no_cells_or_steps(self, sizes: dict[str, int]) -> None:
        with pytest.raises(ParameterError, match="at least one"):
            march_growth(traditional(), traditional().values({}), **sizes)

    def test_growth_beyond_doubles_in_one_step_is_refused(self) -> None:
        scheme = half_line("u[i, n+1] = u[i] + 10**200*u[i-1]", '"u[-1] = 10**200*u[0]"')
        with pytest.raises(NotAnalysable, match="passes the largest double"):
            march_growth(scheme, scheme.values({}), steps=10)


class TestOutput:
    def test_json_has_the_keys_of_the_contract_and_no_nan(self) -> None:
        scheme = traditional()
        found = march(scheme, scheme.values({"alpha": 5}), steps=64)
        text = json.dumps(found.to_json(), allow_nan=False)
        assert list(json.loads(text)) == [
            "schema", "predicted", "observed", "uncertainty", "relative_difference", "agrees", "time_s",
            "told", "because",
        ]  # fmt: skip
        assert json.loads(text)["schema"] == "gks.march/1"
        unbounded = replace(found, uncertainty=math.inf)
        assert unbounded.to_json()["uncertainty"] == "oo"

    def test_same_seed_same_march(self) -> None:
        scheme = traditional()
        values = scheme.values({"alpha": 5})
        first, second = march_growth(scheme, values, steps=64), march_growth(scheme, values, steps=64)
        assert first.growth == second.growth
        assert march_growth(scheme, values, steps=64, seed=1).trace.values[0] != pytest.approx(first.trace.values[0])
