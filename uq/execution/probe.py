"""A process that runs a few rows of a function to see what it returns: ``... HANDLE``."""

import os
import sys
from multiprocessing.connection import Connection
from typing import Any

from uq.errors import InputError, described
from uq.execution.child import READY, REFUSED, end_with_parent, telling_of_compilation
from uq.machines.returned import RowError, as_plain, seen_in
from uq.study.installed_models import model_at

RETURNED, RAISED = "returned", "raised"
"""What a row did, with what it returned as plain data, or with a sentence."""


def main(handle: str) -> None:
    """Run rows as they come, each with its seed, until the connection closes."""
    end_with_parent()
    os.dup2(1, 2)  # warnings of the function go where its prints go
    connection = Connection(int(handle))
    reference = connection.recv()
    try:
        batch: Any = model_at(reference).batch
    except InputError as error:
        connection.send((REFUSED, error))
        return
    connection.send((READY, None))
    with telling_of_compilation(connection):
        while True:
            row, seed = connection.recv()
            try:
                answer: tuple[str, Any] = RETURNED, as_plain(seen_in(batch.row(row, seed)))
            except RowError as error:
                answer = RAISED, str(error)
            except BaseException as error:
                answer = RAISED, f"raised {described(error)}"
            connection.send(answer)


if __name__ == "__main__":
    try:
        main(sys.argv[1])
    except (EOFError, OSError):  # the connection closed: no answer is wanted
        sys.exit(0)
