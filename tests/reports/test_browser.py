"""The page in a real browser: as its readers meet it, on a telephone and on a desk, in light, in the dark, on paper.

Where there is no browser the tests are skipped, but not where GKS_BROWSER=1 or CI says that there has to be one.
"""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.reports.browser import PROGRAMS, Browser, browsing, program
from tests.wanted import NEEDS_LATEX, WANTED, pdflatex

pytestmark = pytest.mark.skipif(
    program() is None and not WANTED, reason=f"none of {', '.join(PROGRAMS)} here; apt-get install chromium"
)


@pytest.fixture(scope="module")
def folder(report: tuple[Path, dict[str, str], dict[str, Any]]) -> Path:
    return report[0]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    assert program() is not None, "GKS_BROWSER or CI asks for a browser, and there is none"
    with browsing() as found:
        yield found


def opened(browser: Browser, folder: Path, **how: Any) -> Browser:
    browser.open(folder / "example.html", **how)
    return browser


def test_nothing_is_complained_of_and_no_request_leaves_the_file(browser: Browser, folder: Path) -> None:
    opened(browser, folder)
    assert browser.complaints() == []
    file, *others = browser.requests()
    assert file.startswith("file://")
    assert all(address.startswith("data:") for address in others)


@pytest.mark.parametrize("width", [360, 800, 1400])
def test_nothing_overflows(browser: Browser, folder: Path, width: int) -> None:
    opened(browser, folder, width=width)
    assert browser.run("document.documentElement.scrollWidth") == width
    sticking_out = """[...document.querySelectorAll('main *')]
        .filter(e => !e.closest('.scroll') && !e.closest('svg') && e.getBoundingClientRect().right > innerWidth + 1)
        .map(e => e.outerHTML.slice(0, 80))"""
    assert browser.run(sticking_out) == []


@pytest.mark.parametrize("width", [360, 1000])
def test_figures_and_mathematics_have_size(browser: Browser, folder: Path, width: int) -> None:
    opened(browser, folder, width=width)
    boxes = browser.run("[...document.querySelectorAll('svg.plot')].map(e => e.getBoundingClientRect().toJSON())")
    assert len(boxes) >= 7
    assert all(box["width"] > 250 and box["height"] > 60 for box in boxes)
    formulas = browser.run("[...document.querySelectorAll('math')].map(e => e.getBoundingClientRect().toJSON())")
    assert len(formulas) > 15
    assert all(box["width"] > 3 and box["height"] > 5 for box in formulas)


def test_the_mathematics_is_laid_out_in_two_dimensions(browser: Browser, folder: Path) -> None:
    """Where MathML is not rendered a fraction stands on one line, its parts side by side."""
    opened(browser, folder)
    parts = browser.run(
        "[...document.querySelectorAll('mfrac')].map(e => [...e.children].map(c => c.getBoundingClientRect().top))"
    )
    assert parts
    assert all(top < bottom for top, bottom in parts)


def test_letters_in_figures_can_be_read_on_a_telephone(browser: Browser, folder: Path) -> None:
    opened(browser, folder, width=360)
    heights = browser.run(
        """[...document.querySelectorAll('svg.plot')].map(
            s => s.getBoundingClientRect().width / s.viewBox.baseVal.width)"""
    )
    # A point of the drawing is that many pixels; the smallest letters, of legends, have 8 points.
    assert all(8 * scale >= 7 for scale in heights)


def test_landmarks_for_those_who_do_not_see(browser: Browser, folder: Path) -> None:
    opened(browser, folder)
    nodes = browser.send("Accessibility.getFullAXTree")["nodes"]
    roles = [node["role"]["value"] for node in nodes if not node["ignored"]]
    for role in ("banner", "navigation", "main", "contentinfo"):
        assert roles.count(role) == 1
    assert roles.count("heading") == 10
    images = [n for n in nodes if not n["ignored"] and n["role"]["value"] in ("image", "img")]
    plots = browser.run("document.querySelectorAll('svg.plot').length")
    assert len([n for n in images if n["name"]["value"]]) >= plots


def test_the_keyboard_reaches_the_content_first(browser: Browser, folder: Path) -> None:
    opened(browser, folder)
    browser.press("Tab")
    assert browser.run("document.activeElement.className") == "skip"
    box = browser.run("document.activeElement.getBoundingClientRect().toJSON()")
    assert box["x"] >= 0
    seen = []
    for _ in range(12):
        browser.press("Tab")
        seen.append(browser.run("document.activeElement.getBoundingClientRect().top + scrollY"))
    assert seen == sorted(seen)  # the focus goes down the page, never back


def luminance(colour: str) -> float:
    """Relative luminance (WCAG 2) of a colour as the browser names it."""
    channels = [int(part) / 255 for part in colour.removeprefix("rgb(").removesuffix(")").split(",")]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.mark.parametrize("dark", [False, True])
def test_text_and_lines_stand_out_in_light_and_dark(browser: Browser, folder: Path, dark: bool) -> None:
    opened(browser, folder, dark=dark)
    paper = luminance(browser.run("getComputedStyle(document.documentElement).backgroundColor"))
    assert (paper < 0.1) is dark
    texts = browser.run(
        """[...new Set([...document.querySelectorAll('p, a, code, strong, h1, td, th, .seen, math')]
            .map(e => getComputedStyle(e).color))]"""
    )
    assert all(contrast(luminance(colour), paper) >= 4.5 for colour in texts)
    strokes = browser.run(
        """[...new Set([...document.querySelectorAll('svg.plot path, svg.plot use')]
            .filter(e => !e.closest('defs') && !e.closest('clipPath'))
            .map(e => getComputedStyle(e)).filter(s => s.fill === 'none' && s.stroke !== 'none'
                && parseFloat(s.strokeWidth) >= 1).map(s => s.stroke))]"""
    )
    shades = [contrast(luminance(colour), paper) for colour in strokes if colour.startswith("rgb(")]
    assert shades
    assert sum(shade >= 2.5 for shade in shades) >= 0.8 * len(shades)


def contrast(one: float, other: float) -> float:
    return (max(one, other) + 0.05) / (min(one, other) + 0.05)


def test_it_prints_in_black_on_white(browser: Browser, folder: Path, tmp_path: Path) -> None:
    opened(browser, folder, dark=True, media="print")
    assert browser.run("getComputedStyle(document.body).color") == "rgb(0, 0, 0)"
    assert browser.run("getComputedStyle(document.querySelector('nav')).display") == "none"
    browser.print_pdf(tmp_path / "page.pdf")
    assert (tmp_path / "page.pdf").stat().st_size > 20_000


@NEEDS_LATEX
def test_pdflatex_sets_the_latex(folder: Path) -> None:
    command = [pdflatex(), "-interaction=nonstopmode", "-halt-on-error", "example.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    assert done.returncode == 0, done.stdout[-2000:]
    assert (folder / "example.pdf").stat().st_size > 50_000
    assert (folder / "example-curve.pdf").read_bytes().startswith(b"%PDF")
