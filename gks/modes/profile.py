"""The mode itself: what a normal mode looks like in space, on both sides of the boundary.

A mode is z**n times a sequence in space that solves the interior scheme, decays (or is the limit of one that does) and
satisfies the closure. In every half-line it is the sum over the spatial factors kappa of

    q[i] = kappa**i (c_0 + c_1 i + c_2 i**2 + ...),

one term where kappa is simple, with vectors c over the unknowns; kappa = 0 (infinity on the left) stands for single
values beside the boundary that no interior equation reads. Profiles are scaled so that their largest value is 1.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, factorial, log
from time import perf_counter

from flint import acb, acb_poly, ctx

from gks.errors import NotAnalysable, ParameterError
from gks.modes.algebraic import GUARD_BITS
from gks.modes.crossing import value_fields
from gks.modes.eigenspace import Eigenspace, power
from gks.modes.fibre import at_balls
from gks.modes.numerals import (
    ComplexNumber,
    exact_fraction,
    json_complex,
    json_real,
    midpoint,
    radius_of,
    text_complex,
    text_exact,
    text_real,
)
from gks.modes.verdict import Mode, ModeKind, ModesResult, text_modulus
from gks.scheme.model import HalfLine, Scheme
from gks.scheme.numbers import fraction_text

PRECISIONS = (128, 256, 512, 1024, 2048, 4096, 8192)
"""Bits tried in turn. Spatial roots at distance 2**-b cost b bits for each further root they are close to."""
ACCURACY = 2.0**-64
"""Error of a profile's values that is good enough: beyond a double's rounding of the largest."""
FEWEST, MOST, PLAIN = 8, 60, 24
"""Grid points shown a side: as many as the mode needs to fall to FADED, within these; PLAIN where it does not fall."""
FADED = 1e-3
"""A thousandth, less than a line is wide in a picture: a choice of how many values are shown; none depends on it."""
LARGEST = 100_000
"""Grid points a side that may be asked for."""


@dataclass(frozen=True, slots=True)
class Component:
    """The share of one spatial factor kappa in one half-line.

    ``kappa`` is None for values beside the boundary that no interior equation reads (kappa = 0, on the left infinity).
    ``present``: whether any of the modes has it with a nonzero amplitude; None where that is open.
    ``group_velocities``: where abs(kappa) = 1, of its branches that count, in grid points a step towards larger x.
    """

    domain: str
    kappa: ComplexNumber | None
    modulus: Fraction
    multiplicity: int
    group_velocities: tuple[float, ...]
    present: bool | None

    def to_json(self) -> dict[str, object]:
        return {
            "domain": self.domain,
            "kappa": None if self.kappa is None else json_complex(self.kappa),
            "modulus": json_real(self.modulus),
            "multiplicity": self.multiplicity,
            "group_velocity": list(self.group_velocities),
            "present": self.present,
        }


@dataclass(frozen=True, slots=True)
class Shape:
    """One mode of the space: its coefficients c_0, c_1, ... by component and unknown, and its values.

    ``coefficients`` of a component without kappa are the values themselves, from the outermost grid point inwards.
    ``values[domain][unknown]`` belong to ``Profile.indices[domain]``; ``error`` bounds the error of every value.
    """

    coefficients: tuple[Mapping[str, tuple[ComplexNumber, ...]], ...]
    values: Mapping[str, Mapping[str, tuple[ComplexNumber, ...]]]
    error: Fraction

    def to_json(self, indices: Mapping[str, Sequence[int]]) -> dict[str, object]:
        return {
            "coefficients": [
                {unknown: [json_complex(c) for c in mine] for unknown, mine in each.items()}
                for each in self.coefficients
            ],
            "values": {
                domain: {"index": list(indices[domain])}
                | {unknown: [json_complex(v) for v in mine] for unknown, mine in each.items()}
                for domain, each in self.values.items()
            },
            "error": json_real(self.error),
        }


@dataclass(frozen=True, slots=True)
class Profile:
    """A mode's shapes, one where its space has dimension one, else a basis."""

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    mode: Mode
    number: int
    components: tuple[Component, ...]
    indices: Mapping[str, range]
    shapes: tuple[Shape, ...]
    certified: bool
    time_s: float = field(compare=False)

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.profile/1",
            "parameters": {name: fraction_text(value) for name, value in self.parameters.items()},
            "index": self.number,
            "mode": self.mode.to_json(),
            "dimension": len(self.shapes),
            "components": [each.to_json() for each in self.components],
            "shapes": [shape.to_json(self.indices) for shape in self.shapes],
            "certified": self.certified,
            "time_s": self.time_s,
        }

    def to_csv(self) -> str:
        """One line a value: shape (from 0), domain, unknown, index, re, im, modulus."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["shape", "domain", "unknown", "index", "re", "im", "modulus"])
        for k, shape in enumerate(self.shapes):
            for domain, unknowns in shape.values.items():
                for unknown, values in unknowns.items():
                    for i, value in zip(self.indices[domain], values, strict=True):
                        modulus = abs(complex(*map(float, value)))
                        writer.writerow([k, domain, unknown, i, *json_complex(value), modulus])
        return text.getvalue()

    def __str__(self) -> str:
        values = ", ".join(f"{name} = {text_exact(value)}" for name, value in self.parameters.items())
        mode = self.mode
        lines = [
            self.scheme.title,
            f"  at {values}",
            f"  mode {self.number}: z = {text_complex(mode.z)}, abs(z) = {text_modulus(mode)}, {mode.kind.value}",
        ]
        if len(self.shapes) > 1:
            lines.append(f"  {len(self.shapes)} independent modes belong to this z; a basis of them is given")
        lines += ["", f"  {'domain':<8} {'kappa':<46} {'abs(kappa)':<22} {'mult':<5} {'amplitude':<10} group velocity"]
        for each in self.components:
            lines.append(self._line(each))
        lines += ["", f"  ({'certified' if self.certified else 'numeric'}, {self.time_s:.3g} s)"]
        return "\n".join(lines)

    def _line(self, each: Component) -> str:
        kappa = "values that no cell reads" if each.kappa is None else text_complex(each.kappa)
        modulus = "" if each.kappa is None else text_real(each.modulus)
        share = {True: "nonzero", False: "zero", None: "open"}[each.present]
        speeds = ", ".join(f"{v:.6g}" for v in each.group_velocities)
        return f"  {each.domain:<8} {kappa:<46} {modulus:<22} {each.multiplicity:<5} {share:<10} {speeds}".rstrip()


def profile(result: ModesResult, number: int = 0, cells: int | None = None) -> Profile:
    """The shape of the mode of that place among ``result.modes`` (0: the one of the largest modulus).

    ``cells`` grid points are given a side, by default as many as the mode needs to fade. ParameterError for a place
    that there is not, NotAnalysable for a root that is no mode, or whose shape is beyond the analysis.
    """
    start = perf_counter()
    if not 0 <= number < len(result.modes):
        raise ParameterError(f"there is no mode {number}", expected=f"one of the {len(result.modes)} modes, from 0 on")
    if cells is not None and not 1 <= cells <= LARGEST:
        raise ParameterError(f"{cells} grid points a side", expected=f"a whole number from 1 to {LARGEST}")
    mode = result.modes[number]
    if mode.kind is ModeKind.INADMISSIBLE:
        raise NotAnalysable(
            f"z = {text_complex(mode.z)} is no mode: no solution that decays in space belongs to it",
            expected="an admissible root",
        )
    space, proved = _space_of(result, mode)
    sampler = _Sampler(space)
    amplitudes, counts = sampler.amplitudes(cells)
    with ctx.workprec(amplitudes.bits + GUARD_BITS):
        shapes = [sampler.shape(vector, counts, amplitudes.bits) for vector in amplitudes.vectors]
        components = tuple(sampler.component(k, amplitudes) for k in range(len(space.parts)))
    indices = {h.name: _indices(h, sampler.lowest[h.name], counts[h.name]) for h in result.scheme.domains}
    return Profile(
        result.scheme, result.parameters, mode, number, components, indices, tuple(shapes),
        proved, perf_counter() - start,
    )  # fmt: skip


def _space_of(result: ModesResult, mode: Mode) -> tuple[Eigenspace, bool]:
    """The space of a mode, found again with what its z came from; and whether it is proved to be one."""
    from gks.modes.locate import space_of

    return space_of(result, mode)


def _indices(half_line: HalfLine, lowest: int, count: int) -> range:
    """Grid indices, outwards from the boundary, of so many mirrored places."""
    if half_line.side == "right":
        return range(lowest, lowest + count)
    return range(-lowest, -lowest - count, -1)


@dataclass(frozen=True, slots=True)
class _Amplitudes:
    """A basis of the kernel at a precision."""

    vectors: Sequence[Sequence[acb]]
    bits: int


class _Sampler:
    """Turns amplitudes of columns into values of the unknowns."""

    def __init__(self, space: Eigenspace) -> None:
        self.space, self.scheme = space, space.problem.scheme
        self.lowest = space.problem.lowest
        self.fields = value_fields(space.problem)

    def amplitudes(self, cells: int | None) -> tuple[_Amplitudes, dict[str, int]]:
        """The kernel at the first precision at which every value is accurate; how many values there are a side."""
        counts = self._counts(cells)
        for bits in PRECISIONS if self.space.local is not None else PRECISIONS[1:2]:
            with ctx.workprec(bits + GUARD_BITS):
                vectors = self.space.kernel(bits)
                if vectors is None:
                    continue
                found = _Amplitudes(vectors, bits)
                errors = [shape.error for shape in (self.shape(v, counts, bits) for v in vectors) if shape is not None]
                if all(error < ACCURACY for error in errors) and len(errors) == len(vectors):
                    return found, counts
        raise NotAnalysable("the mode's amplitudes are not told from rounding: spatial roots nearly coincide there")

    def _counts(self, cells: int | None) -> dict[str, int]:
        counts = {}
        for half_line in self.scheme.domains:
            ghosts = self.space.problem.ghosts(half_line.name)
            parts = [p for p in self.space.parts if p.domain == half_line.name and not p.ghosts]
            sizes = [float(abs(part.root.ball(64)).mid()) for part in parts]
            needed = PLAIN
            if all(size < 1 for size in sizes):
                slowest = max([0.0, *sizes])
                needed = FEWEST if slowest == 0 else min(MOST, max(FEWEST, ceil(log(FADED) / log(slowest))))
            counts[half_line.name] = ghosts + (needed if cells is None else cells)
        return counts

    def shape(self, vector: Sequence[acb], counts: Mapping[str, int], bits: int) -> Shape:
        """Values and coefficients at the working precision, divided by the largest value."""
        at = self.space.at(bits)
        values = {h.name: self._values(h, vector, counts[h.name], at, bits) for h in self.scheme.domains}
        every = [v for each in values.values() for mine in each.values() for v in mine]
        largest = max(every, key=lambda v: abs(v).mid())
        scale = 1 / largest if not largest.contains(0) else acb("nan")
        scaled = {
            domain: {u: [v * scale if v is not largest else acb(1) for v in mine] for u, mine in each.items()}
            for domain, each in values.items()
        }
        error = max(abs_error(v) for each in scaled.values() for mine in each.values() for v in mine)
        coefficients = tuple(self._coefficients(k, vector, scale, at, bits) for k in range(len(self.space.parts)))
        return Shape(
            tuple({u: tuple(_number(c) for c in mine) for u, mine in each.items()} for each in coefficients),
            {d: {u: tuple(_number(v) for v in mine) for u, mine in each.items()} for d, each in scaled.items()},
            error,
        )

    def _shares(self, half_line: HalfLine, component: int, n: int, at: Mapping[str, acb]) -> list[tuple[int, int, acb]]:
        """(field, place, factor) of what an unknown is made of at the n-th place."""
        ghosts = self.space.problem.ghosts(half_line.name)
        return [
            (k, place, at_balls(factor.num, at) / at_balls(factor.den, at))
            for k, each in enumerate(self.fields)
            if each.domain == half_line.name
            for place, factor in each.share(component, n, ghosts)
        ]

    def _values(
        self, half_line: HalfLine, vector: Sequence[acb], count: int, at: Mapping[str, acb], bits: int
    ) -> dict[str, list[acb]]:
        roots = [part.root.ball(bits) for part in self.space.parts]
        tables: dict[int, list[acb]] = {}
        for k, each in enumerate(self.fields):
            if each.domain == half_line.name:
                every = zip(vector, self.space.columns, strict=True)
                mine = [(a, c) for a, c in every if c.field == k and not c.silent]
                tables[k] = [sum((a * power(roots[c.part], n, c.power) for a, c in mine), acb(0)) for n in range(count)]
        return {
            unknown: [
                sum((factor * tables[k][p] for k, p, factor in self._shares(half_line, component, n, at)), acb(0))
                for n in range(count)
            ]
            for component, unknown in enumerate(half_line.unknowns)
        }

    def _coefficients(
        self, k: int, vector: Sequence[acb], scale: acb, at: Mapping[str, acb], bits: int
    ) -> dict[str, list[acb]]:
        """c_0, c_1, ... of one part, by unknown."""
        part = self.space.parts[k]
        half_line = self.scheme.half_line(part.domain)
        mine = [(a * scale, c) for a, c in zip(vector, self.space.columns, strict=True) if c.part == k and not c.silent]
        far = self.space.problem.ghosts(part.domain) + part.multiplicity
        found = {}
        for component, unknown in enumerate(half_line.unknowns):
            if part.ghosts:
                found[unknown] = [
                    sum((f * a for field_, place, f in self._shares(half_line, component, n, at)
                         for a, c in mine if c.field == field_ and c.power == place), acb(0))
                    for n in range(far)
                ]  # fmt: skip
                continue
            x = part.root.ball(bits)
            m = acb_poly([0, 1 if half_line.side == "right" else -1])
            total = acb_poly([acb(0)] * part.multiplicity)
            for field_, place, factor in self._shares(half_line, component, far, at):
                t = place - far - self.lowest[part.domain]  # the place is m + t at the mirrored index m
                for a, c in mine:
                    if c.field == field_:
                        total += factor * a * x ** (t - c.power) / factorial(c.power) * _falling(m + t, c.power)
            found[unknown] = [total[j] for j in range(part.multiplicity)]
        return found

    def component(self, k: int, amplitudes: _Amplitudes) -> Component:
        """What is to be said of a part, and whether any mode has it."""
        part = self.space.parts[k]
        entries = [
            (vector[j], column)
            for vector in amplitudes.vectors
            for j, column in enumerate(self.space.columns)
            if column.part == k and not column.silent
        ]
        present: bool | None
        if any(not amplitude.contains(0) for amplitude, _ in entries):
            present = True
        elif all(amplitude == 0 for amplitude, _ in entries):
            present = False
        else:
            present = _negated(self.space.absent(k))
        x = part.root.ball(amplitudes.bits)
        right = self.scheme.half_line(part.domain).side == "right"
        kappa = None if part.ghosts else x if right else 1 / x
        modulus = Fraction(0) if kappa is None else exact_fraction(abs(kappa))
        if part.group_velocities:
            modulus = Fraction(1)
        number = None if kappa is None else _number(kappa)
        return Component(part.domain, number, modulus, part.multiplicity, part.group_velocities, present)


def _negated(answer: bool | None) -> bool | None:
    return None if answer is None else not answer


def _falling(variable: acb_poly, length: int) -> acb_poly:
    """The product of variable - j over j < length."""
    product = acb_poly([1])
    for step in range(length):
        product *= variable - step
    return product


def _number(value: acb) -> ComplexNumber:
    """The midpoint, with 0 for a part that its ball does not tell from 0: at most two radii off (``abs_error``)."""
    if not value.is_finite():
        return Fraction(0), Fraction(0)
    real, imaginary = midpoint(value)
    return Fraction(0) if value.real.contains(0) else real, Fraction(0) if value.imag.contains(0) else imaginary


def abs_error(value: acb) -> Fraction:
    """Twice the radius of a ball; 1, which no profile's value may be off, where it is not finite."""
    return 2 * radius_of(value) if value.is_finite() else Fraction(1)
