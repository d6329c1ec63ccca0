"""A verdict belongs to the scheme and not to how it is written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given
from hypothesis import strategies as st

from gks.bounds.cfl import stable_set
from gks.errors import InputError
from gks.modes import ModesResult, Verdict, analyse
from gks.scheme.model import Scheme
from gks.scheme.operators import discrete_stencil, stencil
from gks.scheme.schemefile import parse_scheme
from tests.examples import examples
from tests.modes.rewritings import mirrored, moved, renamed, reordered, scaled
from tests.oracle.finite_matrix import growing_modulus
from tests.strategies import Draft, Line, Term, drafts, scalar_drafts

FEW = examples(12, [HealthCheck.too_slow, HealthCheck.filter_too_much])
CLOSE = 1e-14
"""Relative: the numbers compared are exact values rounded once, from enclosures of 80 bits."""


def judged(draft: Draft) -> ModesResult:
    scheme = draft.scheme()
    try:
        return analyse(scheme, scheme.values({}))
    except InputError:
        assume(False)
        raise


def summary(found: ModesResult) -> list[tuple[str, int, float, float]]:
    """Kind, multiplicity, real part and size of the imaginary part of every mode listed, in an order of their own."""
    rows = [
        (m.kind.value, m.multiplicity, float(m.modulus), abs(m.z_complex.imag))
        for m in found.modes
        if m.kind.value != "inadmissible"
    ]
    return sorted(rows, key=lambda row: (row[0], round(row[2], 9), round(row[3], 9)))


def assert_same(one: Draft, other: Draft) -> None:
    """Verdict, reason and every mode but its kappa."""
    before, after = judged(one), judged(other)
    assert (before.verdict, before.reason) == (after.verdict, after.reason)
    left, right = summary(before), summary(after)
    assert [row[:2] for row in left] == [row[:2] for row in right]
    if left:
        # Imaginary parts of nearly real roots are compared against the modulus.
        sizes = np.maximum(1e-300, [[row[2], row[2]] for row in left])
        difference = np.abs(np.array([row[2:] for row in left]) - np.array([row[2:] for row in right]))
        assert np.all(difference <= CLOSE * sizes)


FACTORS = ["-7/3", "1e-40", "10**30", "(2 + lam)", "1/(lam**2 + 1)"]


@given(drafts(), st.lists(st.sampled_from(FACTORS), min_size=4, max_size=4))
@FEW
def test_scaling_an_equation_changes_nothing(draft: Draft, factors: Sequence[str]) -> None:
    assert_same(draft, scaled(draft, factors))


@given(drafts())
@FEW
def test_names_change_nothing(draft: Draft) -> None:
    assert_same(draft, renamed(draft))


@given(drafts())
@FEW
def test_the_mirror_image_is_as_stable(draft: Draft) -> None:
    """x -> -x: sides swap, indices and fluxes change sign, kappa becomes 1/kappa."""
    image = mirrored(draft)
    assert_same(draft, image)
    for one, other in zip(judged(draft).modes, judged(image).modes, strict=True):
        for name, kappas in one.kappa.items():
            mine = sorted((abs(complex(*map(float, k))) for k in kappas), reverse=True)
            theirs = sorted(abs(complex(*map(float, k))) for k in other.kappa[name])
            np.testing.assert_allclose(np.array(mine) * np.array(theirs), 1, rtol=1e-12)


@given(drafts())
@FEW
def test_the_order_of_domains_and_equations_changes_nothing(draft: Draft) -> None:
    assert_same(draft, reordered(draft))


@given(drafts(), st.integers(-3, 4))
@FEW
def test_where_the_cells_start_to_count_changes_nothing(draft: Draft, by: int) -> None:
    assert_same(draft, moved(draft, by))


@given(scalar_drafts(), st.sampled_from([-3, -1, 1, 5]))
@FEW
def test_equations_hold_at_every_level(draft: Draft, by: int) -> None:
    """Written interiors and closures with all their levels moved, each by its own step."""
    discrete = not draft.lines[0].named
    line = draft.lines[0]
    interior = (
        tuple(tuple(replace(t, level=t.level + by) for t in e) for e in line.interior) if discrete else line.interior
    )
    closure = tuple(
        tuple(replace(t, level=t.level + by * (k + 1)) for t in equation) if discrete else equation
        for k, equation in enumerate(draft.closure)
    )
    assert_same(draft, replace(draft, lines=(replace(line, interior=interior),), closure=closure))


@given(drafts())
@FEW
def test_coefficients_may_be_definitions(draft: Draft) -> None:
    """Each coefficient c as (c - d) + d with both parts defined, the second by way of the first."""
    table: list[tuple[str, str]] = []

    def defined(term: Term) -> Term:
        k = len(table) // 2
        table.extend([(f"a{k}", f"({term.coefficient}) - 5/7"), (f"b{k}", f"a{k} + 5/7")])
        return replace(term, coefficient=f"b{k}")

    changed = draft.on_terms(defined)
    assert_same(draft, replace(changed, definitions=tuple(table[::-1])))


# Named schemes written out
# ---------------------------------------------------------------------------------------------


def scalar(side: str, closure: Sequence[str], keys: str) -> Scheme:
    equations = ", ".join(f'"{equation}"' for equation in closure)
    return parse_scheme(
        f'title = "t"\n[parameters]\nlam = {{ role = "cfl", default = "3/10" }}\n[domains.R]\nside = "{side}"\n'
        f'unknowns = ["u"]\n{keys}\n[closure]\nequations = [{equations}]\n',
        "scalar",
    )


def written_lines(space: str, speed: int) -> str:
    operator = stencil(space, speed > 0)
    mass = " + ".join(f"({c})*dt(u[i{j:+d}])" for j, c in operator.mass.items())
    slope = " + ".join(f"({-speed * c})*u[i{j:+d}]" for j, c in operator.derivative.items())
    return f"{mass} = {slope}"


def written_update(scheme: str, speed: int) -> str:
    rows = discrete_stencil(scheme, speed > 0).coefficients
    terms = []
    for j, powers in rows.items():
        weight = " + ".join(f"({c})*({speed}*lam)**{k}" for k, c in enumerate(powers))
        terms.append(f"({weight})*u[i{j:+d}]")
    return f"u[i, n+1] = {' + '.join(terms)}"


def matching_closure(text: str, interior: str) -> list[str] | None:
    """One ghost equation for each ghost point that an interior formula reads on the right half-line (first = 0)."""
    reach = max(k for k in range(4) if k == 0 or f"[i-{k}]" in interior or f"[i-{k})" in interior)
    return [f"u[{-k}] = {text}" for k in range(1, reach + 1)] or None


NAMED = [
    ("upwind1", "ssprk3"),
    ("upwind2", "rk2"),
    ("upwind3", "rk4"),
    ("fromm", "ab3"),
    ("central2", "leapfrog"),
    ("central4", "rk4"),
    ("compact4", "bdf2"),
]


@pytest.mark.parametrize(("space", "time"), NAMED)
@pytest.mark.parametrize("speed", [1, -1])
def test_a_named_operator_is_what_it_says(space: str, time: str, speed: int) -> None:
    interior = written_lines(space, speed)
    closure = matching_closure("-3/5*u[0] + 1/4*u[1]", interior)
    if closure is None:
        return
    named = scalar("right", closure, f'flux = [["{speed}"]]\nspace = "{space}"\ntime = "{time}"')
    written = scalar("right", closure, f'interior = ["{interior}"]\ntime = "{time}"')
    for lam in ("1/10", "3/10", "4/3"):
        one, other = (analyse(scheme, scheme.values({"lam": lam})) for scheme in (named, written))
        assert (one.verdict, one.modes) == (other.verdict, other.modes)
    if space != "central4" and (space, speed) != ("upwind3", 1):
        # Two inflow ghosts under four stages make exact stable sets a matter of minutes.
        assert stable_set(named, {}).intervals == stable_set(written, {}).intervals


@pytest.mark.parametrize("scheme", ["lax-friedrichs", "lax-wendroff", "beam-warming", "fromm"])
@pytest.mark.parametrize("speed", [1, -1])
def test_a_named_update_is_what_it_says(scheme: str, speed: int) -> None:
    interior = written_update(scheme, speed)
    closure = matching_closure("-3/5*u[0] + 1/4*u[1]", interior)
    if closure is None:
        return
    named = scalar("right", closure, f'flux = [["{speed}"]]\nscheme = "{scheme}"')
    written = scalar("right", closure, f'interior = ["{interior}"]')
    one, other = (analyse(each, each.values({})) for each in (named, written))
    assert (one.verdict, one.modes) == (other.verdict, other.modes)
    assert stable_set(named, {}).intervals == stable_set(written, {}).intervals


# Systems
# ---------------------------------------------------------------------------------------------------------------


def system(
    flux_left: str, flux_right: str, unknowns: str, closure: Sequence[str], interior: str, right: str = ""
) -> Scheme:
    equations = ", ".join(f'"{equation}"' for equation in closure)
    return parse_scheme(
        f"""
title = "system"
[parameters]
lam = {{ role = "cfl", default = "3/5" }}
alpha = 2
[interior]
{interior}
[domains.L]
side = "left"
unknowns = {unknowns}
flux = {flux_left}
[domains.R]
side = "right"
unknowns = {unknowns}
flux = {flux_right}
{right}
[closure]
equations = [{equations}]
""",
        "system",
    )


ACOUSTIC = '[["0", "-1"], ["-1", "0"]]'
EULER, WENDROFF = 'space = "upwind1"\ntime = "forward-euler"', 'scheme = "lax-wendroff"'
COPIED = ["L.u[1] = L.u[0]", "L.s[1] = R.s[0]", "R.u[-1] = L.u[0]", "R.s[-1] = R.s[0]"]
TRIPLED, MIXED = ([*COPIED[:-1], f"R.s[-1] = {value}"] for value in ("3*R.s[0]", "R.s[0] - 4*R.u[0]"))
"""With these modes grow, in some of the cases that they are tried with."""


def irrational(stiffness: str, interior: str, closure: Sequence[str] = COPIED) -> Scheme:
    """rho = 1 and kappa = ``stiffness`` on the right: a wave speed of sqrt(kappa)."""
    return system(ACOUSTIC, f'[["0", "-1"], ["-({stiffness})", "0"]]', '["u", "s"]', closure, interior)


@pytest.mark.parametrize(("stiffness", "limit"), [("2", 2**-0.5), ("1/2", 1.0), ("20", 20**-0.5)])
def test_an_irrational_speed_sets_the_interior_limit(stiffness: str, limit: float) -> None:
    scheme = irrational(stiffness, EULER)
    found = stable_set(scheme, scheme.values({}))
    (interval,) = found.intervals
    assert interval.low is None
    assert interval.high is not None
    np.testing.assert_allclose(float(interval.high.ball().real.mid()), limit, rtol=1e-15)
    assert found.limited_by == "interior"


def assert_grows_as_seen(scheme: Scheme, values: Mapping[str, Fraction], cells: int) -> bool:
    """Whether a mode grows: by what the finite problem sees, which sees none where there is none."""
    found = analyse(scheme, values)
    seen = growing_modulus(scheme, values, cells)
    grows = [float(m.modulus) for m in found.modes if m.kind.value == "growing"]
    assert (found.verdict is Verdict.UNSTABLE) is bool(grows)
    assert (seen or 1) == pytest.approx(max(grows, default=1), rel=1e-6)
    return bool(grows)


@pytest.mark.parametrize("interior", [EULER, WENDROFF])
@pytest.mark.parametrize(("stiffness", "lam"), [("2", "7/10"), ("1/2", "9/10"), ("20", "1/5"), ("200", "1/15")])
def test_irrational_speeds_against_the_finite_problem(interior: str, stiffness: str, lam: str) -> None:
    for closure in (COPIED, TRIPLED):
        scheme = irrational(stiffness, interior, closure)
        grows = assert_grows_as_seen(scheme, scheme.values({"lam": lam}), 14)
        assert grows is (closure is TRIPLED and (interior, stiffness) != (WENDROFF, "1/2"))


def test_unequal_speeds_written_by_scaling_one_axis() -> None:
    """Speed 2 with lam is speed 1 with 2 lam: u_t + 2 u_x at lam = 3/10 has the modes of u_t + u_x at 6/10."""
    closure = ["u[-1] = -3/5*u[0] + 1/4*u[1]"]
    fast = scalar("right", closure, 'flux = [["2"]]\nspace = "upwind1"\ntime = "rk2"')
    slow = scalar("right", closure, 'flux = [["1"]]\nspace = "upwind1"\ntime = "rk2"')
    one = analyse(fast, {"lam": Fraction(3, 10)})
    other = analyse(slow, {"lam": Fraction(6, 10)})
    assert [m.modulus for m in one.modes] == [m.modulus for m in other.modes]


def test_a_field_that_stands_still() -> None:
    """Entropy with speed 0 beside two acoustic waves: its ghosts are read by nothing, and it changes no verdict."""
    flux = '[["0", "-1", "0"], ["-1", "0", "0"], ["0", "0", "0"]]'
    right = '[["0", "-1/alpha", "0"], ["-alpha", "0", "0"], ["0", "0", "0"]]'
    closure = [*COPIED, "L.e[1] = L.e[0]", "R.e[-1] = R.e[0]"]
    with_entropy = system(flux, right, '["u", "s", "e"]', closure, EULER)
    without = system(ACOUSTIC, '[["0", "-1/alpha"], ["-alpha", "0"]]', '["u", "s"]', COPIED, EULER)
    for alpha in ("1/2", "2", "31/9", "10"):
        one, other = (analyse(s, s.values({"alpha": alpha, "lam": "9/10"})) for s in (with_entropy, without))
        assert one.verdict is other.verdict
        growing = [[m.modulus for m in r.modes if m.kind.value == "growing"] for r in (one, other)]
        assert growing[0] == growing[1]


def test_three_coupled_waves() -> None:
    """A symmetric 3x3 flux with eigenvalues 0, 1, -1 in a full basis: a change of unknowns of the acoustic problem."""
    # e = u + s + w with w standing still, w = e - u - s; written in (u, s, e).
    flux = '[["0", "-1", "0"], ["-1", "0", "0"], ["-1", "-1", "0"]]'
    right = '[["0", "-1/alpha", "0"], ["-alpha", "0", "0"], ["-alpha", "-1/alpha", "0"]]'
    closure = [*COPIED, "L.e[1] = L.e[0]", "R.e[-1] = R.e[0]"]
    mixed = system(flux, right, '["u", "s", "e"]', closure, EULER)
    plain = system(ACOUSTIC, '[["0", "-1/alpha"], ["-alpha", "0"]]', '["u", "s"]', COPIED, EULER)
    for alpha, lam in (("2", "9/10"), ("31/9", "9/10"), ("10", "9/10"), ("10", "1/3")):
        one, other = (analyse(s, s.values({"alpha": alpha, "lam": lam})) for s in (mixed, plain))
        assert one.verdict is other.verdict


@pytest.mark.parametrize(
    ("left", "right", "growing"),
    [
        ("forward-euler", "backward-euler", [(TRIPLED, "1/4")]),
        ("leapfrog", "crank-nicolson", [(MIXED, "1/4")]),
        ("ab2", "bdf2", [(TRIPLED, "1/4"), (MIXED, "1/4")]),
    ],
)
def test_two_clocks(left: str, right: str, growing: list[tuple[list[str], str]]) -> None:
    """Forward Euler on the left, backward Euler on the right: against the finite problem, z being the variable."""
    space = "central2" if left == "leapfrog" else "upwind1"
    interior = f'space = "{space}"\ntime = "{left}"', f'time = "{right}"'
    for closure in (COPIED, TRIPLED, MIXED):
        scheme = system(ACOUSTIC, '[["0", "-1/alpha"], ["-alpha", "0"]]', '["u", "s"]', closure, *interior)
        for alpha in ("1/4", "40"):
            values = scheme.values({"alpha": alpha, "lam": "2/5"})
            assert assert_grows_as_seen(scheme, values, 8) is ((closure, alpha) in growing)


@pytest.mark.parametrize("time", ["rk4", "ab3", "crank-nicolson", "exact"])
@pytest.mark.parametrize("rate", [Fraction(-1, 2), Fraction(1, 3)])
def test_a_boundary_point_with_its_own_equation(time: str, rate: Fraction) -> None:
    """du_0/dt = rate u_0 feeds u_t + u_x = 0: s = rate is an eigenvalue, whatever the interior."""
    line = Line(
        "R",
        "right",
        ("u",),
        1,
        ((Term("1", "R", "u", 0, dt=True), Term("1", "R", "u", 0), Term("-1", "R", "u", -1)),),
        (("time", time),),
    )
    closure = ((Term("1", "R", "u", 0, dt=True), Term(str(-rate), "R", "u", 0)),)
    found = judged(Draft(Fraction(1, 4), (line,), closure))
    assert found.verdict is (Verdict.UNSTABLE if rate > 0 else Verdict.STABLE)
    # kappa = 1/(1 + s): the root is listed either way, and decays in space only for rate > 0.
    mu = float(rate) / 4
    principal = max((complex(m.z_complex) for m in found.modes), key=lambda z: z.real)
    approximations: dict[str, float] = {
        "rk4": 1 + mu + mu**2 / 2 + mu**3 / 6 + mu**4 / 24,
        "crank-nicolson": (2 + mu) / (2 - mu),
    }
    assert abs(principal - approximations.get(time, float(np.exp(mu)))) < (1e-3 if time == "ab3" else 1e-15)
