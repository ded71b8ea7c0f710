"""Which module may import which: every import of the house, read from the source."""

import ast
import re
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from layers import (
    DEFERRED,
    MACHINES,
    READERS,
    RUNNERS,
    edges,
    imports_between_packages,
    place_of,
    reading_order,
)

HOUSE = Path(__file__).parents[1]

SIDE_BY_SIDE = 12
"""Modules that one folder of a machine may hold, its ``__init__`` apart."""


def test_the_platform_knows_no_machine():
    guilty = {
        (name, other)
        for name, imports in edges("uq").items()
        for other in imports
        if other.split(".")[0] in ("models", "tests", "benchmarks")
    }
    assert not guilty


def test_a_model_imports_nothing_of_the_platform_but_the_contract():
    guilty = {
        (name, other)
        for name, imports in edges("models").items()
        for other in imports
        if other.split(".")[0] == "uq" and other.split(".")[:2] != ["uq", "contract"]
    }
    assert not guilty


def test_models_know_neither_dask_nor_files_nor_xarray():
    allowed_in_explore = {"xarray", "pandas", "matplotlib"}
    foreign = {"dask", "distributed", "netCDF4", "pydantic", "typer", "rich", "SALib"}
    guilty = {
        (name, other)
        for name, imports in edges("models").items()
        for other in imports
        if other.split(".")[0]
        in (foreign if "explore" in name.split(".") else foreign | allowed_in_explore)
    }
    assert not guilty


def test_one_machine_does_not_import_another():
    shared = "numerics"
    guilty = set()
    for name, imports in edges("models").items():
        machine = name.split(".")[1:2]
        for other in imports:
            parts = other.split(".")
            if parts[0] == "models" and len(parts) > 1 and parts[1:2] not in (machine, [shared]):
                guilty.add((name, other))
    assert not guilty


ORDERED = [
    str(path.parent.relative_to(HOUSE))
    for top in ("models", "uq")
    for path in sorted((HOUSE / top).rglob("__init__.py"))
    if "imports only those above it" in path.read_text()
]
"""Packages that state their order."""


def test_every_machine_and_package_states_its_reading_order():
    packages = {
        str(path.parent.relative_to(HOUSE)) for path in (HOUSE / "uq").rglob("*/__init__.py")
    }
    assert {f"models/{machine}" for machine in MACHINES} | packages <= set(ORDERED)


@pytest.mark.parametrize("package", ORDERED)
def test_a_package_depends_one_way(package):
    order = reading_order(package)
    guilty = set()
    for module, here, name, there in _inside(package):
        in_face = there not in order and not _is_module(package, there)
        if in_face or here == "__main__" or (module, name) in DEFERRED:
            continue
        apart = {here, there} == {"exact", "lanes"} or there == "paper"
        if apart or order.index(there) >= order.index(here):
            guilty.add((module, name))
    assert not guilty


def _is_module(package, name):
    """Whether a name is a module or a package, not a function of the package itself."""
    return any((HOUSE / package / name).with_suffix(end).exists() for end in ("", ".py"))


def _inside(package):
    """Yield the imports of a package between what it holds: from where, of what."""
    path = package.split("/")
    for module, names in edges(package).items():
        here = module.split(".")[len(path) :][:1]
        for name in names:
            parts = name.split(".")
            there = parts[len(path) :][:1]
            # The package itself declares MODEL, and imports the rest when it computes.
            if here and there and parts[: len(path)] == path and there != here:
                yield module, here[0], name, there[0]


@pytest.mark.parametrize("machine", MACHINES)
def test_few_files_stand_side_by_side(machine):
    folder = HOUSE / "models" / machine
    files = [path.parent for path in folder.rglob("*.py") if path.name != "__init__.py"]
    assert {place for place in files if files.count(place) > SIDE_BY_SIDE} == set()


@pytest.mark.parametrize("machine", MACHINES)
def test_each_package_says_what_to_read(machine):
    silent = set()
    for path in (HOUSE / "models" / machine).rglob("*.py"):
        package = path.parent if path.name != "__init__.py" else path.parent.parent
        name = path.stem if path.name != "__init__.py" else path.parent.name
        if package != HOUSE / "models":
            docstring = ast.get_docstring(ast.parse((package / "__init__.py").read_text()))
            silent |= set() if re.search(rf"\b{name}\b", docstring) else {path}
    assert silent == set()


def test_the_platform_depends_one_way():
    guilty = {
        (module, name)
        for module, name, here, there in imports_between_packages()
        if place_of(name)[1] >= place_of(module)[1] or (here in READERS and there in RUNNERS)
    }
    assert not guilty


GIVEN_BY_USERS = {
    "uq.explore.basins",
    "uq.explore.single_rows",
    "uq.execution.child",
    "uq.execution.loading",
    "uq.study.definition",
}
"""Modules that load a model by what a user gave, or by a `Study` made from it."""


def test_code_is_reached_by_what_a_user_gave_alone():
    reach = {"uq.study.installed_models.model_at", "uq.machines.program.machine_of"}
    reach |= {"uq.machines.server.server_model", "uq.machines.program.program_of"}
    importers = {name for name, names in edges("uq").items() if names & reach}
    chooser = "uq.study.installed_models"  # itself in `reach`
    assert importers == {*GIVEN_BY_USERS, chooser}


def test_a_worker_imports_no_more_than_it_needs():
    heavy = "{'pydantic', 'scipy', 'xarray'}"
    program = f"import sys, uq.execution.dask_task; print(*{heavy} & set(sys.modules))"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.stdout, ended.stderr) == ("\n", "")


@pytest.mark.parametrize("package", ["uq", "models"])
def test_no_circle_of_imports(package):
    graph = edges(package, when_loaded=True)
    needs = {
        name: {module for other in imports if (module := _module_of(other, graph))}
        for name, imports in graph.items()
    }
    assert set(TopologicalSorter(needs).static_order()) == set(graph)


def _module_of(dotted, modules):
    """Return the module that an import names, be it the module itself or a name in it."""
    candidates = (dotted, dotted.rpartition(".")[0])
    return next((name for name in candidates if name in modules), None)


WITHOUT_A_NOUN = {"one", "found", "known", "said", "own"}
"""Names that do not tell what they hold: a variable is called by the noun of the field."""

NAMED = ("benchmarks", "models", "tests", "uq")
"""Folders whose variables are all named for what they hold."""


@pytest.mark.parametrize("folder", NAMED)
def test_variables_are_named_for_what_they_hold(folder):
    nameless = [
        f"{path.relative_to(HOUSE)}:{node.lineno}: {name}"
        for path in sorted((HOUSE / folder).rglob("*.py"))
        if re.search(rf"\b({'|'.join(WITHOUT_A_NOUN)})\b", text := path.read_text())
        for node in ast.walk(ast.parse(text))
        if (name := _named_by(node)) in WITHOUT_A_NOUN
    ]
    assert nameless == []


def _named_by(node):
    """Return the name that a node gives to a variable, an argument, a function or an import."""
    match node:
        case ast.Name(id=name, ctx=ast.Store()) | ast.arg(arg=name):
            return name
        case ast.FunctionDef(name=name) | ast.alias(asname=name) | ast.ExceptHandler(name=name):
            return name
    return None


MOST_MODULES, MOST_PACKAGES = 300, 14
"""What a newcomer can still take in."""


def test_the_platform_stays_small():
    modules = list((HOUSE / "uq").rglob("*.py"))
    packages = [path for path in (HOUSE / "uq").iterdir() if (path / "__init__.py").exists()]
    assert len(modules) <= MOST_MODULES
    assert len(packages) <= MOST_PACKAGES


def test_no_class_name_is_used_twice():
    trees = (ast.parse(path.read_text()) for path in (HOUSE / "uq").rglob("*.py"))
    names = [node.name for tree in trees for node in tree.body if isinstance(node, ast.ClassDef)]
    assert {name for name in names if names.count(name) > 1} == set()
