"""Terminal output of ``uq update`` and ``uq next-inspection``."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import exp, isfinite
from pathlib import Path
from typing import Any

from uq.cli import progress, say_when_interrupted
from uq.cli.printing import console, grid, heading, note, paragraph, print_json, title
from uq.cli.run import carried_out, loaded
from uq.execution.options import RunOptions
from uq.execution.runner import output_path, run_study
from uq.explore.new_rows import Budget
from uq.explore.updating import is_study, learn, samples_for
from uq.files.whole_files import check_target
from uq.learning.answer import Learnt, learnt, learnt_facts
from uq.learning.inspections import read
from uq.learning.next_inspection import InspectionValue, unit_of_time, worth
from uq.learning.posterior import InformationGain
from uq.learning.posterior_inputs import InputLearnt
from uq.learning.remaining_life import ANY, Remaining, read_times
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate, value_text
from uq.text.numbers import counted, in_brackets, number, percent, threshold
from uq.text.quantities import read_threshold
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
    life: str | None,
    model: str | None,
    options: RunOptions,
    quiet: bool,
    json: bool,
) -> int:
    """Update a study or a result with inspections, write the posterior, and show it."""
    if not is_study(source):
        Result.open(source).refuse_if_record("uq update")
    new = read(inspections)
    check_target(output, 0)
    if is_study(source):
        study = loaded(str(source), model, None)
        study = study if rows is None else study.with_samples(samples_for(study, rows))
        target = output_path(study)
        dataset, _ = carried_out(target, quiet, options, partial(run_study, study, target))
        result = Result(dataset)
    else:
        result = Result.open(source)
    times, budget = read_times("--by", by, result), None
    say_when_interrupted("interrupted; nothing was written")
    with progress.shown(quiet) as show:
        if rows is not None and not is_study(source):
            say_when_interrupted("interrupted; the same command resumes, with the new rows so far")
            budget = Budget(rows, replace(options, progress=show), output, model)
        posterior = Result(learn(result, new, output, model_error, budget, life))
    answer = learnt(posterior, times)
    if json:
        print_json(learnt_facts(answer).json)
    elif not quiet:
        _show(posterior, answer)
        console.print()
        console.print(f"{output}: written. Next: uq summary {output}", soft_wrap=True)
    return 0


def _show(result: Result, answer: Learnt) -> None:
    title(result)
    of_unit: dict[str, list[InputLearnt]] = {}
    for posterior_input in answer.inputs:
        of_unit.setdefault(posterior_input.unit, []).append(posterior_input)
    for unit, inputs in of_unit.items():
        if not unit or len(of_unit) <= MOST_UNITS:
            heading(f"\nInputs of unit {unit}" if unit else "\nInputs that units share")
            grid(_inputs(inputs), header=("", "before", "sd", "after", "error", "sd", ""))
            for posterior_input in inputs:
                after = posterior_input.posterior
                for moment, estimate in (("mean", after.mean), ("sd", after.sd)):
                    if estimate.reason:
                        note(f"{posterior_input.name}: no {moment} after: {estimate.reason}.")
    if answer.confounded:
        heading("\nConfounded by the inspections", "rank correlation")
        grid([(f"{p.first}, {p.second}", f"{p.correlation:.2f}") for p in answer.confounded[:5]])
    if answer.taught:
        heading("\nInformation gain", "beyond all other inspections [bit]")
        most = sorted(answer.taught, key=lambda gain: -gain.bits)[:5]
        grid([(_inspection_label(gain), f"{gain.bits:.2f}") for gain in most])
    for output in dict.fromkeys(remaining.output for remaining in answer.lives):
        _show_lives([remaining for remaining in answer.lives if remaining.output == output])
    if any(posterior_input.posterior.mean.has_interval for posterior_input in answer.inputs):
        note("error: 95 % Monte Carlo error of the mean after.")
    for text in answer.notes:
        note(text)
    worst = answer.worst
    text = f"The effective sample size is {worst.effective:.0f} or more"
    note(text + (f"; Pareto k = {worst.k:.2f}." if isfinite(worst.k) else "."))


def _inspection_label(taught: InformationGain) -> str:
    inspection = taught.inspection
    text = f"{inspection.unit}: {inspection.output} {inspection.kind}"
    if inspection.value is not None:
        text += f" {beside(number(inspection.value), taught.units)}"
    if inspection.time is not None:
        text += f" at {beside(number(inspection.time), taught.time_unit)}"
    return text


def _inputs(shown: Sequence[InputLearnt]) -> Iterator[tuple[str, ...]]:
    for posterior_input in shown:
        before, after = posterior_input.prior, posterior_input.posterior
        unit = unit_of(posterior_input.units, before.mean.value)
        half = (after.mean.high - after.mean.low) / 2 / unit.size
        yield (
            posterior_input.name.partition("[")[0],
            *(_digits(x.value / unit.size) for x in (before.mean, before.sd, after.mean)),
            f"{half:.1g}" if isfinite(half) else "-",
            _digits(after.sd.value / unit.size),
            "" if posterior_input.units == "1" else powers(unit.name),
        )


def _digits(value: float) -> str:
    return f"{value:.4g}" if isfinite(value) else "-"


def _show_lives(lives: Sequence[Remaining]) -> None:
    longest = max((x.value for remaining in lives for x in remaining.life.values()), default=0.0)
    unit = unit_of(lives[0].units, longest)
    heading(f"\n{lives[0].output}", f"remaining life{in_brackets(unit)} of units that run")
    times = list(dict.fromkeys(time for remaining in lives for time in remaining.by))
    ends = (f"P(by {number(time / unit.size)})" for time in times)
    running = [_line(remaining, unit.size, times) for remaining in lives if remaining.life]
    grid(running, header=("unit", "from", "median", "5 % ends within", "rows", *ends))
    for time, points in (pair for remaining in lives for pair in remaining.over_shared.items()):
        span = " to ".join(map(percent, points.values()))
        text = f"P(by {number(time / unit.size)}) of units not inspected: {span} (95 %)"
        paragraph(f"{text}, depending on what units share", indent=2)
    ended = (remaining.unit for remaining in lives if not remaining.life)
    if gone := [unit_name for unit_name in ended if unit_name != ANY]:
        paragraph(f"hardly any row in which it still runs: {', '.join(gone)}", indent=2)


def _line(remaining: Remaining, per: float, times: Sequence[float]) -> tuple[str, ...]:
    shares = (remaining.by.get(time, Estimate()) for time in times)
    return (
        "not inspected" if remaining.unit == ANY else remaining.unit,
        number(remaining.seen / per),
        *(value_text(remaining.life[p], per=per) for p in (0.5, 0.05)),
        f"{remaining.effective_rows:.0f}",
        *(percent(share.value) if isfinite(share.value) else "-" for share in shares),
    )


def next_inspection(
    result: Path,
    output: str,
    times: Sequence[str],
    units: Sequence[int],
    cv: float,
    life: str | None,
    json: bool,
) -> None:
    """Show the expected reduction of the shared uncertainty by inspecting more units."""
    opened = Result.open(result)
    at = [read_threshold("--at", text, "a life", unit_of_time(opened, output)) for text in times]
    expected = worth(opened, output, at, units, cv, life)
    if json:
        print_json(_as_json(expected))
        return
    title(opened)
    heading(f"\n{expected.life}", f"expected narrowing by inspecting {expected.output}")
    lines = []
    for time in at or (None,):
        when = "at any time" if time is None else f"at {threshold(time, expected.time_unit)}"
        shares = (expected.narrowing[time, count] for count in units)
        lines.append((when, *(percent(share) if share == share else "-" for share in shares)))
    grid(lines, header=("", *(counted(count, "unit") for count in units)))
    note(
        f"Shared inputs scatter this life by a factor of {exp(expected.spread):.3g} (one"
        " standard deviation); each cell is the expected relative reduction of the logarithm of"
        " that factor. The scatter between units remains."
    )
    for text in expected.notes:
        note(text)


def _as_json(expected: InspectionValue) -> dict[str, Any]:
    return {
        "life": expected.life,
        "inspect": expected.output,
        "spread": estimate_json.number(expected.spread),
        "time_units": expected.time_unit,
        "notes": expected.notes,
        "narrowing": [
            {"time": time, "units": units, "value": estimate_json.number(share)}
            for (time, units), share in expected.narrowing.items()
        ],
    }
