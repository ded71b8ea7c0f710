"""The synchronous motion of rigid machines: proposed by the averaged theory, found as an orbit."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.vibrator.equations.rigid import Rigid
from models.vibrator.exact.measures import kloss
from models.vibrator.lanes.following import follow
from models.vibrator.lanes.machines import Machines
from models.vibrator.lanes.orbit import Orbits, find_orbits
from models.vibrator.lanes.packed import STATE, Array
from models.vibrator.lanes.steps import STABLE
from models.vibrator.parameters import Rows
from models.vibrator.start.regimes import CAPTURED_BELOW, Outcome, wrapped
from models.vibrator.theory import averaged

STEPS = 24  # of the orbit, unless the machine is stiff
LADDER = tuple(base << k for k in range(7) for base in (24, 36))
ACCURATE = 3e-7  # estimated error of the angle above which steps are halved [rad]
_CLOSE_TO_1 = 2e-3  # multipliers that the length of the steps may carry across 1
_ROUNDING = 1e-8  # of a multiplier
_FINE = 16  # points per step among which extremes are sought


class SynchronousOrbits(NamedTuple):
    """The known stable synchronous motion of n machines.

    Attributes
    ----------
    exists : ndarray of bool, shape (n,)
        Whether one is known.
    orbits : Orbits
    steps : ndarray of int, shape (n,)
        Per revolution, with which they were found.
    disphasing : ndarray, shape (n,)
        Mean disphasing angle in (-pi, pi] [rad], NaN if none is known.
    """

    exists: NDArray[np.bool_]
    orbits: Orbits
    steps: NDArray[np.int64]
    disphasing: Array

    def learn(self, rows: Any, other: "SynchronousOrbits") -> None:
        """Copy the orbits of other machines to `rows`."""
        self.exists[rows], self.steps[rows] = other.exists, other.steps
        self.disphasing[rows] = other.disphasing
        for mine, new in zip(self.orbits, other.orbits, strict=True):
            mine[rows] = new

    def take(self, rows: Any) -> "SynchronousOrbits":
        """Return the orbits of the machines in `rows`."""
        orbits = Orbits._make(field[rows] for field in self.orbits)
        return SynchronousOrbits(self.exists[rows], orbits, self.steps[rows], self.disphasing[rows])


def propose(machines: Machines, steps: int) -> SynchronousOrbits:
    """Find the stable synchronous orbits predicted by the averaged theory.

    Parameters
    ----------
    machines : Machines
    steps : int
        In a revolution, 24 at least; 0 chooses for each machine, as many as are accurate.

    Returns
    -------
    SynchronousOrbits
    """
    theirs = averaged.disphasing(machines.p)
    return search(machines, theirs.speed, theirs.angle, theirs.exists & theirs.stable, steps)


def search(
    machines: Machines, speed: Array, angle: Array, wanted: Any, steps: int
) -> SynchronousOrbits:
    """Find stable synchronous orbits of n machines at working speed, from a guess.

    Parameters
    ----------
    machines : Machines
    speed, angle : ndarray, shape (n,)
        Guess of speed [rad s-1] and disphasing angle [rad].
    wanted : ndarray of bool, shape (n,)
        Where there is a guess.
    steps : int
        In a revolution, 24 at least; 0 chooses for each machine, as many as are accurate.

    Returns
    -------
    SynchronousOrbits
    """
    n = len(speed)
    speed, angle = np.where(wanted, speed, 1.0), np.where(wanted, angle, 0.0)
    state, period = _harmonic(machines.p, speed, angle), 2 * np.pi / speed
    none = Orbits(np.zeros(n, bool), state, period, *np.full((4, n), np.nan))
    synchronous = SynchronousOrbits(
        np.zeros(n, bool), none, np.zeros(n, np.int64), np.full(n, np.nan)
    )
    needed = np.maximum(period * machines.fastest / STABLE, max(steps, STEPS))
    rung = np.array([*LADDER, 0])[np.searchsorted(LADDER, needed)]
    rung = np.where((rung > 0) & (steps > 0) & (needed <= steps), steps, rung)
    rows = np.flatnonzero(wanted & (rung > 0))
    while len(rows):
        for count in np.unique(rung[rows]).tolist():
            group = rows[rung[rows] == count]
            new = _search(machines, group, state, period, count)
            better = new.orbits.converged | ~synchronous.exists[group]
            synchronous.learn(group[better], new.take(better))
        inaccurate = synchronous.exists[rows] & (synchronous.orbits.error[rows] > ACCURATE)
        rows = rows[inaccurate & (steps == 0) & (2 * rung[rows] <= LADDER[-1])]
        state[rows], period[rows] = synchronous.orbits.state[rows], synchronous.orbits.period[rows]
        rung[rows] *= 2
    _confirm(machines, synchronous, np.flatnonzero(wanted))
    return synchronous


def _confirm(machines: Machines, synchronous: SynchronousOrbits, rows: NDArray[np.intp]) -> None:
    """Decide by twice as many steps whether orbits with a multiplier close to 1 are stable.

    The difference of the two multipliers bounds the error of the later one.
    """
    orbits = synchronous.orbits
    with np.errstate(invalid="ignore"):
        rows = rows[orbits.converged[rows] & (np.abs(orbits.multiplier[rows] - 1) < _CLOSE_TO_1)]
    for count in np.unique(synchronous.steps[rows]).tolist():
        close = rows[synchronous.steps[rows] == count]
        fine = _search(machines, close, orbits.state, orbits.period, 2 * count)
        error = np.abs(fine.orbits.multiplier - orbits.multiplier[close])
        sure = fine.exists & (fine.orbits.multiplier + np.maximum(error, _ROUNDING) < 1)
        new = sure & ~synchronous.exists[close]
        synchronous.learn(close[new], fine.take(new))
        synchronous.exists[close[~sure]], synchronous.disphasing[close[~sure]] = False, np.nan


def _search(
    machines: Machines, rows: NDArray[np.intp], state: Array, period: Array, steps: int
) -> SynchronousOrbits:
    """Find the stable synchronous orbits of some machines by this many steps."""
    orbits = find_orbits(machines.constants[rows], state[rows], period[rows], steps)
    slowest = CAPTURED_BELOW * machines.synchronous_speed[rows].max(axis=1)
    fast = 2 * np.pi / orbits.period >= slowest
    exists = orbits.converged & (orbits.multiplier < 1) & fast
    disphasing = np.where(exists, wrapped(orbits.angle), np.nan)
    return SynchronousOrbits(exists, orbits, np.full(len(rows), steps), disphasing)


def _harmonic(p: Rows, speed: Array, angle: Array) -> Array:
    """Return the state at psi_1 = 0 for harmonic motion at constant speed."""
    motion = averaged.steady_motion(p, speed, angle)
    state = np.zeros((len(speed), STATE))
    for i, amplitude in enumerate((motion.x, motion.y, motion.alpha)):
        state[:, i], state[:, 5 + i] = amplitude.real, -speed * amplitude.imag
    state[:, 4] = -angle
    state[:, 8] = state[:, 9] = speed
    return state


def describe(
    machines: Machines, synchronous: SynchronousOrbits, out: Outcome, rows: NDArray[np.intp]
) -> None:
    """Record the outputs of machines on their orbits, where these are known.

    Parameters
    ----------
    machines : Machines
    synchronous : SynchronousOrbits
    out : Outcome
        Updated in place.
    rows : ndarray of int, shape (n,)
        Indices of the n machines in it.
    """
    for count in np.unique(synchronous.steps[synchronous.exists]).tolist():
        i = np.flatnonzero(synchronous.exists & (synchronous.steps == count))
        group, part, orbits = rows[i], machines.take(i), synchronous.take(i).orbits
        trace = follow(part.constants, orbits.state, orbits.period, count)
        alpha, speed = trace[:, :, 2], trace[:, :, 8:10]
        turn = 2 * np.pi * np.arange(1, count + 1) / count
        phase = elementary.cos(turn) - 1j * elementary.sin(turn)
        out.disphasing[group] = synchronous.disphasing[i]
        out.multiplier[group] = orbits.multiplier
        harmonic = 2 * (alpha * phase).mean(axis=1)
        out.angular_amplitude[group] = np.hypot(harmonic.real, harmonic.imag)
        left, right = deck_ends(part.rigid, trace)
        out.stroke_left[group], out.stroke_right[group] = _half_range(left), _half_range(right)
        out.speed[group] = 2 * np.pi / orbits.period
        m = part.rigid
        for power, torque, slip, top, w in (
            (out.power_1, m.torque_1, m.slip_1, m.synchronous_speed_1, speed[:, :, 0]),
            (out.power_2, m.torque_2, m.slip_2, m.synchronous_speed_2, speed[:, :, 1]),
        ):
            lag = top[:, None] - w
            power[group] = (w * kloss(torque[:, None], slip[:, None], lag)).mean(axis=1)


def deck_ends(m: Rigid, trace: Array) -> tuple[Array, Array]:
    """Return the displacements along xi of the left and the right end of the deck [m].

    Parameters
    ----------
    m : Rigid
        n machines.
    trace : ndarray, shape (n, k, 10)
        States.

    Returns
    -------
    left, right : ndarray, shape (n, k)
    """
    cos = elementary.cos(m.working_angle)[:, None]
    sin = elementary.sin(m.working_angle)[:, None]
    along = cos * trace[:, :, 0] + sin * trace[:, :, 1]
    lever = sin * m.half_spacing[:, None] * trace[:, :, 2]
    return along - lever, along + lever


def _half_range(samples: Array) -> Array:
    """Return half the peak-to-peak value of periodic signals by trigonometric interpolation."""
    count = samples.shape[1]
    fine = np.fft.irfft(np.fft.rfft(samples, axis=1), _FINE * count, axis=1) * _FINE
    return np.ptp(fine, axis=1) / 2
