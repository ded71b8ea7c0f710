"""Provenance of a result: processor and software versions, on which rows may depend."""

import importlib.metadata
import platform
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

__version__ = importlib.metadata.version("vibrolife")

_LIBRARIES = ("vibrolife", "numpy", "numba", "scipy", "SALib")
_COMPUTING = ("vibrolife", "numpy", "numba", "scipy", "distributed")


@cache
def provenance() -> dict[str, str]:
    """Return processor and software versions of this machine; callers must not change the dict."""
    here = {"cpu": _cpu(), "python": platform.python_version()}
    return here | {name: importlib.metadata.version(name) for name in _LIBRARIES}


@cache
def versions() -> dict[str, str]:
    """Return the versions that must be equal in all processes that compute rows of a result."""
    python = ".".join(platform.python_version_tuple()[:2])
    return {"Python": python} | {name: importlib.metadata.version(name) for name in _COMPUTING}


def differences(wanted: Mapping[str, str]) -> str:
    """Return the differences between the required and the installed versions; "" if none.

    Parameters
    ----------
    wanted : dict of str to str
        `versions` of the process that requests rows.

    Returns
    -------
    str
        End of a sentence about this process, for the user of the requesting process.
    """
    pairs = [(name, version, wanted.get(name)) for name, version in versions().items()]
    wrong = [(name, version, required) for name, version, required in pairs if version != required]
    has = ", ".join(f"{name} {version}" for name, version, _ in wrong)
    needs = ", ".join(f"{name} {required}" for name, _, required in wrong)
    return f"has {has}; this process has {needs}: install the same on both" if wrong else ""


def _cpu() -> str:
    """Return the processor and its widest vectors: numpy rounds powers and logarithms by these."""
    extensions: Any = np.show_config(mode="dicts")
    widest = (extensions["SIMD Extensions"].get("found") or ["without vectors"])[-1]
    return f"{_processor()}, {widest}"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
