"""From rows of parameters to disphasing angles, start-up and regimes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.vibrator import exact_start, start, theory
from models.vibrator.outcome import Outcome
from models.vibrator.parameters import Params, Rows, Settings


def batch(
    x: NDArray[np.float64], seed: NDArray[np.uint64], settings: Settings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Compute n machines.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        Parameters in the order of `Params`.
    seed : ndarray of uint64, shape (n,)
        Not used: the machine is deterministic.
    settings : Settings

    Returns
    -------
    outputs : dict of str to ndarray, shape (n,)
        As `models.vibrator.parameters.OUTPUTS` says, and ``synchronisation_time_censored``.
    status : ndarray of int8, shape (n,)
    """
    p: Rows = Params._make(np.ascontiguousarray(x.T))
    fast = is_rigid(p) & (settings.kinematics == "small") & (settings.propagator == "fast")
    outcome, status = Outcome.nothing(len(x)), np.zeros(len(x), np.int8)
    for chosen, road in ((fast, start), (~fast, exact_start)):
        rows = np.flatnonzero(chosen)
        if len(rows):
            part, status[rows] = road.outcomes(Params._make(f[rows] for f in p), settings)
            for whole, some in zip(outcome, part, strict=True):
                whole[rows] = some
    theirs = theory.disphasing(p)
    return {
        "disphasing_angle": outcome.disphasing,
        "theory_disphasing_angle": np.where(theirs.stable, theirs.angle, np.nan),
        "angular_amplitude": outcome.angular_amplitude,
        "stroke_left": outcome.stroke_left,
        "stroke_right": outcome.stroke_right,
        "speed": outcome.speed,
        "power_1": outcome.power_1,
        "power_2": outcome.power_2,
        "floquet_multiplier": outcome.multiplier,
        "synchronisation_time": outcome.synchronisation_time,
        "synchronisation_time_censored": outcome.censored,
        "max_excursion": outcome.max_excursion,
        "regime": outcome.regime,
    }, status


def is_rigid(p: Rows) -> NDArray[np.bool_]:
    """Tell the machines whose motors are bolted to the body, without feed."""
    rigid = np.isinf(p.mount_stiffness) & np.isinf(p.mount_rotational_stiffness)
    return rigid & (p.feed_mass == 0)
