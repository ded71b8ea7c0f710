"""How far the rows of a study lie beyond a threshold, asked in standard normal space."""

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import ndtr

from uq.contract import Status
from uq.errors import InputError, nearest
from uq.exploring.evaluator import Evaluator
from uq.inputs.values import unknown_name
from uq.rows.columns import censored_name
from uq.rows.evaluate import Chunk
from uq.rows.results import elements
from uq.rows.sampling import physical, row_seeds

if TYPE_CHECKING:
    from uq.contract import Output
    from uq.study.definition import Study

Floats = NDArray[np.float64]


class LimitState:
    """The margin of rows beyond a threshold.

    Parameters
    ----------
    study : Study
    name : str
        An output, or one element of an output that has dimensions.
    threshold : float
        In the output's unit.
    below : bool
        Whether the event is to lie below it.
    evaluator : Evaluator

    Attributes
    ----------
    output : Output
    failed : int
        Rows that failed, or were censored before the threshold, so far.
    undefined : int
        Rows whose output had no meaning.
    failures : dict of str to str
        Status label -> what happened to the first row with that status.
    """

    def __init__(
        self, study: "Study", name: str, threshold: float, below: bool, evaluator: Evaluator
    ) -> None:
        self.study, self.threshold, self.below = study, threshold, below
        self.output, self._place = find_element(study, name)
        self._column = name.partition("[")[0]
        self._evaluator = evaluator
        self.failed = self.undefined = 0
        self.failures: dict[str, str] = {}

    @property
    def dimension(self) -> int:
        """Of standard normal space."""
        return len(self.study.uncertain)

    def physical(self, u: Floats) -> Floats:
        """Map points of standard normal space, (n, dimension), to the model's parameters."""
        return physical(self.study, np.clip(ndtr(u), 2.0**-54, 1.0 - 2.0**-53))

    def uncertain(self, u: Floats) -> Floats:
        """Map points of standard normal space to the uncertain parameters alone."""
        names = self.study.model.parameter_names
        return self.physical(u)[:, [names.index(name) for name in self.study.uncertain]]

    def __call__(self, u: Floats) -> Floats:
        """Compute the rows of some points.

        Parameters
        ----------
        u : ndarray, shape (n, dimension)
            Standard normal.

        Returns
        -------
        ndarray, shape (n,)
            Distance beyond the threshold, positive within the event, -inf for a row that has no
            value: it counts as outside.
        """
        # Every row has random numbers of its own, as the rows of a study do.
        number = np.arange(len(u)) + self._evaluator.rows
        chunk = self._evaluator(self.physical(u), row_seeds(self.study.design.seed, number))
        for label, (row, text) in chunk.failures.items():
            self.failures.setdefault(label, f"row {row}: {text}")
        return self._margin(chunk)

    def _margin(self, chunk: Chunk) -> Floats:
        def column(name: str) -> NDArray[Any]:
            return chunk.columns[name].reshape(len(chunk.status), -1)[:, self._place]

        values = column(self._column)
        absent = self.output.is_absent(values)
        undefined = np.isnan(values) & (chunk.status == Status.OK)
        values = self.output.for_thresholds(values)
        margin = self.threshold - values if self.below else values - self.threshold
        if self.output.has_censored_flag:
            censored = column(censored_name(self._column)).astype(bool)
            absent |= censored & (values < self.threshold)
            if not self.below:
                margin[censored] = np.inf
        margin[absent] = -np.inf
        self.undefined += int(undefined.sum())
        self.failed += int((absent & ~undefined).sum())
        return margin


def find_element(study: "Study", name: str) -> tuple["Output", int]:
    """Return an output by its name, or by that of one of its elements, and the element's place.

    Raises
    ------
    InputError
        When there is no such output or element, or it is a category.
    """
    model, output = study.model, name.partition("[")[0]
    if output not in model.outputs:
        problem = unknown_name("output", output, model, tuple(model.outputs))
        raise InputError(f"'{output}': {problem}")
    declared = model.outputs[output]
    if declared.is_category:
        raise InputError(f"'{output}' is a category: it has shares, not thresholds")
    coordinates = model.coordinates(study.settings)
    axes = {dim: list(coordinates[dim]) for dim in declared.dims}
    shape = tuple(map(len, axes.values()))
    place = np.arange(np.prod(shape, dtype=int)).reshape(shape)
    numbered = xr.DataArray(place, axes, declared.dims, name=output)
    places = {label: int(number) for label, number in elements(numbered)}
    if name not in places:
        choice = f"; choose one, such as '{next(iter(places))}'" if name == output else ""
        raise InputError(f"'{name}': no such element{choice or nearest(name, places)}")
    return declared, places[name]
