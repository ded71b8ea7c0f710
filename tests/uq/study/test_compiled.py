"""Compiled code of a model is of its present sources, also where numba alone keeps it."""

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from wordings import sentence

import models
from uq.study.compiled_cache import SourcesLocator, keep_apart
from uq.study.sources import signature

COMMAND = Path(sys.executable).with_name("uq")

HELPER = """
import numba

@numba.njit(cache=True)
def rate(x):
    return {factor} * x
"""
CALLER = """
import numba
from plant.helper import rate

@numba.njit(cache=True)
def twice(x):
    return 2.0 * rate(x)
"""
MODEL = """
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from plant.kern import twice
from uq.contract import Model, Output, Parameter


class Parameters(NamedTuple):
    x1: Annotated[float, Parameter("x_1", "1", "input", (0.0, 1.0), "made up")] = 0.5


@dataclass(frozen=True)
class Settings:
    pass


def batch(x, seed, settings):
    return {"y": np.array([twice(value) for value in x[:, 0]])}, np.zeros(len(x), np.int8)


MODEL = Model(
    name="plant",
    title="plant",
    version="1",
    parameters=Parameters,
    settings=Settings,
    outputs={"y": Output("1", "a number")},
    batch=batch,
)
"""


@pytest.fixture
def plant(folder):
    (folder / "plant").mkdir()
    texts = {"__init__": "", "model": MODEL, "kern": CALLER, "helper": HELPER.format(factor=3.0)}
    for name, text in texts.items():
        (folder / "plant" / f"{name}.py").write_text(text)
    return folder / "plant"


@pytest.fixture
def kern(plant, monkeypatch):
    """Import a module that calls compiled code of another."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(plant.parent / "cache"))
    monkeypatch.syspath_prepend(plant.parent)
    keep_apart("plant")
    yield importlib.import_module("plant.kern")
    for name in ("plant", "plant.kern", "plant.helper"):
        del sys.modules[name]


@pytest.mark.parametrize("base", ["", "theirs"])
def test_an_edited_helper_has_another_folder(kern, plant, monkeypatch, base):
    import numba

    monkeypatch.setattr(numba.config, "CACHE_DIR", base and str(plant.parent / base))

    def folder():
        return numba.njit(cache=True)(kern.twice.py_func)._cache.cache_path

    before = folder()
    assert Path(before).is_relative_to(plant.parent / (base or "cache"))
    assert folder() == before
    (plant / "model.py").write_text("# it calls, and is not called\n")
    assert folder() == before
    (plant / "helper.py").write_text(HELPER.format(factor=5.0))
    assert folder() != before


def test_our_own_kernels_stay_where_they_are(kern):
    from models.numerics import cache
    from models.numerics.multipliers import _square

    assert cache.folder_of(_square).name in Path(_square._cache.cache_path).parts
    assert SourcesLocator.from_function(_square.py_func, cache.__file__) is None


def test_of_our_machines_those_count_that_a_package_imports():
    def machines(*imported):
        files = (Path(name) for name, _, _ in signature("models", set(imported)))
        folders = (file.relative_to(Path(models.__file__).parent).parts[0] for file in files)
        return set(folders) - {"__init__.py"}

    assert machines("models.numerics.jit.kernel") == {"numerics"}
    assert machines("models.beam.batch") == {"numerics", "beam"}
    assert machines("models.analytic") == {"numerics", "analytic.py"}


@pytest.mark.slow
@pytest.mark.parametrize("decorator", ["numba.njit(cache=True)", "kernel"])
def test_edited_code_gives_new_numbers_and_says_so(plant, write_study, decorator):
    for name in ("kern", "helper"):
        file = plant / f"{name}.py"
        text = file.read_text().replace("@numba.njit(cache=True)", f"@{decorator}")
        file.write_text(f"from models.numerics.jit import kernel\n{text}")
    study = write_study(model="plant", uncertain=("x1",), samples=3)
    environment = os.environ | {"XDG_CACHE_HOME": str(plant.parent / "cache")}
    environment.pop("PYTHONPATH", None)

    def call(verb, *arguments):
        command = [COMMAND, verb, *map(str, arguments), "--model", "plant.model:MODEL"]
        return subprocess.run(command, env=environment, capture_output=True, text=True)

    def factor():
        command = [COMMAND, "simulate", "plant.model:MODEL", "--json"]
        out = subprocess.run(command, env=environment, capture_output=True, check=True).stdout
        return json.loads(out)["outputs"]["y"] / 0.5

    assert factor() == 6.0
    assert call("run", study, "--quiet").returncode == 0
    output = call("verify", "results/small.nc").stdout
    assert "versions  the same as here" in output, output
    assert "3 of 3 recomputed are equal to the bit" in output
    helper = plant / "helper.py"
    helper.write_text(helper.read_text().replace("3.0", "5.0"))
    assert factor() == 10.0
    ended = call("verify", "results/small.nc")
    assert ended.returncode == 1
    assert "0 of 3 recomputed" in ended.stdout
    shown = call("run", study, "--quiet")
    assert (shown.returncode, shown.stderr.count("\n")) == (0, 1)
    assert sentence("other code", model="plant") in shown.stderr
    assert call("run", study, "--quiet", "--fresh").stderr == ""
    assert "3 of 3 recomputed" in call("verify", "results/small.nc").stdout
