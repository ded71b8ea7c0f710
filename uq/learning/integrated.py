"""The input that only scales lives and is integrated on a grid, not drawn."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Output
from uq.designs.levels import OWN, SHARED
from uq.inputs.conditioning import ppf_within
from uq.learning.dependent_outputs import dependent_outputs
from uq.learning.looks import Look
from uq.population.row_inputs import Inputs, inputs_of
from uq.population.scaling import scalers
from uq.rows.nesting import levels_of


@dataclass(frozen=True)
class Scale:
    """An input that only scales lives, and is integrated on a grid.

    Attributes
    ----------
    name : str
    level : str
    exponents : dict of str to float
        What was inspected -> its exponent.
    drawn : ndarray, shape (n,)
        The values of the rows.
    inputs : Inputs
    """

    name: str
    level: str
    exponents: Mapping[str, float]
    drawn: Floats
    inputs: Inputs

    @property
    def is_own(self) -> bool:
        """Whether each unit has its own."""
        return self.level == OWN

    def quantiles(self, probability: Floats) -> Floats:
        """Return quantiles of its prior."""
        return ppf_within(self.inputs.laws[self.name], probability, self.inputs.bounds[self.name])

    def longer(self, look: Look, rows: NDArray[np.intp], values: Floats) -> Floats:
        """Return by which factor lives of some rows are longer with other values, shape (m, g).

        These are the same in all rows, shape (g,), or differ, shape (m, g).
        """
        if look.name not in self.exponents:
            return np.ones((len(rows), values.shape[-1]))
        return np.asarray((values / self.drawn[rows, None]) ** self.exponents[look.name])


def scale_of(rows: xr.Dataset, looks: Sequence[Look]) -> Scale | None:
    """Return the input to integrate: a shared one first, of these the one that scatters lives most.

    One that scales all lives and depths that were inspected, and that no other output depends on:
    that would keep the values computed with the input as drawn.
    """
    inputs, levels = inputs_of(rows), levels_of(rows)
    scaled, common = _scaled(inputs, looks)
    names = [name for name in _candidates(rows, inputs, looks) if not _otherwise(rows, name)]
    if not names:
        return None

    def spread(name: str) -> float:
        return float(abs(common[0][name]) * np.log(inputs.values[name]).std())

    best = max(names, key=lambda name: (levels[name] == SHARED, spread(name)))
    exponents = {look.name: one[best] for look, one in zip(scaled, common, strict=True)}
    return Scale(best, levels[best], exponents, inputs.values[best], inputs)


def not_integrated(rows: xr.Dataset, looks: Sequence[Look]) -> Iterator[str]:
    """Yield which inputs scale what was inspected, but are not integrated since they do more."""
    for name in _candidates(rows, inputs_of(rows), looks):
        if others := _otherwise(rows, name):
            verb = "depends" if len(others) == 1 else "depend"
            yield f"{name} is not integrated: {' and '.join(others)} {verb} on it otherwise."


def _otherwise(rows: xr.Dataset, name: str) -> list[str]:
    return list(dependent_outputs(rows, name))


def _scaled(inputs: Inputs, looks: Sequence[Look]) -> tuple[list[Look], list[dict[str, float]]]:
    """Return the lives and depths that were inspected, and what scales each."""
    scaled = [look for look in looks if look.declared.is_lifetime or look.depths is not None]
    return scaled, [free_scales(inputs, look.declared) for look in scaled]


def _candidates(rows: xr.Dataset, inputs: Inputs, looks: Sequence[Look]) -> list[str]:
    """Return the inputs that scale all lives and depths that were inspected."""
    common, levels = _scaled(inputs, looks)[1], levels_of(rows)
    names = [name for name in (common[0] if common else ()) if all(name in one for one in common)]
    return [name for name in names if levels[name] in (SHARED, OWN)]


def free_scales(inputs: Inputs, output: Output) -> dict[str, float]:
    """Return the exponent of each input that only scales lives and is independent of all others."""
    return {
        name: exponent
        for name, exponent in scalers(inputs, output).items()
        if inputs.laws[name].times is None and name not in inputs.correlated
    }
