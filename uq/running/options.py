"""What a user may choose about how a run goes; no choice changes a bit of a sound row."""

from collections.abc import Callable
from dataclasses import dataclass

from uq.errors import InputError
from uq.running.progress import Report

Say = Callable[[str], object]
"""What is called with a line for the user."""


def ignore(_: object) -> None:
    """Do nothing with what there is to report."""


@dataclass(frozen=True)
class RunOptions:
    """How rows are carried out.

    Attributes
    ----------
    workers : int or None
        Worker processes; 0 computes in this process, and a row that crashes ends it. None: one
        process for what takes a few seconds, else one worker per core.
    scheduler : str or None
        Address of a running dask scheduler, instead of own workers.
    chunk_rows : int or None
        Rows per task, rounded up to whole groups of the design; None: half a second of work.
    row_limit : float or None
        Longest time for one row [s]; one that outlives it is stopped.
    fresh : bool
        Whether to overwrite whatever the output holds.
    mixed : bool
        Whether to go on also with rows that other code of the model computed.
    progress : callable
        Called with a `Progress` as rows arrive, and when the model begins to be compiled.
    say : callable
        Called with a line for the user: what was found on disk.
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
        """Refuse what is impossible, or excludes each other.

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
                "workers = 0 has none (leave it out, or take 1)"
            )


DEFAULTS = RunOptions()
"""What a run does unless it is told otherwise."""
