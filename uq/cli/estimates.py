"""What ``uq twin`` and ``uq convergence`` print."""

from pathlib import Path
from typing import Any

from uq import json_form
from uq.cli.printing import console, grid, heading, number, paragraph, print_json
from uq.estimate import Estimate
from uq.wording import estimated, failed_interval

_SHOWN = 6  # sizes of each estimate on a terminal


def twin(result: Path, model: str | None, json: bool) -> None:
    """Show means and probabilities sharpened by the study's cheap output."""
    from uq.analysis.twin import with_twin
    from uq.rows.results import open_result

    found = with_twin(open_result(result), model)
    if json:
        print_json(found)
        return
    heading(
        f"With {found['twin']} as twin",
        f"{found['rows']} rows, and {found['cheap_rows']} of the twin alone",
    )
    for name, estimates in found["outputs"].items():
        heading(f"\n{name}")
        grid(
            [
                (
                    estimated(label),
                    number(entry["value"]),
                    _interval(entry),
                    _interval(entry["plain"]),
                    times,
                )
                for label, entry in estimates.items()
                for times in [f"{entry['reduction']:.3g}"]
            ],
            header=("", "value", "95 % interval", "without twin", "worth"),
        )
        for label, entry in estimates.items():
            if note := entry.get("note"):
                paragraph(f"{estimated(label)}: {note}", indent=2)
            if worst := failed_interval(_failed(entry)):
                paragraph(f"{estimated(label)}, with failed rows at best and worst: {worst}", 2)
    console.print()
    per_row = 1 + found["cheap_rows"] / found["rows"]
    paragraph(
        "worth: how many times more rows without twin would do the same. The twin's own rows are"
        " not counted as cost: it pays where one of them takes less than (worth - 1) /"
        f" {per_row:.3g} of the time of a row",
        indent=0,
    )


def _failed(entry: dict[str, Any]) -> Estimate | None:
    if "failed_low" not in entry:
        return None
    return Estimate(low=entry["failed_low"], high=entry["failed_high"])


def _interval(entry: dict[str, Any]) -> str:
    if None in (entry["low"], entry["high"]):
        return ""
    return f"{number(entry['low'])} to {number(entry['high'])}"


def convergence(result: Path, output: str | None, json: bool) -> None:
    """Show estimates as the rows came in, and whether sampling is still the largest error."""
    from uq.analysis.convergence import enough, running_estimates
    from uq.rows.results import open_result

    ds = open_result(result)
    running, errors = running_estimates(ds, output), enough(ds, output)
    found: dict[str, Any] = {}
    for line in running.to_dict("records"):
        entry = found.setdefault(line["output"], {"estimates": {}})
        numbers = {end: json_form.number(line[end]) for end in ("value", "low", "high")}
        lines = entry["estimates"].setdefault(line["estimate"], [])
        lines.append({"samples": line["samples"]} | numbers)
    for name, errors_of in errors.to_dict("index").items():
        if entry := found.get(str(name)):
            entry["sampling_error"] = json_form.number(errors_of["sampling"])
            entry["own_error"] = json_form.number(errors_of["own"])
            entry["warning"] = errors_of["warning"]
    print_json({"outputs": found}) if json else _show_convergence(found)


def _show_convergence(found: dict[str, Any]) -> None:
    for name, entry in found.items():
        heading(f"\n{name}")
        for label, lines in entry["estimates"].items():
            grid(
                [
                    (str(line["samples"]), number(line["value"]), _interval(line))
                    for line in lines[-_SHOWN:]
                ],
                header=("samples", estimated(label), "95 % interval"),
            )
        if entry.get("own_error") is not None:
            paragraph(
                f"error of sampling {number(entry['sampling_error'])}, of the rows themselves"
                f" {number(entry['own_error'])}",
                indent=2,
            )
        if entry.get("warning"):
            paragraph(entry["warning"], indent=2)
