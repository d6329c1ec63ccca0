"""Observed growth per step, with its uncertainty, from values recorded near the boundary at every step.

Two estimators that fail in different ways, and the one with the smaller uncertainty is taken:

- `envelope`: log size = c + n log(rate) + transient, least squares over blocks of steps. A transient p log(n) takes up
  the polynomial factor of a multiple root and the algebraic decay of waves that leave, so neither passes for growth.
- `pencil`: in each of several windows the values are a sum of c_j z_j**n, found by the matrix pencil method (Hua &
  Sarkar, IEEE Trans. ASSP 38 (1990) 814-824). A pair of complex modes, whose size oscillates, is two of these
  terms. The scatter and the drift between windows are its uncertainty.

Uncertainties are half-widths of two-sided 99 % intervals (`CONFIDENCE`), by Student's t over blocks or windows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]

CONFIDENCE = 0.99

T_QUANTILE = {
    1: 63.657,
    2: 9.925,
    3: 5.841,
    4: 4.604,
    5: 4.032,
    6: 3.707,
    7: 3.499,
    8: 3.355,
    10: 3.169,
    13: 3.012,
    17: 2.898,
    21: 2.831,
}
"""Student's t at 99.5 % by degrees of freedom (two-sided 99 %)."""

ROUNDING = 2.0**-46
"""Relative floor of every uncertainty: some hundred rounding errors of a step."""


@dataclass(frozen=True, slots=True)
class Trace:
    """values[n] * 2.0**exponents[n] are the recorded values after n steps; shapes (steps + 1, k) and (steps + 1,)."""

    values: Array
    exponents: Array

    def __len__(self) -> int:
        return len(self.values)

    def log_sizes(self) -> Array:
        """Natural logarithm of the Euclidean norm after each step; -inf where everything is zero."""
        import numpy

        largest = numpy.abs(self.values).max(axis=1, initial=0.0)
        safe = numpy.where(largest > 0, largest, 1.0)
        norms = safe * numpy.linalg.norm(self.values / safe[:, None], axis=1)
        with numpy.errstate(divide="ignore"):
            return numpy.log(numpy.where(largest > 0, norms, 0.0)) + self.exponents * math.log(2.0)

    def part(self, start: int, stop: int) -> Trace:
        """The steps start..stop-1."""
        return Trace(self.values[start:stop], self.exponents[start:stop])


@dataclass(frozen=True, slots=True)
class Growth:
    """rate: growth per step; uncertainty: half-width of its 99 % interval (absolute); how: which estimator gave it.

    window : the steps first..last that it was fitted to, where it was fitted to any.
    """

    rate: float
    uncertainty: float
    how: str
    window: tuple[int, int] = (0, 0)

    def exceeds(self, bound: float) -> bool:
        """Whether the interval lies above the bound; its lower end is as many times below as the upper is above."""
        return self.rate > 0 and self.rate / (1 + self.uncertainty / self.rate) > bound

    def below(self, bound: float) -> bool:
        """Whether the whole interval lies below the bound."""
        return self.rate + self.uncertainty < bound


FLOOR = 2.0**-43
"""A signal that has fallen by this factor, to a thousand rounding errors, may be rounding errors from there on."""

RISEN = 1e3
"""A signal that rises again by this factor from the floor is a mode that rounding errors have excited, and is real."""


def observe(trace: Trace) -> Growth:
    """The growth per step, from all but the first quarter of what lies above the round-off floor.

    Values that have become exactly zero have rate 0. With fewer than 16 steps the two halves are compared, and with
    fewer than 4 nothing is known: uncertainty inf.
    """
    import numpy

    logs = trace.log_sizes()
    if not numpy.isfinite(logs[-1]):
        return Growth(0.0, 0.0, "exactly zero at the end")
    # The largest of the next steps counts: two unknowns of very different size that take turns are no decay.
    ahead = numpy.array([logs[n : n + 16].max() for n in range(len(logs))])
    fallen = numpy.flatnonzero(ahead < numpy.maximum.accumulate(logs) + math.log(FLOOR))
    start, stop, how = 0, len(trace), ""
    if len(fallen):
        lowest = int(fallen[0]) + int(numpy.argmin(logs[fallen[0] :]))
        if logs[-1] - logs[lowest] > math.log(RISEN):
            start = lowest
        else:
            stop, how = max(int(fallen[0]), 2), ", down to the round-off floor"
    start += (stop - start) // 4
    late = trace.part(start, stop)
    late_logs = late.log_sizes()
    found = _halves(late_logs) if len(late) < 16 else _better(envelope(late_logs, start), pencil(late))
    return Growth(found.rate, found.uncertainty, found.how + how, (start, stop - 1))


def _better(found: Growth, other: Growth | None) -> Growth:
    """The estimate with the smaller uncertainty, if the two are compatible, else the envelope's.

    A pencil that contradicts the envelope has picked one wave out of a continuum, and its small scatter means nothing
    then; unless it explains its windows altogether, when a beat with its blocks has misled the envelope.
    """
    if other is None or other.uncertainty >= found.uncertainty:
        return found
    compatible = abs(other.rate - found.rate) <= 2 * (found.uncertainty + other.uncertainty)
    return other if compatible or other.how == COMPLETE else found


def _halves(logs: Array) -> Growth:
    """A few steps: the mean slope, and the difference between the slopes of the halves as its uncertainty."""
    last = len(logs) - 1
    if last < 1:
        return Growth(math.exp(min(709.0, float(logs[-1]))), math.inf, "too few steps")
    rate = math.exp(min(709.0, float(logs[-1] - logs[0]) / last))
    if last < 3:
        return Growth(rate, math.inf, "too few steps")
    middle = last // 2
    first, second = float(logs[middle] - logs[0]) / middle, float(logs[-1] - logs[middle]) / (last - middle)
    return Growth(rate, rate * quantile(1) * abs(second - first) / math.sqrt(2) / 2, "halves")


def envelope(logs: Array, start: int) -> Growth:
    """The slope of log sizes (of steps start, start + 1, ...) once a transient is taken out.

    The form of the transient is not known: none, a power of n (multiple roots, waves that leave), b/n (a bounded signal
    that settles) and both are fitted. The runner-up, and every form that explains the blocks about as well as the
    best one, widen the uncertainty to their own slopes: what is left out of a form errs the same way in every block.
    """
    import numpy

    # Blocks of one even length: two unknowns of different size that take turns leave no trace, nor does a pair of modes
    # that beats within a block. The mean growth is divided out first, else the last step of a block would be all of it.
    count = min(24, len(logs) // 2)
    length = 2 * (len(logs) // (2 * count))
    start += len(logs) - count * length
    logs = logs[len(logs) - count * length :]
    n = numpy.arange(len(logs))
    mean = float(numpy.polyfit(n, logs, 1)[0])
    blocks = (logs - mean * n).reshape(count, length)
    tops = blocks.max(axis=1)
    levels = tops + 0.5 * numpy.log(numpy.mean(numpy.exp(2 * (blocks - tops[:, None])), axis=1))
    steps = start + length * numpy.arange(count) + 0.5 * (length - 1)
    power, settling = numpy.log(steps + 1.0), 1.0 / (steps + 1.0)
    forms = [[], [power], [settling], [power, settling]] if count >= 8 else [[]]
    best, *others = sorted((_slope(steps, levels, form) for form in forms), key=lambda fit: fit.variance)
    credible = [fit for rank, fit in enumerate(others) if rank == 0 or fit.variance <= CREDIBLE * best.variance]
    spread = max((abs(fit.slope - best.slope) for fit in credible), default=0.0)
    rate = math.exp(min(mean + best.slope, 709.0))
    return Growth(rate, rate * (quantile(best.freedom) * best.error + spread + ROUNDING), "envelope")


CREDIBLE = 2.0
"""The 90 % quantile of F at 20 and 20 degrees of freedom is 1.8: a form with twice the residual variance is out."""


@dataclass(frozen=True, slots=True)
class _Fit:
    """A line through block levels: slope per step, its standard error, residual variance, degrees of freedom."""

    slope: float
    error: float
    variance: float
    freedom: int


def _slope(steps: Array, levels: Array, transient: list[Array]) -> _Fit:
    """levels = c + slope * steps (+ p * transient), with the standard error widened by the residuals' correlation."""
    import numpy

    design = numpy.stack([numpy.ones(len(steps)), steps, *transient], axis=1)
    unit = numpy.abs(design).max(axis=0)
    solution, *_ = numpy.linalg.lstsq(design / unit, levels, rcond=None)
    residual = levels - design / unit @ solution
    freedom = max(1, len(steps) - design.shape[1])
    variance = float(residual @ residual) / freedom
    covariance = numpy.linalg.inv((design / unit).T @ (design / unit)) * variance
    error = math.sqrt(max(0.0, float(covariance[1, 1]))) / float(unit[1]) * _correlation_factor(residual)
    return _Fit(float(solution[1]) / float(unit[1]), error, variance, freedom)


def _correlation_factor(residual: Array) -> float:
    """sqrt((1 + r)/(1 - r)), r the lag-one correlation of the residuals (first-order autoregression), at most 0.9."""
    total = float(residual @ residual)
    if total == 0.0 or len(residual) < 8:
        return 1.0
    r = min(0.9, max(0.0, float(residual[1:] @ residual[:-1]) / total))
    return math.sqrt((1 + r) / (1 - r))


def quantile(freedom: int) -> float:
    """Student's t for CONFIDENCE, at the tabulated degrees of freedom not above those given."""
    return T_QUANTILE[max(known for known in T_QUANTILE if known <= max(1, freedom))]


COMPLETE = "pencil, nothing unexplained"

WINDOWS, LONGEST, MOST_TERMS = 4, 120, 12
"""Windows compared, their greatest length in steps, and the terms z**n sought in each."""

NOISE, UNEXPLAINED, ALL = 1e-11, 1e-3, 1e-9
"""Singular values below NOISE of the largest are rounding (times the closure's condition, up to 1e5). Where terms
leave UNEXPLAINED of a window, the accuracy asked of a march, it is no sum of so few; below ALL it is one.
"""


def pencil(trace: Trace) -> Growth | None:
    """The modulus of the dominant term in windows of the trace's second half; None where the windows are too short, or
    a jump in one leaves the rest of it below rounding.
    """
    import numpy

    half = len(trace) // 2
    length = min(LONGEST, half // 2)
    if length < 12:
        return None
    starts = numpy.linspace(len(trace) - half, len(trace) - length, WINDOWS).astype(int)
    windows = [trace.part(int(start), int(start) + length) for start in starts]
    if any(_off_the_mean(window.log_sizes()) > -math.log(NOISE) for window in windows):
        return None
    found = [dominant_term(window) for window in windows]
    if max(unexplained for _, unexplained in found) > UNEXPLAINED:
        return None
    how = COMPLETE if max(unexplained for _, unexplained in found) < ALL else "pencil"
    moduli = [modulus for modulus, _ in found]
    rate = moduli[-1]
    scatter = float(numpy.std(moduli, ddof=1))
    # An error that falls as 1/n is, in the last window, as large as it has fallen since the first, half as far along.
    drift = 2 * abs(moduli[-1] - moduli[0])
    return Growth(rate, quantile(WINDOWS - 1) * scatter / math.sqrt(WINDOWS) + drift + rate * ROUNDING, how)


def _off_the_mean(logs: Array) -> float:
    """How far logarithmic sizes lie from the straight line between their ends; infinite where one is."""
    import numpy

    if not numpy.isfinite(logs).all():
        return math.inf
    return float(numpy.abs(logs - numpy.linspace(logs[0], logs[-1], len(logs))).max())


def dominant_term(trace: Trace) -> tuple[float, float]:
    """(abs(z) of the fastest term z**n that still counts at the end of the window, the share left unexplained)."""
    import numpy

    logs = trace.log_sizes()
    mean = float(logs[-1] - logs[0]) / (len(trace) - 1)
    steps = numpy.arange(len(trace))
    # Divide out the mean growth first: windows may span hundreds of orders of magnitude.
    even = numpy.exp(trace.exponents * math.log(2.0) - (logs[0] + mean * steps))[:, None] * trace.values
    rows = len(trace) // 2
    hankel = numpy.concatenate([even[i : len(trace) - rows + i].T for i in range(rows + 1)], axis=0)
    width = even.shape[1]
    left, singular, _ = numpy.linalg.svd(hankel, full_matrices=False)
    rank = min(MOST_TERMS, int(numpy.sum(singular > singular[0] * NOISE)))
    basis = left[:, :rank]
    shift = numpy.linalg.lstsq(basis[:-width], basis[width:], rcond=None)[0]
    z = numpy.linalg.eigvals(shift)
    powers = z[None, :] ** (steps[:, None] - steps[-1] * (numpy.abs(z) > 1)[None, :])
    amplitudes = numpy.linalg.lstsq(powers, even.astype(complex), rcond=None)[0]
    unexplained = numpy.linalg.norm(even - powers @ amplitudes, axis=1).max() / numpy.linalg.norm(even, axis=1).max()
    final = numpy.linalg.norm(amplitudes, axis=1) * numpy.abs(powers[-1])
    # The fastest of the terms that still carry a thousandth of the largest: it is what remains.
    carried = numpy.abs(z)[final > UNEXPLAINED * final.max()]
    return float(carried.max()) * math.exp(mean), float(unexplained)


def observe_mode(trace: Trace, blocks: int = 6) -> tuple[complex, Growth]:
    """(z, growth) of a trace that is one mode from the start: z from the first step, the modulus from both ends.

    The uncertainty is the scatter and the drift of the modulus over blocks of steps.
    """
    import numpy

    logs = trace.log_sizes()
    steps = len(trace) - 1
    count = min(blocks, steps)
    edges = numpy.linspace(0, steps, count + 1).astype(int)
    rates = [math.exp((logs[b] - logs[a]) / (b - a)) for a, b in pairwise(edges)]
    rate = math.exp(float(logs[-1] - logs[0]) / steps)
    spread = quantile(count - 1) * float(numpy.std(rates, ddof=1)) / math.sqrt(count) if count > 1 else math.inf
    now, then = trace.values[0], trace.values[1] * 2.0 ** float(trace.exponents[1] - trace.exponents[0])
    z = complex(numpy.vdot(now, then) / numpy.vdot(now, now))
    drift = abs(rates[-1] - rates[0])
    return z, Growth(rate, spread + drift + rate * ROUNDING, "mode", (0, steps))


def departure(trace: Trace) -> float:
    """How far the first step is from a multiple of the start, relative to itself: 0 for a mode, 1 for other data."""
    import numpy

    now, then = trace.values[0], trace.values[1] * 2.0 ** float(trace.exponents[1] - trace.exponents[0])
    z = numpy.vdot(now, then) / numpy.vdot(now, now)
    return float(numpy.linalg.norm(then - z * now) / numpy.linalg.norm(then))


def exponent(logs: Array) -> tuple[float, float]:
    """(p, its 99 % half-width) of sizes ~ n**p after 0, 1, ... steps, from their natural logarithms.

    The first sixteenth is left out; the largest size of each block counts, so that oscillations do not.
    """
    import numpy

    edges = numpy.geomspace(max(2, len(logs) // 16), len(logs), 11).astype(int)
    pairs = [(a, b) for a, b in pairwise(edges) if b > a]
    tops = numpy.array([logs[a:b].max() for a, b in pairs])
    if not numpy.isfinite(tops).all():
        return 0.0, 0.0
    x = numpy.log([math.sqrt(a * b) for a, b in pairs])
    x, y = x - x.mean(), tops - tops.mean()
    slope = float(x @ y / (x @ x))
    residual = y - slope * x
    error = math.sqrt(float(residual @ residual) / max(1, len(x) - 2) / float(x @ x)) * _correlation_factor(residual)
    return slope, quantile(len(x) - 2) * error
