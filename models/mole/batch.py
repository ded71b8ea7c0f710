"""From rows of parameters to progression, impacts and regimes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.mole.lanes.rows import OUT_OF_BUDGET, OUTCOME
from models.mole.parameters import NO_IMPACT, PERIODIC, Params, Rows, Settings
from models.mole.response.following import follow_other, follow_repeating
from models.mole.response.machines import Machines
from models.mole.response.measured import BATCHES, Response
from models.mole.response.settling import LATEST, settle, settle_late
from models.mole.response.verdict import verdicts
from models.numerics.batch_means import mean_and_error
from uq.contract import Status


def batch(
    x: NDArray[np.float64], seed: NDArray[np.uint64], settings: Settings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Compute n moles.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        Parameters in the order of `Params`.
    seed : ndarray of uint64, shape (n,)
        Not used: the mole is deterministic.
    settings : Settings

    Returns
    -------
    outputs : dict of str to ndarray, shape (n,)
        Those of `models.mole.parameters.OUTPUTS`.
    status : ndarray of int8, shape (n,)
    """
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    machines = Machines.started(p, settings, settings.transient + settings.duration)
    response = Response.nothing(len(x))
    repeating, other = settle(machines, settings.transient)
    unstable = follow_repeating(machines, repeating, settings.duration, response)
    other = np.concatenate([other, unstable])
    follow_other(machines, other, settings.duration, response)
    latest = 0.0 if settings.transient else LATEST
    late = settle_late(machines, other, response, latest)
    unstable = follow_repeating(machines, late, settings.duration, response)
    follow_other(machines, unstable, settings.duration, response)
    outputs = _outputs(p, machines, response)
    lost = np.isnan(response.time)
    over = machines.record[:, OUTCOME] == OUT_OF_BUDGET
    status = np.where(lost, np.where(over, Status.OUT_OF_BUDGET, Status.NON_FINITE), Status.OK)
    return outputs, status.astype(np.int8)


def _outputs(p: Rows, machines: Machines, response: Response) -> dict[str, NDArray[Any]]:
    known = np.isfinite(response.time)
    repeats = response.period > 0
    progression, progression_error = _mean(response.progress, response.time, repeats)
    impact, impact_error = _mean(response.impact, response.time, repeats)
    electrical, _ = _mean(response.electric, response.time, repeats)
    exponent, exponent_error = _mean(response.growth, response.time, repeats)
    periods = response.time * p.control_frequency
    other = verdicts(response.growth, periods, machines.system.common == 0)
    regime = np.where(repeats, PERIODIC, other)
    regime[(response.contacts == 0) & ~response.touching] = NO_IMPACT
    regime[~known] = -1
    force = p.contact_stiffness * np.maximum(response.high - p.stop_gap, 0.0)
    range_ = response.high - response.low
    impacts = response.contacts / (response.time * p.control_frequency)
    blows = np.where(response.contacts > 0, response.contacts, np.nan)
    return {
        "progression_rate": progression,
        "progression_rate_error": progression_error,
        "peak_contact_force": np.where(known, force, np.nan),
        "impact_work_rate": impact,
        "impact_work_rate_error": impact_error,
        "impacts_per_period": impacts,
        "impact_impulse": response.impulse / blows,
        "impact_energy": response.impact.sum(axis=1) / blows,
        "displacement_range": np.where(known, range_, np.nan),
        "electrical_power": electrical,
        "efficiency": impact / electrical,
        "lyapunov_exponent": exponent,
        "lyapunov_exponent_error": exponent_error,
        "regime": regime.astype(np.int8),
        "period": np.where(known, response.period, -1).astype(np.int8),
    }


def _mean(parts: Any, time: Any, repeats: Any) -> tuple[Any, Any]:
    """Return the mean rate of a quantity given in batches, and its standard error."""
    mean, error = mean_and_error(parts)
    error = np.where(repeats, 0.0, error)
    return mean * BATCHES / time, error * BATCHES / time
