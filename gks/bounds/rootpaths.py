"""Roots followed over a parameter, as data: what `gks roots` gives."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from gks.bounds.sweep import Point, Sweep
from gks.errors import counted
from gks.modes.numerals import json_real, text_exact, text_real
from gks.modes.verdict import ModeKind
from gks.scheme.model import Scheme
from gks.scheme.numbers import fraction_text


@dataclass(frozen=True, slots=True)
class RootPoint:
    """A root at one value; ``r`` is 1/kappa of the decaying solutions where all fields share one; kind None: open.

    ``error`` bounds how far ``z`` is off.
    """

    z: complex
    kind: ModeKind | None
    r: complex | None = None
    error: float = 0.0


@dataclass(frozen=True, slots=True)
class Track:
    """One root followed over the sweep, None where there is none; ``multiplicity`` in the polynomial's factors."""

    multiplicity: int
    points: tuple[RootPoint | None, ...]


@dataclass(frozen=True, slots=True)
class RootMap:
    """The tracks over a sweep. ``because`` holds what was wrong at a value without a scheme."""

    scheme: Scheme
    parameters: Mapping[str, Fraction]
    sweep: Sweep
    tracks: tuple[Track, ...]
    faults: Mapping[int, str]
    time_s: float = field(compare=False)

    @property
    def has_r(self) -> bool:
        """Whether the roots have a common r."""
        return any(point is not None and point.r is not None for track in self.tracks for point in track.points)

    def to_json(self) -> dict[str, object]:
        return {
            "schema": "gks.roots/1",
            "sweep": self.sweep.name,
            "parameters": {k: fraction_text(v) for k, v in self.parameters.items() if k != self.sweep.name},
            "values": [_number(value) for value in self.sweep.values],
            "tracks": [
                {
                    "multiplicity": track.multiplicity,
                    "z": [None if p is None else [p.z.real, p.z.imag] for p in track.points],
                    "kind": [None if p is None else _kind(p) for p in track.points],
                    "r": [None if p is None or p.r is None else [p.r.real, p.r.imag] for p in track.points],
                }
                for track in self.tracks
            ],
            "faults": {str(k): text for k, text in self.faults.items()},
            "time_s": self.time_s,
        }

    def json_text(self) -> str:
        return json.dumps(self.to_json(), allow_nan=False)

    def to_csv(self) -> str:
        """One line a root: the parameter, track (from 0), re, im, modulus, kind, multiplicity, r_re, r_im."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([self.sweep.name, "track", "re", "im", "modulus", "kind", "multiplicity", "r_re", "r_im"])
        for k, track in enumerate(self.tracks):
            for value, p in zip(self.sweep.values, track.points, strict=True):
                if p is not None:
                    r = ["", ""] if p.r is None else [p.r.real, p.r.imag]
                    z = [p.z.real, p.z.imag, abs(p.z)]
                    writer.writerow([_number(value), k, *z, _kind(p), track.multiplicity, *r])
        return text.getvalue()

    def __str__(self) -> str:
        name, values = self.sweep.name, self.sweep.values
        fixed = ", ".join(f"{k} = {text_exact(v)}" for k, v in self.parameters.items() if k != name)
        lines = [self.scheme.title] + ([f"  at {fixed}"] if fixed else [])
        for k, track in enumerate(self.tracks):
            times = f", {track.multiplicity} times" if track.multiplicity > 1 else ""
            lines += ["", f"  root {k}{times}", f"  {name:<22} {'z':<46} {'abs(z)':<18} kind"]
            for at in _telling(track.points):
                p = track.points[at]
                shown = "" if p is None else f"{_text(p.z):<46} {abs(p.z):<18.15g} {_kind(p)}"
                lines.append(f"  {text_real(Fraction(values[at])):<22} {shown or 'none'}")
        for at, text in self.faults.items():
            lines.append(f"  at {name} = {text_real(Fraction(values[at]))}: {text}")
        lines += ["", f"  ({counted(len(values), 'value')}, {counted(len(self.tracks), 'root')}, {self.time_s:.3g} s)"]
        return "\n".join(lines)


def _kind(point: RootPoint) -> str:
    return "open" if point.kind is None else point.kind.value


def _text(z: complex) -> str:
    real = f"{z.real + 0.0:.15g}"  # a zero without its sign
    return real if not z.imag else f"{real} {'-' if z.imag < 0 else '+'} {abs(z.imag):.15g}i"


def _number(value: Point) -> float | str:
    return value if isinstance(value, float) else json_real(value)


def _telling(points: Sequence[RootPoint | None]) -> list[int]:
    """The places a text shows: both ends, and both sides of every change of kind."""
    kinds = [None if p is None else p.kind for p in points]
    places = {0, len(points) - 1}
    for k in range(1, len(points)):
        if kinds[k] != kinds[k - 1] or (points[k] is None) != (points[k - 1] is None):
            places |= {k - 1, k}
    return sorted(places)
