"""Kernel dependence measures (HSIC): target HSIC of an event, conditional HSIC given an event.

The Hilbert-Schmidt independence criterion (HSIC) of an input and an output is zero only if they are
independent. It is computed by OpenTURNS, which is imported on first use.
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
"""Largest number of rows: time and memory grow with its square."""


def target_indices(sample: DesignSample) -> Indices:
    """Estimate the target HSIC of each input for an event, with its p-value.

    Parameters
    ----------
    sample : DesignSample
        Plain sample of an event, 0 or 1.

    Returns
    -------
    Indices
        ``p``, the p-value of the independence test of each input, by a gamma approximation [2]_;
        and ``hsic``, the normalised HSIC of input and event [1]_: 0 if they are independent, at
        most 1. It is computed from ranks, with Gaussian kernels of one standard deviation in width.
        For an input with few values the kernel only compares values for equality, so that their
        labels do not matter.

    Raises
    ------
    RefusedError
        The output is not an event, too few rows are on one side of it, or OpenTURNS is not
        installed.

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
    """Estimate the conditional HSIC of each input: its HSIC among the rows with an event.

    Parameters
    ----------
    sample : DesignSample
        Plain sample of the output in these rows.

    Returns
    -------
    Indices
        As in `target_indices`, between input and output, both by their ranks among these rows.

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
    """Return the normalised HSIC of each input column; NaN for a constant column."""
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

    For an event it is the estimator of target sensitivity, with the event itself as filter. Given
    an event, conditional sensitivity with weights 0 and 1 equals global sensitivity of the rows of
    weight 1.
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
