"""Caveats of a rare-event probability that its numbers do not show."""

import numpy as np
import xarray as xr

from uq.explore.importance_sampling import is_above
from uq.explore.limit_state import LimitState
from uq.explore.subset_simulation import LEVEL_SHARE, SMALLEST
from uq.text.numbers import counted

_ENDS = {
    "plateau": "ended on a plateau, where no row is above the others",
    "smallest": f"ended at levels below {SMALLEST:g}: the threshold may be out of reach",
}
"""Why replicates of subset simulation ended before the event."""


def caveats(ds: xr.Dataset, margin: LimitState, factor: float) -> list[str]:
    """Return caveats that the numbers of a rare event do not show.

    Parameters
    ----------
    ds : xarray.Dataset
        The estimate, without its notes.
    margin : LimitState
        With the rows that failed or have no output.
    factor : float
        Ratio of largest to smallest replicate estimate
        (`uq.explore.subset_simulation.disagreement`); 1 if it needs no explanation.
    """
    notes = []
    estimates, most = ds["estimate"].values, float(ds["high"])
    lost, count = int((estimates == 0).sum()), len(estimates)
    by_wide = ds.attrs["estimated_by"] == "wide"
    if by_wide:
        notes.append(
            f"method '{ds.attrs['method']}' missed a part of the event: it gives"
            f" {float(estimates.mean()):.2g}, and {int(ds['wide_hits'])} of"
            f" {int(ds['wide_rows'])} rows drawn wide are in it; their estimate is shown"
        )
    elif factor > 1:
        notes.append(
            f"replicates differ by a factor of {factor:.2g}, more than their chains explain: a part"
            " of the event is entered by a jump; the high end is from plain rows"
        )
    if "hidden_high" in ds:
        above = is_above(float(ds["wide"]), float(ds["wide_low"]), most)
        if not by_wide and (above or most == ds["wide_high"]):
            notes.append(
                f"rows drawn wide estimate {float(ds['wide']):.2g}, above the interval of method"
                f" '{ds.attrs['method']}': it may miss a part of the event"
                + ("; the high end is theirs" if most == ds["wide_high"] else "")
            )
        notes.append(
            f"an isolated part of the event, reached neither by a trend nor by a row, is"
            f" excluded only above {float(ds['hidden_high']):.2g} (95 %)"
        )
        if ds["wide_failed"] > 0:
            notes.append(
                f"{int(ds['wide_failed'])} of {int(ds['wide_rows'])} rows drawn wide are invalid:"
                " missed parts are not searched for there"
            )
    if np.isnan(most):
        notes.append("no interval: a single replicate does not show the scatter of its estimate")
    if lost and not by_wide:
        seen = (
            "no row is beyond the threshold"
            if lost == count
            else f"{lost} of {count} replicates did not reach the threshold"
        )
        ended = ds["ended"].values.tolist() if "ended" in ds else []
        ends = "".join(
            f"; {ended.count(cause)} of {count} replicates {words}"
            for cause, words in _ENDS.items()
            if cause in ended
        )
        notes.append(
            f"{seen}: the rows only show a probability below {most:.2g}{ends};"
            " more samples can show a lower one"
        )
    elif ds.attrs["method"] == "subset" and ds["probability"] > LEVEL_SHARE:
        notes.append("not a rare event: 'uq run' with this threshold is sufficient")
    if ds.attrs["estimated_by"] == "importance":
        notes.append(
            "valid only if the event is near the design points that were found; method 'subset'"
            " does not need them"
        )
    if margin.failed:
        causes = "".join(f"; {label}: {text}" for label, text in margin.failures.items())
        notes.append(
            f"{margin.failed} of {int(ds['rows'])} rows are invalid, or were censored before the"
            " threshold, and count as outside the event: the probability is a lower bound; with"
            f" them inside, the rows support no more than {float(ds['failed_high']):.2g}{causes}"
        )
    if margin.undefined:
        notes.append(
            f"{counted(margin.undefined, 'row has', 'rows have')} no such output in the regime"
            " there, on neither side of the threshold"
        )
    return notes
