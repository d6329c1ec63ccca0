"""Formulas and text as LaTeX, of the kind that pdflatex sets with nothing but amsmath."""

from __future__ import annotations

import unicodedata

from gks.reports.formulas import GREEK, Node, split_name

_LATEX_SIGNS = {
    "≤": r"\le", "≥": r"\ge", "−": "-", "·": r"\cdot", "∼": r"\sim", "→": r"\to", "≈": r"\approx",
    "∂": r"\partial ", "±": r"\pm", "⇔": r"\iff", "|": "|", "\u2062": r"\,", "…": r"\dots", "∈": r"\in",
}  # fmt: skip


_TEMPLATES = {
    "fraction": r"\frac{{{0}}}{{{1}}}",
    "power": "{{{0}}}^{{{1}}}",
    "index": "{{{0}}}_{{{1}}}",
    "root": r"\sqrt{{{0}}}",
    "fence": r"\left({0}\right)",
}


def latex(node: Node) -> str:
    """The same as LaTeX, for inside a formula."""
    if not node.parts:
        return _leaf(node)
    if node.kind in ("matrix", "cases"):
        rows = r" \\ ".join(" & ".join(map(latex, each.parts)) for each in node.parts)
        kind = "bmatrix" if node.kind == "matrix" else "cases"
        return rf"\begin{{{kind}}} {rows} \end{{{kind}}}"
    parts = [latex(part) for part in node.parts]
    if node.kind in _TEMPLATES:
        return _TEMPLATES[node.kind].format(*parts)
    if node.kind == "call":
        return rf"{parts[0]}\left({', '.join(parts[1:])}\right)"
    return " ".join(parts)


def _leaf(node: Node) -> str:
    if node.kind == "name":
        return _latex_name(node.text)
    if node.kind == "operator":
        return _LATEX_SIGNS.get(node.text, node.text)
    if node.kind == "words":
        return rf"\text{{{latex_text(node.text)}}}"
    return node.text.replace("∞", r"\infty ").replace("Δ", r"\Delta ").replace("%", r"\%")


_TO_COMMAND = {letter: rf"\{word}" for word, letter in GREEK.items()} | {"∞": r"\infty", "ο": "o"}


def _latex_name(text: str) -> str:
    symbol, index = split_name(text)
    if symbol in _TO_COMMAND:
        base = _TO_COMMAND[symbol]
    else:
        base = symbol if len(symbol) == 1 else rf"\mathrm{{{latex_text(symbol)}}}"
    return rf"{base}_{{\mathrm{{{latex_text(index)}}}}}" if index else base


_LATEX_TEXT = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\ensuremath{<}", ">": r"\ensuremath{>}",
    "|": r"\ensuremath{|}", "−": r"\ensuremath{-}", "×": r"\ensuremath{\times}", "±": r"\ensuremath{\pm}",
    "≤": r"\ensuremath{\le}", "≥": r"\ensuremath{\ge}", "→": r"\ensuremath{\to}", "∞": r"\ensuremath{\infty}",
    "–": "--", "—": "---", "“": "``", "”": "''", "’": "'", "‘": "`", "…": r"\dots{}", "·": r"\ensuremath{\cdot}",
    "≈": r"\ensuremath{\approx}", "\u00a0": "~", "√": r"\ensuremath{\surd}", "²": r"\ensuremath{{}^2}", '"': "''",
    "°": r"\ensuremath{{}^\circ}", "ß": r"\ss{}", "æ": r"\ae{}", "ø": r"\o{}", "Ø": r"\O{}", "å": r"\aa{}",
    "∂": r"\ensuremath{\partial}", "∼": r"\ensuremath{\sim}", "Δ": r"\ensuremath{\Delta}",
    **{letter: rf"\ensuremath{{{command}}}" for letter, command in _TO_COMMAND.items()},
}  # fmt: skip

_ACCENTS = {"\u0300": "`", "\u0301": "'", "\u0302": "^", "\u0303": "~", "\u0308": '"', "\u0327": "c", "\u030c": "v"}


def latex_text(text: str) -> str:
    """Any text as LaTeX outside mathematics; a letter that plain LaTeX has no way to write becomes a question mark."""
    return "".join(map(_latex_letter, text))


def _latex_letter(letter: str) -> str:
    if letter in _LATEX_TEXT:
        return _LATEX_TEXT[letter]
    if letter.isascii():
        return letter if letter.isprintable() else " "
    base, marks = (parts := unicodedata.normalize("NFD", letter))[:1], parts[1:]
    if marks in _ACCENTS and base.isascii() and base.isalpha():
        base = rf"\{base}" if base in "ij" else base
        return rf"\{_ACCENTS[marks]}{{{base}}}"
    return "?"
