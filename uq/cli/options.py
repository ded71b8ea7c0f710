"""Arguments and options shared by several verbs of ``uq``, with their help."""

from pathlib import Path
from typing import Annotated

import typer

from uq.cli.completion import (
    complete_model,
    complete_output,
    complete_result,
    complete_study,
)

ModelName = Annotated[
    str,
    typer.Argument(
        metavar="MODEL",
        help="A name from 'uq models', or a file such as pad.py.",
        autocompletion=complete_model,
    ),
]
StudyFile = Annotated[
    str,
    typer.Argument(metavar="STUDY", help="A study file (TOML).", autocompletion=complete_study),
]
ResultFile = Annotated[
    Path,
    typer.Argument(metavar="OUT.nc", help="A result of 'uq run'.", autocompletion=complete_result),
]
Json = Annotated[bool, typer.Option("--json", help="Machine-readable, full precision.")]
Explain = Annotated[bool, typer.Option("--explain", help="Show the answer in sentences.")]
Full = Annotated[bool, typer.Option("--full", help="Show statistics of each output.")]
Plain = Annotated[bool, typer.Option("--plain", help="No exact integration: lives as computed.")]
ModelReference = Annotated[
    str | None,
    typer.Option(
        "--model",
        metavar="FILE.py",
        help="A model of your own: FILE.py[:NAME], FILE.toml, FILE.fmu, http://..., MOD:ATTR.",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option(min=0, metavar="N", help="Worker processes, or jobs; 0: compute in this process."),
]
Samples = Annotated[
    int | None, typer.Option(min=1, metavar="N", help="Overrides the study's number.")
]
Scheduler = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Use a running dask cluster.")
]
RowLimit = Annotated[float | None, typer.Option(metavar="S", help="Stop a row after S seconds.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=VALUE", help="Set a numerical setting: TOML, or a bare word."),
]
Mixed = Annotated[
    bool, typer.Option("--mixed", help="Keep rows from another version of the model.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress, no summary.")]
OnlyOutput = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="Only this output.", autocompletion=complete_output),
]
Times = Annotated[
    list[str] | None,
    typer.Option(metavar="T", help='Time in the unit of the life, or such as "30 days".'),
]
Regime = Annotated[str | None, typer.Option(metavar="NAME", help="Only the rows in this regime.")]
