"""The verbs that take a result, or learn from inspections."""

import sys
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uq.cli import completion, streams
from uq.cli import options as given
from uq.errors import InputError
from uq.execution.options import RunOptions
from uq.text.literals import plain_line

if TYPE_CHECKING:
    import xarray as xr

    from uq.result.result import Result

_LARGEST = 20_000_000  # bytes: their checksum takes a small part of the time of a summary


def status(result: given.ResultFile, json: given.Json = False) -> None:
    """Show the progress of a run, also while it runs."""
    from uq.cli import status

    status.status(result, json)


_Aimed = Annotated[
    str,
    typer.Option(
        "--output",
        metavar="NAME",
        help="Learn this output; without it, fill the space.",
        autocompletion=completion.complete_output,
    ),
]
_Near = Annotated[
    str | None,
    typer.Option("--near", metavar="Y", help='Learn which are beyond, such as "12 degrees".'),
]


def _aim(result: "Result", output: str, near: str | None) -> tuple[str, float | None]:
    """Return the element to learn, and the value near which rows are wanted."""
    from uq.text.quantities import read_threshold

    if near is None:
        return output, None
    if not output:
        raise InputError("--near: name the output, --output NAME")
    unit = result.named_elements(output)[0].units
    return output, read_threshold("--near", near, output, unit)


_ON_A_LINE = 4
"""Numbers of a proposed row, or rows side by side."""


def next_rows(
    result: given.ResultFile,
    number: Annotated[int, typer.Option("-n", "--rows", min=5, metavar="N", help="How many.")] = 20,
    output: _Aimed = "",
    near: _Near = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> None:
    """Propose rows to compute next.

    'uq extend --next N' computes the same rows.
    """
    from uq.cli import printing
    from uq.explore import next_rows as proposal
    from uq.result.result import Result

    opened = Result.open(result)
    table = proposal.next_rows(opened, number, *_aim(opened, output, near), model)
    if json:
        printing.print_json({name: column.tolist() for name, column in table.items()})
        return
    cells = [(str(i), *(f"{value:.6g}" for value in row)) for i, row in enumerate(table.to_numpy())]
    if len(table.columns) <= _ON_A_LINE:
        printing.grid(cells, header=("", *table.columns))
    else:
        for first in range(0, number, _ON_A_LINE):
            numbers, *lines = zip(
                ("", *table.columns), *cells[first : first + _ON_A_LINE], strict=True
            )
            printing.grid(lines, header=numbers)
    printing.note("weight: how much the row counts, against 1 of a row of the study")


def extend(
    result: given.ResultFile,
    samples: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Total number of samples.")
    ] = None,
    next_: Annotated[
        int | None,
        typer.Option("--next", min=5, metavar="N", help="Add rows where they teach most."),
    ] = None,
    into: Annotated[
        Path | None, typer.Option("-o", metavar="NEW.nc", help="With --next: where to write.")
    ] = None,
    output: _Aimed = "",
    near: _Near = None,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    row_limit: given.RowLimit = None,
    model: given.ModelReference = None,
    mixed: given.Mixed = False,
    quiet: given.Quiet = False,
) -> int:
    """Add samples to a result; existing rows are kept."""
    from uq.cli.run import amended
    from uq.execution import amending

    options = RunOptions(workers, scheduler, row_limit=row_limit, mixed=mixed)
    if next_ is not None:
        if samples is not None or into is None:
            raise InputError("uq extend: --next N needs -o NEW.nc, and excludes --samples")
        return _by_next(result, next_, (output, near), into, model, options, quiet)
    if samples is None or into or output or near is not None:
        raise InputError("uq extend: add --samples N, or --next N -o NEW.nc")
    action = partial(amending.extend, result, samples, model)
    return amended(result, model, quiet, options, action)


def _by_next(
    result: Path,
    rows: int,
    aim: tuple[str, str | None],
    into: Path,
    model: str | None,
    options: RunOptions,
    quiet: bool,
) -> int:
    from uq.cli.run import carried_out
    from uq.cli.summary_tables import show_card
    from uq.explore.next_rows import Aim, extend_by_next
    from uq.result.result import Result

    opened = Result.open(result)

    def action(options: RunOptions) -> "xr.Dataset":
        return extend_by_next(opened, rows, Aim(*_aim(opened, *aim)), into, model, options)

    _, note = carried_out(into, quiet, options, action)
    if not quiet:
        show_card(into, [note])
    return 0


def rerun(
    result: given.ResultFile,
    failed: Annotated[bool, typer.Option("--failed", help="The invalid rows.")] = False,
    setting: given.Settings = None,
    workers: given.Workers = None,
    scheduler: given.Scheduler = None,
    row_limit: given.RowLimit = None,
    model: given.ModelReference = None,
    mixed: given.Mixed = False,
    quiet: given.Quiet = False,
) -> int:
    """Recompute the invalid rows of a result."""
    from uq.cli.run import amended
    from uq.cli.simulate import literal
    from uq.execution.amending import rerun_failed

    if not failed:
        raise InputError("uq rerun: add --failed: it recomputes the invalid rows")
    options = RunOptions(workers, scheduler, row_limit=row_limit, mixed=mixed)
    action = partial(rerun_failed, result, dict(map(literal, setting or [])), model)
    return amended(result, model, quiet, options, action)


def verify(result: given.ResultFile, model: given.ModelReference = None) -> int:
    """Check a result, and recompute a few of its rows."""
    from uq.cli import status

    return status.verify(result, model)


def row(
    result: given.ResultFile,
    number: Annotated[
        int | None, typer.Argument(min=0, metavar="N", help="Number of the row, from 0.")
    ] = None,
    lowest: Annotated[
        str | None,
        typer.Option(
            metavar="OUTPUT",
            help="The row with the lowest value.",
            autocompletion=completion.complete_output,
        ),
    ] = None,
    highest: Annotated[
        str | None,
        typer.Option(
            metavar="OUTPUT",
            help="The row with the highest value.",
            autocompletion=completion.complete_output,
        ),
    ] = None,
    near_quantile: Annotated[
        tuple[float, str] | None,
        typer.Option(metavar="P OUTPUT", help="The row closest to this quantile."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="F.png", help="Draw its trajectory here.")
    ] = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> int:
    """Show one row, and compute it again."""
    from uq.cli import status as single

    return single.row(result, number, lowest, highest, near_quantile, plot, model, json)


def summary(
    result: given.ResultFile,
    regime: given.Regime = None,
    fits: Annotated[
        bool, typer.Option("--fits", help="Fit laws to lifetimes by maximum likelihood.")
    ] = False,
    plain: given.Plain = False,
    explain: given.Explain = False,
    full: given.Full = False,
    json: given.Json = False,
) -> None:
    """Show the answer on a card, in sentences or in tables."""
    from uq.assess.answer.answer import conclude
    from uq.assess.card import card_of
    from uq.assess.findings import Findings
    from uq.assess.regimes import boundary_facts
    from uq.assess.summary import summarise
    from uq.assess.summary_facts import summary_facts
    from uq.cli import summary_tables
    from uq.cli.printing import print_json
    from uq.result.result import Result

    opened = Result.open(result)
    findings = Findings(opened)
    answered = regime is None and not plain  # the answer is that of all rows
    statistics = None
    if fits or not answered:
        statistics = summarise(opened, regime=regime, fits=fits, plain=plain)
    if json:
        answer = conclude(findings) if answered else None
        facts = summary_facts(statistics or findings.summary).json
        if answer is not None:
            facts |= boundary_facts(opened, findings.boundary).json
            facts |= {"answer": answer.fact.json, "card": card_of(findings, answer).json}
        print_json(facts)
    elif answered and not fits:
        summary_tables.show_findings(findings, explain=explain, full=full)
    else:
        summary_tables.show_summary(opened, statistics or findings.summary)
    _warn_if_altered(result)


def import_(
    data: Annotated[Path, typer.Argument(metavar="DATA.csv", help="Lives, one row each.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="OUT.nc", help="Where to write the result.")
    ],
    life: Annotated[
        str, typer.Option(metavar="COLUMN", help="Life, or time of censoring; names the output.")
    ],
    unit: Annotated[
        str, typer.Option(metavar="UNIT", help="Of all times, such as h; or in the headings.")
    ] = "",
    censored: Annotated[
        str, typer.Option(metavar="COLUMN", help="1 where the life had not ended, else 0.")
    ] = "",
    low: Annotated[
        str, typer.Option(metavar="COLUMN", help="Known to end after this time; 0 or empty: any.")
    ] = "",
    high: Annotated[
        str, typer.Option(metavar="COLUMN", help="And not after this one; empty: has not ended.")
    ] = "",
    entered: Annotated[
        str, typer.Option(metavar="COLUMN", help="Age at the start of observation (late entry).")
    ] = "",
    cause: Annotated[
        str, typer.Option(metavar="COLUMN", help="Event that ended the life; empty: none.")
    ] = "",
    threshold: given.Times = None,
    quiet: given.Quiet = False,
) -> None:
    """Read lives from the field into a result.

    Other columns of numbers become inputs.
    """
    from uq.cli import summary_tables
    from uq.files.whole_files import check_target, write_result
    from uq.result.life_record import RecordColumns, read_lives

    check_target(output, 0)
    columns = RecordColumns(life, unit, censored, low, high, entered, cause)
    record, notes = read_lives(data, columns, [_number_or_text(at) for at in threshold or ()])
    with _naming_new_folders(output):
        write_result(record, output)
    if not quiet:
        summary_tables.show_card(output, notes)


def _number_or_text(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def export(
    result: given.ResultFile,
    csv: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Comma-separated, units in the headings.")
    ] = None,
    parquet: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Parquet; needs pyarrow.")
    ] = None,
) -> None:
    """Write the rows as a table: inputs, outputs, status."""
    from uq.result.result import Result
    from uq.result.row_table import write_rows

    with _naming_new_folders(csv, parquet):
        files = write_rows(Result.open(result), csv, parquet)
    for file in files:
        print(file)


def sensitivity(
    result: given.ResultFile,
    output: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Only this output, or log(NAME), rank(NAME), ... of it.",
            autocompletion=completion.complete_output,
        ),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            metavar="M", help="Default: the study's.", autocompletion=completion.complete_method
        ),
    ] = None,
    regime: given.Regime = None,
    json: given.Json = False,
) -> None:
    """Show which inputs cause the scatter."""
    from uq.assess.sensitivities import sensitivities
    from uq.assess.sensitivity_table import sensitivity_facts
    from uq.cli.printing import print_json
    from uq.cli.sensitivity import show
    from uq.result.result import Result

    opened = Result.open(result)
    indices = sensitivities(opened, method, output, regime)
    print_json(sensitivity_facts(indices).json) if json else show(opened, indices)


def levels(
    result: given.ResultFile,
    output: given.OnlyOutput = None,
    plain: given.Plain = False,
    json: given.Json = False,
) -> None:
    """Show variance components: shared, per unit, and chance."""
    from uq.cli.sensitivity import levels as show_levels

    show_levels(result, output, plain, json)


def fleet(
    result: given.ResultFile,
    size: Annotated[int, typer.Option(min=1, metavar="N", help="Number of units.")],
    by: Annotated[
        list[str] | None,
        typer.Option(
            metavar="T",
            help='In the unit of the life, or "30 days"; default: the study\'s thresholds.',
        ),
    ] = None,
    allow: Annotated[int, typer.Option(min=0, metavar="K", help="Number that may have ended.")] = 0,
    output: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="The life.", autocompletion=completion.complete_output),
    ] = None,
    plain: given.Plain = False,
    json: given.Json = False,
) -> None:
    """Show when the first of many units ends."""
    from uq.cli import estimates as fleets

    fleets.fleet(result, size, by or [], allow, output, plain, json)


def convergence(
    result: given.ResultFile,
    output: given.OnlyOutput = None,
    json: given.Json = False,
) -> None:
    """Show estimates against rows, and if these are enough."""
    from uq.cli import estimates

    estimates.convergence(result, output, json)


def compare(
    first: Annotated[
        Path,
        typer.Argument(
            metavar="A.nc", help="A result of 'uq run'.", autocompletion=completion.complete_result
        ),
    ],
    second: Annotated[
        Path,
        typer.Argument(
            metavar="B.nc",
            help="Another, of the same model.",
            autocompletion=completion.complete_result,
        ),
    ],
    output: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="The lifetime to set imported lives beside.",
            autocompletion=completion.complete_output,
        ),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="F.png", help="Draw imported and simulated lives here.")
    ] = None,
    json: given.Json = False,
) -> None:
    """Show how two studies, or lives and a study, differ."""
    from uq.cli import compare

    compare.compare(first, second, json, output, plot)


def what_if(
    result: given.ResultFile,
    set_: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="uncertain.NAME.KEY=VALUE",
            help="May be repeated. Settings and fixed inputs: settings.NAME, fixed.NAME.",
            autocompletion=completion.complete_change,
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="NEW.nc", help="Keep rows computed again."),
    ] = None,
    full: given.Full = False,
    json: given.Json = False,
) -> None:
    """Show what other laws of inputs or settings would change."""
    from uq.cli import what_if as question

    question.what_if(result, set_, output, json, full)


def twin(
    result: given.ResultFile,
    emulator: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Of 'uq emulate': the twin.")
    ] = None,
    model: given.ModelReference = None,
    json: given.Json = False,
) -> None:
    """Sharpen estimates by a cheap output or an emulator."""
    from uq.cli import estimates

    estimates.twin(result, model, emulator, json)


def emulate(
    result: given.ResultFile,
    file: Annotated[
        Path,
        typer.Option("-o", "--file", metavar="FILE.emulator", help="Where to write it."),
    ],
    output: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME", help="Only this output.", autocompletion=completion.complete_output
        ),
    ] = None,
    json: given.Json = False,
) -> None:
    """Learn the outputs of a result, as a model.

    'uq run STUDY --model FILE.emulator' runs it.
    """
    from uq.cli import estimates

    with _naming_new_folders(file):
        estimates.emulate(result, file, output or (), json)


def trace(
    result: given.ResultFile,
    key: Annotated[
        str,
        typer.Argument(
            metavar="KEY",
            help="Its path in JSON: outputs/life/quantiles/0.05.",
            autocompletion=completion.complete_key,
        ),
    ],
    model: given.ModelReference = None,
    json: given.Json = False,
) -> int:
    """Show where a number comes from, and compute it again."""
    from uq.cli import sensitivity as tracing

    return tracing.trace(result, key, model, json)


def plot(
    result: given.ResultFile,
    folder: Annotated[
        Path | None,
        typer.Option(
            "-o", "--folder", metavar="FOLDER", help="Default: OUT.nc without its ending."
        ),
    ] = None,
    only: Annotated[
        list[str] | None,
        typer.Option(
            "--only",
            metavar="NAME",
            help="A kind of figure, or the name of a file.",
            autocompletion=completion.complete_figure,
        ),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        typer.Option(
            "--output",
            metavar="OUTPUT",
            help="Figures of this output.",
            autocompletion=completion.complete_output,
        ),
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Every figure, of every output.")] = False,
    formats: Annotated[
        list[str] | None,
        typer.Option(
            "--format",
            metavar="png|svg|pdf",
            help="Default: png.",
            autocompletion=completion.complete_format,
        ),
    ] = None,
    width: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Of each figure, as 84mm; default: 84 or 174 mm."),
    ] = None,
    titles: Annotated[
        bool, typer.Option("--title/--no-title", help="With titles, or without for a caption.")
    ] = True,
) -> None:
    """Draw the figures of a result into a folder.

    By default those about the subject of its study.
    """
    from uq.plots import save_all
    from uq.render.figures.figure import width_in_metres
    from uq.result.result import Result

    with _naming_new_folders(folder and folder / "any"):
        paths = save_all(
            Result.open(result),
            folder or result.with_suffix(""),
            only=only or (),
            outputs=outputs or (),
            every=every,
            formats=tuple(dict.fromkeys(",".join(formats or ["png"]).replace("|", ",").split(","))),
            width=None if width is None else width_in_metres(width),
            titles=titles,
        )
    for path in paths:
        print(path)


def report(
    result: given.ResultFile,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE", help="Default: OUT.html, OUT-dossier.html."),
    ] = None,
    dossier: Annotated[
        bool, typer.Option("--dossier", help="Follow published outlines for assessments.")
    ] = False,
    show: Annotated[bool, typer.Option("--open", help="Open it in the browser.")] = False,
) -> None:
    """Write one self-contained page with everything."""
    from uq.render.html.page import page, write_report

    make = page
    if dossier:
        from uq.render.html.dossier.chapters import dossier as make
    path = output or result.with_name(f"{result.stem}{'-dossier' * dossier}.html")
    with _naming_new_folders(output):
        write_report(result, path, make)
    _warn_if_altered(result)
    print(plain_line(str(path)))
    if show and not webbrowser.open(path.resolve().as_uri()):
        print("no browser found; open this file yourself", file=sys.stderr)


@contextmanager
def _naming_new_folders(*files: Path | None) -> Iterator[None]:
    """Name the folders that are made for files which the user has named."""
    folders = dict.fromkeys(file.parent for file in files if file is not None)
    new = [folder for folder in folders if not folder.exists()]
    yield
    streams.complain(*(f"{folder}: new folder" for folder in new))


def _warn_if_altered(path: Path) -> None:
    """Print a line if the checksum of a result is wrong; larger ones are left to `uq verify`."""
    from uq.files.netcdf_files import is_intact
    from uq.result.result_file import UNREADABLE

    if path.stat().st_size > _LARGEST:
        return
    try:
        altered = is_intact(path) is False
    except UNREADABLE as error:
        altered = not (isinstance(error, OSError) and (error.errno or 0) > 0)
    if altered:
        streams.complain(f"{path}: has changed since it was written: its checksum is wrong")


def update(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="STUDY|OUT.nc",
            help="A study (TOML), or a result.",
            autocompletion=completion.complete_study_or_result,
        ),
    ],
    inspections: Annotated[
        Path,
        typer.Argument(
            metavar="INSPECTIONS.csv|LIVES.nc", help="What was measured, or imported lives."
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="POSTERIOR.nc", help="Where to write it.")
    ],
    rows: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Rows of a study; new rows of a result.")
    ] = None,
    model_error: Annotated[
        float | None,
        typer.Option(min=0.0, metavar="CV", help="Model error: scatter of reality about it."),
    ] = None,
    by: given.Times = None,
    life: Annotated[
        str | None, typer.Option(metavar="NAME", help="Lifetime that imported lives are of.")
    ] = None,
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
        life,
        model,
        options,
        quiet or json,
        json,
    )


def next_inspection(
    result: given.ResultFile,
    inspect: Annotated[
        str,
        typer.Option(
            metavar="OUTPUT",
            help="What to inspect, such as 'depth'.",
            autocompletion=completion.complete_output,
        ),
    ],
    at: given.Times = None,
    units: Annotated[
        list[int] | None, typer.Option(min=1, metavar="N", help="How many more units.")
    ] = None,
    cv: Annotated[float, typer.Option(min=0.0, help="Error of the measurement.")] = 0.1,
    life: Annotated[
        str | None,
        typer.Option(
            metavar="NAME", help="The life to narrow.", autocompletion=completion.complete_output
        ),
    ] = None,
    json: given.Json = False,
) -> None:
    """Estimate the worth of inspecting more units."""
    from uq.cli import learning as question

    question.next_inspection(result, inspect, at or [], units or [1, 5, 20], cv, life, json)
