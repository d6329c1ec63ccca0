"""What every picture of this package stands on: one style, no window system, the same bytes every time.

Matplotlib is imported when something is drawn, never its pyplot; neither the user's own settings nor the date enters.
"""

from __future__ import annotations

import io
import os
import textwrap
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from math import ceil, floor, log10
from typing import TYPE_CHECKING

from gks.modes.printing import latex_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from gks.scheme.model import Scheme

STYLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "gks.mplstyle")

FORMATS = ("png", "svg", "pdf")


def format_of(path: str) -> str:
    """The format that a file's ending names; ValueError for one that is not drawn."""
    kind = os.path.splitext(path)[1].lower().removeprefix(".")
    if kind not in FORMATS:
        raise ValueError(f"{path!r} ends in none of {', '.join(FORMATS)}")
    return kind


@contextmanager
def styled() -> Iterator[None]:
    """Matplotlib's defaults with this package's style, whatever the user's own settings; put back afterwards."""
    import matplotlib

    with matplotlib.rc_context(fname=STYLE):
        yield


def new_figure() -> tuple[Figure, Axes]:
    """A figure of one Axes that no window system knows of."""
    from matplotlib.figure import Figure

    figure = Figure()
    return figure, figure.add_subplot()


def image(figure: Figure, kind: str, title: str) -> bytes:
    """The figure as a file's content ("png", "svg" or "pdf"), without date or program version."""
    title = one_line(title)
    metadata: dict[str, Mapping[str, str | None]] = {
        "png": {"Software": None, "Title": title},
        "svg": {"Date": None, "Creator": None, "Title": title},
        "pdf": {"CreationDate": None, "Producer": None, "Creator": None, "Title": title},
    }
    target = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing", UserWarning)  # a letter the font lacks is drawn as a box
        figure.savefig(target, format=kind, metadata=metadata[kind])
    return target.getvalue()


def mark_decades(axis: Axis, low: float, high: float) -> None:
    """Ticks of an axis over very many decades; matplotlib's own reach for the next one, beyond the doubles."""
    from matplotlib.ticker import FixedLocator, NullLocator

    first, last = ceil(log10(low)), floor(log10(high))
    if last - first > MOST_DECADES:
        step = ceil((last - first) / 8)
        axis.set_major_locator(FixedLocator([10.0**k for k in range(-(-first // step) * step, last + 1, step)]))
        axis.set_minor_locator(NullLocator())


DOUBLE_DECADES = 307
"""Powers of ten up to this are normal doubles."""

MOST_DECADES = 60
"""Beyond these, decades are too narrow for ticks of their own."""


def label_of(scheme: Scheme, name: str) -> str:
    """The parameter as mathematics, with the file's own words for it where they are short."""
    doc = scheme.parameter(name).doc
    return f"${latex_name(name)}$" + (f"  ({plain(doc)})" if 0 < len(doc) <= LONGEST_DOC else "")


LONGEST_DOC = 60
"""Characters of a parameter's description that fit under an axis."""


def plain(text: str) -> str:
    """A file's text as a label: one line of moderate length, in which no dollar sign starts mathematics."""
    return textwrap.shorten(one_line(text), LONGEST_LABEL, placeholder=" ...").replace("$", r"\$")


LONGEST_LABEL = 160
"""Characters of a title: two lines."""


def one_line(text: str) -> str:
    """The text with a space for every run of white space and of what can't be printed."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())
