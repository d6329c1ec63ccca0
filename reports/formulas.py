"""Formulas as trees of presentation: read from the package's own formula text, written as text here, and elsewhere as
MathML (`mathml`) and LaTeX (`latex`).

The text is what the analyses print and sympy reads, `3/2 - sqrt(2)/(4*(alpha + 1))`. It is laid out as it stands:
nothing is evaluated and no term is moved, so that what a page shows is what was derived.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

LONGEST = 1500
"""Characters of a formula that is laid out; a longer one is shown as the text it is."""


@dataclass(frozen=True, slots=True)
class Node:
    """A piece of a formula.

    kind  "number", "name", "operator", "words"   with `text`
          "row", "fraction", "power", "index", "root", "fence", "call", "matrix", "cases"   with `parts`

    A "power" is (base, exponent), an "index" (base, index), a "call" (name, arguments...), a "matrix" its rows, each a
    "row", and "cases" rows of (what, where).
    """

    kind: str
    text: str = ""
    parts: tuple[Node, ...] = ()


class NotAFormula(ValueError):
    """The text is not a formula of the kind read here, or longer than is laid out."""


def number(text: object) -> Node:
    """A number as it is to be shown, or any other word that stands upright by itself."""
    return Node("number", str(text))


def name(text: str) -> Node:
    """A symbol."""
    return Node("name", text)


def operator(text: str) -> Node:
    """A sign between or before operands."""
    return Node("operator", text)


def words(text: str) -> Node:
    """Text inside a formula."""
    return Node("words", text)


def row(*parts: Node) -> Node:
    """Pieces side by side."""
    return parts[0] if len(parts) == 1 else Node("row", parts=parts)


def indexed(base: Node, below: Node, above: Node | None = None) -> Node:
    """A symbol with an index below it and, if given, one above."""
    with_index = Node("index", parts=(base, below))
    return with_index if above is None else Node("power", parts=(with_index, above))


def slashed(node: Node) -> Node:
    """A formula for a line of text: a quotient of two names with a slash, as a small fraction is hard to read."""
    parts = tuple(map(slashed, node.parts))
    if node.kind == "fraction" and not any(part.parts for part in parts):
        return row(parts[0], operator("/"), parts[1])
    return Node(node.kind, node.text, parts)


def matrix(rows: Sequence[Sequence[Node]]) -> Node:
    """A matrix in brackets."""
    return Node("matrix", parts=tuple(Node("row", parts=tuple(entries)) for entries in rows))


def cases(rows: Sequence[tuple[Node, Node]]) -> Node:
    """What holds, and where, behind one brace, which a single case can do without."""
    if len(rows) == 1:
        ((what, where),) = rows
        return row(what, words("   "), where) if where != words("") else what
    return Node("cases", parts=tuple(Node("row", parts=pair) for pair in rows))


def joined(parts: Sequence[Node], sign: str) -> Node:
    """The parts with the operator between them."""
    pieces: list[Node] = []
    for part in parts:
        pieces += [operator(sign), part] if pieces else [part]
    return row(*pieces)


def relation(left: Node, sign: str, right: Node) -> Node:
    """`left sign right`."""
    return row(left, operator(sign), right)


# Reading --------------------------------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"\s*(?:(?P<number>\d+(?:\.\d*)?(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<operator>\*\*|<=|[-+*/(),=<]))"
)

DEEPEST = 100
"""Nesting of parentheses that is laid out."""


def formula(text: str) -> Node:
    """The tree of a formula or of a chain of equations and inequalities; NotAFormula if it is neither."""
    if len(text) > LONGEST:
        raise NotAFormula(f"{len(text)} characters")
    reader = _Reader(list(_tokens(text)))
    tree = reader.relation()
    reader.expect("")
    return tree


def laid_out(text: str) -> Node:
    """The tree of a formula, or what can be said of a text that is none: its first characters."""
    try:
        return formula(text)
    except NotAFormula:
        return words(text if len(text) < SHORT else text[: SHORT - 1] + "…")


SHORT = 60
"""Characters of a text in the place of a formula."""


def _tokens(text: str) -> Iterator[tuple[str, str]]:
    place = 0
    text = text.rstrip()
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise NotAFormula(text[place : place + 20])
        yield match.lastgroup or "", match[match.lastgroup or 0]
        place = match.end()
    yield "end", ""


_SIGNS = {"<=": "≤", "<": "<", "=": "=", "-": "−", "+": "+"}


class _Reader:
    """Recursive descent over the tokens; chains are read in loops, nesting is limited."""

    def __init__(self, tokens: list[tuple[str, str]]) -> None:
        self.tokens, self.place, self.depth = tokens, 0, 0

    def take(self, *texts: str) -> str | None:
        """The next token if it is one of these."""
        kind, text = self.tokens[self.place]
        if kind != "operator" or text not in texts:
            return None
        self.place += 1
        return text

    def expect(self, text: str) -> None:
        kind, found = self.tokens[self.place]
        if found != text or (text == "" and kind != "end"):
            raise NotAFormula(f"{found or 'the end'} where {text or 'the end'} was expected")
        self.place += 1

    def relation(self) -> Node:
        parts = [self.sum()]
        while sign := self.take("=", "<", "<="):
            parts += [operator(_SIGNS[sign]), self.sum()]
        return row(*parts)

    def sum(self) -> Node:
        self.depth += 1
        if self.depth > DEEPEST:
            raise NotAFormula("nested too deep")
        parts: list[Node] = []
        sign = self.take("+", "-")
        if sign == "-":
            parts.append(operator("−"))
        parts.append(self.product())
        while sign := self.take("+", "-"):
            parts += [operator(_SIGNS[sign]), self.product()]
        self.depth -= 1
        return row(*parts)

    def product(self) -> Node:
        above, below = [self.factor()], list[Node]()
        while sign := self.take("*", "/"):
            (above if sign == "*" else below).append(self.factor())
        if not below:
            return _times(above)
        return Node("fraction", parts=(_bare(_times(above)), _bare(_times(below))))

    def factor(self) -> Node:
        if self.take("-"):
            return Node("fence", parts=(row(operator("−"), self.factor()),))
        base = self.atom()
        if not self.take("**"):
            return base
        negative = self.take("-")
        exponent = self.atom()
        return Node("power", parts=(base, row(operator("−"), exponent) if negative else exponent))

    def atom(self) -> Node:
        if self.take("("):
            inner = self.sum()
            self.expect(")")
            return Node("fence", parts=(inner,))
        kind, text = self.tokens[self.place]
        if kind not in ("number", "name"):
            raise NotAFormula(f"{text or 'the end'} where an operand was expected")
        self.place += 1
        if kind == "number":
            return number(text)
        return self.call(text) if self.take("(") else name(text)

    def call(self, function: str) -> Node:
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        self.expect(")")
        if function == "sqrt" and len(arguments) == 1:
            return Node("root", parts=(arguments[0],))
        if function == "exp" and len(arguments) == 1:
            return Node("power", parts=(name("e"), arguments[0]))
        return Node("call", parts=(name(function), *arguments))


def _times(factors: Sequence[Node]) -> Node:
    """Factors side by side: two numbers need a sign between them, a fence and a name only a thin space."""
    if len(factors) == 1:
        return factors[0]
    factors = [f for k, f in enumerate(factors) if k or f != number("1")]
    parts: list[Node] = []
    for factor in factors:
        if parts:
            parts.append(operator("·" if factor.kind in ("number", "fraction") else "\u2062"))
        parts.append(factor)
    return row(*parts)


def _bare(node: Node) -> Node:
    """Without the parentheses that a fraction's bar makes needless."""
    return node.parts[0] if node.kind == "fence" else node


# Plain text -----------------------------------------------------------------------------------------------------------

GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "pi": "π", "rho": "ρ", "sigma": "σ",
    "tau": "τ", "upsilon": "υ", "phi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω",
}  # fmt: skip

STEMS = {**GREEK, "lam": "λ", "oo": "∞"}


def split_name(text: str) -> tuple[str, str]:
    """(symbol, index) of a name as a file spells it: `kappa_R` is κ with the index R, `rho1` ρ with the index 1."""
    head, _, tail = text.partition("_")
    stem = head.rstrip("0123456789")
    if not tail and stem:
        tail = head[len(stem) :]
    else:
        stem = head
    return STEMS.get(stem, stem) or text, tail.replace("_", " ") if stem else ""


_THIN = {"\u2062": " ", "·": "·", "/": "/"}


_TEMPLATES = {"index": "{0}[{1}]", "root": "√({0})", "fence": "({0})"}


def plain(node: Node) -> str:
    """One line of text, for titles, descriptions and terminals."""
    if not node.parts:
        return _leaf(node)
    parts = [plain(part) for part in node.parts]
    if node.kind in _TEMPLATES:
        return _TEMPLATES[node.kind].format(*parts)
    if node.kind in ("fraction", "power"):
        return f"{_closed(node.parts[0])}{'/' if node.kind == 'fraction' else '^'}{_closed(node.parts[1])}"
    if node.kind == "call":
        return f"{parts[0]}({', '.join(parts[1:])})"
    if node.kind in ("matrix", "cases"):
        return "[" + "; ".join(" ".join(filter(None, map(plain, each.parts))) for each in node.parts) + "]"
    return "".join(parts).strip()


def _leaf(node: Node) -> str:
    if node.kind == "operator":
        return _THIN.get(node.text, f" {node.text} ")
    if node.kind != "name":
        return node.text
    symbol, index = split_name(node.text)
    return f"{symbol}_{index}" if index else symbol


def _closed(node: Node) -> str:
    text = plain(node)
    return f"({text})" if node.kind == "row" else text
