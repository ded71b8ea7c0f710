"""Which module may import which: every import of the house, read from the source."""

import ast
import re
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

HOUSE = Path(__file__).parents[1]

GROUND = {
    "compilation",
    "errors",
    "estimate",
    "exact_shares",
    "interrupts",
    "intervals",
    "literals",
    "json_form",
    "moments",
    "order_statistics",
    "places",
    "provenance",
    "tails",
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
    {"upkeep", "exploring"},
    {"indices"},
    {"analysis"},
    {"drawing", "plots"},
    {"report"},
    {"cli"},
)
"""Modules and packages of ``uq``, from the ground up: a layer may use itself and what is below."""

STRANGERS = {
    (above, below)
    for above in ("indices", "analysis", "drawing", "report")
    for below in ("running", "upkeep", "exploring")
} | {("upkeep", "exploring"), ("exploring", "upkeep")}
"""What may not use the other although it stands above."""

STOREYS = {
    "beam": (
        {"parameters"},
        {"structure"},
        {"exact", "lanes"},
        {"start"},
        {"response"},
        {"wear"},
        {"units"},
        {"batch", "trajectory"},
        {"branches"},
        {"explore"},
        {"paper"},
    ),
    "vibrator": (
        {"parameters"},
        {"theory"},
        {"equations"},
        {"lanes", "exact"},
        {"start"},
        {"paper", "batch", "trajectory"},
    ),
    "mole": (
        {"parameters"},
        {"theory"},
        {"exact", "lanes"},
        {"response"},
        {"batch", "trajectory"},
        {"explore"},
        {"paper"},
    ),
}
"""Modules and packages of each machine, from the ground up: one may use itself and those below."""

SIDE_BY_SIDE = 12
"""Modules that one folder of a machine may hold, its ``__init__`` apart."""


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
        in (foreign if "explore" in name.split(".") else foreign | allowed_in_explore)
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


def test_every_machine_has_its_storeys_here():
    assert {path.parent.name for path in HOUSE.glob("models/*/parameters.py")} == set(STOREYS)


@pytest.mark.parametrize("machine", STOREYS)
def test_a_machine_depends_one_way(machine):
    height = {name: i for i, names in enumerate(STOREYS[machine]) for name in names}
    package = ["models", machine]
    guilty = set()
    for name, found in edges(f"models/{machine}").items():
        here = name.split(".")[2:3]
        if not here:  # MODEL, which imports what it declares, and the rest when it computes
            continue
        for other in found:
            parts = other.split(".")
            if parts[:2] == package and parts[2:3] != here:
                below = height.get(".".join(parts[2:3]), len(height))
                guilty |= {(name, other)} if below >= height[here[0]] else set()
    assert not guilty


@pytest.mark.parametrize("machine", STOREYS)
def test_few_files_stand_side_by_side(machine):
    folder = HOUSE / "models" / machine
    files = [path.parent for path in folder.rglob("*.py") if path.name != "__init__.py"]
    assert {place for place in files if files.count(place) > SIDE_BY_SIDE} == set()


@pytest.mark.parametrize("machine", STOREYS)
def test_each_package_says_what_to_read(machine):
    silent = set()
    for path in (HOUSE / "models" / machine).rglob("*.py"):
        package = path.parent if path.name != "__init__.py" else path.parent.parent
        name = path.stem if path.name != "__init__.py" else path.parent.name
        if package != HOUSE / "models":
            said = ast.get_docstring(ast.parse((package / "__init__.py").read_text()))
            silent |= set() if re.search(rf"\b{name}\b", said) else {path}
    assert silent == set()


def test_the_platform_depends_one_way():
    guilty = set()
    for name, found in edges("uq").items():
        if name in ("uq", "uq.__main__"):  # these name everything, lazily
            continue
        here, layer = place_of(name)
        for other in found:
            if other.split(".")[0] != "uq" or other in ("uq", "uq.__version__"):
                continue
            there, below = place_of(other)
            if below > layer or (here, there) in STRANGERS:
                guilty.add((name, other))
    assert not guilty


def test_a_worker_imports_no_more_than_it_needs():
    heavy = "{'pydantic', 'scipy', 'xarray'}"
    program = f"import sys, uq.running.dask_task; print(*{heavy} & set(sys.modules))"
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
