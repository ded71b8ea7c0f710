"""Terminal output of ``uq twin`` and ``uq convergence``."""

from collections.abc import Mapping
from math import isfinite
from pathlib import Path

from uq.assess.answer.number_targets import NumberTarget
from uq.assess.answer.verdict import verdict
from uq.assess.findings import Findings
from uq.assess.running_estimates import convergence_facts, converging
from uq.assess.two_fidelities import twin_facts, with_twin
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import failed_bounds_text, interval_text, value_text
from uq.text.numbers import in_brackets
from uq.text.units import typical, unit_of

_SHOWN = 6  # sizes of each estimate on a terminal


class _Block:
    """How the estimates of one target are shown: its name, and their unit."""

    def __init__(self, result: Result, name: str, estimates: Mapping[str, Estimate]):
        self._target = NumberTarget(result, name)
        values = (estimate.value for label, estimate in estimates.items() if _is_value(label))
        self._unit = unit_of(self._target.units, typical(values))

    def show_heading(self) -> None:
        """Print the name, with its unit and meaning."""
        heading(f"\n{self._target.name}{in_brackets(self._unit)}", self._target.meaning)

    def label(self, label: str) -> str:
        """Return the name of an estimate."""
        return self._target.label(label)

    def cells(self, label: str, estimate: Estimate) -> tuple[str, str]:
        """Return value and interval of an estimate in the unit of the block."""
        return value_text(estimate, per=self._per(label)), self.ends(label, estimate)

    def ends(self, label: str, estimate: Estimate) -> str:
        """Return the interval of an estimate in the unit of the block; "" without one."""
        return interval_text(estimate, self._per(label)) if estimate.has_interval else ""

    def _per(self, label: str) -> float:
        return self._unit.size if _is_value(label) else 1.0


def _is_value(label: str) -> bool:
    """Return whether an estimate is in the unit of the output."""
    return label.startswith(("mean", "quantile"))


def twin(result: Path, model: str | None, json: bool) -> None:
    """Show means and probabilities sharpened with the study's twin."""
    opened = Result.open(result)
    fidelities = with_twin(opened, model)
    if json:
        print_json(twin_facts(fidelities).json)
        return
    heading(
        f"With {fidelities.twin} as twin",
        f"{fidelities.rows} rows, and {fidelities.cheap_rows} of the twin alone",
    )
    for name, estimates in fidelities.outputs.items():
        block = _Block(
            opened,
            name,
            {label: twin_estimate.estimate for label, twin_estimate in estimates.items()},
        )
        block.show_heading()
        grid(
            [
                (
                    block.label(label),
                    *block.cells(label, twin_estimate.estimate),
                    block.ends(label, twin_estimate.plain),
                    f"{twin_estimate.reduction:.3g}",
                )
                for label, twin_estimate in estimates.items()
            ],
            header=("", "value", "95 % interval", "without twin", "worth"),
        )
        for label, twin_estimate in estimates.items():
            if twin_estimate.note:
                paragraph(f"{block.label(label)}: {twin_estimate.note}", indent=2)
            if worst := failed_bounds_text(twin_estimate.failed):
                both = "with failed rows at best and worst"
                paragraph(f"{block.label(label)}, {both}: {worst}", indent=2)
    note(
        "worth: without twin, so many times the rows would be as accurate. The twin's own rows are"
        " not counted: it pays if one of them takes less than (worth - 1) /"
        f" {1 + fidelities.cheap_rows / fidelities.rows:.3g} of the time of a row"
    )


def convergence(result: Path, output: str | None, json: bool) -> None:
    """Show running estimates, and whether sampling is still the largest error."""
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
        last = {label: sizes[-1][1].estimate for label, sizes in estimates.items()}
        block = _Block(opened, name, last)
        block.show_heading()
        for label, sizes in estimates.items():
            grid(
                [
                    (str(samples), *block.cells(label, line.estimate))
                    for samples, line in sizes[-_SHOWN:]
                ],
                header=("samples", block.label(label), "95 % interval"),
            )
        if errors and isfinite(errors["own"]):
            kinds = (Estimate(errors[kind]) for kind in ("sampling", "own"))
            sampling, rows = (block.cells("mean", error)[0] for error in kinds)
            paragraph(f"sampling error {sampling}, error of the rows themselves {rows}", indent=2)
