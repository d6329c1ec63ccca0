"""Which computations the report of a scheme needs: those its sections have a use for, and no others."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from gks.reports.steps import LIMIT, Step
from gks.scheme.model import Parameter, Scheme

CURVE_POINTS = 121
WINDOW = 10**4
"""A quantity without ends is swept from its default divided by this to its default times this."""

PATH_LIMIT = 20.0
"""Seconds for the paths of the roots, which are a picture and decide nothing."""

PROOF_LIMIT = 30.0
"""Seconds for a theorem; the curve stands in for what is not proved by then."""


def plan(scheme: Scheme) -> tuple[Step, ...]:
    """The steps of a scheme's report, those that take longest first."""
    source = scheme.text, scheme.name, scheme.path
    values = {name: str(value) for name, value in _defaults(scheme).items()}
    named, sweep = _named(scheme), sweep_of(scheme)
    setting = "".join(f" -p {name}={value}" for name, value in values.items())
    free = swept(scheme)
    fixed = {name: value for name, value in values.items() if free is None or name != free.name}
    without_lam = {name: value for name, value in fixed.items() if name != scheme.cfl}
    others = "".join(f" -p {name}={value}" for name, value in without_lam.items())
    proof = {"values": without_lam, "limit": PROOF_LIMIT}
    over = f" --sweep {sweep}" if sweep else ""
    path = sweep or lam_sweep(scheme)
    moving = {name: value for name, value in values.items() if name != path.partition("=")[0]}
    at = "".join(f" -p {name}={value}" for name, value in moving.items())
    follow = f"gks roots {named}{at} --sweep {path}"
    steps = [
        Step("curve", "steps.curve", {"values": values, "sweep": sweep}, source, f"gks curve {named}{others}{over}"),
        Step("theorem", "steps.theorem", proof, source, f"gks prove {named}{others}", LIMIT + PROOF_LIMIT),
        Step("modes", "steps.modes", {"values": values}, source, f"gks modes {named}{setting}"),
        Step("radius", "steps.radius", {"values": values, "sweep": sweep}, source),
        Step("roots", "steps.roots", {"values": moving, "sweep": path}, source, follow, PATH_LIMIT),
        Step("profile", "steps.profile", {"values": values}, source, f"gks profile {named}{setting}"),
        Step("march", "steps.march", {"values": values}, source, f"gks march {named}{setting}"),
        Step("derive", "steps.derive", {}, source, f"gks derive {named}"),
    ]
    if scheme.claims:
        steps.insert(0, Step("audit", "steps.audit", {}, source, f"gks audit {named}", 3 * LIMIT))
    if semi_discrete(scheme):  # no lam_max comes of it, and no theorem in lam
        steps = [step for step in steps if step.name not in ("curve", "theorem", "radius")]
    return tuple(steps)


def semi_discrete(scheme: Scheme) -> bool:
    """Whether time is exact."""
    return any(half_line.time == "exact" for half_line in scheme.domains)


def _defaults(scheme: Scheme) -> Mapping[str, Fraction]:
    """The defaults, with a middle of the range for a parameter that has none."""
    given = {p.name: _middle(p) for p in scheme.parameters if p.default is None}
    return scheme.values(given)


def _middle(parameter: Parameter) -> Fraction:
    low, high = parameter.low, parameter.high
    if low is not None and high is not None:
        return (low + high) / 2
    if low is not None:
        return low + 1
    return Fraction(0) if high is None else high - 1


def swept(scheme: Scheme) -> Parameter | None:
    """The parameter that curves and theorems run over: the first ranged one that is not the CFL number."""
    return next((p for p in scheme.parameters if p.ranged and p.role is None), None)


def sweep_of(scheme: Scheme) -> str | None:
    """The sweep over it, as --sweep has it; None where nothing runs."""
    parameter = swept(scheme)
    if parameter is None:
        return None
    low, high = parameter.low, parameter.high
    centre = _defaults(scheme)[parameter.name]
    if low == 0 and centre > 0:
        low = (min(centre, high / 2) if high is not None else centre) / WINDOW
    if low is not None and low > 0:
        top = high if high is not None else max(centre, low) * WINDOW
        if top > 100 * low:
            return f"{parameter.name}={low}:{top}:{CURVE_POINTS}:log"
        return _inside(parameter.name, low, top)
    first = low if low is not None else min(centre, high - 10 if high is not None else centre) - 10
    last = high if high is not None else max(centre, first + 10) + 10
    return _inside(parameter.name, first, last)


def lam_sweep(scheme: Scheme) -> str:
    """A sweep over the CFL number itself, to half as much again as its default."""
    top = Fraction(3, 2) * _defaults(scheme)[scheme.cfl]
    return f"{scheme.cfl}={top / CURVE_POINTS}:{top}:{CURVE_POINTS}"


def _inside(name: str, low: Fraction, high: Fraction) -> str:
    """Equal steps that keep off the ends, which are open."""
    margin = (high - low) / (2 * CURVE_POINTS)
    return f"{name}={low + margin}:{high - margin}:{CURVE_POINTS}"


def _named(scheme: Scheme) -> str:
    """The scheme as a command line has it: its name where it is shipped, else its file."""
    from gks import catalogue

    if scheme.name in catalogue.names() and scheme.path == catalogue.path(scheme.name):
        return scheme.name
    return scheme.path or f"{scheme.name}.toml"
