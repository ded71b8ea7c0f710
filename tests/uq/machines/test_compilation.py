"""Whoever waits for numba hears of it, whether it was there from the start or comes later."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest
from wordings import sentence

COMMAND = Path(sys.executable).with_name("uq")

LATE = """
heard = []
with compilation(lambda: heard.append("began"), lambda: heard.append("ended")):
    import numba
    assert heard == []
    inner = numba.njit(lambda x: x + 1.0)
    assert numba.njit(lambda x: inner(x))(1.0) == 2.0
    assert heard == ["began", "ended"], heard  # one within the other is one
numba.njit(lambda x: x)(1)
assert heard == ["began", "ended"], heard
"""
LOOKED_FOR = """
import sys
from importlib.util import find_spec
with compilation(lambda: heard.append("began")):
    heard = []
    assert find_spec("numba") and "numba" not in sys.modules
    import numba
    numba.njit(lambda x: x + 1.0)(1.0)
assert heard == ["began"], heard
"""
NEVER = """
import sys
before = list(sys.meta_path)
with compilation(lambda: 1 / 0):
    pass
assert sys.meta_path == before and "numba" not in sys.modules
import numba
numba.njit(lambda x: x)(1)
"""


@pytest.mark.parametrize(
    "program",
    [
        pytest.param(code, marks=[pytest.mark.slow] * (code != LATE))
        for code in (LATE, f"import numba\n{LATE}", LOOKED_FOR, NEVER)
    ],
)
def test_compilation_is_heard_of(program):
    program = f"from uq.machines.compilation import compilation\n{program}"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")


@pytest.mark.slow
def test_a_terminal_shows_that_a_model_compiles(folder):
    ours, theirs = pty.openpty()
    command = [COMMAND, "simulate", "process_models:SPINNING", "--json"]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    ended = subprocess.run(command, stdout=subprocess.PIPE, stderr=theirs, env=environment)
    os.close(theirs)
    output = os.read(ours, 1000).decode()
    os.close(ours)
    assert (ended.returncode, output) == (0, f"{sentence('compiling')}\r\n")
