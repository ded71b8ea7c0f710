"""What ``uq rare-event`` does."""

import sys
from math import isfinite
from typing import Any

import numpy as np
import xarray as xr

from uq.cli import say_when_interrupted
from uq.cli.printing import console, grid, heading, number, paragraph, print_json
from uq.errors import InputError
from uq.exploring import rare_events
from uq.study.definition import load_study


def rare_event(
    path: str,
    model: str | None,
    output: str,
    above: float | None,
    below: float | None,
    json: bool,
    options: dict[str, Any],
) -> int:
    """Estimate the probability of a rare event and show it; return the exit code.

    Parameters
    ----------
    path, model, output, above, below, json
        As given on the command line.
    options : dict
        What else `uq.rare_event` takes.
    """
    study = load_study(path, model)
    if (above is None) == (below is None):
        raise InputError("uq: give one of --above and --below")
    say_when_interrupted("interrupted; nothing was written")
    limits = [(above, False), (below, True)]
    ds = next(
        rare_events.rare_event(study, output, threshold, is_below, **options)
        for threshold, is_below in limits
        if threshold is not None
    )
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
    if np.isfinite(ds["failed_high"]):
        names["failed_high"] = "failed_high"
    about = {name: ds.attrs[name] for name in ("output", "side", "threshold", "units", "method")}
    return {
        **about,
        "probability": {key: float(ds[name]) for key, name in names.items()},
        "estimates": ds["estimate"].values.tolist(),
        **{name: int(ds[name]) for name in ("rows", "failed", "undefined")},
        **_by_method(ds),
        "notes": ds.attrs["notes"].splitlines(),
    }


def _by_method(ds: xr.Dataset) -> dict[str, Any]:
    if "typical" in ds:
        return {"ended": ds["ended"].values.tolist(), "typical": _by_parameter(ds["typical"])}
    return {
        "design_points": [
            {name: float(point[name]) for name in ("reliability_index", "first_order")}
            | {"location": _by_parameter(point["location"])}
            for point in _design_points(ds)
        ]
    }


def _design_points(ds: xr.Dataset) -> list[xr.Dataset]:
    return [ds.isel(design_point=i) for i in range(ds.sizes.get("design_point", 0))]


def _by_parameter(values: xr.DataArray) -> dict[str, float]:
    return {str(name): float(value) for name, value in values.to_series().items()}


def _cell(value: float) -> str:
    return number(value if isfinite(value) else None)


def _show(ds: xr.Dataset) -> None:
    sign = ">" if ds.attrs["side"] == "above" else "<"
    unit = "" if ds.attrs["units"] == "1" else f" {ds.attrs['units']}"
    event = f"P({ds.attrs['output']} {sign} {ds.attrs['threshold']:g}{unit})"
    heading(event, f"by {ds.attrs['method']}")
    low, high, worst = (_cell(float(ds[name])) for name in ("low", "high", "failed_high"))
    grid(
        [
            ("probability", _cell(float(ds["probability"]))),
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
    for point in _design_points(ds):
        index = f"reliability index {float(point['reliability_index']):.4g}"
        first = float(point["first_order"])
        heading("\nDesign point", f"{index}, first-order probability {first:.3g}")
        _show_inputs(point["location"])
    for note in ds.attrs["notes"].splitlines():
        console.print()
        paragraph(note, indent=0)


def _show_inputs(values: xr.DataArray) -> None:
    grid([(name, _cell(value)) for name, value in _by_parameter(values).items()])
