"""Terminal output of ``uq twin``, ``uq emulate``, ``uq convergence`` and ``uq fleet``."""

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from uq.assess.answer.answer import verdict
from uq.assess.answer.wording import NumberTarget
from uq.assess.convergence import convergence_facts, converging
from uq.assess.emulate import emulate as fitted
from uq.assess.emulate import emulator_facts
from uq.assess.findings import Findings
from uq.assess.fleet import fleet_facts, fleet_of, lifetime_element, reasons
from uq.assess.fleet_numbers import Banded
from uq.assess.two_fidelities import twin_facts, with_twin
from uq.cli.printing import CELLS, cells, grid, heading, note, paragraph, print_json, title
from uq.result.result import Result
from uq.stats.estimate import Estimate, failed_bounds_text, interval_text, value_text
from uq.text.numbers import counted, in_brackets, percent, threshold
from uq.text.quantities import read_threshold
from uq.text.units import beside, typical, unit_of

_SHOWN = 6  # sizes of each estimate on a terminal


def _show_target(
    result: Result, name: str, estimates: Mapping[str, Estimate]
) -> tuple[NumberTarget, dict[str, float]]:
    """Print the name of a target, its unit and meaning.

    Returns
    -------
    target : NumberTarget
    sizes : dict of str to float
        Label of an estimate -> size of the unit in which it is shown.
    """
    target = NumberTarget(result, name)
    values = [label for label in estimates if label.startswith(("mean", "quantile"))]
    unit = unit_of(target.units, typical(estimates[label].value for label in values))
    heading(f"\n{target.name}{in_brackets(unit)}", target.meaning)
    return target, {label: unit.size if label in values else 1.0 for label in estimates}


def _ends(estimate: Estimate, per: float) -> str:
    """Return an interval in a unit of size `per`; "" without one."""
    return interval_text(estimate, per) if estimate.has_interval else ""


def twin(result: Path, model: str | None, emulator: Path | None, json: bool) -> None:
    """Show control-variate estimates of means and probabilities with a twin."""
    opened = Result.open(result)
    fidelities = with_twin(opened, model, emulator)
    if json:
        print_json(twin_facts(fidelities).json)
        return
    heading(
        f"With {fidelities.twin} as twin",
        f"{fidelities.rows} rows, and {fidelities.cheap_rows} of the twin alone",
    )
    for name, estimates in fidelities.outputs.items():
        sharpened = {label: sharper.estimate for label, sharper in estimates.items()}
        target, sizes = _show_target(opened, name, sharpened)
        grid(
            [
                (
                    target.label(label),
                    value_text(sharper.estimate, per=sizes[label]),
                    _ends(sharper.estimate, sizes[label]),
                    _ends(sharper.plain, sizes[label]),
                    f"{sharper.reduction:.3g}",
                )
                for label, sharper in estimates.items()
            ],
            header=(*CELLS, "without twin", "worth"),
        )
        for label, sharper in estimates.items():
            if sharper.note:
                paragraph(f"{target.label(label)}: {sharper.note}", indent=2)
            if worst := failed_bounds_text(sharper.failed):
                both = "with invalid rows at best and worst"
                paragraph(f"{target.label(label)}, {both}: {worst}", indent=2)
    note(
        "worth: variance reduction factor against plain Monte Carlo, without the cost of the twin's"
        " rows. The twin pays if one of its rows takes less than (worth - 1) /"
        f" {1 + fidelities.cheap_rows / fidelities.rows:.3g} of the time of a row"
    )


def emulate(result: Path, path: Path, outputs: Sequence[str], json: bool) -> None:
    """Fit emulators of the outputs of a result, write them, and show their errors."""
    emulator = fitted(result, path, outputs)
    facts = emulator_facts(emulator).json
    if json:
        print_json(facts)
        return
    heading(f"{path}", f"emulator of {len(emulator.x)} rows of {emulator.source['title']}")
    lines = []
    for name, numbers in facts["outputs"].items():
        if not numbers["refused"]:
            unit = emulator.outputs[name]["unit"]
            lines.append((name, numbers["kind"], *_errors(numbers, unit)))
    grid(lines, header=("", "kind", "Q2", "error", "wrong label"))
    for name, numbers in facts["outputs"].items():
        if numbers["refused"]:
            paragraph(f"{name}: refused: {numbers['refused']}", indent=0)
    if emulator.failed:
        paragraph(
            f"{counted(emulator.failed, 'row')} failed and taught nothing: rows like these are"
            " predicted as if they did not fail",
            indent=0,
        )
    note(
        "Q2: share of the variance explained in rows left out; error: root of their mean square. A"
        f" row of 'uq run STUDY --model {path}' has an error drawn from these, so its scatter is"
        f" right, but a bias remains: 'uq twin {result} --emulator {path}' has none"
    )


def _short(error: float, unit: str) -> str:
    readable = unit_of(unit, error)
    return beside(f"{error / readable.size:.2g}", readable.name)


def _errors(numbers: Mapping[str, Any], unit: str) -> tuple[str, str, str]:
    """Return the share of the variance that is explained, the error, and the wrong labels."""
    wrong = percent(numbers["misclassified"]) if "misclassified" in numbers else ""
    if numbers["q2"] is None:
        return "", "", wrong
    error = numbers["error_sd"]
    in_unit = percent(error) if numbers.get("logarithm") else _short(error, unit)
    return f"{numbers['q2']:.4f}", in_unit, wrong


def convergence(result: Path, output: str | None, json: bool) -> None:
    """Show running estimates, and whether the sampling error dominates."""
    opened = Result.open(result)
    outputs = converging(opened, output)
    if json:
        print_json(convergence_facts(outputs).json)
        return
    for line in verdict(Findings(opened), output):
        paragraph(line, indent=0)
    for name, (_, errors) in outputs.items():
        if errors and errors["warning"]:
            paragraph(f"{name}: {errors['warning']}.", indent=0)
    for name, (estimates, errors) in outputs.items():
        last = {label: lines[-1][1].estimate for label, lines in estimates.items()}
        target, sizes = _show_target(opened, name, last)
        for label, lines in estimates.items():
            per = sizes[label]
            grid(
                [
                    (str(samples), value_text(line.estimate, per=per), _ends(line.estimate, per))
                    for samples, line in lines[-_SHOWN:]
                ],
                header=("samples", target.label(label), "95 % interval"),
            )
        if errors and isfinite(errors["own"]):
            kinds = (Estimate(errors[kind]) for kind in ("sampling", "own"))
            sampling, rows = (value_text(error, per=sizes["mean"]) for error in kinds)
            paragraph(f"sampling error {sampling}, error of the rows themselves {rows}", indent=2)


def fleet(
    result: Path,
    size: int,
    by: Sequence[str],
    allow: int,
    output: str | None,
    plain: bool,
    json: bool,
) -> None:
    """Show the first failure time in a fleet, and the number of failures by a time."""
    opened = Result.open(result)
    units = lifetime_element(opened.independent, output).declared.unit if by else ""
    times = [read_threshold("--by", text, "a life", units) for text in by]
    first_ends = fleet_of(opened, size, times, allow, output, plain=plain)
    if json:
        print_json(fleet_facts(first_ends).json)
        return
    title(opened, first_ends.design)
    unit = unit_of(
        first_ends.units, typical(banded.estimate.value for banded in first_ends.first.values())
    )
    heading(
        f"\n{first_ends.output}{in_brackets(unit)}", f"the first of {size} has {first_ends.ended}"
    )
    _show([(f"quantile {p!r}", banded) for p, banded in first_ends.first.items()], unit.size)
    for time, (failed, at_most) in first_ends.by.items():
        heading(f"\nby {threshold(time, first_ends.units)}")
        kept = f"at most {allow} {'has' if allow == 1 else 'have'} {first_ends.ended}"
        kept = kept if allow else f"none has {first_ends.ended}"
        _show([(f"have {first_ends.ended}", failed), (f"P({kept})", at_most)])
    for text in first_ends.sentences:
        note(text)


def _show(lines: Sequence[tuple[str, Banded]], per: float = 1.0) -> None:
    grid([line for label, banded in lines for line in _lines(label, banded, per)], CELLS)
    for reason in dict.fromkeys(reason for _, banded in lines for reason in reasons(banded)):
        paragraph(reason, indent=2)


def _lines(label: str, banded: Banded, per: float) -> Iterator[tuple[str, str, str]]:
    ends = (("5 % of samples", banded.low), ("95 % of samples", banded.high))
    for name, end in ((label, banded.estimate), *(("  " + text, end) for text, end in ends)):
        yield name, *cells(end, per)
    if worst := failed_bounds_text(banded.failed, per):
        yield "  with invalid rows", "", worst
