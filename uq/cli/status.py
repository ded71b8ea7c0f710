"""The commands ``uq status`` and ``uq verify``."""

from dataclasses import asdict
from pathlib import Path

from uq.cli import progress
from uq.cli.printing import console, duration, grid, heading, print_json
from uq.execution.recomputed_row import other_versions
from uq.execution.status import RunStatus, run_status
from uq.execution.verification import checksum_holds, recompute
from uq.machines.compilation import compilation
from uq.result import result_file
from uq.text.numbers import counted


def status(path: Path, json: bool) -> None:
    """Print the progress of a run."""
    run = run_status(path)
    print_json(asdict(run)) if json else _show_status(run)


def _show_status(run: RunStatus) -> None:
    writer = run.process
    by = f" (process {writer['pid']} on {writer['host']})" if writer else ""
    heading(f"{run.output}: {run.state}{by}")
    rate, left = run.rate, run.seconds_left
    time_left = (duration(left) or f"{left:.0f} s") if left else ""
    statuses = [f"{count} {label}" for label, count in run.status.items()]
    grid(
        [
            ("done", f"{run.done} of {run.rows} rows"),
            ("failed", str(run.failed)),
            ("left", ", ".join(filter(None, (str(run.left), time_left)))),
            ("rate", f"{rate:.3g} rows/s" if rate else "-"),
            ("by status", ", ".join(statuses) or "-"),
        ]
    )
    if run.state != "complete" and run.complete_rows is not None:
        rows = counted(run.complete_rows, "row")
        console.print(f"\nUntil then the result with {rows} is kept.")


def verify(path: Path, model: str | None) -> int:
    """Check a result and print what was found; return the exit code."""
    holds = checksum_holds(path)
    words = {True: "right", False: "WRONG: the file has changed since it was written", None: "none"}
    console.print(f"checksum  {words[holds]}")
    ds = result_file.open_result(path)
    others = other_versions(ds, model)
    for name, (made, here) in others.items():
        console.print(f"{name}  {made} made it, {here} is here")
    if not others:
        console.print("versions  the same as here")
    with compilation(progress.say_compiling):
        rows, differences = recompute(path, model)
    for line in differences:
        console.print(f"recomputed, differs in {line}")
    if differences and holds and not others:
        console.print(
            "File and code are the same: this model does not return the same for the same row. It"
            " keeps something between rows, or draws random numbers that do not depend on its seed."
        )
    equal = len(rows) - len(differences)
    console.print(f"rows      {equal} of {len(rows)} recomputed are equal to the bit")
    return 1 if differences or holds is False else 0
