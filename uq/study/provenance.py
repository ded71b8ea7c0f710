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
    """Return how the versions of this process differ from those wanted; "" if they do not.

    Parameters
    ----------
    wanted : dict of str to str
        `versions` of the process that wants rows.

    Returns
    -------
    str
        The rest of a sentence about this process, for the user of the other one.
    """
    pairs = [(name, version, wanted.get(name)) for name, version in versions().items()]
    wrong = [(name, version, required) for name, version, required in pairs if version != required]
    has = ", ".join(f"{name} {version}" for name, version, _ in wrong)
    needs = ", ".join(f"{name} {required}" for name, _, required in wrong)
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
