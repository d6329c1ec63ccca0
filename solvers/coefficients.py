"""The coefficients of a scheme at one set of parameter values, as doubles.

Formulas are evaluated exactly and rounded once; where a square root is irrational, in 60 decimal digits. The upwind
splitting of a system's flux is done here numerically (balanced eigendecomposition), so that a march shares no
derivation with the analyser it is to check.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from decimal import Context, Decimal, DivisionByZero, InvalidOperation, Overflow
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.errors import IrrationalValue, NotAnalysable, ParameterError, quoted
from gks.scheme.operators import SPACE_OPERATORS, discrete_stencil, stencil

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    from gks.scheme.expression import Expr

    Matrix = NDArray[numpy.float64]

DIGITS = 60
"""Working digits where a square root is irrational: cancellation of 40 digits still leaves a correct double."""


class _DecimalAlgebra:
    """Evaluates a formula in `DIGITS` decimal digits, with exponents far beyond those of doubles."""

    def __init__(self, values: Mapping[str, Fraction]) -> None:
        self.values = values
        self.context = Context(
            prec=DIGITS, Emax=10**9, Emin=-(10**9), traps=[DivisionByZero, InvalidOperation, Overflow]
        )

    def number(self, value: Fraction) -> Decimal:
        return self.context.divide(Decimal(value.numerator), Decimal(value.denominator))

    def symbol(self, name: str) -> Decimal:
        return self.number(self.values[name])

    def add(self, terms: Sequence[Decimal]) -> Decimal:
        total = Decimal(0)
        for term in terms:
            total = self.context.add(total, term)
        return total

    def mul(self, factors: Sequence[Decimal]) -> Decimal:
        product = Decimal(1)
        for factor in factors:
            product = self.context.multiply(product, factor)
        return product

    def power(self, base: Decimal, exponent: int) -> Decimal:
        return self.context.power(base, exponent)

    def sqrt(self, radicand: Decimal) -> Decimal:
        return self.context.sqrt(radicand)


def evaluate(formula: Expr, values: Mapping[str, Fraction]) -> float:
    """The formula at the values, correctly rounded (rational) or from 60 digits (irrational square roots).

    Raises ParameterError where it has no real value there, NotAnalysable where that value is beyond doubles.
    """
    exact: Fraction | Decimal
    try:
        exact = formula.at(values)
    except IrrationalValue:
        try:
            exact = formula.fold(_DecimalAlgebra(values))
        except (DivisionByZero, InvalidOperation, Overflow) as cause:
            raise ParameterError(
                message=f"{quoted(str(formula))} has no real value at these parameters", expected="a real number"
            ) from cause
    return as_double(exact, str(formula))


def as_double(exact: Fraction | Decimal, name: str) -> float:
    """A number as the nearest double. Raises NotAnalysable, with its name, beyond their range."""
    try:
        rounded = float(exact)
    except OverflowError:
        rounded = float("inf")
    if abs(rounded) == float("inf") or (rounded == 0.0 and exact != 0):
        raise beyond_doubles(f"{quoted(name)} is beyond double precision at these parameters")
    return rounded


def beyond_doubles(message: str) -> NotAnalysable:
    """The refusal of what a march can't hold; ``message`` says what that is."""
    return NotAnalysable(message, expected="a march computes in doubles", mend="march at milder values")


def balanced(matrix: Matrix) -> tuple[Matrix, Matrix]:
    """(d, d^-1 matrix d) with d a vector of powers of two that makes rows and columns of like size (Osborne 1960).

    Powers of two leave every entry exact; a flux with entries 1e-300 and 1e300 becomes one with entries of order 1.
    """
    import numpy

    result, scale = matrix.copy(), numpy.ones(len(matrix))
    for _ in range(10 * len(matrix)):
        moved = False
        for i in range(len(matrix)):
            others = numpy.arange(len(matrix)) != i
            column, row = numpy.abs(result[others, i]).sum(), numpy.abs(result[i, others]).sum()
            if column == 0 or row == 0:
                continue
            exponent = round(float(numpy.log2(row) - numpy.log2(column)) / 2)
            if exponent:
                factor = 2.0**exponent
                result[:, i] *= factor
                result[i, :] /= factor
                scale[i] *= factor
                moved = True
        if not moved:
            break
    return scale, result


def matrix_function(flux: Matrix, functions: Sequence[Callable[[float], float]]) -> list[Matrix]:
    """f(flux) for each f, through the eigenvectors of the balanced flux.

    Entries below the rounding errors of that product (in balanced scale) are zero: an unknown that the formulas never
    read must not be read by a rounding error. Raises NotAnalysable where the flux has no full set of real fields.
    """
    import numpy

    scale, even = balanced(flux)
    speeds, vectors = numpy.linalg.eig(even)
    condition = numpy.linalg.cond(vectors)
    eps, size = numpy.finfo(float).eps, max(float(numpy.abs(even).max()), numpy.finfo(float).tiny)
    # Bauer-Fike: a diagonalisable real flux computes with imaginary parts below cond * eps * norm; a defective one has
    # eigenvectors parallel to about sqrt(eps).
    if condition > eps**-0.5 or float(numpy.abs(numpy.imag(speeds)).max()) > 16 * len(flux) * condition * eps * size:
        raise NotAnalysable(
            message=f"the flux has eigenvalues {speeds.tolist()} without a full set of real fields",
            expected="upwinding splits a hyperbolic flux",
            mend="mend the flux, or take a central operator",
        )
    speeds, vectors = numpy.real(speeds), numpy.real(vectors)
    results = []
    for function in functions:
        diagonal = numpy.array([function(float(speed)) for speed in speeds])
        value = (vectors * diagonal) @ numpy.linalg.inv(vectors)
        noise = 16 * len(flux) * condition * eps * float(numpy.abs(diagonal).max())
        value[numpy.abs(value) < noise] = 0.0
        results.append(scale[:, None] * value / scale[None, :])
    return results


def space_blocks(name: str, flux: Matrix) -> tuple[dict[int, Matrix], dict[int, Matrix]]:
    """A named space operator as sum_j mass[j] dt q[i+j] + sum_j rate[j] q[i+j] = 0, blocks by offset j (units of
    dx).
    """
    import numpy

    right, left = stencil(name, True), stencil(name, False)
    identity = numpy.eye(len(flux))
    mass = {j: float(m) * identity for j, m in right.mass.items()}
    if not SPACE_OPERATORS[name].upwinded:
        return mass, {j: float(d) * flux for j, d in right.derivative.items()}
    rightward, leftward = matrix_function(flux, [lambda speed: max(speed, 0.0), lambda speed: min(speed, 0.0)])
    rate = {j: float(d) * rightward for j, d in right.derivative.items()}
    for j, d in left.derivative.items():
        rate[j] = rate.get(j, 0.0) + float(d) * leftward
    return mass, rate


def discrete_blocks(name: str, flux: Matrix, lam: float) -> dict[int, Matrix]:
    """A named fully discrete scheme as q[i, n+1] = sum_j blocks[j] q[i+j]."""
    import numpy

    right, left = discrete_stencil(name, True), discrete_stencil(name, False)
    if right.upwinded:
        offsets = sorted({*right.coefficients, *left.coefficients})

        def at(offset: int) -> Callable[[float], float]:
            def coefficient(speed: float) -> float:
                row = (right if speed > 0 else left).coefficients.get(offset, ())
                return sum(float(c) * (lam * speed) ** power for power, c in enumerate(row))

            return coefficient

        return dict(zip(offsets, matrix_function(flux, [at(offset) for offset in offsets]), strict=True))
    blocks = {}
    for offset, row in right.coefficients.items():
        power, total = numpy.eye(len(flux)), numpy.zeros_like(flux)
        for c in row:
            total = total + float(c) * power
            power = power @ (lam * flux)
        blocks[offset] = total
    return blocks
