"""From standstill to the outcome: the fast road for rigid machines.

The averaged theory proposes the synchronous motion, Newton's method finds it as a periodic orbit,
and the run-up only has to tell whether it is reached: it stops as soon as the disphasing angle
stays near that of a stable orbit, and goes on to the end where it does not.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator import lanes
from models.vibrator.equations import initial_state
from models.vibrator.lanes import Array
from models.vibrator.outcome import (
    BAND,
    CAPTURED_BELOW,
    Outcome,
    locked_regime,
    unlocked_regime,
    wrapped,
)
from models.vibrator.parameters import Rows, Settings
from models.vibrator.synchronous import Known, Machines, describe, propose, search
from uq.contract import Status

STEPS = 12  # in a turn at synchronous speed, unless the machine is stiff
LOOK = 96  # steps between two looks at a run
BUDGET = 4000  # looks
_NEAR = 0.03  # of the orbit's disphasing angle: certain to stay [rad]
_STEADY = 0.02  # range of the disphasing angle in a look that is worth a search for an orbit [rad]
_LOCKED = 0.2  # range in the last second below which motors are locked [rad]
_LAST = 1.0  # [s]
_RUNS = 3  # of a machine, each towards an orbit that the one before has shown
_LONGEST_LAST = 1 << 20  # steps of the last second


class _Plan(NamedTuple):
    """How n machines are run.

    Attributes
    ----------
    step : ndarray, shape (n,)
        [s]
    looks : ndarray of int, shape (n,)
        Until the last second begins.
    over : ndarray of bool, shape (n,)
        Whether the budget ends the run before its time.
    """

    step: Array
    looks: NDArray[np.int64]
    over: NDArray[np.bool_]

    @staticmethod
    def made(machines: Machines, settings: Settings) -> "_Plan":
        """Choose steps that are short enough, and fill the time in whole looks."""
        per_turn = settings.steps_per_turn or STEPS
        turn = 2 * np.pi / machines.synchronous_speed.max(axis=1)
        step = np.minimum(turn / per_turn, lanes.STABLE / machines.fastest)
        time = settings.run_up - _LAST
        looks = np.ceil(time / (LOOK * step)).astype(np.int64)
        over = looks > BUDGET
        step = np.where(over | (looks == 0), step, time / (LOOK * np.maximum(looks, 1)))
        return _Plan(step, np.minimum(looks, BUDGET), over)


def outcomes(p: Rows, settings: Settings) -> tuple[Outcome, NDArray[np.int8]]:
    """Switch on n rigid machines and see what becomes of them.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,); mounts rigid, no feed, small kinematics.
    settings : Settings

    Returns
    -------
    outcome : Outcome
    status : ndarray of int8, shape (n,)
    """
    machines = Machines.prepared(p)
    known = propose(machines, settings.steps_per_turn)
    plan = _Plan.made(machines, settings)
    n = len(known.found)
    out, status = Outcome.nothing(n), np.full(n, Status.OK, np.int8)
    rows = np.arange(n)
    for _ in range(_RUNS):
        rows = _run(machines, plan, known, rows, out, status, settings)
        if not len(rows):
            break
    unfinished = plan.over & np.isinf(out.synchronisation_time)
    status[unfinished] = Status.OUT_OF_BUDGET
    out.censored[:] = unfinished
    reached = plan.step * plan.looks * LOOK + _LAST
    out.synchronisation_time[unfinished] = reached[unfinished]
    return out, status


def _run(
    machines: Machines,
    plan: _Plan,
    known: Known,
    rows: NDArray[np.intp],
    out: Outcome,
    status: NDArray[np.int8],
    settings: Settings,
) -> NDArray[np.intp]:
    """Run machines from standstill; return those to be run again, towards another orbit."""
    again = []
    part, left = machines.take(rows), rows
    state = initial_state(part.p)
    came, far = np.zeros(len(rows)), np.zeros(len(rows))
    look = 0
    while len(left):
        ending = plan.looks[left] <= look
        if ending.any():
            e = np.flatnonzero(ending)
            some = left[e]
            found = _end(part.take(e), state[e], came[e], far[e], some, known, out, settings)
            again.append(some[found])
            g = np.flatnonzero(~ending)
            part, left, state, came, far = part.take(g), left[g], state[g], came[g], far[g]
            continue
        before = state[:, 3:5].copy()
        step = plan.step[left]
        notes = lanes.advance(part.constants, step, state, known.disphasing[left], LOOK, BAND)
        last = notes[:, lanes.LAST_OUT]
        came = np.where(last >= 0, (look * LOOK + last) * step, came)
        far = np.maximum(far, notes[:, lanes.EXCURSION])
        look += 1
        speed = (state[:, 3:5] - before) / (LOOK * step)[:, None]
        low, high = notes[:, lanes.ANGLE_LOW], notes[:, lanes.ANGLE_HIGH]
        finite = np.isfinite(state).all(axis=1)
        arrived = finite & _is_near(known, left, low, high, speed)
        _note_locked(machines, known, left[arrived], came[arrived], far[arrived], out)
        status[left[~finite]] = Status.NON_FINITE
        going = finite & ~arrived
        if look >= 8 and look & (look - 1) == 0:
            fast = (speed >= CAPTURED_BELOW * part.synchronous_speed).all(axis=1)
            waiting = np.flatnonzero(going & fast & (high - low < _STEADY))
            found = _learn(part, state, waiting, left, known, settings)
            again.append(left[waiting[found]])
            going[waiting[found]] = False
        if not going.all():
            g = np.flatnonzero(going)
            part, left, state, came, far = part.take(g), left[g], state[g], came[g], far[g]
    return np.concatenate([np.empty(0, np.intp), *again])


def _is_near(known: Known, rows: Any, low: Array, high: Array, speed: Array) -> Any:
    """Tell which machines have stayed so near a stable orbit that they will not leave it."""
    target = known.disphasing[rows]
    with np.errstate(invalid="ignore"):
        turns = 2 * np.pi * np.round(((low + high) / 2 - target) / (2 * np.pi))
        off = np.maximum(np.abs(low - turns - target), np.abs(high - turns - target))
        ratio = speed * known.orbits.period[rows, None] / (2 * np.pi)
        return known.found[rows] & (off < _NEAR) & (np.abs(ratio - 1) < 0.01).all(axis=1)


def _note_locked(
    machines: Machines, known: Known, rows: Any, came: Array, far: Array, out: Outcome
) -> None:
    describe(machines, known, rows, out)
    out.synchronisation_time[rows] = came
    out.max_excursion[rows] = np.sqrt(far)
    out.regime[rows] = locked_regime(known.disphasing[rows])


def _learn(
    part: Machines, state: Array, waiting: Any, left: Any, known: Known, settings: Settings
) -> NDArray[np.bool_]:
    """Search for the orbit near which machines are; tell where there is a new one."""
    speed = state[waiting, 8:10].mean(axis=1)
    angle = state[waiting, 3] - state[waiting, 4]
    wanted = np.ones(len(waiting), bool)
    other = search(part.take(waiting), speed, angle, wanted, settings.steps_per_turn)
    rows = left[waiting]
    with np.errstate(invalid="ignore"):
        same = np.abs(wrapped(other.disphasing - known.disphasing[rows])) < _NEAR
    new = other.found & ~same
    known.learn(rows[new], other.take(new))
    return new


def _end(
    part: Machines,
    state: Array,
    came: Array,
    far: Array,
    rows: NDArray[np.intp],
    known: Known,
    out: Outcome,
    settings: Settings,
) -> NDArray[np.bool_]:
    """Run the last second; tell which machines turned out to be locked near a new orbit."""
    turn = 2 * np.pi / part.synchronous_speed.max(axis=1)
    per_turn = settings.steps_per_turn or STEPS
    needed = _LAST * np.maximum(per_turn / turn, part.fastest / lanes.STABLE)
    steps = 2 ** np.ceil(np.log2(np.minimum(needed, _LONGEST_LAST))).astype(np.int64)
    new = np.zeros(len(rows), bool)
    for count in np.unique(steps).tolist():
        i = np.flatnonzero(steps == count)
        some, here = part.take(i), state[i]
        before = here[:, 3:5].copy()
        h = np.full(len(i), _LAST / count)
        notes = lanes.advance(some.constants, h, here, known.disphasing[rows[i]], count, BAND)
        mean = (here[:, 3:5] - before) / _LAST
        low, high = notes[:, lanes.ANGLE_LOW], notes[:, lanes.ANGLE_HIGH]
        fast = (mean >= CAPTURED_BELOW * some.synchronous_speed).all(axis=1)
        locked = np.flatnonzero(fast & (high - low < _LOCKED))
        new[i[locked]] = _learn(some, here, locked, rows[i], known, settings)
        _note_unlocked(rows[i], notes / [count, count, *[1] * (lanes.NOTES - 2)], mean, some, out)
        out.max_excursion[rows[i]] = np.sqrt(np.maximum(far[i], notes[:, lanes.EXCURSION]))
    return new


def _note_unlocked(
    rows: NDArray[np.intp], notes: Array, speed: Array, part: Machines, out: Outcome
) -> None:
    def half(low: int) -> Array:
        return (notes[:, low + 1] - notes[:, low]) / 2

    out.power_1[rows], out.power_2[rows] = notes[:, lanes.POWER_1], notes[:, lanes.POWER_2]
    out.angular_amplitude[rows] = half(lanes.ALPHA_LOW)
    out.stroke_left[rows], out.stroke_right[rows] = half(lanes.LEFT_LOW), half(lanes.RIGHT_LOW)
    out.speed[rows] = speed.mean(axis=1)
    out.synchronisation_time[rows] = np.inf
    out.regime[rows] = unlocked_regime(*speed.T, *part.synchronous_speed.T)
