"""Kernels of one factory are never taken for each other, whoever compiled them when."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

MADE = """
import math
import sys

import numpy as np

from models.numerics.jit import kernel


def factory(n):
    @kernel
    def inner(x):
        for _ in range(3):
            for i in range(len(x)):
                x[i] += n + 0 * (math.sin(x[i]) + math.cos(x[i]) + math.exp(-x[i]))
            for i in range(len(x)):
                x[i] += n + 0 * (math.tan(x[i]) + math.atan(x[i]) + math.tanh(-x[i]))
            for i in range(len(x)):
                x[i] += n + 0 * (math.sinh(1e-9 * x[i]) + math.cosh(1e-9 * x[i]))

    return inner


one, hundred = factory(1.0), factory(100.0)


@kernel
def by_one(x):
    one(x)
    one(x)
    one(x)
    one(x)


@kernel
def by_hundred(x):
    hundred(x)
    hundred(x)
    hundred(x)
    hundred(x)


for name in sys.argv[1:]:
    x = np.zeros(2)
    {"one": by_one, "hundred": by_hundred}[name](x)
    print(x[1])
"""


@pytest.mark.slow
def test_code_from_the_cache_and_new_code_keep_apart(tmp_path):
    """Without names apart the third process takes what it compiles for what it has loaded."""
    script = tmp_path / "made.py"
    script.write_text(MADE)
    root = Path(__file__).resolve().parents[3]
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": str(root)}
    printed = [
        subprocess.run(
            [sys.executable, str(script), *names],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for names in (["one"], ["one", "hundred"], ["hundred", "one"])
    ]
    assert printed == [["36.0"], ["36.0", "3600.0"], ["3600.0", "36.0"]]
