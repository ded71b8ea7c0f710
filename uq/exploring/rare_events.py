"""Rare events: the probability that an output exceeds a threshold, down to 1e-6 and less."""

from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import ndtr

from uq.contract import Floats
from uq.errors import InputError, nearest
from uq.exploring.design_points import design_points, drawn_around
from uq.exploring.limit_state import LimitState, evaluator_of
from uq.exploring.subset_simulation import LEVEL_SHARE, SMALLEST, subset_interval, subset_simulation
from uq.intervals import Ends, binomial_interval, log_scatter_interval
from uq.running.loading import load_study
from uq.running.options import RunOptions
from uq.study.definition import Study
from uq.wording import counted

_FEWEST = 100  # rows of a level: 10 chains
_Generators = list[np.random.Generator]
_Outcome = tuple[Floats, Ends, float, dict[str, Any]]
"""Estimate of each replicate, their interval, its high end if the failed rows were within the
event, and variables of the result that one method alone gives."""


def rare_event(
    study: Study | str | Path,
    output: str,
    threshold: float,
    below: bool = False,
    method: str = "subset",
    samples: int = 1000,
    replicates: int = 8,
    workers: int | None = None,
    scheduler: str | None = None,
) -> xr.Dataset:
    """Estimate the probability that an output exceeds a threshold, however small it is.

    Parameters
    ----------
    study : Study, str or Path
        Gives model, laws, settings and seed; its design is not used.
    output : str
        Such as ``disphasing_angle`` (angles by their magnitude) or ``work_rate[site=left]``.
    threshold : float
        In the output's unit.
    below : bool
        Whether the event lies below the threshold instead of above.
    method : {"subset", "importance"}
        Subset simulation searches everywhere and assumes nothing. Importance sampling around the
        design points of FORM takes far fewer rows if the output is smooth, and misses any part of
        the event away from the design points that were found.
    samples : int
        Rows of each level (subset), or around the design points (importance), of each replicate.
    replicates : int
        Independent repetitions of the method, whose scatter gives the interval.
    workers, scheduler
        As in `uq.run`.

    Returns
    -------
    xarray.Dataset
        ``probability`` with its 95 % interval ``low``, ``high``; ``estimate`` of each replicate;
        ``rows`` computed, among them ``failed`` and ``undefined``, which count as outside the
        event, and ``failed_high``, the high end if the failed rows were within it; subset:
        ``levels`` of each replicate, why it ``ended`` (``event``, ``plateau`` or ``smallest``) and
        ``typical``, the median of each uncertain parameter given the event; importance:
        ``reliability_index``, ``first_order`` probability and ``location`` of each design point.
        Attribute ``notes``: caveats.

    Raises
    ------
    InputError
        When a name or number is not admissible, OpenTURNS is missing, or no design point is found.

    Notes
    -----
    Intervals are ``mean exp(+-t s / sqrt(R))``, s the standard deviation of the replicates'
    logarithms. Over 300 repetitions with 1000 samples and 8 replicates, they covered probabilities
    of 1e-6 to 1e-5 on three problems of 4 to 6 inputs in 94 to 97 % of cases; the mean of subset
    simulation was 4 to 6 % too large. If replicates never reach the event, the high end is what the
    rows support (`uq.exploring.subset_simulation.subset_interval`): for 8000 independent rows
    without a hit, 4.6e-4.

    Examples
    --------
    >>> found = uq.rare_event("studies/exponential-wear.toml", "life", 1e5, below=True)
    >>> bool(found["low"] < 3.155e-6 < found["high"])  # the true value
    True
    """
    if not isinstance(study, Study):
        study = load_study(study)
    _check(threshold, method, samples, replicates)
    if study.imported:
        raise InputError(
            f"{study.path}: [design] method = 'imported': rare events draw rows from laws, and"
            " imported rows have none; use another method"
        )
    generators = np.random.default_rng((study.design.seed, 1)).spawn(replicates)
    options = RunOptions(workers, scheduler)
    with evaluator_of(study, output.partition("[")[0], options) as evaluator:
        margin = LimitState(study, output, threshold, below, evaluator)
        estimates, interval, failed_high, variables = ESTIMATORS[method](
            margin, samples, generators
        )
    low, high = map(float, interval)
    ds = xr.Dataset(
        {
            "probability": ((), estimates.mean()),
            "low": ((), low),
            "high": ((), high),
            "failed_high": ((), max(failed_high, high) if margin.failed else np.nan),
            "rows": ((), margin.rows),
            "failed": ((), margin.failed),
            "undefined": ((), margin.undefined),
            "estimate": ("replicate", estimates),
        }
        | variables,
        {"parameter": list(study.uncertain)},
        {
            "output": output,
            "threshold": float(threshold),
            "side": "below" if below else "above",
            "units": margin.output.unit,
            "method": method,
            "samples": samples,
            "study": study.text,
            "study_identity": study.identity,
        },
    )
    return ds.assign_attrs(notes="\n".join(_notes(ds, margin)))


def _subset(margin: LimitState, samples: int, generators: _Generators) -> _Outcome:
    failed = []

    def counting(u: Floats) -> Floats:
        margins = margin(u)
        failed.append(margin.failed)
        return margins

    found = subset_simulation(counting, margin.dimension, samples, generators)
    hits, rows = sum(one.first_hits for one in found), samples * len(found)
    inside = margin.uncertain(np.concatenate([one.inside for one in found]))
    nothing = np.full(margin.dimension, np.nan)
    variables = {
        "levels": ("replicate", np.array([one.levels for one in found])),
        "ended": ("replicate", np.array([one.ended for one in found])),
        "typical": ("parameter", np.median(inside, axis=0) if len(inside) else nothing),
    }
    estimates = np.array([one.probability for one in found])
    failed_high = binomial_interval((hits + failed[0]) / rows, rows)[1]
    return estimates, subset_interval(found, samples), float(failed_high), variables


def _importance(margin: LimitState, samples: int, generators: _Generators) -> _Outcome:
    u = generators[0].standard_normal((samples, margin.dimension))
    first = margin(u)
    hits, failed = int((first > 0).sum()), margin.failed
    points = design_points(margin, u, first)
    if not len(points):
        raise InputError(
            "FORM found no design point: the output is not smooth enough, rows fail on the way, or"
            " the threshold is out of reach; use method 'subset'"
        )
    drawn, weights = zip(*(drawn_around(points, samples, rng) for rng in generators), strict=True)
    inside = margin(np.concatenate(drawn)) > 0
    estimates = (np.concatenate(weights) * inside).reshape(-1, samples).mean(axis=1)
    index = np.linalg.norm(points, axis=1)
    first_rows = binomial_interval(hits / samples, samples)
    variables = {
        "reliability_index": ("design_point", index),
        "first_order": ("design_point", ndtr(-index)),
        "location": (("design_point", "parameter"), margin.uncertain(points)),
    }
    interval = log_scatter_interval(estimates) if estimates.any() else first_rows
    failed_high = binomial_interval((hits + failed) / samples, samples)[1]
    return estimates, interval, float(failed_high), variables


ESTIMATORS = {"subset": _subset, "importance": _importance}


def _check(threshold: float, method: str, samples: int, replicates: int) -> None:
    allowed = f"no such method{nearest(method, ESTIMATORS)} ({', '.join(ESTIMATORS)})"
    demands = {
        f"threshold must be finite: {threshold!r}": isfinite(threshold),
        f"method '{method}': {allowed}": method in ESTIMATORS,
        f"samples must be at least {_FEWEST}: {samples}": samples >= _FEWEST,
        f"replicates must be at least 1: {replicates}": replicates >= 1,
    }
    if faults := [line for line, met in demands.items() if not met]:
        raise InputError(*faults)


def _where_it_ended(ds: xr.Dataset) -> str:
    """Say why replicates of subset simulation ended before the event."""
    causes = {
        "plateau": "ended on a plateau, where no row lies above the others",
        "smallest": f"ended at levels below {SMALLEST:g}: the threshold may be out of reach",
    }
    ended = ds["ended"].values.tolist() if "ended" in ds else []
    return "".join(
        f"; {ended.count(cause)} of {len(ended)} replicates {words}"
        for cause, words in causes.items()
        if cause in ended
    )


def _notes(ds: xr.Dataset, margin: LimitState) -> list[str]:
    """Return caveats that the numbers do not show."""
    notes = []
    estimates, most = ds["estimate"].values, float(ds["high"])
    lost, count = int((estimates == 0).sum()), len(estimates)
    if np.isnan(most):
        notes.append("no interval: a single replicate does not show the scatter of its estimate")
    if lost:
        seen = (
            "no row lies beyond the threshold"
            if lost == count
            else f"{lost} of {count} replicates did not reach the threshold"
        )
        notes.append(
            f"{seen}: the rows only support a probability below {most:.2g}{_where_it_ended(ds)};"
            " more samples support a lower one"
        )
    elif ds.attrs["method"] == "subset" and ds["probability"] > LEVEL_SHARE:
        notes.append("not a rare event: 'uq run' with this threshold reports as much, and more")
    if ds.attrs["method"] == "importance":
        notes.append(
            "valid only if the event lies around the design points that were found; method"
            " 'subset' searches everywhere"
        )
    if margin.failed:
        what = "".join(f"; {label}: {text}" for label, text in margin.failures.items())
        notes.append(
            f"{margin.failed} of {int(ds['rows'])} rows failed, or were censored before the"
            " threshold, and count as outside the event: the probability is a lower bound; with"
            f" them inside, the rows support no more than {float(ds['failed_high']):.2g}{what}"
        )
    if margin.undefined:
        notes.append(
            f"{counted(margin.undefined, 'row has', 'rows have')} no such output in the regime"
            " there, on neither side of the threshold"
        )
    return notes
