"""Selection of a row of a result, and its values as plain numbers."""

from collections import namedtuple
from collections.abc import Iterator
from typing import Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from uq.contract import Model, censored_name
from uq.errors import InputError
from uq.machines.row_by_row import NoSettings
from uq.result.element import Element
from uq.result.one_row import Row
from uq.result.result import Result
from uq.stats.order_statistics import quantile, rows_to_reach
from uq.text.numbers import counted

_MANY = 10**9


class Choice(NamedTuple):
    """A chosen row.

    Attributes
    ----------
    number : int
    words : str
        Reason for the selection.
    """

    number: int
    words: str


def lowest_row(result: Result, name: str) -> Choice:
    """Return the row in which an output, or one element of it, is lowest.

    Parameters
    ----------
    result : Result
        A result.
    name : str
        As `uq.result.elements.named_elements` takes it.

    Returns
    -------
    Choice
        The first such row; never one that failed or is undefined.

    Raises
    ------
    InputError
        When there is no such output, or no row has a value.
    """
    candidates = list(_ordered(result, name))
    # Of several elements the lowest value; which of two equal ones does not matter.
    element, order = min(candidates, key=lambda pair: _rank(pair[0], pair[1][0]))
    place = order[0]
    earlier = int((element.censored & (element.values < element.values[place])).sum())
    words = f"the lowest {element.name}"
    if earlier:
        words += f"; {counted(earlier, 'row was', 'rows were')} censored earlier"
    return Choice(int(result.dataset["row"].values[place]), words)


def highest_row(result: Result, name: str) -> Choice:
    """Return the row in which an output, or one element of it, is highest.

    Parameters
    ----------
    result : Result
        A result.
    name : str
        As `uq.result.elements.named_elements` takes it.

    Returns
    -------
    Choice
        A row that never ends, if there is one, else one that was censored; never one that failed
        or is undefined.

    Raises
    ------
    InputError
        When there is no such output, or no row has a value.
    """
    element, order = max(_ordered(result, name), key=lambda pair: _rank(pair[0], pair[1][-1]))
    return Choice(int(result.dataset["row"].values[order[-1]]), f"the highest {element.name}")


def lowest_rows(result: Result, name: str, most: int) -> list[tuple[int, float]]:
    """Return the rows in which one element is lowest, each with its value; only rows that ended.

    Parameters
    ----------
    result : Result
        A result.
    name : str
        Of an element.
    most : int

    Raises
    ------
    InputError
        When there is no such element, or no row has a value.
    """
    element, order = next(_ordered(result, name))
    ended = [i for i in order[:most] if not (element.censored[i] or element.never[i])]
    return [(int(result.dataset["row"].values[i]), float(element.values[i])) for i in ended]


def near_quantile_row(result: Result, probability: float, name: str) -> Choice:
    """Return the row that is closest to a quantile of an output or of one element.

    Parameters
    ----------
    result : Result
        A result.
    probability : float
    name : str
        Of an output without dimensions, or of an element.

    Returns
    -------
    Choice
        One of the rows that determine the quantile in a summary.

    Raises
    ------
    InputError
        When there is no such output or quantile.
    """
    if not 0 < probability < 1:
        raise InputError(
            f"--near-quantile {probability:g}: must be between 0 and 1; write 0.05 for 5 %"
        )
    result.refuse_if_weighted("--near-quantile")
    if why := result.why_no_statistics:
        raise InputError(
            f"no quantiles: the rows of a '{result.design_name}' design {why}; choose a row by its"
            " number or with --lowest"
        )
    rows = result.independent
    (element, order), *others = _ordered(rows, name)
    if others:
        names = ", ".join(
            f"'{candidate.name}'" for candidate in (element, *(other for other, _ in others))
        )
        raise InputError(f"'{name}' has several elements; choose one of {names}")
    first, last = (quantile(values, probability) for values in (element.at_least, element.at_most))
    if np.isnan(first):
        needed = rows_to_reach(probability)
        least = needed if needed < _MANY else f"more than {_MANY:g}"
        raise InputError(f"{name}: a {100 * probability:g} % quantile needs {least} rows")
    ended = order[~element.censored[order] & np.isfinite(element.values[order])]
    if len(ended) and np.isfinite(first) and first == last:
        place = ended[np.abs(element.values[ended] - first).argmin()]
    else:  # it depends on censored rows, or is never
        place = order[min(max(round(probability * len(order)), len(ended)), len(order) - 1)]
    words = f"closest to the {100 * probability:g} % quantile of {element.name}"
    return Choice(int(rows.dataset["row"].values[place]), words)


def _ordered(result: Result, name: str) -> Iterator[tuple[Element, NDArray[np.intp]]]:
    """Yield elements with ascending row positions: ended lives, then censored, then infinite."""
    unsound = result.failed
    has_values = False
    for element in result.named_elements(name):
        places = np.flatnonzero(element.present & ~unsound)
        if len(places):
            has_values = True
            state = element.censored + 2 * element.never
            yield element, places[np.lexsort((element.values[places], state[places]))]
    if not has_values:
        raise InputError(f"no row has a value of '{name}'")


def _rank(element: Element, place: int) -> tuple[bool, bool, float]:
    return bool(element.never[place]), bool(element.censored[place]), float(element.values[place])


def place_of(result: Result, number: int) -> int:
    """Return the position in a result of the row with the given number.

    Raises
    ------
    InputError
        When there is no such row.
    """
    result.refuse_empty()
    numbers = result.dataset["row"].values
    places = (numbers == number).nonzero()[0]
    if not len(places):
        raise InputError(f"no such row: {number} (allowed: {numbers.min()} to {numbers.max()})")
    return int(places[0])


def stored_row(result: Result, place: int) -> Row:
    """Return a row of a result.

    Parameters
    ----------
    result : Result
    place : int
        As from `place_of`.

    Returns
    -------
    Row
        Its model has the declarations of the result and cannot compute; its seed is 0.
    """
    stored = result.take([place])
    row, attrs = stored.dataset.load(), stored.dataset.attrs
    outputs = stored.outputs
    columns = {name: row[name].values for name in outputs}
    flags = [flag for name in outputs if (flag := censored_name(name)) in row]
    columns |= {flag: row[flag].values.astype(bool) for flag in flags}
    values = {
        str(name): float(variable.values.reshape(-1)[0])
        for name, variable in row.data_vars.items()
        if variable.attrs.get("role") in ("input", "fixed")
    }
    axes = {dim: row[dim].values.tolist() for output in outputs.values() for dim in output.dims}
    model = Model(
        name=str(attrs["model"]),
        title=str(attrs["title"]),
        version=str(attrs["model_version"]),
        parameters=namedtuple("Parameters", values),
        settings=NoSettings,
        outputs=outputs,
        batch=_refused,
        coordinates=lambda settings: axes,
    )
    return Row(model, NoSettings(), values, 0, columns, row["status"].values, {})


def _refused(*arguments: Any) -> NoReturn:
    """Replace the batch function: rows of a result are only shown, never computed."""
    raise NotImplementedError("this model only describes a result")
