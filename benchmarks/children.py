"""What other processes take: their time and their CPU time."""

import resource
import subprocess
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass


@dataclass
class Taken:
    """What the processes took that ended within a block.

    Attributes
    ----------
    seconds : float
        Time [s].
    cpu : float
        CPU time of all of them and of those that they waited for, user and system [s].
    """

    seconds: float = 0.0
    cpu: float = 0.0


@contextmanager
def clocked() -> Iterator[Taken]:
    """Yield what the processes that end within the block take; filled in at its end."""
    taken, before, began = Taken(), _cpu(), time.perf_counter()
    yield taken
    taken.seconds, taken.cpu = time.perf_counter() - began, _cpu() - before


def run(command: Sequence[str], **options: int) -> Taken:
    """Run a command, which must succeed; options as those of `subprocess.run`."""
    with clocked() as taken:
        subprocess.run(command, check=True, **options)
    return taken


def _cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
