"""Verdicts and their evidence: the result of ``modes``, as objects and as the JSON of the contract."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from fractions import Fraction
from typing import Literal

from gks.modes.numerals import (
    ComplexNumber,
    decimal_text,
    json_complex,
    json_real,
    rounding_of,
    text_complex,
    text_exact,
    text_real,
)
from gks.scheme.model import Scheme
from gks.scheme.numbers import fraction_text


class Verdict(Enum):
    """What the Kreiss condition says at one set of parameter values."""

    STABLE = "stable"
    NEUTRAL = "neutral"
    GENERALIZED = "generalized"
    UNSTABLE = "unstable"
    UNDECIDED = "undecided"

    def __bool__(self) -> bool:
        raise TypeError("a Verdict is not a yes or no; write `v is Verdict.STABLE`")


class ModeKind(Enum):
    """What a root of the characteristic polynomial is.

    GROWING: a normal mode with abs(z) > 1. EIGENVALUE, GENERALIZED: a normal mode on abs(z) = 1, the latter with a
    component that does not decay. DECAYING: a normal mode with abs(z) < 1. INADMISSIBLE: no normal mode, because no
    solution that decays in space belongs to it.
    """

    GROWING = "growing"
    EIGENVALUE = "eigenvalue"
    GENERALIZED = "generalized"
    DECAYING = "decaying"
    INADMISSIBLE = "inadmissible"


Reason = Literal["interior", "closure"]


@dataclass(frozen=True, slots=True)
class Mode:
    """One root z with its multiplicity, what it is, and the spatial factors kappa = u[i+1]/u[i] of each domain.

    ``z`` and ``kappa`` are exact midpoints; ``radius`` bounds the distance of ``z`` from the true root (in JSON, that
    of the rounded number).

    ``multiplicity`` is the order to which the determinant of the decaying solutions vanishes (``order``). Of an
    INADMISSIBLE root it is that of the characteristic polynomial, which counts every choice of spatial roots that
    shares the root; and so for a DECAYING one where no determinant continues into the circle, as at z = 0.
    """

    z: ComplexNumber
    modulus: Fraction
    radius: Fraction
    multiplicity: int
    kind: ModeKind
    kappa: Mapping[str, tuple[ComplexNumber, ...]]
    exact: str | None = None

    @property
    def z_complex(self) -> complex:
        """z in double precision; OverflowError beyond its range."""
        return complex(float(self.z[0]), float(self.z[1]))

    def meets(self, other: Mode) -> bool:
        """Whether the disc of a mode of the same kind overlaps this one's: those of different modes that were told
        apart are disjoint.
        """
        apart = (self.z[0] - other.z[0]) ** 2 + (self.z[1] - other.z[1]) ** 2
        return self.kind is other.kind and apart <= (self.radius + other.radius) ** 2

    def conjugate(self) -> Mode:
        """The mode at the conjugate z, which a scheme with real coefficients has as well."""
        kappa = {name: tuple((real, -imaginary) for real, imaginary in each) for name, each in self.kappa.items()}
        return replace(self, z=(self.z[0], -self.z[1]), kappa=kappa)

    def to_json(self) -> dict[str, object]:
        return {
            "z": json_complex(self.z),
            "modulus": json_real(self.modulus),
            "radius": json_real(self.radius + rounding_of(self.z)),
            "multiplicity": self.multiplicity,
            "kind": self.kind.value,
            "kappa": {domain: [json_complex(k) for k in kappas] for domain, kappas in self.kappa.items()},
        }


def text_modulus(mode: Mode) -> str:
    """abs(z) to 15 digits; where they read 1 and the root is off the circle, by how much, or the bound known of that.

    The distance is (abs(z)**2 - 1)/(abs(z) + 1): nothing cancels, since ``z`` is exact. Three digits of it are printed
    where the radius leaves them.
    """
    text = text_real(mode.modulus)
    off = mode.kind in (ModeKind.GROWING, ModeKind.DECAYING)
    if text != "1" or not (off or (mode.kind is ModeKind.INADMISSIBLE and mode.modulus != 1)):
        return text
    distance = (mode.z[0] ** 2 + mode.z[1] ** 2 - 1) / (mode.modulus + 1)
    if abs(distance) > 1000 * mode.radius:
        return f"1 {'+' if distance > 0 else '-'} {decimal_text(abs(distance), 3)}"
    if not off:
        return text
    most = decimal_text(2 * (abs(distance) + mode.radius), 1)  # twice: rounding to one digit takes off a third at most
    return f"1 {'+' if mode.kind is ModeKind.GROWING else '-'} less than {most}"


@dataclass(frozen=True, slots=True)
class ModesResult:
    """The verdict at one set of parameter values, with the modes that decide it.

    ``solvable`` is False where level n+1 is not determined at these values: a mode at z = oo.
    """

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    verdict: Verdict
    reason: Reason | None
    margin: Fraction | None
    certified: bool
    tier: Literal["exact", "numeric", "certified"]
    modes: tuple[Mode, ...]
    solvable: bool
    because: str
    time_s: float = field(compare=False)

    def to_json(self) -> dict[str, object]:
        modes: list[dict[str, object]] = [mode.to_json() for mode in self.modes]
        if not self.solvable:
            modes.insert(0, _infinite_mode(self.scheme))
        return {
            "schema": "gks.modes/1",
            "parameters": {name: fraction_text(value) for name, value in self.parameters.items()},
            "verdict": self.verdict.value,
            "reason": self.reason,
            "margin": "-oo" if not self.solvable else None if self.margin is None else json_real(self.margin),
            "certified": self.certified,
            "tier": self.tier,
            "modes": modes,
            "because": self.because,
            "time_s": self.time_s,
        }

    def __str__(self) -> str:
        values = ", ".join(f"{name} = {text_exact(value)}" for name, value in self.parameters.items())
        lines = [self.scheme.title, f"  at {values}", f"  {self.verdict.value}: {self.because}"]
        if self.modes:
            lines.append("")
            lines.append(f"  {'z':<46} {'abs(z)':<22} mult  kind")
        for mode in self.modes:
            lines.append(
                f"  {text_complex(mode.z):<46} {text_modulus(mode):<22} {mode.multiplicity:<5} {mode.kind.value}"
            )
        tier = f"{self.tier}, certified" if self.certified and self.tier != "certified" else self.tier
        lines += ["", f"  ({tier}, {self.time_s:.3g} s)"]
        return "\n".join(lines)

    def _repr_latex_(self) -> str:
        rows = r" \\ ".join(
            f"{text_complex(mode.z, latex=True)} & {text_modulus(mode)} & {mode.multiplicity} & "
            rf"\text{{{mode.kind.value}}}"
            for mode in self.modes
        )
        head = rf"\text{{{self.verdict.value}}}"
        if not self.modes:
            return f"${head}$"
        table = rf"\begin{{array}}{{llll}} z & |z| & \text{{mult.}} & \text{{kind}} \\ \hline {rows} \end{{array}}"
        return rf"${head}\qquad {table}$"


def _infinite_mode(scheme: Scheme) -> dict[str, object]:
    """Delta vanishes at z = infinity: the closure does not determine the next level."""
    return {
        "z": "oo",
        "modulus": "oo",
        "radius": 0.0,
        "multiplicity": 1,
        "kind": ModeKind.GROWING.value,
        "kappa": {half_line.name: [] for half_line in scheme.domains},
    }
