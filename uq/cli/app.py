"""The command ``uq``: its verbs, in the order of ``uq --help``."""

from typing import Annotated

import typer

from uq.cli.verbs import results, studies
from uq.cli.verbs.results import next_inspection, update

VERBS = (
    studies.models,
    studies.simulate,
    studies.init,
    studies.check,
    studies.schema,
    studies.serve,
    studies.plan,
    studies.run,
    results.status,
    results.extend,
    results.rerun,
    results.verify,
    results.row,
    results.summary,
    results.sensitivity,
    results.levels,
    results.fleet,
    results.convergence,
    results.compare,
    results.what_if,
    update,
    next_inspection,
    results.twin,
    results.trace,
    studies.rare_event,
    results.plot,
    results.report,
)

app = typer.Typer(pretty_exceptions_enable=False, rich_markup_mode=None)
for verb in VERBS:
    app.command()(verb)


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
