"""The settled response of n moles, and the means of what it adds up."""

from typing import Any

import numpy as np

from models.mole.parameters import Settings
from models.mole.response.following import follow_other, follow_repeating
from models.mole.response.machines import Machines
from models.mole.response.measured import BATCHES, Response
from models.mole.response.settling import LATEST, settle, settle_late
from models.numerics.batch_means import mean_and_error


def respond(machines: Machines, settings: Settings) -> Response:
    """Return the settled responses of n moles from their present states, which are updated.

    Tangents of moles with soil ahead have more components: these moles form a group of their own.
    """
    soil = machines.system.soil
    if soil.all() or not soil.any():
        return _respond_alike(machines, settings)
    response = Response.nothing(len(machines.record))
    for rows in np.flatnonzero(~soil), np.flatnonzero(soil):
        some = Machines(machines.system.take(rows), machines.record[rows])
        part = _respond_alike(some, settings)
        for mine, new in zip(response, part, strict=True):
            mine[rows] = new
        machines.record[rows] = some.record
    return response


def _respond_alike(machines: Machines, settings: Settings) -> Response:
    response = Response.nothing(len(machines.record))
    repeating, other = settle(machines, settings.transient)
    unstable = follow_repeating(machines, repeating, settings.duration, response)
    other = np.concatenate([other, unstable])
    follow_other(machines, other, settings.duration, response)
    latest = 0.0 if settings.transient else LATEST
    late = settle_late(machines, other, response, latest)
    unstable = follow_repeating(machines, late, settings.duration, response)
    follow_other(machines, unstable, settings.duration, response)
    return response


def mean_rate(parts: Any, time: Any, repeats: Any) -> tuple[Any, Any]:
    """Return the mean rate of a quantity given in batches, and its standard error."""
    mean, error = mean_and_error(parts)
    error = np.where(repeats, 0.0, error)
    return mean * BATCHES / time, error * BATCHES / time
