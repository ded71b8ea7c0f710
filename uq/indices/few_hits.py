"""Events with few hits: when their indices are refused, or come with a warning."""

import numpy as np
import xarray as xr

from uq.indices.targets import Target
from uq.methods.indices import RefusedError
from uq.rows.elements import independent_rows, why_no_statistics

FEWEST_HITS = 5
"""With fewer in each replicate an event has no indices."""

ENOUGH_HITS = 20
"""With fewer in each replicate the indices come with a warning."""


def few_hits(ds: xr.Dataset, target: Target) -> tuple[str, ...]:
    """Return the warning for an event with few hits or misses; any two values are an event.

    Parameters
    ----------
    ds : xarray.Dataset
        The result that the target is of.
    target : Target

    Returns
    -------
    tuple of str
        One sentence or none.

    Raises
    ------
    RefusedError
        Fewer than `FEWEST_HITS` in each replicate.
    """
    values, replicates = target.values, int(ds.attrs.get("replicates", 1))
    if not why_no_statistics(ds):
        values = independent_rows(ds.assign(hit=("sample", values)))["hit"].values
    known = values[np.isfinite(values)]
    hits = known > known.min(initial=np.inf)
    rarer = int(min(hits.sum(), (~hits).sum()))
    two_values = target.event or bool((known[hits] == known.max(initial=-np.inf)).all())
    if not two_values or not 0 < rarer < ENOUGH_HITS * replicates:
        return ()  # without any the method refuses
    side = "hits" if rarer == hits.sum() else "misses"
    each = f", {rarer / replicates:.2g} in each replicate" if replicates > 1 else ""
    more = ENOUGH_HITS * replicates / rarer
    remedy = f"about {more:.2g} times the samples would give {ENOUGH_HITS}"
    seen = f"only {rarer} {side} in {len(hits)} rows{each}"
    if rarer < FEWEST_HITS * replicates:
        raise RefusedError(f"{seen}: {FEWEST_HITS} are needed for an index; {remedy}")
    return (f"{seen}: the indices are rough, and intervals may be too narrow; {remedy}",)
