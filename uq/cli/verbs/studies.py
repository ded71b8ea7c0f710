"""The verbs that take a model or a study file."""

import sys
from contextlib import redirect_stdout
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from uq.cli import ask_for_plain_arrays, completion, say_when_interrupted
from uq.cli import options as given
from uq.errors import InputError
from uq.execution.options import RunOptions


def models(
    name: Annotated[
        str | None,
        typer.Argument(help="Show this model in full.", autocompletion=completion.complete_model),
    ] = None,
    json: given.Json = False,
) -> None:
    """List the models, or show the declarations of one of them."""
    from uq.cli import models
    from uq.cli.printing import print_json
    from uq.execution.loading import load_model

    if name is None:
        listed = models.list_models()
        print_json(listed) if json else models.show_list(listed)
    else:
        model = load_model(name)
        print_json(models.as_json(model)) if json else models.show(model)


def simulate(
    model: given.ModelName,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
    ] = None,
    setting: given.Settings = None,
    json: given.Json = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="TRAJ.nc", help="Write the trajectory here."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="F.png", help="Draw the trajectory here.")
    ] = None,
) -> int:
    """Run a model once, at its nominal values except where set."""
    from uq.cli import simulate as single

    return single.simulate(model, set_ or [], setting or [], json, output, plot)


def init(
    model: Annotated[
        str | None,
        typer.Argument(metavar="MODEL", help="A model.", autocompletion=completion.complete_model),
    ] = None,
    machine: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Write a folder with a machine of your own instead."),
    ] = None,
    from_: Annotated[
        str | None,
        typer.Option(
            "--from",
            metavar="STUDY",
            help="Print a variant of this study.",
            autocompletion=completion.complete_study,
        ),
    ] = None,
    design: Annotated[
        str | None,
        typer.Option(
            metavar="METHOD",
            help="Another design.",
            autocompletion=completion.complete_design,
        ),
    ] = None,
    name: Annotated[str | None, typer.Option(metavar="NAME", help="Name of the study.")] = None,
    own_model: given.ModelReference = None,
    output: Annotated[str | None, typer.Option("-o", "--output", hidden=True)] = None,
) -> None:
    """Print a study file to edit, or write a new machine."""
    if [model, machine, from_].count(None) != 2:
        raise InputError("uq init: give one of MODEL, --from STUDY and --machine NAME")
    if output is not None:
        asked = f"--from {from_}" if from_ else model or "MODEL"
        raise InputError(f"uq init prints the study: uq init {asked} > {output}")
    if machine is not None and (design or name):
        raise InputError("uq init: --design and --name are of a study, not of a machine")
    if from_ is None and own_model:
        raise InputError("uq init: --model goes with --from STUDY; else it is the argument")
    if from_ is not None:
        from uq.execution.loading import load_study
        from uq.study.template import variant

        print(variant(load_study(from_, own_model), design, name), end="")
        return
    if machine is not None:
        from uq.cli.models import write_machine

        write_machine(machine)
        return
    assert model is not None
    from uq.execution.loading import load_model
    from uq.study.template import template

    print(template(load_model(model), model, design, name), end="")


def check(study: given.StudyFile, model: given.ModelReference = None) -> None:
    """Check a study file and show what it would run."""
    from uq.cli.check import check as show_check

    show_check(study, model)


def serve(
    model: given.ModelName,
    port: Annotated[int, typer.Option(min=0, max=65535, help="0: any free one.")] = 4242,
    host: Annotated[
        str, typer.Option(metavar="HOST", help="Anyone who can reach it can run rows.")
    ] = "127.0.0.1",
) -> None:
    """Offer a model to other programs (UM-Bridge)."""
    from uq.execution.loading import load_model
    from uq.machines.serving import address_of, server_of

    loaded_model = load_model(model)
    server = server_of(loaded_model, host, port)
    say_when_interrupted("stopped")
    with server:
        print(address_of(host, server.server_address[1], loaded_model.name), flush=True)
        with redirect_stdout(sys.stderr):  # who reads the address may leave before a row prints
            server.serve_forever()


def schema(
    machine: Annotated[bool, typer.Option("--machine", help="That of machine files.")] = False,
) -> None:
    """Print the JSON Schema of study files, for an editor."""
    from uq.cli.printing import print_json
    from uq.machines.program import machine_schema
    from uq.study.schema import json_schema

    print_json(machine_schema() if machine else json_schema())


def plan(
    study: given.StudyFile,
    workers: given.Workers = None,
    samples: given.Samples = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> None:
    """Estimate the cost and the interval widths of a study."""
    from uq.cli.check import plan as show_plan
    from uq.cli.progress import say_plain
    from uq.cli.run import loaded
    from uq.study.hints import hints

    asked = loaded(study, model, samples)
    say_plain(*hints(asked))
    show_plan(asked, workers, json)


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
    """Run a study, or resume it; show the summary."""
    if scheduler is None:
        ask_for_plain_arrays()

    from uq.cli.run import carried_out, end, loaded
    from uq.execution.runner import finished, output_path, run_study
    from uq.result.result import Result

    asked = loaded(study, model, samples, row_limit)
    target = output_path(asked, output)
    if not fresh and (ds := finished(asked, target)) is not None:
        note = f"{target} is already complete; nothing was computed (--fresh recomputes it)"
    else:
        options = RunOptions(workers, scheduler, chunk_rows, row_limit, fresh, mixed)
        ds, note = carried_out(target, quiet, options, partial(run_study, asked, target))
    return end(asked, Result(ds), target, quiet, note, mixed)


def rare_event(
    study: given.StudyFile,
    output: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Output, or one of its elements.",
            autocompletion=completion.complete_output,
        ),
    ] = None,
    above: Annotated[
        str | None, typer.Option(metavar="T", help="Probability of exceeding T.")
    ] = None,
    below: Annotated[
        str | None, typer.Option(metavar="T", help="Probability of staying below T.")
    ] = None,
    any_of: Annotated[
        list[str] | None,
        typer.Option(
            "--any", metavar="LIMIT", help='Several limits, such as --any "a > 3" --any "b < 1".'
        ),
    ] = None,
    all_of: Annotated[
        list[str] | None, typer.Option("--all", metavar="LIMIT", help="The same, all at once.")
    ] = None,
    method: Annotated[
        str,
        typer.Option(metavar="M", help="subset, importance (FORM), or active (dear rows)."),
    ] = "subset",
    samples: Annotated[
        int | None,
        typer.Option(metavar="N", help="Rows of each level, 1000; of active: in all, 300."),
    ] = None,
    replicates: Annotated[
        int | None, typer.Option(metavar="R", help="Repetitions of the procedure, 8.")
    ] = None,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> int:
    """Estimate the probability of a rare event."""
    from uq.cli.progress import say
    from uq.cli.rare_event import limits, show, warn, written
    from uq.execution.loading import load_study
    from uq.explore import rare_events

    loaded = load_study(study, model, say)
    event = limits(loaded, output, above, below, any_of or [], all_of or [])
    warn(loaded, event)
    say_when_interrupted("interrupted; nothing was written")
    ds = rare_events.rare_event(
        loaded,
        method=method,
        samples=samples,
        replicates=replicates,
        workers=workers,
        scheduler=scheduler,
        **event,
    )
    return show(ds, json, loaded, *(threshold for _, threshold in written(event)))
