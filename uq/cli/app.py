"""The verbs of ``uq``: what each is given, and what it calls.

Heavy modules are imported inside the verbs, so that ``uq --help`` answers at once.
"""

import sys
import webbrowser
from pathlib import Path
from typing import Annotated, Any

import typer

from uq.literals import plain_line

app = typer.Typer(
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _models(incomplete: str) -> list[str]:
    """Return the names that a shell may complete to."""
    from uq.study.registry import model_names

    return [name for name in model_names() if name.startswith(incomplete)]


ModelName = Annotated[
    str,
    typer.Argument(metavar="MODEL", help="As 'uq models' lists them.", autocompletion=_models),
]
StudyFile = Annotated[str, typer.Argument(metavar="STUDY", help="A study file (TOML).")]
ResultFile = Annotated[Path, typer.Argument(metavar="OUT.nc", help="A result of 'uq run'.")]
Json = Annotated[bool, typer.Option("--json", help="Machine-readable, full precision.")]
ModelReference = Annotated[
    str | None,
    typer.Option("--model", metavar="PKG.MOD:ATTR", help="Use a model that is not installed."),
]
Workers = Annotated[
    int | None,
    typer.Option(min=0, metavar="N", help="Worker processes; 0: compute in this process."),
]
Scheduler = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Use a running dask cluster.")
]
RowLimit = Annotated[
    float | None, typer.Option(metavar="S", help="Stop a row after so many seconds.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=VALUE", help="Set a numerical setting: TOML, or a bare word."),
]
Mixed = Annotated[
    bool, typer.Option("--mixed", help="Keep rows that other code of the model computed.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress, no summary.")]


def _show_version(wanted: bool) -> None:
    if wanted:
        from uq import __version__

        print(f"vibrolife {__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def begin(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", is_eager=True, callback=_show_version, help="Show the version."),
    ] = False,
) -> None:
    """Probabilistic lifetime and sensitivity studies of vibro-impact machines."""
    if context.invoked_subcommand is None:
        from uq.cli.guide import guide

        guide()


@app.command()
def models(
    name: Annotated[
        str | None, typer.Argument(help="Show this one in full.", autocompletion=_models)
    ] = None,
    json: Json = False,
) -> None:
    """List the models, or show all that one of them declares."""
    from uq.cli import catalogue
    from uq.cli.printing import print_json

    if name is None:
        listed = catalogue.list_models()
        print_json(listed) if json else catalogue.show_list(listed)
    else:
        described = catalogue.describe(name)
        print_json(catalogue.finite(described)) if json else catalogue.show(described)


@app.command()
def simulate(
    model: ModelName,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
    ] = None,
    setting: Settings = None,
    json: Json = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="TRAJ.nc", help="Write the trajectory here."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="F.png", help="Draw the trajectory here.")
    ] = None,
) -> int:
    """Run a model once, at its nominal values but for what is set."""
    from uq.cli import simulation

    return simulation.simulate(model, set_ or [], setting or [], json, output, plot)


@app.command()
def init(model: ModelName) -> None:
    """Print a commented study file to edit."""
    from uq.study.registry import find_model
    from uq.study.template import template

    print(template(find_model(model)), end="")


@app.command()
def check(study: StudyFile, model: ModelReference = None) -> None:
    """Check a study file and say what it would run."""
    from uq.cli import studies

    studies.check(study, model)


@app.command()
def schema() -> None:
    """Print the JSON Schema of study files, for an editor."""
    from uq.cli.printing import print_json
    from uq.study.schema import json_schema

    print_json(json_schema())


@app.command()
def plan(
    study: StudyFile,
    workers: Workers = None,
    samples: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Instead of the study's own.")
    ] = None,
    model: ModelReference = None,
    json: Json = False,
) -> None:
    """Say what a study will take, from a few of its rows."""
    from uq.cli.plan import plan as show_plan

    show_plan(study, model, samples, workers, json)


@app.command()
def run(
    study: StudyFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="OUT.nc", help="Default results/<name>.nc."),
    ] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    samples: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Instead of the study's own.")
    ] = None,
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
    from uq.cli import studies

    options: dict[str, Any] = {
        "workers": workers,
        "scheduler": scheduler,
        "chunk_rows": chunk_rows,
        "row_limit": row_limit,
        "mixed": mixed,
    }
    return studies.run(study, output, model, samples, fresh, quiet, options)


Regime = Annotated[str | None, typer.Option(metavar="NAME", help="Only the rows in this regime.")]


@app.command()
def status(result: ResultFile, json: Json = False) -> None:
    """Show where a run stands, also while it runs."""
    from uq.cli import upkeep
    from uq.cli.printing import print_json
    from uq.upkeep.status import standing

    print_json(standing(result)) if json else upkeep.show_status(standing(result))


@app.command()
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

    options: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    options |= {"row_limit": row_limit, "mixed": mixed}
    return upkeep.extend(result, samples, model, quiet, options)


@app.command()
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

    options: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    options |= {"row_limit": row_limit, "mixed": mixed}
    return upkeep.rerun(result, failed, setting or [], model, quiet, options)


@app.command()
def verify(result: ResultFile, model: ModelReference = None) -> int:
    """Check a result, and compute a few of its rows again."""
    from uq.cli import upkeep

    return upkeep.verify(result, model)


@app.command()
def summary(
    result: ResultFile,
    regime: Regime = None,
    fits: Annotated[
        bool, typer.Option("--fits", help="Fit Weibull and lognormal laws to lifetimes.")
    ] = False,
    json: Json = False,
) -> None:
    """Show how rows ended, and the statistics of each output."""
    from uq.analysis.as_json import summary_json
    from uq.analysis.summary import summarise
    from uq.cli import tables
    from uq.cli.printing import print_json
    from uq.rows.results import open_result

    ds = open_result(result)
    found = summarise(ds, regime=regime, fits=fits)
    print_json(summary_json(found)) if json else tables.show_summary(ds, found)


@app.command()
def sensitivity(
    result: ResultFile,
    output: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Only this output, or of it log(NAME), rank(NAME), ..."),
    ] = None,
    method: Annotated[str | None, typer.Option(metavar="M", help="Default: the study's.")] = None,
    regime: Regime = None,
    json: Json = False,
) -> None:
    """Show which inputs the scatter comes from."""
    from uq.cli import tables
    from uq.cli.printing import print_json
    from uq.indices.sensitivities import sensitivities
    from uq.rows.results import open_result

    found = sensitivities(open_result(result), method, output, regime)
    print_json(found) if json else tables.show_sensitivity(found)


@app.command()
def convergence(
    result: ResultFile,
    output: Annotated[str | None, typer.Option(metavar="NAME", help="Only this output.")] = None,
    json: Json = False,
) -> None:
    """Show whether it is enough: running estimates."""
    from uq.cli import estimates

    estimates.convergence(result, output, json)


@app.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="A.nc", help="A result of 'uq run'.")],
    second: Annotated[Path, typer.Argument(metavar="B.nc", help="Another, of the same model.")],
    json: Json = False,
) -> None:
    """Show what two studies of one model have different."""
    from uq.cli import comparing

    comparing.compare(first, second, json)


@app.command()
def twin(result: ResultFile, model: ModelReference = None, json: Json = False) -> None:
    """Sharpen estimates by many rows of a cheap output."""
    from uq.cli import estimates

    estimates.twin(result, model, json)


@app.command()
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
    workers: Annotated[
        int | None,
        typer.Option(min=0, metavar="N", help="Worker processes; 0: compute in this process."),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Use a running dask cluster.")
    ] = None,
    model: ModelReference = None,
    json: Json = False,
) -> int:
    """Estimate the probability of a rare event."""
    from uq.cli import estimates

    options: dict[str, Any] = {
        "method": method,
        "samples": samples,
        "replicates": replicates,
        "workers": workers,
        "scheduler": scheduler,
    }
    return estimates.rare_event(study, model, output, above, below, json, options)


@app.command()
def plot(
    result: ResultFile,
    folder: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Default: OUT.nc without its ending."),
    ] = None,
) -> None:
    """Draw the figures of a result into a folder."""
    from uq.plots import save_all
    from uq.rows.results import open_result

    for path in save_all(open_result(result), folder or result.with_suffix("")):
        print(path)


@app.command()
def report(
    result: ResultFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Default: OUT.html beside OUT.nc."),
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Open it in the browser.")] = False,
) -> None:
    """Write all that a result says into one page for a browser."""
    from uq.report import write_report

    path = output or result.with_suffix(".html")
    write_report(result, path)
    print(plain_line(str(path)))
    if show and not webbrowser.open(path.resolve().as_uri()):
        print("no browser was found; open this file yourself", file=sys.stderr)
