"""What ``uq twin`` and ``uq convergence`` print."""

from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Any

import pandas as pd

from uq import json_form
from uq.analysis.convergence import enough, running_estimates
from uq.analysis.findings import Findings
from uq.analysis.twin import Sharpened, TwoFidelities, with_twin
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


def twin_json(found: TwoFidelities) -> dict[str, Any]:
    """Return estimates with a twin as plain data."""
    outputs = {
        name: {label: _sharpened(one) for label, one in estimates.items()}
        for name, estimates in found.outputs.items()
    }
    return vars(found) | {"outputs": outputs}


def _sharpened(one: Sharpened) -> dict[str, Any]:
    plain = {"plain": json_form.numbers(one.plain), "reduction": one.reduction}
    note = {"note": one.note} if one.note else {}
    return json_form.numbers(one.estimate) | plain | json_form.failed(one.failed) | note


def _cells(one: Estimate) -> tuple[str, str]:
    return known(one), _ends(one)


def _ends(one: Estimate) -> str:
    return interval(one) if one.has_interval else ""


def convergence(result: Path, output: str | None, json: bool) -> None:
    """Show running estimates, and whether sampling is still the largest error."""
    ds = open_result(result)
    running, errors = running_estimates(ds, output), enough(ds, output).to_dict("index")
    found = {
        str(name): {str(label): _sizes(own) for label, own in lines.groupby("estimate", sort=False)}
        for name, lines in running.groupby("output", sort=False)
    }
    if json:
        print_json({"outputs": {name: _json(one, errors.get(name)) for name, one in found.items()}})
        return
    if output is None:
        for line in verdict(Findings(ds)):
            paragraph(line, indent=0)
    for name, estimates in found.items():
        heading(f"\n{name}")
        for label, sizes in estimates.items():
            grid(
                [(str(samples), *_cells(one)) for samples, one in sizes[-_SHOWN:]],
                header=("samples", estimated(label), "95 % interval"),
            )
        if own := errors.get(name):
            if isfinite(own["own"]):
                sampling, rows = (known(Estimate(own[kind])) for kind in ("sampling", "own"))
                paragraph(f"sampling error {sampling}, error of the rows themselves {rows}", 2)
            if own["warning"]:
                paragraph(own["warning"], indent=2)


Sizes = list[tuple[int, Estimate]]
"""Number of samples, and the estimate from them."""


def _sizes(lines: pd.DataFrame) -> Sizes:
    columns = (lines[name].tolist() for name in ("samples", "value", "low", "high"))
    return [(samples, Estimate(*numbers)) for samples, *numbers in zip(*columns, strict=True)]


def _json(estimates: Mapping[str, Sizes], errors: dict[Any, Any] | None) -> dict[str, Any]:
    found: dict[str, Any] = {
        "estimates": {
            label: [{"samples": samples} | json_form.numbers(one) for samples, one in sizes]
            for label, sizes in estimates.items()
        }
    }
    if errors:
        found["sampling_error"] = json_form.number(errors["sampling"])
        found["own_error"] = json_form.number(errors["own"])
        found["warning"] = errors["warning"]
    return found
