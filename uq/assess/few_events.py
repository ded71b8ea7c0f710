"""Events that happen, or do not, in few rows: their indices are rough, or refused."""

import numpy as np

from uq.assess.targets import IndexTarget
from uq.indices.index import RefusedError
from uq.indices.measures import MIN_SIDE
from uq.result.result import Result
from uq.sampling.layouts import PLAIN
from uq.text.numbers import counted, grouped, rows_in_words

FEWEST_HITS = 5
"""With fewer in each replicate an event has no indices."""

ENOUGH_HITS = 20
"""With fewer in each replicate the indices come with a warning."""


def few_hits(result: Result, target: IndexTarget, intervals: bool = True) -> tuple[str, ...]:
    """Return the warning for an event with few hits or misses; any two values make one.

    Parameters
    ----------
    result : Result
        The result that the target is of.
    target : IndexTarget
    intervals : bool, optional
        Whether its indices have any.

    Returns
    -------
    tuple of str
        One sentence or none; none for all elements of an output together.

    Raises
    ------
    RefusedError
        Fewer than `FEWEST_HITS` in each replicate.
    """
    if target.values.ndim > 1:
        return ()
    values, replicates = target.values, int(result.dataset.attrs.get("replicates", 1))
    if not (target.event or len(np.unique(values[np.isfinite(values)])) == 2):
        return ()
    if not result.why_no_statistics:
        with_hits = Result(result.dataset.assign(hit=("row", values)))
        values = with_hits.independent.dataset["hit"].values
    defined = values[np.isfinite(values)]
    hits = defined > defined.min(initial=np.inf)
    rarer = int(min(hits.sum(), (~hits).sum()))
    if not 0 < rarer < ENOUGH_HITS * replicates:
        return ()  # without any the method refuses
    side = ("hit",) if rarer == hits.sum() else ("miss", "misses")
    per_replicate = f", {rarer / replicates:.2g} in each replicate" if replicates > 1 else ""
    samples = int(result.dataset.attrs["samples"])
    needed = rows_in_words(ENOUGH_HITS * replicates / rarer * samples)
    remedy = f"about {needed} samples instead of {grouped(samples)} would give {ENOUGH_HITS}"
    seen = f"only {counted(rarer, *side)} in {counted(len(hits), 'row')}{per_replicate}"
    if rarer < FEWEST_HITS * replicates:
        if target.event and result.design.layout is not PLAIN:
            remedy += f", and 'regional' of a 'monte-carlo' design needs {MIN_SIDE} in all"
        raise RefusedError(f"{seen}: {FEWEST_HITS} are needed for an index; {remedy}")
    widened = result.design.crossed
    narrow = ", and intervals may be too narrow" if intervals and not widened else ""
    return (f"{seen}: the indices are rough{narrow}; {remedy}",)
