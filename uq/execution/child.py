"""A process that computes rows for its parent: ``python -m uq.execution.child HANDLE``.

A kernel may crash it or never return; then the parent ends it and starts another. Where a function
does not declare what it returns, such a process runs a few of its rows to find out.
"""

import os
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

from uq.contract import Model
from uq.errors import InputError, described
from uq.machines.compilation import compilation
from uq.machines.returned import RowError, as_plain, seen_in
from uq.machines.row_by_row import RowByRow
from uq.machines.row_resources import adopt, end_descendants
from uq.study.evaluate import evaluate
from uq.study.installed_models import code_of, model_at


class ModelSpec(NamedTuple):
    """One model with its settings, for a child to run.

    Attributes
    ----------
    model : str
        Reference for `uq.study.installed_models.model_at`.
    version : str
        Required version of the model.
    settings : tuple of (str, object)
        Names and values.
    output : str
        The cheap output to be computed alone; "" for all outputs.
    code : str
        `uq.study.installed_models.code_of` the required model; "" for any.
    probed : bool
        Whether single rows are run to infer the outputs of a function that does not declare them.
    """

    model: str
    version: str
    settings: tuple[tuple[str, Any], ...]
    output: str = ""
    code: str = ""
    probed: bool = False

    def load(self) -> tuple[Model, Any]:
        """Load the model, reduced to the requested output, and its settings.

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
"""Messages of a child.

The last two come with a chunk or an exception; the first with two flags: whether the process stops
rows itself when their time is over, and whether its first call may take longer.
"""

Action = Callable[[], object]
Answer = Callable[..., tuple[str, Any]]


FIRST_SECONDS = 5.0
"""Extra time for a first call, which loads compiled code: about 1 s, more on a busy computer."""

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


def _end_with_parent() -> None:
    """End this process, from a thread, when the pipe at its standard input closes.

    It closes when the process at the other end stops, for whatever reason.
    """

    def wait() -> None:
        # From the file descriptor: a thread inside sys.stdin would never release its lock.
        while os.read(0, 1024):
            pass
        end_descendants()
        os._exit(0)

    sys.stdin = Path(os.devnull).open()  # for a model that asks something
    threading.Thread(target=wait, daemon=True).start()


def _evaluation(spec: ModelSpec, limit: float | None) -> tuple[tuple[bool, bool], Answer]:
    """Return the flags of `READY`, and the function that computes rows.

    Parameters
    ----------
    spec : ModelSpec
    limit : float or None
        Time limit of a row [s].
    """
    adopt()
    model, settings = spec.load()
    batch, flags = model.batch, (False, True)
    if isinstance(batch, RowByRow):
        flags = batch.stops_rows, batch.loads_first
        if limit is not None and batch.stops_rows:
            model = replace(model, batch=batch.limited(limit))

    def answer(*rows: Any) -> tuple[str, Any]:
        try:
            return DONE, evaluate(model, settings, *rows)
        except Exception as error:
            return REFUSED, error

    return flags, answer


def _probe(spec: ModelSpec) -> tuple[tuple[bool, bool], Answer]:
    """Return the flags and the evaluation of single rows, to infer undeclared outputs.

    The answer is the return value of a row as plain data, or a sentence on its failure.
    """
    batch: Any = model_at(spec.model).batch

    def answer(row: list[float], seed: int) -> tuple[str, Any]:
        try:
            return DONE, as_plain(seen_in(batch.row(row, seed)))
        except RowError as error:
            return DONE, str(error)
        except BaseException as error:
            return DONE, f"raised {described(error)}"

    return (False, True), answer


def main(handle: str) -> None:
    """Answer requests until the connection closes.

    The first message is a `ModelSpec`, with the time limit of a row.
    """
    _end_with_parent()
    os.dup2(1, 2)  # warnings of the model go where its prints go
    connection = Connection(int(handle))
    spec: ModelSpec
    spec, limit = connection.recv()
    try:
        flags, answer = _probe(spec) if spec.probed else _evaluation(spec, limit)
    except Exception as error:
        connection.send((REFUSED, error))
        return
    connection.send((READY, flags))
    with compilation(
        lambda: connection.send((COMPILING, None)), lambda: connection.send((COMPILED, None))
    ):
        while True:
            reply = answer(*connection.recv())
            sys.stdout.flush()  # this process is killed in the end
            connection.send(reply)


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except (EOFError, OSError):  # the connection closed: no answer is wanted
        sys.exit(0)
