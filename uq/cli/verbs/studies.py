"""The verbs that take a study file."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from uq.cli.options import (
    Json,
    Mixed,
    ModelName,
    ModelReference,
    Quiet,
    RowLimit,
    Samples,
    Scheduler,
    StudyFile,
    Workers,
)


def init(model: ModelName) -> None:
    """Print a commented study file to edit."""
    from uq.study.registry import find_model
    from uq.study.template import template

    print(template(find_model(model)), end="")


def check(study: StudyFile, model: ModelReference = None) -> None:
    """Check a study file and say what it would run."""
    from uq.cli.check import check as show_check

    show_check(study, model)


def schema() -> None:
    """Print the JSON Schema of study files, for an editor."""
    from uq.cli.printing import print_json
    from uq.study.schema import json_schema

    print_json(json_schema())


def plan(
    study: StudyFile,
    workers: Workers = None,
    samples: Samples = None,
    model: ModelReference = None,
    json: Json = False,
) -> None:
    """Say what a study will take, from a few of its rows."""
    from uq.cli.plan import plan as show_plan

    show_plan(study, model, samples, workers, json)


def run(
    study: StudyFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT.nc", help="Default results/<name>.nc."),
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    samples: Samples = None,
    chunk_rows: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Rows per task; default: 0.5 to 5 s.")
    ] = None,
    row_limit: RowLimit = None,
    model: ModelReference = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Overwrite whatever OUT.nc is.")] = False,
    mixed: Mixed = False,
    quiet: Quiet = False,
) -> int:
    """Run a study, or go on where it stopped; show the summary."""
    from uq.cli.run import run as run_and_show
    from uq.running.options import RunOptions

    options = RunOptions(workers, scheduler, chunk_rows, row_limit, fresh, mixed)
    return run_and_show(study, output, model, samples, quiet, options)


def rare_event(
    study: StudyFile,
    output: Annotated[str, typer.Option(metavar="NAME", help="Output, or element of one.")],
    above: Annotated[
        float | None, typer.Option(metavar="T", help="Probability of lying above.")
    ] = None,
    below: Annotated[
        float | None, typer.Option(metavar="T", help="Probability of lying below.")
    ] = None,
    method: Annotated[
        str, typer.Option(metavar="M", help="subset, or importance (FORM; smooth outputs).")
    ] = "subset",
    samples: Annotated[int, typer.Option(metavar="N", help="Rows of each level.")] = 1000,
    replicates: Annotated[int, typer.Option(metavar="R", help="Repetitions of it all.")] = 8,
    workers: Workers = None,
    scheduler: Scheduler = None,
    model: ModelReference = None,
    json: Json = False,
) -> int:
    """Estimate the probability of a rare event."""
    from uq.cli.rare_event import rare_event as estimate_and_show
    from uq.exploring import rare_events

    estimate = partial(
        rare_events.rare_event,
        method=method,
        samples=samples,
        replicates=replicates,
        workers=workers,
        scheduler=scheduler,
    )
    return estimate_and_show(study, model, output, above, below, json, estimate)
