"""The verbs about a run: its progress, more samples, failed rows again."""

from functools import partial
from typing import Annotated

import typer

from uq.cli import options as given
from uq.errors import InputError
from uq.running.options import RunOptions


def status(result: given.ResultFile, json: given.Json = False) -> None:
    """Show the progress of a run, also while it runs."""
    from uq.cli import upkeep

    upkeep.status(result, json)


def extend(
    result: given.ResultFile,
    samples: Annotated[int, typer.Option(min=1, metavar="N", help="Total number of samples.")],
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    row_limit: given.RowLimit = None,
    model: given.ModelReference = None,
    mixed: given.Mixed = False,
    quiet: given.Quiet = False,
) -> int:
    """Give a result more samples; nothing is computed again."""
    from uq.cli.run import amended
    from uq.upkeep import amending

    options = RunOptions(workers, scheduler, row_limit=row_limit, mixed=mixed)
    action = partial(amending.extend, result, samples, model)
    return amended(result, model, quiet, options, action)


def rerun(
    result: given.ResultFile,
    failed: Annotated[bool, typer.Option("--failed", help="The rows that failed.")] = False,
    setting: given.Settings = None,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    row_limit: given.RowLimit = None,
    model: given.ModelReference = None,
    mixed: given.Mixed = False,
    quiet: given.Quiet = False,
) -> int:
    """Recompute the failed rows of a result."""
    from uq.cli.run import amended
    from uq.cli.simulate import literal
    from uq.upkeep.amending import rerun_failed

    if not failed:
        raise InputError("uq rerun: give --failed, the rows to compute again")
    options = RunOptions(workers, scheduler, row_limit=row_limit, mixed=mixed)
    action = partial(rerun_failed, result, dict(map(literal, setting or [])), model)
    return amended(result, model, quiet, options, action)


def verify(result: given.ResultFile, model: given.ModelReference = None) -> int:
    """Check a result, and recompute a few of its rows."""
    from uq.cli import upkeep

    return upkeep.verify(result, model)
