"""The layers of the house, the storeys of its machines, and what the source really imports.

The tests refuse an import that these forbid; the picture of the house is drawn from them.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

HOUSE = Path(__file__).parents[1]

LAYERS = (
    ("contract",),
    ("text",),
    ("files",),
    ("sampling", "stats"),
    ("indices", "machines"),
    ("study",),
    ("result",),
    ("assess",),
    ("execution", "learning"),
    ("explore",),
    ("render",),
    ("cli",),
)
"""Packages of ``uq``, from the ground up: one may import itself and those of the layers below.

``errors`` counts as part of ``contract``, and ``plots``, the face of the figures, as ``render``.
"""

READERS = ("assess", "learning", "render")
"""Packages that read results, and therefore import none of the `RUNNERS`."""

RUNNERS = ("execution", "explore")
"""Packages that run models."""

DEFERRED = {
    ("uq.assess.answer.answer_sentences", "uq.render.html.answer.notebook"),
    ("uq.render.html.pictures", "uq.plots.FIGURES"),
}
"""Imports upwards: an answer shows itself in a notebook; `plots` is the face of the figures."""

MACHINES = tuple(sorted(path.parent.name for path in HOUSE.glob("models/*/parameters.py")))


def reading_order(package: str) -> list[str]:
    """Return what a package says of itself: its modules and packages, each above what uses it."""
    said = ast.get_docstring(ast.parse((HOUSE / package / "__init__.py").read_text())) or ""
    return re.findall(r"^ {4}(\w+) {2,}\S", said, re.MULTILINE)


@cache
def _tree(path: Path) -> ast.Module:
    """Return the syntax tree of a module, parsed once for all packages that it is in."""
    return ast.parse(path.read_text())


@cache
def modules(package: str) -> tuple[tuple[str, ast.Module], ...]:
    """Return the dotted name and the syntax tree of every module of a package."""
    found = []
    for path in sorted((HOUSE / package).rglob("*.py")):
        parts = path.relative_to(HOUSE).with_suffix("").parts
        name = ".".join(part for part in parts if part != "__init__")
        found.append((name, _tree(path)))
    return tuple(found)


def imports(tree: ast.AST, when_loaded: bool = False) -> Iterator[str]:
    """Yield the dotted name of all that a module imports; names from a module come with it.

    Only what runs when the module is loaded, if so wished: not what functions import, not types.
    """
    for node in ast.iter_child_nodes(tree):
        later = isinstance(node, ast.FunctionDef) or (
            isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
        )
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"relative import of {node.module}"
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif not (when_loaded and later):
            yield from imports(node, when_loaded)


@cache
def edges(package: str, when_loaded: bool = False) -> dict[str, set[str]]:
    """Return module -> names it imports, for one package."""
    return {name: set(imports(tree, when_loaded)) for name, tree in modules(package)}


@cache
def place_of(dotted: str) -> tuple[str, int]:
    """Return the package of ``uq`` that a dotted name is in, and the number of its layer."""
    name = dotted.split(".")[1]
    name = {"plots": "render", "errors": "contract"}.get(name, name)
    found = [number for number, names in enumerate(LAYERS) if name in names]
    assert found, f"{dotted}: put the new package into LAYERS of docs/layers.py"
    return name, found[0]


def imports_between_packages() -> Iterator[tuple[str, str, str, str]]:
    """Yield a module of ``uq``, what it imports of another package, and the two packages."""
    for module, names in edges("uq").items():
        if module in ("uq", "uq.__main__"):  # these name everything, lazily
            continue
        here, _ = place_of(module)
        for name in sorted(names):
            if name.split(".")[0] == "uq" and name not in ("uq", "uq.__version__"):
                there, _ = place_of(name)
                if there != here and (module, name) not in DEFERRED:
                    yield module, name, here, there
