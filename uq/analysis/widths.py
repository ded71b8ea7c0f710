"""How wide the intervals of a study will be, from a few of its rows.

By the spread of independent rows. Intervals from replicates scatter, and good designs make them
narrower than that: for these the width is about the most to be expected.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy import stats

from uq.designs.registry import DESIGNS
from uq.indices.targets import lightened, number_of
from uq.methods.indices import Kind
from uq.methods.method import Method
from uq.methods.registry import METHODS, piloted_by
from uq.methods.sample import Sample
from uq.order_statistics import is_within
from uq.rows.elements import (
    Element,
    Floats,
    analysis_of,
    are_independent,
    elements_of,
    flags,
    independent_rows,
    shown_outputs,
)
from uq.tails import lacks_variance

_ENOUGH_ROWS = 8
_LEVEL = 0.975


@dataclass(frozen=True)
class Widths:
    """Widths of the 95 % intervals of an element of an output; None where the pilot cannot tell.

    Attributes
    ----------
    units : str
        Of the output.
    mean : float or None
    quantiles : dict of float to float or None
        Probability -> width.
    thresholds : dict of float to float or None
        Threshold -> width of the probability of lying above.
    indices : dict of str to float or None
        The widest of each kind (``S1``, ``ST``) that the design feeds and a pilot can forecast.
    """

    units: str
    mean: float | None
    quantiles: Mapping[float, float | None]
    thresholds: Mapping[float, float | None]
    indices: Mapping[str, float | None]


def expected_widths(pilot: xr.Dataset) -> dict[str, Widths]:
    """Return the widths of the 95 % intervals that a whole study will give.

    Parameters
    ----------
    pilot : xarray.Dataset
        Some rows of the study, whole groups of its design.

    Returns
    -------
    dict of str to Widths
        Element of an output -> widths.
    """
    analysis = analysis_of(pilot)
    samples, replicates = pilot.attrs["samples"], pilot.attrs["replicates"]
    labels = [label for _, label in flags(pilot["block"])]
    rows = samples * replicates * (2 if "A" in labels else 1)
    factor = _factor(are_independent(pilot), replicates)
    groups = _groups(pilot, len(labels))
    method = piloted_by(DESIGNS[pilot.attrs["design"]])
    found = {}
    for whole, element in zip(
        elements_of(pilot, shown_outputs(pilot, analysis)),
        elements_of(independent_rows(pilot), shown_outputs(pilot, analysis)),
        strict=True,
    ):
        found[element.name] = Widths(
            units=element.units,
            mean=_mean(element, rows, factor),
            quantiles={p: _quantile(element.at_least, p, rows, factor) for p in analysis.quantiles},
            thresholds={
                t: _share(element, t, rows, factor)
                for t in analysis.thresholds.get(element.output, ())
            },
            indices=_indices(whole, method, groups, labels, samples * replicates, factor)
            if method
            else {},
        )
    return found


def _factor(independent: bool, replicates: int) -> float | None:
    """Return half the width of an interval in standard errors."""
    if independent:
        return float(stats.norm.ppf(_LEVEL))
    return float(stats.t.ppf(_LEVEL, replicates - 1)) if replicates > 1 else None


def _mean(element: Element, rows: int, factor: float | None) -> float | None:
    values = element.at_least
    unbounded = element.never.any() or element.censored.any()
    if factor is None or unbounded or len(values) < _ENOUGH_ROWS or lacks_variance(values):
        return None
    return float(2 * factor * values.std(ddof=1) / np.sqrt(rows))


def _quantile(values: Floats, p: float, rows: int, factor: float | None) -> float | None:
    if factor is None or len(values) < _ENOUGH_ROWS or not is_within(p, rows):
        return None
    m = len(values)
    spread = np.sqrt(p * (1 - p))
    half = factor * spread / np.sqrt(rows)
    # Neighbours in the pilot are too few to tell a slope; what is rarer than a row it cannot know.
    reach = min(max(half, 2 * spread / np.sqrt(m)), p - 1 / (m + 1), m / (m + 1) - p)
    if reach < half:
        return None
    with np.errstate(invalid="ignore"):  # between a life that ends and one that never does
        low, high = np.quantile(values, [p - reach, p + reach], method="weibull")
    return float((high - low) * half / reach) if np.isfinite(high - low) else None


def _share(element: Element, threshold: float, rows: int, factor: float | None) -> float | None:
    values = element.for_thresholds[element.present]
    if factor is None or len(values) < _ENOUGH_ROWS:
        return None
    # As with two more rows on each side: a pilot without a hit does not prove that there is none.
    p = (np.count_nonzero(values > threshold) + 2) / (len(values) + 4)
    return float(2 * factor * np.sqrt(p * (1 - p) / rows))


def _groups(pilot: xr.Dataset, blocks: int) -> NDArray[np.intp]:
    """Return the rows of each group of the pilot, shape (groups, blocks)."""
    keys = [pilot[name].values for name in ("block", "group", "replicate")]
    return np.lexsort(keys).reshape(-1, blocks)


def _indices(
    element: Element,
    method: str,
    groups: NDArray[np.intp],
    labels: list[str],
    n: int,
    factor: float | None,
) -> dict[str, float | None]:
    """Return the widest interval of each kind of index, as of independent groups."""
    target = lightened(number_of(element))
    own = Sample(target.values, {}, groups[None], tuple(labels))
    spreads = {} if target.refused else _spreads(METHODS[method], own)
    return {
        kind.key: _index(spreads.get(kind), n, factor)
        for kind in METHODS[method].kinds
        if not kind.of_pairs
    }


def _spreads(method: Method, sample: Sample) -> dict[Kind, float]:
    """Return what a few groups tell of each kind of index; nothing where they are too few."""
    whole = sample.values[sample.groups][sample.whole]
    enough = len(whole) >= _ENOUGH_ROWS and whole.std() > 0
    return method.pilot(sample) if enough and method.pilot else {}


def _index(spread: float | None, groups: int, factor: float | None) -> float | None:
    """Return the widest interval of a kind of index, as of independent groups."""
    if spread is None or factor is None:
        return None
    return float(2 * factor * spread / np.sqrt(groups))
