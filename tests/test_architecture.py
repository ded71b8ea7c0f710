"""Which module may import which: every import of the house, read from the source."""

import ast
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

HOUSE = Path(__file__).parents[1]

GROUND = {
    "columns",
    "compilation",
    "environment",
    "errors",
    "estimate",
    "exact_shares",
    "interrupts",
    "intervals",
    "literals",
    "moments",
    "places",
    "provenance",
    "tails",
    "threads",
    "time_units",
    "two_samples",
    "wording",
}

LAYERS = (
    {"contract"},
    GROUND,
    {"designs"},
    {"methods"},
    {"inputs"},
    {"study"},
    {"rows", "store"},
    {"running"},
    {"indices"},
    {"analysis"},
    {"drawing", "plots"},
    {"report"},
    {"cli"},
)
"""Modules and packages of ``uq``, from the ground up: a layer may use itself and what is below."""

STRANGERS = {
    ("indices", "running"),
    ("analysis", "running"),
    ("drawing", "running"),
    ("report", "running"),
}
"""What may not use the other although it stands above."""


def modules(package):
    """Yield the dotted name and the syntax tree of every module of a package."""
    for path in sorted((HOUSE / package).rglob("*.py")):
        parts = path.relative_to(HOUSE).with_suffix("").parts
        yield ".".join(part for part in parts if part != "__init__"), ast.parse(path.read_text())


def imports(tree, when_loaded=False):
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


def edges(package, when_loaded=False):
    """Return module -> names it imports, for one package."""
    return {name: set(imports(tree, when_loaded)) for name, tree in modules(package)}


def place_of(dotted):
    """Return a module or package of ``uq``, and the number of its layer."""
    name = dotted.split(".")[1]
    found = [number for number, names in enumerate(LAYERS) if name in names]
    assert found, f"{dotted}: put the new module into a layer of this test"
    return name, found[0]


def test_the_platform_knows_no_machine():
    guilty = {
        (name, other)
        for name, found in edges("uq").items()
        for other in found
        if other.split(".")[0] in ("models", "tests", "benchmarks")
    }
    assert not guilty


def test_a_model_imports_nothing_of_the_platform_but_the_contract():
    guilty = {
        (name, other)
        for name, found in edges("models").items()
        for other in found
        if other.split(".")[0] == "uq" and other.split(".")[:2] != ["uq", "contract"]
    }
    assert not guilty


def test_models_know_neither_dask_nor_files_nor_xarray():
    allowed_in_explore = {"xarray", "pandas", "matplotlib"}
    foreign = {"dask", "distributed", "netCDF4", "pydantic", "typer", "rich", "SALib"}
    guilty = {
        (name, other)
        for name, found in edges("models").items()
        for other in found
        if other.split(".")[0]
        in (foreign if name.endswith(".explore") else foreign | allowed_in_explore)
    }
    assert not guilty


def test_one_machine_does_not_import_another():
    shared = "numerics"
    guilty = set()
    for name, found in edges("models").items():
        own = name.split(".")[1:2]
        for other in found:
            parts = other.split(".")
            if parts[0] == "models" and len(parts) > 1 and parts[1:2] not in (own, [shared]):
                guilty.add((name, other))
    assert not guilty


def test_the_platform_depends_one_way():
    guilty = set()
    for name, found in edges("uq").items():
        if name in ("uq", "uq.__main__"):  # these name everything, lazily
            continue
        here, layer = place_of(name)
        for other in found:
            if other.split(".")[0] != "uq" or other == "uq":
                continue
            there, below = place_of(other)
            if below > layer or (here, there) in STRANGERS:
                guilty.add((name, other))
    assert not guilty


def test_a_worker_imports_no_more_than_it_needs():
    heavy = "{'pydantic', 'scipy', 'xarray'}"
    program = f"import sys, uq.running.task; print(*{heavy} & set(sys.modules))"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.stdout, ended.stderr) == ("\n", "")


@pytest.mark.parametrize("package", ["uq", "models"])
def test_no_circle_of_imports(package):
    graph = edges(package, when_loaded=True)
    needs = {
        name: {module for other in found if (module := _module_of(other, graph))}
        for name, found in graph.items()
    }
    assert set(TopologicalSorter(needs).static_order()) == set(graph)


def _module_of(dotted, known):
    """Return the module that an import names, be it the module itself or a name in it."""
    candidates = (dotted, dotted.rpartition(".")[0])
    return next((name for name in candidates if name in known), None)
