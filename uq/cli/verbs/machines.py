"""The verbs that take a model."""

from pathlib import Path
from typing import Annotated

import typer

from uq.cli import options as given


def models(
    name: Annotated[
        str | None,
        typer.Argument(help="Show this model in full.", autocompletion=given.complete_model),
    ] = None,
    json: given.Json = False,
) -> None:
    """List the models, or show what one of them declares."""
    from uq.cli import catalogue
    from uq.cli.printing import print_json
    from uq.study.registry import find_model

    if name is None:
        listed = catalogue.list_models()
        print_json(listed) if json else catalogue.show_list(listed)
    else:
        model = find_model(name)
        print_json(catalogue.as_json(model)) if json else catalogue.show(model)


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
