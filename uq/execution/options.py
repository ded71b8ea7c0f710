"""Options of a run and its progress; no option changes the values of a valid row."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

from uq.errors import InputError


class Progress(NamedTuple):
    """Progress of a run.

    Attributes
    ----------
    done, total, failed : int
        Rows.
    reused : int
        Rows among those done that had been computed before this run.
    status : dict of str to int
        Status label -> rows.
    median : tuple of (str, float) or None
        Name and median [s] of a lifetime, among the rows that arrived in this process.
    shares : dict of str to float
        Of regimes, among the same rows.
    dashboard : str
        Address of the dashboard of a dask cluster, or "".
    compiling : bool
        Whether the model is being compiled, and rows wait for it.
    under_way : int
        Rows that are being computed: of a model that computes row by row, one for each worker.
    """

    done: int
    total: int
    failed: int
    reused: int = 0
    status: Mapping[str, int] = MappingProxyType({})
    median: tuple[str, float] | None = None
    shares: Mapping[str, float] = MappingProxyType({})
    dashboard: str = ""
    compiling: bool = False
    under_way: int = 0


Report = Callable[[Progress], object]
"""Called whenever rows have arrived."""

Say = Callable[[str], object]
"""Called with a line for the user."""


def ignore(_: object) -> None:
    """Do nothing with a report."""


@dataclass(frozen=True)
class RunOptions:
    """Options of a run.

    Attributes
    ----------
    workers : int or None
        Worker processes; 0 computes in this process, which a crashing row ends. None: one process
        for a few seconds of work, else one worker per core.
    scheduler : str or None
        Address of a running dask scheduler, instead of own workers.
    chunk_rows : int or None
        Rows per task, rounded up to whole groups of the design; None: half a second of work.
    row_limit : float or None
        Time limit of a row [s]; rows that exceed it are stopped.
    fresh : bool
        Whether to overwrite an existing output.
    mixed : bool
        Whether to reuse rows from another version of the model's code.
    progress : callable
        Called with a `Progress` as rows arrive, and when compilation of the model starts.
    say : callable
        Called with a line for the user: what was found on disk, or that a goal is out of reach.
    """

    workers: int | None = None
    scheduler: str | None = None
    chunk_rows: int | None = None
    row_limit: float | None = None
    fresh: bool = False
    mixed: bool = False
    progress: Report = ignore
    say: Say = ignore

    def check(self) -> None:
        """Refuse impossible or contradictory options.

        Raises
        ------
        InputError
        """
        if self.chunk_rows is not None and self.chunk_rows < 1:
            raise InputError(f"chunk_rows must be at least 1: {self.chunk_rows}")
        if self.workers is not None and self.scheduler is not None:
            raise InputError("workers and scheduler exclude each other")
        if self.workers is not None and self.workers < 0:
            raise InputError(f"workers must not be negative: {self.workers}")
        if self.row_limit is not None and not self.row_limit > 0:
            raise InputError(f"the time limit of a row must be positive: {self.row_limit:g} s")
        if self.row_limit is not None and self.workers == 0:
            raise InputError(
                "a time limit for rows needs another process that can be stopped: "
                "workers = 0 has none (omit it, or use 1)"
            )


DEFAULTS = RunOptions()
"""The options of a run unless others are given."""
