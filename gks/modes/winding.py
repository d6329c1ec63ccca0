"""The number of zeros of Delta in abs(w) < 1, by a walk along the unit circle that leaves nothing between its steps.

Delta is analytic for abs(w) < 1 and continuous up to the circle, and its coefficients are real: the walk goes from a
real point to a real point through the upper half-plane, and the zeros inside number the half-turns of Delta on the way.
A step is a disc over which Delta is proved to stay within a right angle of its value at the node, so that the phase
between neighbouring nodes is known without a doubt about full turns. Where that fails the step is divided. Round a
known zero near the circle the walk goes on an arc inside of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import acos, ceil, pi

import numpy as np

from gks.modes.chart import Chart
from gks.modes.discs import Array, ComplexArray, Discs
from gks.modes.kreissdiscs import Index, Patch, Region, Start, patch
from gks.modes.kreisspairs import PairedRegion, paired_patch
from gks.modes.tables import DiscTables

FIRST_STEP = pi / 128
"""Half-length of the first steps: symbols of degree up to 8 need about one division from here."""
CIRCLE_STEP = 0.125
"""Half-length, in radians, of the first steps round a small disc: a zero at its centre turns Delta as fast."""
INWARD = 0.25
"""The node of a step of half-length h on the circle lies INWARD*h inside, where decaying roots are told by modulus."""
RIGHT_ANGLE = 0.9
"""Largest relative change that a step may prove: the phase moves by less than asin(0.9) = 1.12, two of which stay below
pi by more than any rounding of a phase."""
JOINT = 2.0**-46
"""Added to the radius of a step's disc: more than the rounding of end points of neighbouring pieces (a few 2**-52)."""
TINY = 2.0**-48
"""Distance of end points up to which neighbouring steps leave nothing between their discs."""
STEPS = 20_000
"""Steps after which a walk gives up, some seconds of work."""
FEW_STEPS = 2_000
"""The same round a pocket, which another radius may suit better: a hundred are usual."""


@dataclass(frozen=True, slots=True)
class Piece:
    """The arc centre + radius*exp(i t), t from ``begin`` to ``end``; on the unit circle nodes are moved inwards."""

    centre: complex
    radius: float
    begin: float
    end: float
    unit: bool


@dataclass(frozen=True, slots=True)
class _Settled:
    """Steps of one piece over which Delta was followed: midpoints and half-lengths in t, the rest as in `Walk`."""

    piece: Piece
    middle: Array
    half: Array
    node: ComplexArray
    patch: Patch

    def within(self, piece: Piece) -> _Settled | None:
        """Those that are steps of another piece as well."""
        if self.piece != piece and not (self.piece.unit and piece.unit):
            return None
        low, high = sorted((piece.begin, piece.end))
        at = np.flatnonzero((self.middle - self.half >= low - TINY) & (self.middle + self.half <= high + TINY))
        return _Settled(piece, self.middle[at], self.half[at], self.node[at], self.patch.take(at)) if len(at) else None


@dataclass(frozen=True, slots=True)
class Walk:
    """Nodes in order, the value of Delta there, and the nodes of the steps that no size settled.

    ``closed`` says that the path is a full circle; else it runs from a real point to a real point. ``settled`` has the
    steps that need not be taken again where another path has them too.
    """

    node: ComplexArray
    phase: Array
    log: Array
    relative: Array
    change: Array
    stuck: tuple[complex, ...]
    closed: bool
    settled: tuple[_Settled, ...] = ()

    @property
    def zeros(self) -> float:
        """The number of zeros enclosed, an integer up to rounding where nothing is stuck.

        The half-turns from a real point to a real point, or the full turns of a closed path.
        """
        steps = float(_wrapped(np.diff(self.phase)).sum())
        if self.closed:
            return (steps + float(_wrapped(self.phase[:1] - self.phase[-1:])[0])) / (2 * pi)
        return (steps + _to_real(self.phase[-1]) - _to_real(self.phase[0])) / pi

    @property
    def continuous(self) -> ComplexArray:
        """log Delta along the path, zero or a half-turn at the real end where the path begins there."""
        first = 0.0 if self.closed else -_to_real(self.phase[0])
        turned = first + np.concatenate([[0.0], np.cumsum(_wrapped(np.diff(self.phase)))])
        return np.asarray(self.log + 1j * turned)


def _wrapped(angles: Array) -> Array:
    """The same angles in (-pi, pi]."""
    return np.asarray(np.angle(np.exp(1j * angles)))


def _to_real(phase: float) -> float:
    """The smallest turn that makes a number of this phase real."""
    return round(phase / pi) * pi - phase


def half_circle(indentations: Sequence[tuple[complex, float]] = ()) -> list[Piece]:
    """The contour from a real point near 1 to one near -1, round discs (centre, radius) that meet the unit circle.

    The discs are disjoint, and each is centred on the real axis or keeps clear of it in the upper half-plane.
    """
    pieces: list[Piece] = []
    at = 0.0
    for centre, radius in sorted(indentations, key=lambda each: float(np.angle(each[0]))):
        direction = float(np.angle(centre)) if centre.imag else (0.0 if centre.real > 0 else pi)
        size = abs(centre)
        half = acos((1 + size**2 - radius**2) / (2 * size))
        meeting = np.exp(1j * half) - size  # seen from the centre, the direction of the centre being the real axis
        side = float(abs(np.angle(meeting)))
        begin = direction - (pi if direction == 0.0 else side)
        end = direction - (pi if direction == pi else 2 * pi - side)
        if direction - half > at:
            pieces.append(Piece(0j, 1.0, at, direction - half, True))
        pieces.append(Piece(centre, radius, begin, end, False))
        at = direction + half
    if at < pi:
        pieces.append(Piece(0j, 1.0, at, pi, True))
    return pieces


def full_circle(centre: complex, radius: float) -> list[Piece]:
    """The boundary of a disc, or its upper half where the centre is real."""
    return [Piece(centre, radius, 0.0, 2 * pi if centre.imag else pi, False)]


@dataclass(frozen=True, slots=True)
class _Steps:
    """A batch of steps: piece number, midpoint in t, half-length in t (positive)."""

    piece: Index
    middle: Array
    half: Array

    def divided(self) -> _Steps:
        quarter = self.half / 2
        return _Steps(
            np.repeat(self.piece, 2),
            (self.middle[:, None] + np.stack([-quarter, quarter], 1)).ravel(),
            np.repeat(quarter, 2),
        )

    def take(self, index: Index) -> _Steps:
        return _Steps(self.piece[index], self.middle[index], self.half[index])


def walk(
    tables: DiscTables,
    chart: Chart,
    pieces: Sequence[Piece],
    smallest: float,
    region: Region | PairedRegion | None = None,
    most: int = STEPS,
    known: Walk | None = None,
) -> Walk:
    """Walks along the pieces with steps no shorter than ``smallest`` (half-length in w).

    With a region, its discs instead of the modulus tell the decaying roots; with one that has pairs, Delta is taken
    over both choices of their roots, and the walk is that of the product. Steps of a walk that is ``known`` are not
    taken again.
    """
    kept = [[s for each in (known.settled if known else ()) if (s := each.within(piece))] for piece in pieces]
    pending = _first(pieces, kept)
    start: Start | None = None
    done = [
        (_Steps(np.full(len(s.middle), k), s.middle, s.half), s.node, s.patch)
        for k, mine in enumerate(kept)
        for s in mine
    ]
    settled = [s for mine in kept for s in mine]
    stuck: list[complex] = []
    taken = 0
    while len(pending.piece):
        taken += len(pending.piece)
        disc, node = _cover(pieces, pending)
        found = _patches(tables, chart, disc, node, start, region)
        passed = found.change <= RIGHT_ANGLE
        small = disc.rad < 2 * smallest if taken < most else np.ones(len(passed), bool)
        stuck += [complex(w) for w in node[~passed & small]]
        closed = np.flatnonzero(passed | small)
        done.append((pending.take(closed), node[closed], found.take(closed)))
        settled += _settled(pieces, pending, node, found, np.flatnonzero(passed))
        open_ = np.flatnonzero(~(passed | small))
        pending = pending.take(open_).divided()
        start = found.start.take(np.repeat(open_, 2))
    return _ordered(pieces, done, stuck, settled)


def _settled(
    pieces: Sequence[Piece], steps: _Steps, node: ComplexArray, found: Patch, passed: Index
) -> Iterator[_Settled]:
    for k in np.unique(steps.piece[passed]):
        at = passed[steps.piece[passed] == k]
        yield _Settled(pieces[int(k)], steps.middle[at], steps.half[at], node[at], found.take(at))


MOST_BYTES = 100_000_000
"""Memory that the arrays of one batch of discs may take, roughly."""
COPIES = 24
"""Arrays of the size of a batch's matrices that live at once: values and slopes, midpoints and radii, products."""


def _patches(
    tables: DiscTables,
    chart: Chart,
    disc: Discs,
    node: ComplexArray,
    start: Start | None,
    region: Region | PairedRegion | None,
) -> Patch:
    """As `patch` or `paired_patch`, in portions that fit in memory."""

    def over(disc: Discs, node: ComplexArray, start: Start | None) -> Patch:
        if isinstance(region, PairedRegion):
            return paired_patch(tables, chart, disc, node, start, region)
        return patch(tables, chart, disc, node, start, region)

    matrix = tables.size * sum(tables.longest)
    roots = sum(symbol.powers.mid.shape[1] ** 2 for symbol in tables.symbols)
    portion = max(1, MOST_BYTES // (16 * COPIES * chart.branches * (matrix + roots)))
    if len(node) <= portion:
        return over(disc, node, start)
    places = [np.arange(k, min(k + portion, len(node))) for k in range(0, len(node), portion)]
    return Patch.join([over(disc[at], node[at], start and start.take(at)) for at in places])


def _first(pieces: Sequence[Piece], kept: Sequence[Sequence[_Settled]]) -> _Steps:
    """The first steps along what no kept ones cover."""
    number, middle, half = [], [], []
    for k, piece in enumerate(pieces):
        for low, high in _uncovered(piece, kept[k]):
            count = ceil((high - low) / (2 * (FIRST_STEP if piece.unit else CIRCLE_STEP)))
            for j in range(count):
                number.append(k)
                middle.append(low + (high - low) * (j + 0.5) / count)
                half.append((high - low) / (2 * count))
    return _Steps(np.array(number, np.intp), np.array(middle), np.array(half))


def _uncovered(piece: Piece, kept: Sequence[_Settled]) -> Iterator[tuple[float, float]]:
    """The intervals of t between kept steps, ascending."""
    at, end = sorted((piece.begin, piece.end))
    if kept:
        middle, half = (np.concatenate([getattr(s, name) for s in kept]) for name in ("middle", "half"))
        for low, high in sorted(zip(middle - half, middle + half, strict=True)):
            if low > at + TINY:
                yield at, float(low)
            at = max(at, float(high))
    if end > at + TINY:
        yield at, end


def _cover(pieces: Sequence[Piece], steps: _Steps) -> tuple[Discs, ComplexArray]:
    """Discs that hold the steps, centred at their nodes."""
    centre = np.array([p.centre for p in pieces])[steps.piece]
    radius = np.array([p.radius for p in pieces])[steps.piece]
    unit = np.array([p.unit for p in pieces])[steps.piece]
    inward = np.where(unit, INWARD * steps.half, 0.0)
    node = centre + radius * (1 - inward) * np.exp(1j * steps.middle)
    # The end points are at most sqrt(h**2 + (INWARD h)**2) from the node, for h <= 4 INWARD.
    reach = radius * steps.half * np.where(unit, np.hypot(1, INWARD), 1.0)
    return Discs(node, reach + JOINT * radius), node


def _ordered(
    pieces: Sequence[Piece],
    done: Sequence[tuple[_Steps, ComplexArray, Patch]],
    stuck: Sequence[complex],
    settled: Sequence[_Settled],
) -> Walk:
    piece = np.concatenate([s.piece for s, _, _ in done])
    forward = np.array([1.0 if p.end >= p.begin else -1.0 for p in pieces])[piece]
    order = np.lexsort((np.concatenate([s.middle for s, _, _ in done]) * forward, piece))
    found = Patch.join([p for _, _, p in done]).take(order)
    node = np.concatenate([n for _, n, _ in done])[order]
    closed = len(pieces) == 1 and abs(pieces[0].end - pieces[0].begin) > 1.5 * pi
    log = found.log.sum(axis=1)
    return Walk(node, found.phase, log, found.relative, found.change, tuple(stuck), closed, tuple(settled))


def seeds(found: Walk, centre: complex, radius: float, count: int) -> list[complex]:
    """The ``count`` zeros of Delta that a path encloses, roughly, from the moments of Delta'/Delta along it.

    With u = (w - centre)/radius and L = log Delta the k-th moment, the sum of u_j**k over the zeros, is by parts

        count * u_b**k - (k/pi) Im I,      I = the integral of u**(k-1) L du,

    from a real point to a real point u_b through the upper half-plane, and count * u_b**k - k/(2 pi i) I round a circle
    that begins and ends at u_b. Newton's identities turn moments into the polynomial that has the zeros as roots.
    """
    if not count:
        return []
    known = np.isfinite(found.log)  # a node of a step that was given up may be a zero itself
    u, logs = (found.node[known] - centre) / radius, found.continuous[known]
    if found.closed:
        u, logs = np.append(u, u[0]), np.append(logs, logs[0] + 2j * pi * count)
    else:
        u = np.concatenate([[_real_end(u[0])], u, [_real_end(u[-1])]])
        logs = np.concatenate([[logs[0].real], logs, [logs[-1].real + 1j * pi * round(logs[-1].imag / pi)]])
    moments = []
    for k in range(1, count + 1):
        values = u ** (k - 1) * logs
        integral = complex(((values[1:] + values[:-1]) / 2 * np.diff(u)).sum())
        end = complex(u[-1]) ** k * count
        moments.append(end - k * integral / (2j * pi) if found.closed else complex(end.real - k * integral.imag / pi))
    elementary: list[complex] = [1.0 + 0j]
    for k in range(1, count + 1):
        terms = ((-1) ** (i - 1) * elementary[k - i] * moments[i - 1] for i in range(1, k + 1))
        elementary.append(sum(terms) / k)
    polynomial = [(-1) ** k * e for k, e in enumerate(elementary)]
    return [centre + radius * complex(root) for root in np.roots(polynomial)]


def _real_end(u: complex) -> float:
    """The real point next to the first or last node of a path round the unit circle of u, or along it."""
    return float(np.sign(u.real) * abs(u))
