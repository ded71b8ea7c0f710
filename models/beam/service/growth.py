"""Wear of two gaps in service: the equations as kernels of the integrator of slow time.

The work-rates come from settled responses of many beams at a time, while the integrator follows one
row after another. So a row is integrated again and again: it reads the responses that it asked for
before, in the same order, and stops at the first that is missing. Integrating anew takes
microseconds a step, a response milliseconds.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.parameters import FACTORS
from models.beam.service.work_maps import mapped_work
from models.numerics import duty as duty_states
from models.numerics.duty import OFFSET, TIME, WEAR, end_of_state, offset_of_state
from models.numerics.gap_drift import drift, drift_clock, drift_falls, drift_passes, next_kink
from models.numerics.jit import kernel
from models.numerics.scars import oxide_volume, scar_depth
from models.numerics.slow_time import integrator
from models.numerics.wear_laws.worn import wear_clock, wear_rate

FORCE, FREQUENCY, RANDOM_LEVEL = range(duty_states.FACTORS, duty_states.FACTORS + len(FACTORS))
"""Columns of a duty."""

USED, AVAILABLE, IS_MISSING = range(3)
"""Entries of `Rod.cursor`: responses read so far, and available; whether one was missing."""

_EXTINCT = 1e-6  # of the largest work-rate: wear ends below it, near the free amplitude
_NEAR = 1.01  # bound of the free displacement over a gap that is near it


class Rod(NamedTuple):
    """One row, in SI units; symbols as in `models.beam.service`.

    Attributes
    ----------
    gap, coefficient : ndarray, shape (2,)
        X_i0 and k_i.
    kappa, factor, power, tilt : float
        kappa; B, p; theta L_s of an inclined bar, inf for other scars.
    depths, growths : ndarray, shape (D,), (G,)
    drift : ndarray, shape (7,)
    history : ndarray, shape (2, k)
    laws : ndarray, shape (l, 1 + MOST)
    oxide, oxide_factor : float
        Volume of a site's scar in both bodies when the rod's is as deep as delta_ox [m3]; psi_ox.
    duty : ndarray, shape (s, 6)
    in_sequence : bool
    reach : ndarray, shape (s,)
        Bound of the tip's displacement without contact in each state.
    work, noise : ndarray, shape (R, s, 2)
        Work-rates of the responses, and their standard errors.
    cursor : ndarray of int, shape (3,)
    at : ndarray, shape (1 + 2 s,)
        Of the missing response: its time, then the gaps of each state, NaN where it is not asked.
    largest : ndarray, shape (1,)
        Largest work-rate read so far.
    map_gap : ndarray, shape (s, 2)
        Least gaps that are mapped; inf for a state whose work-rates are not.
    map_growth : float
        Growth of each gap up to which they are.
    map_terms : ndarray, shape (s, 2, TERMS)
    """

    gap: NDArray[np.float64]
    coefficient: NDArray[np.float64]
    kappa: float
    factor: float
    power: float
    tilt: float
    depths: NDArray[np.float64]
    growths: NDArray[np.float64]
    drift: NDArray[np.float64]
    history: NDArray[np.float64]
    laws: NDArray[np.float64]
    oxide: float
    oxide_factor: float
    duty: NDArray[np.float64]
    in_sequence: bool
    reach: NDArray[np.float64]
    work: NDArray[np.float64]
    noise: NDArray[np.float64]
    cursor: NDArray[np.int64]
    at: NDArray[np.float64]
    largest: NDArray[np.float64]
    map_gap: NDArray[np.float64]
    map_growth: float
    map_terms: NDArray[np.float64]


@kernel
def _worn_depth(v, i, p):
    """Return h of a site, the depth of the scar in both bodies together."""
    return scar_depth(v[i], p.factor, p.power, p.tilt)


@kernel
def _coordinates(v, t, state, p, x):
    moved = drift(t, p.drift, p.history) + offset_of_state(state, p.duty, p.in_sequence)
    for i in range(2):
        x[i] = p.gap[i] + _worn_depth(v, i, p) + moved  # Eq. (3)


@kernel
def _may_wear(right, left, s, p):
    """Return whether wear is possible in a state of duty, at its gaps."""
    return p.duty[s, TIME] > 0 and p.duty[s, WEAR] > 0 and max(right, left) > 0


@kernel
def _is_extinct(right, left, used, s, p):
    """Return whether contact is too weak for a greater depth ever to be reached.

    A gap that grows towards the free amplitude approaches it like 1/t, not in finite time.
    """
    strongest = max(p.work[used, s, 0], p.work[used, s, 1])
    p.largest[0] = max(p.largest[0], strongest)
    return strongest <= _EXTINCT * p.largest[0] and p.reach[s] < _NEAR * min(right, left)


@kernel
def _runs_now(s, state, p):
    return not p.in_sequence or s == state % len(p.duty)


@kernel
def _is_mapped(right, left, s, p):
    low, high = p.map_gap[s], p.map_growth
    return 0 <= right - low[0] <= high and 0 <= left - low[1] <= high


@kernel
def _asks(right, left, s, state, p):
    """Return whether a state of duty asks for a response at its gaps."""
    return (
        _runs_now(s, state, p)
        and _may_wear(right, left, s, p)
        and not _is_mapped(right, left, s, p)
    )


@kernel
def _wear(k, work, t, depth, volume, p):
    return wear_rate(k * work, work, t, depth, volume, p.laws)


@kernel
def _rates(v, x, t, state, p, rate, noise):
    rate[0] = rate[1] = 0.0
    base = offset_of_state(state, p.duty, p.in_sequence)
    is_asked = False
    for s in range(len(p.duty)):
        shift = p.duty[s, OFFSET] - base
        is_asked |= _asks(x[0] + shift, x[1] + shift, s, state, p)
    used = p.cursor[USED]
    if is_asked and used == p.cursor[AVAILABLE]:
        rate[0] = rate[1] = np.nan
        if p.cursor[IS_MISSING] == 0:
            p.cursor[IS_MISSING] = 1
            p.at[0] = t
            for s in range(len(p.duty)):
                shift = p.duty[s, OFFSET] - base
                asks = _asks(x[0] + shift, x[1] + shift, s, state, p)
                for i in range(2):
                    p.at[1 + 2 * s + i] = x[i] + shift if asks else np.nan
        return
    if is_asked:
        p.cursor[USED] += 1
    for s in range(len(p.duty)):
        shift = p.duty[s, OFFSET] - base
        if not (_runs_now(s, state, p) and _may_wear(x[0] + shift, x[1] + shift, s, p)):
            continue
        is_mapped = _is_mapped(x[0] + shift, x[1] + shift, s, p)
        if not is_mapped and _is_extinct(x[0] + shift, x[1] + shift, used, s, p):
            continue
        share = 1.0 if p.in_sequence else p.duty[s, TIME]
        for i in range(2):
            if not x[i] + shift > 0:
                continue
            volume = v[i] / (1 + p.kappa)
            depth = _worn_depth(v, i, p) / (1 + p.kappa)  # Eq. (5)
            work, doubt = 0.0, 0.0
            if is_mapped:
                right = (x[0] + shift - p.map_gap[s, 0]) / p.map_growth
                left = (x[1] + shift - p.map_gap[s, 1]) / p.map_growth
                work = mapped_work(right, left, p.map_terms[s, i])
            else:
                work, doubt = p.work[used, s, i], p.noise[used, s, i]
            k = p.coefficient[i] * p.duty[s, WEAR]
            worn = _wear(k, work, t, depth, volume, p)
            more = _wear(k, work + doubt, t, depth, volume, p)
            if v[i] < p.oxide:
                worn, more = worn * p.oxide_factor, more * p.oxide_factor
            rate[i] += share * (1 + p.kappa) * worn  # Eq. (1)
            noise[i] = np.hypot(noise[i], share * (1 + p.kappa) * (more - worn))


@kernel
def _marks(v, x, t, p, mark):
    moved, j = drift(t, p.drift, p.history), 0
    for i in range(2):
        h = _worn_depth(v, i, p)
        for depth in p.depths:
            mark[j] = h / (1 + p.kappa) - depth
            j += 1
    for i in range(2):
        h = _worn_depth(v, i, p)
        for growth in p.growths:
            mark[j] = h + moved - growth
            j += 1
    for i in range(2):
        mark[j] = x[i]
        j += 1


@kernel
def _ends(state, p):
    return end_of_state(state, p.duty) if p.in_sequence else np.inf


@kernel
def _clock(t, p):
    return min(drift_clock(t, p.drift), wear_clock(t, p.laws))


@kernel
def _awakes(v, t, p):
    """Return the earliest time at which there may be contact, or a gap opens or has grown."""
    moved = drift(t, p.drift, p.history)
    gap = p.gap[0] + _worn_depth(v, 0, p), p.gap[1] + _worn_depth(v, 1, p)
    earliest = np.inf
    for s in range(len(p.duty)):
        right, left = gap[0] + p.duty[s, OFFSET], gap[1] + p.duty[s, OFFSET]
        if p.duty[s, TIME] > 0 and p.duty[s, WEAR] > 0:
            is_open = max(right, left) + moved > 0
            # In silence near the free amplitude, wear has ended.
            if is_open and min(right, left) + moved <= p.reach[s] / _NEAR:
                return t
            if not is_open:
                opens = drift_passes(t, -max(right, left), p.drift, p.history)
                earliest = min(earliest, opens)
            else:
                level = p.reach[s] - min(right, left)
                if moved <= level:
                    level = p.reach[s] / _NEAR - min(right, left)
                earliest = min(earliest, drift_falls(t, level, p.drift, p.history))
        for i in range(2):
            opens = drift_passes(t, -gap[i] - p.duty[s, OFFSET], p.drift, p.history)
            if opens > t:
                earliest = min(earliest, opens)
    for i in range(2):
        for growth in p.growths:
            grown = drift_passes(t, growth - _worn_depth(v, i, p), p.drift, p.history)
            if grown > t:
                earliest = min(earliest, grown)
    return earliest


@kernel
def _kinks(t, p):
    return next_kink(t, p.drift, p.history)


@kernel
def _jumps(v, p, level):
    for i in range(2):
        level[i] = p.oxide if v[i] < p.oxide else np.inf


_integrate = integrator(_coordinates, _rates, _marks, _ends, _clock, _awakes, _kinks, _jumps)

_STEPS = 100_000


@kernel
def integrate_rod(
    gap, coefficient, numbers, depths, growths, c, history, laws, duty, in_sequence, reach, work,
    noise, cursor, at, map_gap, map_growth, map_terms, floor, length, end, fate, times,
    errors, instants, volume,
):  # fmt: skip
    """Integrate one row as far as its responses go.

    Parameters
    ----------
    gap, coefficient, depths, growths, c, history, laws, duty, in_sequence, reach, work, noise, at
        As in `Rod`; c is its drift.
    map_gap, map_growth, map_terms
        As in `Rod`.
    numbers : ndarray, shape (6,)
        kappa, B, p, tilt, delta_ox, psi_ox.
    cursor : ndarray of int, shape (3,)
        As in `Rod`; `AVAILABLE` is given.
    floor : ndarray, shape (2,)
    length, end : float
        Relative length of a step, and the last time [s].
    fate, times, errors, instants, volume
        As in `models.numerics.slow_time.integrator`. Events: the depths of the right and of the
        left site, their growths, their opening.

    Returns
    -------
    status : int
    time : float
        Reached [s].
    """
    oxide = oxide_volume(numbers[4], numbers[5], numbers[0], numbers[1], numbers[2], numbers[3])
    p = Rod(
        gap, coefficient, numbers[0], numbers[1], numbers[2], numbers[3], depths, growths, c,
        history, laws, oxide, numbers[5], duty, in_sequence, reach, work, noise, cursor, at,
        np.zeros(1), map_gap, map_growth, map_terms,
    )  # fmt: skip
    cursor[USED], cursor[IS_MISSING] = 0, 0
    v = np.zeros(2)
    ended = _integrate(0.0, end, v, p, length, floor, _STEPS, fate, times, errors, instants, volume)
    return ended.status, ended.time
