"""Start of child processes with the same imports and compilation as this process."""

import os
import subprocess
import sys
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

SINGLE_THREADED = {
    f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM")
}
"""Environment variables that these libraries read when they are loaded.

Several processes with one thread per core each would slow each other down, and a different number
of threads may change the last bits.
"""


def command(module: str, *arguments: str) -> list[str]:
    """Return the command that runs a module in another process of this Python."""
    # -P: the current folder is searched only if this process searches it.
    return [sys.executable, "-P", "-m", module, *arguments]


def inherited() -> dict[str, str]:
    """Return the environment of a process with bitwise equal results."""
    environment = dict(os.environ) | {"PYTHONPATH": os.pathsep.join(sys.path)}
    return SINGLE_THREADED | environment | _numba_settings()


def _numba_settings() -> dict[str, str]:
    """Return the instruction set and cache that numba uses in this process, if it is loaded.

    It reads the environment once, at import; the environment may have changed since.
    """
    if "numba" not in sys.modules:
        return {}
    import numba
    from numba.core.registry import cpu_target

    config: Any = numba.config
    _, cpu, features = cpu_target.target_context.codegen().magic_tuple()
    return {
        "NUMBA_CPU_NAME": cpu,
        "NUMBA_CPU_FEATURES": features,
        "NUMBA_CACHE_DIR": config.CACHE_DIR,
    }


def started(
    module: str, prints: int = subprocess.DEVNULL
) -> tuple[subprocess.Popen[bytes], Connection]:
    """Start a process connected to this one; its argument is the number of the connection.

    It is in a session of its own: Ctrl-C reaches this process, which ends the other.

    Parameters
    ----------
    module : str
    prints : int
        File descriptor for what it prints.

    Raises
    ------
    OSError
        When it cannot start.
    """
    parent_end, child_end = Pipe()
    with child_end:
        try:
            process = subprocess.Popen(
                command(module, str(child_end.fileno())),
                stdin=subprocess.PIPE,
                stdout=prints,
                pass_fds=(child_end.fileno(),),
                start_new_session=True,
                env=inherited(),
            )
        except OSError:
            parent_end.close()
            raise
    return process, parent_end
