"""What ``uq twin`` and ``uq convergence`` print."""

from math import isfinite
from pathlib import Path

from uq.analysis.as_json import convergence_json, twin_json
from uq.analysis.converging import converging
from uq.analysis.findings import Findings
from uq.analysis.twin import with_twin
from uq.cli.printing import grid, heading, note, paragraph, print_json
from uq.conclusions.advice import verdict
from uq.estimate import Estimate
from uq.rows.results import open_result
from uq.wording import estimated, failed_interval, interval, known

_SHOWN = 6  # sizes of each estimate on a terminal


def twin(result: Path, model: str | None, json: bool) -> None:
    """Show means and probabilities sharpened with the study's twin."""
    found = with_twin(open_result(result), model)
    if json:
        print_json(twin_json(found))
        return
    heading(
        f"With {found.twin} as twin", f"{found.rows} rows, and {found.cheap_rows} of the twin alone"
    )
    for name, estimates in found.outputs.items():
        heading(f"\n{name}")
        grid(
            [
                (estimated(label), *_cells(one.estimate), _ends(one.plain), f"{one.reduction:.3g}")
                for label, one in estimates.items()
            ],
            header=("", "value", "95 % interval", "without twin", "worth"),
        )
        for label, one in estimates.items():
            if one.note:
                paragraph(f"{estimated(label)}: {one.note}", indent=2)
            if worst := failed_interval(one.failed):
                paragraph(f"{estimated(label)}, with failed rows at best and worst: {worst}", 2)
    note(
        "worth: without twin, so many times the rows would be as accurate. The twin's own rows are"
        " not counted: it pays if one of them takes less than (worth - 1) /"
        f" {1 + found.cheap_rows / found.rows:.3g} of the time of a row"
    )


def _cells(one: Estimate) -> tuple[str, str]:
    return known(one), _ends(one)


def _ends(one: Estimate) -> str:
    return interval(one) if one.has_interval else ""


def convergence(result: Path, output: str | None, json: bool) -> None:
    """Show running estimates, and whether sampling is still the largest error."""
    ds = open_result(result)
    found = converging(ds, output)
    if json:
        print_json(convergence_json(found))
        return
    if output is None:
        for line in verdict(Findings(ds)):
            paragraph(line, indent=0)
    for name, one in found.items():
        heading(f"\n{name}")
        for label, sizes in one.estimates.items():
            grid(
                [(str(samples), *_cells(estimate)) for samples, estimate in sizes[-_SHOWN:]],
                header=("samples", estimated(label), "95 % interval"),
            )
        if own := one.errors:
            if isfinite(own["own"]):
                sampling, rows = (known(Estimate(own[kind])) for kind in ("sampling", "own"))
                paragraph(f"sampling error {sampling}, error of the rows themselves {rows}", 2)
            if own["warning"]:
                paragraph(own["warning"], indent=2)
