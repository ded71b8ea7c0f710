"""What ``uq status``, ``uq extend``, ``uq rerun`` and ``uq verify`` do."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from uq.cli import progress
from uq.cli.printing import console, duration, grid, heading
from uq.cli.simulation import literal
from uq.cli.studies import carried_out, end
from uq.compilation import compilation
from uq.errors import InputError
from uq.rows import results
from uq.upkeep import extending, verification


def show_status(standing: Mapping[str, Any]) -> None:
    """Print where a run stands."""
    process = standing["process"]
    by = f" (process {process['pid']} on {process['host']})" if process else ""
    heading(f"{standing['output']}: {standing['state']}{by}")
    rate, left = standing["rate"], standing["seconds_left"]
    time_left = (duration(left) or f"{left:.0f} s") if left else ""
    statuses = [f"{count} {label}" for label, count in standing["status"].items()]
    grid(
        [
            ("done", f"{standing['done']} of {standing['rows']} rows"),
            ("failed", str(standing["failed"])),
            ("left", ", ".join(filter(None, (str(standing["left"]), time_left)))),
            ("rate", f"{rate:.3g} rows/s" if rate else "-"),
            ("by status", ", ".join(statuses) or "-"),
        ]
    )
    if standing["state"] != "complete" and standing["complete_rows"] is not None:
        console.print(f"\nUntil then the result with {standing['complete_rows']} rows stays.")


def extend(
    path: Path, samples: int, model: str | None, quiet: bool, options: Mapping[str, Any]
) -> int:
    """Give a result more samples and show it; return the exit code."""
    action = partial(extending.extend, path, samples, model, **options)
    ds, note = carried_out(path, quiet, action)
    return end(extending.study_of(path, model), ds, path, quiet, note, options["mixed"])


def rerun(
    path: Path,
    failed: bool,
    settings: Sequence[str],
    model: str | None,
    quiet: bool,
    options: Mapping[str, Any],
) -> int:
    """Compute failed rows again and show the result; return the exit code."""
    if not failed:
        raise InputError("uq rerun: say which rows: --failed")
    changes = dict(literal(text) for text in settings)
    action = partial(extending.rerun_failed, path, changes, model, **options)
    ds, note = carried_out(path, quiet, action)
    return end(extending.study_of(path, model), ds, path, quiet, note, options["mixed"])


def verify(path: Path, model: str | None) -> int:
    """Check a result and print what was found; return the exit code."""
    holds = verification.checksum_holds(path)
    words = {True: "right", False: "WRONG: the file is not what was written", None: "none"}
    console.print(f"checksum  {words[holds]}")
    ds = results.open_result(path)
    others = verification.other_versions(ds, model)
    for other in others:
        console.print(f"{other.name}  {other.made} made it, {other.here} is here")
    if not others:
        console.print("versions  the same as here")
    with compilation(progress.say_compiling):
        rows, differences = verification.recompute(path, model)
    for line in differences:
        console.print(f"computed again, differs in {line}")
    equal = len(rows) - len(differences)
    console.print(f"rows      {equal} of {len(rows)} computed again are equal to the bit")
    return 1 if differences or holds is False else 0
