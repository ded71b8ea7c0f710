"""Epistemic band of the probability of an end: its posterior range over what units share."""

import numpy as np

from uq.assess.scaling import inputs_of
from uq.contract import Floats
from uq.learning.integrated_input import free_scales
from uq.learning.posterior_inputs import quantiles
from uq.result.elements import Element
from uq.result.result import Result
from uq.result.weights import INTEGRATED, WEIGHT, WORLDS
from uq.sampling.levels import SHARED

ENDS = (0.025, 0.975)


def over_shared(result: Result, element: Element, seen: float, time: float) -> dict[float, float]:
    """Return the 95 % range of P(T < time) given T > `seen`, of a unit never inspected.

    Parameters
    ----------
    result : Result
        A result of `uq.update`.
    element : Element
        A life of its rows.
    seen, time : float
        In the unit of the life.

    Returns
    -------
    dict of float to float
        Probability -> quantile over what units share. Empty unless that is one integrated input
        that scales this life, and no row is censored too early: only then does each of its values
        give the probability without the noise of a few units.
    """
    name = result.dataset.attrs[INTEGRATED]
    if not name or result.dataset.attrs[WORLDS] > 1 or result.levels[name] != SHARED:
        return {}
    exponent = free_scales(inputs_of(result), element.declared).get(name)
    if exponent is None:
        return {}
    shared, weights = result.dataset[name].values, result.dataset[WEIGHT].values
    longer = shared**exponent
    latest = time * longer / longer.min()
    if (element.censored & (element.values < latest)).any():
        return {}
    present = element.present
    lives = element.values[present] / longer[present]  # with a shared input of 1
    before, by = (_below(lives, weights[present], at / longer) for at in (seen, time))
    with np.errstate(divide="ignore", invalid="ignore"):
        ended = (by - before) / (1 - before)
    runs = before < 1
    return quantiles(ended[runs], weights[runs] * (1 - before[runs]), ENDS)


def _below(values: Floats, weights: Floats, at: Floats) -> Floats:
    """Return the share of weighted values below others."""
    order = np.argsort(values)
    share = np.append(0.0, np.cumsum(weights[order]) / weights.sum())
    return np.asarray(share[np.searchsorted(values[order], at, side="left")])
