"""Systems that no basis separates: one scalar field, crossing branches, and what a double root on the circle may be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.bounds.cfl import stable_set
from gks.errors import InputError, NotAnalysable, SchemeError
from gks.modes import characteristic
from gks.modes.admissible import Candidate, admissible, crossing_slopes, point_of
from gks.modes.algebraic import Position, Root
from gks.modes.analysis import analyse, eliminated
from gks.modes.candidates import candidates_of
from gks.modes.coupled import CoupledField
from gks.modes.crossing import modes_at
from gks.modes.fibre import fibre
from gks.modes.interior import interior_stability
from gks.modes.kreiss import NormalModeProblem, normal_mode_problem, spatial_problem
from gks.modes.undecided import Undecided
from gks.modes.verdict import ModesResult, Verdict
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from tests.examples import examples
from tests.oracle.finite_matrix import growing_modulus


def half_line(
    interior: Sequence[str], closure: Sequence[str], time: str = "", side: str = "right", unknowns: str = "us"
) -> Scheme:
    extra = f'time = "{time}"' if time else ""
    return parse_scheme(
        f"""
title = "half-line"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
[domains.R]
side = "{side}"
unknowns = {list(unknowns)}
interior = {list(interior)}
{extra}
[closure]
equations = {list(closure)}
""".replace("'", '"'),
        "half-line",
    )


YEE = ("u[i, n+1] = u[i] + lam*(s[i+1] - s[i])", "s[i, n+1] = s[i] + lam*(u[i, n+1] - u[i-1, n+1])")
"""The staggered scheme for u_t = s_x, s_t = u_x, leapfrog in time: u at points, s between them."""


def judged(scheme: Scheme, **values: str) -> ModesResult:
    return analyse(scheme, scheme.values(values))


def problem_of(scheme: Scheme) -> NormalModeProblem:
    problem = normal_mode_problem(scheme, scheme.values({}))
    assert problem.coupled
    return problem


class TestStaggeredScheme:
    """D = (z - 1)**2 x - lam**2 z (x - 1)**2; a wave into the half-line has u = -s, one out of it u = s."""

    @pytest.mark.parametrize(
        ("closure", "verdict"),
        [
            ("u[-1] = 0*u[0]", Verdict.STABLE),  # a wall conserves the energy of the scheme
            ("u[-1] = s[0]", Verdict.STABLE),  # what goes out meets itself
            ("u[-1] = -s[0]", Verdict.GENERALIZED),  # a constant wave comes in from nowhere, z = kappa = 1
            ("u[-1] = u[0]", Verdict.GENERALIZED),
            ("u[-1, n+1] = u[0]", Verdict.GENERALIZED),
            ("u[-1] = -u[0]", Verdict.GENERALIZED),  # kappa = -1 has no group velocity
            ("u[-1, n+1] = 2*u[0]", Verdict.UNSTABLE),
        ],
    )
    def test_closures(self, closure: str, verdict: Verdict) -> None:
        scheme = half_line(YEE, [closure])
        assert judged(scheme).verdict is verdict
        left = half_line(mirrored(YEE), mirrored([closure]), side="left")
        assert judged(left).verdict is verdict

    def test_the_wall_is_stable_up_to_the_interiors_own_limit(self) -> None:
        scheme = half_line(YEE, ["u[-1] = 0*u[0]"])
        found = stable_set(scheme, scheme.values({}))
        assert [(i.low, i.high) for i in found.intervals] == [(None, Root.of(1))]
        assert found.limited_by == "interior"
        # At lam = 1 the wave kappa = -1 has z = -1 twice with one eigenvector: it grows like n.
        assert judged(scheme, lam="1").reason == "interior"

    def test_an_impedance_of_the_wrong_sign_is_stable_only_far_from_lam_zero(self) -> None:
        """u[-1] = a s[0] makes s_0 grow by z = (lam + a)/(a (lam a + 1)); a = -2: abs(z) < 1 for 4/5 < lam alone."""
        scheme = half_line(YEE, ["u[-1] = -2*s[0]"])
        found = stable_set(scheme, scheme.values({}))
        assert [(i.low, i.high) for i in found.intervals] == [(Root.of(Fraction(4, 5)), Root.of(1))]
        (mode,) = (m for m in judged(scheme, lam="3/5").modes if m.kind.value == "growing")
        assert mode.z == (Fraction(-7, 2), Fraction(0))
        nowhere = judged(scheme)
        assert nowhere.verdict is Verdict.UNSTABLE and not nowhere.solvable, "at lam = 1/2 s_0 is not determined"

    def test_two_half_lines(self) -> None:
        """One line cut in two: the standing wave kappa = -1 fits both sides. A jump of impedance turns it into a
        surface wave, or takes it away, on the unit circle either way: the scheme conserves its energy.
        """
        for alpha, verdict in (("1", Verdict.GENERALIZED), ("2", Verdict.NEUTRAL), ("1/3", Verdict.STABLE)):
            found = judged(TWO_HALF_LINES, alpha=alpha)
            assert found.verdict is verdict
            assert all(m.modulus == 1 for m in found.modes)

    def test_values_below_the_interiors_reach_are_free(self) -> None:
        """s[-1] is read by the closure alone."""
        scheme = half_line(YEE, ["u[-1] = 2*s[-1] - s[1]", "s[-1] = s[0]"])
        plain = half_line(YEE, ["u[-1] = 2*s[0] - s[1]"])
        assert summary(judged(scheme)) == summary(judged(plain))
        assert sum(b.width for b in problem_of(scheme).blocks) == 2


def mirrored(equations: Sequence[str]) -> list[str]:
    """i to -i."""
    found = []
    for text in equations:
        for old, new in (("i+1", "i~1"), ("i-1", "i+1"), ("i~1", "i-1"), ("[-1", "[1")):
            text = text.replace(old, new)
        found.append(text)
    return found


TWO_HALF_LINES = parse_scheme(
    """
title = "two staggered half-lines"
[parameters]
lam = { role = "cfl", default = 0.5 }
alpha = 2
[domains.L]
side = "left"
unknowns = ["u", "s"]
interior = ["u[i, n+1] = u[i] + lam*(s[i+1] - s[i])", "s[i, n+1] = s[i] + lam*(u[i, n+1] - u[i-1, n+1])"]
[domains.R]
side = "right"
unknowns = ["u", "s"]
interior = [
  "u[i, n+1] = u[i] + lam/alpha*(s[i+1] - s[i])", "s[i, n+1] = s[i] + lam*alpha*(u[i, n+1] - u[i-1, n+1])"
]
[closure]
equations = ["L.s[1] = R.s[0]", "R.u[-1] = L.u[0]"]
""",
    "two half-lines",
)


class TestCrossing:
    """z = kappa = 1: (z - 1)**2 = lam**2 (x - 1)**2 to lowest order, so eta = v eps with v = 1/lam and -1/lam."""

    def test_slopes_and_the_one_branch_that_counts(self) -> None:
        problem = problem_of(half_line(YEE, ["u[-1] = s[0]"]))
        (family,) = (f for f in problem.families if f.degree)
        here = Candidate(Root.of(1), Root.of(1), 1, Position.ON)
        (root,) = fibre(point_of(problem, here), family.polynomial, "x")
        assert root.multiplicity == 2
        assert {v.rational for v, _ in crossing_slopes(problem, family, here, root)} == {-2, 2}
        assert [count for _, count in admissible(problem, family, here).limiting] == [1]

    def test_the_scalar_field_alone_cannot_tell(self) -> None:
        """c vanishes at the crossing, so its determinant does for every closure; the limit of the branch decides."""
        for closure, modes in (("u[-1] = s[0]", 0), ("u[-1] = -s[0]", 1)):
            problem = problem_of(half_line(YEE, [closure]))
            here = Candidate(Root.of(1), Root.of(1), 1, Position.ON)
            (field,) = (b.field for b in problem.blocks if isinstance(b.field, CoupledField))
            assert field.vanishes(point_of(problem, here), Root.of(1))
            assert any(f.polynomial == problem.coefficients.gens["z"] - 1 for f in eliminated(problem).factors)
            assert modes_at(problem, here, [admissible(problem, f, here) for f in problem.families]) == modes

    def test_local_vectors_and_the_scalar_field_agree_where_both_hold(self) -> None:
        problem = problem_of(half_line(YEE, ["u[-1, n+1] = 2*u[0]"]))
        seen = set()
        for factor in eliminated(problem).factors:
            for candidate in candidates_of(problem, factor):
                if candidate.position is Position.OUTSIDE:
                    families = [admissible(problem, f, candidate) for f in problem.families]
                    seen.add(modes_at(problem, candidate, families))
        assert seen == {1}

    def test_a_mode_at_infinity_is_named(self) -> None:
        with pytest.raises(SchemeError, match=r"R\.u\[-1\] is left undetermined"):
            judged(half_line(YEE, ["u[0] = u[1]"]))


WAVES: Mapping[str, tuple[tuple[str, str], str]] = {
    "lax-wendroff": (
        (
            "u[i, n+1] = u[i] + lam/2*(s[i+1] - s[i-1]) + lam**2/2*(u[i+1] - 2*u[i] + u[i-1])",
            "s[i, n+1] = s[i] + lam/2*(u[i+1] - u[i-1]) + lam**2/2*(s[i+1] - 2*s[i] + s[i-1])",
        ),
        "",
    ),
    "leapfrog": (
        ("u[i, n+1] = u[i, n-1] + lam*(s[i+1] - s[i-1])", "s[i, n+1] = s[i, n-1] + lam*(u[i+1] - u[i-1])"),
        "",
    ),
    **{
        f"central {time}": (("dt(u[i]) = (s[i+1] - s[i-1])/2", "dt(s[i]) = (u[i+1] - u[i-1])/2"), time)
        for time in ("rk4", "leapfrog", "crank-nicolson", "exact")
    },
}
"""u_t = s_x, s_t = u_x with both unknowns at the same points: u + s and u - s separate."""

WEIGHTS = st.sampled_from(["0", "1", "-1", "2", "1/2", "-1/2"])


@st.composite
def closures(draw: st.DrawFn, needed: Sequence[str], levels: bool, unknowns: str = "us") -> list[str]:
    found = []
    for name in needed:
        level = draw(st.sampled_from(["", "", ", n+1"])) if levels else ""
        terms = [
            f"({draw(WEIGHTS)})*{draw(st.sampled_from(unknowns))}[{draw(st.integers(0, 2))}]"
            for _ in range(draw(st.integers(1, 3)))
        ]
        found.append(f"{name[:-1]}{level}] = {' + '.join(terms)}")
    return found


def summary(found: ModesResult) -> tuple[str, str | None, list[tuple[str, float]]]:
    """The verdict with the distinct moduli that make it; inside the circle, and beside an unstable interior, the two
    routes list different roots.
    """
    kinds = ("growing", "eigenvalue", "generalized") if found.reason != "interior" else ()
    listed = {(m.kind.value, round(float(m.modulus), 9)) for m in found.modes if m.kind.value in kinds}
    return found.verdict.value, found.reason, sorted(listed)


def answer(scheme: Scheme, lam: str) -> Any:
    try:
        return summary(judged(scheme, lam=lam))
    except InputError as refused:
        return type(refused)


def coupled_answer(scheme: Scheme, lam: str) -> Any:
    """As if nothing had separated the unknowns."""

    def refuse(*_: object) -> None:
        raise NotAnalysable("left coupled")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(characteristic, "_joint_fields", refuse)
        return answer(scheme, lam)


class TestBothRoutesAgree:
    @examples(20)
    @given(st.data(), st.sampled_from(sorted(WAVES)), st.sampled_from(["1/2", "9/10", "6/5"]))
    def test_on_systems_that_separate(self, data: st.DataObject, name: str, lam: str) -> None:
        interior, time = WAVES[name]
        closure = data.draw(closures(["u[-1]", "s[-1]"], levels=not time))
        scheme = half_line(interior, closure, time)
        assert coupled_answer(scheme, lam) == answer(scheme, lam)

    def test_where_one_choice_of_roots_is_lost(self) -> None:
        """Even u and odd s: Delta vanishes for k_2 = 1/k_1, which no decaying pair is; at s = 0 and s = i it does for
        one that is. Both routes have to look past the lost choice.
        """
        interior, time = WAVES["central rk4"]
        scheme = half_line(interior, ["u[-1] = u[1]", "s[-1] = -s[1]"], time)
        expected = ("generalized", "closure", [("generalized", 1.0)])
        assert answer(scheme, "1/2") == coupled_answer(scheme, "1/2") == expected


COUPLED: Mapping[str, tuple[tuple[str, ...], str, tuple[str, ...]]] = {
    "staggered": (YEE, "", ("u[-1]",)),
    "staggered, method of lines": (("dt(u[i]) = s[i+1] - s[i]", "dt(s[i]) = u[i] - u[i-1]"), "rk4", ("u[-1]",)),
    "staggered, implicit": (("dt(u[i]) = s[i+1] - s[i]", "dt(s[i]) = u[i] - u[i-1]"), "crank-nicolson", ("u[-1]",)),
    "triangular": (
        (
            "u[i, n+1] = u[i] - lam*(u[i] - u[i-1]) + lam/4*(s[i+1] - s[i])",
            "s[i, n+1] = s[i] + lam/4*(s[i+1] - s[i-1]) + lam**2/8*(s[i+1] - 2*s[i] + s[i-1])",
        ),
        "",
        ("u[-1]", "s[-1]"),
    ),
    "three fields": (
        (
            "dt(u[i]) = s[i+1] - s[i]",
            "dt(s[i]) = u[i] - u[i-1] - s[i]/3 + w[i]",
            "dt(w[i]) = -(w[i] - w[i-1])/2 - w[i]",
        ),
        "rk4",
        ("u[-1]", "w[-1]"),
    ),
}


@examples(30)
@given(st.data(), st.sampled_from(sorted(COUPLED)), st.sampled_from(["3/10", "1/2", "4/5"]))
def test_growing_modes_are_those_of_the_finite_matrix(data: st.DataObject, name: str, lam: str) -> None:
    interior, time, needed = COUPLED[name]
    unknowns = "usw"[: len(interior)]
    scheme = half_line(interior, data.draw(closures(needed, not time, unknowns)), time, unknowns=unknowns)
    values = scheme.values({"lam": lam})
    try:
        found = analyse(scheme, values)
    except InputError:
        return
    assert found.verdict is not Verdict.UNDECIDED
    if not found.solvable or found.reason == "interior":
        return
    seen = growing_modulus(scheme, values)
    growing = [m for m in found.modes if m.kind.value == "growing"]
    if seen is not None and seen > 1 + 1e-6:
        assert max(float(m.modulus) for m in growing) == pytest.approx(seen, abs=1e-6)
    if growing and all(abs(complex(*map(float, kappa))) < 0.4 for m in growing for kappa in m.kappa["R"]):
        assert seen is not None, "twelve cells are enough for modes that decay so fast"


class TestDoubleRootsOnTheCircle:
    """u_t = u_x + (coupling), s_t = c s_x by Lax-Wendroff: z = kappa = 1 twice."""

    @staticmethod
    def interior(c: str, coupling: str) -> tuple[str, str]:
        def wave(q: str, nu: str) -> str:
            slope, bend = f"({q}[i+1] - {q}[i-1])", f"({q}[i+1] - 2*{q}[i] + {q}[i-1])"
            return f"{q}[i, n+1] = {q}[i] + {nu}/2*{slope} + ({nu})**2/2*{bend}"

        return f"{wave('u', 'lam')} + lam*({coupling})", wave("s", f"({c}*lam)")

    def stability(self, c: str, coupling: str) -> str | None:
        scheme = half_line(self.interior(c, coupling), ["u[-1] = u[0]", "s[-1] = s[0]"])
        return interior_stability(problem_of(scheme))

    def test_two_speeds_keep_two_eigenvectors(self) -> None:
        assert self.stability("1/2", "s[i+1] - s[i]") is None

    def test_a_source_term_is_a_jordan_block(self) -> None:
        assert "double root" in str(self.stability("1/2", "s[i]"))

    def test_one_speed_with_a_shared_eigenvector_is_weakly_hyperbolic(self) -> None:
        """At kappa = 1 there are two eigenvectors, close by there is one: powers grow like theta**-3."""
        assert "double root" in str(self.stability("1", "s[i+1] - s[i]"))

    def test_one_speed_to_first_order_is_left_open(self) -> None:
        coupling = "s[i+1] - 2*s[i] + s[i-1]"
        with pytest.raises(Undecided, match="one group velocity"):
            self.stability("1", coupling)
        scheme = half_line(self.interior("1", coupling), ["u[-1] = u[0]", "s[-1] = s[0]"])
        found = judged(scheme)
        assert (found.verdict, found.reason) == (Verdict.UNDECIDED, "interior")

    def test_equations_that_leave_the_new_level_open(self) -> None:
        both = "u[i, n+1] + s[i, n+1]"
        scheme = half_line((f"{both} = u[i+1] + s[i]", f"{both} = s[i+1] - 2*u[i]"), ["u[-1] = u[0]", "s[-1] = s[0]"])
        problem = spatial_problem(scheme, scheme.values({}))
        assert "new time level" in str(interior_stability(problem))


class TestWhatIsBeyond:
    def test_independent_solutions_with_one_root(self) -> None:
        """Two copies of a staggered scheme, mixed: every spatial root has two solutions."""
        interior = (
            "u[i, n+1] = u[i] + lam*(s[i+1] - s[i])",
            "s[i, n+1] = s[i] + lam*(u[i, n+1] - u[i-1, n+1])",
            "v[i, n+1] + u[i, n+1] = v[i] + u[i] + lam*(w[i+1] - w[i] + s[i+1] - s[i])",
            "w[i, n+1] = w[i] + lam*(v[i, n+1] - v[i-1, n+1])",
        )
        with pytest.raises(NotAnalysable, match="independent solutions"):
            judged(half_line(interior, ["u[-1] = 0*u[0]", "v[-1] = 0*v[0]"], unknowns="usvw"))

    def test_wide_stencils_are_undecided(self) -> None:
        slope = "(8*({0}[i+1] - {0}[i-1]) - ({0}[i+2] - {0}[i-2]))/12"
        interior = (
            f"dt(u[i]) = {slope.format('s')} - u[i]/5",
            f"dt(s[i]) = {slope.format('u')} + u[i]/7",
        )
        closure = [f"{q}[-{k}] = {q}[0]" for q in "us" for k in (1, 2)]
        found = judged(half_line(interior, closure, "rk4"))
        assert found.verdict is Verdict.UNDECIDED
        assert "was not proved to vanish (at z = 1)" in found.because  # by arithmetic on the rational roots there
