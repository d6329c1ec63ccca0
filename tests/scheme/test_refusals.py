# ruff: noqa: E501 - tables of messages, one a line
"""Every refusal of the reader: line, column, entry, what was found, what was expected and what would mend it."""

from __future__ import annotations

import pytest

from tests.scheme.examples import IN_LINES, INTERFACE, LEAPFROG, changed, read, refusal

ALPHA = "default = 1, range = [1e-4, 1e4]"
U_I = '"L.u[1] = u_I"'
BOUND = 'bound  = "min(1, 4/(1 + 1/alpha))"'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        # the file
        ('title  = "Traditional coupling, first order"', "", "1:1: the file has no title; expected title"),
        ('"Traditional coupling, first order"', '" "', "1:10: title: the title is empty"),
        ("title  =", "titel =", '1:1: titel: unknown key "titel"; the keys here are title, source, notes, '),
        ("source =", "source", "2:8: it is not valid TOML: expected '="),
        ("[closure]", "[closure", "22:9: it is not valid TOML: expected ']'"),
        ("[interior]", "[parameters]", "8:12: it is not valid TOML: cannot declare"),
        # parameters
        ("[parameters]", "[[parameters]]", "4:3: parameters: found an array; expected a table"),
        ("alpha =", "beta =", '20:23: domains.R.flux[0][1]: "alpha" is not defined; the names here are lam, beta'),
        ("alpha =", "n =", '6:1: parameters.n: "n" is a word of the formula language; take another name'),
        ("alpha =", '"a b" =', '6:1: parameters."a b": "a b" is no name: it has " "'),
        ("alpha =", "2a =", '6:1: parameters."2a": "2a" is no name; a name has letters'),
        (
            "alpha =",
            '"αlpha" =',
            '6:1: parameters."αlpha": "αlpha" is no name: it has "α" (U+03B1 GREEK SMALL LETTER ALPHA)',
        ),
        ("alpha =", "u =", '14:13: domains.L.unknowns[0]: "u" is a parameter already'),
        ('role = "cfl", ', "", "4:2: parameters: no parameter is the CFL number; expected exactly one"),
        ('"cfl"', '"CFL"', '5:18: parameters.lam.role: found the string "CFL"; the only role is "cfl"'),
        (ALPHA, 'role = "cfl"', "6:1: parameters.alpha: lam and alpha are both CFL numbers; expected exactly one"),
        (
            ALPHA,
            "defualt = 1",
            '6:11: parameters.alpha.defualt: unknown key "defualt"; the keys here are role, default, range, doc; did you mean "default"?',
        ),
        (ALPHA, "default = nan", "6:21: parameters.alpha.default: found nan; expected a number"),
        (ALPHA, "default = -inf", "6:21: parameters.alpha.default: found -inf; expected a finite number"),
        (
            ALPHA,
            "default = 1e10001",
            '6:21: parameters.alpha.default: the decimal exponent "10001" is over the limit 10000',
        ),
        (ALPHA, "default = 1" + "0" * 4000, "6:21: a value of 4001 characters, and numbers have at most 4000"),
        (ALPHA, "default = 0x" + "f" * 3900, "6:21: parameters.alpha.default: a number of over 4000 digits"),
        (ALPHA, "default = true", "6:21: parameters.alpha.default: found true; expected a number"),
        (ALPHA, "default = 1979-05-27", "6:21: parameters.alpha.default: found a date or time; expected a number"),
        (ALPHA, 'default = "1/lam"', '6:24: parameters.alpha.default: "lam" is not defined'),
        (ALPHA, 'default = "sqrt(2)"', "6:21: parameters.alpha.default: an irrational number; values are rational"),
        ("default = 0.9", "default = 0", "5:35: parameters.lam.default: found 0; dt/dx is positive"),
        (ALPHA, "range = [2, 1]", "6:19: parameters.alpha.range: found [2, 1]; expected lo < hi"),
        (ALPHA, "range = [1, 1]", "6:19: parameters.alpha.range: found [1, 1]; expected lo < hi"),
        (ALPHA, "range = [inf, -inf]", "6:19: parameters.alpha.range: found [inf, -inf]; expected lo < hi"),
        (ALPHA, "range = [nan, 1]", "6:20: parameters.alpha.range[0]: found nan; expected a number"),
        (ALPHA, "range = [1]", "6:19: parameters.alpha.range: found 1 end; expected [lo, hi]"),
        # definitions
        (
            "[interior]",
            '[definitions]\na = "b"\nb = "1 + a"\n[interior]',
            "10:10: definitions.b: the shorthands go in a circle: a -> b -> a",
        ),
        (
            "[interior]",
            '[definitions]\na = "1 + a"\n[interior]',
            "9:10: definitions.a: the shorthands go in a circle: a -> a",
        ),
        ("[interior]", '[definitions]\nlam = "1"\n[interior]', '9:1: definitions.lam: "lam" is a parameter already'),
        (
            "[interior]",
            '[definitions]\na = "L.u[0]"\n[interior]',
            "9:6: definitions.a: a grid value; a definition holds parameters only",
        ),
        (
            "[interior]",
            '[definitions]\nu = "1"\n[interior]',
            '16:13: domains.L.unknowns[0]: "u" is a definition already',
        ),
        # domains
        (
            "[domains.L]",
            "[domains.M]\n[domains.L]",
            "12:2: domains: found 3 domains; expected one half-line, or one on each side",
        ),
        ("[domains.L]", "[domains.n]", '12:2: domains.n: "n" is a word of the formula language'),
        (
            'side     = "left"',
            'side     = "right"',
            "18:12: domains.R.side: both domains are on the right; two half-lines meet",
        ),
        (
            'side     = "left"',
            'side     = "links"',
            '13:12: domains.L.side: found "links"; expected "left" (x < 0) or "right" (x > 0)',
        ),
        ('side     = "left"', "", "12:2: domains.L: the domain has no side; expected side = ..."),
        ('unknowns = ["u", "s"]', 'unknowns = ["u", "u"]', '14:18: domains.L.unknowns[1]: "u" is an unknown already'),
        ('unknowns = ["u", "s"]', "unknowns = []", "14:12: domains.L.unknowns: found 0 unknowns; expected 1 to 16"),
        (
            'unknowns = ["u", "s"]',
            'unknowns = "u"',
            '14:12: domains.L.unknowns: found the string "u"; expected an array [...]',
        ),
        (
            '[["0", "-1"], ["-1", "0"]]',
            '[["0", "-1"]]',
            "15:12: domains.L.flux: found 1 row; expected 2, one for each unknown",
        ),
        (
            '[["0", "-1"], ["-1", "0"]]',
            '[["0", "-1"], ["-1"]]',
            "15:26: domains.L.flux[1]: found 1 in a row; expected 2, one for each unknown",
        ),
        (
            '[["0", "-1"], ["-1", "0"]]',
            '[["0", "-1"], ["1/(1 - 1)", 0]]',
            "15:29: domains.L.flux[1][0]: division by zero",
        ),
        (
            '[["0", "-1"], ["-1", "0"]]',
            '[["0", "-1"], ["u[0]", 0]]',
            "15:28: domains.L.flux[1][0]: a grid value; the flux holds parameters only",
        ),
        ('[["0", "-1"], ["-1", "0"]]', '[["0", "-1"], ["1", 0]]', "15:12: domains.L.flux: the flux is not hyperbolic"),
        (
            'flux     = [["0", "-1"], ["-1", "0"]]',
            "",
            "12:2: domains.L: the domain has no flux; upwind1 discretises q_t + flux q_x = 0; add flux",
        ),
        # interiors
        ('"upwind1"', '"upwind4"', '9:9: interior.space: there is no space "upwind4"; the named ones are upwind1, '),
        (
            '"forward-euler"',
            '"euler"',
            '10:9: interior.time: there is no time "euler"; the named ones are forward-euler, ',
        ),
        (
            'space = "upwind1"',
            'scheme = "fromm"',
            "10:1: interior.time: both scheme and time; a named scheme is fully discrete",
        ),
        (
            'space = "upwind1"',
            "",
            "12:2: domains.L: the domain has no space; expected space and time, or scheme, in [interior] or here",
        ),
        (
            'space = "upwind1"\ntime  = "forward-euler"',
            "",
            "11:2: domains.L: the domain has no interior scheme; expected",
        ),
        (
            'side     = "left"',
            'side     = "left"\ninterior = []\nspace = "fromm"',
            "15:1: domains.L.space: both interior and space; ",
        ),
        (
            'side     = "left"',
            'side     = "left"\ninterior = ["u[i]=0"]',
            "14:12: domains.L.interior: found 1 equation; expected 2, one for each of the unknowns u, s",
        ),
        # closures
        (
            's_I = "R.s[0]"',
            's_I = "R.s[0] + x", x = "2*s_I"',
            "23:52: closure.let.x: the shorthands go in a circle: s_I -> x -> s_I",
        ),
        ('s_I = "R.s[0]"', 'alpha = "R.s[0]"', '23:25: closure.let.alpha: "alpha" is a parameter already'),
        ('s_I = "R.s[0]"', 's = "R.s[0]"', '23:25: closure.let.s: "s" is an unknown of R already'),
        (
            "let =",
            "lets =",
            '23:1: closure.lets: unknown key "lets"; the keys here are let, equations; did you mean "let"?',
        ),
        (U_I, "1", "25:3: closure.equations[0]: found 1; expected a string"),
        (
            U_I,
            '"L.u[1] = v_I"',
            '25:13: closure.equations[0]: "v_I" is not defined; the names here are lam, alpha, u_I, s_I; did you mean "u_I"?',
        ),
        (
            U_I,
            '"L.u[i+1] = u_I"',
            '25:8: closure.equations[0]: found "i" in an index; an index in a closure is an integer',
        ),
        (U_I, '"L.u[65] = u_I"', "25:8: closure.equations[0]: an offset of 65; the limit is 64"),
        (
            U_I,
            '"L.u[1] = u_I + 1"',
            "25:19: closure.equations[0]: a constant term, without a grid value; equations are homogeneous",
        ),
        (
            U_I,
            '"dt(L.u[1]) = L.u[0, n-1]"',
            "25:3: closure.equations[0]: several time levels in a method-of-lines equation",
        ),
        # the count
        (
            ', "R.s[-1] = s_I"',
            "",
            '26:3: closure.equations[2]: the scheme reads 4 boundary values and 3 equations were given; "R.s[-1]" has none: add an equation for it',
        ),
        (
            ', "R.s[-1] = s_I"',
            ', "R.u[-1] = s_I", "L.u[1] = 0"',
            "26:37: closure.equations[4]: the scheme reads 4 boundary values and 5 equations were given; ",
        ),
        (
            '"R.s[-1] = s_I"',
            '"R.s[-2] = s_I"',
            '26:20: closure.equations[3]: the scheme reads 5 boundary values and 4 equations were given; "R.s[-1]" has none',
        ),
        (
            '"upwind1"',
            '"upwind2"',
            '26:20: closure.equations[3]: the scheme reads 8 boundary values and 4 equations were given; "L.u[2]", "L.s[2]", "R.u[-2]", "R.s[-2]" have none: add an equation for each',
        ),
        # claims
        (BOUND, "", "29:3: claims[0]: the claim states nothing; expected bound, stable or modulus"),
        (
            BOUND,
            "stable = true",
            "31:1: claims[0].stable: stable without parameter values; expected at = {...} beside it",
        ),
        (BOUND, "stable = 1\nat = {}", "31:10: claims[0].stable: found 1; expected true or false"),
        (BOUND, BOUND + "\nstable = true", "31:1: claims[0].bound: both bound and stable; a claim states one thing"),
        (BOUND, 'bound = "lam"', "31:9: claims[0].bound: a bound on lam that holds lam"),
        (
            BOUND,
            'bound = "min(1, 4/(1 + 1/alpa))"',
            '31:26: claims[0].bound: "alpa" is not defined; the names here are lam, alpha; did you mean "alpha"?',
        ),
        (
            BOUND,
            "bound = 1\nat = { alpah = 1 }",
            '32:8: claims[0].at.alpah: unknown key "alpah"; the keys here are lam, alpha; did you mean "alpha"?',
        ),
        (BOUND, "bound = 1\nat = { lam = -1 }", "32:14: claims[0].at.lam: found -1; dt/dx is positive"),
        (BOUND, "bound = inf", '31:9: claims[0].bound: found inf; expected a formula "..." or a number'),
        ('source = "Theorem 3.1"', "", "29:3: claims[0]: the claim has no source"),
    ],
)
def test_refusals_of_the_interface(old: str, new: str, message: str) -> None:
    assert refusal(INTERFACE, (old, new)).startswith(f"example.toml:{message}")


INTERIOR = 'interior = ["u[i, n+1] = u[i, n-1] + lam*(u[i+1] - u[i-1])"]'


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("u[i-1])", "u[i-1]]", '9:58: domains.R.interior[0]: found "]" inside parentheses; expected ")"'),
        (
            INTERIOR,
            'interior = ["dt(u[i]) = u[i+1] - u[i-1]"]',
            "9:1: domains.R.interior: dt(...) and no time integrator",
        ),
        (
            INTERIOR,
            'interior = ["u[i] = u[i+1] - u[i-1]"]',
            "9:12: domains.R.interior: all values are at one time level",
        ),
        ("first    = 1", 'first = 1\ntime = "rk4"', "11:1: domains.R.time: a time integrator and no dt(...)"),
        ("first    = 1", "first    = 65", "10:12: domains.R.first: found 65; the limit is 64"),
        ("first    = 1", "first    = 1.0", "10:12: domains.R.first: found 1.0; expected an integer"),
        ("first    = 1", "first    = true", "10:12: domains.R.first: found true; expected an integer"),
        (
            "u[0, n+1] = u[1, n+1]",
            "dt(u[0]) = u[1]",
            "13:15: closure.equations[0]: dt(...) of R.u[0]; R is fully discrete",
        ),
        (
            '"u[0, n+1] = u[1, n+1]"',
            "",
            "13:13: closure.equations: the scheme reads 1 boundary value and 0 equations were given",
        ),
        (
            '\n[closure]\nequations = ["u[0, n+1] = u[1, n+1]"]\n',
            "",
            '1:1: the scheme reads 1 boundary value and 0 equations were given; "R.u[0]" has none',
        ),
    ],
)
def test_refusals_of_the_leapfrog_scheme(old: str, new: str, message: str) -> None:
    assert refusal(LEAPFROG, (old, new)).startswith(f"example.toml:{message}")


@pytest.mark.parametrize("time", ["rk2", "ssprk3", "rk4", "exact"])
def test_several_levels_need_a_multistep_integrator(time: str) -> None:
    text = changed(LEAPFROG, IN_LINES, ("u[1, n+1]", "u[1]"))
    read(text)
    message = refusal(text, ('"ab2"', f'"{time}"'))
    assert "example.toml:14:14: closure.equations[0]: several time levels under " + time in message
    assert "a multistep integrator: forward-euler, backward-euler, crank-nicolson, leapfrog, ab2, ab3, bdf2;" in message


@pytest.mark.parametrize(
    ("quoted", "line", "column"),
    [
        ("'u[0, n+1] = u[1, m+1]'", 13, 32),
        ('"""u[0, n+1] = u[1, m+1]"""', 13, 34),
        ("'''\nu[0, n+1] =\n  u[1, m+1]'''", 15, 8),
        ('"u[0, n+1] = \\u0075[1, m+1]"', 13, 14),
    ],
)
def test_columns_inside_all_kinds_of_strings(quoted: str, line: int, column: int) -> None:
    message = refusal(LEAPFROG, ('"u[0, n+1] = u[1, n+1]"', quoted))
    assert message.startswith(f'example.toml:{line}:{column}: closure.equations[0]: found "m" in an index')
