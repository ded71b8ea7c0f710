"""What methods share whose rows come in groups: intervals from the scatter between replicates."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from uq.estimate import Estimate
from uq.intervals import scatter_interval
from uq.methods.indices import Kind
from uq.methods.sample import Floats

Name = tuple[Kind, str]
"""A kind of index, and the input that it is of."""


def by_replicates(
    estimate: Callable[[Floats], Mapping[Name, float]],
    pooled: Floats,
    replicates: Sequence[Floats],
    what: str,
    lacking: str = "",
) -> tuple[dict[Name, Estimate], tuple[str, ...]]:
    """Estimate from all groups together, with intervals from the same estimate by replicates.

    Parameters
    ----------
    estimate : callable
        Whole groups, along the first axis -> indices.
    pooled : ndarray
        All whole groups.
    replicates : sequence of ndarray
        Those of each replicate.
    what : str
        What a sentence calls them.
    lacking : str
        Why the replicates cannot be estimated from alone, or "".

    Returns
    -------
    estimates : dict
    notes : tuple of str
        Why there are no intervals.
    """
    scatter: list[Mapping[Name, float]] = []
    notes: tuple[str, ...] = ()
    if len(replicates) == 1:
        notes = (f"no intervals: with replicates = 1 nothing shows the scatter of the {what}",)
    elif lacking:
        notes = (f"no intervals: {lacking}",)
    else:
        scatter = [estimate(own) for own in replicates]
    found = {}
    for key, value in estimate(pooled).items():
        interval = scatter_interval(value, np.array([one[key] for one in scatter]))
        found[key] = Estimate(value, *interval)
    return found, notes
