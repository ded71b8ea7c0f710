"""The processor and the versions that computed a result: rows may differ with others."""

import importlib.metadata
import platform
from collections.abc import Mapping
from functools import cache
from pathlib import Path

__version__ = importlib.metadata.version("vibrolife")

_LIBRARIES = ("vibrolife", "numpy", "numba", "scipy", "SALib")
_COMPUTING = ("vibrolife", "numpy", "numba", "scipy", "distributed")


@cache
def provenance() -> dict[str, str]:
    """Return the processor and the versions that compute results here, not to be changed."""
    here = {"cpu": _cpu(), "python": platform.python_version()}
    return here | {name: importlib.metadata.version(name) for name in _LIBRARIES}


@cache
def versions() -> dict[str, str]:
    """Return the versions that must agree in all processes that compute rows of one result."""
    python = ".".join(platform.python_version_tuple()[:2])
    return {"Python": python} | {name: importlib.metadata.version(name) for name in _COMPUTING}


def differences(wanted: Mapping[str, str]) -> str:
    """Return how this process differs from one that wants rows; "" if it does not.

    Parameters
    ----------
    wanted : dict of str to str
        `versions` of the process that wants rows.

    Returns
    -------
    str
        The rest of a sentence about this process, for the user of the other one.
    """
    pairs = [(name, there, wanted.get(name)) for name, there in versions().items()]
    wrong = [(name, there, here) for name, there, here in pairs if there != here]
    has = ", ".join(f"{name} {there}" for name, there, _ in wrong)
    needs = ", ".join(f"{name} {here}" for name, _, here in wrong)
    return f"has {has}; this process has {needs}: install the same on both" if wrong else ""


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
