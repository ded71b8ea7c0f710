"""The processor and the versions that made a result: the same row may differ elsewhere."""

import importlib.metadata
import platform
from functools import cache
from pathlib import Path

_LIBRARIES = ("vibrolife", "numpy", "numba", "scipy", "SALib")


def provenance() -> dict[str, str]:
    """Return the processor and the versions that made a result."""
    return dict(_here())


@cache
def _here() -> dict[str, str]:
    here = {"cpu": _cpu(), "python": platform.python_version()}
    return here | {name: importlib.metadata.version(name) for name in _LIBRARIES}


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    for line in lines:
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
