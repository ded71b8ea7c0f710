"""The input that only scales lives and is integrated on a grid, not drawn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from uq.assess.row_inputs import Inputs, inputs_of
from uq.assess.scaling import scalers
from uq.contract import Floats, Output
from uq.learning.dependent_outputs import dependent_outputs
from uq.learning.observables import Observable
from uq.result.result import Result
from uq.sampling.levels import OWN, SHARED
from uq.sampling.truncation import ppf_within


@dataclass(frozen=True)
class IntegratedScale:
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


def scale_of(
    rows: Result, observables: Sequence[Observable]
) -> tuple[IntegratedScale | None, tuple[str, ...]]:
    """Return the input to integrate, and sentences on those that do too much to be integrated.

    A shared one first, of these the one that scatters lives most. One that scales all lives and
    depths that were inspected, and that no other output depends on: that would keep the values
    computed with the input as drawn.
    """
    inputs, levels = inputs_of(rows), rows.levels
    exponents = {
        observable.name: free_scales(inputs, observable.declared)
        for observable in observables
        if observable.declared.is_lifetime or observable.depths is not None
    }
    common = set.intersection(*map(set, exponents.values())) if exponents else set()
    candidates = [name for name in inputs.laws if name in common and levels[name] in (SHARED, OWN)]
    others = {name: list(dependent_outputs(rows, name)) for name in candidates}
    why = [
        f"{name} is not integrated: {' and '.join(outputs)}"
        f" {'depends' if len(outputs) == 1 else 'depend'} on it otherwise."
        for name, outputs in others.items()
        if outputs
    ]
    free = [name for name in candidates if not others[name]]
    if not free:
        return None, tuple(why)
    first = next(iter(exponents.values()))

    def spread(name: str) -> float:
        return float(abs(first[name]) * np.log(inputs.values[name]).std())

    best = max(free, key=lambda name: (levels[name] == SHARED, spread(name)))
    best_exponents = {name: by_input[best] for name, by_input in exponents.items()}
    scale = IntegratedScale(best, levels[best], best_exponents, inputs.values[best], inputs)
    return scale, tuple(why)


def shared_inputs(rows: Result, scale: IntegratedScale | None) -> list[str]:
    """Return the inputs that units share, without the integrated one and those equal to it."""
    shared = [name for name, level in rows.levels.items() if level == SHARED]
    if scale is None or scale.is_own:
        return shared
    tied = {a for a, b in scale.inputs.tied.items() if b == scale.name}
    return [name for name in shared if name not in {scale.name, *tied}]


def free_scales(inputs: Inputs, output: Output) -> dict[str, float]:
    """Return the exponent of each input that only scales lives and is independent of all others."""
    return {
        name: exponent
        for name, exponent in scalers(inputs, output).items()
        if inputs.laws[name].times is None and name not in inputs.correlated
    }
