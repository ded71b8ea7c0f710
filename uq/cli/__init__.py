"""The command ``uq``: its start, how it reports mistakes, its end.

Exit codes: 0 done; 1 no usable result; 2 bad input; 130 interrupted.

Reading order; each part imports only those above it:

    printing        text, numbers and tables on a terminal, and JSON
    progress        the progress of a run
    completion      words with which a shell completes an argument or the value of an option
    options         arguments and options shared by several verbs of ``uq``, with their help
    streams         standard streams that are closed, full or lack characters
    compare         the output of ``uq compare``
    estimates       terminal output of ``uq twin``, ``uq convergence`` and ``uq fleet``
    models          terminal output of ``uq models``, and of ``uq`` without a command: next steps
    sensitivity     terminal output of ``uq sensitivity``, ``uq levels`` and ``uq trace``
    summary_tables  card, answer and summary of a result, 80 columns wide
    what_if         terminal output of ``uq what-if``
    check           terminal output of ``uq check`` and ``uq plan``, before a run
    rare_event      terminal output of ``uq rare-event``
    simulate        the command ``uq simulate``
    run             output of the verbs that compute rows of a result
    status          terminal output of ``uq status``, ``uq verify`` and ``uq row``
    learning        terminal output of ``uq update`` and ``uq next-inspection``
    verbs           the verbs of ``uq``: what each takes, and what it calls
    app             the command ``uq``: its verbs, in the order of ``uq --help``
"""

import ctypes
import gc
import os
import signal
import sys
from contextlib import suppress
from functools import partial
from importlib.util import LazyLoader, find_spec, module_from_spec
from types import FrameType
from typing import Any, NoReturn

from uq.cli import streams
from uq.errors import InputError, RunError, described, nearest, one_line
from uq.execution.environment import SINGLE_THREADED
from uq.files.interrupts import undo_all

_when_interrupted = "interrupted"

_ALLOCATIONS = 100_000  # between searches for garbage; imports allocate much and discard little

_KEPT = 2**25  # bytes that are freed and kept; glibc allows no more
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # as in its <malloc.h>

_READERS = (
    "summary",
    "sensitivity",
    "levels",
    "fleet",
    "convergence",
    "compare",
    "what-if",
    "trace",
    "plot",
    "report",
)
"""Verbs that only read results."""

_NOT_ASKED = ("dask", "pint")
"""Packages that xarray would import to ask whether an array is one of theirs: here none is."""

_SELDOM_USED = ("numpy.f2py", "numpy.testing")
"""Modules that ``from numpy import *`` imports, in scipy."""

_HOMES = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME")
"""Folders of a user, ignored where they are relative, as the XDG base directory specification has
it: libraries would make a folder ``~`` in the current one for a ``~`` that no shell expanded."""


def main() -> NoReturn:
    """Run the command line and end the process."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, partial(_stop, os.getpid()))
    gc.set_threshold(_ALLOCATIONS)
    if sys.argv[1:2] and sys.argv[1] in _READERS:
        for name in _NOT_ASKED:
            sys.modules.setdefault(name, None)  # type: ignore[arg-type]  # "not installed"
        _keep_freed_memory()
    for name, value in SINGLE_THREADED.items():
        os.environ.setdefault(name, value)
    if len(sys.argv) > 2 and sys.argv[1] in (*_READERS, "run") and "--help" not in sys.argv:
        _load_when_used(*_SELDOM_USED)
    for name in _HOMES:
        if not os.path.isabs(os.environ.get(name, os.sep)):
            del os.environ[name]
    streams.watch()
    try:
        code = _run(sys.argv[1:])
    except (InputError, RunError) as error:
        streams.complain(*getattr(error, "lines", (str(error),)))
        code = 2 if isinstance(error, InputError) else 1
    except OSError as error:
        if not streams.are_lost():
            streams.complain(_of_the_system(error))
        code = 1
    except MemoryError as error:
        streams.complain(f"uq: not enough memory: {one_line(error) or 'none is left'}")
        code = 1
    except Exception as error:
        streams.complain(_unforeseen(error))
        code = 1
    code = streams.finish(code)
    gc.freeze()  # else Python searches all modules for garbage, three times, before it ends
    sys.exit(code)


def _keep_freed_memory() -> None:
    """Keep the memory of freed columns for the next ones: the system clears what it gives anew."""
    with suppress(AttributeError, OSError, TypeError):  # another C library than glibc
        for threshold in (_TRIM_THRESHOLD, _MMAP_THRESHOLD):
            ctypes.CDLL(None).mallopt(threshold, _KEPT)


def _load_when_used(*names: str) -> None:
    """Let submodules load only when an attribute of theirs is first asked for."""
    for name in names:
        if name in sys.modules:
            continue
        spec = find_spec(name)
        assert spec is not None and spec.loader is not None, name
        spec.loader = LazyLoader(spec.loader)
        sys.modules[name] = module = module_from_spec(spec)
        spec.loader.exec_module(module)
        package, _, last = name.rpartition(".")
        setattr(sys.modules[package], last, module)


def ask_for_plain_arrays() -> None:
    """Let xarray find, once and for all, that no array is of `_NOT_ASKED`.

    Unlike verbs that only read, the caller runs models and workers, which may import them.
    """
    if "xarray" in sys.modules:
        return
    absent = [name for name in _NOT_ASKED if name not in sys.modules]
    sys.modules.update(dict.fromkeys(absent))  # type: ignore[arg-type]  # "not installed"
    try:
        import xarray as xr

        xr.Dataset({"number": ("row", [0.0])}).load()
        xr.DataArray([0.0]).to_numpy()
    finally:
        for name in absent:
            del sys.modules[name]


def say_when_interrupted(sentence: str) -> None:
    """Set the sentence that an interrupt prints from now on."""
    global _when_interrupted
    _when_interrupted = sentence


def _of_the_system(error: OSError) -> str:
    """Return the line of a failure that the operating system reports."""
    place = f"{os.fsdecode(error.filename)}: " if isinstance(error.filename, str | bytes) else ""
    reason = error.strerror or one_line(error) or type(error).__name__
    if reason.startswith("No usable temporary directory"):
        reason += "; name a folder that can be written in TMPDIR"
    return f"uq: {place}{reason}"


def _unforeseen(error: Exception) -> str:
    """Return the line of a mistake of this program; its traceback is kept in a private file."""
    import tempfile
    import traceback

    try:
        handle, name = tempfile.mkstemp(prefix="uq-", suffix=".txt")
        with open(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            traceback.print_exception(error, file=file)
    except OSError:
        name = "nowhere, as no temporary file can be written"
    return (
        f"uq: this input was not foreseen ({described(error)}); please report it with its"
        f" traceback, kept in {name}"
    )


def _run(arguments: list[str]) -> int:
    import typer

    from uq.cli.app import app

    refusal: Any = typer.BadParameter.__mro__[2]  # the base of all errors that typer raises
    try:
        return app(arguments, prog_name="uq", standalone_mode=False) or 0
    except refusal as error:
        if options := getattr(error, "possibilities", None):
            line = f"{error.message}{nearest(error.option_name, options)}"
        else:
            line = " ".join(error.format_message().split())
        context = getattr(error, "ctx", None)
        command = context.command_path if context else "uq"
        line = f"{line} See" if line.endswith("?") else f"{line.rstrip('.')}; see"
        raise InputError(f"uq: {line} '{command} --help'") from None


def _stop(process: int, number: int, frame: FrameType | None) -> NoReturn:
    """End at once, leaving nothing behind; no exception that could be caught on the way.

    A process forked by a model exits silently: it must not undo pending work of this process.
    """
    signal.signal(number, signal.SIG_IGN)
    if os.getpid() != process:
        os._exit(128 + number)
    try:
        undo_all()
        os.write(2, f"{_when_interrupted}\n".encode())
    finally:
        os._exit(128 + number)
