"""The marching problem of a scheme at given parameter values: plain numbers, nothing eliminated.

Every equation becomes one row  sum over levels k = 0..depth of  coefficient * value[slot, n+k] = 0  with its own
newest level at k = depth, so that level n+depth follows from the `depth` levels below it. Three kinds of scheme
reduce to this one form:

- fully discrete equations as they are written, shifted as a whole;
- method of lines under a linear multistep integrator: rho(E) on the dt(...) terms, lam sigma(E) on the others, E the
  shift by one level; - method of lines under Runge-Kutta stages, or `exact`: depth 1 with level 1 standing for the
  time derivative,
  mass * w' + rate * w = 0. A closure equation without dt(...) holds at every stage, hence for w' too.

Places count outward from the boundary: place = i on a right half-line and -i on a left one, so that both sides have
cells place >= first and boundary points place < first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.errors import NotAnalysable
from gks.scheme.integrators import Integrator, integrator
from gks.scheme.model import HalfLine, LinearForm, NamedLines, NamedScheme, Scheme, WrittenLines
from gks.solvers.coefficients import as_double, discrete_blocks, evaluate, space_blocks

if TYPE_CHECKING:
    from gks.solvers.coefficients import Matrix


@dataclass(frozen=True, slots=True, order=True)
class Slot:
    """One grid value: side (index of the half-line), unknown (its index there), place (outward; an offset in interior
    rows).
    """

    side: int
    unknown: int
    place: int


@dataclass(frozen=True, slots=True)
class Row:
    """sum of coefficient * value[slot, n+level] = 0.

    constraint : method of lines under stages only: the row holds no dt(...), so it binds every state, not its
    derivative.
    """

    terms: tuple[tuple[int, Slot, float], ...]
    constraint: bool = False


@dataclass(frozen=True, slots=True)
class Side:
    """One half-line: its interior rows (places are offsets from the cell) and the places it reaches."""

    name: str
    unknowns: tuple[str, ...]
    outward: int
    first: int
    rows: tuple[Row, ...]

    @property
    def inward_reach(self) -> int:
        """How many places towards the boundary a cell's equations read."""
        return max(0, -min(slot.place for row in self.rows for _, slot, _ in row.terms))

    @property
    def outward_reach(self) -> int:
        """How many places away from the boundary a cell's equations read."""
        return max(0, max(slot.place for row in self.rows for _, slot, _ in row.terms))


@dataclass(frozen=True, slots=True)
class Problem:
    """All rows at the values. stages : None where level n+depth follows directly, else the integrator that advances
    w'.
    """

    sides: tuple[Side, ...]
    closure: tuple[Row, ...]
    ghosts: tuple[Slot, ...]
    depth: int
    stages: Integrator | None
    lam: float

    @property
    def near(self) -> int:
        """The places from the boundary outward that the closure involves."""
        places = [slot.place + 1 for row in self.closure for _, slot, _ in row.terms]
        return max([side.first + 1 for side in self.sides] + places)


@dataclass(frozen=True, slots=True)
class _Written:
    """An equation before its time integration: dt(...) terms and plain terms, each {(level, slot): coefficient}."""

    derivatives: Mapping[tuple[int, Slot], float]
    values: Mapping[tuple[int, Slot], float]
    integrator: Integrator | None


def build(scheme: Scheme, values: Mapping[str, Fraction]) -> Problem:
    """The problem that the scheme poses at the parameter values.

    Raises NotAnalysable for mixtures of stages with anything else, whose intermediate values no file defines.
    """
    index = {half.name: number for number, half in enumerate(scheme.domains)}
    lam = evaluate_lam(scheme, values)
    interiors = [_interior(half, side, values, lam) for side, half in enumerate(scheme.domains)]
    closure = [_closure_row(equation.form, scheme, index, values) for equation in scheme.closure.equations]
    stages = _stages([row for rows in interiors for row in rows] + closure, _time_of(scheme))
    every = [_advance(row, stages, lam) for rows in interiors for row in rows]
    bounds = [_advance(row, stages, lam) for row in closure]
    depth = max(1, *(_span(row) for row in every + bounds))
    sides, used = [], 0
    for half, rows in zip(scheme.domains, interiors, strict=True):
        placed = tuple(_placed(row, depth) for row in every[used : used + len(rows)])
        used += len(rows)
        sides.append(Side(half.name, half.unknowns, _outward(half), half.first, placed))
    closed = tuple(
        _placed(row, depth, constraint=stages is not None and not written.derivatives)
        for row, written in zip(bounds, closure, strict=True)
    )
    ghosts = tuple(_slot(scheme, index, value.domain, value.unknown, value.index) for value in scheme.boundary_unknowns)
    return Problem(tuple(sides), closed, ghosts, depth, stages, lam)


def evaluate_lam(scheme: Scheme, values: Mapping[str, Fraction]) -> float:
    """The CFL number as a double. Raises NotAnalysable beyond their range."""
    return as_double(values[scheme.cfl], scheme.cfl)


def _outward(half: HalfLine) -> int:
    return 1 if half.side == "right" else -1


def _slot(scheme: Scheme, index: Mapping[str, int], domain: str, unknown: str, place: int) -> Slot:
    half = scheme.half_line(domain)
    return Slot(index[domain], half.unknowns.index(unknown), _outward(half) * place)


def _time_of(scheme: Scheme) -> list[Integrator | None]:
    """The integrator of each half-line, None where its interior is fully discrete."""
    times: list[Integrator | None] = []
    for half in scheme.domains:
        interior = half.interior
        times.append(integrator(interior.time) if isinstance(interior, NamedLines | WrittenLines) else None)
    return times


def _interior(half: HalfLine, side: int, values: Mapping[str, Fraction], lam: float) -> list[_Written]:
    """The interior equations of one half-line, one per unknown; slots hold outward offsets."""
    interior = half.interior
    outward = _outward(half)
    if isinstance(interior, NamedLines):
        mass, rate = space_blocks(interior.space, _flux(half, values))
        return [
            _Written(
                {(0, slot): c for slot, c in _block_row(mass, row, side, outward)},
                {(0, slot): c for slot, c in _block_row(rate, row, side, outward)},
                integrator(interior.time),
            )
            for row in range(len(half.unknowns))
        ]
    if isinstance(interior, NamedScheme):
        blocks = discrete_blocks(interior.scheme, _flux(half, values), lam)
        return [
            _Written(
                {},
                {(1, Slot(side, row, 0)): 1.0} | {(0, slot): -c for slot, c in _block_row(blocks, row, side, outward)},
                None,
            )
            for row in range(len(half.unknowns))
        ]
    time = integrator(interior.time) if isinstance(interior, WrittenLines) else None
    slots = {unknown: number for number, unknown in enumerate(half.unknowns)}
    return [
        _written(
            [
                (
                    grid.derivative,
                    grid.level,
                    Slot(side, slots[grid.unknown], outward * grid.index),
                    evaluate(c, values),
                )
                for grid, c in form.terms
            ],
            time,
        )
        for form in interior.equations
    ]


def _flux(half: HalfLine, values: Mapping[str, Fraction]) -> Matrix:
    import numpy

    if half.flux is None:
        raise ValueError(f"half-line {half.name}: a named interior without a flux")
    return numpy.array([[evaluate(entry, values) for entry in row] for row in half.flux])


def _block_row(blocks: Mapping[int, Matrix], row: int, side: int, outward: int) -> Iterable[tuple[Slot, float]]:
    for offset, block in blocks.items():
        for column, coefficient in enumerate(block[row]):
            if coefficient != 0.0:
                yield Slot(side, column, outward * offset), float(coefficient)


def _written(terms: Iterable[tuple[bool, int, Slot, float]], time: Integrator | None) -> _Written:
    parts: tuple[dict[tuple[int, Slot], float], dict[tuple[int, Slot], float]] = ({}, {})
    for derivative, level, slot, coefficient in terms:
        part = parts[0 if derivative else 1]
        part[level, slot] = part.get((level, slot), 0.0) + coefficient
    return _Written(parts[0], parts[1], time)


def _closure_row(
    form: LinearForm, scheme: Scheme, index: Mapping[str, int], values: Mapping[str, Fraction]
) -> _Written:
    """A closure equation; its dt(...) belongs to the integrator of the half-line whose values it differentiates."""
    times = _time_of(scheme)
    terms = [
        (grid.derivative, grid.level, _slot(scheme, index, grid.domain, grid.unknown, grid.index), evaluate(c, values))
        for grid, c in form.terms
    ]
    owners = {time.name: time for d, _, slot, _ in terms if d and (time := times[slot.side]) is not None}
    if len(owners) > 1:
        raise NotAnalysable(
            message=f"one closure equation differentiates values advanced by {' and '.join(sorted(owners))}",
            expected="one integrator for all dt(...) of an equation",
            mend="give both half-lines the same `time`",
        )
    return _written(terms, next(iter(owners.values()), None))


def _stages(rows: list[_Written], times: list[Integrator | None]) -> Integrator | None:
    """The integrator by stages (or `exact`) that advances everything; None where all rows are levels."""
    staged = {time.name: time for time in times if time is not None and time.kind != "multistep"}
    if not staged:
        return None
    names = {time.name if time is not None else "a fully discrete interior" for time in times}
    if len(names) > 1:
        raise NotAnalysable(
            message=f"the half-lines are advanced by {' and '.join(sorted(names))}",
            expected="at its stages one half-line reads values the other never computes",
            mend="give both half-lines the same `time`",
        )
    if any(level != 0 for row in rows for level, _ in (*row.derivatives, *row.values)):
        raise NotAnalysable(
            message="an equation over several levels under an integrator by stages",
            expected="one level, or a multistep integrator",
        )
    return next(iter(staged.values()))


def _advance(row: _Written, stages: Integrator | None, lam: float) -> dict[tuple[int, Slot], float]:
    """The row over levels (see the module's three kinds)."""
    if stages is not None:
        moved = [((1, slot), c) for (_, slot), c in row.derivatives.items()]
        moved += [((0 if row.derivatives else 1, slot), c) for (_, slot), c in row.values.items()]
        return _summed(moved)
    if not row.derivatives:
        return dict(row.values)
    if row.integrator is None:
        raise ValueError("dt(...) without an integrator")
    rho, sigma = ([float(c) for c in part] for part in (row.integrator.rho, row.integrator.sigma))
    return _summed([*_shifted(rho, row.derivatives), *_shifted([lam * c for c in sigma], row.values)])


def _shifted(
    polynomial: list[float], terms: Mapping[tuple[int, Slot], float]
) -> Iterable[tuple[tuple[int, Slot], float]]:
    """polynomial(E) applied to the terms, E the shift by one level."""
    for power, weight in enumerate(polynomial):
        if weight:
            yield from (((level + power, slot), weight * c) for (level, slot), c in terms.items())


def _summed(terms: Iterable[tuple[tuple[int, Slot], float]]) -> dict[tuple[int, Slot], float]:
    result: dict[tuple[int, Slot], float] = {}
    for key, coefficient in terms:
        result[key] = result.get(key, 0.0) + coefficient
    return result


def _span(row: Mapping[tuple[int, Slot], float]) -> int:
    levels = [level for level, _ in row]
    return max(levels) - min(levels)


def _placed(row: Mapping[tuple[int, Slot], float], depth: int, constraint: bool = False) -> Row:
    """The row shifted so that its newest level is n+depth."""
    shift = depth - max(level for level, _ in row)
    return Row(tuple((level + shift, slot, c) for (level, slot), c in row.items()), constraint)
