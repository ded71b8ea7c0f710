"""The last second of a run that has not reached a known orbit: means, and the regime they show."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.lanes.fixed_steps import advance
from models.vibrator.lanes.machines import Machines
from models.vibrator.lanes.notes import (
    ALPHA_LOW,
    ANGLE,
    ANGLE_HIGH,
    ANGLE_LOW,
    EXCURSION,
    LAST_ENTRY,
    LEFT_LOW,
    POWER_1,
    POWER_2,
    RIGHT_LOW,
    SUMS,
)
from models.vibrator.lanes.packed import Array
from models.vibrator.lanes.steps import STABLE
from models.vibrator.parameters import Settings
from models.vibrator.start.regimes import (
    BAND,
    CAPTURED_BELOW,
    Outcome,
    locked_regime,
    unlocked_regime,
    wrapped,
)
from models.vibrator.start.synchronous import SynchronousOrbits, describe, search

LAST = 1.0  # [s]
STEPS = 12  # per turn at synchronous speed, unless the machine is stiff
_CLOSELY = 48  # per turn in the last second, whose extremes are those of the steps
NEAR = 0.03  # of the expected disphasing angle: the same motion [rad]
_LOCKED = 0.2  # range of the disphasing angle below which an orbit is searched for [rad]
_LONGEST = 1 << 20  # steps


class Live(NamedTuple):
    """The machines that are still running.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
    machines : Machines
    state : ndarray, shape (n, 10)
    came : ndarray, shape (n,)
        When the disphasing angle last entered its band [s].
    far : ndarray, shape (n,)
        Largest squared displacement of C so far [m2].
    neared : ndarray, shape (n,)
        When the displacement was last comparable to that [s].
    """

    rows: NDArray[np.intp]
    machines: Machines
    state: Array
    came: Array
    far: Array
    neared: Array

    def take(self, chosen: NDArray[np.bool_]) -> "Live":
        """Return some of them."""
        i = np.flatnonzero(chosen)
        return Live(self.rows[i], self.machines.take(i), *(field[i] for field in self[2:]))


def learn(
    part: Machines,
    state: Array,
    rows: NDArray[np.intp],
    synchronous: SynchronousOrbits,
    settings: Settings,
) -> NDArray[np.bool_]:
    """Search for orbits near the machines' states; return where a new one was found."""
    speed, angle = state[:, 8:10].mean(axis=1), state[:, 3] - state[:, 4]
    other = search(part, speed, angle, np.ones(len(rows), bool), settings.steps_per_turn)
    with np.errstate(invalid="ignore"):
        same = np.abs(wrapped(other.disphasing - synchronous.disphasing[rows])) < NEAR
    new = other.exists & ~same
    synchronous.learn(rows[new], other.take(new))
    return new


def run_last_second(
    live: Live,
    time: Array,
    synchronous: SynchronousOrbits,
    out: Outcome,
    settings: Settings,
    final: bool,
) -> NDArray[np.bool_]:
    """Run the last second; return which machines are locked elsewhere than expected.

    Parameters
    ----------
    live : Live
        Its states are updated in place.
    time : ndarray, shape (n,)
        Time so far [s].
    synchronous : SynchronousOrbits
        Updated where they are locked.
    out : Outcome
        Updated in place.
    settings : Settings
    final : bool
        Whether this is the last run: where a machine then locks elsewhere than expected, it is not
        known when.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    part, state, rows = live.machines, live.state, live.rows
    turn = 2 * np.pi / part.synchronous_speed.max(axis=1)
    per_turn = settings.steps_per_turn or _CLOSELY
    needed = LAST * np.maximum(per_turn / turn, part.fastest / STABLE)
    part_of_two, power = np.frexp(np.minimum(needed, _LONGEST))
    steps = 2 ** (power - (part_of_two == 0.5)).astype(np.int64)
    again = np.zeros(len(rows), bool)
    for count in np.unique(steps).tolist():
        i = np.flatnonzero(steps == count)
        group, here, these = part.take(i), state[i], rows[i]
        before = here[:, 3:5].copy()
        first = here[:, 3] - here[:, 4]
        h = np.full(len(i), LAST / count)
        target, accurate = synchronous.disphasing[these], settings.steps_per_turn > 0
        notes = advance(group, here, h, target, count, BAND, accurate)
        speed = (here[:, 3:5] - before) / LAST
        notes[:, :SUMS] /= count
        _note_means(these, notes, speed, group, out)
        out.max_excursion[these] = np.sqrt(np.maximum(live.far[i], notes[:, EXCURSION]))
        last = notes[:, LAST_ENTRY]
        inside = np.where(last >= 0, time[i] + last * LAST / count, live.came[i])
        low, high = notes[:, ANGLE_LOW], notes[:, ANGLE_HIGH]
        fast = (speed >= CAPTURED_BELOW * group.synchronous_speed).all(axis=1)
        locked = np.flatnonzero(fast & (high - low < _LOCKED))
        new = learn(group.take(locked), here[locked], these[locked], synchronous, settings)
        if not final:
            again[i[locked]] = new
            locked, new = locked[~new], new[~new]
        where, mean = these[locked], wrapped(notes[locked, ANGLE])
        target = synchronous.disphasing[where]
        with np.errstate(invalid="ignore"):
            off = [
                np.abs(wrapped(angle[locked] - target))
                for angle in (first, here[:, 3] - here[:, 4])
            ]
            near = np.abs(wrapped(mean - target)) < NEAR
            coming = synchronous.exists[where] & ~near & (off[1] < off[0])
        # On its way to no stable orbit: a slow slip, or a synchronous motion that is unstable.
        attracted = synchronous.exists[where] & (near | coming)
        out.regime[where[attracted]] = locked_regime(synchronous.disphasing[where[attracted]])
        late = time[i[locked]] + LAST
        unknown = coming | new
        out.synchronisation_time[where[attracted]] = np.where(unknown, late, inside[locked])[
            attracted
        ]
        out.censored[where[attracted & unknown]] = True
        describe(
            group.take(locked[attracted]), synchronous.take(where[attracted]), out, where[attracted]
        )
    return again


def _note_means(
    rows: NDArray[np.intp], notes: Array, speed: Array, part: Machines, out: Outcome
) -> None:
    """Record the outputs of machines that are not locked, as far as they are known."""

    def half(low: int) -> Array:
        return (notes[:, low + 1] - notes[:, low]) / 2

    out.power_1[rows], out.power_2[rows] = (
        notes[:, POWER_1],
        notes[:, POWER_2],
    )
    out.angular_amplitude[rows] = half(ALPHA_LOW)
    out.stroke_left[rows], out.stroke_right[rows] = (
        half(LEFT_LOW),
        half(RIGHT_LOW),
    )
    out.speed[rows] = speed.mean(axis=1)
    out.synchronisation_time[rows] = np.inf
    out.regime[rows] = unlocked_regime(*speed.T, *part.synchronous_speed.T)
