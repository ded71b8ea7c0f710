"""The verbs that ask a model."""

from pathlib import Path
from typing import Annotated

import typer

from uq.cli.options import Json, ModelName, Settings, complete_model


def models(
    name: Annotated[
        str | None, typer.Argument(help="Show this one in full.", autocompletion=complete_model)
    ] = None,
    json: Json = False,
) -> None:
    """List the models, or show all that one of them declares."""
    from uq.cli import catalogue
    from uq.cli.printing import print_json
    from uq.study.registry import find_model

    if name is None:
        listed = catalogue.list_models()
        print_json(listed) if json else catalogue.show_list(listed)
    else:
        model = find_model(name)
        print_json(catalogue.finite(catalogue.as_json(model))) if json else catalogue.show(model)


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
    from uq.cli import simulate as single

    return single.simulate(model, set_ or [], setting or [], json, output, plot)
