"""What ``uq rare-event``, ``uq twin`` and ``uq convergence`` print."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.cli import say_when_interrupted
from uq.cli.printing import console, grid, heading, number, paragraph, print_json
from uq.errors import InputError
from uq.estimate import Estimate
from uq.study.definition import load_study
from uq.wording import estimated, failed_interval

_SHOWN = 6  # sizes of each estimate on a terminal


def rare_event(
    path: Path | str,
    model: str | None,
    output: str,
    above: float | None,
    below: float | None,
    json: bool,
    options: dict[str, Any],
) -> int:
    """Estimate the probability of a rare event and show it; return the exit code."""
    from uq.exploring.rare_events import rare_event

    study = load_study(path, model)
    if (above is None) == (below is None):
        raise InputError("uq: give one of --above and --below")
    say_when_interrupted("interrupted; nothing was written")
    threshold = above if above is not None else below
    assert threshold is not None
    ds = rare_event(study, output, threshold, above is None, **options)
    print_json(_plain(ds)) if json else _show(ds)
    failed = int(ds["failed"]) / int(ds["rows"])
    if failed <= study.analysis.max_failed:
        return 0
    print(
        f"{failed:.0%} of the rows failed, more than max_failed = {study.analysis.max_failed:g}"
        " allows",
        file=sys.stderr,
    )
    return 1


def _plain(ds: xr.Dataset) -> dict[str, Any]:
    found: dict[str, Any] = {
        name: ds.attrs[name] for name in ("output", "side", "threshold", "units", "method")
    }
    names = {"value": "probability", "low": "low", "high": "high"}
    found["probability"] = {key: _finite(float(ds[name])) for key, name in names.items()}
    if np.isfinite(ds["failed_high"]):
        found["probability"]["failed_high"] = float(ds["failed_high"])
    found["estimates"] = ds["estimate"].values.tolist()
    found |= {name: int(ds[name]) for name in ("rows", "failed", "undefined")}
    if "typical" in ds:
        found["ended"] = ds["ended"].values.tolist()
        found["typical"] = _by_parameter(ds["typical"])
    else:
        found["design_points"] = [
            {name: float(ds[name][i]) for name in ("reliability_index", "first_order")}
            | {"location": _by_parameter(ds["location"][i])}
            for i in range(ds.sizes["design_point"])
        ]
    return found | {"notes": ds.attrs["notes"].splitlines()}


def _by_parameter(values: xr.DataArray) -> dict[str, float | None]:
    names = values["parameter"].values.tolist()
    return dict(zip(names, map(_finite, values.values.tolist()), strict=True))


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _show(ds: xr.Dataset) -> None:
    found = _plain(ds)
    sign = ">" if found["side"] == "above" else "<"
    unit = "" if found["units"] == "1" else f" {found['units']}"
    heading(f"P({found['output']} {sign} {found['threshold']:g}{unit})", f"by {found['method']}")
    probability = found["probability"]
    grid(
        [
            ("probability", number(probability["value"])),
            ("95 % interval", f"{number(probability['low'])} to {number(probability['high'])}"),
            *_failed_inside(probability),
            ("rows", str(found["rows"])),
            ("failed", str(found["failed"] or "")),
            ("undefined", str(found["undefined"] or "")),
        ]
    )
    if "typical" in found:
        heading("\nMedian of each input, given the event")
        grid([(name, number(value)) for name, value in found["typical"].items()])
    for point in found.get("design_points", ()):
        index = f"reliability index {point['reliability_index']:.4g}"
        heading("\nDesign point", f"{index}, first-order probability {point['first_order']:.3g}")
        grid([(name, number(value)) for name, value in point["location"].items()])
    for note in found["notes"]:
        console.print()
        paragraph(note, indent=0)


def _failed_inside(probability: dict[str, Any]) -> list[tuple[str, str]]:
    worst = probability.get("failed_high")
    return [] if worst is None else [("with failed rows inside", f"up to {number(worst)}")]


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
        numbers = {end: _finite(line[end]) for end in ("value", "low", "high")}
        lines = entry["estimates"].setdefault(line["estimate"], [])
        lines.append({"samples": line["samples"]} | numbers)
    for name, errors_of in errors.to_dict("index").items():
        if entry := found.get(str(name)):
            entry["sampling_error"] = _finite(errors_of["sampling"])
            entry["own_error"] = _finite(errors_of["own"])
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
