"""The command ``uq``: its verbs in groups, in the order of ``uq --help``."""

from collections.abc import Callable
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from uq.cli.verbs import results, studies

GROUPS: dict[str, dict[Callable[..., Any], str]] = {
    "Start": {
        studies.models: "uq models exponential-wear",
        studies.init: "uq init exponential-wear > mine.toml",
        studies.simulate: "uq simulate exponential-wear --set rate=3e-10",
        results.import_: "uq import rods.csv -o results/rods.nc --life hours --unit h",
        studies.schema: "uq schema > vibrolife-study.schema.json",
        studies.serve: "uq serve exponential-wear --port 4242",
    },
    "Run": {
        studies.plan: "uq plan studies/exponential-wear.toml",
        studies.run: "uq run studies/exponential-wear.toml",
        results.status: "uq status results/exponential-wear.nc",
        results.extend: "uq extend results/exponential-wear.nc --samples 4000",
        results.next_rows: (
            "uq next-rows results/vibrator-tolerances.nc -n 20 --output disphasing_angle"
        ),
        results.rerun: "uq rerun results/exponential-wear.nc --failed",
    },
    "Read": {
        results.summary: "uq summary results/exponential-wear.nc",
        results.sensitivity: "uq sensitivity results/exponential-wear.nc --output life",
        results.levels: "uq levels results/mole-outcome.nc",
        results.twin: "uq twin results/vibrator-tolerances.nc",
        results.emulate: "uq emulate results/ishigami.nc -o ishigami.emulator",
        results.export: "uq export results/exponential-wear.nc --csv rows.csv",
        results.plot: "uq plot results/exponential-wear.nc",
        results.report: "uq report results/exponential-wear.nc --open",
    },
    "Decide": {
        results.compare: "uq compare results/exponential-wear.nc results/other.nc",
        results.what_if: "uq what-if results/exponential-wear.nc --set uncertain.rate.sigma=0.25",
        results.fleet: 'uq fleet results/fleet.nc --size 100 --by "30 days"',
        studies.rare_event: (
            'uq rare-event studies/exponential-wear.toml --output life --below "2 days"'
        ),
    },
    "Learn": {
        results.update: "uq update results/fleet.nc inspections.csv -o results/posterior.nc",
        results.next_inspection: 'uq next-inspection results/fleet.nc --inspect life --at "1 year"',
    },
    "Check": {
        studies.check: "uq check studies/exponential-wear.toml",
        results.convergence: "uq convergence results/exponential-wear.nc",
        results.verify: "uq verify results/exponential-wear.nc",
        results.row: "uq row results/exponential-wear.nc --lowest life",
        results.trace: "uq trace results/exponential-wear.nc outputs/life/quantiles/0.05",
    },
}
"""Heading of ``uq --help`` -> its verbs, each with an example."""

VERBS = tuple(verb for group in GROUPS.values() for verb in group)


class _Grouped(TyperGroup):
    """A group whose help lists its commands under the headings that they name."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        widest = max(map(len, self.commands))
        room = formatter.width - widest - 6
        for heading in GROUPS:
            listed = [
                (name.ljust(widest), command.get_short_help_str(room))
                for name, command in self.commands.items()
                if getattr(command, "rich_help_panel", None) == heading
            ]
            with formatter.section(typer.style(heading, bold=True)):
                formatter.write_dl(listed)


app = typer.Typer(
    cls=_Grouped,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for heading, group in GROUPS.items():
    for verb, example in group.items():
        name = verb.__name__.rstrip("_").replace("_", "-")
        app.command(name, rich_help_panel=heading, epilog=f"\b\nExample:\n  {example}")(verb)


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
        from uq.cli.models import guide

        guide()
