"""From rows of parameters to progression, impacts and regimes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.mole.drives import drives, refused
from models.mole.lanes.rows import OUT_OF_BUDGET, OUTCOME, SCALES
from models.mole.lanes.strobe import REPEAT
from models.mole.parameters import NO_IMPACT, ON_STOP, PERIODIC, Params, Rows, Settings
from models.mole.response.machines import Machines
from models.mole.response.measured import Response
from models.mole.response.settled import mean_rate, respond
from models.mole.response.verdict import verdicts
from models.numerics.batch_means import ratio_error
from models.numerics.block_maxima import maximum_and_growth
from uq.contract import Status


def batch(x: NDArray[np.float64], seed: NDArray[np.uint64], settings: Settings) -> Any:
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
    reasons : dict of int to str
        Of rows refused; only if there are some.
    """
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    machines = Machines.started(p, settings, settings.transient + settings.duration)
    response = respond(machines, settings)
    outputs = _outputs(p, machines, response)
    lost = np.isnan(response.time)
    over = machines.record[:, OUTCOME] == OUT_OF_BUDGET
    status = np.where(lost, np.where(over, Status.OUT_OF_BUDGET, Status.NON_FINITE), Status.OK)
    reasons = refused(p, settings)
    if settings.distance or settings.temperature:
        more, unfinished = drives(p, machines, response, settings)
        outputs |= more
        status = np.where(unfinished, Status.OUT_OF_BUDGET, status)
    for i in reasons:
        status[i] = Status.NON_FINITE
        for values in outputs.values():
            values[i] = np.nan if values.dtype.kind == "f" else -1 if values.dtype == np.int8 else 0
    done = outputs, status.astype(np.int8)
    return (*done, reasons) if reasons else done


def _outputs(p: Rows, machines: Machines, response: Response) -> dict[str, NDArray[Any]]:
    valid = np.isfinite(response.time)
    repeats = response.period > 0
    progression, progression_error = mean_rate(response.progress, response.time, repeats)
    impact, impact_error = mean_rate(response.impact, response.time, repeats)
    electrical, electrical_error = mean_rate(response.electric, response.time, repeats)
    exponent, exponent_error = mean_rate(response.growth, response.time, repeats)
    periods = response.time * p.control_frequency
    _, impacts_error = mean_rate(response.contacts, periods, repeats)
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
