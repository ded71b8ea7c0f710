"""What ``uq rare-event`` does."""

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from uq import json_form
from uq.cli import say_when_interrupted
from uq.cli.printing import console, grid, heading, number, paragraph, print_json
from uq.errors import InputError
from uq.study.definition import Study, load_study

Estimate = Callable[[Study, str, float, bool], xr.Dataset]
"""``estimate(study, output, threshold, below)``, as `uq.rare_event` with all else chosen."""


def rare_event(
    path: str,
    model: str | None,
    output: str,
    above: float | None,
    below: float | None,
    json: bool,
    estimate: Estimate,
) -> int:
    """Estimate the probability of a rare event and show it; return the exit code."""
    study = load_study(path, model)
    if (above is None) == (below is None):
        raise InputError("uq: give one of --above and --below")
    say_when_interrupted("interrupted; nothing was written")
    threshold = above if above is not None else below
    assert threshold is not None
    ds = estimate(study, output, threshold, above is None)
    print_json(as_json(ds)) if json else _show(ds)
    failed = int(ds["failed"]) / int(ds["rows"])
    if failed <= study.analysis.max_failed:
        return 0
    print(
        f"{failed:.0%} of the rows failed, more than max_failed = {study.analysis.max_failed:g}"
        " allows",
        file=sys.stderr,
    )
    return 1


def as_json(ds: xr.Dataset) -> dict[str, Any]:
    """Return the JSON of ``uq rare-event``."""
    names = {"value": "probability", "low": "low", "high": "high"}
    probability = {key: _number(ds[name]) for key, name in names.items()}
    if np.isfinite(ds["failed_high"]):
        probability["failed_high"] = float(ds["failed_high"])
    about = {name: ds.attrs[name] for name in ("output", "side", "threshold", "units", "method")}
    return {
        **about,
        "probability": probability,
        "estimates": ds["estimate"].values.tolist(),
        **{name: int(ds[name]) for name in ("rows", "failed", "undefined")},
        **_by_method(ds),
        "notes": ds.attrs["notes"].splitlines(),
    }


def _by_method(ds: xr.Dataset) -> dict[str, Any]:
    if "typical" in ds:
        return {"ended": ds["ended"].values.tolist(), "typical": _by_parameter(ds["typical"])}
    points = [ds.isel(design_point=i) for i in range(ds.sizes["design_point"])]
    return {
        "design_points": [
            {name: float(point[name]) for name in ("reliability_index", "first_order")}
            | {"location": _by_parameter(point["location"])}
            for point in points
        ]
    }


def _by_parameter(values: xr.DataArray) -> dict[str, float | None]:
    return {str(value["parameter"].item()): _number(value) for value in values}


def _number(value: xr.DataArray) -> float | None:
    return json_form.number(float(value))


def _show(ds: xr.Dataset) -> None:
    sign = ">" if ds.attrs["side"] == "above" else "<"
    unit = "" if ds.attrs["units"] == "1" else f" {ds.attrs['units']}"
    event = f"P({ds.attrs['output']} {sign} {ds.attrs['threshold']:g}{unit})"
    heading(event, f"by {ds.attrs['method']}")
    low, high, worst = (number(_number(ds[name])) for name in ("low", "high", "failed_high"))
    grid(
        [
            ("probability", number(_number(ds["probability"]))),
            ("95 % interval", f"{low} to {high}"),
            *([("with failed rows inside", f"up to {worst}")] if worst != "-" else []),
            ("rows", str(int(ds["rows"]))),
            ("failed", str(int(ds["failed"]) or "")),
            ("undefined", str(int(ds["undefined"]) or "")),
        ]
    )
    if "typical" in ds:
        heading("\nMedian of each input, given the event")
        _show_inputs(ds["typical"])
    for i in range(ds.sizes.get("design_point", 0)):
        point = ds.isel(design_point=i)
        index = f"reliability index {float(point['reliability_index']):.4g}"
        first = float(point["first_order"])
        heading("\nDesign point", f"{index}, first-order probability {first:.3g}")
        _show_inputs(point["location"])
    for note in ds.attrs["notes"].splitlines():
        console.print()
        paragraph(note, indent=0)


def _show_inputs(values: xr.DataArray) -> None:
    grid([(name, number(value)) for name, value in _by_parameter(values).items()])
