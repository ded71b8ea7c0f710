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
    """Return the settled responses of n moles from their present states, which are updated."""
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
