"""Clean-up of interrupted work: no temporary files or processes remain."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

T = TypeVar("T")

_pending: list[Callable[[], object]] = []


@contextmanager
def undone(action: Callable[[], object]) -> Iterator[None]:
    """Call `action` when the block ends, however it ends.

    A process that ends at once, without unwinding, calls `undo_all` first.

    Parameters
    ----------
    action : callable
        Harmless when there is nothing to undo.
    """
    _pending.append(action)
    try:
        yield
    finally:
        if action in _pending:
            _pending.remove(action)
        action()


def undo_all() -> None:
    """Undo everything that is pending, the latest first."""
    while _pending:
        _pending.pop()()


def in_background(work: Callable[[], T]) -> T:
    """Call `work` in a daemon thread, so that Ctrl-C always reaches the calling thread."""
    outcome: list[T] = []
    failure: list[BaseException] = []

    def call() -> None:
        try:
            outcome.append(work())
        except BaseException as error:
            failure.append(error)

    thread = threading.Thread(target=call, daemon=True)
    thread.start()
    while thread.is_alive():
        thread.join(0.2)
    if failure:
        raise failure[0]
    return outcome[0]
