"""A claimed bound held against a theorem: for every value of the parameter, not at samples.

Over a cell of the theorem the bound is one root of one polynomial g in lam, apart from the others. A claim f, with its
minima and maxima decided, is that root on a whole interval where g(p, f(p)) = 0 as a formula, f is continuous, and the
two agree at one point. So an interval is cut where something in f may switch or break (arguments of a minimum that
meet, radicands, divisors), and each part is decided at a sample. At the finitely many values between, both sides are
continuous, or an exact stable set decides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations, pairwise

from flint import fmpz_mpoly, fmpz_poly

from gks.bounds.claimvalue import ClaimField, compare
from gks.bounds.criticality import between
from gks.bounds.region import Branch, Cell, Cut, Decomposition, value_of
from gks.errors import NotAnalysable, ParameterError
from gks.modes.algebraic import Root, isolated_roots
from gks.modes.coefficients import Ratio
from gks.modes.fibre import coefficients as powers_of
from gks.modes.fibre import univariate
from gks.modes.unimodular import by_real_part
from gks.scheme.expression import Expr

Values = Mapping[str, Fraction]
Ends = tuple[Root | None, Root | None]


def holds_throughout(
    formula: Expr,
    region: Decomposition,
    parameter: str,
    values: Values,
    domain: tuple[Fraction | None, Fraction | None],
) -> bool:
    """Whether the claim is proved to be the theorem's bound for every value of the parameter in the domain.

    False says that it is not proved so; the claim may still be right.
    """
    low, high = (None if end is None else Root.of(end) for end in domain)
    places = [cut.root for cut in region.cuts]
    try:
        return all(
            _on_cell(formula, region, cell, (start, end), parameter, values)
            for cell, (start, end) in zip(region.cells, pairwise([low, *places, high]), strict=True)
        ) and all(_on_cut(formula, cut, parameter, values) for cut in region.cuts)
    except (ParameterError, NotAnalysable):
        return False


def _on_cell(formula: Expr, region: Decomposition, cell: Cell, ends: Ends, parameter: str, values: Values) -> bool:
    waiting = [ends]
    while waiting:
        low, high = waiting.pop()
        sample = between(low, high)
        field = _Following(values, parameter, sample)
        claimed = field.evaluate(formula)
        inside = _roots_between(field.breaks(), low, high)
        if inside:
            if any(field.breaks_off(root) for root in inside):
                return False
            waiting += pairwise([low, *inside, high])
            continue
        if not _is_bound(field, claimed, region, cell, sample):
            return False
        if compare(formula, {**values, parameter: sample}, _bound(region, cell, sample)):
            return False
    return True


def _bound(region: Decomposition, cell: Cell, sample: Fraction) -> Root:
    """lam_max over a cell; ParameterError where it is infinite, which no claim is."""
    first = cell.spans[0] if cell.spans else None
    if first is None or first.low is not None:
        return Root.of(0)
    if first.high is None:
        raise ParameterError("no bound")
    return value_of(region.boundary, first.high, sample)


def _is_bound(field: _Following, claimed: Ratio, region: Decomposition, cell: Cell, sample: Fraction) -> bool:
    """g(p, f) = 0 as a formula."""
    first = cell.spans[0] if cell.spans else None
    if first is None or first.low is not None:
        return field.vanishes(claimed.num)
    if not isinstance(first.high, Branch):
        return False
    total = field.number(Fraction(0))
    for power, part in enumerate(powers_of(region.boundary.curves[first.high.curve], "lam")):
        weight = field.in_parameter(univariate(part, "p"))
        total = total + weight * field.power(claimed, power) if power else total + weight
    return field.vanishes(total.num)


def _on_cut(formula: Expr, cut: Cut, parameter: str, values: Values) -> bool:
    """At a cut the claim has a value; where the stable set is not the limit of both sides, the value is compared."""
    exact = cut.root.rational
    if exact is None:
        field = _Following(values, parameter, between(cut.root, None))
        field.evaluate(formula)
        return cut.spans is None and not field.breaks_off(cut.root)
    here = {**values, parameter: exact}
    if cut.spans is None:
        ClaimField(here).evaluate(formula)
        return True
    first = cut.spans[0] if cut.spans else None
    if first is None or first.low is not None:
        return compare(formula, here, Root.of(0)) == 0
    return isinstance(first.high, Root) and compare(formula, here, first.high) == 0


def _roots_between(polynomials: Sequence[fmpz_poly], low: Root | None, high: Root | None) -> list[Root]:
    factors = {str(f): f for polynomial in polynomials for f, _ in polynomial.factor()[1]}
    roots = [r for f in factors.values() for r in isolated_roots(f, is_square_free=True) if r.is_real]
    return by_real_part([r for r in roots if (low is None or low < r) and (high is None or r < high)])


class _Following(ClaimField):
    """The field of functions of the parameter; what may switch or break is recorded, a sample decides its sign."""

    __slots__ = ("_divisors", "_name", "_switches")

    def __init__(self, values: Values, parameter: str, sample: Fraction) -> None:
        super().__init__({**values, parameter: sample}, (parameter,))
        self._name = parameter
        self._switches: list[fmpz_mpoly] = []
        self._divisors: list[fmpz_mpoly] = []

    def minimum(self, values: Sequence[Ratio]) -> Ratio:
        self._switches += [(one - other).num for one, other in combinations(values, 2)]
        return super().minimum(values)

    def sqrt(self, value: Ratio) -> Ratio:
        self._switches.append(value.num * value.den)
        if self.sign(value) < 0:
            raise ParameterError("the square root of a negative number")
        return super().sqrt(value)

    def power(self, base: Ratio, exponent: int) -> Ratio:
        if exponent < 0:
            self._divisors.append(base.num)
        return super().power(base, exponent)

    def in_parameter(self, polynomial: fmpz_poly) -> Ratio:
        """A polynomial in p."""
        p = self.gens[self.variable(self._name)]
        return self.of(sum((int(c) * p**k for k, c in enumerate(list(polynomial))), self.context.constant(0)))

    def vanishes(self, polynomial: fmpz_mpoly) -> bool:
        """Whether a polynomial is reduced to 0 by the square roots' relations."""
        for generator in reversed(self.generators):
            q = self.gens[generator.name]
            square = q * q - generator.relation
            if square.degrees()[list(self.gens).index(generator.name)]:
                return False  # no square root
            rest = self.context.constant(0)
            for power, part in enumerate(powers_of(polynomial, generator.name)):
                rest += part * square ** (power // 2) * q ** (power % 2)
            polynomial = rest
        return bool(polynomial.is_zero())

    def breaks(self) -> list[fmpz_poly]:
        """Polynomials in p at whose roots the formula may switch or break."""
        return [each for found in (self._switches, self._divisors) for each in self._in_p(found)]

    def breaks_off(self, root: Root) -> bool:
        """Whether a divisor may vanish at a value of the parameter."""
        mine = root.minimal.poly
        return any(not each % mine for each in self._in_p(self._divisors))

    def _in_p(self, polynomials: Sequence[fmpz_mpoly]) -> list[fmpz_poly]:
        normed = [self.norm(each) for each in polynomials if not self.vanishes(each)]
        if any(each.is_zero() for each in normed):
            raise NotAnalysable("a formula that vanishes for one choice of its square roots")
        return [univariate(each, self.variable(self._name)) for each in normed]
