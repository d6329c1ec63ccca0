"""Figures as part of a page: SVG without a background, whose colours follow the page from light to dark.

Matplotlib's own output is a whole document with identifiers that repeat from figure to figure; here it becomes an
element with a title, a description and identifiers of its own. Each colour becomes a custom property of the page,
with itself as the fallback, so that the page's style sheet can give it a counterpart for dark backgrounds.
"""

from __future__ import annotations

import base64
import pickle
import re
from typing import TYPE_CHECKING

from gks.reports.canvas import image, styled
from gks.reports.document import Panel
from gks.reports.mathml import escaped
from gks.reports.steps import Step

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH = 4.6
"""Inches of a panel: at the width of a small telephone its letters are still 9 pixels high."""


def drawn(panel: Panel) -> Figure:
    """The panel on a figure of its own, in the style in force."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, WIDTH * panel.aspect))
    figure.patch.set_alpha(0)
    axes = figure.add_subplot()
    axes.patch.set_alpha(0)
    panel.draw(axes)
    if panel.title:
        axes.set_title(panel.title)
    return figure


def svg_file(panel: Panel, title: str) -> bytes:
    """The panel as the content of an SVG file on white."""
    return _saved(panel, title, "svg")


def pdf_file(panel: Panel, title: str) -> bytes:
    """The panel as the content of a PDF file."""
    return _saved(panel, title, "pdf")


def _saved(panel: Panel, title: str, kind: str) -> bytes:
    with styled():
        figure = drawn(panel)
        figure.patch.set_alpha(1)
        return image(figure, kind, title)


def drawing_step(panel: Panel, key: str, title: str, description: str) -> Step:
    """The drawing of a panel as a step of the report."""
    packed = base64.b64encode(pickle.dumps(panel, protocol=5)).decode("ascii")
    arguments = {"packed": packed, "key": key, "title": title, "description": description}
    return Step(f"draw {key}", "inline_svg.packed_svg", arguments)


def packed_svg(packed: str, key: str, title: str, description: str) -> dict[str, str]:
    """`inline_svg` of a panel packed by `drawing_step`, which only this package's own processes send to one another."""
    panel = pickle.loads(base64.b64decode(packed))
    return {"svg": inline_svg(panel, key, title, description)}


def inline_svg(panel: Panel, key: str, title: str, description: str) -> str:
    """The panel as an `svg` element whose identifiers begin with `key`, with its text equivalent inside."""
    with styled():
        text = image(drawn(panel), "svg", title).decode("utf-8")
    start = text.index("<svg")
    head, _, body = text[start:].partition(">")
    box = re.search(r'viewBox="([^"]+)"', head)
    assert box is not None
    body = body[body.index("</metadata>") + len("</metadata>") :]
    body = re.sub(r"<!--.*?-->\s*", "", body, flags=re.DOTALL)
    body = re.sub(r'\bid="([^"]+)"', rf'id="{key}-\1"', body)
    body = re.sub(r'href="#([^"]+)"', rf'href="#{key}-\1"', body).replace("xlink:href", "href")
    body = body.replace("url(#", f"url(#{key}-")
    body = re.sub(r"#([0-9a-fA-F]{6})\b(?=[;\"])", _following, body)
    body = body.replace("<style type=\"text/css\">*{stroke-linejoin: round; stroke-linecap: butt}</style>", "")
    named = f'<title id="{key}-title">{escaped(title)}</title><desc id="{key}-desc">{escaped(description)}</desc>'
    width = float(box[1].split()[2])
    return (
        f'<svg class="plot" role="img" aria-labelledby="{key}-title {key}-desc" viewBox="{box[1]}" '
        f'style="max-width: {width * 4 / 3:.0f}px">{named}{body}'
    )


def _following(match: re.Match[str]) -> str:
    return f"var(--c{match[1].lower()}, #{match[1]})"
