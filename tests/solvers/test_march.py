"""Marches of whole schemes: against the finite matrix, against the normal modes, and in the traps.

What an agreement rests on is in `test_march_evidence`.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gks.catalogue import find
from gks.errors import NotAnalysable, ParameterError
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.march import forced_response, march, march_growth, mode_march
from gks.solvers.problem import build
from tests.examples import examples
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
    @examples(12)
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
    @examples(10)
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

    def test_a_weight_of_1e300_is_marched_as_far_as_doubles_go(self) -> None:
        """The growth is 1e100 a step; where squares of the equations overflow, the march says so or leaves it open."""
        text = find("beam-warming-inverse-3-1").text
        scheme = parse_scheme(text.replace("5/8*u[2]", "5/8e-300*u[2]"), "heavy")
        result = march(scheme, scheme.values({}))
        assert result.agrees
        assert result.observed > 1e90

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
