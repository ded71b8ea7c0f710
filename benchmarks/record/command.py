"""A command of ``uq``, carried out in a fork of this process."""

import contextlib
import os
import sys
import tempfile
import traceback


def reported(*arguments: str) -> dict[str, object]:
    """Return the exit code, output and errors of a command."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
        child = os.fork()
        if not child:
            os.dup2(out.fileno(), 1)
            os.dup2(errors.fileno(), 2)
            _carry_out(arguments)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        texts = []
        for file in (out, errors):
            file.seek(0)
            texts.append(file.read().decode())
    return {"code": code, "out": texts[0], "err": texts[1]}


def _carry_out(arguments: tuple[str, ...]) -> None:
    from uq.cli import main

    code = 99
    sys.argv = ["uq", *arguments]
    try:
        main()
    except SystemExit as end:
        code = int(end.code or 0)
    except BaseException:  # a crash is part of the record
        traceback.print_exc()
    with contextlib.suppress(BaseException):
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(code)
