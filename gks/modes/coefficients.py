"""Exact coefficients: rational functions of the parameters, with real algebraic numbers adjoined.

Everything the analyser computes with is a quotient of two integer polynomials in one FLINT context. The
context has the resolvent variable (``s`` under the method of lines with one-level closures, else ``z``), the
spatial variable ``x`` (kappa of the mirrored half-line), one variable for each spatial root that an elimination
has to carry (``k0``, ``k1``, ...), one for each adjoined irrational number (``q0``, ...), and the parameters
that stay symbolic.

A square root that is not rational and a flux eigenvalue that is not rational become *generators*: a variable
with a polynomial relation, and the isolated real root that says which conjugate is meant. Elimination takes
the norm over the relation; the conjugates that this adds are told apart by the isolated root.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import isqrt

from flint import Ordering, acb, ctx, fmpq, fmpz, fmpz_mpoly, fmpz_mpoly_ctx

from gks.errors import IrrationalValue, NotAnalysable, ParameterError
from gks.modes.algebraic import GUARD_BITS, START_BITS, Root, isolated_roots
from gks.modes.fibre import at_balls, embed, is_zero, univariate
from gks.scheme.expression import Expr

KAPPA_VARIABLES = 8
"""Spatial roots that one elimination may carry; wider problems belong to the numeric route."""
GENERATOR_VARIABLES = 6
"""Irrational numbers that one scheme may adjoin."""
EXPANSION_DEGREE = 60
"""Degree that one formula may have in the symbols: eliminants and their roots then stay within seconds."""
EXPANSION_TERMS = 20_000
"""Terms that one formula may have once it is multiplied out in the symbols: about a second of arithmetic."""
SIGN_BITS = 1 << 14
"""A nonzero number whose sign that many bits leave open, and some of its own length, comes from symbols set at one of
its zeros."""
SIGN_LENGTHS = 8
"""How many times the length of its longest coefficient is added to that: a - sqrt(a**2 + 1) takes twice."""


def value_ball(value: Fraction | Root, bits: int) -> acb:
    """A ball around a parameter's value."""
    return value.ball(bits) if isinstance(value, Root) else acb(fmpq(value.numerator, value.denominator))


@dataclass(frozen=True, slots=True)
class Ratio:
    """A quotient of two coprime integer polynomials of one context; the denominator is never zero."""

    num: fmpz_mpoly
    den: fmpz_mpoly

    @staticmethod
    def make(num: fmpz_mpoly, den: fmpz_mpoly) -> Ratio:
        if den.is_zero():
            raise ParameterError("division by zero", expected="a denominator that does not vanish at these values")
        common = num.gcd(den)
        if not common.is_one():
            num, den = num / common, den / common
        if den.leading_coefficient() < 0:
            num, den = -num, -den
        return Ratio(num, den)

    def __add__(self, other: Ratio) -> Ratio:
        if self.den == other.den:
            return Ratio.make(self.num + other.num, self.den)
        return Ratio.make(self.num * other.den + other.num * self.den, self.den * other.den)

    def __sub__(self, other: Ratio) -> Ratio:
        return self + Ratio(-other.num, other.den)

    def __neg__(self) -> Ratio:
        return Ratio(-self.num, self.den)

    def __mul__(self, other: Ratio) -> Ratio:
        return Ratio.make(self.num * other.num, self.den * other.den)

    def __truediv__(self, other: Ratio) -> Ratio:
        return Ratio.make(self.num * other.den, self.den * other.num)

    def is_zero(self) -> bool:
        return bool(self.num.is_zero())


@dataclass(slots=True)
class Generator:
    """An adjoined real number: ``relation(name, earlier names) = 0``, and which root of its norm is meant."""

    name: str
    relation: fmpz_mpoly
    root: Root | None


@dataclass(slots=True)
class Coefficients:
    """The field the analysis of one scheme works in; also the algebra that ``Expr.fold`` evaluates in.

    ``values`` gives every parameter a value, rational or algebraic; those named in ``symbols`` stay variables all the
    same, and their value only says which branch a sign or a square root takes.
    """

    values: Mapping[str, Fraction | Root]
    symbols: tuple[str, ...] = ()
    generators: list[Generator] = field(default_factory=list)
    adjoined: dict[str, Ratio] = field(default_factory=dict)
    inverted: dict[str, fmpz_mpoly] = field(default_factory=dict)
    """What formulas divide by that holds a symbol: where it vanishes the scheme has no value, cancelled or not."""
    context: fmpz_mpoly_ctx = field(init=False)
    gens: dict[str, fmpz_mpoly] = field(init=False)

    def __post_init__(self) -> None:
        names = ["s", "z", "x"]
        names += [f"k{i}" for i in range(KAPPA_VARIABLES)]
        names += [f"q{i}" for i in range(GENERATOR_VARIABLES)]
        # A parameter called z or k0 must not meet the analyser's own variables: it gets a name no formula can spell.
        names += [self.variable(symbol) for symbol in self.symbols]
        self.context = fmpz_mpoly_ctx.get(tuple(names), Ordering.lex)
        self.gens = dict(zip(names, self.context.gens(), strict=True))

    @staticmethod
    def variable(symbol: str) -> str:
        return f"p.{symbol}"

    # The algebra of Expr.fold -----------------------------------------------------------------------------------

    def number(self, value: Fraction) -> Ratio:
        return Ratio(self.context.constant(value.numerator), self.context.constant(value.denominator))

    def symbol(self, name: str) -> Ratio:
        if name in self.symbols:
            return self.of(self.gens[self.variable(name)])
        value = self.values[name]
        if isinstance(value, Fraction):
            return self.number(value)
        if value.rational is not None:
            return self.number(value.rational)
        if name not in self.adjoined:
            self.adjoined[name] = self.adjoin(embed(value.minimal.poly, self.context, "x"), value.minimal)
        return self.adjoined[name]

    def add(self, terms: Sequence[Ratio]) -> Ratio:
        total = self.number(Fraction(0))
        for term in terms:
            total = total + term
        return total

    def mul(self, terms: Sequence[Ratio]) -> Ratio:
        total = self.number(Fraction(1))
        for term in terms:
            total = total * term
        return total

    def power(self, base: Ratio, exponent: int) -> Ratio:
        if exponent >= 0:
            return Ratio(base.num**exponent, base.den**exponent)
        if self._symbolic(base.num):
            self.inverted[str(base.num)] = base.num
        return Ratio.make(base.den ** (-exponent), base.num ** (-exponent))

    def sqrt(self, value: Ratio) -> Ratio:
        """The nonnegative root: rational where it is, otherwise a new generator ``g**2 = num*den`` over ``den``."""
        product = value.num * value.den
        if product.is_constant():
            number = int(product.leading_coefficient()) if not product.is_zero() else 0
            if number < 0:
                raise ParameterError("the square root of a negative number", expected="a nonnegative argument of sqrt")
            root = isqrt(number)
            if root * root == number:
                return Ratio.make(self.context.constant(root), value.den)
        for known in self.generators:
            if known.relation == self.gens[known.name] ** 2 - product:
                return Ratio.make(self.gens[known.name], value.den)
        name = self._next_generator()
        variable = self.gens[name]
        relation = variable**2 - product
        chosen = None if self._symbolic(product) else self._positive_root(relation, name, product)
        self.generators.append(Generator(name, relation, chosen))
        return Ratio.make(variable, value.den)

    # Construction -----------------------------------------------------------------------------------------------

    def of(self, polynomial: fmpz_mpoly) -> Ratio:
        return Ratio(polynomial, self.context.constant(1))

    def evaluate(self, expression: Expr) -> Ratio:
        """A formula in this field: a rational number where its parameters have rational values, else expanded.

        NotAnalysable beyond EXPANSION_DEGREE or EXPANSION_TERMS.
        """
        symbolic = [name for name in expression.symbols if name in self.symbols]
        given = {n: v for n in expression.symbols if n not in symbolic and isinstance(v := self.values[n], Fraction)}
        if len(given) == len(expression.symbols):
            try:
                return self.number(expression.at(given))
            except IrrationalValue:
                pass
        size = expression.size
        if size.degree > EXPANSION_DEGREE or size.terms(len(expression.symbols) - len(given)) > EXPANSION_TERMS:
            raise NotAnalysable(
                f"a formula in {', '.join(sorted(symbolic))} has degree {size.degree} multiplied out",
                expected=f"degree {EXPANSION_DEGREE} and {EXPANSION_TERMS} terms at most",
                mend="lower its powers, or set its parameters with -p",
            )
        return expression.fold(self)

    def adjoin(self, relation_in_x: fmpz_mpoly, root: Root | None) -> Ratio:
        """A new generator with the relation given in the variable ``x``."""
        name = self._next_generator()
        swap = [self.gens[n] for n in self.gens]
        swap[list(self.gens).index("x")] = self.gens[name]
        self.generators.append(Generator(name, relation_in_x.compose(*swap, ctx=self.context), root))
        return self.of(self.gens[name])

    def _next_generator(self) -> str:
        if len(self.generators) == GENERATOR_VARIABLES:
            raise NotAnalysable(f"the scheme holds more than {GENERATOR_VARIABLES} different irrational numbers")
        return f"q{len(self.generators)}"

    def _symbolic(self, polynomial: fmpz_mpoly) -> bool:
        degrees = dict(zip(self.gens, polynomial.degrees(), strict=True))
        free = any(degrees[self.variable(symbol)] > 0 for symbol in self.symbols)
        return free or any(degrees[g.name] > 0 and g.root is None for g in self.generators)

    def _positive_root(self, relation: fmpz_mpoly, name: str, product: fmpz_mpoly) -> Root:
        norm = self.norm(relation)
        candidates = isolated_roots(univariate(norm, name))
        bits = START_BITS
        while True:
            with ctx.workprec(bits + GUARD_BITS):
                square = self.ball(product, bits)
                if square.real < 0:
                    raise ParameterError(
                        "the square root of a negative number", expected="a nonnegative argument of sqrt"
                    )
                target = square.sqrt()
                near = [c for c in candidates if c.ball(bits).overlaps(target)]
            if len(near) == 1:
                return near[0]
            bits *= 2

    # Evaluation -------------------------------------------------------------------------------------------------

    def norm(self, polynomial: fmpz_mpoly) -> fmpz_mpoly:
        """Eliminates every generator, the last adjoined first."""
        for generator in reversed(self.generators):
            degrees = dict(zip(self.gens, polynomial.degrees(), strict=True))
            if degrees[generator.name] > 0:
                polynomial = polynomial.resultant(generator.relation, generator.name)
        return polynomial

    def point(self) -> dict[str, Root]:
        """The generators that have a value, as coordinates for fibres and zero tests."""
        return {g.name: g.root for g in self.generators if g.root is not None}

    def without_free_roots(self, *polynomials: fmpz_mpoly) -> None:
        """NotAnalysable where one holds a square root of symbols left free: that has no value to count at."""
        free = [g for g in self.generators if g.root is None and any(self._holds(p, g.name) for p in polynomials)]
        under = [s for s in self.symbols if any(self._holds(g.relation, self.variable(s)) for g in free)]
        if free:
            roots = f"square root of {' and '.join(under)}" if under else "nested square root of parameters"
            raise NotAnalysable(f"the interior scheme holds a {roots}, left free", mend="set it with -p")

    def _holds(self, polynomial: fmpz_mpoly, variable: str) -> bool:
        return bool(polynomial.degrees()[list(self.gens).index(variable)] > 0)

    def ball(self, polynomial: fmpz_mpoly, bits: int, at: Mapping[str, acb] | None = None) -> acb:
        """Encloses a polynomial at the generators' values and at the further coordinates given."""
        coordinates = dict(at or {})
        for symbol in self.symbols:
            coordinates.setdefault(self.variable(symbol), value_ball(self.values[symbol], bits))
        for generator in self.generators:
            if generator.root is not None:
                coordinates.setdefault(generator.name, generator.root.ball(bits))
            elif generator.name not in coordinates:
                square = self.gens[generator.name] ** 2 - generator.relation
                coordinates[generator.name] = at_balls(square, coordinates).sqrt()
        return at_balls(polynomial, coordinates)

    def is_zero(self, polynomial: fmpz_mpoly) -> bool:
        """Exactly zero at the generators' values, as a polynomial in everything else."""
        if polynomial.is_zero():
            return True
        point = self.point()
        names = list(self.gens)
        groups: dict[tuple[int, ...], dict[tuple[int, ...], fmpz]] = {}
        for exponents, coefficient in polynomial.terms():
            inner = tuple(int(e) if names[i] in point else 0 for i, e in enumerate(exponents))
            outer = tuple(0 if names[i] in point else int(e) for i, e in enumerate(exponents))
            groups.setdefault(outer, {})[inner] = coefficient
        return all(is_zero(point, self.context.from_dict(inner)) for inner in groups.values())

    def sign(self, value: Ratio) -> int:
        """The sign of a real number, or of a function of the symbols at their values; 0 only where it vanishes."""
        if self.is_zero(value.num):
            return 0
        parts = [value.num, value.den, *(generator.relation for generator in self.generators)]
        longest = max(int(abs(c)).bit_length() for part in parts for c in part.coeffs())
        bits = START_BITS
        while bits <= SIGN_BITS + SIGN_LENGTHS * longest:
            with ctx.workprec(bits + GUARD_BITS):
                number = (self.ball(value.num, bits) / self.ball(value.den, bits)).real
            if number > 0 or number < 0:
                return 1 if number > 0 else -1
            bits *= 2
        raise NotAnalysable(f"the sign of a number of the scheme is not decided within {bits // 2} bits")


def common_denominator(ratios: Sequence[Ratio], one: fmpz_mpoly) -> fmpz_mpoly:
    """The least common multiple of the denominators, numeric contents included."""
    total = one
    for ratio in ratios:
        common = total.gcd(ratio.den)
        total = total * (ratio.den / common)
    return total
