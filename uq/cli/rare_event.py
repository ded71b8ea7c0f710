"""Terminal output of ``uq rare-event``."""

from math import isfinite
from typing import Any

import numpy as np
import xarray as xr

from uq.cli.printing import grid, heading, note, number, print_json
from uq.cli.progress import say, say_plain
from uq.contract import Model
from uq.errors import InputError
from uq.machines.row_by_row import undeclared_lives
from uq.study.definition import Study
from uq.text.numbers import quantity
from uq.text.numbers import threshold as threshold_in_words
from uq.text.quantities import read_threshold


def limit(study: Study, output: str, above: str | None, below: str | None) -> tuple[float, bool]:
    """Return the threshold that one of two options gives, and whether the event is below it."""
    if (above is None) == (below is None):
        raise InputError("uq: give one of --above and --below")
    name = output.partition("[")[0]
    units = study.model.outputs[name].unit if name in study.model.outputs else "1"
    option, text = ("--above", above) if above is not None else ("--below", str(below))
    return read_threshold(option, text, name, units), above is None


def warn(study: Study, output: str) -> None:
    """Print on standard error if an output has the name of a life, but is not declared as one."""
    name = output.partition("[")[0]
    if name in study.model.outputs:
        say_plain(*undeclared_lives(study.model, (name,)))


def show(ds: xr.Dataset, json: bool, study: Study, threshold: float) -> int:
    """Print the probability of a rare event; return the exit code."""
    print_json(as_json(ds)) if json else _show(ds, study.model, threshold)
    max_failed = study.analysis.max_failed
    failed = int(ds["failed"]) / int(ds["rows"])
    if failed <= max_failed:
        return 0
    allowed = f"more than max_failed = {max_failed:g} allows"
    say(f"{failed:.0%} of the rows are invalid, {allowed}")
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
        "estimated_by": ds.attrs["estimated_by"],
        "interval_of": ds.attrs["interval_of"],
        **_unseen(ds),
        **_by_method(ds),
        "notes": ds.attrs["notes"].splitlines(),
    }


def _unseen(ds: xr.Dataset) -> dict[str, Any]:
    """Return the results of plain rows and widened laws on parts missed by the method."""
    if "wide" not in ds:
        return {}
    names = {"value": "wide", "low": "wide_low", "high": "wide_high"}
    wide: dict[str, Any] = {key: float(ds[name]) for key, name in names.items()}
    counts = {key: int(ds[f"wide_{key}"]) for key in ("hits", "rows", "failed")}
    return {"hidden_high": float(ds["hidden_high"]), "wide": wide | counts}


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


def _shown_unseen(ds: xr.Dataset) -> list[tuple[str, str]]:
    if "wide" not in ds:
        return []
    hits, rows = int(ds["wide_hits"]), int(ds["wide_rows"])
    return [
        ("a hidden part", f"at most {float(ds['hidden_high']):.2g} (95 %)"),
        ("rows drawn wide", f"{rows}, {hits} within the event"),
    ]


def _part_alone(ds: xr.Dataset) -> str:
    """Return a remark beside the interval if it covers only a part of the event."""
    return "" if ds.attrs["interval_of"] == "event" else f", only {ds.attrs['interval_of']}"


def _cell(value: float) -> str:
    return number(value if isfinite(value) else None)


def _show(ds: xr.Dataset, model: Model, threshold: float) -> None:
    output, sign = ds.attrs["output"], ">" if ds.attrs["side"] == "above" else "<"
    variable = f"|{output}|" if model.outputs[output.partition("[")[0]].is_angle else output
    event = f"P({variable} {sign} {threshold_in_words(threshold, ds.attrs['units'])})"
    by_wide = ", estimate by rows drawn wide" * (ds.attrs["estimated_by"] == "wide")
    heading(event, f"by {ds.attrs['method']}{by_wide}")
    low, high, worst = (_cell(float(ds[name])) for name in ("low", "high", "failed_high"))
    grid(
        [
            ("probability", _cell(float(ds["probability"]))),
            ("95 % interval", f"{low} to {high}{_part_alone(ds)}"),
            *_shown_unseen(ds),
            *([("with invalid rows inside", f"up to {worst}")] if worst != "-" else []),
            ("rows", str(int(ds["rows"]))),
            *((name, str(int(ds[name]))) for name in ("failed", "undefined") if ds[name] > 0),
        ]
    )
    if "typical" in ds:
        heading("\nMedian of each input, given the event")
        _show_inputs(ds["typical"], model)
    for point in _design_points(ds):
        index = f"reliability index {float(point['reliability_index']):.4g}"
        first = float(point["first_order"])
        heading("\nDesign point", f"{index}, first-order probability {first:.3g}")
        _show_inputs(point["location"], model)
    for text in ds.attrs["notes"].splitlines():
        note(text)


def _show_inputs(values: xr.DataArray, model: Model) -> None:
    pairs = _by_parameter(values).items()
    grid([(name, quantity(value, model.parameter(name).unit)) for name, value in pairs])
