"""A mode's profile solves the scheme as written: interior and closure, substituted value by value.

The substitution is the marching code's own reading of the file (`gks.solvers.problem`), which shares nothing with the
derivation of the modes. Where a mode grows its profile is also the eigenvector of the finite update matrix.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Mapping
from fractions import Fraction
from math import log
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gks.api import LoadedScheme, load
from gks.catalogue import path as path_of
from gks.errors import InputError, NotAnalysable
from gks.modes.analysis import analyse
from gks.modes.profile import Profile, profile
from gks.modes.verdict import ModeKind
from gks.scheme.model import Scheme
from gks.scheme.schemefile import parse_scheme
from gks.solvers.matrices import layout, update_matrix
from gks.solvers.problem import Problem, Slot, build
from tests.examples import examples
from tests.modes.test_coupled import YEE
from tests.modes.test_coupled import half_line as system
from tests.modes.test_wide import INFLOW, lax_wendroff, written
from tests.oracle.scheme_texts import BACKWARD_CENTRED, CRANK_NICOLSON, LAX_WENDROFF, LEAPFROG, constructs, half_line

BEAM_WARMING = "u[i, n+1] = u[i] - lam/2*(3*u[i] - 4*u[i-1] + u[i-2]) + lam**2/2*(u[i] - 2*u[i-1] + u[i-2])"

ROUNDING = 1e-12
"""Residuals against the size of an equation's terms: coefficients of the second reading are doubles."""


def found(scheme: Scheme, number: int = 0, cells: int | None = 16, **values: str) -> Profile:
    return profile(analyse(scheme, scheme.values(values)), number, cells)


def number(text: str) -> tuple[Fraction, Fraction]:
    """A real number as modes have it."""
    return Fraction(text), Fraction(0)


Values = Mapping[str, Mapping[str, tuple[tuple[Fraction, Fraction], ...]]]


def numbers(scheme: Scheme, shape: Values, lows: Mapping[str, int]) -> dict[Slot, complex]:
    """The profile's values by slot of the marching code: places count outwards."""
    slots = {}
    for side, half in enumerate(scheme.domains):
        for k, unknown in enumerate(half.unknowns):
            for n, value in enumerate(shape[half.name][unknown]):
                slots[Slot(side, k, lows[half.name] + n)] = complex(float(value[0]), float(value[1]))
    return slots


def resolvents(problem: Problem, z: complex) -> list[complex]:
    """What stands for a shift by one level: z, or under stages every s with R(lam s) = z."""
    if problem.stages is None:
        return [z]
    if problem.stages.kind == "exact":
        return [(np.log(z) + 2j * np.pi * turn) / problem.lam for turn in range(-3, 4)]
    *high, constant = [float(c) for c in problem.stages.stability[::-1]]
    return [complex(mu) / problem.lam for mu in np.roots([*high, constant - z])]


def residual(each: Profile, shape: int = 0) -> float:
    """The largest residual of the closure and of the interior at all cells that the profile covers."""
    problem = build(each.scheme, each.parameters)
    lows = {h.name: each.indices[h.name][0] * (1 if h.side == "right" else -1) for h in each.scheme.domains}
    values = numbers(each.scheme, each.shapes[shape].values, lows)
    rows = [(row, 0, 0) for row in problem.closure]
    for number, half in enumerate(problem.sides):
        cells = len(each.indices[each.scheme.domains[number].name]) + lows[half.name] - half.outward_reach
        rows += [(row, place, number) for row in half.rows for place in range(half.first, cells)]
    worst = []
    for resolvent in resolvents(problem, each.mode.z_complex):
        largest = 0.0
        for row, place, _ in rows:
            terms = [
                c * resolvent**level * values[Slot(slot.side, slot.unknown, slot.place + place)]
                for level, slot, c in row.terms
            ]
            size = sum(abs(c * resolvent**level) for level, _, c in row.terms)
            largest = max(largest, abs(sum(terms)) / max(size, 1e-300))
        worst.append(largest)
    return min(worst)


CASES = {
    "interface, first order": ("traditional-1", {"alpha": "5"}),
    "interface, second order": ("traditional-2", {"alpha": "7"}),
    "interface, extreme ratio": ("traditional-1", {"alpha": "1e10", "lam": "1/10"}),
    "interface, neutral": ("traditional-1", {"alpha": "31/9"}),
    "interface, decaying in time": ("traditional-1", {"alpha": "33/10"}),
    "implicit": ("implicit-1", {"alpha": "100", "lam": "1/10"}),
    "generalized": ("leapfrog-space-0", {}),
}


@pytest.mark.parametrize("case", CASES)
def test_profile_solves_the_scheme(case: str) -> None:
    name, values = CASES[case]
    result = load(name).modes(values)
    modes = [k for k, mode in enumerate(result.modes) if mode.kind is not ModeKind.INADMISSIBLE]
    assert modes
    for k in modes:
        each = profile(result, k, 16)
        for shape in range(len(each.shapes)):
            assert residual(each, shape) < ROUNDING


def louder(scheme: Scheme) -> Scheme:
    """With three times the closure's right sides: few constructs have a mode as they are."""
    head, equations = scheme.text.split("equations = ")
    tripled = re.sub(r'"([^"=]+) = ([^"]+)"', r'"\1 = 3*(\2)"', equations)
    return parse_scheme(f"{head}equations = {tripled}", scheme.name)


@pytest.mark.parametrize("name", sorted(constructs()))
def test_every_construct_of_the_format(name: str) -> None:
    seen = 0
    for scheme in (constructs()[name], louder(constructs()[name])):
        for lam in ("1/2", "9/5"):
            result = analyse(scheme, scheme.values({"lam": lam}))
            for k, mode in enumerate(result.modes):
                if mode.kind is not ModeKind.INADMISSIBLE and mode.modulus:
                    assert residual(profile(result, k, 12)) < ROUNDING, (lam, mode.z_complex)
                    seen += 1
    assert seen


def test_the_largest_value_is_one_and_the_others_are_smaller() -> None:
    each = found(load("traditional-1").scheme, alpha="5")
    sizes = [abs(complex(*map(float, v))) for d in each.shapes[0].values.values() for u in d.values() for v in u]
    assert max(sizes) == pytest.approx(1, abs=1e-15)
    assert each.shapes[0].error < 2.0**-60


def test_profile_is_the_finite_matrix_eigenvector() -> None:
    scheme = load("traditional-1").scheme
    each = found(scheme, cells=10, alpha="5")
    cells = 40
    values, vectors = np.linalg.eig(update_matrix(scheme, each.parameters, cells))
    at = int(np.argmin(np.abs(values - each.mode.z_complex)))
    grid = layout(build(scheme, each.parameters), [cells, cells])
    mine, theirs = [], []
    for side, half in enumerate(scheme.domains):
        for k, unknown in enumerate(half.unknowns):
            # Places from 0: the cells, which the one-step matrix holds.
            for n, value in enumerate(each.shapes[0].values[half.name][unknown][1:]):
                mine.append(complex(float(value[0]), float(value[1])))
                theirs.append(vectors[grid.index(Slot(side, k, n)), at])
    ratio = np.vdot(mine, theirs) / np.vdot(mine, mine)
    assert np.abs(np.array(theirs) - ratio * np.array(mine)).max() < 1e-6 * abs(ratio)


def test_amplitudes_add_up_to_the_values() -> None:
    each = found(load("traditional-2").scheme, alpha="7")
    for half in each.scheme.domains:
        for unknown in half.unknowns:
            for i, value in zip(each.indices[half.name], each.shapes[0].values[half.name][unknown], strict=True):
                if half.is_boundary(i):
                    continue
                total = 0j
                for part, amplitude in zip(each.components, each.shapes[0].coefficients, strict=True):
                    if part.domain == half.name and part.kappa is not None:
                        c = [complex(*map(float, x)) for x in amplitude[unknown]]
                        total += complex(*map(float, part.kappa)) ** i * sum(x * i**k for k, x in enumerate(c))
                assert total == pytest.approx(complex(float(value[0]), float(value[1])), abs=1e-13)


# What is special at a point -----------------------------------------------------------------------------------------


def test_colliding_kappas_give_a_polynomial_times_a_power() -> None:
    # Beam-Warming entering at lam = 1/2 has kappa = 1/3 twice at z = 3/2; closures that make that point a mode.
    scheme = half_line(BEAM_WARMING, '"u[-2] = 9*u[0] - 3*u[1] + 0*u[-1]", "u[-1, n+1] = 3/2*u[-1]"')
    result = analyse(scheme, scheme.values({"lam": "1/2"}))
    at = next(k for k, mode in enumerate(result.modes) if mode.z == number("3/2"))
    each = profile(result, at, 12)
    double = [part for part in each.components if part.multiplicity == 2]
    (kappa,) = [part.kappa for part in double]
    assert kappa is not None and complex(*map(float, kappa)) == pytest.approx(1 / 3)
    assert residual(each) < ROUNDING
    assert all(len(c["u"]) == 2 for c in each.shapes[0].coefficients)


def test_a_component_of_zero_amplitude_is_told_from_one_that_is_there() -> None:
    # Two waves that leave x > 0 and do not meet in the closure: the mode of one has nothing of the other.
    scheme = system(
        ("u[i, n+1] = u[i-1, n] + 0*s[i]", "s[i, n+1] = s[i-1]/2 + s[i+1]/2 + 0*u[i]"),
        ("u[-1] = 2*u[0]", "s[-1] = s[0]/3"),
    )
    each = found(scheme)
    assert each.mode.z == number("2")
    assert {part.present for part in each.components} == {True, False}
    assert all(not any(map(any, c["s"])) for c in each.shapes[0].coefficients)


def test_an_amplitude_that_vanishes_by_a_coincidence_is_exactly_zero() -> None:
    # Both equations hold for kappa = 1/2 alone, whatever the second decaying kappa at that z is.
    each = found(half_line(BEAM_WARMING, '"u[-1] = 2*u[0]", "u[-2] = 2*u[-1]"'), lam="1/2")
    assert each.mode.z == number("11/8")
    assert {part.kappa == number("1/2"): part.present for part in each.components} == {True: True, False: False}
    assert residual(each) < ROUNDING


def test_two_modes_at_one_z_are_a_basis() -> None:
    scheme = system(
        ("u[i, n+1] = u[i-1, n] + 0*s[i]", "s[i, n+1] = s[i-1] + 0*u[i]"), ("u[-1] = 2*u[0]", "s[-1] = 2*s[0]")
    )
    each = found(scheme)
    assert len(each.shapes) == 2
    rows = [[complex(*map(float, v)) for u in s.values["R"].values() for v in u] for s in each.shapes]
    assert np.linalg.matrix_rank(np.array(rows)) == 2
    assert all(residual(each, k) < ROUNDING for k in range(2))


def test_left_and_right_profiles_mirror_each_other() -> None:
    right = half_line(LAX_WENDROFF, '"u[-1] = 3*u[0] - u[1]"', 0)
    mirrored = LAX_WENDROFF.replace("u[i+1]", "u[x]").replace("u[i-1]", "u[i+1]").replace("u[x]", "u[i-1]")
    left = half_line(mirrored, '"u[1] = 3*u[0] - u[-1]"', 0, "left")
    one, other = found(right), found(left)
    assert list(one.indices["R"]) == [-i for i in other.indices["R"]]
    ours, theirs = ([complex(*map(float, v)) for v in e.shapes[0].values["R"]["u"]] for e in (one, other))
    assert ours == pytest.approx(theirs, abs=1e-15)
    for a, b in zip(one.components, other.components, strict=True):
        assert a.kappa is not None and b.kappa is not None
        assert complex(*map(float, a.kappa)) * complex(*map(float, b.kappa)) == pytest.approx(1)


def test_profile_of_a_coupled_system() -> None:
    scheme = system(YEE, ("s[-1] = s[0]", "u[-1] = 3*u[0]"))
    result = analyse(scheme, scheme.values({"lam": "1/2"}))
    for k, mode in enumerate(result.modes):
        if mode.kind is not ModeKind.INADMISSIBLE and mode.modulus:
            assert residual(profile(result, k, 12)) < ROUNDING


def test_profile_of_a_scheme_beyond_elimination() -> None:
    closure = [f"u[{-k}] = 2*u[{-k + 1}] - u[{-k + 2}]/3" for k in (1, 2, 3)] + ["u[-4] = 4*u[0]"]
    scheme = written(lax_wendroff(4, INFLOW), closure)
    result = analyse(scheme, scheme.values({"lam": "9/10"}))
    assert result.tier != "exact" and result.modes
    for k in range(len(result.modes)):
        each = profile(result, k, 12)
        assert residual(each) < ROUNDING
        assert each.certified


def test_profile_of_a_runge_kutta_method_beyond_elimination() -> None:
    """The zero counted is mu = lam s, known to far more bits than a double has; s has to keep them."""
    text = Path(path_of("sbp-4-interface")).read_text().replace("- 48/17*(R.u[0]", "+ 1*(R.u[0]")
    scheme = parse_scheme(text, "a penalty of the wrong sign")
    result = analyse(scheme, scheme.values({"lam": "1"}))
    assert result.tier == "certified" and result.modes[0].kind is ModeKind.GROWING
    each = profile(result, 0, 12)
    assert residual(each) < ROUNDING
    assert each.certified


# Group velocities -----------------------------------------------------------------------------------------------------


def test_the_parasite_of_leapfrog_leaves_the_boundary() -> None:
    # u_t = u_x moves left; at z = -1, kappa = 1 the leapfrog wave moves right at the speed lam, one grid point being 1.
    (part,) = found(half_line(LEAPFROG, '"u[0, n+1] = u[1, n+1]"', 1), lam="1/3").components
    assert list(part.group_velocities) == pytest.approx([1 / 3])


@pytest.mark.parametrize("lam", ["1/4", "3/2", "5/2"])
def test_group_velocity_is_the_slope_of_the_dispersion_relation(lam: str) -> None:
    scheme = half_line(CRANK_NICOLSON, '"u[0, n+1] = -u[1, n]"', 1)
    result = analyse(scheme, scheme.values({"lam": lam}))
    every = [(m, profile(result, k, 4)) for k, m in enumerate(result.modes) if m.kind is ModeKind.GENERALIZED]
    assert every
    for mode, each in every:
        for part in each.components:
            assert part.kappa is not None
            xi = np.angle(complex(*map(float, part.kappa)))
            # tan(omega/2) = lam/2 sin(xi), waves z = exp(i omega) kappa = exp(i xi), velocity -d omega/d xi.
            expected = -float(Fraction(lam)) * np.cos(xi) / (1 + (float(Fraction(lam)) / 2 * np.sin(xi)) ** 2)
            assert list(part.group_velocities) == pytest.approx([expected], abs=1e-12)
            assert expected >= 0 and abs(abs(mode.z_complex) - 1) < 1e-12


def test_glancing_has_velocity_zero() -> None:
    # Crank-Nicolson at lam = 2 with u[0, n+1] = u[1, n]: the generalized eigenvalue where cos(xi) = 0.
    each = found(half_line(CRANK_NICOLSON, '"u[0, n+1] = u[1, n]"', 1), lam="2", cells=4)
    assert each.mode.kind is ModeKind.GENERALIZED
    assert [part.group_velocities for part in each.components] == [(0.0,)]


def test_decaying_components_have_no_group_velocity() -> None:
    each = found(half_line(BACKWARD_CENTRED, '"u[0, n+1] = u[0, n] + lam*(u[1, n] - u[0, n])"', 1), lam="3/2")
    assert each.mode.kind is ModeKind.EIGENVALUE and each.mode.z == number("-1")
    assert all(part.group_velocities == () for part in each.components)
    assert [abs(float(part.modulus)) for part in each.components] == [pytest.approx(1 / 3)]


# Output, refusals, properties -----------------------------------------------------------------------------------------


def test_json_and_csv_hold_the_same_values() -> None:
    each = load("traditional-1").profile(alpha=5, cells=6)
    data = json.loads(json.dumps(each.to_json(), allow_nan=False))
    assert data["schema"] == "gks.profile/1" and data["dimension"] == 1
    rows = list(csv.DictReader(io.StringIO(each.to_csv())))
    from_csv = {(r["domain"], r["unknown"], int(r["index"])): [float(r["re"]), float(r["im"])] for r in rows}
    from_json = {
        (domain, unknown, i): value
        for domain, block in data["shapes"][0]["values"].items()
        for unknown, mine in block.items()
        if unknown != "index"
        for i, value in zip(block["index"], mine, strict=True)
    }
    assert from_csv == from_json
    assert "growing" in str(each)


def test_refusals() -> None:
    stable = load("weighted-1").modes()
    with pytest.raises(NotAnalysable, match="no mode"):
        profile(stable, 0)
    with pytest.raises(InputError, match="no mode 9"):
        profile(stable, 9)
    with pytest.raises(InputError, match="grid points"):
        profile(load("traditional-1").modes(), 0, 0)


def test_enough_points_for_the_mode_to_fade() -> None:
    each = profile(load("traditional-1").modes(alpha=5))
    slowest = max(float(p.modulus) for p in each.components if p.kappa is not None and p.domain == "R")
    assert len(each.indices["R"]) >= log(1e-3) / log(slowest)


INTERFACE = """
title = "random interface"
[parameters]
lam = {{ role = "cfl", default = 0.5 }}
[interior]
scheme = "{scheme}"
[domains.L]
side = "left"
unknowns = ["u"]
flux = [["{left}"]]
[domains.R]
side = "right"
unknowns = ["u"]
flux = [["{right}"]]
[closure]
equations = ["L.u[1] = {a}*R.u[0] + ({b})*L.u[0] + ({c})*L.u[-1]", "R.u[-1] = ({d})*L.u[0] + ({e})*R.u[0]"]
"""


@examples(25)
@given(
    weights=st.lists(st.integers(-3, 3), min_size=5, max_size=5),
    speeds=st.tuples(st.sampled_from([-1, 1]), st.sampled_from([-1, 1])),
)
def test_random_interfaces(weights: list[int], speeds: tuple[int, int]) -> None:
    names = dict(zip("abcde", weights, strict=True))
    text = INTERFACE.format(scheme="lax-wendroff", left=speeds[0], right=speeds[1], **names)
    try:
        scheme = LoadedScheme(parse_scheme(text, "random"))
        result = scheme.modes()
    except InputError:
        return  # the closure is degenerate, or does not read an unknown
    for k, mode in enumerate(result.modes):
        if mode.kind is not ModeKind.INADMISSIBLE and mode.modulus:
            each = profile(result, k, 12)
            for shape in range(len(each.shapes)):
                assert residual(each, shape) < ROUNDING
