"""The rows of a result as one flat table, for spreadsheets and other programs."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from uq.contract import Status, censored_name, entered_name, high_name
from uq.errors import InputError
from uq.files.whole_files import check_target, whole
from uq.result.elements import labels
from uq.result.result import Result
from uq.text.element_names import places

if TYPE_CHECKING:
    import pandas as pd

_OF_DESIGN = ("replicate", "group", "world", "unit", "repeat", "weight")


def row_table(result: Result) -> "pd.DataFrame":
    """Return the rows of a result, one in a line.

    Parameters
    ----------
    result : Result

    Returns
    -------
    pandas.DataFrame
        Indexed by ``row``: ``status`` in words, places in the design that vary, inputs and outputs.
        An output with dimensions has a column for each element, a category its labels, and a
        lifetime with censored rows a column ``..._censored``. Headings carry units in brackets.
    """
    import pandas as pd

    ds = result.dataset
    columns: dict[str, Any] = {
        "status": [Status(code).label for code in ds["status"].values.tolist()]
    }
    for name in _OF_DESIGN:
        if name in ds and np.ptp(ds[name].values):
            columns[name] = ds[name].values
    for variable in map(str, ds.data_vars):
        if ds[variable].attrs.get("role") == "input":
            columns[_heading(result, variable)] = ds[variable].values
    for name in result.output_names:
        columns |= dict(_columns(result, name))
    return pd.DataFrame(columns, index=pd.Index(ds["row"].values, name="row"))


def _columns(result: Result, output: str) -> Iterator[tuple[str, Any]]:
    """Yield the columns of an output: its values, and which of them are censored."""
    variable = result.dataset[output]
    values = labels(variable) if result.is_category(output) else variable
    flag = result.dataset.get(censored_name(output))
    coordinates = {str(dim): variable[dim].values for dim in variable.dims[1:]}
    for name, index, _ in places(output, coordinates):
        place: Any = (..., *index)
        yield _heading(result, output, name), values.values[place]
        if flag is not None and flag.values[place].any():
            yield f"{name}_censored", flag.values[place].astype(bool)
        for beside in (high_name(output), entered_name(output)):
            if beside in result.dataset:
                heading = _heading(result, output, name.replace(output, beside, 1))
                yield heading, result.dataset[beside].values[place]


def _heading(result: Result, name: str, element: str = "") -> str:
    unit = str(result.dataset[name].attrs.get("units", "1"))
    return (element or name) + ("" if unit == "1" else f" [{unit}]")


def write_rows(result: Result, csv: Path | None, parquet: Path | None) -> list[Path]:
    """Write the rows as CSV, as Parquet, or as both; return the files.

    Raises
    ------
    InputError
        When no file is given, Parquet is asked for without pyarrow, or a file cannot be written.
    RunError
        When a write fails.
    """
    files = [file for file in (csv, parquet) if file is not None]
    if not files:
        raise InputError("uq export: give --csv FILE or --parquet FILE")
    if parquet is not None and find_spec("pyarrow") is None:
        raise InputError("uq export: --parquet needs pyarrow: pip install pyarrow, or use --csv")
    size = result.dataset.nbytes
    for option, file in (("--csv", csv), ("--parquet", parquet)):
        if file is not None:
            check_target(file, size, option)
    table = row_table(result)
    if csv is not None:
        with whole(csv) as path:
            table.to_csv(path, lineterminator="\n", encoding="utf-8")
    if parquet is not None:
        with whole(parquet) as path:
            table.to_parquet(path)
    return files
