"""Kernel measures of dependence (HSIC): of an event, and of an output given an event.

The Hilbert-Schmidt independence criterion (HSIC) is zero only if an input and what it is compared
with are independent. It is computed by OpenTURNS, which is imported when it is first used.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from uq.contract import Floats
from uq.indices.given_data import beside_nulls, one_kind
from uq.indices.index import IndexKind, Indices, RefusedError
from uq.indices.measures import MOST_CATEGORIES, as_event
from uq.indices.method import DesignSample
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import mid_ranks

HSIC = IndexKind("hsic", "HSIC, normalised")
P = IndexKind("p", "p-value of independence", "p-value")

MOST_ROWS = 2000
"""Time and memory grow with the square of the rows."""


def target_indices(sample: DesignSample) -> Indices:
    """Estimate how much each input decides whether an event happens.

    Parameters
    ----------
    sample : DesignSample
        Plain; an event, 0 or 1.

    Returns
    -------
    Indices
        ``p``, the probability of so large a dependence of an input without effect, by a gamma law
        [2]_, each input by itself; and ``hsic``, between input and event, over the root of the
        products of each with itself [1]_: 0 if they are independent, at most 1. It is that of
        ranks, with Gaussian kernels as wide as their standard deviation; of an input with few
        values, that of a kernel that tells whether two are equal, whatever they are called.

    Raises
    ------
    RefusedError
        Not an event, too few rows on one side of it, or OpenTURNS is not installed.

    References
    ----------
    .. [1] A. Marrel, V. Chabridon, "Statistical developments for target and conditional sensitivity
       analysis: application on safety studies for nuclear reactor", Reliab. Eng. Syst. Saf. 214,
       107711 (2021).
    .. [2] A. Gretton et al., "A kernel statistical test of independence", Adv. Neural Inf. Process.
       Syst. 20, 585-592 (2008).
    """
    as_event(sample.values)
    return _indices(sample)


def conditional_indices(sample: DesignSample) -> Indices:
    """Estimate how much each input matters for an output among the rows in which an event happens.

    Parameters
    ----------
    sample : DesignSample
        Plain; the output in these rows.

    Returns
    -------
    Indices
        As `target_indices`, between input and output, both by their ranks among these rows.

    Raises
    ------
    RefusedError
        OpenTURNS is not installed.
    """
    ranked = replace(sample, values=mid_ranks(sample.values))
    indices = _indices(ranked)
    note = f"of the {len(sample.values)} rows in which it happens; there inputs may be dependent"
    return replace(indices, notes=(note, *indices.notes))


def _indices(sample: DesignSample) -> Indices:
    indices = beside_nulls(one_kind(HSIC, _normalised))(sample)
    p_values = {name: Estimate(_p_value(x, sample.values)) for name, x in sample.inputs.items()}
    return replace(indices, values={P: p_values, **indices.values})


def _normalised(x: Floats, y: Floats) -> Floats:
    """Return the normalised HSIC of each column of inputs; NaN for a constant one."""
    return np.array(
        [
            _estimator(column, y).getR2HSICIndices()[0] if np.ptp(column) else np.nan
            for column in x.T
        ]
    )


def _p_value(x: Floats, y: Floats) -> float:
    return float(_estimator(x, y).getPValuesAsymptotic()[0]) if np.ptp(x) else np.nan


def _estimator(x: Floats, y: Floats) -> Any:
    """Return OpenTURNS' estimator for one input.

    Of an event it is that of target sensitivity, whose filter is the event itself; given an event,
    that of conditional sensitivity with weights 0 and 1 is the global one of the rows of weight 1.
    """
    try:
        import openturns as ot
    except ImportError:
        raise RefusedError(
            "OpenTURNS is not installed: pip install 'vibrolife[reliability]'"
        ) from None
    few = len(np.unique(x)) <= MOST_CATEGORIES
    x = x if few else mid_ranks(x)
    kernel = ot.DiracCovarianceModel(1) if few else ot.SquaredExponential([x.std()])
    return ot.HSICEstimatorGlobalSensitivity(
        [kernel, ot.SquaredExponential([y.std()])],
        ot.Sample(x[:, None]),
        ot.Sample(y[:, None]),
        ot.HSICVStat(),
    )
