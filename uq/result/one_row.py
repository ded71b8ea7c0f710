"""One row of a model as plain numbers, without a Dataset."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Model, Status, censored_name
from uq.errors import InputError
from uq.files.interrupts import in_background
from uq.result.element import Element, elements_in
from uq.sampling.named_values import fault_lines, parameter_problem, read_settings
from uq.study.evaluate import Chunk, evaluate, failed_rows

Evaluate = Callable[[Floats, NDArray[np.uint64]], Chunk]


class Row(NamedTuple):
    """A row and its outcome.

    Attributes
    ----------
    model : Model
    settings : object
    values : dict of str to float
        Every parameter.
    seed : int
    columns : dict of str to ndarray, shape (1, *dims)
    status : ndarray of int8, shape (1,)
    failures : dict of str to str
        Status label -> failure message.
    """

    model: Model
    settings: Any
    values: dict[str, float]
    seed: int
    columns: dict[str, NDArray[Any]]
    status: NDArray[np.int8]
    failures: dict[str, str]

    @property
    def failed(self) -> bool:
        """Whether an output that must have a value has none."""
        required = (
            (output, self.columns[name])
            for name, output in self.model.outputs.items()
            if not output.may_be_undefined
        )
        return bool(failed_rows(self.status, required)[0])

    @property
    def ending(self) -> tuple[Status, str]:
        """The status of the row and its explanation."""
        status = Status(self.status.item())
        return status, self.failures.get(status.label, status.meaning)

    def elements(self, output: str) -> Iterator[Element]:
        """Yield the elements of an output that is not a category."""
        return elements_in(
            output,
            self.model.outputs[output],
            self.columns[output],
            self.columns.get(censored_name(output)),
            self.model.coordinates(self.settings),
            np.array([self.failed]),
        )


def run_row(
    model: Model,
    parameters: Mapping[str, float],
    settings: Mapping[str, Any],
    seed: int = 0,
    batch: Evaluate | None = None,
) -> Row:
    """Run a model once; see `uq.simulate`, and `computed` for `batch`."""
    problems = {name: parameter_problem(model, name, value) for name, value in parameters.items()}
    frozen, wrong = read_settings(model, settings)
    if faults := fault_lines("", parameters, problems) + fault_lines("setting ", settings, wrong):
        raise InputError(*faults)

    values = model.nominal | {name: float(value) for name, value in parameters.items()}
    return computed(model.given(frozen), frozen, values, seed, batch)


def computed(
    model: Model, settings: Any, values: dict[str, float], seed: int, batch: Evaluate | None = None
) -> Row:
    """Compute a row.

    Parameters
    ----------
    model : Model
    settings : object
        An instance of the model's settings.
    values : dict of str to float
        Every parameter, in declared order.
    seed : int
    batch : callable, optional
        ``batch(x, seed)`` -> chunk; by default the model is called in this process.

    Returns
    -------
    Row
    """
    x, seeds = np.array([list(values.values())]), np.array([seed], dtype=np.uint64)
    batch = batch or partial(evaluate, model, settings)
    chunk = in_background(lambda: batch(x, seeds))
    failures = {label: text for label, (_, text) in chunk.failures.items()}
    return Row(model, settings, values, seed, chunk.columns, chunk.status, failures)
