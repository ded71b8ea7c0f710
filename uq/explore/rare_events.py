"""Rare events: the probability that an output exceeds a threshold, down to 1e-6 and less."""

from collections.abc import Sequence
from math import isfinite, log
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.special import ndtr

from uq.contract import Floats
from uq.errors import InputError, nearest
from uq.execution.loading import load_study
from uq.execution.options import RunOptions
from uq.explore.active_learning import DOUBT, active_learning
from uq.explore.importance_sampling import (
    WideSearch,
    design_points,
    drawn_around,
    is_above,
    wide_search,
)
from uq.explore.limit_state import EventLimit, LimitState, SystemState, evaluator_of
from uq.explore.subset_simulation import (
    LEVEL_SHARE,
    SMALLEST,
    disagreement,
    subset_interval,
    subset_simulation,
)
from uq.stats.intervals import CONFIDENCE, Ends, binomial_interval, log_scatter_interval
from uq.study.definition import Study
from uq.text.numbers import counted

_FEWEST = 100  # rows of a level: 10 chains
REACHED = "of the part that the method reaches"
"""Scope of an interval, unless it is based on plain rows or widened laws."""


class _Outcome(NamedTuple):
    """Outcome of a method: its estimates, interval and bounds.

    Attributes
    ----------
    estimates : ndarray, shape (R,)
        Of each replicate.
    interval : Ends
    supported : float
        Upper bound from the share of its independent plain rows within the event.
    failed_high : float
        The same if the failed rows were within the event.
    plain : int
        Number of these rows; 0 if the estimates are shares of them.
    disagreement : float
        See `uq.explore.subset_simulation.disagreement`.
    variables : dict
        Variables of the result specific to this method.
    """

    estimates: Floats
    interval: Ends
    supported: float
    failed_high: float
    plain: int
    disagreement: float
    variables: dict[str, Any]

    @property
    def is_partial(self) -> bool:
        """Whether the interval is of the part of the event that the method reaches."""
        return self.plain > 0 or "hidden_high" in self.variables


def rare_event(
    study: Study | str | Path,
    output: str | None = None,
    threshold: float | None = None,
    below: bool = False,
    method: str = "subset",
    samples: int | None = None,
    replicates: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    any_of: Sequence[tuple[str, float, str]] = (),
    all_of: Sequence[tuple[str, float, str]] = (),
) -> xr.Dataset:
    """Estimate the probability that an output exceeds a threshold, however small it is.

    The event may also be that any, or all, of several limits are exceeded.

    Parameters
    ----------
    study : Study, str or Path
        Gives model, laws, settings and seed; its design is not used.
    output : str, optional
        Such as ``disphasing_angle`` (angles by their magnitude) or ``work_rate[site=left]``.
    threshold : float, optional
        In the output's unit.
    below : bool
        Whether the event is below the threshold instead of above.
    method : {"subset", "importance", "active"}
        Subset simulation follows the output towards the event from every side. It assumes that the
        output rises towards every part of the event, without a jump. Importance sampling around the
        design points of FORM requires far fewer rows if the output is smooth, but misses any part
        of the event away from the design points found. Active learning is for rows that take
        minutes: emulators choose a few hundred rows, a third of which corrects their estimate
        (`uq.explore.active_learning.active_learning`).
    samples : int, optional
        Rows of each level (subset, 1000), or around the design points (importance, 1000), of each
        replicate; largest number of all rows (active, 300).
    replicates : int, optional
        Independent repetitions of the method, whose scatter gives the interval, 8 by default; not
        of active learning, whose interval is from its last rows.
    workers, scheduler
        As in `uq.run`.
    any_of, all_of : sequence of (str, float, {"above", "below"}), optional
        Instead of output and threshold: several limits, any of which (series system) or all of
        which (parallel system) make the event, such as ``[("life", 1e5, "below"), ("sum", 3.0,
        "above")]``.

    Returns
    -------
    xarray.Dataset
        ``probability`` with its 95 % interval ``low``, ``high``; ``estimate`` of each replicate;
        ``rows`` computed by the method, among them ``failed`` and ``undefined``, which count as
        outside the event, and ``failed_high``, the high end if the failed rows were within it;
        ``hidden_high``, the probability above which plain rows exclude a part of the event that the
        method cannot see (95 %, 3.0 over their number); ``wide``, ``wide_low``, ``wide_high``,
        ``wide_hits``, ``wide_rows`` and ``wide_failed``, the same probability from rows drawn wide,
        how many of these lie within the event, how many there are and how many failed; subset:
        ``levels`` of each replicate, why it ``ended`` (``event``, ``plateau`` or ``smallest``) and
        ``typical``, the median of each uncertain parameter given the event; importance:
        ``reliability_index``, ``first_order`` probability and ``location`` of each design point;
        active: no rows drawn wide apart, but ``emulated``, the probability by the emulators alone,
        the share of it that they expect to be ``misclassified``, and how many of the ``checks``,
        the rows of the last estimate, ``contradicted`` them.
        Attributes: ``estimated_by`` (the method, or ``wide`` where rows drawn wide show that it
        missed a part), ``interval_of`` (``event``, or the part that the method reaches), and
        ``notes``: caveats. Of a system, ``output``, ``threshold``, ``side`` and ``units`` are lists
        and ``combination`` is ``any`` or ``all``.

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
    rows support (`uq.explore.subset_simulation.subset_interval`): for 8000 independent rows
    without a hit, 4.6e-4.

    Both methods can miss a part of the event; subset simulation misses a part behind a jump of the
    output. As a check, as many rows as in a level are drawn from widened laws
    (`uq.explore.importance_sampling`). Their estimate and interval replace those of the method if
    their interval is above, or if enough of them are within the event and a replicate did not reach
    it. If only their estimate is above, by more than a standard error, and enough rows are within
    the event, the high end is at least theirs, with a note. If replicates of subset simulation
    scatter more than chain correlation explains, the high end is at least the upper bound from
    plain rows, and the low end is that about the geometric mean of the replicates.

    Examples
    --------
    >>> event = uq.rare_event("studies/exponential-wear.toml", "life", 1e5, below=True)
    >>> bool(event["low"] < 3.155e-6 < event["high"])  # the true value
    True
    """
    if not isinstance(study, Study):
        study = load_study(study)
    limits, every = _limits(output, threshold, below, any_of, all_of)
    if samples is None:
        samples = SAMPLES.get(method, 0)
    _check(limits, method, samples, replicates)
    replicates = REPLICATES if replicates is None else replicates
    if study.imported:
        raise InputError(
            f"{study.path}: [design] method = 'imported': rare events draw rows from laws, and"
            " imported rows have none; use another method"
        )
    options = RunOptions(workers, scheduler)
    names = {limit.output.partition("[")[0] for limit in limits}
    with evaluator_of(study, names.pop() if len(names) == 1 else "", options) as evaluator:

        def state(first: int) -> LimitState:
            if len(limits) == 1:
                return LimitState(study, *limits[0], evaluator, first)
            return SystemState(study, limits, every, evaluator, first)

        margin = state(0)
        generators = np.random.default_rng((study.design.seed, 1)).spawn(replicates)
        outcome = ESTIMATORS[method](margin, samples, generators)
        wide, lost = None, 0
        if outcome.plain:
            apart = state(margin.rows)
            generators = np.random.default_rng((study.design.seed, 2)).spawn(replicates)
            wide = wide_search(apart, margin.dimension, samples, generators)
            lost = apart.failed
    by_wide, unseen = wide is not None and _is_missed(outcome, wide), {}
    if wide is not None:
        unseen = {
            "hidden_high": ((), wide.hidden_high(outcome.plain)),
            "wide": ((), wide.probability),
            "wide_low": ((), wide.interval[0]),
            "wide_high": ((), wide.interval[1]),
            "wide_hits": ((), len(wide.weights)),
            "wide_rows": ((), samples * replicates),
            "wide_failed": ((), lost),
        }
    probability, (low, high) = estimate_of(outcome, wide)
    ds = xr.Dataset(
        {
            "probability": ((), probability),
            "low": ((), low),
            "high": ((), high),
            "failed_high": ((), max(outcome.failed_high, high) if margin.failed else np.nan),
            **unseen,
            "rows": ((), margin.rows),
            "failed": ((), margin.failed),
            "undefined": ((), margin.undefined),
            "estimate": ("replicate", outcome.estimates),
        }
        | outcome.variables,
        {"parameter": list(study.uncertain)},
        {
            **_event(margin),
            "method": method,
            "estimated_by": "wide" if by_wide else method,
            "interval_of": REACHED if outcome.is_partial and not by_wide else "event",
            "samples": samples,
            "study": study.text,
            "study_identity": study.identity,
        },
    )
    return ds.assign_attrs(notes="\n".join(caveats(ds, margin, outcome.disagreement)))


def _limits(
    output: str | None,
    threshold: float | None,
    below: bool,
    any_of: Sequence[tuple[str, float, str]],
    all_of: Sequence[tuple[str, float, str]],
) -> tuple[list[EventLimit], bool]:
    """Return the limits of an event, and whether all of them must be exceeded."""
    single = output is not None or threshold is not None
    if single + bool(any_of) + bool(all_of) != 1 or (single and None in (output, threshold)):
        raise InputError("rare event: give an output and a threshold, or any_of, or all_of")
    if output is not None and threshold is not None:
        return [EventLimit(output, threshold, below)], False
    given = any_of or all_of
    if len(given) < 2:
        raise InputError("rare event: any_of and all_of need at least two limits")
    if faults := [side for *_, side in given if side not in ("above", "below")]:
        raise InputError(f"rare event: a limit is 'above' or 'below', not {faults[0]!r}")
    return [EventLimit(name, limit, side == "below") for name, limit, side in given], bool(all_of)


def _event(margin: LimitState) -> dict[str, Any]:
    """Return the attributes of an event: lists of those of its limits if there are several."""
    parts = [
        {
            "output": part.limit.output,
            "threshold": float(part.limit.threshold),
            "side": "below" if part.limit.below else "above",
            "units": part.output.unit,
        }
        for part in margin.parts
    ]
    if len(parts) == 1:
        return parts[0]
    lists = {name: [part[name] for part in parts] for name in parts[0]}
    return lists | {"combination": "all" if margin.every else "any"}


def estimate_of(outcome: _Outcome, wide: WideSearch | None) -> tuple[float, tuple[float, float]]:
    """Return the probability and its interval, from widened laws if a method missed a part.

    Parameters
    ----------
    outcome : _Outcome
        Of a method of `ESTIMATORS`.
    wide : WideSearch or None
        None where the estimates are shares of plain rows.

    Returns
    -------
    probability : float
    low, high : float
    """
    if wide is not None and _is_missed(outcome, wide):
        low, high = map(float, wide.interval)
        if np.isnan(high):
            high = max(outcome.supported, wide.probability)
        return wide.probability, (low, high)
    probability = float(outcome.estimates.mean())
    low, high = map(float, outcome.interval)
    if outcome.disagreement > 1:
        # One replicate that enters a part by chance dominates the mean, not the geometric mean.
        low *= float(np.exp(np.log(outcome.estimates).mean())) / probability
        high = max(high, outcome.supported)
    if wide is not None and wide.is_enough and is_above(wide.probability, wide.interval[0], high):
        high = max(high, float(wide.interval[1]))
    return probability, (low, high)


def _is_missed(outcome: _Outcome, wide: WideSearch) -> bool:
    """Return whether widened laws reveal a part of the event that a method missed."""
    reached = bool((outcome.estimates > 0).all())
    return wide.interval[0] > outcome.interval[1] or (wide.is_enough and not reached)


def _subset(margin: LimitState, samples: int, generators: list[np.random.Generator]) -> _Outcome:
    failed = []

    def counting(u: Floats) -> Floats:
        margins = margin(u)
        failed.append(margin.failed)
        return margins

    replicates = subset_simulation(counting, margin.dimension, samples, generators)
    hits, rows = sum(replicate.first_hits for replicate in replicates), samples * len(replicates)
    inside = margin.uncertain(np.concatenate([replicate.inside for replicate in replicates]))
    nothing = np.full(margin.dimension, np.nan)
    variables = {
        "levels": ("replicate", np.array([replicate.levels for replicate in replicates])),
        "ended": ("replicate", np.array([replicate.ended for replicate in replicates])),
        "typical": ("parameter", np.median(inside, axis=0) if len(inside) else nothing),
    }
    estimates = np.array([replicate.probability for replicate in replicates])
    supported, failed_high = (
        float(binomial_interval(k / rows, rows)[1]) for k in (hits, hits + failed[0])
    )
    plain = 0 if all(replicate.levels == 1 and hits for replicate in replicates) else rows
    scatter = disagreement(replicates, samples)
    interval = subset_interval(replicates, samples)
    return _Outcome(estimates, interval, supported, failed_high, plain, scatter, variables)


def _importance(
    margin: LimitState, samples: int, generators: list[np.random.Generator]
) -> _Outcome:
    u = generators[0].standard_normal((samples, margin.dimension))
    first = margin(u)
    hits, failed = int((first > 0).sum()), margin.failed
    if hits == samples:
        raise InputError(
            f"no design point to find: all of {samples} rows are beyond the threshold; 'uq run'"
            " with this threshold gives its probability"
        )
    points = design_points(margin, u, first)
    if not len(points):
        raise InputError(
            "FORM found no design point: the output is not smooth enough, rows on the way are"
            " invalid, or the threshold is out of reach; use method 'subset'"
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
    failed_high = float(binomial_interval((hits + failed) / samples, samples)[1])
    supported = float(first_rows[1])
    return _Outcome(estimates, interval, supported, failed_high, samples, 1.0, variables)


def _active(margin: LimitState, samples: int, generators: list[np.random.Generator]) -> _Outcome:
    learnt = active_learning(margin, samples, generators[0])
    hidden = -log(1 - CONFIDENCE) / learnt.plain
    interval, failed_high = learnt.interval, learnt.failed_high
    if not learnt.probability:
        interval, failed_high = (0.0, hidden), hidden
    variables = {
        "hidden_high": ((), hidden),
        "emulated": ((), learnt.emulated),
        "misclassified": ((), learnt.doubt),
        "checks": ((), learnt.checks),
        "contradicted": ((), learnt.contradicted),
    }
    estimates = np.array([learnt.probability])
    return _Outcome(estimates, interval, hidden, failed_high, 0, 1.0, variables)


ESTIMATORS = {"subset": _subset, "importance": _importance, "active": _active}

SAMPLES = {"subset": 1000, "importance": 1000, "active": 300}
"""Rows by default: of a level, around design points, and in all."""

REPLICATES = 8


def _check(limits: list[EventLimit], method: str, samples: int, replicates: int | None) -> None:
    active = method == "active"
    allowed = f"no such method{nearest(method, ESTIMATORS)} ({', '.join(ESTIMATORS)})"
    demands = {
        **{
            f"threshold must be finite: {limit.threshold!r}": isfinite(limit.threshold)
            for limit in limits
        },
        f"method '{method}': {allowed}": method in ESTIMATORS,
        f"samples must be at least {_FEWEST}: {samples}": samples >= _FEWEST
        or method not in SAMPLES,
        f"replicates must be at least 1: {replicates}": replicates is None or replicates >= 1,
        "method 'active' has no replicates: its interval is from its last rows": not active
        or replicates is None,
    }
    if faults := [line for line, met in demands.items() if not met]:
        raise InputError(*faults)


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
    if "wide" in ds:
        above = is_above(float(ds["wide"]), float(ds["wide_low"]), most)
        if not by_wide and (above or most == ds["wide_high"]):
            notes.append(
                f"rows drawn wide estimate {float(ds['wide']):.2g}, above the interval of method"
                f" '{ds.attrs['method']}': it may miss a part of the event"
                + ("; the high end is theirs" if most == ds["wide_high"] else "")
            )
    if "hidden_high" in ds:
        notes.append(
            f"an isolated part of the event, reached neither by a trend nor by a row, is"
            f" excluded only above {float(ds['hidden_high']):.2g} (95 %)"
        )
        if "wide" in ds and ds["wide_failed"] > 0:
            notes.append(
                f"{int(ds['wide_failed'])} of {int(ds['wide_rows'])} rows drawn wide are invalid:"
                " missed parts are not searched for there"
            )
    if "checks" in ds:
        notes.append(
            f"{int(ds['contradicted'])} of the last {int(ds['checks'])} rows contradict the"
            f" emulator, which alone gives {float(ds['emulated']):.2g}; the estimate is corrected"
            " by them"
        )
        if not ds["misclassified"] <= DOUBT:
            notes.append(
                "learning ended with its rows, before the emulator was certain: more samples give a"
                " narrower interval"
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
