"""Models that take time or depend on their process, for tests of how rows are carried out."""

import math
import os
import time
import zlib
from pathlib import Path

import numba
import numpy as np
from sample_models import ok, simple


def _mark():
    """Tell whoever watches that a row is being computed."""
    if place := os.environ.get("UQ_TEST_MARK"):
        Path(place).touch()


def _sleep(x, seed, settings):
    _mark()
    time.sleep(settings.seconds * len(x))
    return {"y": x[:, 0].copy()}, ok(len(x))


SLEEPING = simple("sleeping", _sleep)


@numba.njit(nogil=True)
def _count(steps):
    z = np.uint64(1)
    for _ in range(steps):
        z ^= z << np.uint64(13)
        z ^= z >> np.uint64(7)
        z ^= z << np.uint64(17)
    return z


def _spin(x, seed, settings):
    _mark()
    # One kernel call that does not return to Python: about a second per 4e8 steps.
    z = _count(int(settings.seconds * 4e8) * len(x))
    return {"y": x[:, 0] + 0.0 * float(z)}, ok(len(x))


SPINNING = simple("spinning", _spin)


def _compile(x, seed, settings):
    _mark()
    lines = [f"    z += math.sin(z * {i}.5) + math.exp(-z / {i + 1})" for i in range(3000)]
    names = {}
    exec("\n".join(["def f(z):", *lines, "    return z"]), {"math": math}, names)
    return {"y": x[:, 0] + 0.0 * numba.njit(names["f"])(1.0)}, ok(len(x))


COMPILING = simple("compiling", _compile)
"""Spends half a minute or more in the compiler."""


def _process(x, seed, settings):
    time.sleep(settings.seconds * len(x))
    return {"y": np.full(len(x), float(os.getpid()))}, ok(len(x))


PROCESS = simple("process", _process)
"""Says which process computed a row."""

VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "UQ_TEST")


def _environment(x, seed, settings):
    import numba.core.codegen as codegen
    from numba import config

    here = [os.environ.get(name) for name in VARIABLES]
    here += [config.CACHE_DIR, config.CPU_FEATURES or codegen.get_host_cpu_features()]
    return {"y": np.full(len(x), float(hash_of(repr(here))))}, ok(len(x))


def hash_of(text):
    return zlib.crc32(text.encode())


ENVIRONMENT = simple("environment", _environment)
"""Tells one environment from another."""
