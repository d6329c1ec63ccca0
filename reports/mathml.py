"""Formulas as MathML, as a page holds them."""

from __future__ import annotations

from gks.reports.formulas import Node, split_name


def mathml(node: Node, *, block: bool = False) -> str:
    """A `math` element; its text equivalent is the tree itself, which screen readers speak."""
    display = ' display="block"' if block else ""
    return f"<math{display}>{_element(node)}</math>"


_TEMPLATES = {
    "fraction": "<mfrac>{0}{1}</mfrac>",
    "power": "<msup>{0}{1}</msup>",
    "index": "<msub>{0}{1}</msub>",
    "root": "<msqrt>{0}</msqrt>",
}


def _element(node: Node) -> str:
    if not node.parts:
        return _leaf(node)
    if node.kind in ("matrix", "cases"):
        return _table(node)
    if node.kind == "power" and node.parts[0].kind == "index":
        base, below, above = (_element(part) for part in (*node.parts[0].parts, node.parts[1]))
        return f"<msubsup>{base}{below}{above}</msubsup>"
    parts = [_element(part) for part in node.parts]
    if node.kind == "fence":
        # Stretched parentheses keep a distance; around what is one line high they need none.
        stretch = "" if _high(node) else ' stretchy="false" lspace="0" rspace="0"'
        return f"<mrow><mo{stretch}>(</mo>{parts[0]}<mo{stretch}>)</mo></mrow>"
    if node.kind in _TEMPLATES:
        return _TEMPLATES[node.kind].format(*parts)
    if node.kind == "call":
        return f"<mrow>{parts[0]}<mo>(</mo>{'<mo>,</mo>'.join(parts[1:])}<mo>)</mo></mrow>"
    return f"<mrow>{''.join(parts)}</mrow>"


def _high(node: Node) -> bool:
    return node.kind in ("fraction", "root", "matrix", "cases") or any(map(_high, node.parts))


def _leaf(node: Node) -> str:
    if node.kind == "name":
        return _identifier(node.text)
    if node.kind == "words":
        return f"<mtext>{escaped(node.text).replace(' ', chr(160))}</mtext>"
    tag = {"number": "mn", "operator": "mo"}.get(node.kind, "mrow")
    return f"<{tag}>{escaped(node.text)}</{tag}>"


def _table(node: Node) -> str:
    rows = ("".join(f"<mtd>{_element(entry)}</mtd>" for entry in each.parts) for each in node.parts)
    inner = "".join(f"<mtr>{cells}</mtr>" for cells in rows)
    if node.kind == "cases":
        return f'<mrow><mo>{{</mo><mtable class="cases">{inner}</mtable></mrow>'
    return f"<mrow><mo>[</mo><mtable>{inner}</mtable><mo>]</mo></mrow>"


def _identifier(text: str) -> str:
    symbol, index = split_name(text)
    base = f"<mn>{symbol}</mn>" if symbol == "∞" else f"<mi>{escaped(symbol)}</mi>"
    return f"<msub>{base}<mi>{escaped(index)}</mi></msub>" if index else base


def escaped(text: str) -> str:
    """Text as HTML has it between tags."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
