"""Stated laws and rank correlations of the inputs compared with those of rows or of data."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import scipy  # which imports scipy.stats when it is first used
import xarray as xr

from uq.assess.fact import Fact
from uq.assess.row_inputs import EVERYWHERE, independent_inputs
from uq.contract import Floats
from uq.errors import InputError, nearest
from uq.result.result import Result
from uq.sampling.copulas import (
    COPULAS,
    STUDENT,
    PairCopula,
    SurvivalPair,
    fitted_copula,
    has_survival,
)
from uq.sampling.data_files import read_column
from uq.sampling.designs import DESIGNS
from uq.sampling.law import Law
from uq.sampling.truncation import cdf_within, factor_of, ppf_within
from uq.stats.estimate_json import number
from uq.study.definition import Study
from uq.study.input_checks import laws_of
from uq.study.row_sampling import row_block, rows
from uq.text.numbers import listed, percent

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


FEWEST_PAIRS = 30
"""Fewer pairs of values are not fitted."""

MOST_CORRELATED = 0.999
"""Largest rank correlation, either sign, of two columns to which copulas are fitted."""

MOST_TIED = 0.2
"""Largest share of equal values in a column."""

SAME_SUPPORT = 4.0
"""Copulas whose AIC is within this of the lowest are not told apart."""

MOST_COMPARED = 2000
"""Largest number of pairs whose empirical copula is compared: of more, the first."""


def copula_fits(data: Any, first: str, second: str, refits: int = 0, seed: int = 0) -> pd.DataFrame:
    """Fit the copulas of a study file to two columns of data, by maximum likelihood of their ranks.

    Parameters
    ----------
    data : path, pandas.DataFrame, xarray.Dataset, Result or mapping
        A CSV or netCDF file, or columns by name.
    first, second : str
        The columns; their laws do not matter.
    refits : int
        Samples drawn from each fitted copula and refitted, for its p-value; 200 resolve 5 %.
    seed : int
        Of these samples.

    Returns
    -------
    pandas.DataFrame
        Index: the copula as in ``[dependence]`` (``survival clayton``: ``survival = true``), by
        ascending AIC. Columns: ``parameter`` (theta, or the correlation of normal or Student
        scores); ``degrees_of_freedom``; Spearman's ``rank_correlation``, for the study file;
        ``log_likelihood`` and ``aic``; coefficients of tail dependence, ``lower_tail`` and
        ``upper_tail``; ``distance`` from the empirical copula (Cramer-von Mises, of at most 2000
        pairs), and its ``p_value``, NaN without refits. In ``attrs``: ``conclusion``, a sentence on
        whether the data tell these copulas apart; the number of ``pairs``, the share ``tied``, and
        Spearman's ``rank_correlation`` of the data.

    Raises
    ------
    InputError
        When a column is missing, or has too few or too many equal values.

    Notes
    -----
    Ranks over n + 1 take the place of the values [1]_; equal values have their mean rank. The
    p-value is that of the parametric bootstrap [2]_. The AIC treats ranks as independent draws: a
    difference of less than 4 is not taken as a distinction.

    References
    ----------
    .. [1] C. Genest, K. Ghoudi, L.-P. Rivest, "A semiparametric estimation procedure of dependence
       parameters in multivariate families of distributions", Biometrika 82, 543-552 (1995).
    .. [2] C. Genest, B. Remillard, D. Beaudoin, "Goodness-of-fit tests for copulas: a review and a
       power study", Insur. Math. Econ. 44, 199-213 (2009).

    Examples
    --------
    >>> import numpy as np
    >>> rng = np.random.default_rng(1)
    >>> a = rng.weibull(2.0, 400)
    >>> fits = uq.copula_fits({"a": a, "b": a + 0.3 * rng.weibull(2.0, 400)}, "a", "b")
    >>> fits.loc["normal", "rank_correlation"].round(1).item()
    0.9
    """
    if refits < 0:
        raise InputError(f"copula fits: refits must not be negative: {refits}")
    columns = _column(data, first), _column(data, second)
    sizes = sorted({len(column) for column in columns})
    if sizes[1:] or sizes[0] < FEWEST_PAIRS:
        wanted = f"two columns of one length, {FEWEST_PAIRS} or more"
        raise InputError(f"copula fits: {first} and {second} have {sizes} values; needed: {wanted}")
    tied = {name: _tied(column) for name, column in zip((first, second), columns, strict=True)}
    for name, share in tied.items():
        if share > MOST_TIED:
            raise InputError(
                f"copula fits: {percent(share)} of the values of {name} are equal to others"
                f" (allowed: {percent(MOST_TIED)}); their ranks do not determine a copula"
            )
    points = _pseudo_observations(columns[0]), _pseudo_observations(columns[1])
    if abs(rank := float(np.corrcoef(*points)[0, 1])) > MOST_CORRELATED:
        raise InputError(
            f"copula fits: the rank correlation of {first} and {second} is {rank:.5f}"
            f" (allowed: {MOST_CORRELATED} at most); one determines the other, which equals states"
        )
    names = [(name, False) for name in COPULAS]
    names += [(name, True) for name in COPULAS if has_survival(name)]
    rng = np.random.default_rng(seed)
    lines = {}
    for name, survival in names:
        fit = fitted_copula(name, *points, survival)
        lines["survival " * survival + name] = _line_of(fit, name, points) | {
            "p_value": _p_value(fit, name, survival, points, refits, rng)
        }
    table = pd.DataFrame.from_dict(lines, orient="index").sort_values("aic", kind="stable")
    table.index.name = "copula"
    table.attrs = {
        "conclusion": _conclusion(table, max(tied.values())),
        "pairs": sizes[0],
        "tied": max(tied.values()),
        "rank_correlation": rank,
    }
    return table


Pairs = tuple[Floats, Floats]
"""Ranks of two columns over n + 1."""


def _column(data: Any, name: str) -> Floats:
    """Return a column of data."""
    if isinstance(data, str | Path):
        return read_column(Path(data), name)
    if isinstance(data, Result):
        data = data.dataset
    if not isinstance(data, Mapping | pd.DataFrame | xr.Dataset):
        raise InputError(f"copula fits: {type(data).__name__} has no columns: give a file or table")
    if name not in data:
        names = [str(column) for column in data]
        raise InputError(
            f"copula fits: no column '{name}'{nearest(name, names)} (columns: {listed(names)})"
        )
    try:
        values = np.asarray(data[name], dtype=float)
    except (TypeError, ValueError):
        values = np.empty((0, 0))
    if values.ndim != 1 or not np.isfinite(values).all():
        raise InputError(f"copula fits: {name} must be a column of finite numbers")
    return values


def _tied(values: Floats) -> float:
    """Return the share of values that are equal to others."""
    _, counts = np.unique(values, return_counts=True)
    return float(counts[counts > 1].sum() / len(values))


def _pseudo_observations(values: Floats) -> Floats:
    """Return ranks over n + 1, mean ranks of equal values."""
    return np.asarray(scipy.stats.rankdata(values) / (len(values) + 1))


def _line_of(fit: PairCopula, name: str, points: Pairs) -> dict[str, float]:
    """Return the numbers of a fitted copula."""
    of: Any = fit.of if isinstance(fit, SurvivalPair) else fit
    log_likelihood = float(fit.log_density(*points).sum())
    lower, upper = fit.tails
    return {
        "parameter": of.correlation if hasattr(of, "correlation") else of.theta,
        "degrees_of_freedom": getattr(of, "freedom", np.nan),
        "rank_correlation": fit.rank_correlation,
        "log_likelihood": log_likelihood,
        "aic": 2.0 * (1 + (name == STUDENT)) - 2 * log_likelihood,
        "lower_tail": lower,
        "upper_tail": upper,
        "distance": _distance(fit, points),
    }


def _distance(fit: PairCopula, points: Pairs) -> float:
    """Return the sum of squared differences from the empirical copula at the points."""
    u, v = (column[:MOST_COMPARED] for column in points)
    empirical = np.array([((u <= a) & (v <= b)).mean() for a, b in zip(u, v, strict=True)])
    return float(((empirical - fit.joint(u, v)) ** 2).sum())


def _p_value(
    fit: PairCopula,
    name: str,
    survival: bool,
    points: Pairs,
    refits: int,
    rng: np.random.Generator,
) -> float:
    """Return the share of refitted samples of a copula that are as far from their copula."""
    if not refits:
        return np.nan
    observed, exceeded = _distance(fit, points), 0
    for _ in range(refits):
        u, w = rng.random((2, len(points[0])))
        sample = _pseudo_observations(u), _pseudo_observations(fit.conditional_quantile(w, u))
        exceeded += _distance(fitted_copula(name, *sample, survival), sample) >= observed
    return (exceeded + 0.5) / (refits + 1)


def _conclusion(table: pd.DataFrame, tied: float) -> str:
    """Return a sentence on the copulas that the data do not tell apart."""
    best, *others = table.index[table["aic"] <= table["aic"].iloc[0] + SAME_SUPPORT]
    text = f"The lowest AIC is that of the copula '{best}'"
    if others:
        text += f"; the data do not tell it from {listed(others)} (AIC within {SAME_SUPPORT:g})"
    else:
        text += f", by more than {SAME_SUPPORT:g}"
    ties = (
        f" {percent(tied)} of the values of a column are equal to others: their mean rank is used."
    )
    return f"{text}.{ties * bool(tied)}"
