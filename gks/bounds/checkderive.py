"""The checker's own way from a scheme to its boundary curves.

It goes by projectors of the flux where the prover uses eigenvectors, writes the determinant over all spatial roots by
complete homogeneous polynomials, finds the pairs z_i z_j = 1 by Jury's inner determinant and works in its own ring. Only
the reading of the scheme and the tables of operators and integrators are shared.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import isqrt, prod

from flint import Ordering, acb, acb_poly, ctx, fmpq, fmpz_mpoly, fmpz_mpoly_ctx

from gks.bounds.checkformula import Rejected
from gks.scheme.integrators import Integrator, integrator
from gks.scheme.model import HalfLine, NamedLines, NamedScheme, Scheme, WrittenDiscrete, WrittenLines
from gks.scheme.operators import discrete_stencil, stencil

MOST_ROOTS = 6
RING = fmpz_mpoly_ctx.get(("p", "lam", "s", "z", "x", *(f"k{i}" for i in range(MOST_ROOTS))), Ordering.lex)
GEN = dict(zip(RING.names(), RING.gens(), strict=True))
ONE, ZERO = RING.constant(1), RING.constant(0)

COUNT_BITS = 200
"""Precision at which decaying roots are counted at a sample: they stand off the circle there."""


class Unsupported(Exception):
    """A scheme beyond this checker."""


@dataclass(frozen=True, slots=True)
class Fr:
    """A rational function; the denominator is not zero."""

    num: fmpz_mpoly
    den: fmpz_mpoly

    @staticmethod
    def of(num: fmpz_mpoly, den: fmpz_mpoly = ONE) -> Fr:
        if den.is_zero():
            raise Unsupported("a formula divides by zero")
        common = num.gcd(den)
        return Fr(num / common, den / common)

    def __add__(self, other: Fr) -> Fr:
        return Fr.of(self.num * other.den + other.num * self.den, self.den * other.den)

    def __sub__(self, other: Fr) -> Fr:
        return self + Fr(-other.num, other.den)

    def __mul__(self, other: Fr) -> Fr:
        return Fr.of(self.num * other.num, self.den * other.den)

    def __truediv__(self, other: Fr) -> Fr:
        return Fr.of(self.num * other.den, self.den * other.num)

    def __pow__(self, exponent: int) -> Fr:
        return Fr(self.num**exponent, self.den**exponent) if exponent >= 0 else Fr.of(self.den**-exponent, self.num**-exponent)

    @property
    def zero(self) -> bool:
        return bool(self.num.is_zero())


def constant(value: Fraction | int) -> Fr:
    exact = Fraction(value)
    return Fr(RING.constant(exact.numerator), RING.constant(exact.denominator))


class Values:
    """The algebra of the scheme's formulas: p and lam stay symbols; divisors are recorded."""

    def __init__(self, names: Mapping[str, Fr]) -> None:
        self.names = names
        self.divisors: list[fmpz_mpoly] = []

    def number(self, value: Fraction) -> Fr:
        return constant(value)

    def symbol(self, name: str) -> Fr:
        return self.names[name]

    def add(self, terms: Sequence[Fr]) -> Fr:
        return sum(terms, constant(0))

    def mul(self, factors: Sequence[Fr]) -> Fr:
        return prod(factors, start=constant(1))

    def power(self, base: Fr, exponent: int) -> Fr:
        if exponent < 0:
            self.divisors.append(base.num)
        return base**exponent

    def sqrt(self, radicand: Fr) -> Fr:
        parts = [radicand.num, radicand.den]
        if all(part.is_constant() for part in parts):
            numbers = [int(part.leading_coefficient()) if not part.is_zero() else 0 for part in parts]
            if all(isqrt(abs(n)) ** 2 == n for n in numbers):
                return constant(Fraction(isqrt(numbers[0]), isqrt(numbers[1])))
        raise Unsupported("irrational numbers")


@dataclass(frozen=True, slots=True)
class Scalar:
    """One scalar field of a half-line: where it lives, its direction, and its symbol sum_j c_j x**j on x >= 0."""

    domain: str
    vector: tuple[Fr, ...]
    symbol: Mapping[int, Fr]


@dataclass(frozen=True, slots=True)
class Family:
    """P(sigma, x) without its roots 0, the product of its factors that hold decaying roots, and their number."""

    whole: fmpz_mpoly
    part: fmpz_mpoly
    decaying: int


@dataclass(frozen=True, slots=True)
class Block:
    scalar: Scalar
    family: int
    zeros: int


@dataclass(frozen=True, slots=True)
class Problem:
    """sigma is s (with the map pi(z, s) = 0) or z (``time_map`` None)."""

    variable: str
    time_map: fmpz_mpoly | None
    families: tuple[Family, ...]
    blocks: tuple[Block, ...]
    rows: tuple[tuple[tuple[int, int, fmpz_mpoly], ...], ...]
    """Equations: block, grid point n, coefficient."""
    growth: tuple[fmpz_mpoly, ...]
    """The interior's amplification polynomials F(z, x)."""
    structure: tuple[fmpz_mpoly, ...]
    """Divisors and wave speeds: polynomials in p and lam whose zeros the description does not cross."""


def degree(polynomial: fmpz_mpoly, name: str) -> int:
    return max(0, int(polynomial.degrees()[RING.variable_to_index(name)]))


def parts_of(polynomial: fmpz_mpoly, name: str) -> list[fmpz_mpoly]:
    """Coefficients of name**0, name**1, ..."""
    k = RING.variable_to_index(name)
    parts: list[dict[tuple[int, ...], int]] = [{} for _ in range(degree(polynomial, name) + 1)]
    for powers, c in polynomial.to_dict().items():
        parts[int(powers[k])][(*powers[:k], 0, *powers[k + 1 :])] = int(c)
    return [RING.from_dict(part) for part in parts]


def put(polynomial: fmpz_mpoly, name: str, value: Fraction) -> fmpz_mpoly:
    """A rational put in for one variable, denominators cleared."""
    parts = parts_of(polynomial, name)
    top = len(parts) - 1
    return sum((c * (value.numerator**k * value.denominator ** (top - k)) for k, c in enumerate(parts)), ZERO)


def mirror(polynomial: fmpz_mpoly, *names: str) -> fmpz_mpoly:
    """Each named variable replaced by its inverse, cleared."""
    for name in names:
        parts = parts_of(polynomial, name)
        polynomial = sum((c * GEN[name] ** (len(parts) - 1 - k) for k, c in enumerate(parts)), ZERO)
    return polynomial


def factors(polynomial: fmpz_mpoly) -> list[tuple[fmpz_mpoly, int]]:
    """Irreducible factors, leading coefficient positive."""
    if polynomial.is_zero():
        return []
    return [(-f if f.leading_coefficient() < 0 else f, int(m)) for f, m in polynomial.factor()[1]]


def enclose(polynomial: fmpz_mpoly, at: Mapping[str, acb]) -> acb:
    total = acb(0)
    names = RING.names()
    for powers, c in polynomial.to_dict().items():
        term = acb(int(c))
        for name, power in zip(names, powers, strict=True):
            if power:
                term *= at[name] ** int(power)
        total += term
    return total


# From the scheme to scalar problems -------------------------------------------------------------------------------------


def derive(scheme: Scheme, fixed: Mapping[str, Fraction], parameter: str | None, p: Fraction, lam: Fraction) -> Problem:
    """The problem with p and lam symbolic; (p, lam) is a sample that settles signs and counts."""
    names = {name: constant(value) for name, value in fixed.items()}
    names[scheme.cfl] = Fr(GEN["lam"], ONE)
    if parameter is not None:
        names[parameter] = Fr(GEN["p"], ONE)
    values = Values(names)
    times = {h.name: h.time for h in scheme.domains}
    if "exact" in times.values():
        raise Unsupported("exact time")
    levels = [{v.level for v, _ in e.form.terms} for e in scheme.closure.equations]
    lines = len(set(times.values())) == 1 and None not in times.values() and all(len(each) <= 1 for each in levels)
    method = integrator(next(t for t in times.values() if t is not None)) if lines else None
    variable = "s" if lines else "z"
    clocks = {name: Fr(GEN["s"], ONE) if lines or time is None else _clock(integrator(time)) for name, time in times.items()}
    sample = {"p": p, "lam": lam}
    speeds: list[Fr] = []
    scalars = [each for h in scheme.domains for each in _scalars(h, values, clocks[h.name], sample, speeds)]
    lowest = {h.name: _lowest(scheme, h) for h in scheme.domains}
    families: list[Family] = []
    blocks = [_block(scheme, each, lowest, families, variable, sample) for each in scalars]
    rows = _rows(scheme, values, clocks, blocks, lowest, lines)
    width = sum(b.zeros + families[b.family].decaying for b in blocks)
    if width != len(rows):
        raise Rejected(f"{width} decaying solutions against {len(rows)} equations")
    time_map = None if method is None else _map(method)
    growth = {str(g): g for each in scalars for g in [_growth(each, time_map)]}
    structure = [*values.divisors, *(part for speed in speeds for part in (speed.num, speed.den))]
    return Problem(variable, time_map, tuple(families), tuple(blocks), tuple(rows), tuple(growth.values()), tuple(structure))


def _clock(method: Integrator) -> Fr:
    """dt of a multistep method: rho(z)/(lam sigma(z))."""
    if method.kind != "multistep":
        raise Unsupported("a Runge-Kutta method beside another clock")
    z = Fr(GEN["z"], ONE)
    rho, sigma = (sum((constant(c) * z**k for k, c in enumerate(each)), constant(0)) for each in (method.rho, method.sigma))
    return rho / (Fr(GEN["lam"], ONE) * sigma)


def _map(method: Integrator) -> fmpz_mpoly:
    mu = Fr(GEN["lam"] * GEN["s"], ONE)
    total = constant(0)
    for k, in_mu in enumerate(method.characteristic()):
        for power, c in enumerate(in_mu):
            total = total + constant(c) * mu**power * Fr(GEN["z"], ONE) ** k
    return total.num


def _mirrored(half_line: HalfLine, index: int) -> int:
    return index if half_line.side == "right" else -index


def _lowest(scheme: Scheme, half_line: HalfLine) -> int:
    return min(half_line.first, *(_mirrored(half_line, v.index) for v in scheme.boundary_unknowns if v.domain == half_line.name), half_line.first)


def _scalars(
    half_line: HalfLine, values: Values, clock: Fr, sample: Mapping[str, Fraction], speeds: list[Fr]
) -> Iterator[Scalar]:
    interior = half_line.interior
    if isinstance(interior, WrittenDiscrete | WrittenLines):
        yield from _written(half_line, interior, values, clock)
        return
    assert half_line.flux is not None
    flux = [[entry.fold(values) for entry in row] for row in half_line.flux]
    for speed, columns in _spectrum(flux):
        speeds.append(speed)
        ball = enclose(speed.num, _point(sample)) / enclose(speed.den, _point(sample))
        forward = bool(ball.real >= 0)
        symbol: dict[int, Fr] = {}
        if isinstance(interior, NamedLines):
            operator = stencil(interior.space, forward)
            for j in {*operator.mass, *operator.derivative}:
                symbol[j] = clock * constant(operator.mass.get(j, 0)) + speed * constant(operator.derivative.get(j, 0))
        else:
            assert isinstance(interior, NamedScheme)
            nu = Fr(GEN["lam"], ONE) * speed
            symbol[0] = Fr(GEN["z"], ONE)
            for j, powers in discrete_stencil(interior.scheme, forward).coefficients.items():
                value = sum((constant(c) * nu**k for k, c in enumerate(powers)), constant(0))
                symbol[j] = symbol.get(j, constant(0)) - value
        placed = {_mirrored(half_line, j): c for j, c in symbol.items() if not c.zero}
        for column in columns:
            yield Scalar(half_line.name, column, placed)


def _point(sample: Mapping[str, Fraction]) -> dict[str, acb]:
    return {name: acb(fmpq(v.numerator, v.denominator)) for name, v in sample.items()}


def _spectrum(flux: list[list[Fr]]) -> list[tuple[Fr, list[tuple[Fr, ...]]]]:
    """Eigenvalues with independent columns of their projectors prod (A - w')/(w - w')."""
    size = len(flux)
    characteristic = _determinant([[(_diagonal(i, j) - flux[i][j]) for j in range(size)] for i in range(size)])
    values = []
    for factor, multiplicity in factors(characteristic.num):
        parts = parts_of(factor, "x")
        if len(parts) == 2:
            values.append((Fr.of(-parts[0], parts[1]), multiplicity))
        elif len(parts) > 2:
            raise Unsupported("wave speeds that are no rational functions")
    found = []
    for value, multiplicity in values:
        projector = [[constant(int(i == j)) for j in range(size)] for i in range(size)]
        for other, _ in values:
            if other != value:
                shifted = [[flux[i][j] - (other if i == j else constant(0)) for j in range(size)] for i in range(size)]
                projector = [
                    [sum((projector[i][k] * shifted[k][j] for k in range(size)), constant(0)) / (value - other) for j in range(size)]
                    for i in range(size)
                ]
        columns = _independent([tuple(projector[i][j] for i in range(size)) for j in range(size)])
        if len(columns) != multiplicity:
            raise Unsupported("a flux without a full set of eigenvectors")
        found.append((value, columns))
    return found


def _diagonal(i: int, j: int) -> Fr:
    return Fr(GEN["x"], ONE) if i == j else constant(0)


def _independent(columns: list[tuple[Fr, ...]]) -> list[tuple[Fr, ...]]:
    chosen: list[tuple[Fr, ...]] = []
    reduced: list[tuple[Fr, ...]] = []
    for column in columns:
        rest = column
        for basis in reduced:
            lead = next(k for k, v in enumerate(basis) if not v.zero)
            factor = rest[lead] / basis[lead]
            rest = tuple(a - factor * b for a, b in zip(rest, basis, strict=True))
        if any(not v.zero for v in rest):
            chosen.append(column)
            reduced.append(rest)
    return chosen


def _written(half_line: HalfLine, interior: WrittenDiscrete | WrittenLines, values: Values, clock: Fr) -> Iterator[Scalar]:
    size = len(half_line.unknowns)
    for row, form in enumerate(interior.equations):
        unknowns = {v.unknown for v, _ in form.terms}
        if len(unknowns) != 1:
            raise Unsupported("a written interior that couples its unknowns")
        place = half_line.unknowns.index(unknowns.pop())
        lowest = min(v.level for v, _ in form.terms)
        symbol: dict[int, Fr] = {}
        for value, coefficient in form.terms:
            weight = coefficient.fold(values)
            weight = weight * (clock if value.derivative else Fr(GEN["z"], ONE) ** (value.level - lowest))
            j = _mirrored(half_line, value.index)
            symbol[j] = symbol.get(j, constant(0)) + weight
        del row
        vector = tuple(constant(int(k == place)) for k in range(size))
        yield Scalar(half_line.name, vector, {j: c for j, c in symbol.items() if not c.zero})


def _polynomial(symbol: Mapping[int, Fr]) -> fmpz_mpoly:
    """sum_j c_j x**(j - min), denominators cleared."""
    clear = ONE
    for value in symbol.values():
        clear = clear * (value.den / clear.gcd(value.den))
    low = min(symbol)
    return sum((c.num * (clear / c.den) * GEN["x"] ** (j - low) for j, c in symbol.items()), ZERO)


def _growth(scalar: Scalar, time_map: fmpz_mpoly | None) -> fmpz_mpoly:
    polynomial = _polynomial(scalar.symbol)
    return polynomial if time_map is None else polynomial.resultant(time_map, "s")


def _block(
    scheme: Scheme, scalar: Scalar, lowest: Mapping[str, int], families: list[Family], variable: str, sample: Mapping[str, Fraction]
) -> Block:
    half_line = scheme.half_line(scalar.domain)
    ghosts = half_line.first - lowest[scalar.domain] + min(scalar.symbol)
    if ghosts < 0:
        raise Unsupported("an interior whose lowest offset lies inside the domain")
    polynomial = _polynomial(scalar.symbol)
    kept, whole = ONE, ONE
    decaying = 0
    for factor, multiplicity in factors(polynomial):
        if not degree(factor, "x"):
            continue
        whole *= factor**multiplicity
        mine = multiplicity * _inside(factor, variable, sample)
        if mine:
            decaying += mine
            kept *= factor**multiplicity
    for k, family in enumerate(families):
        if family.whole == whole:
            return Block(scalar, k, ghosts)
    families.append(Family(whole, kept, decaying))
    return Block(scalar, len(families) - 1, ghosts)


def _inside(factor: fmpz_mpoly, variable: str, sample: Mapping[str, Fraction]) -> int:
    outside = Fraction(3) if variable == "z" else Fraction(1, 2) / sample["lam"]
    for name, value in {**sample, variable: outside}.items():
        factor = put(factor, name, value)
    with ctx.workprec(COUNT_BITS):
        roots = acb_poly([enclose(c, {}) for c in parts_of(factor, "x")]).roots()
        if any(abs(root).contains(1) for root in roots):
            raise Unsupported("a spatial root on the circle at the sample")
        return sum(1 for root in roots if abs(root) < 1)


def _rows(
    scheme: Scheme, values: Values, clocks: Mapping[str, Fr], blocks: Sequence[Block], lowest: Mapping[str, int], lines: bool
) -> list[tuple[tuple[int, int, fmpz_mpoly], ...]]:
    rows = []
    for equation in scheme.closure.equations:
        base = min(v.level for v, _ in equation.form.terms)
        row: dict[tuple[int, int], Fr] = {}
        for value, coefficient in equation.form.terms:
            half_line = scheme.half_line(value.domain)
            weight = coefficient.fold(values)
            if not lines:
                weight = weight * Fr(GEN["z"], ONE) ** (value.level - base)
            if value.derivative:
                weight = weight * clocks[value.domain]
            component = half_line.unknowns.index(value.unknown)
            n = _mirrored(half_line, value.index) - lowest[value.domain]
            for k, block in enumerate(blocks):
                if block.scalar.domain == value.domain:
                    row[k, n] = row.get((k, n), constant(0)) + weight * block.scalar.vector[component]
        rows.append(_cleared(row))
    known = {(v.domain, v.unknown, v.index) for v in scheme.boundary_unknowns}
    for half_line in scheme.domains:
        for place in range(lowest[half_line.name], half_line.first):
            for component, unknown in enumerate(half_line.unknowns):
                if (half_line.name, unknown, _mirrored(half_line, place)) not in known:
                    n = place - lowest[half_line.name]
                    rows.append(_cleared({(k, n): b.scalar.vector[component] for k, b in enumerate(blocks) if b.scalar.domain == half_line.name}))
    return rows


def _cleared(row: Mapping[tuple[int, int], Fr]) -> tuple[tuple[int, int, fmpz_mpoly], ...]:
    clear = ONE
    for value in row.values():
        clear = clear * (value.den / clear.gcd(value.den))
    return tuple((k, n, v.num * (clear / v.den)) for (k, n), v in sorted(row.items(), key=lambda e: e[0]) if not v.zero)


def _determinant(matrix: list[list[Fr]]) -> Fr:
    if not matrix:
        return constant(1)
    total = constant(0)
    for j, entry in enumerate(matrix[0]):
        if not entry.zero:
            minor = _determinant([[v for k, v in enumerate(row) if k != j] for row in matrix[1:]])
            total = total + entry * minor * constant((-1) ** j)
    return total


# Elimination ------------------------------------------------------------------------------------------------------------


def bases(roots: Sequence[fmpz_mpoly | acb], count: int, zero: object, one: object) -> list[list[object]]:
    """Column j: complete homogeneous polynomials h_(n-j) of the first j + 1 roots, n < count."""
    columns = []
    for j in range(len(roots)):
        # h_m(k_1..k_(j+1)) = sum_i k_(j+1)**i h_(m-i)(k_1..k_j), by its generating function.
        series: list[object] = [one] + [zero] * count
        for root in roots[: j + 1]:
            for m in range(1, count + 1):
                series[m] = series[m] + root * series[m - 1]  # type: ignore[operator]
        columns.append([zero] * j + series[: max(count - j, 0)])
    return [column[:count] for column in columns]


def kreiss(problem: Problem, roots: Sequence[Sequence[object]], coefficient: object, zero: object, one: object) -> list[list[object]]:
    """The closure applied to every column; ``roots`` of each block, zeros included."""
    reach = [1 + max((n for row in problem.rows for k, n, _ in row if k == b), default=0) for b in range(len(problem.blocks))]
    columns = [bases(mine, reach[b], zero, one) for b, mine in enumerate(roots)]  # type: ignore[arg-type]
    matrix = []
    for row in problem.rows:
        line = []
        for b, block in enumerate(columns):
            for column in block:
                total = zero
                for k, n, c in row:
                    if k == b:
                        total = total + coefficient(c) * column[n]  # type: ignore[operator]
                line.append(total)
        matrix.append(line)
    return matrix


def characteristic(problem: Problem) -> tuple[list[fmpz_mpoly], list[fmpz_mpoly]]:
    """Irreducible factors of the norm of Delta: those with sigma, and those in p and lam alone."""
    carried: list[list[str]] = []
    used = 0
    for family in problem.families:
        carried.append([f"k{used + j}" for j in range(family.decaying)])
        used += family.decaying
        if used > MOST_ROOTS:
            raise Unsupported("too many spatial roots to eliminate")
    roots = [[ZERO] * b.zeros + [GEN[name] for name in carried[b.family]] for b in problem.blocks]
    matrix = kreiss(problem, roots, lambda c: c, ZERO, ONE)
    norm = _determinant([[Fr(entry, ONE) for entry in row] for row in matrix]).num  # type: ignore[arg-type]
    for names, family in zip(carried, problem.families, strict=True):
        relations = []
        rest = family.part
        for name in names:
            relations.append(_compose(rest, name))
            rest = _divided(rest, name)
        for name, relation in reversed(list(zip(names, relations, strict=True))):
            common = norm.gcd(relation)
            while degree(common, name):
                norm = norm / common
                common = norm.gcd(relation)
            norm = norm.resultant(relation, name)
            if norm.is_zero():
                raise Rejected("the determinant of the closure vanishes identically")
    found = [f for f, _ in factors(norm)]
    return [f for f in found if degree(f, problem.variable)], [f for f in found if not degree(f, problem.variable)]


def _compose(polynomial: fmpz_mpoly, name: str) -> fmpz_mpoly:
    return sum((c * GEN[name] ** k for k, c in enumerate(parts_of(polynomial, "x"))), ZERO)


def _divided(polynomial: fmpz_mpoly, name: str) -> fmpz_mpoly:
    """(f(x) - f(k))/(x - k)."""
    total = ZERO
    for k, c in enumerate(parts_of(polynomial, "x")):
        total += c * sum((GEN["x"] ** i * GEN[name] ** (k - 1 - i) for i in range(k)), ZERO)
    return total


# Curves ---------------------------------------------------------------------------------------------------------------


def curves(problem: Problem) -> dict[str, fmpz_mpoly]:
    """Irreducible polynomials in p and lam off whose zeros the verdict cannot change, but for constants and lam."""
    found: dict[str, fmpz_mpoly] = {}
    for polynomial in _all_curves(problem):
        for factor, _ in factors(polynomial):
            if not factor.is_constant() and factor != GEN["lam"]:
                found.setdefault(str(factor), factor)
    return found


def in_z(problem: Problem, own: Sequence[fmpz_mpoly]) -> list[fmpz_mpoly]:
    if problem.time_map is None:
        return list(own)
    return [g for f in own for g, _ in factors(f.resultant(problem.time_map, "s"))]


def _all_curves(problem: Problem) -> Iterator[fmpz_mpoly]:
    yield from problem.structure
    own, idle = characteristic(problem)
    yield from idle
    growing = in_z(problem, own)
    loci = list(_loci(problem))
    for f in growing:
        yield parts_of(f, "z")[-1]
        if not degree(f, "z"):
            continue
        yield from (put(f, "z", Fraction(end)) for end in (1, -1))
        if mirror(f, "z") in (f, -f):
            if degree(f, "z") > 1:
                yield f.discriminant("z")
        else:
            yield inner(f)
        yield from (f.resultant(locus, "z") for locus in loci if locus != f)
    for growth in problem.growth:
        yield from _interior(growth)


def inner(f: fmpz_mpoly) -> fmpz_mpoly:
    """Jury's inner determinant: up to powers of the leading coefficient the product of 1 - z_i z_j over pairs."""
    a = parts_of(f, "z")
    size = len(a) - 2
    matrix = [
        [
            Fr((a[-1 - (j - i)] if j >= i else ZERO) - (a[i + j - size + 1] if i + j >= size - 1 else ZERO), ONE)
            for j in range(size)
        ]
        for i in range(size)
    ]
    return _determinant(matrix).num


def _loci(problem: Problem) -> Iterator[fmpz_mpoly]:
    """z over an open set of (p, lam) with a unimodular x, other than 1 and -1."""
    for growth in problem.growth:
        split = [f for f, _ in factors(growth) if degree(f, "x") and degree(f, "z")]
        neutral = [f for f in split if mirror(f, "z", "x") in (f, -f)]
        found = [f.discriminant("x") for f in neutral if degree(f, "x") > 1]
        for f in split:
            if f in neutral:
                continue
            cut = f.resultant(mirror(f, "z", "x"), "z")
            for spot, order in factors(cut):
                if degree(spot, "x") and mirror(spot, "x") in (spot, -spot) and (order > 1 or spot.total_degree() == 1):
                    found.append(f.resultant(spot, "x"))
        for locus in found:
            for g, _ in factors(locus):
                if degree(g, "z") and g.total_degree() > 1 and mirror(g, "z") in (g, -g):
                    yield g


def _interior(growth: fmpz_mpoly) -> Iterator[fmpz_mpoly]:
    split = [f for f, _ in factors(growth)]
    cuts: dict[str, fmpz_mpoly] = {}
    doubles: dict[str, fmpz_mpoly] = {}
    moving = [f for f in split if degree(f, "z")]
    neutral: list[fmpz_mpoly] = []
    for f in split:
        if not degree(f, "z") and not degree(f, "x"):
            yield f
        loci = [parts_of(f, "z")[-1]]
        if degree(f, "z"):
            turned = mirror(f, "z", "x")
            if turned in (f, -f):
                loci += [f.discriminant("z")] if degree(f, "z") > 1 else []
                loci += [f.resultant(other, "z") for other in neutral]
                neutral.append(f)
            else:
                loci.append(f.resultant(turned, "z"))
        cuts |= {str(g): g for locus in loci for g, _ in factors(locus)}
    for f in moving:
        if degree(f, "z") > 1:
            doubles |= {str(g): g for g, _ in factors(f.discriminant("z"))}
    for one, other in combinations(moving, 2):
        doubles |= {str(g): g for g, _ in factors(one.resultant(other, "z"))}
    circle = [c for c in cuts.values() if degree(c, "x")]
    yield from (c for c in cuts.values() if not degree(c, "x"))
    for c in [*circle, *doubles.values()]:
        yield from (put(c, "x", Fraction(end)) for end in (1, -1))
    round_ones = [c for c in circle if degree(c, "x") % 2 == 0 and mirror(c, "x") == c]
    for c in round_ones:
        yield c.discriminant("x")
    for one, other in combinations(round_ones, 2):
        yield one.resultant(other, "x")
