"""What holding a claim against the derivation gives: a status, what was derived, and what shows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction

from gks.errors import InputError
from gks.modes.admissible import Candidate
from gks.modes.algebraic import Root
from gks.modes.analysis import analyse, eliminated
from gks.modes.candidates import candidates_of
from gks.modes.kreiss import normal_mode_problem
from gks.modes.numerals import exact_fraction, json_complex, json_real, text_complex, text_real
from gks.modes.verdict import Mode, ModeKind, ModesResult
from gks.scheme.model import Scheme
from gks.scheme.numbers import fraction_text, integer_text

Values = Mapping[str, Fraction]


class Status(Enum):
    """Whether a claim holds; undecided is said where nothing was decided, and is never a guess."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDECIDED = "undecided"

    def __bool__(self) -> bool:
        raise TypeError("a Status is not a yes or no; write `status is Status.HOLDS`")


@dataclass(frozen=True, slots=True)
class Counterexample:
    """Exact parameter values at which a claim fails, and what the normal modes say there.

    shows       in words, what is wrong with the claim here
    mode        the admissible mode of largest modulus, or, where no mode is admissible, the largest root of all; None
                where the scheme has neither (an interior that is unstable by itself)
    polynomial  the irreducible polynomial in z that the mode's z is a root of, where the exact route has it
    """

    parameters: Values
    shows: str
    verdict: str
    mode: Mode | None
    polynomial: str | None

    def to_json(self) -> dict[str, object]:
        mode = self.mode
        return {
            "parameters": {name: fraction_text(value) for name, value in self.parameters.items()},
            "shows": self.shows,
            "verdict": self.verdict,
            "z": None if mode is None else json_complex(mode.z),
            "modulus": None if mode is None else json_real(mode.modulus),
            "kind": None if mode is None else mode.kind.value,
            "z_is_a_root_of": self.polynomial,
        }

    def __str__(self) -> str:
        text = f"at {point_text(self.parameters)}: {self.verdict}"
        if self.mode is not None:
            z, modulus = text_complex(self.mode.z), text_real(self.mode.modulus)
            text += f", z = {z}, abs(z) = {modulus} ({self.mode.kind.value})"
        return text


@dataclass(frozen=True, slots=True)
class Finding:
    """The outcome for one statement. ``evidence`` is JSON: how it was decided and over which values."""

    status: Status
    derived: str
    counterexample: Counterexample | None = None
    evidence: Mapping[str, object] = field(default_factory=dict)


def undecided(reason: object) -> Finding:
    """The finding where the analysis doesn't reach the claim, with the reason."""
    return Finding(Status.UNDECIDED, f"undecided: {reason}")


def witness(scheme: Scheme, values: Values, shows: str) -> Counterexample:
    """The counterexample at these values: raises what `analyse` raises."""
    result = analyse(scheme, values)
    mode = leading(result)
    root = None if mode is None else exact_z(scheme, values, mode)
    polynomial = None if root is None else polynomial_in_z(root)
    reason = f" ({result.reason})" if result.reason else ""
    return Counterexample(dict(values), shows, result.verdict.value + reason, mode, polynomial)


def leading(result: ModesResult) -> Mode | None:
    """The admissible mode of largest modulus; the largest root where none is admissible; None without roots."""
    admissible = [mode for mode in result.modes if mode.kind is not ModeKind.INADMISSIBLE]
    return max(admissible or result.modes, key=lambda mode: mode.modulus, default=None)


def exact_z(scheme: Scheme, values: Values, mode: Mode) -> Root | None:
    """A mode's z as an exact number; None where elimination is out of reach or time is exact (z = exp(lam s))."""
    problem = normal_mode_problem(scheme, values)
    try:
        factors = eliminated(problem).factors
    except InputError:
        return None
    for factor in factors:
        for candidate in candidates_of(problem, factor):
            if candidate.z is not None and _is_at(candidate, mode):
                return candidate.z
    return None


def _is_at(candidate: Candidate, mode: Mode) -> bool:
    """Whether a candidate's z lies where the mode was printed; both are known far better than a double shows."""
    assert candidate.z is not None
    ball = candidate.z.ball(IDENTITY_BITS)
    near = max(mode.modulus, Fraction(1, 2**1000)) / 2**50
    return all(
        abs(exact_fraction(part.mid()) - printed) <= near
        for part, printed in zip((ball.real, ball.imag), mode.z, strict=True)
    )


IDENTITY_BITS = 64
"""Precision at which a root is recognised by its printed value."""


def polynomial_in_z(root: Root) -> str:
    """The irreducible integer polynomial of an algebraic number, as text in z."""
    coefficients = [int(c) for c in list(root.minimal.poly)]
    terms = []
    for power in range(len(coefficients) - 1, -1, -1):
        value = coefficients[power]
        if value:
            factor = "" if power == 0 else "z" if power == 1 else f"z**{power}"
            number = integer_text(abs(value)) if abs(value) != 1 or not factor else ""
            size = "*".join(part for part in (number, factor) if part)
            terms.append(("- " if value < 0 else "+ ") + size)
    text = " ".join(terms)
    return text.removeprefix("+ ") if text.startswith("+") else "-" + text.removeprefix("- ")


def point_text(values: Values) -> str:
    """`lam = 9/10, alpha = 2`: exact where short, else a decimal."""
    return ", ".join(f"{name} = {exact_text(value)}" for name, value in values.items())


def exact_text(value: Fraction) -> str:
    """A short fraction as it is, a long one to fifteen digits."""
    text = fraction_text(value)
    return text if len(text) <= 12 else text_real(value)
