"""What a march's agreement rests on: it can say no, it says when it could not have, and decay has no floor."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace

import numpy as np
import pytest

import gks.modes
from gks.catalogue import find
from gks.catalogue.interfaces import UNIT, closure_lines, ghost_equations, own_value, two_media
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.growth import Growth, Trace
from gks.solvers.march import March, _agrees, _nothing_claimed, _told, march, march_growth
from tests.oracle.scheme_texts import half_line, traditional


def acoustic(interior: str, order: int, values: Mapping[str, str], lam: str, c: str) -> Scheme:
    """Two acoustic half-lines of wave speeds 1 and c and equal density, coupled by interface values."""
    closure = closure_lines(ghost_equations(order, 1), values)
    media = (UNIT, ("-1", f"-({c})**2"))
    parameters = f'lam = {{ role = "cfl", default = "{lam}" }}'
    return parse_scheme(two_media("weights", parameters, interior, closure, media), "weights")


def named_half_line(space: str, time: str, flux: str, first: int, closure: Sequence[str]) -> Scheme:
    """u_t + flux u_x = 0 on x > 0 under named operators."""
    equations = ", ".join(f'"{each}"' for each in closure)
    return parse_scheme(
        f"""
title = "half-line"
[parameters]
lam = {{ role = "cfl", default = 1 }}
[interior]
space = "{space}"
time = "{time}"
[domains.R]
side = "right"
unknowns = ["u"]
flux = [["{flux}"]]
first = {first}
[closure]
equations = [{equations}]
""",
        "half-line",
    )


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

    def test_random_data_that_hardly_grow_leave_it_to_the_mode_itself(self) -> None:
        """z = 1.0045 over 128 steps is a factor 1.8: waves that leave fast hide as much."""
        values = {"u_I": f"-9/10*({own_value('L', 'u', 2)})", "s_I": "0"}
        scheme = acoustic('scheme = "lax-wendroff"', 2, values, lam="11/2000", c="100")
        found = march(scheme, scheme.values({}), steps=128)
        assert found.agrees and found.told and found.method == "from the mode"
        assert found.observed == pytest.approx(1.00454061793442, rel=1e-10)

    def test_a_mode_that_reaches_beyond_what_is_marched_is_not_denied(self) -> None:
        """abs(kappa) = 1 - 2e-4, and RK4 has three other s for this z, none of which is a mode."""
        values = {"u_I": "R.u[0] + 4/5*(L.s[0] - R.s[0])", "s_I": "1/5*R.s[0]"}
        scheme = acoustic('space = "central2"\ntime = "rk4"', 1, values, lam="7/25", c="1/100")
        found = march(scheme, scheme.values({}), steps=128)
        assert found.agrees and not found.told
        assert found.uncertainty == math.inf
        assert "reaches too far" in found.because

    def test_a_mode_that_decays_within_three_steps_is_told_from_other_data(self) -> None:
        """z = -0.0117 is R(lam s) for three s, and at two of them the vector that fits best is no mode."""
        closure = '"dt(u[0]) = -3*u[0] + 4*u[1] - 2*u[2]"'
        scheme = half_line("dt(u[i]) = (u[i-1] - u[i+1])/2", closure, first=1, time="ssprk3")
        found = march(scheme, scheme.values({"lam": "9/20"}), steps=128)
        assert found.agrees and found.told and found.method == "from the mode"

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


class TestWhatAnAgreementRestsOn:
    def test_an_interior_that_grows_is_named_beside_a_boundary_mode_that_agrees(self) -> None:
        """Forward Euler, fourth order centred, unstable at every lam; the closure has a decaying mode of its own."""
        closure = ["dt(u[0]) = 1*(u[1] - u[0])", "dt(u[-1]) = 1*(u[0] - u[-1])"]
        scheme = named_half_line("central4", "forward-euler", "-1", 1, closure)
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


class TestDecayOverHundredsOfOrders:
    """A state that falls as a whole is scaled up again: only zeros are zero."""

    @pytest.mark.parametrize("steps", [200, 1024])
    def test_the_rate_does_not_depend_on_where_doubles_end(self, steps: int) -> None:
        """Diagonal of the step: (1 - 3 lam/4)/(1 + 3 lam/4), -5/13 at lam = 3; (5/13)**1024 is 1e-425."""
        scheme = named_half_line("upwind2", "crank-nicolson", "1", 3, ["u[2] = 0*u[3]", "u[1] = 0*u[3]"])
        found = march_growth(scheme, scheme.values({"lam": 3}), steps=steps)
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
