"""Where a claimed bound is looked at: exact parameter values that spread over the ranges the claim is made for.

A claim speaks of every value of a parameter that it leaves open: of each parameter that has a range, and of each that
its formula names, unless its `at` sets it. Others are at their defaults.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations, pairwise

from gks.bounds.claimvalue import difference
from gks.errors import InputError
from gks.modes.unimodular import simplest_between
from gks.scheme.expression import Expr
from gks.scheme.model import Claim, Parameter, Scheme
from gks.scheme.numbers import fraction_text

SPREAD = 16
"""Values of each open parameter, whatever its range."""

UNBOUNDED_DECADES = 6
"""How far from the default values go towards an end that is 0 or infinite."""

BISECTIONS = 12
"""How closely the point is looked at where a formula goes from one of its pieces to another: 2**-12 of a gap."""

Values = Mapping[str, Fraction]


def open_parameters(scheme: Scheme, claim: Claim) -> list[Parameter]:
    """The parameters that a claimed bound leaves open."""
    named = claim.bound.symbols if claim.bound is not None else frozenset()
    return [
        parameter
        for parameter in scheme.parameters
        if parameter.role != "cfl" and parameter.name not in claim.at and (parameter.ranged or parameter.name in named)
    ]


def samples(scheme: Scheme, claim: Claim) -> list[dict[str, Fraction]]:
    """All parameters' values (the CFL number's own default among them) at which a claimed bound is held.

    One set where nothing is open; several open parameters run together, each through its own values in another order.
    """
    free = open_parameters(scheme, claim)
    fixed = scheme.values(dict(claim.at), [p.name for p in free])
    if not free:
        return [fixed]
    spreads = {parameter.name: _spread(parameter) for parameter in free}
    sets = []
    for k in range(SPREAD):
        # Odd strides are coprime to the number of values, a power of two: each parameter meets each of its values once.
        chosen = {name: spread[k * (2 * j + 1) % SPREAD] for j, (name, spread) in enumerate(spreads.items())}
        sets.append({**fixed, **chosen})
    defaults = {p.name: p.default for p in free if p.default is not None and inside(p, p.default)}
    if len(defaults) == len(free):
        sets.append({**fixed, **defaults})
    if len(free) == 1:
        (name,) = spreads
        sets.sort(key=lambda values: values[name])
        sets = sorted([*sets, *_switches(claim.bound, sets, name)], key=lambda values: values[name])
    return [dict(each) for each in dict.fromkeys(tuple(each.items()) for each in sets)]


def inside(parameter: Parameter, value: Fraction) -> bool:
    """Whether a value lies in a parameter's open range."""
    return (parameter.low is None or parameter.low < value) and (parameter.high is None or value < parameter.high)


def interval_text(parameter: Parameter) -> str:
    """The open range as text, (0, oo)."""
    low = "-oo" if parameter.low is None else fraction_text(parameter.low)
    return f"({low}, {'oo' if parameter.high is None else fraction_text(parameter.high)})"


def _spread(parameter: Parameter) -> list[Fraction]:
    """SPREAD values in the open range, evenly spaced in the logarithm on each side of 0."""
    low, high = parameter.low, parameter.high
    centre = abs(parameter.default or Fraction(1))
    if low is not None and low >= 0:
        return _geometric(low, high, centre, SPREAD)
    if high is not None and high <= 0:
        return [-value for value in _geometric(-high, None if low is None else -low, centre, SPREAD)]
    below = _geometric(Fraction(0), None if low is None else -low, centre, SPREAD // 2)
    return [-value for value in reversed(below)] + _geometric(Fraction(0), high, centre, SPREAD // 2)


def _geometric(low: Fraction, high: Fraction | None, centre: Fraction, count: int) -> list[Fraction]:
    """Values of three digits where these lie inside, strictly between the ends, in a constant ratio."""
    far = 10**UNBOUNDED_DECADES
    bottom = low if low > 0 else (min(centre, high) if high is not None else centre) / far
    top = high if high is not None else max(centre, bottom) * far
    return [_between(bottom, top, Fraction(2 * k + 1, 2 * count)) for k in range(count)]


def _between(bottom: Fraction, top: Fraction, share: Fraction) -> Fraction:
    """bottom**(1 - share) * top**share, to three digits if these stay between the ends."""
    from decimal import Context, Decimal

    fine, short = Context(prec=30, Emax=10**6, Emin=-(10**6)), Context(prec=3, Emax=10**6, Emin=-(10**6))

    def log(value: Fraction) -> Decimal:
        return fine.ln(fine.divide(Decimal(value.numerator), Decimal(value.denominator)))

    weight = fine.divide(Decimal(share.numerator), Decimal(share.denominator))
    exact = fine.exp(fine.add(fine.multiply(log(bottom), 1 - weight), fine.multiply(log(top), weight)))
    rounded = Fraction(short.plus(exact))
    return rounded if bottom < rounded < top else Fraction(exact)


def _switches(formula: Expr | None, sets: Sequence[Values], name: str) -> Iterator[dict[str, Fraction]]:
    """Where the pieces of a formula's min and max meet, and a value on each side."""
    if formula is None:
        return
    for node in formula.nodes():
        if node.op in ("min", "max"):
            for one, other in combinations(node.args, 2):
                yield from _meeting(one, other, sets, name)


def _meeting(one: Expr, other: Expr, sets: Sequence[Values], name: str) -> Iterator[dict[str, Fraction]]:
    signs = [_sign(one, other, values) for values in sets]
    for (before, sign), (after, next_sign) in pairwise(zip(sets, signs, strict=True)):
        if sign is None or next_sign is None or sign * next_sign >= 0:
            continue
        low, high = before[name], after[name]
        near = (high - low) / 2**BISECTIONS
        while high - low > near:
            middle = _simplest(low + (high - low) / 4, high - (high - low) / 4)
            here = _sign(one, other, {**before, name: middle})
            if not here:
                low, high = middle - near / 2, middle + near / 2
            else:
                low, high = (middle, high) if here == sign else (low, middle)
        # A meeting point that is a short fraction is the simplest one in its bracket.
        for value in (low, _simplest(low, high), high):
            yield {**before, name: value}


def _sign(one: Expr, other: Expr, values: Values) -> int | None:
    try:
        return difference(one, other, values)
    except InputError:
        return None  # one of them has no value here


def _simplest(low: Fraction, high: Fraction) -> Fraction:
    """`simplest_between` for ends of any sign."""
    if low < 0 < high:
        return Fraction(0)
    return simplest_between(low, high) if low >= 0 else -simplest_between(-high, -low)
