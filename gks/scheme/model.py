"""What the user wrote: parameters, half-lines, closure and claims, as exact and immutable data.

Grid values keep the levels they were written with (an equation holds at every n, so only differences of levels
mean something); the one exception is an equation with dt(...), whose single level is moved to n.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Literal

from gks.errors import ParameterError, TooLarge, Where, quoted
from gks.scheme.expression import Expr
from gks.scheme.numbers import rational
from gks.scheme.suggest import nearest

Side = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A symbol of the formulas. Its range is open, None an infinite end; without one (ranged False) it is (0, oo)."""

    name: str
    role: Literal["cfl"] | None
    default: Fraction | None
    low: Fraction | None
    high: Fraction | None
    ranged: bool
    doc: str


@dataclass(frozen=True, slots=True)
class GridValue:
    """An unknown at a grid point and a time level, or the time derivative of it.

    index  the offset from i in an interior equation, the absolute index in a closure
    level  0 is n, 1 is n+1, -1 is n-1
    """

    domain: str
    unknown: str
    index: int
    level: int
    derivative: bool = False

    def __str__(self) -> str:
        """As a closure writes it: R.s[-1, n+1]."""
        level = f", n{self.level:+d}" if self.level else ""
        text = f"{self.domain}.{self.unknown}[{self.index}{level}]"
        return f"dt({text})" if self.derivative else text


@dataclass(frozen=True, slots=True)
class LinearForm:
    """An equation sum(coefficient * grid value) = 0, left side minus right side.

    Each grid value occurs once, and no coefficient is identically zero as a formula.
    """

    terms: tuple[tuple[GridValue, Expr], ...]

    @property
    def levels(self) -> tuple[int, int]:
        """The earliest and the latest level."""
        levels = [value.level for value, _ in self.terms]
        return min(levels), max(levels)

    @property
    def holds_dt(self) -> bool:
        return any(value.derivative for value, _ in self.terms)


@dataclass(frozen=True, slots=True)
class NamedLines:
    """Method of lines: a named space operator, advanced by a named integrator."""

    space: str
    time: str


@dataclass(frozen=True, slots=True)
class NamedScheme:
    """A named fully discrete scheme."""

    scheme: str


@dataclass(frozen=True, slots=True)
class WrittenDiscrete:
    """A fully discrete scheme written out, one equation an unknown."""

    equations: tuple[LinearForm, ...]


@dataclass(frozen=True, slots=True)
class WrittenLines:
    """Method-of-lines equations written out (in units of dx), one an unknown, advanced by a named integrator."""

    equations: tuple[LinearForm, ...]
    time: str


Interior = NamedLines | NamedScheme | WrittenDiscrete | WrittenLines


@dataclass(frozen=True, slots=True)
class HalfLine:
    """One side: cells 0, 1, 2, ... for x > 0 ("right") or 0, -1, -2, ... for x < 0 ("left").

    first  the interior scheme gives the cells i >= first (right), i <= -first (left); the others are boundary points
    flux   the matrix of q_t + flux q_x = 0, by rows, if the file has it
    """

    name: str
    side: Side
    unknowns: tuple[str, ...]
    first: int
    flux: tuple[tuple[Expr, ...], ...] | None
    interior: Interior

    @property
    def lines(self) -> bool:
        """Whether it is advanced as method of lines."""
        return isinstance(self.interior, NamedLines | WrittenLines)

    @property
    def time(self) -> str | None:
        """The integrator's name under method of lines."""
        return self.interior.time if isinstance(self.interior, NamedLines | WrittenLines) else None

    def is_boundary(self, index: int) -> bool:
        """Whether the interior scheme leaves the value at this index to the closure."""
        return index < self.first if self.side == "right" else index > -self.first


@dataclass(frozen=True, slots=True)
class Equation:
    """A closure equation, with its text and place in the file."""

    form: LinearForm
    text: str
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Closure:
    """The closure of both half-lines; its shorthands are written out in the equations."""

    equations: tuple[Equation, ...]


@dataclass(frozen=True, slots=True)
class Claim:
    """What a publication states: to be audited, never used.

    bound    stability for 0 < lam < bound and loss of it just above; may hold min, max and sqrt
    stable   the verdict at `at`
    modulus  the largest modulus among the roots the claim speaks of, at `at`
    at       parameter values; parameters that are not in it are at their defaults
    texts    "bound" and "modulus" as the file spells them, with the digits printed
    """

    source: str
    bound: Expr | None
    stable: bool | None
    modulus: Expr | None
    at: Mapping[str, Fraction]
    texts: Mapping[str, str]
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Scheme:
    """A whole scheme file.

    domains            one or two half-lines, in file order
    boundary_unknowns  the values the closure has to give (level 0): by domain, index and unknown
    name, text, path   the short name, the file's text and the path it was read from, if any
    """

    title: str
    source: str
    notes: str
    parameters: tuple[Parameter, ...]
    domains: tuple[HalfLine, ...]
    closure: Closure
    claims: tuple[Claim, ...]
    boundary_unknowns: tuple[GridValue, ...]
    name: str
    text: str
    path: str | None

    def __reduce__(self) -> tuple[object, ...]:
        """Pickled as the text it was read from: expressions are graphs too deep for pickle's recursion."""
        from gks.scheme.schemefile import parse_scheme

        return parse_scheme, (self.text, self.name, self.path)

    @property
    def cfl(self) -> str:
        """The name of the parameter whose stable bound is sought."""
        return next(p.name for p in self.parameters if p.role == "cfl")

    @property
    def closure_place(self) -> Where:
        """Where the closure is written: the place of its first equation, for faults of the closure as a whole."""
        file = self.path or self.name
        first = self.closure.equations[:1]
        return Where(file, first[0].line, first[0].column) if first else Where(file)

    def parameter(self, name: str) -> Parameter:
        """The parameter of that name; ParameterError if there is none."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        names = [p.name for p in self.parameters]
        found, expected = f"the scheme has no parameter {quoted(name)}", f"it has {', '.join(names)}"
        raise ParameterError(found, expected=expected, mend=nearest(name, names))

    def half_line(self, name: str) -> HalfLine:
        """The domain of that name; KeyError if there is none."""
        for domain in self.domains:
            if domain.name == name:
                return domain
        raise KeyError(name)

    def values(
        self,
        overrides: Mapping[str, Fraction | int | str | float | Decimal] | None = None,
        free: Collection[str] = (),
    ) -> dict[str, Fraction]:
        """Exact values of the parameters, in file order: the overrides, else the defaults.

        Strings may be "9/10", "0.9" or "1e-10"; a float counts as the shortest decimal that prints it. Parameters
        named in `free` are left out. ParameterError for unknown names, for what is not a finite number, for a
        CFL number that is not positive, and for a parameter that has neither.
        """
        given = {self.parameter(name).name: _exact(name, value) for name, value in (overrides or {}).items()}
        values: dict[str, Fraction] = {}
        for parameter in self.parameters:
            value = given.get(parameter.name, parameter.default)
            if parameter.name in free:
                continue
            if value is None:
                mend = f"set it with -p {parameter.name}=..."
                raise ParameterError("it has no default and no value is given", path=parameter.name, mend=mend)
            if parameter.role == "cfl" and value <= 0:
                raise ParameterError(
                    f"{_printed(value)} is not positive", path=parameter.name, expected="dt/dx is positive"
                )
            values[parameter.name] = value
        return values


def _exact(name: str, value: Fraction | int | str | float | Decimal) -> Fraction:
    if isinstance(value, Fraction):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return Fraction(value)
    try:
        return rational(value.strip() if isinstance(value, str) else str(value))
    except (ValueError, TooLarge) as error:
        raise ParameterError(str(error), path=name, expected="expected a number such as 9/10, 0.9 or 1e-10") from None


def _printed(value: Fraction) -> str:
    return str(value) if value.numerator.bit_length() + value.denominator.bit_length() < 200 else "the value"
