"""A command of ``uq``, carried out in a fork of this process."""

import contextlib
import os
import sys
import tempfile
import traceback
from collections.abc import Callable
from pathlib import Path


def reported(*arguments: str, folder: Path | None = None) -> dict[str, object]:
    """Return the exit code, output and errors of a command, carried out in a folder."""

    def command() -> None:
        from uq.cli import main

        sys.argv = ["uq", *arguments]
        main()

    return forked(command, folder)


def forked(work: Callable[[], None], folder: Path | None = None) -> dict[str, object]:
    """Return the exit code, output and errors of a function, called in a folder."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        child = os.fork()
        if not child:
            os.dup2(out.fileno(), 1)
            os.dup2(errors.fileno(), 2)
            _carry_out(work, folder)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, errors):
            file.seek(0)
            texts.append(file.read().decode())
    return {"code": code, "out": texts[0], "err": texts[1]}


def _carry_out(work: Callable[[], None], folder: Path | None) -> None:
    code = 99
    try:
        os.chdir(folder or ".")
        work()
        code = 0
    except SystemExit as end:
        code = int(end.code or 0)
    except BaseException:  # a crash is part of the record
        traceback.print_exc()
    with contextlib.suppress(BaseException):
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(code)
