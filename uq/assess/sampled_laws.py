"""Stated laws and rank correlations of the inputs compared with those of the rows."""

from typing import NamedTuple

import numpy as np
import scipy  # which imports scipy.stats when it is first used

from uq.assess.fact import Fact
from uq.assess.row_inputs import EVERYWHERE, independent_inputs
from uq.contract import Floats
from uq.result.result import Result
from uq.sampling.designs import DESIGNS
from uq.sampling.law import Law
from uq.sampling.truncation import cdf_within, factor_of, ppf_within
from uq.stats.estimate_json import number
from uq.study.definition import Study
from uq.study.input_checks import laws_of
from uq.study.row_sampling import row_block, rows

PROBABILITIES = (0.05, 0.5, 0.95)

MAX_ROWS = 100_000
"""Rows of a study that are drawn for comparison with its laws."""


class SampledInput(NamedTuple):
    """One input as stated and as the rows have it.

    Attributes
    ----------
    stated, sampled : ndarray, shape (3,)
        Quantiles of `PROBABILITIES`.
    distance : float
        Largest difference of the two cumulative distributions (Kolmogorov-Smirnov).
    """

    stated: Floats
    sampled: Floats
    distance: float


def sampled_inputs(study: Study) -> dict[str, SampledInput]:
    """Compare the laws of a study with its rows, the first 100,000 of them.

    Parameters
    ----------
    study : Study

    Returns
    -------
    dict of str to SampledInput
        Empty for designs whose rows do not follow the laws.
    """
    if not DESIGNS[study.design.method].follows_laws:
        return {}
    values = drawn_inputs(study)
    return {name: compare(law, values[name]) for name, law in study.uncertain.items()}


def drawn_inputs(study: Study) -> dict[str, Floats]:
    """Return the first rows of a study, one of each sample, each input as its own law gives it."""
    x = row_block(study, 0, min(rows(study), MAX_ROWS)).x[:: study.design.rows_of_a_sample]
    column = {name: x[:, i] for i, name in enumerate(study.model.parameter_names)}
    return {
        name: column[name] if law.times is None else factor_of(law, column[name], column[law.times])
        for name, law in study.uncertain.items()
    }


def sampled_ranks(study: Study) -> Floats:
    """Return the rank correlations that the rows of a study have, shape (k, k).

    Parameters
    ----------
    study : Study
        With dependence, whose matrix sets the order.
    """
    values = drawn_inputs(study)
    assert study.dependence is not None
    return np.corrcoef([scipy.stats.rankdata(values[name]) for name in study.dependence.parameters])


def compare(law: Law, values: Floats, weights: Floats | None = None) -> SampledInput:
    """Compare a law with values that should follow it: quantiles of both [1]_, their distance.

    Parameters
    ----------
    law : Law
    values : ndarray, shape (n,)
    weights : ndarray, shape (n,), optional

    Returns
    -------
    SampledInput

    References
    ----------
    .. [1] R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", The American
       Statistician 50 (1996) 361, definition 1.
    """
    probabilities = np.array(PROBABILITIES)
    worth = np.ones(len(values)) if weights is None else weights
    order = np.argsort(values, kind="stable")
    ascending, share = values[order], np.append(0.0, np.cumsum(worth[order]) / worth.sum())
    distinct = np.unique(ascending)
    stated = cdf_within(law, distinct, EVERYWHERE)
    up_to = share[np.searchsorted(ascending, distinct, side="right")]
    distance = np.abs(up_to - stated).max()
    if not law.discrete:  # just before each step of the rows
        before = share[np.searchsorted(ascending, distinct, side="left")]
        distance = max(distance, np.abs(before - stated).max())
    return SampledInput(
        ppf_within(law, probabilities, EVERYWHERE),
        np.quantile(values, probabilities, method="inverted_cdf", weights=weights),
        float(distance),
    )


def laws_and_values(result: Result) -> dict[str, tuple[Law, Floats]]:
    """Return the law of each input of a result and the values of its rows, where they follow it.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    dict of str to tuple of Law and ndarray
        For a parameter that is another times a factor, those of the factor.
    """
    plain = _first_rows(result)
    if len(plain) == 0:
        return {}
    values = independent_inputs(plain)
    return {
        name: (law, values[name]) for name, law in laws_of(result.dataset.attrs["study"]).items()
    }


def weights_of_samples(result: Result) -> Floats | None:
    """Return the weights of the rows of `laws_and_values`, None where they have none."""
    return _first_rows(result).row_weights


def _first_rows(result: Result) -> Result:
    return result.independent.first_rows


def inputs_facts(result: Result, only: str = "") -> Fact:
    """Return quantiles of the inputs: of their laws as ``stated``, and as ``sampled``.

    Of a single input if `only` names one.
    """
    given, weights = laws_and_values(result), weights_of_samples(result)
    facts = {}
    for name in [only] if only in given else given:
        comparison = compare(*given[name], weights)
        quantiles = {
            kind: dict(zip(map(repr, PROBABILITIES), map(number, values), strict=True))
            for kind, values in (("stated", comparison.stated), ("sampled", comparison.sampled))
        }
        facts[name] = quantiles | {"distance": comparison.distance}
    return Fact(facts, (compare,))
