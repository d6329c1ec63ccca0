"""A report as LaTeX that pdflatex sets with amsmath, graphicx, hyperref and longtable; pictures as PDF beside it."""

from __future__ import annotations

from gks.reports.document import (
    Block,
    Code,
    Figure,
    Formula,
    Inline,
    Link,
    Listing,
    Maths,
    Number,
    Paragraph,
    Report,
    Strong,
    Table,
    Text,
)
from gks.reports.latex import latex, latex_text

_HEAD = r"""\documentclass[10pt,a4paper]{article}
\usepackage[utf8]{inputenc}
\usepackage[margin=22mm]{geometry}
\usepackage{amsmath,graphicx,array,longtable}
\usepackage[hidelinks]{hyperref}
\setlength{\parindent}{0pt}\setlength{\parskip}{5pt plus 2pt}\setlength{\tabcolsep}{4pt}
\setlength{\LTleft}{0pt}\emergencystretch=3em\sloppy\allowdisplaybreaks
"""


def tex(report: Report) -> str:
    """The whole document; pictures are NAME.pdf beside it."""
    parts = [rf"\title{{{latex_text(report.title)}}}", r"\date{}", r"\begin{document}", r"\maketitle"]
    parts += map(_block, report.summary)
    for section in report.sections:
        parts += [rf"\section{{{latex_text(section.title)}}}\label{{{section.anchor}}}", *map(_block, section.blocks)]
    return _HEAD + "\n\n".join([*parts, r"\end{document}"]) + "\n"


def _block(block: Block) -> str:
    if isinstance(block, Paragraph):
        return text_tex(block.text)
    if isinstance(block, Formula):
        return rf"\begin{{flushleft}}{_fitted(latex(block.node))}\end{{flushleft}}"
    if isinstance(block, Listing):
        items = "\n".join(rf"\item {text_tex(item)}" for item in block.items)
        return rf"\begin{{itemize}}{items}\end{{itemize}}"
    return _table(block) if isinstance(block, Table) else _figure(block)


def _fitted(formula: str) -> str:
    """In display style, and made narrower where it is wider than the line."""
    return (
        rf"\setbox0\hbox{{$\displaystyle {formula}$}}"
        r"\ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\box0}\else\box0\fi"
    )


def _table(table: Table) -> str:
    count = len(table.columns)
    caption = f"{text_tex(table.caption)}\n\n" if table.caption else ""
    head = ""
    headings = [rf"\textbf{{{text_tex(column)}}}" if column else "" for column in table.columns]
    if any(map(_words, table.columns)):
        head = rf"\hline {' & '.join(headings)} \\ \hline \endhead"
    rows = "\n".join(" & ".join(map(text_tex, row)) + r" \\" for row in table.rows)
    kinds = "".join(_columns(table, count))
    return f"{caption}\\begin{{longtable}}{{{kinds}}}{head}\n{rows}\n\\end{{longtable}}"


def _columns(table: Table, count: int) -> list[str]:
    """Column kinds: what is long is set in paragraphs, their widths in proportion to what is in them."""
    lengths = [max([len(_words(row[k])) for row in table.rows] + [len(_words(table.columns[k]))]) for k in range(count)]
    if sum(lengths) + 3 * count <= LINE:
        return ["r" if k in table.numeric else "l" for k in range(count)]
    capped = [min(max(length, 7), 45) for length in lengths]
    share = [0.93 * size / sum(capped) for size in capped]
    return [rf">{{\raggedright\arraybackslash}}p{{{width:.3f}\linewidth}}" for width in share]


LINE = 84
"""Characters of a line, about."""


def _words(text: Text) -> str:
    return "".join(p if isinstance(p, str) else latex(p.node)[:24] if isinstance(p, Maths) else p.text for p in text)


def _figure(figure: Figure) -> str:
    width = 0.62 if len(figure.panels) == 1 else 0.485
    images = "\n".join(rf"\includegraphics[width={width}\linewidth]{{{name}.pdf}}" for name in figure.files())
    caption = rf"\\ \textit{{{text_tex(figure.caption)}}} {latex_text(figure.description)}"
    return rf"\begin{{flushleft}}{images}{caption}\end{{flushleft}}"


def text_tex(text: Text) -> str:
    """A line of text with what stands in it."""
    return "".join(map(_inline, text))


def _inline(piece: Inline) -> str:
    if isinstance(piece, str):
        return latex_text(piece)
    if isinstance(piece, Maths):
        return f"${latex(piece.node)}$"
    if isinstance(piece, Number):
        return _number(piece.text)
    if isinstance(piece, Code):
        return rf"\texttt{{{_breakable(piece.text)}}}"
    if isinstance(piece, Link):
        return latex_text(piece.text) if piece.target.startswith("#") else rf"\texttt{{{latex_text(piece.text)}}}"
    return rf"\textbf{{{latex_text(piece.text)}}}" if isinstance(piece, Strong) else latex_text(piece.text)


def _breakable(text: str) -> str:
    """A command or formula that may end a line after an operator."""
    broken = latex_text(text)
    for sign in ("*", "/", "(", ")", ",", "="):
        broken = broken.replace(sign, sign + r"\allowbreak{}")
    return broken


_RAISED = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def _number(text: str) -> str:
    """Powers of ten as an exponent."""
    mantissa, power, exponent = text.partition("10")
    if power and exponent and all(c in "⁻⁰¹²³⁴⁵⁶⁷⁸⁹" for c in exponent):
        return rf"{latex_text(mantissa)}\ensuremath{{10^{{{exponent.translate(_RAISED)}}}}}"
    return latex_text(text)
