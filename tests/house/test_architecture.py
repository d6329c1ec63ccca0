"""Imports point one way, reports to campaigns to solvers to bounds to modes to scheme; what is slow is loaded late."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Each may import those before it.
LAYERS = ["gks.scheme", "gks.modes", "gks.bounds", "gks.solvers", "gks.campaigns", "gks.reports"]
SLOW = {"numpy", "scipy", "sympy", "matplotlib", "flint", "mpmath", "hypothesis", "distributed"}
FOLDERS = {"gks.solvers": ROOT / "solvers", "gks.reports": ROOT / "reports"}
START_UP = [f"gks/{name}.py" for name in ("__init__", "__main__", "cli", "commands", "outputs", "api", "files")]


def modules(layer: str) -> list[Path]:
    folder = FOLDERS.get(layer, ROOT / layer.replace(".", "/"))
    return sorted(folder.rglob("*.py"))


def imported(tree: ast.AST) -> Iterator[str]:
    """The modules that the statements under `tree` import, but for those that only a type checker sees."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module or ""
        elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        else:
            yield from imported(node)


def imported_on_load(tree: ast.Module) -> Iterator[str]:
    """As `imported`, but only what importing the module itself imports: nothing inside functions."""
    for node in tree.body:
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            yield from imported(ast.Module([node], []))


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_imports_only_those_below_it(layer: str) -> None:
    above = tuple(LAYERS[LAYERS.index(layer) + 1 :])
    for file in modules(layer):
        upward = [name for name in imported(ast.parse(file.read_text())) if name.startswith(above)]
        assert upward == [], f"{file.relative_to(ROOT)} imports {upward}"


@pytest.mark.parametrize("file", [*START_UP, *(str(f.relative_to(ROOT)) for f in modules("gks.scheme"))])
def test_start_up_and_reading_load_nothing_slow(file: str) -> None:
    slow = {name.split(".")[0] for name in imported_on_load(ast.parse((ROOT / file).read_text()))} & SLOW
    assert slow == set()


def test_the_check_sees_an_import_that_points_upward() -> None:
    tree = ast.parse("def late():\n    from gks.bounds.curve import curve\n")
    assert list(imported(tree)) == ["gks.bounds.curve"]
    assert list(imported_on_load(tree)) == []
