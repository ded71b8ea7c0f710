"""Wear of one gap: its equations, as kernels of the integrator of slow time.

The numbers of the equations are those of `models.gap_wear.declarations`.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.gap_wear.declarations import FACTORS, GapWearParameters, GapWearSettings
from models.numerics import duty as duty_states
from models.numerics.duty import (
    OFFSET,
    TIME,
    WEAR,
    duty_numbers,
    end_of_state,
    history_numbers,
    offset_of_state,
)
from models.numerics.gap_drift import drift, drift_clock, drift_passes, next_kink
from models.numerics.jit import kernel
from models.numerics.scars import oxide_volume, scar, scar_depth
from models.numerics.slow_time import NEVER, OUT_OF_BUDGET, PENDING, REACHED, integrator
from models.numerics.wear_laws.laws import law_numbers
from models.numerics.wear_laws.worn import wear_clock, wear_rate, wear_threshold
from uq.contract import Status

_WORK_RATE = duty_states.FACTORS + FACTORS.index("work_rate")
_DRIFT = 11  # place of the seven numbers of a drift, at the end of those of a row


class Gap(NamedTuple):
    """One row, in SI units; symbols as in `models.gap_wear.declarations`.

    Attributes
    ----------
    gap, reference, work_rate, exponent, coefficient, kappa : float
        X_i, X_0, U_0, m, k, kappa.
    factor, power, tilt : float
        B, p; theta L_s of an inclined bar, inf for other scars.
    oxide, oxide_factor : float
        Volume of the scar in both bodies when the rod's is as deep as delta_ox [m3]; psi_ox.
    depths, growths : ndarray, shape (D,), (G,)
    drift : ndarray, shape (7,)
    history : ndarray, shape (2, k)
    laws : ndarray, shape (l, 1 + MOST)
    duty : ndarray, shape (s, 4)
    in_sequence : bool
    """

    gap: float
    reference: float
    work_rate: float
    exponent: float
    coefficient: float
    kappa: float
    factor: float
    power: float
    tilt: float
    oxide: float
    oxide_factor: float
    depths: NDArray[np.float64]
    growths: NDArray[np.float64]
    drift: NDArray[np.float64]
    history: NDArray[np.float64]
    laws: NDArray[np.float64]
    duty: NDArray[np.float64]
    in_sequence: bool


@kernel
def _worn_depth(v, p):
    """Return h, the depth of the scar in both bodies together."""
    return scar_depth(v[0], p.factor, p.power, p.tilt)


@kernel
def _coordinates(v, t, state, p, x):
    offset = offset_of_state(state, p.duty, p.in_sequence)
    x[0] = p.gap + _worn_depth(v, p) + drift(t, p.drift, p.history) + offset  # Eq. (3)


@kernel
def _rate(gap, v, t, index, p):
    """Return the volume worn off both bodies per time in a duty state, at its gap."""
    if not gap > 0:
        return 0.0
    work_rate = p.work_rate * p.duty[index, _WORK_RATE]
    work_rate *= math.pow(gap / p.reference, p.exponent)  # Eq. (1)
    depth, volume = _worn_depth(v, p) / (1 + p.kappa), v[0] / (1 + p.kappa)  # Eq. (5)
    rate = p.coefficient * p.duty[index, WEAR] * work_rate
    worn = wear_rate(rate, work_rate, t, depth, volume, p.laws)
    if v[0] < p.oxide:
        worn *= p.oxide_factor
    return (1 + p.kappa) * worn


@kernel
def _rates(v, x, t, state, p, rate, noise):
    if p.in_sequence:
        rate[0] = _rate(x[0], v, t, state % len(p.duty), p)
        return
    gap = x[0] - offset_of_state(state, p.duty, p.in_sequence)
    rate[0] = 0.0
    for i in range(len(p.duty)):
        rate[0] += p.duty[i, TIME] * _rate(gap + p.duty[i, OFFSET], v, t, i, p)


@kernel
def _marks(v, x, t, p, mark):
    h, j = _worn_depth(v, p), 0
    for depth in p.depths:
        mark[j] = h / (1 + p.kappa) - depth
        j += 1
    for growth in p.growths:
        mark[j] = h + drift(t, p.drift, p.history) - growth
        j += 1
    mark[j] = x[0]


@kernel
def _ends(state, p):
    return end_of_state(state, p.duty) if p.in_sequence else np.inf


@kernel
def _clock(t, p):
    return min(drift_clock(t, p.drift), wear_clock(t, p.laws))


@kernel
def _least_gap(index, p):
    """Return the gap above which there is wear in a duty state; inf if there is none at any."""
    at_reference = p.work_rate * p.duty[index, _WORK_RATE]
    if not (p.coefficient * p.duty[index, WEAR] > 0 and p.duty[index, TIME] > 0):
        return np.inf
    threshold = wear_threshold(p.laws)
    if p.exponent == 0 or at_reference == 0:
        return 0.0 if at_reference > threshold else np.inf
    return p.reference * math.pow(threshold / at_reference, 1 / p.exponent)


@kernel
def _awakes(v, t, p):
    h = _worn_depth(v, p)
    worn, opened = np.inf, np.inf
    for i in range(len(p.duty)):
        here = p.gap + h + p.duty[i, OFFSET]
        worn = min(worn, drift_passes(t, _least_gap(i, p) - here, p.drift, p.history))
        opened = min(opened, drift_passes(t, -here, p.drift, p.history))
    if opened > t:
        worn = min(worn, opened)
    for growth in p.growths:
        grown = drift_passes(t, growth - h, p.drift, p.history)
        if grown > t:
            worn = min(worn, grown)
    return worn


@kernel
def _kinks(t, p):
    return next_kink(t, p.drift, p.history)


@kernel
def _jumps(v, p, level):
    level[0] = p.oxide if v[0] < p.oxide else np.inf


_integrate = integrator(_coordinates, _rates, _marks, _ends, _clock, _awakes, _kinks, _jumps)


@kernel
def _run(
    rows, depths, growths, history, laws, duty, in_sequence, accuracy, horizon, budget, instants,
    fate, times, errors, volume, status,
):  # fmt: skip
    v, floor = np.empty(1), np.empty(1)
    for i in range(len(rows)):
        row = rows[i]
        oxide = oxide_volume(row[9], row[10], row[5], row[6], row[7], row[8])
        p = Gap(
            row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], oxide, row[10],
            depths, growths, row[_DRIFT:], history, laws, duty, in_sequence,
        )  # fmt: skip
        v[0] = 0.0
        floor[0] = min(p.reference, (1 + p.kappa) * depths[0])
        if len(growths):
            floor[0] = min(floor[0], growths[0])
        ended = _integrate(
            0.0, horizon, v, p, accuracy, floor, budget,
            fate[i], times[i], errors[i], instants, volume[i],
        )  # fmt: skip
        status[i] = ended.status


class Lives(NamedTuple):
    """Results of n rows.

    Attributes
    ----------
    time : ndarray, shape (n, q)
        To the depths, the growths and the opening [s]; inf for never.
    error : ndarray, shape (n, q)
        Bounds of the errors of the times [s], NaN where these are infinite or censored.
    censored : ndarray of bool, shape (n, q)
    worn, drifted : ndarray, shape (n, k)
        Growth of the gap by wear and by itself at the instants [m].
    status : ndarray of int8, shape (n,)
    """

    time: NDArray[np.float64]
    error: NDArray[np.float64]
    censored: NDArray[np.bool_]
    worn: NDArray[np.float64]
    drifted: NDArray[np.float64]
    status: NDArray[np.int8]


@kernel
def _grown(rows, history, instants, volume, worn, drifted):
    for i in range(len(rows)):
        row = rows[i]
        for k in range(len(instants)):
            drifted[i, k] = drift(instants[k], row[_DRIFT:], history)
            worn[i, k] = np.nan
            if volume[i, k, 0] >= 0:
                worn[i, k] = scar_depth(volume[i, k, 0], row[6], row[7], row[8])


def gap_when_new(p: Any) -> NDArray[np.float64]:
    """Return X_i of n rows; Eq. (4)."""
    return np.where(p.preload_deflection > 0, -p.preload_deflection, p.initial_gap)


def lives(x: NDArray[np.float64], settings: GapWearSettings) -> Lives:
    """Integrate n rows.

    Parameters
    ----------
    x : ndarray, shape (n, d)
        In the order of `GapWearParameters`.
    settings : GapWearSettings
    """
    n = len(x)
    p: Any = GapWearParameters._make(np.ascontiguousarray(x.T))
    shape = scar(
        settings.scar, p.contact_area, p.rod_radius, p.support_width, p.support_radius,
        p.support_inclination,
    )  # fmt: skip
    relaxation = p.preload_deflection * (1 - p.relaxed_share)
    rows = np.stack(
        [
            gap_when_new(p), p.initial_gap, p.work_rate, p.exponent, p.wear_coefficient,
            p.support_wear_ratio, *shape, p.oxide_thickness, p.oxide_wear_factor,
            p.creep_down, p.creep_time, relaxation, p.relaxation_time, p.swelling_rate,
            p.swelling_start, p.gap_history_factor,
        ],
        axis=1,
    )  # fmt: skip
    depths, growths = np.array(settings.depths), np.array(settings.growths, float)
    events = len(depths) + len(growths) + 1
    history = history_numbers(settings.gap_history)
    laws = law_numbers(settings.wear_law, settings.wear_law_numbers)
    duty = duty_numbers(settings.duty, settings.order, FACTORS)
    in_sequence = bool(settings.duty) and settings.order == "sequence"
    instants = np.array(settings.instants, float)
    fate = np.empty((n, events), np.int8)
    time, error = np.empty((2, n, events))
    volume = np.empty((n, len(instants), 1))
    status = np.empty(n, np.int8)
    # The error of the method is of second order in the relative length of steps.
    length = np.sqrt(settings.accuracy)
    _run(
        rows, depths, growths, history, laws, duty, in_sequence, length, settings.horizon,
        settings.step_budget, instants, fate, time, error, volume, status,
    )  # fmt: skip
    unfinished = status == OUT_OF_BUDGET
    pending = fate == PENDING
    time[pending] = settings.horizon
    time[pending & unfinished[:, None]] = np.nan
    time[fate == NEVER] = np.inf
    error[fate != REACHED] = np.nan
    worn, drifted = np.empty((2, n, len(instants)))
    _grown(rows, history, instants, volume, worn, drifted)
    outcome = np.where(unfinished, Status.OUT_OF_BUDGET, Status.OK).astype(np.int8)
    return Lives(time, error, pending, worn, drifted, outcome)
