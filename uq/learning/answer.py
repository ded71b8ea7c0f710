"""What the inspections say, as one answer."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any
from unicodedata import normalize

import numpy as np
import xarray as xr

from uq.assess.summary_json import quality_json
from uq.errors import InputError
from uq.learning.information_gain import Taught, taught
from uq.learning.inspections import Inspection
from uq.learning.posterior import Posterior, posterior
from uq.learning.posterior_inputs import (
    Confounded,
    InputLearnt,
    PosteriorMoments,
    confounded,
    inputs_learnt,
)
from uq.learning.posterior_result import as_table, inspections_of, prior_of, unit_quality
from uq.learning.prior_predictive import STRANGE, strangeness
from uq.learning.remaining_life import ANY, Remaining, remaining
from uq.result.elements import independent_rows
from uq.result.weights import MODEL_ERROR, has_weights
from uq.stats import estimate_json
from uq.stats.importance_weights import Smoothed
from uq.text.numbers import percent


@dataclass(frozen=True)
class Learnt:
    """What inspections say.

    Attributes
    ----------
    inspections : list of Inspection
    worst : Smoothed
        The worst weights: of rows as inspected units, or as units never inspected.
    inputs : list of InputLearnt
    confounded : list of Confounded
    lives : list of Remaining
    taught : list of Taught
    strangeness : float
        Probability, before the inspections, of inspections at least as improbable.
    notes : list of str
        Warnings.
    """

    inspections: list[Inspection]
    worst: Smoothed
    inputs: list[InputLearnt]
    confounded: list[Confounded]
    lives: list[Remaining]
    taught: list[Taught]
    strangeness: float
    notes: list[str]


def learnt(ds: xr.Dataset, by: Sequence[float] = ()) -> Learnt:
    """Return what the inspections in a result of `uq.update` say.

    Parameters
    ----------
    ds : xarray.Dataset
    by : sequence of float
        Times from the beginning of a life, in its unit: the probability that it has ended by each.

    Raises
    ------
    InputError
        When the result has not been updated, or a time is negative or not finite.
    """
    if not has_weights(ds):
        raise InputError("this result has not been updated with inspections: see 'uq update'")
    quality, inspections = unit_quality(ds), inspections_of(ds)
    cv = float(ds.attrs[MODEL_ERROR])
    rows = independent_rows(prior_of(ds))
    found = posterior(rows, inspections, cv)
    strange = strangeness(found, int(ds.attrs["seed"]), cv)
    return Learnt(
        inspections,
        min(quality, key=lambda one: one.effective),
        list(inputs_learnt(ds)),
        confounded(ds),
        list(remaining(ds, by)),
        list(taught(found)),
        strange,
        [
            *_warnings(strange),
            *_alike(list(found.units)),
            *found.not_integrated,
            *_interpolated(found),
            *filter(None, [found.only_inspected]),
        ],
    )


def _warnings(strange: float) -> Iterator[str]:
    if strange < STRANGE:
        yield (
            f"Warning: inspections as improbable as these had a probability of {percent(strange)}"
            " before; a law, the model (--model-error) or an inspection may be wrong."
        )


def _alike(labels: Sequence[str]) -> Iterator[str]:
    """Yield which units may be one, written in two ways."""
    seen: dict[str, str] = {}
    for label in labels:
        letters = "".join(normalize("NFKC", label).casefold().split())
        if (other := seen.setdefault(letters, label)) != label:
            yield f"Warning: '{other}' and '{label}' are taken for two units."


def _interpolated(found: Posterior) -> Iterator[str]:
    """Yield how well depths are known between those whose lives the result has."""
    for look in {look.name: look for look in found.looks.values()}.values():
        errors = look.depths.error() if look.depths is not None else np.empty(0)
        if np.isfinite(errors).any():
            most = percent(float(np.nanquantile(errors, 0.9)))
            yield (
                f"{look.name} at a time is interpolated; with a declared depth left out it is"
                f" wrong by up to {most} in nine of ten rows."
            )


def learnt_json(found: Learnt) -> dict[str, Any]:
    """Return the answer in plain data.

    Returns
    -------
    dict
        ``effective_rows``, ``pareto_k``; ``inputs``: name -> ``prior`` and ``posterior``, each with
        ``mean``, ``sd`` (of the posterior with intervals, ``mean_low``, ..., and ``mean_reason``
        where it is missing) and ``quantiles``; of a unit as ``NAME[unit=LABEL]``; ``confounded``:
        pairs with their rank correlation; ``taught``: of each inspection the ``bits`` that it adds
        to all others; ``strangeness``: the probability, before them, of inspections at least as
        strange; ``notes``; ``units``: label -> life -> ``units`` (of all
        times), ``seen`` (when it was last seen running), ``runs``, ``remaining`` (quantiles from
        then on), ``by`` (probability to have ended by a time), ``effective_rows``; ``uninspected``:
        the same of units never inspected, with ``over_shared`` beside a probability, where known:
        its 2.5 and 97.5 % points over what units share.
    """
    units: dict[str, dict[str, Any]] = {}
    for one in found.lives:
        units.setdefault(one.unit, {})[one.output] = _life(one)
    return {
        **quality_json(found.worst),
        "inspections": len(found.inspections),
        "inputs": {
            one.name: {
                "units": one.units,
                "prior": _spread(one.prior),
                "posterior": _spread(one.posterior),
            }
            for one in found.inputs
        },
        "confounded": [
            {"inputs": [one.first, one.second], "correlation": one.correlation}
            for one in found.confounded
        ],
        "taught": [as_table(one.inspection) | {"bits": one.bits} for one in found.taught],
        "strangeness": found.strangeness,
        "notes": found.notes,
        "uninspected": units.pop(ANY, {}),
        "units": units,
    }


def _spread(one: PosteriorMoments) -> dict[str, Any]:
    quantiles = {repr(p): value for p, value in one.quantiles.items()}
    found: dict[str, Any] = {}
    for name, of in (("mean", one.mean), ("sd", one.sd)):
        found[name] = estimate_json.number(of.value)
        found |= {f"{name}_{end}": value for end, value in estimate_json.ends(of).items()}
        found |= {f"{name}_reason": of.reason} if of.reason else {}
    return found | {"quantiles": quantiles}


def _life(one: Remaining) -> dict[str, Any]:
    def spread(time: float) -> dict[str, Any]:
        points = one.over_shared.get(time, {})
        return {"over_shared": {repr(p): x for p, x in points.items()}} if points else {}

    return {
        "units": one.units,
        "seen": one.seen,
        "runs": estimate_json.whole(one.runs),
        "remaining": {repr(p): estimate_json.whole(found) for p, found in one.life.items()},
        "by": {repr(time): estimate_json.whole(p) | spread(time) for time, p in one.by.items()},
        "effective_rows": one.effective_rows,
    }
