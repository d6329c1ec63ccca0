"""The checker's own way from a scheme to its boundary curves.

It goes by projectors of the flux where the prover uses eigenvectors, writes the determinant over all spatial roots by
complete homogeneous polynomials, finds the pairs z_i z_j = 1 by Jury's inner determinant and works in its own ring.
Only the reading of the scheme and the tables of operators and integrators are shared.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, ctx, fmpq, fmpz_mpoly

from gks.bounds.checkformula import Rejected
from gks.bounds.checknumbers import roots_of, univariate
from gks.bounds.checkring import (
    GEN,
    ONE,
    ZERO,
    Fr,
    Unsupported,
    Values,
    constant,
    degree,
    enclose,
    factors,
    put,
)
from gks.bounds.checkspectrum import spectrum
from gks.scheme.integrators import Integrator, integrator
from gks.scheme.model import HalfLine, NamedLines, NamedScheme, Scheme, WrittenDiscrete, WrittenLines
from gks.scheme.operators import discrete_stencil, stencil

COUNT_BITS = 200
"""Precision at which decaying roots are counted at a sample: they stand off the circle there."""


@dataclass(frozen=True, slots=True)
class Scalar:
    """One scalar field of a half-line: where it lives, its direction, and its symbol sum_j c_j x**j on x >= 0."""

    domain: str
    vector: tuple[Fr, ...]
    symbol: Mapping[int, Fr]


@dataclass(frozen=True, slots=True)
class Family:
    """P(sigma, x) without its roots 0, the product of its factors that hold decaying roots, and their number.

    ``counts`` are the irreducible factors, each with its multiplicity and how many of its roots decay.
    """

    whole: fmpz_mpoly
    part: fmpz_mpoly
    decaying: int
    counts: tuple[tuple[fmpz_mpoly, int, int], ...]


@dataclass(frozen=True, slots=True)
class Block:
    """A scalar with its family and the roots 0 that stand for ghosts it never reads."""

    scalar: Scalar
    family: int
    zeros: int


@dataclass(frozen=True, slots=True)
class Problem:
    """sigma is s (with the map pi(z, s) = 0) or z (``time_map`` None)."""

    variable: str
    time_map: fmpz_mpoly | None
    explicit: bool
    """Whether sigma = infinity is z = infinity."""
    families: tuple[Family, ...]
    blocks: tuple[Block, ...]
    rows: tuple[tuple[tuple[int, int, fmpz_mpoly], ...], ...]
    """Equations: block, grid point n, coefficient."""
    growth: tuple[fmpz_mpoly, ...]
    """The interior's amplification polynomials F(z, x)."""
    structure: tuple[fmpz_mpoly, ...]
    """Divisors and wave speeds: polynomials in p and lam whose zeros the description does not cross."""
    speeds: tuple[tuple[Fr, bool], ...]
    """Wave speeds that stencils go by, with whether they are taken to be positive."""

    def holds_at(self, p: Fraction, lam: Fraction) -> bool:
        """Whether the signs of speeds and the numbers of decaying roots are those of the sample there too."""
        sample = {"p": p, "lam": lam}
        return all(_forward(speed, sample) is forward for speed, forward in self.speeds) and all(
            _inside(factor, self.variable, sample) == mine
            for family in self.families
            for factor, _, mine in family.counts
        )


# From the scheme to scalar problems ---------------------------------------------------------------------------------


def derive(
    scheme: Scheme,
    fixed: Mapping[str, Fraction],
    parameter: str | None,
    p: Fraction,
    lam: Fraction,
    *,
    counted: bool = True,
) -> Problem:
    """The problem with p and lam symbolic; (p, lam) is a sample that settles signs and counts.

    Not ``counted``, no root is said to decay: enough for the interior, and all there is where it is not stable.
    """
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
    clocks = {
        name: Fr(GEN["s"], ONE) if lines or time is None else _clock(integrator(time)) for name, time in times.items()
    }
    sample = {"p": p, "lam": lam}
    speeds: list[Fr] = []
    scalars = [each for h in scheme.domains for each in _scalars(h, values, clocks[h.name], sample, speeds)]
    lowest = {h.name: _lowest(scheme, h) for h in scheme.domains}
    families: list[Family] = []
    blocks = [_block(scheme, each, lowest, families, variable, sample if counted else None) for each in scalars]
    rows = _rows(scheme, values, clocks, blocks, lowest, lines)
    width = sum(b.zeros + families[b.family].decaying for b in blocks)
    if counted and width != len(rows):
        raise Rejected(f"{width} decaying solutions against {len(rows)} equations")
    time_map = None if method is None else _map(method)
    growth = {str(g): g for each in scalars for g in [_growth(each, time_map)]}
    structure = [*values.divisors, *(part for speed in speeds for part in (speed.num, speed.den))]
    explicit = method is None or method.explicit
    return Problem(
        variable,
        time_map,
        explicit,
        tuple(families),
        tuple(blocks),
        tuple(rows),
        tuple(growth.values()),
        tuple(structure),
        tuple((speed, _forward(speed, sample)) for speed in speeds),
    )


def _clock(method: Integrator) -> Fr:
    """dt of a multistep method: rho(z)/(lam sigma(z))."""
    if method.kind != "multistep":
        raise Unsupported("a Runge-Kutta method beside another clock")
    z = Fr(GEN["z"], ONE)
    rho, sigma = (
        sum((constant(c) * z**k for k, c in enumerate(each)), constant(0)) for each in (method.rho, method.sigma)
    )
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
    return min(
        half_line.first,
        *(_mirrored(half_line, v.index) for v in scheme.boundary_unknowns if v.domain == half_line.name),
        half_line.first,
    )


def _scalars(
    half_line: HalfLine, values: Values, clock: Fr, sample: Mapping[str, Fraction], speeds: list[Fr]
) -> Iterator[Scalar]:
    interior = half_line.interior
    if isinstance(interior, WrittenDiscrete | WrittenLines):
        yield from _written(half_line, interior, values, clock)
        return
    assert half_line.flux is not None
    flux = [[entry.fold(values) for entry in row] for row in half_line.flux]
    for speed, columns in spectrum(flux):
        speeds.append(speed)
        forward = _forward(speed, sample)
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


def _forward(speed: Fr, sample: Mapping[str, Fraction]) -> bool:
    return bool((enclose(speed.num, _point(sample)) / enclose(speed.den, _point(sample))).real >= 0)


def _point(sample: Mapping[str, Fraction]) -> dict[str, acb]:
    return {name: acb(fmpq(v.numerator, v.denominator)) for name, v in sample.items()}


def _written(
    half_line: HalfLine, interior: WrittenDiscrete | WrittenLines, values: Values, clock: Fr
) -> Iterator[Scalar]:
    size = len(half_line.unknowns)
    for form in interior.equations:
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
    scheme: Scheme,
    scalar: Scalar,
    lowest: Mapping[str, int],
    families: list[Family],
    variable: str,
    sample: Mapping[str, Fraction] | None,
) -> Block:
    half_line = scheme.half_line(scalar.domain)
    ghosts = half_line.first - lowest[scalar.domain] + min(scalar.symbol)
    if ghosts < 0:
        raise Unsupported("an interior whose lowest offset lies inside the domain")
    polynomial = _polynomial(scalar.symbol)
    kept, whole = ONE, ONE
    counts = []
    for factor, multiplicity in factors(polynomial):
        if not degree(factor, "x"):
            continue
        whole *= factor**multiplicity
        mine = 0 if sample is None else _inside(factor, variable, sample)
        counts.append((factor, multiplicity, mine))
        if mine:
            kept *= factor**multiplicity
    decaying = sum(multiplicity * mine for _, multiplicity, mine in counts)
    for k, family in enumerate(families):
        if family.whole == whole:
            return Block(scalar, k, ghosts)
    families.append(Family(whole, kept, decaying, tuple(counts)))
    return Block(scalar, len(families) - 1, ghosts)


def _inside(factor: fmpz_mpoly, variable: str, sample: Mapping[str, Fraction]) -> int:
    outside = Fraction(3) if variable == "z" else Fraction(1, 2) / sample["lam"]
    for name, value in {**sample, variable: outside}.items():
        factor = put(factor, name, value)
    with ctx.workprec(COUNT_BITS):
        roots = [(root, m) for g, m in univariate(factor, "x").factor()[1] for root in roots_of(g)]
        if any(abs(root).contains(1) for root, _ in roots):
            raise Unsupported("a spatial root on the circle at the sample")
        return sum(m for root, m in roots if abs(root) < 1)


Row = tuple[tuple[int, int, fmpz_mpoly], ...]


def _rows(
    scheme: Scheme,
    values: Values,
    clocks: Mapping[str, Fr],
    blocks: Sequence[Block],
    lowest: Mapping[str, int],
    lines: bool,
) -> list[Row]:
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
    return rows + list(_pins(scheme, blocks, lowest))


def _pins(scheme: Scheme, blocks: Sequence[Block], lowest: Mapping[str, int]) -> Iterator[Row]:
    """Grid points that nothing reads, and only the common indexing of the unknowns brings in, are set to 0."""
    known = {(v.domain, v.unknown, v.index) for v in scheme.boundary_unknowns}
    for half_line in scheme.domains:
        own = {k: b.scalar.vector for k, b in enumerate(blocks) if b.scalar.domain == half_line.name}
        for place in range(lowest[half_line.name], half_line.first):
            for component, unknown in enumerate(half_line.unknowns):
                if (half_line.name, unknown, _mirrored(half_line, place)) not in known:
                    n = place - lowest[half_line.name]
                    yield _cleared({(k, n): vector[component] for k, vector in own.items()})


def _cleared(row: Mapping[tuple[int, int], Fr]) -> tuple[tuple[int, int, fmpz_mpoly], ...]:
    clear = ONE
    for value in row.values():
        clear = clear * (value.den / clear.gcd(value.den))
    return tuple((k, n, v.num * (clear / v.den)) for (k, n), v in sorted(row.items(), key=lambda e: e[0]) if not v.zero)
