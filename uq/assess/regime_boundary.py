"""The boundary between the regimes of a result: how intermingled they are."""

import numpy as np

from uq.assess.fact import Fact
from uq.assess.independent_inputs import independent_inputs
from uq.assess.row_inputs import EVERYWHERE
from uq.assess.statistic import Statistic
from uq.assess.summary import REGIME
from uq.assess.summary_json import estimate_fact
from uq.result.result import Result
from uq.sampling.truncation import cdf_within
from uq.stats.estimate import Estimate
from uq.stats.uncertainty_exponent import uncertainty_exponent
from uq.study.input_checks import laws_of
from uq.text.numbers import percent, percent_interval

MOST_ROWS = 50_000
"""Of more rows the first ones are compared: all would take too long."""

BOUNDARY = "boundary"
"""Its part of the JSON of a summary."""

EXPONENT = "uncertainty_exponent"

DEPENDENT = "the rows of a '{design}' design are not independent; use design 'monte-carlo'"


def boundary(result: Result) -> Statistic | None:
    """Estimate how intermingled the regimes are over the inputs.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    Statistic or None
        The uncertainty exponent of the boundary between the regimes, or the reason why there is
        none; of one row of each sample. None where the rows do not end in several regimes, or have
        weights.
    """
    if REGIME not in result.dataset or result.has_weights:
        return None
    rows = compared_rows(result)
    if len(np.unique(rows.dataset[REGIME])) < 2:
        return None
    if result.has_independent_samples:
        exponent = _exponent(rows)
    else:
        exponent = Estimate(reason=DEPENDENT.format(design=result.design_name))
    label = EXPONENT.replace("_", " ")
    return Statistic((BOUNDARY, EXPONENT), label, exponent, by=(uncertainty_exponent,))


def compared_rows(result: Result) -> Result:
    """Return the first `MOST_ROWS` of the independent rows, one of each sample, with a regime."""
    rows = result.independent.first_rows.take(slice(MOST_ROWS))
    return rows.take((rows.dataset[REGIME].values >= 0) & ~rows.failed)


def _exponent(rows: Result) -> Estimate:
    laws, values = laws_of(rows.dataset.attrs["study"]), independent_inputs(rows)
    shares = [cdf_within(law, values[name], EVERYWHERE) for name, law in laws.items()]
    listed = [law.discrete for law in laws.values()]
    if all(listed):
        return Estimate(reason="no input varies continuously")
    table = np.column_stack(shares)
    kinds = np.unique(table[:, listed], axis=0, return_inverse=True)[1] if any(listed) else None
    return uncertainty_exponent(table[:, ~np.array(listed)], rows.dataset[REGIME].values, kinds)


def boundary_facts(result: Result, statistic: Statistic | None) -> Fact:
    """Return the boundary of a result; empty without several regimes."""
    if statistic is None:
        return Fact({})
    exponent = Fact({EXPONENT: estimate_fact(statistic)}, rows=compared_rows(result))
    return Fact({BOUNDARY: exponent})


def still_uncertain(exponent: Estimate) -> Estimate:
    """Return the share of uncertain outcomes that stay so if all inputs are known twice as well."""
    value, high, low = (2.0 ** -np.clip(exponent.numbers, 0.0, 1.0)).tolist()
    return Estimate(value, low, high)


def in_words(statistic: Statistic) -> str:
    """Return the meaning of an uncertainty exponent, in a clause."""
    value, high, low = (1 - end for end in still_uncertain(statistic.estimate).numbers)
    return (
        f"if all inputs are known twice as well, {percent(value)} ({percent_interval(low, high)})"
        " fewer outcomes are uncertain (50 % where the boundary between regimes is smooth, 0 %"
        " where they are intermingled everywhere)"
    )
