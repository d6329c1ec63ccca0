"""Named space operators and fully discrete schemes, as exact stencils with their sources.

For the scalar model q_t + a q_x = 0 (dx = 1):

- a space operator is sum_j m_j dt q[i+j] = -a sum_j d_j q[i+j]: mass m, derivative d;
- a fully discrete scheme is q[i, n+1] = sum_j c_j(nu) q[i+j, n], nu = lam a (signed), c_j polynomial in nu.

The tables hold the waves that run to the right (a > 0), for which upwind stencils lean to the left. Reflecting
x -> -x turns them into those for a < 0: m_j -> m_{-j}, d_j -> -d_{-j}, c_j(nu) -> c_{-j}(-nu). Symmetric
operators are their own reflection. For a system q_t + A q_x = 0 the coefficient of q[i+j] is the matrix function
sum_w d_j(w) w P_w (or c_j(lam w) P_w) over the eigenvalues w of A with projectors P_w.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from gks.errors import IrrationalValue, ParameterError, SchemeError
from gks.scheme import fields
from gks.scheme.generic import generic_points
from gks.scheme.model import HalfLine, NamedLines, NamedScheme, Parameter

if TYPE_CHECKING:
    from gks.scheme.expression import Expr

Coefficients = tuple[Fraction, ...]


@dataclass(frozen=True, slots=True)
class Stencil:
    """sum_j mass[j] dt q[i+j] = -a sum_j derivative[j] q[i+j], dx = 1.

    order : sum_j d_j p(j) = sum_j m_j p'(j) for every polynomial p of degree <= order and not of degree order + 1.
    upwinded : whether the stencil depends on the sign of a.
    """

    name: str
    mass: Mapping[int, Fraction]
    derivative: Mapping[int, Fraction]
    order: int
    source: str
    upwinded: bool

    def mirrored(self) -> Stencil:
        """The reflection x -> -x, which carries a to -a."""
        mass = {-j: self.mass[j] for j in sorted(self.mass, reverse=True)}
        derivative = {-j: -self.derivative[j] for j in sorted(self.derivative, reverse=True)}
        return Stencil(self.name, mass, derivative, self.order, self.source, self.upwinded)


@dataclass(frozen=True, slots=True)
class DiscreteStencil:
    """q[i, n+1] = sum_j c_j(nu) q[i+j, n], coefficients[j] = c_j ascending in nu = lam a (signed).

    order : sum_j c_j(nu) j**k = (-nu)**k, as polynomials in nu, for k <= order and not for k = order + 1.
    upwinded : whether the stencil depends on the sign of a.
    """

    name: str
    coefficients: Mapping[int, Coefficients]
    order: int
    source: str
    upwinded: bool

    def mirrored(self) -> DiscreteStencil:
        """The reflection x -> -x, which carries nu to -nu."""
        reflected = {
            -j: tuple(-c if power % 2 else c for power, c in enumerate(self.coefficients[j]))
            for j in sorted(self.coefficients, reverse=True)
        }
        return DiscreteStencil(self.name, reflected, self.order, self.source, self.upwinded)


def stencil(name: str, positive: bool) -> Stencil:
    """The named space operator for waves to the right (positive) or to the left; KeyError if there is none."""
    right = SPACE_OPERATORS[name]
    return right if positive or not right.upwinded else right.mirrored()


def discrete_stencil(name: str, positive: bool) -> DiscreteStencil:
    """The named fully discrete scheme for waves to the right (positive) or to the left; KeyError if there is none."""
    right = DISCRETE_SCHEMES[name]
    return right if positive or not right.upwinded else right.mirrored()


def _space(
    name: str, order: int, source: str, derivative: dict[int, int], over: int,
    mass: dict[int, Fraction] | None = None, upwinded: bool = False,
) -> Stencil:  # fmt: skip
    scaled = {j: Fraction(d, over) for j, d in derivative.items()}
    return Stencil(name, mass or {0: Fraction(1)}, scaled, order, source, upwinded)


def _discrete(
    name: str, order: int, source: str, coefficients: dict[int, tuple[int, ...]], over: int, upwinded: bool = False
) -> DiscreteStencil:
    scaled = {j: tuple(Fraction(c, over) for c in row) for j, row in coefficients.items()}
    return DiscreteStencil(name, scaled, order, source, upwinded)


_FORNBERG = "Fornberg, Math. Comp. 51 (1988) 699-706, Table 1"

_SPACE = (
    _space(
        "upwind1", 1, "Courant, Isaacson & Rees, Comm. Pure Appl. Math. 5 (1952) 243-255",
        {-1: -1, 0: 1}, 1, upwinded=True,
    ),
    _space(
        "upwind2", 2, "one-sided differences, Fornberg, Math. Comp. 51 (1988) 699-706, Table 3",
        {-2: 1, -1: -4, 0: 3}, 2, upwinded=True,
    ),
    _space(
        "upwind3", 3, "kappa = 1/3 of van Leer, Lect. Appl. Math. 22 (1985) 327-336 (third-order upwind-biased)",
        {-2: 1, -1: -6, 0: 3, 1: 2}, 6, upwinded=True,
    ),
    _space(
        "fromm", 2, "Fromm, J. Comput. Phys. 3 (1968) 176-189, without its time correction (kappa = 0 of van Leer)",
        {-2: 1, -1: -5, 0: 3, 1: 1}, 4, upwinded=True,
    ),
    _space("central2", 2, _FORNBERG, {-1: -1, 1: 1}, 2),
    _space("central4", 4, _FORNBERG, {-2: 1, -1: -8, 1: 8, 2: -1}, 12),
    _space("central6", 6, _FORNBERG, {-3: -1, -2: 9, -1: -45, 1: 45, 2: -9, 3: 1}, 60),
    _space(
        "compact4", 4, "Lele, J. Comput. Phys. 103 (1992) 16-42, (2.1.6), alpha = 1/4 (the classical Padé scheme)",
        {-1: -3, 1: 3}, 4, mass={-1: Fraction(1, 4), 0: Fraction(1), 1: Fraction(1, 4)},
    ),
)  # fmt: skip

_DISCRETE = (
    _discrete(
        "lax-friedrichs", 1, "Lax, Comm. Pure Appl. Math. 7 (1954) 159-193",
        {-1: (1, 1), 1: (1, -1)}, 2,
    ),
    _discrete(
        "lax-wendroff", 2, "Lax & Wendroff, Comm. Pure Appl. Math. 13 (1960) 217-237",
        {-1: (0, 1, 1), 0: (2, 0, -2), 1: (0, -1, 1)}, 2,
    ),
    _discrete(
        "beam-warming", 2, "Warming & Beam, AIAA J. 14 (1976) 1241-1249",
        {-2: (0, -1, 1), -1: (0, 4, -2), 0: (2, -3, 1)}, 2, upwinded=True,
    ),
    _discrete(
        "fromm", 2, "Fromm, J. Comput. Phys. 3 (1968) 176-189: the mean of Lax-Wendroff and Beam-Warming",
        {-2: (0, -1, 1), -1: (0, 5, -1), 0: (4, -3, -1), 1: (0, -1, 1)}, 4, upwinded=True,
    ),
)  # fmt: skip

SPACE_OPERATORS: dict[str, Stencil] = {each.name: each for each in _SPACE}
DISCRETE_SCHEMES: dict[str, DiscreteStencil] = {each.name: each for each in _DISCRETE}


# --- which grid values an interior scheme reads -------------------------------------------------------------------

_BITS = 1024
"""Precision of the balls for fluxes with irrational entries: a value below 2**-900 would be taken for zero."""


def reach(half_line: HalfLine, parameters: Sequence[Parameter]) -> dict[str, tuple[int, int]]:
    """The offsets (least, greatest) at which the interior of a half-line reads each unknown, at whatever level.

    Counted from the formulas, over the whole parameter range and never at one value: an offset counts if its
    coefficient is not identically zero in some equation. Unknowns that are never read are absent.

    Raises SchemeError where an upwinded operator meets a flux that has no real diagonalisation at any point tried.
    """
    if isinstance(half_line.interior, NamedLines | NamedScheme):
        return _named_reach(half_line, half_line.interior, parameters)
    offsets: dict[str, set[int]] = {}
    for form in half_line.interior.equations:
        for value, _ in form.terms:
            offsets.setdefault(value.unknown, set()).add(value.index)
    return {unknown: (min(found), max(found)) for unknown, found in offsets.items()}


def _named_reach(
    half_line: HalfLine, interior: NamedLines | NamedScheme, parameters: Sequence[Parameter]
) -> dict[str, tuple[int, int]]:
    """Every unknown is read where dt(…) or level n+1 stands; elsewhere the fields it carries decide, point by point."""
    if isinstance(interior, NamedLines):
        right, left = (stencil(interior.space, positive).mass for positive in (True, False))
        upwinded, standing = SPACE_OPERATORS[interior.space].upwinded, {0, *right, *left}
    else:
        upwinded, standing = DISCRETE_SCHEMES[interior.scheme].upwinded, {0}
    found = {unknown: set(standing) for unknown in half_line.unknowns}
    refused: SchemeError | None = None
    analysed = False
    for flux, functions in _evaluations(half_line, interior, parameters):
        annihilators = [fields.annihilator(flux, column) for column in range(len(flux))]
        if upwinded and not all(map(fields.roots_real_and_simple, annihilators)):
            refused = refused or _not_hyperbolic(half_line, annihilators)
            continue
        analysed = True
        for unknown, polynomial in zip(half_line.unknowns, annihilators, strict=True):
            found[unknown] |= _offsets_read(polynomial, functions, upwinded)
        if all(read >= functions.keys() for read in found.values()):
            break  # no other point can add any
    if refused and not analysed:
        raise refused
    return {unknown: (min(offsets), max(offsets)) for unknown, offsets in found.items()}


Function = tuple[fields.Polynomial, fields.Polynomial]
"""The coefficient of q[i+j] as a polynomial in the eigenvalue: for the positive ones, and for the negative ones."""


def _offsets_read(annihilator: fields.Polynomial, functions: Mapping[int, Function], upwinded: bool) -> set[int]:
    """The offsets whose coefficient function does not vanish at every root of the annihilator (see `fields`)."""
    read = set()
    for offset, (positive, negative) in functions.items():
        if upwinded:
            right = fields.without_common_roots(annihilator, positive)
            left = fields.without_common_roots(annihilator, negative)
            found = fields.has_root(right, positive=True) or fields.has_root(left, positive=False)
        else:
            found = len(fields.without_common_roots(annihilator, positive)) > 1
        if found:
            read.add(offset)
    return read


def _evaluations(
    half_line: HalfLine, interior: NamedLines | NamedScheme, parameters: Sequence[Parameter]
) -> Iterator[tuple[fields.Matrix, dict[int, Function]]]:
    """Flux matrix and coefficient functions at every generic point where the flux has a value."""
    if half_line.flux is None:
        raise ValueError(f"half-line {half_line.name}: a named interior scheme without a flux")
    symbols = frozenset().union(*(entry.symbols for row in half_line.flux for entry in row))
    discrete = isinstance(interior, NamedScheme)
    drawn = [p for p in parameters if p.name in symbols or (discrete and p.role == "cfl")]
    cfl = next((p.name for p in parameters if p.role == "cfl"), None)
    for values in generic_points(drawn):
        lam = values[cfl] if discrete and cfl is not None else Fraction(1)
        functions = _functions(interior, lam)
        try:
            yield [[entry.at(values) for entry in row] for row in half_line.flux], functions
        except ParameterError:  # division by zero just there, as at x = 1 in 1/(x - 1)
            continue
        except IrrationalValue:
            yield from _in_balls(half_line.flux, values, functions)


def _functions(interior: NamedLines | NamedScheme, lam: Fraction) -> dict[int, Function]:
    """d_j x of a space operator, or c_j(lam x) of a fully discrete scheme, for the two signs of x."""
    sides: list[dict[int, list[fields.Number]]] = []
    for positive in (True, False):
        if isinstance(interior, NamedLines):
            derivative = stencil(interior.space, positive).derivative
            sides.append({j: [Fraction(0), d] for j, d in derivative.items()})
        else:
            coefficients = discrete_stencil(interior.scheme, positive).coefficients
            sides.append({j: [c * lam**power for power, c in enumerate(row)] for j, row in coefficients.items()})
    return {j: (sides[0].get(j, []), sides[1].get(j, [])) for j in sorted(sides[0].keys() | sides[1].keys())}


def _in_balls(
    flux: Sequence[Sequence[Expr]], values: Mapping[str, Fraction], functions: Mapping[int, Function]
) -> Iterator[tuple[fields.Matrix, dict[int, Function]]]:
    """The same evaluation in real balls; nothing where a square root is not real or a divisor not clearly nonzero.

    The precision stays raised until the consumer asks for the next point, since it goes on computing with these balls.
    """
    import flint

    with flint.ctx.workprec(_BITS):
        algebra = fields.BallAlgebra(values)
        matrix = [[entry.fold(algebra) for entry in row] for row in flux]
        if all(entry.is_finite() for row in matrix for entry in row):
            yield matrix, {j: (fields.to_balls(p), fields.to_balls(q)) for j, (p, q) in functions.items()}


def _not_hyperbolic(half_line: HalfLine, annihilators: Sequence[fields.Polynomial]) -> SchemeError:
    eigenvalues = ", ".join(sorted({text for each in annihilators for text in fields.roots_text(each)}))
    return SchemeError(
        f"the flux is not hyperbolic: its eigenvalues {eigenvalues} are not all real with a full set of eigenvectors",
        path=f"domains.{half_line.name}.flux",
        expected="upwinding splits the flux by the signs of real eigenvalues",
        mend="mend the flux, or take a central operator",
    )
