"""What runs in the processes that are killed: the command line, and a model that takes its time."""

import os
import resource
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, NamedTuple

import numpy as np

from uq.cli import main
from uq.contract import Model, Output, Parameter, Status

# What the command loads when it needs it: loaded once, before the processes are forked, and before
# they become another user, who may not see where Python lives.
MODULES = (
    "dask.array",
    "filelock",
    "netCDF4",
    "scipy.stats",
    "models.analytic",
    "uq.assess.statistics",
)
for module in MODULES:
    import_module(module)
"".encode("utf-8-sig")
for module in ("app", "run", "status"):
    import_module(f"uq.cli.{module}")


class Parameters(NamedTuple):
    x1: Annotated[float, Parameter("x_1", "1", "first input", (0.0, 1.0), "made up")] = 0.5
    x2: Annotated[float, Parameter("x_2", "1", "second input", (0.0, 1.0), "made up")] = 0.5


@dataclass(frozen=True)
class Settings:
    """No numerical choices."""


def patient(x, seed, settings):
    """Take a while for each row; raise at large x1, give nan at small x2."""
    time.sleep(float(os.environ.get("UQ_TEST_SECONDS", "0")) * len(x))
    x1, x2 = np.ascontiguousarray(x.T)
    if np.any(x1 > 0.88):
        raise ValueError(f"x1 is {x1[x1 > 0.88][0]}")
    y = np.where(x2 < 0.12, np.nan, x1 + 1e-3 * (seed % 7))
    return {"y": y, "z": np.stack([x2, -x2], axis=-1)}, np.full(len(x), Status.OK, np.int8)


PATIENT = Model(
    name="patient",
    title="Takes its time",
    version="1",
    parameters=Parameters,
    settings=Settings,
    outputs={"y": Output("1", "a number"), "z": Output("1", "two numbers", dims=("side",))},
    batch=patient,
    coordinates=lambda settings: {"side": ("left", "right")},
)


def run(folder, arguments, environment, output):
    """Be the command ``uq ARGUMENTS`` in a folder."""
    os.chdir(folder)
    os.environ.update(environment)
    if limit := environment.get("UQ_TEST_FILE_SIZE"):
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit), resource.RLIM_INFINITY))
    handle = os.open(output, os.O_WRONLY | os.O_CREAT)
    os.dup2(handle, 1)
    os.dup2(handle, 2)
    if user := environment.get("UQ_TEST_USER"):
        os.seteuid(int(user))
    sys.argv = ["uq", *arguments]
    main()
