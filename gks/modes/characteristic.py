"""Characteristic fields: the scalar problems that a half-line's scheme falls into.

A half-line is first mirrored so that it always extends to the right: index -i for i on a left one. Then every
scheme whose coefficient matrices can be diagonalised together is, in that basis, one scalar scheme a field,

    sum_j c_j(sigma) v[i + j] = 0,        sigma the resolvent variable (s or z),

and its symbol, cleared of negative powers, is a polynomial P(sigma, x) whose roots x are the spatial roots
(kappa on the right half-line, 1/kappa on the left one). The fields meet only in the closure. Systems that no basis
separates are left to ``coupled``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction

from flint import fmpz_mpoly

from gks.errors import NotAnalysable, ParameterError
from gks.modes.algebraic import isolated_roots
from gks.modes.coefficients import Coefficients, Ratio
from gks.modes.coupled import coupled_fields
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import coefficients as powers_of
from gks.modes.fibre import univariate
from gks.modes.field import Field, Stencil, mirrored
from gks.modes.linear import Matrix, characteristic_polynomial, identity, kernel, multiply, solve
from gks.modes.resolvent import Resolvent
from gks.scheme.model import HalfLine, NamedLines, NamedScheme, WrittenDiscrete, WrittenLines
from gks.scheme.operators import discrete_stencil, stencil


def fields_of(half_line: HalfLine, coefficients: Coefficients, resolvent: Resolvent) -> list[Field]:
    """The characteristic fields of one half-line, in a fixed order.

    Raises NotAnalysable where the unknowns are coupled in a way that is beyond the analysis, ParameterError where the
    flux of a named scheme is not hyperbolic at the values given.
    """
    match half_line.interior:
        case NamedLines(space=space):
            return _flux_fields(
                half_line,
                coefficients,
                lambda a, sign: _lines(coefficients, space, a, sign, resolvent.of(half_line.name)),
            )
        case NamedScheme(scheme=scheme):
            return _flux_fields(
                half_line, coefficients, lambda a, sign: _discrete(coefficients, scheme, a, sign, resolvent)
            )
        case WrittenDiscrete() | WrittenLines():
            return _written_fields(half_line, coefficients, resolvent)
    raise AssertionError(half_line.interior)


# Named operators: the eigenvectors of the flux -----------------------------------------------------------------------


def _flux_fields(
    half_line: HalfLine, coefficients: Coefficients, build: Callable[[Ratio, int], Stencil]
) -> list[Field]:
    assert half_line.flux is not None
    flux = [[coefficients.evaluate(entry) for entry in row] for row in half_line.flux]
    found = []
    for speed, vectors in eigenvectors(flux, coefficients, f"the flux of domain {half_line.name}"):
        sign = coefficients.sign(speed)
        scheme = {mirrored(half_line, j): c for j, c in build(speed, sign).items()}
        found += [Field(half_line.name, vector, scheme, speed) for vector in vectors]
    return found


def _lines(coefficients: Coefficients, space: str, speed: Ratio, sign: int, sigma: Ratio) -> Stencil:
    """sigma * sum_j m_j x**j + speed * sum_j d_j x**j."""
    operator = stencil(space, sign >= 0)
    found: Stencil = {}
    for offset in sorted({*operator.mass, *operator.derivative}):
        mass = coefficients.number(operator.mass.get(offset, Fraction(0)))
        slope = coefficients.number(operator.derivative.get(offset, Fraction(0)))
        found[offset] = sigma * mass + speed * slope
    return {j: c for j, c in found.items() if not c.is_zero()}


def _discrete(coefficients: Coefficients, scheme: str, speed: Ratio, sign: int, resolvent: Resolvent) -> Stencil:
    """z - sum_j c_j(nu) x**j with nu = lam * speed."""
    nu = coefficients.symbol(resolvent.cfl) * speed
    found: Stencil = {0: resolvent.z}
    for offset, powers in discrete_stencil(scheme, sign >= 0).coefficients.items():
        value = coefficients.add([coefficients.number(c) * coefficients.power(nu, k) for k, c in enumerate(powers)])
        found[offset] = found.get(offset, coefficients.number(Fraction(0))) - value
    return {j: c for j, c in found.items() if not c.is_zero()}


def unit_lines(half_line: HalfLine, coefficients: Coefficients, sign: int, resolvent: Resolvent) -> Field:
    """The field of a named space operator at speed 1 or -1."""
    assert isinstance(half_line.interior, NamedLines)
    speed = coefficients.number(Fraction(sign))
    scheme = _lines(coefficients, half_line.interior.space, speed, sign, resolvent.of(half_line.name))
    return Field(half_line.name, (), {mirrored(half_line, j): c for j, c in scheme.items()}, speed)


# Written interiors: the basis that diagonalises all coefficient matrices ----------------------------------------------


def _written_fields(half_line: HalfLine, coefficients: Coefficients, resolvent: Resolvent) -> list[Field]:
    matrices = _coefficient_matrices(half_line, coefficients, resolvent)
    size = len(half_line.unknowns)
    if size == 1:
        return [
            Field(
                half_line.name,
                (coefficients.number(Fraction(1)),),
                _scalar(matrices, 0, coefficients, resolvent, half_line),
                None,
            )
        ]
    if all(m[i][j].is_zero() for m in matrices.values() for i in range(size) for j in range(size) if i != j):
        unit = identity(size, coefficients)
        return [
            Field(half_line.name, tuple(unit[k]), _scalar(matrices, k, coefficients, resolvent, half_line), None)
            for k in range(size)
        ]
    generators, inverted = list(coefficients.generators), dict(coefficients.inverted)
    try:
        return _joint_fields(half_line, matrices, coefficients, resolvent)
    except (NotAnalysable, ParameterError):
        # What the attempt adjoined and divided by is of no account to the coupled system.
        coefficients.generators, coefficients.inverted = generators, inverted
        return coupled_fields(half_line, coefficients, resolvent)


Key = tuple[int, int, bool]
"""Offset, level, and whether the value stands under dt."""


def _coefficient_matrices(half_line: HalfLine, coefficients: Coefficients, resolvent: Resolvent) -> dict[Key, Matrix]:
    interior = half_line.interior
    assert isinstance(interior, WrittenDiscrete | WrittenLines)
    size = len(half_line.unknowns)
    matrices: dict[Key, Matrix] = {}
    for row, form in enumerate(interior.equations):
        for value, coefficient in form.terms:
            key = (value.index, value.level, value.derivative)
            matrix = matrices.setdefault(key, [[coefficients.number(Fraction(0))] * size for _ in range(size)])
            column = half_line.unknowns.index(value.unknown)
            matrix[row][column] = matrix[row][column] + coefficients.evaluate(coefficient)
    return matrices


def _weight(key: Key, coefficients: Coefficients, resolvent: Resolvent, half_line: HalfLine, lowest: int) -> Ratio:
    """What a grid value at this level contributes as a function of the resolvent variable."""
    _, level, derivative = key
    weight = coefficients.power(resolvent.z, level - lowest) if resolvent.in_z else coefficients.number(Fraction(1))
    return weight * resolvent.of(half_line.name) if derivative else weight


def _scalar(
    matrices: Mapping[Key, Matrix], k: int, coefficients: Coefficients, resolvent: Resolvent, half_line: HalfLine
) -> Stencil:
    entries = {key: matrix[k][k] for key, matrix in matrices.items()}
    return _assemble(entries, coefficients, resolvent, half_line)


def _assemble(
    entries: Mapping[Key, Ratio], coefficients: Coefficients, resolvent: Resolvent, half_line: HalfLine
) -> Stencil:
    lowest = min(level for (_, level, _) in entries)
    found: Stencil = {}
    for key, value in entries.items():
        offset = mirrored(half_line, key[0])
        term = value * _weight(key, coefficients, resolvent, half_line, lowest)
        found[offset] = found[offset] + term if offset in found else term
    return {j: c for j, c in sorted(found.items()) if not c.is_zero()}


def _joint_fields(
    half_line: HalfLine, matrices: Mapping[Key, Matrix], coefficients: Coefficients, resolvent: Resolvent
) -> list[Field]:
    """Fields from a basis in which all coefficient matrices are diagonal.

    If C_i = L D_i R for all i, then with W any invertible combination of them W**-1 C_i = R**-1 (D_W**-1 D_i) R, and
    the eigenvectors of one generic combination of these are the columns of R**-1.
    """
    keys = sorted(matrices)
    size = len(half_line.unknowns)
    base = _combination([matrices[k] for k in keys], [3 * i + 1 for i in range(len(keys))], coefficients)
    reduced = {key: solve(base, matrices[key], coefficients) for key in keys}
    if any(m is None for m in reduced.values()):
        raise NotAnalysable(f"domain {half_line.name}: the interior equations do not determine all its unknowns")
    small: dict[Key, Matrix] = {key: m for key, m in reduced.items() if m is not None}
    mix = _combination([small[k] for k in keys], [2 * i * i + i + 1 for i in range(len(keys))], coefficients)
    found = []
    for _, vectors in eigenvectors(mix, coefficients, f"the interior of domain {half_line.name}"):
        for vector in vectors:
            entries = {key: _rayleigh(small[key], vector, coefficients, half_line) for key in keys}
            # An eigenvalue of base**-1 C: the field's scheme up to the common factor that base contributes.
            found.append(Field(half_line.name, vector, _assemble(entries, coefficients, resolvent, half_line), None))
    if len(found) != size:
        raise NotAnalysable(f"domain {half_line.name}: the eigenvectors are no basis")
    return found


def _rayleigh(matrix: Matrix, vector: Sequence[Ratio], coefficients: Coefficients, half_line: HalfLine) -> Ratio:
    image = multiply(matrix, [[v] for v in vector], coefficients)
    pivot = next(k for k, v in enumerate(vector) if not coefficients.is_zero(v.num))
    value = image[pivot][0] / vector[pivot]
    if any(not coefficients.is_zero((image[k][0] - value * v).num) for k, v in enumerate(vector)):
        raise NotAnalysable(f"domain {half_line.name}: an eigenvector of one matrix is none of another")
    return value


def _combination(matrices: Sequence[Matrix], weights: Sequence[int], coefficients: Coefficients) -> Matrix:
    size = len(matrices[0])
    total = [[coefficients.number(Fraction(0))] * size for _ in range(size)]
    for matrix, weight in zip(matrices, weights, strict=True):
        factor = coefficients.number(Fraction(weight))
        total = [[total[i][j] + factor * matrix[i][j] for j in range(size)] for i in range(size)]
    return total


# Eigenvectors -------------------------------------------------------------------------------------------------------


def eigenvectors(matrix: Matrix, coefficients: Coefficients, what: str) -> list[tuple[Ratio, list[tuple[Ratio, ...]]]]:
    """Eigenvalues with a basis of each eigenspace; irrational ones are adjoined.

    Raises ParameterError where an eigenvalue is not real or the matrix is defective.
    """
    found = []
    for value, multiplicity in _eigenvalues(matrix, coefficients, what):
        shifted = [[entry - value if i == j else entry for j, entry in enumerate(row)] for i, row in enumerate(matrix)]
        basis = kernel(shifted, coefficients)
        if len(basis) != multiplicity:
            coefficients.without_free_roots(value.num, *(entry.num for row in shifted for entry in row))
            raise ParameterError(
                f"{what} has an eigenvalue {multiplicity} times with {len(basis)} eigenvectors",
                expected="a full set of eigenvectors (a hyperbolic system)",
            )
        found.append((value, basis))
    return found


def _eigenvalues(matrix: Matrix, coefficients: Coefficients, what: str) -> list[tuple[Ratio, int]]:
    polynomial = characteristic_polynomial(matrix, coefficients)
    values: list[tuple[Ratio, int]] = []
    for factor, multiplicity in irreducible_factors(polynomial):
        powers = powers_of(factor, "x")
        if len(powers) == 1:
            continue
        if len(powers) == 2:
            values.append((Ratio.make(-powers[0], powers[1]), multiplicity))
        elif len(powers) == 3:
            values += [(value, multiplicity) for value in _quadratic(powers, coefficients, what)]
        else:
            values += [(value, multiplicity) for value in _adjoined(factor, coefficients, what)]
    return values


def _quadratic(powers: Sequence[fmpz_mpoly], coefficients: Coefficients, what: str) -> list[Ratio]:
    c, b, a = powers
    try:
        root = coefficients.sqrt(coefficients.of(b * b - 4 * a * c))
    except ParameterError:
        raise _not_hyperbolic(what) from None
    return [
        (coefficients.of(-b) + root) / coefficients.of(2 * a),
        (coefficients.of(-b) - root) / coefficients.of(2 * a),
    ]


def _adjoined(factor: fmpz_mpoly, coefficients: Coefficients, what: str) -> list[Ratio]:
    if coefficients.symbols:
        raise NotAnalysable(
            f"{what} has eigenvalues that are no square root of the parameters", mend="give its parameters values"
        )
    if coefficients.generators:
        raise NotAnalysable(f"{what} has irrational eigenvalues of degree above 2 over irrational entries")
    roots = isolated_roots(univariate(factor, "x"), is_square_free=True)
    if not all(root.is_real for root in roots):
        raise _not_hyperbolic(what)
    return [coefficients.adjoin(factor, root) for root in roots]


def _not_hyperbolic(what: str) -> ParameterError:
    return ParameterError(f"{what} has eigenvalues that are not real", expected="a hyperbolic system")
