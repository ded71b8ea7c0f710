"""Output of the verbs that compute rows of a result."""

import shlex
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from uq.cli import progress, say_when_interrupted, summary_tables
from uq.cli.printing import console
from uq.contract import Status
from uq.execution import runner
from uq.execution.amending import study_of
from uq.execution.loading import load_study
from uq.execution.options import Progress, RunOptions, ignore
from uq.execution.row_folder import folder_of
from uq.result.result import Result
from uq.result.result_file import with_model
from uq.study.definition import Study
from uq.text.numbers import counted, elapsed


def loaded(
    path: str, model: str | None, samples: int | None, row_limit: float | None = None
) -> Study:
    """Return a study, with another number of samples if one is given."""
    study = load_study(path, model, progress.say, row_limit)
    return study if samples is None else study.with_samples(samples)


def amended(
    path: Path,
    model: str | None,
    quiet: bool,
    options: RunOptions,
    action: Callable[[RunOptions], xr.Dataset],
) -> int:
    """Compute more rows of a result and show it; return the exit code."""
    ds, note = carried_out(path, quiet, options, action)
    return end(study_of(path, model), Result(ds), path, quiet, note, options.mixed)


def carried_out(
    target: Path, quiet: bool, options: RunOptions, action: Callable[[RunOptions], xr.Dataset]
) -> tuple[xr.Dataset, str]:
    """Show the progress of a run; return its result and a line that summarises the run."""
    began = time.monotonic()
    computed = reused = 0
    with progress.shown(quiet) as show:

        def report(so_far: Progress) -> None:
            nonlocal computed, reused
            computed, reused = so_far.done - so_far.reused, so_far.reused
            if so_far.done:
                say_when_interrupted(
                    f"interrupted after {so_far.done} of {so_far.total} rows, kept in "
                    f"{folder_of(target)}; the same command resumes the run"
                )
            show(so_far)

        say = ignore if quiet else progress.say_plain
        say_when_interrupted("interrupted; nothing was written")
        ds = action(replace(options, progress=report, say=say))
    before = f"; {reused} computed before" if reused else ""
    seconds = time.monotonic() - began
    return ds, f"{target}: {counted(computed, 'row')} computed in {elapsed(seconds)}{before}"


def end(study: Study, result: Result, target: Path, quiet: bool, note: str, mixed: bool) -> int:
    """Show the summary of a result; return the exit code.

    Rows from another version of the code are reported even if all else is quiet, unless wanted.
    """
    say_when_interrupted(f"interrupted; the result is complete in {target}")
    if not mixed and (line := runner.line_on_other_code(study, target, result.dataset)):
        progress.say_plain(line)
    if not quiet:
        from uq.assess.findings import Findings

        with_model(result.dataset, study.model_reference)
        console.print(note)
        console.print(f"Page: uq report {shlex.quote(str(target))} --open\n", soft_wrap=True)
        summary_tables.show_findings(Findings(result))
    failed = int(np.count_nonzero(result.failed))
    share = failed / len(result)
    if share <= study.analysis.max_failed:
        return 0
    examples = [
        f"{status.label}: {text}"
        for status in Status
        if (text := result.dataset["status"].attrs.get(f"example_{status.name.lower()}"))
    ]
    progress.say_plain(
        f"{failed} of {len(result)} rows are invalid, more than max_failed = "
        f"{study.analysis.max_failed:g} allows ({'; '.join(examples)})"
    )
    return 1
