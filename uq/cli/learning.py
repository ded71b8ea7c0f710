"""What ``uq update`` shows."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import isfinite
from pathlib import Path

import xarray as xr

from uq.cli import progress, say_when_interrupted
from uq.cli.printing import console, grid, heading, note, paragraph, print_json
from uq.cli.run import carried_out, loaded
from uq.execution.options import RunOptions
from uq.execution.runner import output_path, run_study
from uq.explore.new_rows import Budget
from uq.explore.updating import is_study, learn, samples_for
from uq.files.whole_files import check_target
from uq.learning.answer import Learnt, learnt, learnt_json
from uq.learning.information_gain import Taught
from uq.learning.inspection_log import read
from uq.learning.posterior_inputs import InputLearnt
from uq.learning.remaining_life import ANY, Remaining, read_times
from uq.result.result_file import open_result
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import value_text
from uq.text.numbers import in_brackets, number, percent
from uq.text.units import beside, powers, unit_of

MOST_UNITS = 12
"""Inspected units whose own inputs are listed."""


def update(
    source: Path,
    inspections: Path,
    output: Path,
    rows: int | None,
    model_error: float | None,
    by: Sequence[str],
    model: str | None,
    options: RunOptions,
    quiet: bool,
    json: bool,
) -> int:
    """Update a study or a result with inspections, write the posterior, and show it."""
    new = read(inspections)
    check_target(output, 0)
    if is_study(source):
        study = loaded(str(source), model, None)
        study = study if rows is None else study.with_samples(samples_for(study, rows))
        target = output_path(study)
        ds, _ = carried_out(target, quiet, options, partial(run_study, study, target))
    else:
        ds = open_result(source)
    times, budget = read_times("--by", by, ds), None
    say_when_interrupted("interrupted; nothing was written")
    with progress.shown(quiet) as show:
        if rows is not None and not is_study(source):
            say_when_interrupted("interrupted; the same command resumes, with the new rows so far")
            budget = Budget(rows, replace(options, progress=show), output, model)
        found = learn(ds, new, output, model_error, budget)
    answer = learnt(found, times)
    if json:
        print_json(learnt_json(answer))
    elif not quiet:
        _show(found, answer)
        console.print()
        console.print(f"{output}: written. Next: uq summary {output}", soft_wrap=True)
    return 0


def _show(ds: xr.Dataset, found: Learnt) -> None:
    heading(str(ds.attrs["title"]), str(ds.attrs["source"]))
    of_unit: dict[str, list[InputLearnt]] = {}
    for one in found.inputs:
        of_unit.setdefault(one.unit, []).append(one)
    for unit, inputs in of_unit.items():
        if not unit or len(of_unit) <= MOST_UNITS:
            heading(f"\nInputs of unit {unit}" if unit else "\nInputs that units share")
            grid(_inputs(inputs), header=("", "before", "sd", "after", "error", "sd", ""))
            for one in inputs:
                after = one.posterior
                for what, of in (("mean", after.mean), ("sd", after.sd)):
                    if of.reason:
                        note(f"{one.name}: no {what} after: {of.reason}.")
    if found.confounded:
        heading("\nConfounded by the inspections", "rank correlation")
        grid([(f"{p.first}, {p.second}", f"{p.correlation:.2f}") for p in found.confounded[:5]])
    if found.taught:
        heading("\nTaught most", "beyond all other inspections [bit]")
        most = sorted(found.taught, key=lambda one: -one.bits)[:5]
        grid([(_what(one), f"{one.bits:.2f}") for one in most])
    for output in dict.fromkeys(one.output for one in found.lives):
        _show_lives([one for one in found.lives if one.output == output])
    if any(one.posterior.mean.has_interval for one in found.inputs):
        note("error: how far, with 95 % confidence, the rows may be off the mean after.")
    for text in found.notes:
        note(text)
    worst = found.worst
    text = f"The rows are worth {worst.effective:.0f} of equal weight, or more"
    note(text + (f"; Pareto k = {worst.k:.2f}." if isfinite(worst.k) else "."))


def _what(taught: Taught) -> str:
    one = taught.inspection
    when = f" at {beside(number(one.time), taught.time_unit)}" if one.time is not None else ""
    value = f" {beside(number(one.value), taught.units)}" if one.value is not None else ""
    return f"{one.unit}: {one.output} {one.kind}{value}{when}"


def _inputs(shown: Sequence[InputLearnt]) -> Iterator[tuple[str, ...]]:
    for one in shown:
        before, after = one.prior, one.posterior
        unit = unit_of(one.units, before.mean.value)
        half = (after.mean.high - after.mean.low) / 2 / unit.size
        yield (
            one.name.partition("[")[0],
            *(_digits(x.value / unit.size) for x in (before.mean, before.sd, after.mean)),
            f"{half:.1g}" if isfinite(half) else "-",
            _digits(after.sd.value / unit.size),
            "" if one.units == "1" else powers(unit.name),
        )


def _digits(value: float) -> str:
    return f"{value:.4g}" if isfinite(value) else "-"


def _show_lives(lives: Sequence[Remaining]) -> None:
    longest = max((x.value for one in lives for x in one.life.values()), default=0.0)
    unit = unit_of(lives[0].units, longest)
    heading(f"\n{lives[0].output}", f"remaining life{in_brackets(unit)} of units that run")
    times = list(dict.fromkeys(time for one in lives for time in one.by))
    ends = (f"P(by {number(time / unit.size)})" for time in times)
    header = ("unit", "from", "median", "5 % ends within", "rows", *ends)
    grid([_line(one, unit.size, times) for one in lives if one.life], header=header)
    for time, points in (pair for one in lives for pair in one.over_shared.items()):
        span = " to ".join(map(percent, points.values()))
        text = f"P(by {number(time / unit.size)}) of units not inspected: {span} (95 %)"
        paragraph(f"{text}, depending on what units share", indent=2)
    if gone := [one.unit for one in lives if not one.life and one.unit != ANY]:
        paragraph(f"hardly any row in which it still runs: {', '.join(gone)}", indent=2)


def _line(one: Remaining, per: float, times: Sequence[float]) -> tuple[str, ...]:
    shares = (one.by.get(time, Estimate()) for time in times)
    return (
        "not inspected" if one.unit == ANY else one.unit,
        number(one.seen / per),
        *(value_text(one.life[p], per=per) for p in (0.5, 0.05)),
        f"{one.effective_rows:.0f}",
        *(percent(one.value) if isfinite(one.value) else "-" for one in shares),
    )
