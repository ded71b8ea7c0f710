"""Compiled code is kept for each machine: an edit reaches all that it concerns, and only that."""

import ast
import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

from models.numerics import cache

NUMERICS = Path(cache.__file__).parent

SHARED = """
from house.numerics.jit import kernel

@kernel
def scaled(x):
    return 1.0 * x

def last_of(pair):
    @kernel
    def last(x):
        return pair(scaled(x), -scaled(x)).last
    return last
"""
HELPER = """
from typing import NamedTuple

from house.numerics.jit import kernel

class Pair(NamedTuple):
    first: float
    last: float

@kernel
def rate(x):
    return {factor} * x
"""
MACHINE = """
from house.numerics.jit import kernel
from house.numerics.shared import last_of, scaled
from house.{name}.parts.helper import Pair, rate

last = last_of(Pair)

@kernel
def run(x):
    return rate(scaled(x))

@kernel
def end(x):
    return last(x)
"""
OUTSIDE = """
from house.numerics.jit import kernel
from plant.helper import rate

@kernel
def run(x):
    return rate(x)
"""


@pytest.fixture
def house(tmp_path, monkeypatch):
    """Build two machines on a copy of what compiles ours, and a package from outside."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # an edit may come within a second
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("jit", "cache"):
        text = (NUMERICS / f"{name}.py").read_text().replace("models.", "house.")
        written(tmp_path / "house/numerics" / f"{name}.py", text)
    written(tmp_path / "house/numerics/shared.py", SHARED)
    for name in ("beam", "mole"):
        written(tmp_path / f"house/{name}/motion.py", MACHINE.format(name=name))
        written(tmp_path / f"house/{name}/parts/helper.py", HELPER.format(factor=3.0))
    written(tmp_path / "plant/motion.py", OUTSIDE)
    written(tmp_path / "plant/helper.py", HELPER.format(factor=3.0))
    for folder in ("house", "house/numerics", "house/beam", "house/mole", "plant"):
        (tmp_path / folder / "__init__.py").touch()
    yield tmp_path
    forget()


def written(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def edit(file, old, new):
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def forget():
    for name in [name for name in sys.modules if name.partition(".")[0] in ("house", "plant")]:
        del sys.modules[name]


def result(package, function="run"):
    """Return what a new process would compute, and whether it need not compile."""
    forget()
    importlib.invalidate_caches()
    run = getattr(importlib.import_module(f"{package}.motion"), function)
    return run(1.0), bool(run.stats.cache_hits)


def test_an_edit_of_one_machine_leaves_another_warm(house):
    for package in ("house.beam", "house.mole", "plant"):
        assert result(package) == (3.0, False)
    edit(house / "house/mole/parts/helper.py", "class Pair", "# a word\nclass Pair")
    assert result("house.mole") == (3.0, False)
    assert result("house.beam") == result("plant") == (3.0, True)


def test_an_edit_of_a_helper_takes_effect_at_once(house):
    for package, helper in (("house.beam", "house/beam/parts"), ("plant", "plant")):
        assert [result(package) for _ in range(2)] == [(3.0, False), (3.0, True)]
        edit(house / helper / "helper.py", "3.0 * x", "5.0 * x")
        assert result(package) == (5.0, False)


def test_an_edit_while_a_process_runs_leaves_nothing_stale(house):
    """What it imported before and what it imports after are of no one state of the sources."""
    shared = house / "house/numerics/shared.py"
    written(house / "house/numerics/early.py", SHARED)
    forget()
    importlib.import_module("house.numerics.early")
    edit(shared, "1.0 * x", "-10.0 * x")
    assert importlib.import_module("house.beam.motion").run(1.0) == -30.0
    edit(shared, "-10.0 * x", "1.0 * x")
    assert result("house.beam") == (3.0, False)


def test_a_package_from_outside_may_use_a_machine(house):
    edit(house / "plant/motion.py", "plant.helper", "house.beam.parts.helper")
    assert result("plant") == (3.0, False)
    edit(house / "house/mole/parts/helper.py", "3.0 * x", "5.0 * x")
    assert result("plant") == (3.0, True)
    edit(house / "house/beam/parts/helper.py", "3.0 * x", "5.0 * x")
    assert result("plant") == (5.0, False)


def test_an_edit_of_what_they_share_reaches_all(house):
    packages = ("house.beam", "house.mole", "plant")
    assert [result(package) for package in packages] == 3 * [(3.0, False)]
    edit(house / "house/numerics/shared.py", "1.0 * x", "2.0 * x")
    assert [result(package) for package in packages] == [(6.0, False), (6.0, False), (3.0, False)]


def test_what_a_factory_makes_belongs_to_what_it_was_made_for(house):
    assert result("house.beam", "last") == (-1.0, False)
    assert result("house.beam", "last") == (-1.0, True)
    helper = house / "house/beam/parts/helper.py"
    edit(helper, "first: float\n    last: float", "last: float\n    first: float")
    assert result("house.beam", "last") == (1.0, False)
    assert result("house.beam", "end") == (1.0, False)


def fields_of_arguments(source):
    """Yield the attributes of their arguments that kernels read, but for those of arrays."""
    kernels = (
        node
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.FunctionDef)
        and {"kernel", "lean", "inlined"}
        & {ast.unparse(decorator) for decorator in node.decorator_list}
    )
    for function in kernels:
        arguments = {argument.arg for argument in function.args.args}
        for node in ast.walk(function):
            owner = node
            while isinstance(owner, ast.Attribute | ast.Subscript):
                owner = owner.value
            is_read = isinstance(node, ast.Attribute) and not hasattr(np.ndarray, node.attr)
            if is_read and isinstance(owner, ast.Name) and owner.id in arguments:
                yield f"{function.name}: {ast.unparse(node)}"


def test_kernels_that_machines_share_read_no_field_of_an_argument():
    """It could be that of a machine's tuple, whose edits leave the shared kernel as it is."""
    fields = [
        field for path in NUMERICS.glob("*.py") for field in fields_of_arguments(path.read_text())
    ]
    assert fields == []
    reading = "@kernel\ndef rate(y, p):\n    return y.size * p[0].stiffness"
    assert [*fields_of_arguments(reading)] == ["rate: p[0].stiffness"]
