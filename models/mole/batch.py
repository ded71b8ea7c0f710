"""From rows of parameters to progression, impacts and regimes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.mole.lanes.rows import OUT_OF_BUDGET, OUTCOME, SCALES
from models.mole.lanes.strobe import REPEAT
from models.mole.parameters import NO_IMPACT, ON_STOP, PERIODIC, Params, Rows, Settings
from models.mole.response.following import follow_other, follow_repeating
from models.mole.response.machines import Machines
from models.mole.response.measured import BATCHES, Response
from models.mole.response.settling import LATEST, settle, settle_late
from models.mole.response.verdict import verdicts
from models.numerics.batch_means import mean_and_error, ratio_error
from models.numerics.block_maxima import maximum_and_growth
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
    valid = np.isfinite(response.time)
    repeats = response.period > 0
    progression, progression_error = _mean(response.progress, response.time, repeats)
    impact, impact_error = _mean(response.impact, response.time, repeats)
    electrical, electrical_error = _mean(response.electric, response.time, repeats)
    exponent, exponent_error = _mean(response.growth, response.time, repeats)
    periods = response.time * p.control_frequency
    _, impacts_error = _mean(response.contacts, periods, repeats)
    high, low = response.high.max(axis=1), response.low.min(axis=1)
    contacts = response.contacts.sum(axis=1)
    other = verdicts(response.growth, periods, machines.system.common == 0)
    regime = np.where(repeats, PERIODIC, other)
    regime[(contacts == 0) & ~response.touching] = NO_IMPACT
    regime[(contacts == 0) & response.touching & (high - low < REPEAT * SCALES[0])] = ON_STOP
    regime[~valid] = -1
    gap, stiffness = p.stop_gap[:, None], p.contact_stiffness[:, None]
    forces = stiffness * np.maximum(response.high - gap, 0.0)
    blows = np.where(contacts > 0, contacts, np.nan)
    return {
        "progression_rate": progression,
        "progression_rate_error": progression_error,
        "peak_contact_force": np.where(valid, forces.max(axis=1), np.nan),
        "peak_contact_force_error": _growth(valid, repeats, forces),
        "impact_work_rate": impact,
        "impact_work_rate_error": impact_error,
        "impacts_per_period": contacts / periods,
        "impacts_per_period_error": impacts_error,
        "impact_impulse": response.impulse.sum(axis=1) / blows,
        "impact_impulse_error": _ratio_error(response.impulse, response.contacts, repeats),
        "impact_energy": response.impact.sum(axis=1) / blows,
        "impact_energy_error": _ratio_error(response.impact, response.contacts, repeats),
        "displacement_range": np.where(valid, high - low, np.nan),
        "displacement_range_error": _growth(valid, repeats, response.high, -response.low),
        "electrical_power": electrical,
        "electrical_power_error": electrical_error,
        "efficiency": impact / electrical,
        "efficiency_error": _ratio_error(response.impact, response.electric, repeats),
        "lyapunov_exponent": exponent,
        "lyapunov_exponent_error": exponent_error,
        "regime": regime.astype(np.int8),
        "period": np.where(valid, response.period, -1).astype(np.int8),
    }


def _mean(parts: Any, time: Any, repeats: Any) -> tuple[Any, Any]:
    """Return the mean rate of a quantity given in batches, and its standard error."""
    mean, error = mean_and_error(parts)
    error = np.where(repeats, 0.0, error)
    return mean * BATCHES / time, error * BATCHES / time


def _ratio_error(parts: Any, denominator: Any, repeats: Any) -> Any:
    """Return the standard error of the ratio of two quantities given in batches."""
    exact = np.where(denominator.any(axis=1), 0.0, np.nan)
    return np.where(repeats, exact, ratio_error(parts, denominator))


def _growth(valid: Any, repeats: Any, *maxima: Any) -> Any:
    """Return a bound on the growth of a sum of largest values; maxima are given in batches."""
    error = np.where(valid, 0.0, np.nan)
    other = valid & ~repeats
    error[other] = sum(maximum_and_growth(largest[other])[1] for largest in maxima)
    return error
