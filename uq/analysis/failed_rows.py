"""What failed rows leave open: bounds with these rows at best and at worst, beside each estimate.

A row that failed has a value that is not known, and rows often fail where something happens: the
others may be anything but a fair sample. A tolerance bound counts them as the worst on each side;
so do these bounds.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from uq.intervals import Replicates, share_interval
from uq.rows.elements import Element, Floats, Mask

Entry = dict[str, Any]
Described = dict[str, dict[str, Any]]

LOW, HIGH = "failed_low", "failed_high"
"""Keys beside ``low`` and ``high``: the ends of the interval with the failed rows on that side."""


def with_failed_at(element: Element, value: float) -> Element:
    """Return an element whose failed rows have a value."""
    return replace(
        element,
        values=np.where(element.failed, value, element.values),
        failed=np.zeros_like(element.failed),
    )


def with_failed_bounds(
    element: Element, describe: Callable[[Element], Described]
) -> dict[str, dict[str, Any]]:
    """Describe an element, with bounds beside each probability, quantile and B-life.

    Parameters
    ----------
    element : Element
        Of independent rows.
    describe : callable
        Element -> ``quantiles``, ``b_lives`` and ``thresholds``.

    Returns
    -------
    dict
        What `describe` returns. Where rows failed, each entry also has `LOW` and `HIGH`: the ends
        of the 95 % interval with all failed rows at the lowest and at the highest value there may
        be, which for a lifetime are 0 and never. Null where they leave no bound.
    """
    found = describe(element)
    if not element.failed.any():
        return found
    is_life = element.is_lifetime
    least = 0.0 if is_life else -np.inf
    lowest, highest = (describe(with_failed_at(element, end)) for end in (least, np.inf))
    for part in ("quantiles", "b_lives"):
        for name, entry in found[part].items():
            low, high = lowest[part][name], highest[part][name]
            entry |= _ends(low, high, entry, is_life)
            if all("kaplan_meier" in one for one in (entry, low, high)):
                guess, low, high = (one["kaplan_meier"] for one in (entry, low, high))
                guess |= _ends(low, high, guess, is_life)
    if element.is_angle:  # thresholds are of the magnitude
        lowest = describe(with_failed_at(element, 0.0))
    for name, entry in found["thresholds"].items():
        ends = lowest["thresholds"][name], highest["thresholds"][name]
        _sides(entry, *ends)
        if "kaplan_meier" in entry:
            _sides(entry["kaplan_meier"], *(one["kaplan_meier"] for one in ends))
    return found


def _sides(entry: Entry, lowest: Entry, highest: Entry) -> None:
    entry["above"] |= _ends(lowest["above"], highest["above"], entry["above"])
    entry["below"] |= _ends(highest["below"], lowest["below"], entry["below"])


def _ends(lowest: Entry, highest: Entry, plain: Entry, is_life: bool = False) -> Entry:
    """Return both bounds; of an estimate without interval the estimates themselves."""
    alone = plain["low"] is None and plain["high"] is None
    found = {}
    for key, entry, inner in ((LOW, lowest, "low"), (HIGH, highest, "high")):
        # Replicates that agree with the failed rows on one side give no interval there.
        agreed = entry["value"] is not None and entry["low"] is None and entry["high"] is None
        end, reasons = ("value", "") if alone or agreed else (inner, f"{inner}_")
        known = entry[end] is not None and plain[inner] is not None
        found[key] = float(outer(key, entry[end], plain[inner])) if known else entry[end]
        for reason in ("never", "censored"):
            if is_life and entry.get(f"{reasons}{reason}"):
                found[f"{key}_{reason}"] = True
    return found


def outer(key: str, bound: ArrayLike, end: ArrayLike) -> Floats:
    """Return the outer one of bounds and ends of plain intervals; NaN where there is no bound.

    Replicates may scatter less with the failed rows on one side than without them.
    """
    widest = (np.fmin if key == LOW else np.fmax)(bound, end)
    return np.where(np.isnan(bound), np.nan, widest)


def failed_share_bounds(hits: Mask, failed: Mask, replicate: Replicates) -> Entry:
    """Return bounds of a share with all failed rows among the misses, and among the hits.

    Parameters
    ----------
    hits, failed : ndarray of bool, shape (n,)
        Of all independent rows.
    replicate : ndarray of int, shape (n,), or None

    Returns
    -------
    dict
        `LOW` and `HIGH`; nothing where no row failed.
    """
    if not failed.any():
        return {}
    ends = {}
    plain = share_interval(hits[~failed], None if replicate is None else replicate[~failed])
    for key, some, end in ((LOW, hits & ~failed, 0), (HIGH, hits | failed, 1)):
        bound = share_interval(some, replicate)[end]
        bound = bound if np.isfinite(bound) else some.mean()
        ends[key] = float(outer(key, bound, plain[end]))
    return ends


def failed_note(outputs: Iterable[Mapping[str, Any]], rows: int) -> list[str]:
    """Return the sentence on failed rows in a summary, or none.

    Parameters
    ----------
    outputs : iterable of dict
        What a summary says of each output.
    rows : int
        Independent ones.
    """
    most = max((one["failed"] for one in outputs), default=0)
    if not most:
        return []
    return [
        f"{most} of {rows} independent rows failed. Estimates are of the others; beside each"
        " probability, quantile and B-life stand its bounds with the failed rows at best and at"
        " worst"
    ]
