"""What ``uq check`` and ``uq run`` do."""

import shlex
import sys
import time
from collections.abc import Callable
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.cli import progress, say_when_interrupted, tables
from uq.cli.printing import console, grid, heading, number
from uq.contract import Status
from uq.designs.table import DESIGNS
from uq.literals import plain_line
from uq.rows import results
from uq.rows.sampling import group_size, rows
from uq.running import runner
from uq.running.dispatch import Progress
from uq.store import folder_of
from uq.study.definition import Study, load_study
from uq.wording import law


def check(path: str, model: str | None) -> None:
    """Print what a study would run, if it is in order."""
    study = load_study(path, model)
    design = study.design
    heading(f"{path}: in order", study.description)
    factors = {"replicates": design.replicates, "rows each": group_size(study)}
    parts = [f"{design.samples} samples"]
    parts += [f"{number} {name}" for name, number in factors.items() if number > 1]
    stated = ", stated to be independent" * design.independent
    unsaid = DESIGNS[design.method].imported and not design.independent
    dependent = study.dependence is not None or unsaid
    feeds = ", ".join(DESIGNS[design.method].feeds_with(dependent))
    grid(
        [
            ("model", f"{study.model.name}, version {study.model.version}"),
            ("design", f"{design.method}: {DESIGNS[design.method].meaning}{stated}"),
            ("rows", f"{rows(study)} = {' x '.join(parts)}" if parts[1:] else str(rows(study))),
            *_of_random(study),
            ("outputs", ", ".join(study.analysis.outputs)),
            ("sensitivity", f"{feeds} can be had from this design"),
            ("result", str(runner.output_path(study))),
        ]
    )
    heading("\nUncertain inputs")
    laws = [(name, law(stated), _unit(study, name)) for name, stated in study.uncertain.items()]
    ties = [(name, f"equals {tied.equals}", "") for name, tied in study.tied.items()]
    grid(laws + ties, header=("parameter", "distribution", "unit"))
    _show_realised(study)


def _of_random(study: Study) -> list[tuple[str, str]]:
    design = DESIGNS[study.design.method]
    if not study.random or not design.shares_seeds:
        return []
    more = "; one more row of each tells the share of noise" if design.crossed else ""
    return [("seeds", f"the model is random: rows that are compared share a seed{more}")]


def _unit(study: Study, name: str) -> str:
    times = study.uncertain[name].times
    return study.model.parameter(name).unit if times is None else f"x {times}"


def _show_realised(study: Study) -> None:
    """Print each input as stated and as the rows have it."""
    from uq.analysis.sampled_inputs import MAX_ROWS, realised_inputs, realised_ranks

    count = min(rows(study), MAX_ROWS)
    found = realised_inputs(study)
    if not found:
        print(f"\nThe rows of a '{study.design.method}' design do not follow these laws.")
        return
    heading(
        f"\nAs {count} rows have them",
        f"(independent rows would be less than {1.36 / count**0.5:.2g} off in 19 of 20 cases)",
    )
    lines = []
    for name, one in found.items():
        lines.append((name, "stated", *map(number, one.stated), ""))
        lines.append(("", "rows", *map(number, one.realised), f"{one.distance:.2g}"))
    grid(lines, header=("parameter", "", "5 %", "50 %", "95 %", "largest distance"))
    if study.dependence is not None:
        heading("\nRank correlations")
        ranks, names = realised_ranks(study), study.dependence.parameters
        stated = study.dependence.rank_correlation
        grid(
            [
                (f"{names[i]}, {names[j]}", number(stated[i][j]), f"{ranks[i, j]:.3f}")
                for i, j in combinations(range(len(names)), 2)
            ],
            header=("", "stated", "rows"),
        )


def run(
    path: str,
    output: Path | None,
    model: str | None,
    samples: int | None,
    fresh: bool,
    quiet: bool,
    options: dict[str, Any],
) -> int:
    """Run a study and show its result; return the exit code."""
    study = load_study(path, model)
    if samples is not None:
        study = study.with_samples(samples)
    target = runner.output_path(study, output)
    if not fresh and (ds := runner.finished(study, target)) is not None:
        note = f"{target} is complete already; nothing was computed (--fresh computes it again)"
    else:
        ds, note = carried_out(
            target, quiet, partial(runner.run, study, target, fresh=fresh, **options)
        )
    return end(study, ds, target, quiet, note, options["mixed"])


def carried_out(
    target: Path, quiet: bool, action: Callable[..., xr.Dataset]
) -> tuple[xr.Dataset, str]:
    """Show how a run goes on; return its result and a line on what was done."""
    began = time.monotonic()
    computed = found = 0
    with progress.shown(quiet) as show:

        def report(so_far: Progress) -> None:
            nonlocal computed, found
            computed, found = so_far.done - so_far.found, so_far.found
            if so_far.done:
                say_when_interrupted(
                    f"interrupted after {so_far.done} of {so_far.total} rows, kept in "
                    f"{folder_of(target)}; the same command goes on from there"
                )
            show(so_far)

        def say(line: str) -> None:
            if not quiet:
                print(plain_line(line), file=sys.stderr)

        say_when_interrupted("interrupted; nothing was written")
        ds = action(progress=report, say=say)
    before = f"; {found} were there already" if found else ""
    seconds = time.monotonic() - began
    return ds, f"{target}: {computed} rows computed in {seconds:.1f} s{before}"


def end(
    study: Study, ds: xr.Dataset, target: Path, quiet: bool, note: str, mixed: bool = False
) -> int:
    """Show the summary of a result; return the exit code.

    Rows that other code computed are named, also where all else is to be quiet, unless they are
    wanted.
    """
    say_when_interrupted(f"interrupted; the result is complete in {target}")
    if not mixed and (line := runner.made_elsewhere(study, target, ds)):
        print(plain_line(line), file=sys.stderr)
    if not quiet:
        from uq.analysis.summary import summarise

        tables.show_summary(ds, summarise(ds))
        console.print()
        console.print(note)
        name = shlex.quote(str(target))
        console.print(f"Next: uq report {name} --open", soft_wrap=True)
        console.print(f"      uq sensitivity {name}", soft_wrap=True)
    return _verdict(study, ds)


def _verdict(study: Study, ds: Any) -> int:
    failed = int(np.count_nonzero(results.failed(ds)))
    share = failed / ds.sizes["sample"]
    if share <= study.analysis.max_failed:
        return 0
    examples = [
        f"{status.label}: {text}"
        for status in Status
        if (text := ds["status"].attrs.get(f"example_{status.name.lower()}"))
    ]
    print(
        f"{failed} of {ds.sizes['sample']} rows failed, more than max_failed = "
        f"{study.analysis.max_failed:g} allows ({plain_line('; '.join(examples))})",
        file=sys.stderr,
    )
    return 1
