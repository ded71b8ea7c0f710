"""What goes into every sensitivity method, a target, and what comes out of it, indices."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import xarray as xr

from uq.rows.elements import Element, Floats, flags
from uq.rows.results import failed


@dataclass(frozen=True)
class Target:
    """One number per row.

    Attributes
    ----------
    name : str
        That of the element; for lifetimes ``rate(element)`` and ``P(element<t)``; for regimes
        ``P(regime=label)``.
    element : Element or None
        None for a category.
    values : ndarray, shape (n,)
        NaN for rows that failed or have no value.
    refused : str
        Why there can be no index of it, or "".
    event : bool
        Whether the values say if something happened, 1, or not, 0.
    """

    name: str
    element: Element | None
    values: Floats
    refused: str = ""
    event: bool = False


class Index(NamedTuple):
    """One index with its 95 % interval, NaN where there is none."""

    value: float
    low: float = np.nan
    high: float = np.nan


class Indices(NamedTuple):
    """All indices of one target.

    Attributes
    ----------
    values : dict of str to dict
        ``S1``, ``ST``, ... -> parameter (``"first,second"`` for a pair) -> Index.
    notes : tuple of str
        Sentences on what could not be given.
    dummy : dict of str to float
        Name of the index -> its largest value over inputs that play no part.
    noise : Index or None
        Share of the variance that remains once all inputs are known, where rows tell it.
    """

    values: dict[str, dict[str, Index]]
    notes: tuple[str, ...] = ()
    dummy: Mapping[str, float] = MappingProxyType({})
    noise: Index | None = None


class RefusedError(Exception):
    """A target has no indices; the message is the sentence that says why."""


def targets(
    elements: Iterable[Element], thresholds: Mapping[str, tuple[float, ...]]
) -> Iterator[Target]:
    """Yield the targets of some elements.

    Parameters
    ----------
    elements : iterable of Element
    thresholds : dict of str to tuple of float
        Output -> times t of its probabilities P(T < t), for lifetimes.

    Yields
    ------
    Target
        A value or angle is a target as it is. A lifetime T may be infinite or censored; its rate
        1/T and the event T < t are bounded.
    """
    for element in elements:
        if element.kind != "lifetime":
            yield Target(element.name, element, element.values)
            continue
        yield _rate(element)
        for threshold in thresholds.get(element.output, ()):
            yield _event(element, threshold)


def _rate(element: Element) -> Target:
    censored = int(element.censored.sum())
    refused = ""
    if censored:
        refused = (
            f"the rate of {censored} rows is not known because their lifetimes are censored; ask"
            " for P(T < t) by a threshold in [analysis], or lengthen the horizon"
        )
    with np.errstate(divide="ignore"):
        rate = 1 / element.values
    if np.isinf(rate).any():
        refused = (
            refused
            or f"{int(np.isinf(rate).sum())} of {rate.size} rows have lifetime zero: no rate"
        )
    return Target(f"rate({element.name})", element, rate, refused)


def _event(element: Element, threshold: float) -> Target:
    ended = element.values < threshold
    unknown = int((ended & element.censored).sum())
    refused = f"{unknown} of {ended.size} rows were censored before then" * (unknown > 0)
    event = np.where(element.present, ended, np.nan)
    return Target(f"P({element.name}<{threshold!r})", element, event, refused, event=True)


def category_targets(ds: xr.Dataset, output: str) -> Iterator[Target]:
    """Yield whether a category, such as the regime, is each of those that occur.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, or some rows of one.
    output : str
        An output of kind ``category`` without dimensions.

    Yields
    ------
    Target
        NaN for rows that failed before they had a category; a sound row of no category has none.
    """
    codes, lost = ds[output].values, failed(ds)
    for code, label in flags(ds[output]):
        if code >= 0 and (hits := codes == code).any():
            values = np.where((codes < 0) & lost, np.nan, hits)
            yield Target(f"P({output}={label})", None, values, event=True)
