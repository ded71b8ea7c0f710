"""Synchronous running of any vibrator as a periodic orbit: shooting with the exact propagator.

The Poincaré map P takes a state on the section psi_1 = 0 to the state after one turn of vibrator 1.
A fixed point, with psi_2 also turned once, is a periodic orbit; the eigenvalues of dP are the
Floquet multipliers except the trivial 1. The derivative is taken by central differences.

Coordinates that cannot vary are left out of P: those of rigid mounts and, if the feed rides at
psi_1 = 0, its height. If it flies there, its height and its rate are included. The flight may
then begin or end at any other phase: P is smooth as long as the same events occur in the same
order.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.dop853 import GUARDED
from models.numerics.linear import solve
from models.numerics.multipliers import log_radius
from models.vibrator.exact import lag
from models.vibrator.exact.budgeted import PSI_1, PSI_2, Machine
from models.vibrator.exact.measures import Measures, first_harmonic, measure
from models.vibrator.theory import averaged

TIGHTEST = 1e-11  # tolerance of orbits, if that of the runs is looser
SAMPLES = 2048  # of an orbit: impacts of the feed cause errors of up to 1e-4 in the mean powers
_ITERATIONS, _DERIVATIVES = 15, 4  # at most
_ROUGH = 1e-8  # tolerance that suffices for the derivative in a search
_NUDGE = 1e-4  # of central differences, in units of the propagator's scales
_CLOSE, _STALLED = 1e-9, 1e-6  # last step: below the first, or stalled below the second
_BOLDEST = 0.5  # longest step of psi_2 and of log(speed)
_SLOWEST = 5.0  # longest turn tried, in turns at the guessed speed


class Orbit(NamedTuple):
    """Synchronous running.

    Attributes
    ----------
    state : ndarray
        At psi_1 = 0.
    period : float
        [s]
    multiplier : float
        Largest modulus of the Floquet multipliers except the trivial 1.
    measures : Measures
        Over one revolution, disphasing in (-pi, pi], amplitude of the first harmonic of alpha.
    ripple : float
        Largest deviation of psi_1 - psi_2 from its mean [rad].
    """

    state: NDArray[np.float64]
    period: float
    multiplier: float
    measures: Measures
    ripple: float


def proposal(machine: Machine) -> NDArray[np.float64] | None:
    """Return the state at psi_1 = 0 of the synchronous running predicted by the averaged theory.

    None if no stable one exists. The feed rides.
    """
    guess = averaged.disphasing(machine.params)
    if not guess.stable[0]:
        return None
    w = float(guess.speed[0])
    motion = averaged.steady_motion(machine.params, guess.speed, guess.angle)
    state = np.zeros(2 * machine.degrees)
    places = (0, 1, 2, 5, 6) if machine.is_extended else (0, 1, 2)
    for i, amplitude in zip(places, motion, strict=False):
        state[i], state[machine.degrees + i] = amplitude[0].real, -w * amplitude[0].imag
    state[PSI_2] = -guess.angle[0]
    state[machine.degrees + PSI_1] = state[machine.degrees + PSI_2] = w
    if machine.system.torque_lag:
        state[-2:] = lag.start_torques(machine.system, w)
    return state


def anchored(machine: Machine, state: NDArray[np.float64], tolerance: float) -> NDArray[np.float64]:
    """Return the state when psi_1 is next a multiple of 2 pi, with whole turns subtracted."""
    state = state.copy()
    part = 1 - (state[PSI_1] / (2 * np.pi)) % 1
    machine.run(state, _longest_turn(machine, state), tolerance, part)
    state[PSI_2] -= 2 * np.pi * np.round(state[PSI_2] / (2 * np.pi))
    state[PSI_1] = 0.0
    return state


def find_orbit(machine: Machine, guess: NDArray[np.float64], tolerance: float) -> Orbit | None:
    """Find the periodic orbit near a guess, by Newton's method.

    The derivative of P is renewed only where steps no longer shrink fast enough.

    Parameters
    ----------
    machine : Machine
    guess : ndarray
        State at psi_1 = 0.
    tolerance : float
        See `models.vibrator.exact.propagator.propagate`; tightened to `TIGHTEST`.

    Returns
    -------
    Orbit or None
        None if the search does not converge, or takes more than half the machine's budget.
    """
    tolerance = min(tolerance, TIGHTEST)
    kept = machine.budget // 2
    machine.budget -= kept
    fixed = _fixed_point(machine, guess, tolerance)
    orbit = None if fixed is None else _describe(machine, fixed, tolerance)
    machine.budget += kept
    return orbit


def _longest_turn(machine: Machine, state: NDArray[np.float64]) -> float:
    speed = max(state[machine.degrees + PSI_1], 1e-2 * machine.system.rigid.synchronous_speed_1)
    return _SLOWEST * 2 * np.pi / speed


def _revolved(
    machine: Machine, state: NDArray[np.float64], tolerance: float
) -> tuple[NDArray[np.float64], float] | None:
    """Return the state after one turn of vibrator 1, with the turn subtracted, and its duration."""
    end = state.copy()
    ended, _ = machine.run(end, _longest_turn(machine, state), tolerance, 1.0)
    if ended.status != GUARDED or not np.isfinite(end).all():
        return None
    end[PSI_1] = 0.0
    end[PSI_2] -= 2 * np.pi
    return end, ended.time


def _derivative(
    machine: Machine, state: NDArray[np.float64], free: NDArray[np.intp], tolerance: float
) -> NDArray[np.float64] | None:
    """Return the derivative of P in units of the scales."""
    scales = machine.scales[free]
    matrix = np.empty((len(free), len(free)))
    for column, i in enumerate(free):
        ends = []
        for side in (1.0, -1.0):
            nudged = state.copy()
            nudged[i] += side * _NUDGE * machine.scales[i]
            revolved = _revolved(machine, nudged, tolerance)
            if revolved is None:
                return None
            ends.append(revolved[0][free])
        matrix[:, column] = (ends[0] - ends[1]) / (2 * _NUDGE * scales)
    return matrix


def _fixed_point(
    machine: Machine, guess: NDArray[np.float64], tolerance: float
) -> NDArray[np.float64] | None:
    state, matrix, before = guess, None, math.inf
    riding, derivatives = machine.rides(state), 0
    for _ in range(_ITERATIONS):
        revolved = _revolved(machine, state, tolerance)
        if revolved is None:
            return None
        end, _ = revolved
        if machine.rides(end) != riding:
            # Newton's method must know whether P includes the feed's height.
            state, riding, matrix = end, not riding, None
            continue
        free = machine.free(riding)
        scales = machine.scales[free]
        if matrix is None:
            if derivatives == _DERIVATIVES:
                return None
            matrix = _derivative(machine, state, free, max(tolerance, _ROUGH))
            derivatives += 1
            if matrix is None:
                return None
            before = math.inf
        left = np.eye(len(free)) - matrix
        steps, regular = solve(left[None], ((end - state)[free] / scales)[None, :, None])
        if not regular[0]:
            return None
        step = steps[0, :, 0]
        size = float(np.abs(step).max())
        bold = np.abs(step[np.isin(free, [PSI_2, machine.degrees + PSI_1])]).sum()
        state = state.copy()
        state[free] += step * scales * min(1.0, _BOLDEST / max(bold, _CLOSE))
        if size < _CLOSE or (size < _STALLED and size > 0.3 * before):
            return state
        if size > 0.1 * before:
            matrix = None
        before = size
    return None


def _describe(machine: Machine, state: NDArray[np.float64], tolerance: float) -> Orbit | None:
    matrix = _derivative(machine, state, machine.free(machine.rides(state)), tolerance)
    revolved = _revolved(machine, state, tolerance)
    if matrix is None or revolved is None:
        return None
    period = revolved[1]
    interval = period / SAMPLES
    _, samples = machine.run(
        state.copy(), period, tolerance, times=interval * np.arange(SAMPLES + 1)
    )
    if not np.isfinite(samples).all():
        return None
    measures = measure(machine.system, samples, interval)
    dphi = samples[:, PSI_1] - samples[:, PSI_2]
    mean = math.remainder(measures.disphasing, 2 * np.pi)
    return Orbit(
        state,
        period,
        math.exp(log_radius(matrix[None])[0]),
        measures._replace(
            disphasing=np.pi if mean == -np.pi else mean,
            angular_amplitude=first_harmonic(samples[:-1, 2]),
        ),
        float(np.abs(dphi - measures.disphasing).max()),
    )
