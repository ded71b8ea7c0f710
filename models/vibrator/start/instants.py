"""Speeds and disphasing angle at given instants, read off a run-up without disturbing it."""

import numpy as np
from numpy.typing import NDArray

from models.numerics.dop853 import OUT_OF_BUDGET
from models.vibrator.exact.budgeted import Machine
from models.vibrator.lanes.fixed_steps import advance
from models.vibrator.lanes.machines import Machines
from models.vibrator.lanes.packed import Array
from models.vibrator.parameters import Settings
from models.vibrator.start.last_second import Live
from models.vibrator.start.regimes import Outcome

_STEPS = 96  # or a multiple of it from one instant to the next, for many machines at once


def note_fast(
    step: Array, settings: Settings, out: Outcome, live: Live, begin: Array, end: Array
) -> None:
    """Record n machines at the instants of some time, by steps from their state at its beginning.

    Parameters
    ----------
    step : ndarray
        Longest step of each machine of the run [s].
    settings : Settings
    out : Outcome
        Updated in place.
    live : Live
        Not changed.
    begin, end : ndarray, shape (n,)
        Of the time; its end does not belong to it [s].
    """
    now, state = begin.copy(), live.state.copy()
    for k, instant in enumerate(settings.instants):
        i = np.flatnonzero((now <= instant) & (instant < end))
        if len(i):
            part = live.machines.take(i)
            longest, accurate = step[live.rows[i]], settings.steps_per_turn > 0
            state[i] = _advanced(part, state[i], instant - now[i], longest, accurate)
            now[i] = instant
            out.on_the_way[live.rows[i], k] = _seen(state[i])


def _advanced(machines: Machines, state: Array, time: Array, step: Array, accurate: bool) -> Array:
    """Return the state of n machines after a time, in steps no longer than given."""
    steps = _STEPS * np.maximum(1, np.ceil(time / (_STEPS * step))).astype(np.int64)
    for count in np.unique(steps).tolist():
        i = np.flatnonzero(steps == count)
        part, nowhere = state[i], np.full(len(i), np.nan)
        advance(machines.take(i), part, time[i] / count, nowhere, count, 0.0, accurate)
        state[i] = part
    return state


def run_exactly(
    machine: Machine,
    state: Array,
    begin: float,
    times: Array,
    settings: Settings,
    out: Outcome,
) -> tuple[int, Array]:
    """Advance a machine through sampling times, and record it at the instants on the way.

    Parameters
    ----------
    machine : Machine
    state : ndarray
        At the beginning; advanced in place to the last of the times.
    begin : float
        [s]
    times : ndarray, shape (k,)
        Since the beginning [s].
    settings : Settings
    out : Outcome
        Of this machine, fields of shape (1, ...); updated in place.

    Returns
    -------
    status : int
        Of the integration.
    samples : ndarray, shape (k, d)
        Fewer where it ended early.
    """
    since = np.asarray(settings.instants) - begin
    inside = np.flatnonzero((since > 0) & (since <= times[-1] * (1 + 1e-12)))
    every = np.concatenate([times, np.minimum(since[inside], times[-1])])
    order = np.argsort(every, kind="stable")
    wanted = every[order]
    ended, samples = machine.run(state, times[-1], settings.tolerance, times=wanted, begin=begin)
    taken, samples = order[: ended.sampled], samples[: ended.sampled]
    here = taken >= len(times)
    out.on_the_way[0, inside[taken[here] - len(times)]] = _seen(samples[here])
    return ended.status, samples[~here]


def note_exactly(
    machine: Machine, state: Array, begin: float, settings: Settings, out: Outcome
) -> bool:
    """Record a machine at the instants after a time; return whether its budget suffices."""
    later = [instant - begin for instant in settings.instants if instant > begin]
    if not later:
        return True
    status, _ = run_exactly(machine, state, begin, np.array(later[-1:]), settings, out)
    return status != OUT_OF_BUDGET


def _seen(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return psi_1 - psi_2 and the speeds of both vibrators, for each state."""
    rates = states.shape[1] // 2
    return np.column_stack([states[:, 3] - states[:, 4], states[:, rates + 3 : rates + 5]])
