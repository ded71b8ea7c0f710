"""A model whose rows take their time and, on request, take their process with them."""

import ctypes
import math
import os
import signal
import time
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numba
import numpy as np

from models.numerics.jit import kernel
from uq.contract import Model, Output, Parameter, Setting

if "UQ_TEST_CHILDREN_END" in os.environ:  # set once the process of the test has imported this
    os._exit(3)


class Parameters(NamedTuple):
    x1: Annotated[float, Parameter("x_1", "1", "input", (0.0, 1.0), "made up")] = 0.25


@dataclass(frozen=True)
class Settings:
    """What rows do to their process."""

    seconds: Annotated[float, Setting("time a row takes", "s", bounds=(0.0, 100.0))] = 0.0
    above: Annotated[float, Setting("rows whose x1 lies above this do it")] = 2.0
    how: Annotated[str, Setting("what they do", choices=("segfault", "kill", "dtype"))] = "kill"


def _do(x, seed, settings):
    time.sleep(settings.seconds * len(x))
    y = 3.0 * x[:, 0]
    if np.any(x[:, 0] > settings.above):
        match settings.how:
            case "segfault":
                ctypes.string_at(0)
            case "kill":  # as the kernel does when memory is short
                os.kill(os.getpid(), signal.SIGKILL)
            case "dtype":
                y = y.astype(np.float32)
    return {"y": y}, np.zeros(len(x), np.int8)


@kernel
def _sum(values):
    total = 0.0
    for value in values:
        total += np.sin(value) ** 2 + np.exp(-value)
    return total


def _compiled(x, seed, settings):
    y = np.array([_sum(np.linspace(0.0, row[0], 100)) for row in x])
    return {"y": y}, np.zeros(len(x), np.int8)


def _compiling(x, seed, settings):
    lines = [f"    z += math.sin(z * {i}.5) + math.exp(-z / {i + 1})" for i in range(300)]
    names = {}
    exec("\n".join(["def f(z):", *lines, "    return z"]), {"math": math}, names)
    return {"y": x[:, 0] + 0.0 * numba.njit(names["f"])(1.0)}, np.zeros(len(x), np.int8)


def _model(name, batch):
    return Model(
        name=name,
        title=name,
        version="1",
        parameters=Parameters,
        settings=Settings,
        outputs={"y": Output("1", "some number")},
        batch=batch,
    )


FAULTY = _model("faulty", _do)
COMPILING = _model("compiling", _compiling)
COMPILED = _model("compiled", _compiled)
