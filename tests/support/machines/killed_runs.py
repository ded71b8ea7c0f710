"""Commands in processes of their own, which tests kill, and what such runs have kept."""

import os
import signal
import time
from pathlib import Path
from typing import NamedTuple

import command

from uq.execution.row_folder import history

PATIENCE = 900.0
"""How long a busy machine may take for what should take a moment [s]."""

OUT = Path("results/small.nc")
ROWS = Path("results/small.nc.rows")
MODEL = ("--model", "command:PATIENT", "--workers", "0", "--quiet")


class Command:
    """One ``uq`` command under way."""

    def __init__(self, context, folder, arguments, environment):
        self.output = folder / f"output-{time.monotonic_ns()}"
        self.process = context.Process(
            target=command.run, args=(folder, arguments, environment, self.output)
        )
        self.process.start()

    def send(self, number):
        os.kill(self.process.pid, number)

    def wait(self):
        """Return exit code and all that was printed."""
        self.process.join(PATIENCE)
        assert self.process.exitcode is not None, "waited in vain"
        text = self.output.read_text() if self.output.exists() else ""
        self.output.unlink(missing_ok=True)
        return self.process.exitcode, text

    def kill(self):
        self.send(signal.SIGKILL)
        return self.wait()


class Kept(NamedTuple):
    """What the journal says is kept."""

    chunks: int
    rows: int


def kept():
    """Return how many chunk files and rows the journal names."""
    journal = history(ROWS)
    records = journal.chunks if journal else []
    return Kept(len(records), sum(record.rows for record in records))


def until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.0005)
