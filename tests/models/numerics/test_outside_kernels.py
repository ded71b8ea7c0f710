"""A kernel from elsewhere is compiled anew when anything that it may call was edited."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from models.numerics import cache

ROOT = Path(__file__).resolve().parents[3]

HELPER = """
from models.numerics.jit import kernel

@kernel
def rate(x):
    return {factor} * x
"""
CALLER = """
from models.numerics.jit import kernel
from {helper} import rate

@kernel
def twice(x):
    return 2.0 * rate(x)
"""
CALL = "from plant.kern import twice; print(twice(1.0), sum(twice.stats.cache_hits.values()))"


def written(folder, name, text):
    """Write a module, with the packages that it lies in; return its file."""
    file = folder.joinpath(*name.split(".")).with_suffix(".py")
    file.parent.mkdir(parents=True, exist_ok=True)
    for package in file.parents[: name.count(".")]:
        (package / "__init__.py").touch()
    file.write_text(text)
    return file


@pytest.mark.slow
def test_an_edited_helper_takes_effect(tmp_path):
    written(tmp_path, "plant.kern", CALLER.format(helper="plant.parts.helper"))
    helper = written(tmp_path, "plant.parts.helper", HELPER.format(factor=3.0))
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": path}

    def called():
        command = [sys.executable, "-c", CALL]
        ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return ended.stdout.split()

    assert called() == ["6.0", "0"]
    assert called() == ["6.0", "1"]
    helper.write_text(HELPER.format(factor=5.0))
    assert called() == ["10.0", "0"]


@pytest.fixture
def modules_of_its_own():
    """Forget the modules that a test imports from its folder, before it and after."""

    def forget():
        for name in list(sys.modules):
            if name.partition(".")[0] in ("plant", "kern"):
                del sys.modules[name]

    forget()
    yield
    forget()


@pytest.mark.usefixtures("modules_of_its_own")
@pytest.mark.parametrize(
    ("caller", "helper", "counts"),
    [
        ("plant.kern", "plant.parts.helper", True),
        ("kern", "helper", True),
        ("kern", "parts.helper", True),
        ("plant.kern", "other.helper", False),
        ("kern", "site-packages.helper", False),
    ],
)
def test_a_kernel_is_cached_by_what_it_can_import(tmp_path, monkeypatch, caller, helper, counts):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.syspath_prepend(tmp_path)
    written(tmp_path, caller, "def function(x):\n    return x\n")
    file = written(tmp_path, helper, "a = 1\n")
    (tmp_path / "site-packages" / "__init__.py").unlink(missing_ok=True)
    function = importlib.import_module(caller).function
    before = cache.folder_of(function)
    assert before.is_dir()
    file.write_text("a = 22\n")
    assert cache.folder_of(function) == (None if counts else before)
    cache._snapshot.cache_clear()  # as in the next process
    after = cache.folder_of(function)
    assert after.is_dir()
    assert (after != before) == counts
