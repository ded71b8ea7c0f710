"""The command ``uq simulate``."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uq.cli.printing import duration, grid, heading, number, print_json
from uq.cli.progress import say_compiling, say_plain
from uq.contract import Model, Status
from uq.errors import InputError
from uq.execution.loading import load_model, run_alone
from uq.files.whole_files import file_behind
from uq.machines.compilation import compilation
from uq.machines.row_by_row import undeclared_lives
from uq.result.one_row import Row
from uq.text.literals import read_number, read_toml
from uq.text.numbers import in_brackets
from uq.text.quantities import read_quantity, read_threshold
from uq.text.units import readable, typical, unit_of

if TYPE_CHECKING:
    import xarray as xr


def simulate(
    reference: str,
    parameters: Sequence[str],
    settings: Sequence[str],
    json: bool,
    output: Path | None,
    plot: Path | None,
) -> int:
    """Run a model once and show the result; return the exit code."""
    given = dict(_number(text, reference) for text in parameters)
    chosen = dict(literal(text) for text in settings)
    if output or plot:
        check_files(load_model(reference), output, plot)
    with compilation(say_compiling):
        row = run_alone(reference, given, chosen, compiling=say_compiling)
        if output or plot:
            _keep(row, output, plot)
    say_plain(*undeclared_lives(row.model))
    print_json(as_json(row)) if json else _show(row)
    return 1 if row.failed else 0


def check_files(model: Model, output: Path | None, plot: Path | None) -> None:
    """Refuse files that cannot be written, or that the model has nothing for."""
    from uq.explore.single_rows import holds_trajectory
    from uq.files.whole_files import check_target

    for path, option in ((output, "-o"), (plot, "--plot")):
        if path is not None:
            check_target(path, 0, option)
    if output and output.exists() and not holds_trajectory(output):
        raise InputError(
            f"{output}: exists and is not a trajectory of 'uq simulate'; choose another name"
        )
    if model.simulate is None:
        given = " and ".join(["-o"] * bool(output) + ["--plot"] * bool(plot))
        raise InputError(f"model '{model.name}' gives no trajectory; leave out {given}")


def _keep(row: Row, output: Path | None, plot: Path | None) -> None:
    """Write the row with its time history, draw the history, or both."""
    from uq.explore.single_rows import dataset
    from uq.files.whole_files import write

    ds = dataset(row)
    if output:
        write(ds, output)
    if plot:
        draw(ds, plot)


def draw(ds: "xr.Dataset", plot: Path) -> None:
    """Draw the time history of a Dataset into a file.

    Parameters
    ----------
    ds : xarray.Dataset
        As from `uq.simulate`.
    plot : Path
    """
    from uq.plots import motion
    from uq.render.figures.figure import DOTS_PER_INCH, replaced

    try:
        file_behind(plot).parent.mkdir(parents=True, exist_ok=True)
        with replaced(plot) as part:
            motion(ds).savefig(part, dpi=DOTS_PER_INCH)
    except (OSError, ValueError) as error:  # ValueError: a format matplotlib does not know
        raise InputError(f"{plot}: {getattr(error, 'strerror', None) or error}") from None


def as_json(row: Row) -> dict[str, Any]:
    """Return one row as the JSON of ``uq simulate``.

    Parameters
    ----------
    row : Row

    Returns
    -------
    dict
        ``never``, ``censored`` and ``undefined`` name the outputs that are so.
    """
    status, meaning = row.ending
    names: dict[str, list[str]] = {"never": [], "censored": [], "undefined": []}
    for name in row.model.outputs:
        for element, _, state in _states(row, name):
            if state:
                names[state].append(element)
    return {
        "model": row.model.name,
        "inputs": row.values,
        "outputs": {
            name: _plain(row.model, name, row.columns[name][0]) for name in row.model.outputs
        },
        "status": {"code": status.label, "meaning": meaning},
        **names,
    }


def _plain(model: Model, name: str, values: Any) -> Any:
    if not model.outputs[name].is_category:
        return values.astype(float).tolist()
    if np.ndim(values):
        return [_plain(model, name, value) for value in values]
    return model.outputs[name].categories[int(values)] if values >= 0 else None


def _states(row: Row, name: str) -> Iterator[tuple[str, float, str]]:
    """Yield name, value and never, censored, undefined or "" of each element of an output."""
    if row.model.outputs[name].is_category:
        return
    for element in row.elements(name):
        states = ("censored", "never", "undefined")
        state = next((state for state in states if getattr(element, state)[0]), "")
        yield element.name, float(element.values[0]), state


def _show(row: Row) -> None:
    status, meaning = row.ending
    heading(f"{row.model.name}: {status.label}", "" if status is Status.OK else meaning)
    show_outputs(row)


def show_outputs(row: Row) -> None:
    """Print every output of a row, with its unit and meaning; of a failed row what it has."""
    for name, output in row.model.outputs.items():
        states = list(_states(row, name))
        category = _plain(row.model, name, row.columns[name][0]) if output.is_category else None
        is_empty = not np.any(category) and all(
            np.isnan(value) and not state for _, value, state in states
        )
        if not output.shown or (row.failed and is_empty):
            continue
        if output.is_category:
            heading(f"\n{name}", readable(output.meaning))
            names = np.ravel(np.array(category, object))
            grid([("", ", ".join(name or "none" for name in names))])
            continue
        unit = unit_of(output.unit, typical(value for _, value, _ in states))
        heading(f"\n{name}{in_brackets(unit)}", readable(output.meaning))
        grid(
            [
                (
                    key[len(name) :].removeprefix("[").removesuffix("]"),
                    _shown(value, state, unit.size),
                    f"{number(value)} s" if output.unit == "s" and duration(value) else "",
                )
                for key, value, state in states
            ]
        )


def _shown(value: float, state: str, per: float) -> str:
    if state == "censored":
        return f"more than {number(value / per)}"
    return state or ("invalid" if np.isnan(value) else number(value / per))


def _number(text: str, reference: str) -> tuple[str, float]:
    """Return name and value of a parameter; the value may have a unit."""
    name, _, value = (part.strip() for part in text.partition("="))
    try:
        return name, read_number(value)
    except ValueError:
        pass
    except OverflowError as error:
        raise InputError(f"--set {text}: {error}") from None
    model, quantity = load_model(reference), value.strip("\"'")
    try:
        read_quantity(quantity)
    except ValueError:
        problem = "write it as NAME=VALUE with a number, or a number and its unit"
        raise InputError(f"--set {text}: {problem}") from None
    units = model.parameter(name).unit if name in model.parameter_names else "1"
    return name, read_threshold(f"--set {name} =", quantity, name, units)


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
