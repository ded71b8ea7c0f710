"""Effect of stated errors of rows on their values and scatter."""

from dataclasses import replace

import numpy as np

from uq.contract import Mask
from uq.result.element import Element


def off_by_error(element: Element, error: Element, sign: int) -> Element:
    """Return the same rows, each with a value that differs by the error stated for it.

    What never ends, is censored or states no error stays as it is; no life becomes negative.

    Parameters
    ----------
    element, error : Element
    sign : {-1, 1}
        Whether the values become smaller or larger.
    """
    values = np.where(
        _stated(element, error), element.values + sign * np.abs(error.values), element.values
    )
    return replace(element, values=np.maximum(values, 0.0) if element.is_lifetime else values)


def error_share(element: Element, error: Element) -> float:
    """Return the mean square of the errors as a share of the variance; of lives, of logarithms.

    Of the rows that state an error; NaN where these have no variance.
    """
    kept = _stated(element, error)
    values, errors = element.values[kept], error.values[kept]
    if element.is_lifetime:
        positive = values > 0
        values, errors = values[positive], errors[positive]
        values, errors = np.log(values), errors / values
    variance = float(np.var(values)) if len(values) else 0.0
    return float(np.mean(np.square(errors))) / variance if variance > 0 else np.nan


def stating_none(element: Element, error: Element) -> int:
    """Return how many rows have a value that could have an error, and state none."""
    return int((_may_err(element) & ~np.isfinite(error.values)).sum())


def _stated(element: Element, error: Element) -> Mask:
    return _may_err(element) & np.isfinite(error.values)


def _may_err(element: Element) -> Mask:
    return np.isfinite(element.values) & ~element.censored
