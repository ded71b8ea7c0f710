"""Outputs that depend on an input otherwise than by scaling with it, as the rows show."""

from collections.abc import Iterator

import numpy as np

from uq.assess.row_inputs import inputs_of
from uq.assess.scaling import scalers
from uq.learning.importance import own_rows
from uq.result.result import Result
from uq.result.variables import error_name

_CHANCE = 1e-6
_FEWEST = 20


def dependent_outputs(rows: Result, name: str) -> Iterator[str]:
    """Yield the outputs that depend on an input but do not scale with it.

    Parameters
    ----------
    rows : Result
        Before the inspections.
    name : str
        An input.

    Yields
    ------
    str
        Those with an element whose ranks, of the means of samples if units share the input, follow
        those of the input more closely than one in a million that do not.
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
