"""The bits of compiled code are a function of its source: no flag lets the compiler choose."""

import ast
import importlib
import pkgutil
import re
from pathlib import Path

import numba
import numpy as np
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
