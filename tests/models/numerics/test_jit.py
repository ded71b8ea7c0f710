"""The bits of compiled code are a function of its source: no flag lets the compiler choose."""

import ast
import importlib
import os
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
from numba.core import caching
from numba.core.compiler import Flags
from numba.core.registry import CPUDispatcher

import models
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel, lean

FOLDER = Path(models.__file__).parent
FREEDOM = re.compile(r"\b(fast|reassoc|contract|arcp|afn|nsz|nnan|ninf)\b")


@inlined
def _product(a, b):
    return a * b


@lean
def _rest(a, b):
    return 1.0 - _product(a, b)


@kernel
def _algebra(x, out):
    for i in range(len(x)):
        out[i] += x[i] * x[i] + fma(x[i], 3.0, _rest(x[i], out[i]))


def modules():
    names = pkgutil.walk_packages(models.__path__, "models.")
    return [importlib.import_module(name) for _, name, _ in names if "__main__" not in name]


def test_no_option_of_the_compiler_moves_a_bit():
    compiled = {
        value
        for module in modules()
        for value in vars(module).values()
        if isinstance(value, CPUDispatcher)
    }
    assert len(compiled) > 100
    for function in compiled:
        options = function.targetoptions
        assert not options.get("fastmath") and not options.get("parallel"), function.py_func


def test_compiled_algebra_is_free_of_flags():
    fresh = numba.jit(**_algebra.targetoptions)(_algebra.py_func)  # cached code is not shown
    fresh(np.ones(5), np.ones(5))
    (code,) = fresh.inspect_llvm().values()
    assert "llvm.fma" in code and " fmul " in code and " fadd " in code
    assert FREEDOM.findall(code) == []


def test_a_flag_would_be_seen():
    free = numba.njit(fastmath={"contract"})(lambda x: x * x + 1.0)
    assert free(2.0) == 5.0
    (code,) = free.inspect_llvm().values()
    assert "contract" in FREEDOM.findall(code)


def test_the_instruction_set_is_chosen_before_numba_is_imported():
    """Whichever module comes first; numba would otherwise choose for itself."""
    program = (
        "import models.numerics.fma, numba, os;"
        "print(os.environ['NUMBA_CPU_FEATURES'] == numba.config.CPU_FEATURES)"
    )
    unset = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_CPU")}
    ended = subprocess.run([sys.executable, "-c", program], env=unset, capture_output=True)
    assert ended.stdout == b"True\n", ended.stderr


def test_options_are_compared_as_numba_compares_them():
    flags, other = Flags(), Flags()
    assert flags == other and hash(flags) == hash(other)
    flags.nrt, flags.error_model = True, "numpy"
    assert flags != other
    assert flags.values() == {name: getattr(flags, name) for name in Flags.options}
    other.nrt, other.error_model = True, "numpy"
    other.boundscheck = Flags.options["boundscheck"].default
    assert flags == other and hash(flags) == hash(other)


def test_no_source_asks_for_more():
    """Everything is compiled by `models.numerics.jit`, without fast mathematics."""
    for path in FOLDER.rglob("*.py"):
        asked = {
            word.arg
            for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.Call)
            for word in node.keywords
        }
        assert not asked & {"fastmath", "parallel"}, path


def test_a_full_disk_does_not_fail_a_kernel(monkeypatch):
    def full(*arguments):
        raise OSError(28, "No space left on device")

    @kernel
    def doubled(x):
        return 2.0 * x

    monkeypatch.setattr(caching.IndexDataCacheFile, "save", full)
    assert doubled(1.5) == 3.0
