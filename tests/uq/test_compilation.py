"""Whoever waits for numba hears of it, whether it was there from the start or comes later."""

import subprocess
import sys

import pytest

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
NEVER = """
import sys
before = list(sys.meta_path)
with compilation(lambda: 1 / 0):
    pass
assert sys.meta_path == before and "numba" not in sys.modules
import numba
numba.njit(lambda x: x)(1)
"""


@pytest.mark.parametrize("program", [LATE, f"import numba\n{LATE}", NEVER])
def test_compilation_is_heard_of(program):
    program = f"from uq.compilation import compilation\n{program}"
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
