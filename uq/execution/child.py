"""A process that computes rows for its parent: ``python -m uq.execution.child HANDLE``.

A kernel may crash it or never return; then the parent ends it and starts another.
"""

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

from uq.contract import Model
from uq.errors import InputError
from uq.machines.child_processes import adopt, end_descendants
from uq.machines.compilation import compilation
from uq.machines.row_by_row import RowByRow
from uq.study.evaluate import evaluate
from uq.study.installed_models import code_of, model_at


class ModelSpec(NamedTuple):
    """One model with its settings, for a child to run.

    Attributes
    ----------
    model : str
        Reference for `uq.study.installed_models.model_at`.
    version : str
        Of the model that is wanted.
    settings : tuple of (str, object)
        Names and values.
    output : str
        The cheap output to be computed alone; "" for all outputs.
    code : str
        `uq.study.installed_models.code_of` the wanted model; "" for any.
    """

    model: str
    version: str
    settings: tuple[tuple[str, Any], ...]
    output: str = ""
    code: str = ""

    def load(self) -> tuple[Model, Any]:
        """Return the model, as far as it is wanted, and its settings.

        Raises
        ------
        InputError
            When this process has no such model, or a different one.
        """
        model = model_at(self.model)
        if model.version != self.version:
            raise InputError(
                f"the process that computes rows has version {model.version} of model "
                f"'{model.name}', this process has {self.version}: install the same on both"
            )
        if self.code not in ("", code_of(self.model)):
            raise InputError(
                f"the process that computes rows has other code of model '{model.name}' than this "
                "process: start again if it was edited meanwhile, or install the same on both"
            )
        wanted, settings = model, model.settings(**dict(self.settings))
        if self.output:
            wanted = model.alone(self.output)
        return wanted.given(settings), settings


READY, COMPILING, COMPILED, DONE, REFUSED = "ready", "compiling", "compiled", "done", "refused"
"""Messages of a child; the last two come with a chunk or an exception, the first with `Ready`."""

Action = Callable[[], object]


class Ready(NamedTuple):
    """How a process keeps to the time limit of a row.

    Attributes
    ----------
    stops_rows : bool
        Whether it stops rows itself when their time is over.
    loads_first : bool
        Whether its first call may take longer.
    """

    stops_rows: bool = False
    loads_first: bool = True


FIRST_SECONDS = 5.0
"""Beyond its limit for a first call, which loads compiled code: 1 s, more on a busy computer."""

_POLL_SECONDS = 0.2  # so that an interrupt is seen


def answer_of(
    connection: Connection,
    limit: float | None = None,
    compiling: Action = lambda: None,
    waiting: Action = lambda: None,
) -> tuple[str, Any] | None:
    """Return the answer of a process, or None when its time is over.

    Parameters
    ----------
    connection : Connection
    limit : float, optional
        Time for the answer [s]; compilation does not count.
    compiling : callable
        Called when the process starts to compile.
    waiting : callable
        Called several times a second.

    Raises
    ------
    EOFError, OSError
        When the process has died.
    """
    began: float | None = time.monotonic()
    while True:
        while not connection.poll(min(limit or _POLL_SECONDS, _POLL_SECONDS)):
            waiting()
            if limit and began and time.monotonic() > began + limit:
                return None
        kind, value = connection.recv()
        if kind == COMPILING:
            began = None
            compiling()
        elif kind == COMPILED:
            began = time.monotonic()
        else:
            return kind, value


@contextmanager
def telling_of_compilation(connection: Connection) -> Iterator[None]:
    """Send a message whenever this process starts and ends compiling."""
    compiling, compiled = ((word, None) for word in (COMPILING, COMPILED))
    with compilation(lambda: connection.send(compiling), lambda: connection.send(compiled)):
        yield


def end_with_parent(cleanup: Callable[[], object] = lambda: None) -> threading.Thread:
    """End this process, from a thread, when the pipe at its standard input closes.

    It closes when the process at the other end stops, for whatever reason.

    Parameters
    ----------
    cleanup : callable
        Called first.

    Returns
    -------
    threading.Thread
    """

    def wait() -> None:
        # From the file descriptor: a thread inside sys.stdin would never release its lock.
        while os.read(0, 1024):
            pass
        cleanup()
        os._exit(0)

    sys.stdin = Path(os.devnull).open()  # for a model that asks something
    thread = threading.Thread(target=wait, daemon=True)
    thread.start()
    return thread


def main(handle: str) -> None:
    """Answer requests, each the arguments of `evaluate`, until the connection closes."""
    adopt()
    end_with_parent(end_descendants)
    os.dup2(1, 2)  # warnings of the model go where its prints go
    connection = Connection(int(handle))
    spec: ModelSpec
    limit: float | None
    spec, limit = connection.recv()
    try:
        model, settings = spec.load()
    except Exception as error:
        connection.send((REFUSED, error))
        return
    batch = model.batch
    ready = Ready()
    if isinstance(batch, RowByRow):
        ready = Ready(batch.stops_rows, batch.loads_first)
        if limit is not None and batch.stops_rows:
            model = replace(model, batch=batch.limited(limit))
    connection.send((READY, tuple(ready)))  # plain: this module is __main__
    with telling_of_compilation(connection):
        while True:
            rows = connection.recv()
            try:
                answer: Any = DONE, evaluate(model, settings, *rows)
            except Exception as error:
                answer = REFUSED, error
            sys.stdout.flush()  # this process is killed in the end
            connection.send(answer)


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except (EOFError, OSError):  # the connection closed: no answer is wanted
        sys.exit(0)
