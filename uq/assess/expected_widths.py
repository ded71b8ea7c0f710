"""The expected width of the intervals of a study, from a few of its rows.

From the spread of independent rows. Intervals from replicates scatter, and good designs make them
narrower: for these the width is about the largest to expect. So it is where samples have several
rows: as if these agreed.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from uq.assess.targets import number_of, transformed_if_heavy
from uq.contract import Floats
from uq.indices.method import DesignSample, SensitivityMethod
from uq.indices.methods import METHODS, piloted_by
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.result import Result
from uq.stats.intervals import upper_probability
from uq.stats.order_statistics import is_within
from uq.stats.quantile_functions import normal, student
from uq.stats.tails import lacks_variance

_ENOUGH_ROWS = 8


@dataclass(frozen=True)
class Widths:
    """Widths of the 95 % intervals of an element of an output; None where the pilot is too small.

    Attributes
    ----------
    units : str
        Of the output.
    mean : float or None
    quantiles : dict of float to float or None
        Probability -> width.
    thresholds : dict of float to float or None
        Threshold -> width of the probability of exceeding it.
    indices : dict of str to float or None
        The widest of each kind (``S1``, ``ST``) that the design feeds and a pilot can forecast.
    """

    units: str
    mean: float | None
    quantiles: Mapping[float, float | None]
    thresholds: Mapping[float, float | None]
    indices: Mapping[str, float | None]


def expected_widths(pilot: Result) -> dict[str, Widths]:
    """Return the expected widths of the 95 % intervals of the full study.

    Parameters
    ----------
    pilot : Result
        Some rows of the study, whole groups of its design.

    Returns
    -------
    dict of str to Widths
        Element of an output -> widths.
    """
    analysis = pilot.analysis
    samples, replicates = pilot.dataset.attrs["samples"], pilot.dataset.attrs["replicates"]
    labels = [label for _, label in flags(pilot.dataset["block"])]
    rows = samples * replicates * (2 if "A" in labels else 1)
    factor = _factor(pilot.has_independent_samples, replicates)
    keys = [pilot.dataset[name].values for name in ("block", "group", "replicate")]
    groups = np.lexsort(keys).reshape(-1, len(labels))
    method = piloted_by(pilot.design)
    widths = {}
    outputs = pilot.shown_outputs(analysis)
    for whole, element in zip(
        pilot.elements(outputs), pilot.independent.elements(outputs), strict=True
    ):
        usable = factor if len(element.at_least) >= _ENOUGH_ROWS else None
        limits = analysis.thresholds.get(element.output, ())
        sample = DesignSample(
            transformed_if_heavy(number_of(whole)).values, {}, groups[None], tuple(labels)
        )
        widths[element.name] = Widths(
            units=element.units,
            mean=usable and _mean(element, rows, usable),
            quantiles={
                p: usable and _quantile(element.at_least, p, rows, usable)
                for p in analysis.quantiles
            },
            thresholds={t: usable and _share(element, t, rows, usable) for t in limits},
            indices=_indices(sample, METHODS[method], samples * replicates, factor)
            if method
            else {},
        )
    return widths


def _factor(independent: bool, replicates: int) -> float | None:
    """Return the half-width of an interval in standard errors."""
    if independent:
        return float(normal(upper_probability()))
    return student(upper_probability(), replicates - 1) if replicates > 1 else None


def _mean(element: Element, rows: int, factor: float) -> float | None:
    values = element.at_least
    unbounded = element.never.any() or element.censored.any()
    if unbounded or lacks_variance(values):
        return None
    return float(2 * factor * values.std(ddof=1) / np.sqrt(rows))


def _quantile(values: Floats, p: float, rows: int, factor: float) -> float | None:
    if not is_within(p, rows):
        return None
    m = len(values)
    spread = np.sqrt(p * (1 - p))
    half = factor * spread / np.sqrt(rows)
    # Too few neighbours in the pilot for a slope; events rarer than one row are unknown.
    reach = min(max(half, 2 * spread / np.sqrt(m)), p - 1 / (m + 1), m / (m + 1) - p)
    if reach < half:
        return None
    with np.errstate(invalid="ignore"):  # between a life that ends and one that never does
        low, high = np.quantile(values, [p - reach, p + reach], method="weibull")
    return float((high - low) * half / reach) if np.isfinite(high - low) else None


def _share(element: Element, threshold: float, rows: int, factor: float) -> float:
    above = element.above(threshold)[element.present]
    # Two more rows on each side: a pilot without a hit does not prove that there is none.
    p = (np.count_nonzero(above) + 2) / (len(above) + 4)
    return float(2 * factor * np.sqrt(p * (1 - p) / rows))


def _indices(
    sample: DesignSample, method: SensitivityMethod, groups: int, factor: float | None
) -> dict[str, float | None]:
    """Return the widest interval of each kind of index, as of independent groups."""
    whole = sample.grouped[sample.whole]
    enough = factor is not None and len(whole) >= _ENOUGH_ROWS and whole.std() > 0
    spreads = method.pilot(sample) if enough and method.pilot else {}
    return {
        kind.key: float(2 * factor * spreads[kind] / np.sqrt(groups))
        if factor is not None and kind in spreads
        else None
        for kind in method.kinds
        if not kind.of_pairs
    }
