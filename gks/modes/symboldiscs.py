"""The symbols over discs of w: polynomials in a spatial root, and the variable in which their roots are sought.

In x itself, but where a root may be near infinity: there in y with x = (y + c)/(1 + conj(c) y), which keeps the unit
disc (`gks.modes.tables`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gks.modes.discs import ComplexArray, Discs, Jets, Ring, joined, powers
from gks.modes.rootdiscs import Mask
from gks.modes.tables import DiscSymbol

SMALL_LEAD = 2.0**-8
"""A leading coefficient that much smaller than the largest one, or more, says that a root may be near infinity."""


def homogeneous(pair: tuple[Ring, Ring], degree: int) -> Ring:
    """a**k b**(degree - k) for k = 0, ..., degree: (N, degree + 1)."""
    a, b = (powers(each, degree + 1) for each in pair)
    return joined([a[k] * b[degree - k] for k in range(degree + 1)], lambda parts: np.stack(parts, 1))


def led(symbol: DiscSymbol, pair: tuple[Jets, Jets]) -> Mask:
    """Where no spatial root is near infinity (N,), so that they are sought in x."""
    if not symbol.turn:
        return np.ones(len(pair[0].value.mid), bool)
    values = homogeneous(_normalised((pair[0].value, pair[1].value)), len(symbol.plain.mid) - 1).times(symbol.plain)
    return np.asarray(values.lower()[:, -1] > SMALL_LEAD * values.upper().max(axis=1))


def symbol_over(symbol: DiscSymbol, pair: tuple[Ring, Ring], plain: Mask) -> Ring:
    """The coefficients of P, ascending: (N, n + 1); in x where ``plain`` (N,), else in y.

    Up to a power of a or b, whichever is the larger: with that one 1 only one number varies over a disc.
    """
    table = homogeneous(_normalised(pair), len(symbol.powers.mid) - 1)
    if not symbol.turn or plain.all():
        return table.times(symbol.plain)
    turned = table.times(symbol.powers)
    return _select(plain, table.times(symbol.plain), turned) if plain.any() else turned


def _normalised(pair: tuple[Ring, Ring]) -> tuple[Ring, Ring]:
    a, b = pair
    sizes = [np.abs(x.mid if isinstance(x, Discs) else x.value.mid) for x in pair]
    one = type(a).exact(np.ones(sizes[0].shape, complex))
    finite = sizes[0] <= sizes[1]
    return _select(finite, a * b.reciprocal(), one), _select(finite, one, b * a.reciprocal())


def _select(first: Mask, one: Ring, other: Ring) -> Ring:
    """Rows of the one where ``first`` (N,), of the other elsewhere."""
    return joined([one, other], lambda parts: np.where(_beside(first, parts[0]), parts[0], parts[1]))


def _beside(rows: Mask, values: NDArray[Any]) -> Mask:
    return rows.reshape(rows.shape + (1,) * (values.ndim - 1))


def turned_back(symbol: DiscSymbol, y: Ring, plain: Mask) -> Ring:
    """x = (y + c)/(1 + conj(c) y), but where it is x already."""
    if not symbol.turn or plain.all():
        return y
    one = type(y).exact(np.ones((y.mid if isinstance(y, Discs) else y.value.mid).shape, complex))
    turn = Discs.exact(np.asarray(symbol.turn))
    x = (y + one.scaled(turn)) * (one + y.scaled(turn.apply(np.conj))).reciprocal()
    return _select(plain, y, x)


def turned_to(symbol: DiscSymbol, y: ComplexArray, plain: Mask) -> ComplexArray:
    """Points in y as approximate points in x where that is ``plain``."""
    turn = symbol.turn
    return np.where(plain[:, None], (y + turn) / (1 + turn.conjugate() * y), y) if turn else y


def turned_from(symbol: DiscSymbol, x: ComplexArray, plain: Mask) -> ComplexArray:
    """The other way."""
    turn = symbol.turn
    return np.where(plain[:, None], (x - turn) / (1 - turn.conjugate() * x), x) if turn else x
