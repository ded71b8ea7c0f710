"""From rows of parameters to the times of events of one gap."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.gap_wear.declarations import GapWearParameters, GapWearSettings
from models.gap_wear.growth import gap_when_new, lives
from uq.contract import Status

_PRELOADED = (
    "preload_deflection > 0 and nothing opens the gap: set creep_down, or relaxed_share below 1"
)


def batch(
    x: NDArray[np.float64], seed: NDArray[np.uint64], settings: GapWearSettings
) -> tuple[dict[str, NDArray[Any]], NDArray[np.int8], dict[int, str]]:
    """Integrate Eq. (1) to (5) with the integrator of slow time that machines use.

    Closed forms: with m = 0 and no closed gap the time to a depth d is
    (1 + kappa)^(p-1) B d^p/(k U_0). With p = 1, m not 1, and neither creep nor preload,
    (X/X_0)^(1-m) = 1 - (m-1) a t, where a = (1 + kappa) k U_0/(S X_0). With p = m = 1
    and creep, X = X_0 e^(at) + (C_c/tau_c) (e^(at) - e^(-t/tau_c))/(a + 1/tau_c). With
    tau_c = tau_r = tau, a gap opens at -tau ln(1 - delta_0/(C_c + (1 - phi) delta_0)), never where
    C_c <= phi delta_0.

    Parameters
    ----------
    x : ndarray, shape (n, 20)
        In declared order: lengths [m], U_0 [W], k [m2 N-1], S [m2], times [s], others [1].
    seed : ndarray, shape (n,)
        Not used.
    settings : GapWearSettings

    Returns
    -------
    outputs : dict
        ``time_to_depth``, shape (n, D), ``time_to_gap_growth``, shape (n, G), and
        ``time_to_opening``, shape (n,) [s], each with ``_censored`` and ``_error`` [s]; the error
        is NaN where the time is infinite or censored. With instants also ``worn_depth``,
        ``gap`` [m] and ``wear_share`` [1], shape (n, k).
    status : ndarray, shape (n,)
        Non-finite, as are all outputs, where a gap is preloaded and nothing opens it.
    reasons : dict of int to str
        Of these rows.
    """
    results = lives(x, settings)
    outputs: dict[str, NDArray[Any]] = {}
    count, last = len(settings.depths), len(settings.depths) + len(settings.growths)
    parts: dict[str, Any] = {"time_to_depth": slice(0, count), "time_to_opening": last}
    if settings.growths:
        parts["time_to_gap_growth"] = slice(count, last)
    for name, part in parts.items():
        outputs[name] = results.time[:, part]
        outputs[f"{name}_censored"] = results.censored[:, part]
        outputs[f"{name}_error"] = results.error[:, part]
    p: Any = GapWearParameters._make(np.ascontiguousarray(x.T))
    if settings.instants:
        worn, grown = results.worn, results.worn + results.drifted
        outputs["worn_depth"] = worn / (1 + p.support_wear_ratio)[:, None]
        outputs["gap"] = gap_when_new(p)[:, None] + grown
        share = np.full_like(worn, np.nan)
        outputs["wear_share"] = np.divide(worn, grown, out=share, where=grown > 0)
    refused = _never_opened(p, settings)
    for name in outputs:
        if not name.endswith("_censored"):
            outputs[name][refused] = np.nan
    status = np.where(refused, np.int8(Status.NON_FINITE), results.status)
    return outputs, status, dict.fromkeys(np.flatnonzero(refused).tolist(), _PRELOADED)


def _never_opened(p: Any, settings: GapWearSettings) -> NDArray[np.bool_]:
    """Return the mask of preloaded gaps that nothing can open."""
    offsets = [value for state in settings.duty for key, value in state if key == "gap_offset"]
    if settings.gap_history or any(float(offset) > 0 for offset in offsets):
        return np.zeros(len(p.initial_gap), bool)
    return np.asarray((p.preload_deflection > 0) & (p.creep_down == 0) & (p.relaxed_share == 1))
