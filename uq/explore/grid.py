"""Grids: a model on evenly spaced values of some of its parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from operator import index
from typing import Any

import numpy as np

from uq.contract import Floats, Model
from uq.errors import InputError
from uq.sampling.named_values import fault_lines, parameter_problem, read_settings
from uq.study.installed_models import find_model, model_at, model_names
from uq.study.row_sampling import Rows, row_seeds

Axis = tuple[float, float, int]
"""First value, last value, number of values."""


@dataclass(frozen=True)
class ParameterGrid:
    """Rows of a model on the points of a grid, the last axis running fastest.

    Attributes
    ----------
    model : Model
    reference : str
        By which another process finds the model; empty if it cannot.
    axes : dict of str to Axis
        Of the parameters that vary.
    constants : dict of str to float
        All other parameters.
    settings : object
        An instance of ``model.settings``.
    """

    model: Model
    reference: str
    axes: Mapping[str, Axis]
    constants: dict[str, float]
    settings: Any

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values on each axis."""
        return tuple(count for _, _, count in self.axes.values())

    @property
    def rows(self) -> int:
        """Number of points."""
        return prod(self.shape)

    def values(self, name: str) -> Floats:
        """Return the values along an axis."""
        return np.linspace(*self.axes[name])

    def block(self, start: int, stop: int) -> Rows:
        """Return the rows start..stop, as in `uq.study.row_sampling.row_block`."""
        number = np.arange(start, stop)
        places = dict(zip(self.axes, np.unravel_index(number, self.shape), strict=True))
        x = np.empty((len(number), len(self.model.parameter_names)))
        for i, name in enumerate(self.model.parameter_names):
            x[:, i] = self.values(name)[places[name]] if name in places else self.constants[name]
        return Rows.without_design(x, row_seeds(0, number))


def grid_of(
    model: str | Model,
    axes: Mapping[str, Axis],
    fixed: Mapping[str, float],
    settings: Mapping[str, Any],
) -> ParameterGrid:
    """Check and build a grid.

    Parameters
    ----------
    model : str or Model
    axes : dict of str to Axis
    fixed : dict of str to float
        Other parameters with values that are not nominal.
    settings : dict
        Numerical settings by name.

    Returns
    -------
    ParameterGrid

    Raises
    ------
    InputError
        Everything that is wrong, one line each.
    """
    if isinstance(model, str):
        resolved, reference = model_at(model), model
    else:
        installed = model.name in model_names() and find_model(model.name) is model
        resolved, reference = model, model.name if installed else ""
    for argument, given in (("axes", axes), ("fixed", fixed), ("settings", settings)):
        if not isinstance(given, Mapping):
            raise InputError(f"{argument} must be a dictionary with names as keys: {given!r}")
    faults = [] if axes else ["axes: nothing varies; give at least one parameter its values"]
    wrong_axes = {name: _axis_problem(resolved, name, axis) for name, axis in axes.items()}
    twice = dict.fromkeys(axes, "is among the axes too; keep one of the two")
    wrong_fixed = {
        name: twice.get(name) or parameter_problem(resolved, name, value)
        for name, value in fixed.items()
    }
    frozen, wrong = read_settings(resolved, settings)
    faults += fault_lines("axes: ", axes, wrong_axes) + fault_lines("fixed: ", fixed, wrong_fixed)
    if faults := faults + fault_lines("settings: ", settings, wrong):
        raise InputError(*faults)
    return ParameterGrid(
        resolved.given(frozen),
        reference,
        {name: (float(a), float(b), index(n)) for name, (a, b, n) in axes.items()},
        {
            name: float(x)
            for name, x in (resolved.nominal | dict(fixed)).items()
            if name not in axes
        },
        frozen,
    )


def _axis_problem(model: Model, name: str, axis: Any) -> str | None:
    try:
        first, last, count = axis
        enough = index(count) >= 2
    except (TypeError, ValueError):
        return "must be (first value, last value, number of values)"
    problem = parameter_problem(model, name, first) or parameter_problem(model, name, last)
    ascends = enough and not problem and first < last < np.inf
    return problem if ascends or problem else "must ascend, two finite values at least"
