"""The verbs that take a study file."""

from pathlib import Path
from typing import Annotated

import typer

from uq.cli import options as given
from uq.running.options import RunOptions


def init(model: given.ModelName) -> None:
    """Print a commented study file to edit."""
    from uq.study.registry import find_model
    from uq.study.template import template

    print(template(find_model(model)), end="")


def check(study: given.StudyFile, model: given.ModelReference = None) -> None:
    """Check a study file and show what it would run."""
    from uq.cli.check import check as show_check

    show_check(study, model)


def schema() -> None:
    """Print the JSON Schema of study files, for an editor."""
    from uq.cli.printing import print_json
    from uq.study.schema import json_schema

    print_json(json_schema())


def plan(
    study: given.StudyFile,
    workers: given.Workers = None,
    samples: given.Samples = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> None:
    """Estimate what a study will take, from a few of its rows."""
    from uq.cli.plan import plan as show_plan

    show_plan(study, model, samples, workers, json)


def run(
    study: given.StudyFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT.nc", help="Default results/<name>.nc."),
    ] = None,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    samples: given.Samples = None,
    chunk_rows: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Rows per task; default: 0.5 to 5 s.")
    ] = None,
    row_limit: given.RowLimit = None,
    model: given.ModelReference = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Overwrite OUT.nc, whatever it is.")
    ] = False,
    mixed: given.Mixed = False,
    quiet: given.Quiet = False,
) -> int:
    """Run a study, or resume it where it stopped; show the summary."""
    from uq.cli.run import run as run_and_show

    options = RunOptions(workers, scheduler, chunk_rows, row_limit, fresh, mixed)
    return run_and_show(study, output, model, samples, quiet, options)


def rare_event(
    study: given.StudyFile,
    output: Annotated[str, typer.Option(metavar="NAME", help="Output, or one of its elements.")],
    above: Annotated[
        float | None, typer.Option(metavar="T", help="Probability of exceeding T.")
    ] = None,
    below: Annotated[
        float | None, typer.Option(metavar="T", help="Probability of staying below T.")
    ] = None,
    method: Annotated[
        str, typer.Option(metavar="M", help="subset, or importance (FORM; smooth outputs).")
    ] = "subset",
    samples: Annotated[int, typer.Option(metavar="N", help="Rows of each level.")] = 1000,
    replicates: Annotated[int, typer.Option(metavar="R", help="Repetitions of the whole.")] = 8,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> int:
    """Estimate the probability of a rare event."""
    from uq.cli.rare_event import rare_event as estimate_and_show

    options = {"method": method, "samples": samples, "replicates": replicates}
    options |= {"workers": workers, "scheduler": scheduler}
    return estimate_and_show(study, model, output, above, below, json, options)
