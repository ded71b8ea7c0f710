"""The verbs that are about a run: where it stands, more of it, failed rows again."""

from typing import Annotated

import typer

from uq.cli.options import (
    Json,
    Mixed,
    ModelReference,
    Quiet,
    ResultFile,
    RowLimit,
    Scheduler,
    Settings,
    Workers,
)


def status(result: ResultFile, json: Json = False) -> None:
    """Show where a run stands, also while it runs."""
    from uq.cli import upkeep

    upkeep.status(result, json)


def extend(
    result: ResultFile,
    samples: Annotated[int, typer.Option(min=1, metavar="N", help="As many in all.")],
    workers: Workers = None,
    scheduler: Scheduler = None,
    row_limit: RowLimit = None,
    model: ModelReference = None,
    mixed: Mixed = False,
    quiet: Quiet = False,
) -> int:
    """Give a result more samples; nothing is computed again."""
    from uq.cli import upkeep
    from uq.running.options import RunOptions

    options = RunOptions(workers, scheduler, row_limit=row_limit, mixed=mixed)
    return upkeep.extend(result, samples, model, quiet, options)


def rerun(
    result: ResultFile,
    failed: Annotated[bool, typer.Option("--failed", help="The rows that failed.")] = False,
    setting: Settings = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    row_limit: RowLimit = None,
    model: ModelReference = None,
    mixed: Mixed = False,
    quiet: Quiet = False,
) -> int:
    """Compute the failed rows of a result again."""
    from uq.cli import upkeep
    from uq.running.options import RunOptions

    options = RunOptions(workers, scheduler, row_limit=row_limit, mixed=mixed)
    return upkeep.rerun(result, failed, setting or [], model, quiet, options)


def verify(result: ResultFile, model: ModelReference = None) -> int:
    """Check a result, and compute a few of its rows again."""
    from uq.cli import upkeep

    return upkeep.verify(result, model)
