"""What ``uq simulate`` does."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq import store
from uq.cli.printing import duration, grid, heading, number, print_json
from uq.cli.progress import say_compiling
from uq.compilation import compilation
from uq.contract import Model, Status
from uq.errors import InputError
from uq.exploring.simulation import holds_trajectory
from uq.exploring.simulation import simulate as run_once
from uq.literals import read_number, read_toml
from uq.places import file_behind
from uq.rows import results
from uq.rows.elements import elements_of
from uq.study.registry import find_model


def simulate(
    reference: str,
    parameters: Sequence[str],
    settings: Sequence[str],
    json: bool,
    output: Path | None,
    plot: Path | None,
) -> int:
    """Run a model once and show the result; return the exit code."""
    model = find_model(reference)
    given = dict(_number(text) for text in parameters)
    chosen = dict(literal(text) for text in settings)
    for path in (output, plot):
        if path is not None:
            store.check_target(path, 0)
    if output and output.exists() and not holds_trajectory(output):
        raise InputError(
            f"{output}: exists and is not a trajectory of 'uq simulate'; choose another name"
        )
    if model.simulate is None and (output or plot):
        raise InputError(f"model '{model.name}' gives no trajectory; leave out -o and --plot")
    with compilation(say_compiling):
        ds = run_once(model, given, chosen, trajectory=bool(output or plot))
    if output:
        store.write(ds, output)
    if plot:
        from uq.drawing.figure import DOTS_PER_INCH
        from uq.plots import history

        try:
            file_behind(plot).parent.mkdir(parents=True, exist_ok=True)
            history(ds).savefig(plot, dpi=DOTS_PER_INCH)
        except (OSError, ValueError) as error:  # ValueError: a format matplotlib does not know
            raise InputError(f"{plot}: {getattr(error, 'strerror', None) or error}") from None
    print_json(as_json(model, ds)) if json else _show(model, ds)
    return 1 if results.failed(ds).any() else 0


def as_json(model: Model, ds: xr.Dataset) -> dict[str, Any]:
    """Return one row as the JSON of ``uq simulate``.

    Parameters
    ----------
    model : Model
    ds : xarray.Dataset
        From `uq.simulate`.

    Returns
    -------
    dict
        ``never``, ``censored`` and ``undefined`` name the outputs that are so.
    """
    status = Status(ds["status"].item())
    names: dict[str, list[str]] = {"never": [], "censored": [], "undefined": []}
    for element, _, state in (one for name in model.outputs for one in _states(ds, name)):
        if state:
            names[state].append(element)
    return {
        "model": model.name,
        "inputs": {name: ds[name].item() for name in model.parameter_names},
        "outputs": {name: _plain(model, name, ds[name].values[0]) for name in model.outputs},
        "status": {"code": status.label, "meaning": _meaning(ds, status)},
        **names,
    }


def _plain(model: Model, name: str, values: Any) -> Any:
    if not model.outputs[name].is_category:
        return values.astype(float).tolist()
    if np.ndim(values):
        return [_plain(model, name, value) for value in values]
    return model.outputs[name].categories[int(values)] if values >= 0 else None


def _states(ds: xr.Dataset, name: str) -> Iterator[tuple[str, float, str]]:
    """Yield name, value and never, censored, undefined or "" of each element of an output."""
    for element in elements_of(ds, [name]):
        states = ("censored", "never", "undefined")
        state = next((state for state in states if getattr(element, state)[0]), "")
        yield element.name, float(element.values[0]), state


def _show(model: Model, ds: xr.Dataset) -> None:
    status = Status(ds["status"].item())
    heading(f"{model.name}: {status.label}", "" if status is Status.OK else _meaning(ds, status))
    for name, output in model.outputs.items():
        unit = "" if output.unit == "1" else f" [{output.unit}]"
        heading(f"\n{name}{unit}", output.meaning)
        if output.is_category:
            grid([("", _plain(model, name, ds[name].values[0]) or "none")])
            continue
        grid(
            [
                (
                    key[len(name) :].strip("[]"),
                    _shown(value, state),
                    duration(value) if output.unit == "s" else "",
                )
                for key, value, state in _states(ds, name)
            ]
        )


def _shown(value: float, state: str) -> str:
    if state == "censored":
        return f"more than {number(value)}"
    return state or ("failed" if np.isnan(value) else number(value))


def _meaning(ds: xr.Dataset, status: Status) -> str:
    return str(ds["status"].attrs.get(f"example_{status.name.lower()}", status.meaning))


def _number(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name.strip(), read_number(value)
    except ValueError:
        raise InputError(f"--set {text}: write it as NAME=VALUE with a number") from None
    except OverflowError as error:
        raise InputError(f"--set {text}: {error}") from None


def literal(text: str) -> tuple[str, Any]:
    """Return name and value of a setting: a TOML literal, else a bare word."""
    name, equals, value = text.partition("=")
    if not equals:
        raise InputError(f"--setting {text}: write it as NAME=VALUE")
    try:
        parsed = read_toml(f"value = {value}")
    except ValueError:
        return name.strip(), value.strip()
    except OverflowError as error:
        raise InputError(f"--setting {text}: {error}") from None
    return name.strip(), parsed["value"] if len(parsed) == 1 else value.strip()
