"""Compiled code is what its source says: plain Python computes the same numbers."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
import short_runs

ROUNDED = {"bouncing_ball": 1e-13, "vibrator_exact": 1e-10, "vibrator_springs": 1e-14}
"""Of these, plain Python rounds sines and powers otherwise; the others agree to the bit."""


def in_a_new_process(disable):
    ended = subprocess.run(
        [sys.executable, short_runs.__file__],
        env=os.environ | {"NUMBA_DISABLE_JIT": disable},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(ended.stdout)


@pytest.fixture(scope="module")
def plain():
    return in_a_new_process("1")


@pytest.mark.parametrize("run", short_runs.RUNS, ids=lambda run: run.__name__)
def test_plain_python_agrees_with_compiled_code(plain, run):
    tolerance = ROUNDED.get(run.__name__, 0.0)
    np.testing.assert_allclose(plain[run.__name__], run(), rtol=tolerance, atol=tolerance / 1000)


@pytest.mark.slow
def test_compiled_code_is_kept_on_disk():
    here = {run.__name__: run().tolist() for run in short_runs.RUNS}
    assert in_a_new_process("0") == here | {"compiled anew": 0}
