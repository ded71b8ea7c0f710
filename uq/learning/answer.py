"""What the inspections say, as one answer."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr

from uq import json_form
from uq.analysis.as_json import quality_json
from uq.errors import InputError
from uq.learning.inputs_learnt import Confounded, InputLearnt, Spread, confounded, inputs_learnt
from uq.learning.inspections import Inspection
from uq.learning.remaining import ANY, Remaining, remaining
from uq.learning.result import inspections_of, unit_quality
from uq.population.smoothing import Smoothed
from uq.rows.weights import has_weights


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
    """

    inspections: list[Inspection]
    worst: Smoothed
    inputs: list[InputLearnt]
    confounded: list[Confounded]
    lives: list[Remaining]


def learnt(ds: xr.Dataset, by: Sequence[float] = ()) -> Learnt:
    """Return what the inspections in a result of `uq.update` say.

    Parameters
    ----------
    ds : xarray.Dataset
    by : sequence of float
        Times from the beginning of a life [s]: the probability that it has ended by each.

    Raises
    ------
    InputError
        When the result has not been updated.
    """
    if not has_weights(ds):
        raise InputError("this result has not been updated with inspections: see 'uq update'")
    quality = unit_quality(ds)
    return Learnt(
        inspections_of(ds),
        min(quality, key=lambda one: one.effective),
        list(inputs_learnt(ds)),
        confounded(ds),
        list(remaining(ds, by)),
    )


def learnt_json(found: Learnt) -> dict[str, Any]:
    """Return the answer in plain data.

    Returns
    -------
    dict
        ``effective_rows``, ``pareto_k``; ``inputs``: name -> ``prior`` and ``posterior``, each with
        ``mean``, ``sd`` and ``quantiles``, those of a unit as ``NAME[unit=LABEL]``; ``confounded``:
        pairs with their rank correlation; ``units``: label -> life -> ``seen`` (when it was last
        seen running), ``runs``, ``remaining`` (quantiles from then on), ``by`` (probability to have
        ended by a time), ``effective_rows``; ``uninspected``: the same of units never inspected.
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
        "uninspected": units.pop(ANY, {}),
        "units": units,
    }


def _spread(one: Spread) -> dict[str, Any]:
    quantiles = {repr(p): value for p, value in one.quantiles.items()}
    return {"mean": one.mean, "sd": one.sd, "quantiles": quantiles}


def _life(one: Remaining) -> dict[str, Any]:
    return {
        "seen": one.seen,
        "runs": json_form.whole(one.runs),
        "remaining": {repr(p): json_form.whole(found) for p, found in one.life.items()},
        "by": {repr(time): json_form.whole(found) for time, found in one.by.items()},
        "effective_rows": one.effective_rows,
    }
