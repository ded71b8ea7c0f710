"""A process that computes rows for the one that started it: ``python -m uq.running.child HANDLE``.

A kernel may crash it or never return; then the other one ends it and starts another.
"""

import os
import sys
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.compilation import compilation
from uq.contract import Model
from uq.errors import InputError
from uq.rows.evaluate import evaluate
from uq.study.code import code_of
from uq.study.registry import find_model


class ModelSpec(NamedTuple):
    """What a child is for: one model with its settings.

    Attributes
    ----------
    model : str
        What `uq.study.registry.find_model` finds it by.
    version : str
        Which version of it is wanted.
    settings : tuple of (str, object)
        Names and values.
    output : str
        The cheap output that it computes alone; "" for all outputs.
    code : str
        `uq.study.code.code_of` the model that is wanted; "" for any.
    """

    model: str
    version: str
    settings: tuple[tuple[str, Any], ...]
    output: str = ""
    code: str = ""

    def find_model(self) -> Model:
        """Return the model, as far as it is wanted."""
        model = find_model(self.model)
        return model.alone(self.output) if self.output else model


class Request(NamedTuple):
    """Rows to be computed; see `uq.rows.evaluate.evaluate`."""

    x: NDArray[np.float64]
    seed: NDArray[np.uint64]
    start: int


READY, COMPILING, COMPILED, DONE, REFUSED = "ready", "compiling", "compiled", "done", "refused"
"""What a child says; with the last two goes a chunk or an exception."""


def end_with_parent(cleanup: Callable[[], object] = lambda: None) -> threading.Thread:
    """End this process, from a thread, when the pipe that is its standard input closes.

    It does so when the process that holds the other end stops, however that ends.

    Parameters
    ----------
    cleanup : callable
        Called before.

    Returns
    -------
    threading.Thread
    """

    def wait() -> None:
        # From the file descriptor: a thread inside sys.stdin would hold its lock for ever.
        while os.read(0, 1024):
            pass
        cleanup()
        os._exit(0)

    thread = threading.Thread(target=wait, daemon=True)
    thread.start()
    return thread


def main(handle: str) -> None:
    """Answer the requests that arrive on a connection until it closes."""
    end_with_parent()
    connection = Connection(int(handle))
    spec: ModelSpec = connection.recv()
    try:
        model = spec.find_model()
        if model.version != spec.version:
            raise InputError(
                f"a worker has version {model.version} of model '{model.name}', "
                f"this process has {spec.version}: install the same on both"
            )
        if spec.code not in ("", code_of(spec.model)):
            raise InputError(
                f"a worker has other code of model '{model.name}' than this process: start again "
                "if it was edited meanwhile, or install the same on both"
            )
        settings = model.settings(**dict(spec.settings))
    except Exception as error:
        connection.send((REFUSED, error))
        return
    connection.send((READY, None))
    compiling, compiled = ((word, None) for word in (COMPILING, COMPILED))
    with compilation(lambda: connection.send(compiling), lambda: connection.send(compiled)):
        while True:
            request: Request = connection.recv()
            try:
                answer: Any = DONE, evaluate(model, settings, *request)
            except Exception as error:
                answer = REFUSED, error
            connection.send(answer)


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except (EOFError, OSError):  # the connection closed: nobody wants an answer
        sys.exit(0)
