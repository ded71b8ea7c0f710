"""What ``uq check`` and ``uq run`` do."""

import shlex
import sys
import time
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from uq import results, runner
from uq.cli import progress, say_when_interrupted, tables
from uq.cli.printing import console, grid, heading, number
from uq.contract import Status
from uq.designs import DESIGNS
from uq.job import Progress
from uq.literals import shown
from uq.sampling import group_size, rows
from uq.study import Study, load_study


def check(path: str, model: str | None) -> None:
    """Print what a study would run, if it is in order."""
    study = load_study(path, model)
    design = study.design
    heading(f"{path}: in order", study.description)
    factors = {"replicates": design.replicates, "rows each": group_size(study)}
    parts = [f"{design.samples} samples"]
    parts += [f"{number} {name}" for name, number in factors.items() if number > 1]
    dependent = study.dependence is not None
    feeds = ", ".join(DESIGNS[design.method].feeds_with(dependent))
    grid(
        [
            ("model", f"{study.model.name}, version {study.model.version}"),
            ("design", f"{design.method}: {DESIGNS[design.method].meaning}"),
            ("rows", f"{rows(study)} = {' x '.join(parts)}" if parts[1:] else str(rows(study))),
            ("outputs", ", ".join(study.analysis.outputs)),
            ("sensitivity", f"{feeds} can be had from this design"),
            ("result", str(runner.output_path(study))),
        ]
    )
    heading("\nUncertain inputs")
    laws = [(name, _law(law), _unit(study, name)) for name, law in study.uncertain.items()]
    ties = [(name, f"equals {tied.equals}", "") for name, tied in study.tied.items()]
    grid(laws + ties, header=("parameter", "distribution", "unit"))
    _show_realised(study)


def _unit(study: Study, name: str) -> str:
    law = study.uncertain[name]
    return study.model.parameter(name).unit if law.times is None else f"x {law.times}"


def _law(law: Any) -> str:
    given = law.model_dump(exclude={"distribution", "source", "times"}, exclude_none=True)
    if given.get("file") is not None:
        del given["values"]
    arguments = ", ".join(f"{name} = {shown(value)}" for name, value in given.items())
    return f"{law.distribution}({arguments})"


def _show_realised(study: Study) -> None:
    """Print each input as stated and as the rows have it."""
    from uq.realised import MAX_ROWS, realised_inputs, realised_ranks

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
    ds = None if fresh else runner.finished(study, target)
    if ds is not None:
        note = f"{target} is complete already; nothing was computed (--fresh computes it again)"
    else:
        began = time.monotonic()
        with progress.shown(quiet) as show:

            def report(so_far: Progress) -> None:
                say_when_interrupted(
                    f"interrupted after {so_far.done} of {so_far.total} rows; nothing was written"
                )
                show(so_far)

            say_when_interrupted("interrupted; nothing was written")
            ds = runner.run(study, target, fresh=True, progress=report, **options)
        note = f"{target}: {ds.sizes['sample']} rows in {time.monotonic() - began:.1f} s"
    say_when_interrupted(f"interrupted; the result is complete in {target}")
    if not quiet:
        from uq.statistics import summarise

        tables.show_summary(ds, summarise(ds))
        console.print()
        console.print(note)
        name = shlex.quote(str(target))
        console.print(f"Next: uq sensitivity {name}, or uq plot {name}")
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
        f"{study.analysis.max_failed:g} allows ({'; '.join(examples)})",
        file=sys.stderr,
    )
    return 1
