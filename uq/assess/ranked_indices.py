"""The indices of a target as the lines of a table that ends with inputs without effect."""

from collections.abc import Mapping
from math import isfinite, nan

from uq.indices.index import IndexKind, Null
from uq.stats.estimate import Estimate

Values = Mapping[IndexKind, Mapping[str, Estimate]]


def ranking(values: Values) -> list[str]:
    """Return the inputs, or pairs of them, the most important by the last kind of index first."""
    last = list(values.values())[-1]
    return sorted(last, key=lambda label: -size(last[label]))


def size(index: Estimate) -> float:
    """Return the value of an index; 0 where there is none."""
    return index.value if isfinite(index.value) else 0.0


def lines(values: Values, nulls: Mapping[IndexKind, Null]) -> list[tuple[str, list[Estimate]]]:
    """Return label and estimates, one of each kind, of each line of a table.

    Parameters
    ----------
    values : dict of IndexKind to dict
    nulls : dict of IndexKind to Null
        Limits of indices of inputs without effect; unknown for pairs.

    Returns
    -------
    list of tuple
    """
    ranked = ranking(values)
    entries = [(label, [by_label[label] for by_label in values.values()]) for label in ranked]
    limits = [nulls.get(kind, Null(nan)) for kind in values]
    if any(isfinite(null.limit) for null in limits):
        entries.append(("(an input without effect)", [Estimate(null.limit) for null in limits]))
    if any(isfinite(null.largest) for null in limits):
        label = f"(largest of {len(ranked)} such inputs)"
        entries.append((label, [Estimate(null.largest) for null in limits]))
    return entries
