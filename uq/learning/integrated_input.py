"""Integrated input: it only scales lives and is integrated by quadrature, not sampled."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from uq.assess.integrated_inputs import scalers
from uq.assess.row_inputs import Inputs, inputs_of
from uq.contract import Floats, Output
from uq.learning.importance import own_rows
from uq.learning.observables import Observable
from uq.result.result import Result
from uq.result.variables import error_name
from uq.sampling.levels import OWN, SHARED
from uq.sampling.truncation import ppf_within

_CHANCE = 1e-6
_FEWEST = 20


def dependent_outputs(rows: Result, name: str) -> Iterator[str]:
    """Yield the outputs that depend on an input but do not scale with it.

    Parameters
    ----------
    rows : Result
        Rows before the update.
    name : str
        An input.

    Yields
    ------
    str
        Outputs with an element whose rank correlation with the input is significant at one in a
        million (sample means are ranked if units share the input).
    """
    from scipy import stats

    rows = own_rows(rows)
    inputs, place = inputs_of(rows), rows.nesting
    shared = len(np.unique(inputs.values[name])) <= place.samples < len(place.sample)
    outputs = rows.outputs
    scaled = {output for output, declared in outputs.items() if name in scalers(inputs, declared)}
    scaled |= {error_name(output) for output in scaled}
    for output, declared in outputs.items():
        if declared.is_category or output in scaled:
            continue
        for element in rows.elements([output]):
            input_values = inputs.values[name]
            values = np.where(element.censored, np.nan, element.values)
            if shared:
                input_values, values = place.means(input_values), place.means(values)
            finite = np.isfinite(input_values) & np.isfinite(values)
            if finite.sum() < _FEWEST or np.ptp(values[finite]) == 0:
                continue
            if stats.spearmanr(input_values[finite], values[finite]).pvalue < _CHANCE:
                yield output
                break


@dataclass(frozen=True)
class IntegratedScale:
    """An input that only scales lives and is integrated by quadrature.

    Attributes
    ----------
    name : str
    level : str
    exponents : dict of str to float
        Observable -> its scaling exponent.
    drawn : ndarray, shape (n,)
        The sampled values of the rows.
    inputs : Inputs
    """

    name: str
    level: str
    exponents: Mapping[str, float]
    drawn: Floats
    inputs: Inputs

    @property
    def is_own(self) -> bool:
        """Whether each unit has its own value."""
        return self.level == OWN

    def quantiles(self, probability: Floats) -> Floats:
        """Return quantiles of its prior."""
        return ppf_within(self.inputs.laws[self.name], probability, self.inputs.bounds[self.name])


def scale_of(
    rows: Result, observables: Sequence[Observable]
) -> tuple[IntegratedScale | None, tuple[str, ...]]:
    """Return the input to integrate, and sentences on scaling inputs that cannot be integrated.

    The input must scale all inspected lives and depths, and no other output may depend on it: such
    an output would keep the values computed with the sampled input. Shared inputs are preferred,
    then inputs that cause more scatter of the lives.
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
        return None, (*why, *_scaling_elsewhere(rows, inputs, exponents, common))
    first = next(iter(exponents.values()))

    def spread(name: str) -> float:
        return float(abs(first[name]) * np.log(inputs.values[name]).std())

    best = max(free, key=lambda name: (levels[name] == SHARED, spread(name)))
    best_exponents = {name: by_input[best] for name, by_input in exponents.items()}
    scale = IntegratedScale(best, levels[best], best_exponents, inputs.values[best], inputs)
    return scale, tuple(why)


def _scaling_elsewhere(
    rows: Result, inputs: Inputs, exponents: Mapping[str, Mapping[str, float]], common: set[str]
) -> Iterator[str]:
    """Yield sentences on inputs that scale other lives of the result, but not the inspected ones.

    A process with a clock of its own, such as creep, ends the scaling of the lives that it changes.
    """
    if not exponents or common:
        return
    scaling = {name for output in rows.outputs.values() for name in free_scales(inputs, output)}
    for name in inputs.laws:
        if name in scaling:
            yield (
                f"{name} is not integrated: under the processes of this study, the inspected lives"
                " do not only scale with it."
            )


def shared_inputs(rows: Result, scale: IntegratedScale | None) -> list[str]:
    """Return the shared inputs, except the integrated input and inputs equal to it."""
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
