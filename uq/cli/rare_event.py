"""Terminal output of ``uq rare-event``."""

import re
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

_LIMIT = re.compile(r"\s*(.*?)\s*([<>])\s*(.*?)\s*")


def limits(
    study: Study,
    output: str | None,
    above: str | None,
    below: str | None,
    any_of: list[str],
    all_of: list[str],
) -> dict[str, Any]:
    """Return the arguments of `uq.rare_event` that options give for its event."""
    if any_of or all_of:
        if any_of and all_of:
            raise InputError("uq: give one of --any and --all")
        if not output is above is below is None:
            raise InputError("uq: give --output with --above or --below, or limits with --any")
        option, key = ("--any", "any_of") if any_of else ("--all", "all_of")
        if len(any_of or all_of) < 2:
            raise InputError(
                f'uq: give {option} at least twice, such as {option} "a > 3" {option} "b < 1";'
                " a single limit is --output with --above or --below"
            )
        return {key: [_limit(study, option, text) for text in any_of or all_of]}
    if output is None:
        raise InputError('uq: give an --output, or limits such as --any "a > 3" --any "b < 1"')
    if (above is None) == (below is None):
        raise InputError("uq: give one of --above and --below")
    option, text = ("--above", above) if above is not None else ("--below", str(below))
    threshold = _threshold(study, option, text, output)
    return {"output": output, "threshold": threshold, "below": above is None}


def _limit(study: Study, option: str, text: str) -> tuple[str, float, str]:
    matched = _LIMIT.fullmatch(text)
    if not matched or not matched[1] or not matched[3]:
        raise InputError(f"uq: {option} {text!r} is not a limit, such as 'life < 24 hours'")
    name, sign, value = matched.groups()
    side = "above" if sign == ">" else "below"
    return name, _threshold(study, option, value, name), side


def _threshold(study: Study, option: str, text: str, output: str) -> float:
    name = output.partition("[")[0]
    units = study.model.outputs[name].unit if name in study.model.outputs else "1"
    return read_threshold(option, text, name, units)


def written(event: dict[str, Any]) -> list[tuple[str, float]]:
    """Return the outputs of an event, with their thresholds."""
    if "output" in event:
        return [(event["output"], event["threshold"])]
    return [(name, limit) for name, limit, _ in event.get("any_of") or event["all_of"]]


def warn(study: Study, event: dict[str, Any]) -> None:
    """Print on standard error if an output has the name of a life, but is not declared as one."""
    for name in dict.fromkeys(output.partition("[")[0] for output, _ in written(event)):
        if name in study.model.outputs:
            say_plain(*undeclared_lives(study.model, (name,)))


def show(ds: xr.Dataset, json: bool, study: Study, *thresholds: float) -> int:
    """Print the probability of a rare event, with its thresholds as written; return the code."""
    print_json(as_json(ds)) if json else _show(ds, study.model, thresholds)
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
    keys = ("output", "side", "threshold", "units", "combination", "method")
    about = {name: ds.attrs[name] for name in keys if name in ds.attrs}
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
        return {"hidden_high": float(ds["hidden_high"])} if "hidden_high" in ds else {}
    names = {"value": "wide", "low": "wide_low", "high": "wide_high"}
    wide: dict[str, Any] = {key: float(ds[name]) for key, name in names.items()}
    counts = {key: int(ds[f"wide_{key}"]) for key in ("hits", "rows", "failed")}
    return {"hidden_high": float(ds["hidden_high"]), "wide": wide | counts}


def _by_method(ds: xr.Dataset) -> dict[str, Any]:
    if "typical" in ds:
        return {"ended": ds["ended"].values.tolist(), "typical": _by_parameter(ds["typical"])}
    if "checks" in ds:
        doubt = float(ds["misclassified"])
        return {
            "emulated": float(ds["emulated"]),
            "misclassified": doubt if isfinite(doubt) else None,
            **{name: int(ds[name]) for name in ("checks", "contradicted")},
        }
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
    if "hidden_high" not in ds:
        return []
    hidden = ("a hidden part", f"at most {float(ds['hidden_high']):.2g} (95 %)")
    if "wide" not in ds:
        return [hidden]
    hits, rows = int(ds["wide_hits"]), int(ds["wide_rows"])
    return [hidden, ("rows drawn wide", f"{rows}, {hits} within the event")]


def _part_alone(ds: xr.Dataset) -> str:
    """Return a remark beside the interval if it covers only a part of the event."""
    return "" if ds.attrs["interval_of"] == "event" else f", only {ds.attrs['interval_of']}"


def _cell(value: float) -> str:
    return number(value if isfinite(value) else None)


def _in_words(output: str, side: str, units: str, threshold: float, model: Model) -> str:
    sign = ">" if side == "above" else "<"
    variable = f"|{output}|" if model.outputs[output.partition("[")[0]].is_angle else output
    return f"{variable} {sign} {threshold_in_words(threshold, units)}"


def _show(ds: xr.Dataset, model: Model, thresholds: tuple[float, ...]) -> None:
    about = (np.atleast_1d(ds.attrs[name]).tolist() for name in ("output", "side", "units"))
    each = [
        _in_words(output, side, units, threshold, model)
        for output, side, units, threshold in zip(*about, thresholds, strict=True)
    ]
    word = " and " if ds.attrs.get("combination") == "all" else " or "
    event = f"P({word.join(each)})"
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
