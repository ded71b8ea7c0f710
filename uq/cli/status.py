"""Terminal output of ``uq status``, ``uq verify`` and ``uq row``."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from uq.cli import progress
from uq.cli.printing import console, grid, heading, note, number, print_json
from uq.cli.progress import say_compiling
from uq.cli.simulate import as_json, check_files, draw, show_outputs
from uq.contract import Status
from uq.errors import InputError
from uq.execution.amending import checksum_holds, recompute
from uq.execution.loading import load_model
from uq.execution.recomputation import other_versions
from uq.execution.row_folder import RunStatus, run_status
from uq.explore.single_rows import RowAgain, row_again, with_trajectory
from uq.machines.compilation import compilation
from uq.result import result_file
from uq.result.result import Result
from uq.study.installed_models import find_model
from uq.text.numbers import capitalized, counted, elapsed, quantity

ROUNDED = 1e-12
"""Relative difference of numbers that rounding explains."""


def status(path: Path, json: bool) -> None:
    """Print the progress of a run."""
    run = run_status(path)
    print_json(asdict(run)) if json else _show_status(run)


def _show_status(run: RunStatus) -> None:
    writer = run.process
    by = f" (process {writer['pid']} on {writer['host']})" if writer else ""
    heading(f"{run.output}: {run.state}{by}")
    rate, left = run.rate, run.seconds_left
    time_left = elapsed(left) if left else ""
    statuses = [f"{count} {label}" for label, count in run.status.items()]
    grid(
        [
            ("done", f"{run.done} of {run.rows} rows"),
            ("invalid", str(run.failed)),
            ("left", ", ".join(filter(None, (str(run.left), time_left)))),
            ("rate", f"{rate:.3g} rows/s" if rate else "-"),
            ("by status", ", ".join(statuses) or "-"),
        ]
    )
    if run.state != "complete" and run.complete_rows is not None:
        rows = counted(run.complete_rows, "row")
        console.print(f"\nUntil then the result with {rows} is kept.")


def verify(path: Path, model: str | None) -> int:
    """Verify a result and print the findings; return the exit code."""
    holds = checksum_holds(path)
    words = {True: "right", False: "WRONG: the file has changed since it was written", None: "none"}
    console.print(f"checksum  {words[holds]}")
    ds = result_file.open_result(path)
    others = other_versions(ds, model)
    for name, (made, here) in others.items():
        console.print(f"{name}  {made} made it, here {here}")
    if not others:
        console.print("versions  the same as here")
    with compilation(progress.say_compiling):
        rows, differences = recompute(path, model)
    for line, change in differences.items():
        by = f", by {number(change)} of it" if change < np.inf else ""
        console.print(f"recomputed, differs in {line}{by}")
    is_rounded = "cpu" in others and all(change <= ROUNDED for change in differences.values())
    if differences and is_rounded:
        console.print("Another processor rounds otherwise; the numbers are the same else.")
    if differences and holds and not others:
        console.print(
            "File and code are unchanged, but the model returns other values for the same row. It"
            " keeps state between rows, or draws random numbers independent of its seed."
        )
    equal = len(rows) - len(differences)
    console.print(f"rows      {equal} of {len(rows)} recomputed are equal to the bit")
    return 1 if (differences and not is_rounded) or holds is False else 0


def row(
    result: Path,
    number: int | None,
    lowest: str | None,
    highest: str | None,
    near_quantile: tuple[float, str] | None,
    plot: Path | None,
    model: str | None,
    json: bool,
) -> int:
    """Show a row of a result, computed again; return the exit code."""
    opened = Result.open(result)
    if plot:
        check_files(
            load_model(model) if model else find_model(opened.dataset.attrs["model"]), None, plot
        )
    with compilation(say_compiling):
        recomputed = row_again(opened, number, lowest, near_quantile, model, str(result), highest)
        if plot:
            if recomputed.again is None:
                raise InputError(
                    f"{result}: row {recomputed.number}: no trajectory: {recomputed.reason}"
                )
            draw(with_trajectory(recomputed.stored.dataset, recomputed.again), plot)
    print_json(plain(recomputed)) if json else _show(recomputed, len(opened))
    return 1 if recomputed.differing else 0


def plain(recomputed: RowAgain) -> dict[str, Any]:
    """Return a row as plain data, for JSON.

    Returns
    -------
    dict
        ``row``, ``equal``, ``place`` in the design, and the row as `uq simulate` prints it. Where
        it is not equal, ``reason``, and if it was computed again ``differing`` and ``again``.
        ``versions`` has the versions that differ from those of the result, ``[there, here]``.
    """
    again = recomputed.again
    entry: dict[str, Any] = {
        "row": recomputed.number,
        "equal": recomputed.equal,
        "place": recomputed.place,
    }
    entry |= {"chosen": recomputed.choice.words} if recomputed.choice else {}
    entry |= {"seed": again.seed} if again else {}
    entry |= as_json(recomputed.row)
    if recomputed.reason:
        entry["reason"] = recomputed.reason
    if again and recomputed.differing:
        here = as_json(again)
        entry["differing"] = list(recomputed.differing)
        entry["again"] = {name: here[name] for name in ("inputs", "outputs", "status")}
    if recomputed.versions:
        entry["versions"] = {name: list(pair) for name, pair in recomputed.versions.items()}
    return entry


def _show(recomputed: RowAgain, rows: int) -> None:
    stored, (status, meaning) = recomputed.row, recomputed.row.ending
    title = f"{stored.model.name}, row {recomputed.number} of {rows}: {status.label}"
    heading(title, "" if status is Status.OK else meaning)
    if recomputed.choice:
        grid([(recomputed.choice.words,)])
    grid([(", ".join(f"{name} {place}" for name, place in recomputed.place.items()),)])
    heading("\ninputs")
    attributes = {name: recomputed.stored.dataset[name].attrs for name in stored.values}
    inputs = [name for name in attributes if attributes[name].get("role") == "input"]
    grid([(name, quantity(stored.values[name], attributes[name]["units"])) for name in inputs])
    show_outputs(stored)
    note(_in_words(recomputed))


def _in_words(recomputed: RowAgain) -> str:
    if recomputed.again is None:
        return f"{capitalized(recomputed.reason)}."
    code = "; the code of the model has changed since" if "code" in recomputed.versions else ""
    if recomputed.equal:
        return f"Computed again: equal to the bit{code}."
    differing = ", ".join(recomputed.differing)
    return f"Computed again: differs in {differing}. Reason: {recomputed.reason}."
