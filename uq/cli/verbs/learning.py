"""The verbs that learn from inspections."""

from pathlib import Path
from typing import Annotated

import typer

from uq.cli import options as given
from uq.execution.options import RunOptions


def update(
    source: Annotated[
        Path, typer.Argument(metavar="STUDY|OUT.nc", help="A study (TOML), or a result.")
    ],
    inspections: Annotated[
        Path, typer.Argument(metavar="INSPECTIONS.csv", help="What was measured.")
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="POSTERIOR.nc", help="Where to write it.")
    ],
    rows: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Rows of a study; new rows of a result.")
    ] = None,
    model_error: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="CV", help="Scatter of reality about the model."),
    ] = None,
    by: given.Times = None,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    model: given.ModelReference = None,
    quiet: given.Quiet = False,
    json: given.Json = False,
) -> int:
    """Learn from inspections about inputs, units and lives."""
    from uq.cli import learning

    options = RunOptions(workers, scheduler)
    return learning.update(
        source,
        inspections,
        output,
        rows,
        model_error,
        by or [],
        model,
        options,
        quiet or json,
        json,
    )


def next_inspection(
    result: given.ResultFile,
    inspect: Annotated[
        str, typer.Option(metavar="OUTPUT", help="What to inspect, such as 'depth'.")
    ],
    at: given.Times = None,
    units: Annotated[
        list[int] | None, typer.Option(min=1, metavar="N", help="How many more units.")
    ] = None,
    cv: Annotated[float, typer.Option(min=0.0, help="Error of the measurement.")] = 0.1,
    life: Annotated[str | None, typer.Option(metavar="NAME", help="The life to narrow.")] = None,
    json: given.Json = False,
) -> None:
    """Estimate the worth of inspecting more units."""
    from uq.cli import next_inspection as question

    question.next_inspection(result, inspect, at or [], units or [1, 5, 20], cv, life, json)
