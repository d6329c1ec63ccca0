"""The scheme format: its two examples, what each key means, and every refusal with its place."""

from __future__ import annotations

import pickle
from fractions import Fraction
from pathlib import Path

import pytest

from gks.errors import SchemeError
from gks.scheme.document import Document
from gks.scheme.domains import read_domains
from gks.scheme.forms import ZeroTest
from gks.scheme.formula import Context
from gks.scheme.limits import Work
from gks.scheme.model import (
    GridValue,
    HalfLine,
    NamedLines,
    NamedScheme,
    Parameter,
    Scheme,
    WrittenDiscrete,
    WrittenLines,
)  # fmt: skip
from gks.scheme.schemefile import read_scheme
from tests.scheme.examples import IN_LINES, INTERFACE, LEAPFROG, read


def equations(scheme: Scheme) -> list[dict[str, str]]:
    return [{str(v): str(c) for v, c in equation.form.terms} for equation in scheme.closure.equations]


# --- the examples --------------------------------------------------------------------------------------------------


def test_two_half_lines_and_an_interface() -> None:
    scheme = read(INTERFACE)
    assert (scheme.title, scheme.name, scheme.path) == ("Traditional coupling, first order", "example", "example.toml")
    assert (scheme.source, scheme.notes) == ("Banks & Sjögreen, eq. (3.6)", "")
    assert scheme.parameters == (
        Parameter("lam", "cfl", Fraction(9, 10), Fraction(0), None, False, ""),
        Parameter("alpha", None, Fraction(1), Fraction(1, 10**4), Fraction(10**4), True, "kappa_R / kappa_L"),
    )
    left, right = scheme.domains
    assert (left.name, left.side, left.unknowns, left.first) == ("L", "left", ("u", "s"), 0)
    assert left.interior == right.interior == NamedLines("upwind1", "forward-euler")
    assert right.flux is not None and [[str(f) for f in row] for row in right.flux] == [
        ["0", "-1/alpha"],
        ["-alpha", "0"],
    ]
    assert equations(scheme) == [
        {"L.u[1]": "1", "L.u[0]": "-1"},
        {"L.s[1]": "1", "R.s[0]": "-1"},
        {"R.u[-1]": "1", "L.u[0]": "-1"},
        {"R.s[-1]": "1", "R.s[0]": "-1"},
    ]
    assert (scheme.closure.equations[1].line, scheme.closure.equations[1].column) == (25, 20)
    assert [str(value) for value in scheme.boundary_unknowns] == ["L.u[1]", "L.s[1]", "R.u[-1]", "R.s[-1]"]
    (claim,) = scheme.claims
    assert (claim.source, claim.line, claim.column) == ("Theorem 3.1", 29, 3)
    assert claim.bound is not None and claim.bound.at({"alpha": Fraction(1)}) == 1


def test_one_half_line_with_an_update_written_out() -> None:
    scheme = read(LEAPFROG)
    (domain,) = scheme.domains
    assert (domain.first, domain.flux) == (1, None)
    assert isinstance(domain.interior, WrittenDiscrete)
    (form,) = domain.interior.equations
    assert form.levels == (-1, 1) and not form.holds_dt
    assert scheme.boundary_unknowns == (GridValue("R", "u", 0, 0),)


def test_crlf_and_a_byte_order_mark_change_nothing(tmp_path: Path) -> None:
    path = tmp_path / "leapfrog.toml"
    path.write_bytes(b"\xef\xbb\xbf" + LEAPFROG.replace("\n", "\r\n").encode())
    scheme, plain = read_scheme(path), read(LEAPFROG)
    assert (scheme.name, scheme.path) == ("leapfrog", str(path))
    assert (scheme.parameters, scheme.domains, scheme.closure) == (plain.parameters, plain.domains, plain.closure)


def test_a_scheme_survives_pickling() -> None:
    scheme = read(INTERFACE)
    assert pickle.loads(pickle.dumps(scheme)) == scheme


# --- parameters and definitions ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "default", "low", "high", "ranged"),
    [
        ("alpha = 0.1", Fraction(1, 10), Fraction(0), None, False),
        ("alpha = { default = 1e-300 }", Fraction(1, 10**300), Fraction(0), None, False),
        ('alpha = { default = "31/9" }', Fraction(31, 9), Fraction(0), None, False),
        ("alpha = {}", None, Fraction(0), None, False),
        ("alpha = { range = [-inf, inf] }", None, None, None, True),
        ("alpha = { default = 5, range = [-2, +inf] }", Fraction(5), Fraction(-2), None, True),
        ('alpha = { range = ["-1/3", 1_0.5] }', None, Fraction(-1, 3), Fraction(21, 2), True),
        ("alpha.default = 0x10", Fraction(16), Fraction(0), None, False),
    ],
)
def test_parameters(
    line: str, default: Fraction | None, low: Fraction | None, high: Fraction | None, ranged: bool
) -> None:
    old = 'alpha = { default = 1, range = [1e-4, 1e4], doc = "kappa_R / kappa_L" }'
    parameter = read(INTERFACE, (old, line)).parameter("alpha")
    assert parameter == Parameter("alpha", None, default, low, high, ranged, "")


def test_definitions_in_any_order_share_their_parts() -> None:
    scheme = read(
        INTERFACE,
        ("[interior]", '[definitions]\nz = "x + y"\nx = "1/alpha"\ny = "2*x"\nw = 0.5\n[interior]'),
        ('"-1/alpha"', '"-z*w"'),
    )
    flux = scheme.half_line("R").flux
    assert flux is not None and flux[0][1].at({"alpha": Fraction(3)}) == Fraction(-1, 2)


def test_long_chains_of_definitions() -> None:
    chain = "\n".join(f'x{k} = "x{k + 1}"' for k in range(2000))
    scheme = read(
        INTERFACE, ("[interior]", f'[definitions]\n{chain}\nx2000 = "alpha"\n[interior]'), ('"-alpha"', '"-x0"')
    )
    assert scheme.domains == read(INTERFACE).domains


# --- interiors -----------------------------------------------------------------------------------------------------


def interior(domain: str, common: str = "") -> HalfLine:
    """The half-line whose table ends in these lines, whatever closure it will need."""
    text = f'[interior]\n{common}\n[domains.R]\nside = "right"\n{domain}'
    work = Work()
    (line,) = read_domains(Document(text, "x").root.table(), Context({}, ZeroTest({}, work), work), {})
    return line


FLUX = 'unknowns = ["u"]\nflux = [[1]]\n'


@pytest.mark.parametrize(
    ("domain", "common", "expected"),
    [
        (FLUX, 'space = "central4"\ntime = "rk4"', NamedLines("central4", "rk4")),
        (FLUX, 'scheme = "lax-wendroff"', NamedScheme("lax-wendroff")),
        (FLUX + 'time = "ab2"', 'space = "central4"\ntime = "rk4"', NamedLines("central4", "ab2")),
        (FLUX + 'space = "upwind1"', 'time = "rk4"', NamedLines("upwind1", "rk4")),
        (FLUX + 'scheme = "fromm"', 'space = "central4"\ntime = "rk4"', NamedScheme("fromm")),
        (FLUX + 'space = "fromm"\ntime = "exact"', 'scheme = "fromm"', NamedLines("fromm", "exact")),
    ],
)
def test_a_domain_overrides_the_common_interior(domain: str, common: str, expected: object) -> None:
    assert interior(domain, common).interior == expected


def test_written_interiors_may_stand_beside_a_common_one() -> None:
    line = interior('unknowns = ["u"]\ninterior = ["dt(u[i+1, n+1]) = u[i+1, n+1] - u[i, n+1]"]', 'time = "bdf2"')
    assert isinstance(line.interior, WrittenLines) and line.interior.time == "bdf2" and line.lines
    assert [str(value) for value, _ in line.interior.equations[0].terms] == ["dt(R.u[1])", "R.u[1]", "R.u[0]"]
    assert isinstance(
        interior('unknowns = ["u"]\ninterior = ["u[i, n+1] = u[i-1]"]', 'time = "rk4"').interior, WrittenDiscrete
    )


def test_each_domain_may_have_its_own_kind() -> None:
    scheme = read(
        INTERFACE,
        (
            'flux     = [["0", "-1"], ["-1", "0"]]',
            'interior = ["u[i, n+1] = u[i] + lam*(u[i+1] - u[i])", "s[i, n+1] = s[i]"]',
        ),
        (',  "L.s[1] = s_I"', ""),
    )
    left, right = scheme.domains
    assert (left.time, right.time, left.lines, right.lines) == (None, "forward-euler", False, True)


# --- closures ------------------------------------------------------------------------------------------------------


def test_a_closure_may_have_its_own_ode() -> None:
    scheme = read(LEAPFROG, IN_LINES, ("u[0, n+1] = u[1, n+1]", "dt(u[0, n+1]) = u[1, n+1] - u[0, n+1]"))
    assert equations(scheme) == [{"dt(R.u[0])": "1", "R.u[1]": "-1", "R.u[0]": "1"}]


def test_levels_stay_as_written() -> None:
    assert equations(read(LEAPFROG))[0].keys() == {"R.u[0, n+1]", "R.u[1, n+1]"}
    assert equations(read(LEAPFROG, IN_LINES, ("u[1, n+1]", "u[1, n]")))[0].keys() == {"R.u[0, n+1]", "R.u[1]"}


def test_no_closure_is_needed_where_nothing_is_read() -> None:
    scheme = read(
        LEAPFROG, ("u[i+1] - u[i-1]", "u[i+1] - u[i]"), ('[closure]\nequations = ["u[0, n+1] = u[1, n+1]"]\n', "")
    )
    assert scheme.boundary_unknowns == () and scheme.closure.equations == ()


# --- claims --------------------------------------------------------------------------------------------------------


def test_claims_keep_the_digits_printed() -> None:
    (claim,) = read(
        INTERFACE, ('bound  = "min(1, 4/(1 + 1/alpha))"', 'modulus = 1.0010120\nat = { lam = 0.9, alpha = "1/3" }')
    ).claims
    assert claim.texts == {"modulus": "1.0010120"} and claim.modulus is not None
    assert claim.modulus.at({}) == Fraction(1001012, 10**6)
    assert (
        claim.at == {"lam": Fraction(9, 10), "alpha": Fraction(1, 3)} and claim.bound is None and claim.stable is None
    )


def test_claims_of_stability() -> None:
    (claim,) = read(INTERFACE, ('bound  = "min(1, 4/(1 + 1/alpha))"', "stable = false\nat = { alpha = 1e10 }")).claims
    assert (claim.stable, claim.at) == (False, {"alpha": Fraction(10**10)})


# --- files -------------------------------------------------------------------------------------------------------


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for name, data, words in [
        ("big", b"#" * 1_000_001, "the file has over 1000000 bytes"),
        ("latin", 'title = "x"\n# Sj\xf6green'.encode("latin-1"), ":2:5: the file is not UTF-8 text; save it as UTF-8"),
        ("utf16", LEAPFROG.encode("utf-16"), ":1:1: the file is not UTF-8 text"),
        ("nul", LEAPFROG.encode() + b"\0", ":14:1: it is not valid TOML"),
        ("empty", b"", ":1:1: the file has no title"),
    ]:
        path = tmp_path / name
        path.write_bytes(data)
        with pytest.raises(SchemeError) as caught:
            read_scheme(path)
        assert str(caught.value).startswith(str(path)) and words in str(caught.value)
    for missing in (tmp_path, tmp_path / "nowhere.toml", "nul\0in name"):
        with pytest.raises(SchemeError, match="can't be read"):
            read_scheme(missing)


def test_a_file_of_just_the_limit_is_read(tmp_path: Path) -> None:
    path = tmp_path / "full.toml"
    path.write_text(LEAPFROG + "#" * (1_000_000 - len(LEAPFROG.encode())))
    assert read_scheme(path).domains == read(LEAPFROG).domains


def test_a_bound_may_divide_by_an_extremum() -> None:
    bounds = ["1/min(1, sqrt(lam0), 1/lam0)", "2/(1 + max(lam0, sqrt(2)))"]
    claims = "".join(f'[[claims]]\nsource = "{k}"\nbound = "{bound}"\n' for k, bound in enumerate(bounds))
    scheme = read(LEAPFROG.replace("[parameters]", "[parameters]\nlam0 = 1") + claims)
    assert [str(claim.bound) for claim in scheme.claims] == bounds
    with pytest.raises(SchemeError, match="division by zero"):
        read(LEAPFROG + '[[claims]]\nsource = "zero"\nbound = "1/(min(1, sqrt(2)) - 1)"\n')
