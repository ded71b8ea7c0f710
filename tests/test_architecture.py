"""Which module may import which: every import of the house, read from the source."""

import ast
import re
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

HOUSE = Path(__file__).parents[1]
sys.path.insert(0, str(HOUSE / "docs"))

from layers import (  # noqa: E402
    READERS,
    RUNNERS,
    STOREYS,
    edges,
    imports_between_packages,
    place_of,
)

SIDE_BY_SIDE = 12
"""Modules that one folder of a machine may hold, its ``__init__`` apart."""


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
    guilty = {
        (module, name)
        for module, name, here, there in imports_between_packages()
        if place_of(name)[1] >= place_of(module)[1] or (here in READERS and there in RUNNERS)
    }
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
