"""Cauchy (von Neumann) stability of a scalar scheme F(z, kappa) = 0, decided exactly.

The scheme is uniformly power-bounded on the line when, for every abs(kappa) = 1, the leading coefficient of F in z is
not zero, every root has abs(z) <= 1 and the roots with abs(z) = 1 are simple. (Simple eigenvalues stay apart on the
compact circle and a companion matrix depends continuously on kappa, so the pointwise condition is uniform.)

For abs(kappa) = 1 the roots of F*(z, kappa) = z**L kappa**m F(1/z, 1/kappa) are the images of those of F under the
inversion z -> 1/conj(z). A unimodular root is therefore a common root of F and F*. Take F irreducible. Either F and F*
are coprime: then unimodular roots occur only over the finitely many zeros of Res_z(F, F*). Or they agree up to a
constant, as in every nondissipative scheme: then the roots are unimodular or come in pairs z, 1/conj(z), and pairs can
form only over a zero of the discriminant. Either way finitely many unimodular kappas cut the circle into arcs on which
the numbers of roots inside, on and outside are constant. One rational point an arc and every cut are tested exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from math import prod

from flint import acb, ctx, fmpz_mpoly, fmpz_poly

from gks.modes.algebraic import GUARD_BITS, START_BITS, Position, Root
from gks.modes.amplification import under_multistep
from gks.modes.factoring import irreducible_factors
from gks.modes.fibre import (
    VanishesIdentically,
    coefficients,
    fibre,
    is_zero,
    norm,
    polynomial_at_balls,
    specialise,
    univariate,
    vanishes,
)
from gks.modes.unimodular import arc_samples, unimodular_roots

#: Precision up to which balls are tried for the cheap proof that all roots lie strictly inside. Beyond it the exact
#: route decides, so only speed depends on this number.
CHEAP_BITS = 4 * START_BITS


DoubleRootRule = Callable[[Mapping[str, Root], Root, Root], bool]
"""For F = det M of a coupled system: whether a multiple root on the circle, at (point, kappa, z), is harmless."""


class Instability(Enum):
    """Why a scheme is not Cauchy-stable."""

    GROWING = "growing"
    DOUBLE_ROOT = "double root on the circle"
    LEADING_COEFFICIENT = "leading coefficient vanishes"


@dataclass(frozen=True, slots=True)
class CauchyResult:
    """A verdict and, where it is "no", a unimodular kappa as witness with (but for a vanishing coefficient) its z."""

    stable: bool
    reason: Instability | None = None
    kappa: Root | None = None
    z: Root | None = None


@dataclass(frozen=True, slots=True)
class Factors:
    """F as a product of powers of polynomials irreducible over the rationals; ``point`` holds its other variables.

    ``idle`` are the factors without z and kappa, none of them zero at the point.
    """

    powers: tuple[tuple[fmpz_mpoly, int], ...]
    idle: tuple[fmpz_mpoly, ...]
    point: Mapping[str, Root]
    z: str
    kappa: str


def cauchy_stable(
    poly: fmpz_mpoly,
    point: Mapping[str, Root] | None = None,
    *,
    z: str = "z",
    kappa: str = "kappa",
    harmless: DoubleRootRule | None = None,
) -> CauchyResult:
    """Decide whether the scalar scheme ``poly(z, kappa) = 0`` is Cauchy-stable.

    ``point`` gives every other variable of ``poly`` a real algebraic value; ``harmless`` judges multiple roots on the
    circle, which are all fatal without it. Raises ValueError where ``poly`` holds no
    z, VanishesIdentically where it is zero at the point.
    """
    if not degree_in(poly, z):
        raise ValueError(f"expected a polynomial in {z} and {kappa}, got {poly}")
    factors = factored(poly, point or {}, z=z, kappa=kappa)
    if _loses_a_root(poly, factors):
        return CauchyResult(False, Instability.LEADING_COEFFICIENT, Root.of(1))
    cuts = unimodular_roots(_cutting_polynomial(factors))
    for spot in (*arc_samples(cuts), *cuts):
        failure = _failure_at(factors, spot, _bound(harmless, point))
        if failure is not None:
            return failure
    return CauchyResult(stable=True)


def _bound(harmless: DoubleRootRule | None, point: Mapping[str, Root] | None) -> Callable[[Root, Root], bool]:
    if harmless is None:
        return lambda kappa, z: False
    rule, at = harmless, point or {}
    return lambda kappa, z: rule(at, kappa, z)


def stable_as_limit(
    poly: fmpz_mpoly,
    point: Mapping[str, Root] | None = None,
    *,
    z: str = "z",
    kappa: str = "kappa",
    harmless: DoubleRootRule | None = None,
) -> CauchyResult:
    """Like ``cauchy_stable``, at a point that is a limit of points known to be Cauchy-stable: less is left to test.

    By continuity no root is outside, except through infinity; so only leading coefficients and double roots on the
    circle can be at fault, and these lie over common zeros in kappa of few polynomials.
    """
    factors = factored(poly, point or {}, z=z, kappa=kappa)
    if _loses_a_root(poly, factors):
        return CauchyResult(False, Instability.LEADING_COEFFICIENT, Root.of(1))
    suspects = prod(_suspects(factors), start=fmpz_poly([1]))
    if not suspects:
        return cauchy_stable(poly, point, z=z, kappa=kappa, harmless=harmless)
    for spot in unimodular_roots(suspects):
        failure = _failure_at(factors, spot, _bound(harmless, point))
        if failure is not None:
            return failure
    return CauchyResult(stable=True)


def _suspects(factors: Factors) -> Iterator[fmpz_poly]:
    """Polynomials in kappa with every unimodular kappa at which a limit of stable schemes can fail; 0: every kappa."""
    for k, (factor, power) in enumerate(factors.powers):
        yield _norm_in_kappa(factors, coefficients(factor, factors.z)[-1])
        double = [factor.resultant(other, factors.z) for other, _ in factors.powers[:k]]
        if degree_in(factor, factors.z) > 1:
            double.append(factor.discriminant(factors.z))
        for locus in double:
            yield _norm_in_kappa(factors, locus) or _on_circle(factors, factor)
        if power > 1:
            yield _on_circle(factors, factor)


def _on_circle(factors: Factors, factor: fmpz_mpoly) -> fmpz_poly:
    """An integer polynomial in kappa whose zeros lie under all unimodular roots z; 0 where that is every kappa."""
    mirrored = reciprocal_in(factor, (factors.z, factors.kappa))
    return _norm_in_kappa(factors, factor.resultant(mirrored, factors.z))


def _norm_in_kappa(factors: Factors, poly: fmpz_mpoly) -> fmpz_poly:
    """An integer polynomial in kappa that has the zeros of ``poly`` at the point, zero where that is."""
    if vanishes(factors.point, poly):
        return fmpz_poly([])
    return univariate(norm(factors.point, _reduced(factors, poly)), factors.kappa)


def _loses_a_root(poly: fmpz_mpoly, factors: Factors) -> bool:
    """Whether the leading coefficient in z is zero at the point for every kappa."""
    kept = sum(power * (len(_trimmed(factors, factor)) - 1) for factor, power in factors.powers)
    return kept < degree_in(poly, factors.z)


def semi_discrete_stable(
    symbol: fmpz_mpoly,
    point: Mapping[str, Root] | None = None,
    *,
    s: str = "s",
    kappa: str = "kappa",
    harmless: DoubleRootRule | None = None,
) -> CauchyResult:
    """Decide Re s <= 0, roots on the axis simple, for the scalar method of lines ``symbol(s, kappa) = 0``.

    The Cayley map z = (1 + s)/(1 - s) takes the left half-plane to the disk. It would put s = infinity at z = -1; that
    is a vanishing leading coefficient, and refused first. The witness's ``z``, and the one that ``harmless`` is asked
    about, is the Cayley image.
    """
    for spot in _zeros_on_circle(coefficients(symbol, s)[-1], point or {}, kappa):
        return CauchyResult(False, Instability.LEADING_COEFFICIENT, spot)
    # In the Cayley image the generator s itself can serve as z.
    cayley = under_multistep(symbol, fmpz_poly([-1, 1]), fmpz_poly([1, 1]), lam=symbol.context().constant(1), s=s, z=s)
    return cauchy_stable(cayley, point, z=s, kappa=kappa, harmless=harmless)


def factored(poly: fmpz_mpoly, point: Mapping[str, Root], *, z: str, kappa: str) -> Factors:
    """``poly`` with rational coordinates put in, factored over the rationals.

    Raises VanishesIdentically where ``poly`` is zero at the point for every z and kappa.
    """
    rational = {name: root.rational for name, root in point.items()}
    rest = specialise(poly, {name: exact for name, exact in rational.items() if exact is not None})
    algebraic = {name: root.minimal for name, root in point.items() if degree_in(rest, name)}
    powers, idle = [], []
    for factor, power in irreducible_factors(rest) if rest else ((rest, 1),):
        if degree_in(factor, z) or degree_in(factor, kappa):
            powers.append((factor, power))
        elif vanishes(algebraic, factor):
            raise VanishesIdentically(f"{poly} vanishes for every {z} and {kappa} at {dict(point)}")
        else:
            idle.append(factor)
    return Factors(tuple(powers), tuple(idle), algebraic, z, kappa)


def cuts_of(factors: Factors) -> Iterator[fmpz_mpoly]:
    """Polynomials, none zero at the point, off whose unimodular zeros in kappa the counts of roots are constant.

    The leading coefficients (a root at infinity); the locus of common roots with F*; and where there are common roots
    for every kappa, the loci where two of them meet.
    """
    neutral: list[fmpz_mpoly] = []
    for factor, _ in factors.powers:
        yield coefficients(factor, factors.z)[-1]
        mirrored = reciprocal_in(factor, (factors.z, factors.kappa))
        resultant = factor.resultant(mirrored, factors.z)
        if not vanishes(factors.point, resultant):
            yield resultant
            continue
        yield from _common_root_loci(factors, factor, mirrored)
        yield from _common_root_loci(factors, factor, factor.derivative(factors.z))
        for other in neutral:
            yield from _common_root_loci(factors, factor, other)
        neutral.append(factor)


def _common_root_loci(factors: Factors, f: fmpz_mpoly, g: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    """Polynomials in kappa off whose zeros f and g have a constant number of common roots z.

    The resultant, where it is not zero at the point; else the leading coefficients along a pseudo-remainder sequence,
    which specialises well where none of them vanishes.
    """
    resultant = f.resultant(g, factors.z)
    if not vanishes(factors.point, resultant):
        yield resultant
        return
    first, second = _trimmed(factors, f), _trimmed(factors, g)
    if len(first) < len(second):
        first, second = second, first
    while second:
        yield second[-1]
        first, second = second, _trimmed_list(factors, _pseudo_remainder(first, second))


def _pseudo_remainder(dividend: list[fmpz_mpoly], divisor: list[fmpz_mpoly]) -> list[fmpz_mpoly]:
    """Coefficients of a nonzero multiple of the remainder; lists of coefficients of z**0, z**1, ..."""
    remainder = list(dividend)
    while len(remainder) >= len(divisor):
        lead, shift = remainder[-1], len(remainder) - len(divisor)
        remainder = [divisor[-1] * c for c in remainder]
        for k, c in enumerate(divisor):
            remainder[k + shift] -= lead * c
        remainder.pop()
    return remainder


def _trimmed(factors: Factors, poly: fmpz_mpoly) -> list[fmpz_mpoly]:
    return _trimmed_list(factors, coefficients(poly, factors.z))


def _trimmed_list(factors: Factors, parts: list[fmpz_mpoly]) -> list[fmpz_mpoly]:
    """Without the leading coefficients that are zero at the point for every kappa."""
    while parts and vanishes(factors.point, parts[-1]):
        parts.pop()
    return parts


def _failure_at(factors: Factors, spot: Root, harmless: Callable[[Root, Root], bool]) -> CauchyResult | None:
    """What goes wrong at one unimodular kappa, None if nothing does."""
    here = {**factors.point, factors.kappa: spot}
    on_circle: dict[Root, int] = {}
    for factor, power in factors.powers:
        if _strictly_inside(factors, factor, spot):
            continue
        if is_zero(here, coefficients(factor, factors.z)[-1]):
            return CauchyResult(False, Instability.LEADING_COEFFICIENT, spot)
        for found in fibre(here, factor, factors.z):
            if found.position is Position.OUTSIDE:
                return CauchyResult(False, Instability.GROWING, spot, found.root)
            if found.position is Position.ON:
                on_circle[found.root] = on_circle.get(found.root, 0) + found.multiplicity * power
    for root, multiplicity in on_circle.items():
        if multiplicity > 1 and not harmless(spot, root):
            return CauchyResult(False, Instability.DOUBLE_ROOT, spot, root)
    return None


def _strictly_inside(factors: Factors, factor: fmpz_mpoly, spot: Root) -> bool:
    """A cheap proof, in balls, that all roots z at this kappa are inside; False proves nothing."""
    bits = START_BITS
    while bits <= CHEAP_BITS:
        with ctx.workprec(bits + GUARD_BITS):
            balls = {name: root.ball(bits) for name, root in factors.point.items()}
            balls[factors.kappa] = spot.ball(bits)
            if schur_stable(polynomial_at_balls(factor, factors.z, balls)):
                return True
        bits *= 2
    return False


def schur_stable(parts: list[acb]) -> bool:
    """Whether the Schur-Cohn recursion proves that all roots of sum parts[k] z**k, leading ball nonzero, are inside."""
    while len(parts) > 1:
        first, last = parts[0], parts[-1]
        if not abs(last) > abs(first):
            return False
        mirrored = [c.conjugate() for c in reversed(parts)]
        parts = [last.conjugate() * c - first * m for c, m in zip(parts, mirrored, strict=True)][1:]
    return abs(parts[0]) > 0


def _cutting_polynomial(factors: Factors) -> fmpz_poly:
    """One integer polynomial in kappa with every cut among its roots (norms may add roots, which do no harm)."""
    return prod(
        (_norm_in_kappa(factors, cut) for cut in cuts_of(factors)),
        start=fmpz_poly([1]),
    )


def _reduced(factors: Factors, cut: fmpz_mpoly) -> fmpz_mpoly:
    """``cut`` without repeated factors: the norms to come are powers of its degree."""
    if not factors.point:
        return cut
    return prod((factor for factor, _ in irreducible_factors(cut)), start=cut.context().constant(1))


def _zeros_on_circle(poly: fmpz_mpoly, point: Mapping[str, Root], kappa: str) -> list[Root]:
    """The unimodular kappas, imaginary part >= 0, at which ``poly(kappa)`` is zero; kappa = 1 where all of them are."""
    try:
        factors = factored(poly, point, z=kappa, kappa=kappa)
    except VanishesIdentically:
        return [Root.of(1)]
    product = prod((factor for factor, _ in factors.powers), start=poly.context().constant(1))
    candidates = unimodular_roots(univariate(norm(factors.point, product), kappa))
    return [spot for spot in candidates if is_zero({**factors.point, kappa: spot}, product)]


def reciprocal_in(poly: fmpz_mpoly, names: tuple[str, ...]) -> fmpz_mpoly:
    """``poly`` with each of the named variables replaced by its inverse, times the monomial that clears them."""
    context = poly.context()
    turned = {context.variable_to_index(name) for name in names}
    degrees = poly.degrees()
    return context.from_dict(
        {
            tuple(degrees[k] - e if k in turned else e for k, e in enumerate(exponents)): int(coefficient)
            for exponents, coefficient in poly.to_dict().items()
        }
    )


def degree_in(poly: fmpz_mpoly, name: str) -> int:
    """The degree of ``poly`` in one variable (0 for the zero polynomial)."""
    return max(0, poly.degrees()[poly.context().variable_to_index(name)])
