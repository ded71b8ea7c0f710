"""From standstill to the outcome: the fast way for rigid machines.

The averaged theory proposes the synchronous motion, Newton's method finds it as a periodic orbit,
and the run-up only has to show whether it is reached: it stops as soon as the disphasing angle
stays near that of a stable orbit, and otherwise continues to the end. Free vibration of the body
dies away more slowly: the run also waits until it can no longer exceed the largest displacement.
"""

from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.vibrator.equations.time_scales import slowest_period
from models.vibrator.lanes.fixed_steps import advance
from models.vibrator.lanes.machines import Machines, prepared, start
from models.vibrator.lanes.notes import ANGLE_HIGH, ANGLE_LOW, EXCURSION, LAST_ENTRY
from models.vibrator.lanes.packed import Array
from models.vibrator.lanes.steps import STABLE
from models.vibrator.parameters import Rows, Settings
from models.vibrator.start.instants import note_fast
from models.vibrator.start.last_second import LAST, NEAR, STEPS, Live, learn, run_last_second
from models.vibrator.start.regimes import (
    BAND,
    CAPTURED_BELOW,
    COMPARABLE,
    Outcome,
    locked_regime,
)
from models.vibrator.start.synchronous import SynchronousOrbits, describe, propose
from uq.contract import Status

LOOK = 96  # steps between two looks at a run
BUDGET = 1000  # looks
_STEADY = 0.02  # range of the disphasing angle in a look below which a search is worth while [rad]
_RUNS = 3  # of a machine, each towards an orbit found in the one before


class _Plan(NamedTuple):
    """How n machines are run.

    Attributes
    ----------
    step : ndarray, shape (n,)
        [s]
    looks : ndarray of int, shape (n,)
        Until the start of the last second.
    over : ndarray of bool, shape (n,)
        Whether the budget ends the run before its time.
    """

    step: Array
    looks: NDArray[np.int64]
    over: NDArray[np.bool_]

    @staticmethod
    def made(machines: Machines, settings: Settings) -> "_Plan":
        """Choose steps that are short enough and divide the time into whole looks."""
        per_turn = settings.steps_per_turn or STEPS
        turn = 2 * np.pi / machines.synchronous_speed.max(axis=1)
        step = np.minimum(turn / per_turn, STABLE / machines.fastest)
        time = settings.run_up - LAST
        looks = np.ceil(time / (LOOK * step)).astype(np.int64)
        over = looks > BUDGET
        step = np.where(over | (looks == 0), step, time / (LOOK * np.maximum(looks, 1)))
        return _Plan(step, np.minimum(looks, BUDGET), over)


def outcomes(p: Rows, settings: Settings) -> tuple[Outcome, NDArray[np.int8]]:
    """Switch on n rigid machines and find their outcomes.

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
    machines = prepared(p)
    synchronous = propose(machines, settings.steps_per_turn)
    plan = _Plan.made(machines, settings)
    n = len(synchronous.exists)
    out, status = Outcome.nothing(n, len(settings.instants)), np.full(n, Status.OK, np.int8)
    rows = np.arange(n)
    for run in range(_RUNS):
        final = run == _RUNS - 1
        rows = _run(machines, plan, synchronous, rows, out, settings, final)
    lost = ~np.isfinite(out.speed)
    out.regime[lost] = -1
    status[lost] = Status.NON_FINITE
    unfinished = plan.over & np.isinf(out.synchronisation_time) & np.isnan(out.disphasing) & ~lost
    status[unfinished] = Status.OUT_OF_BUDGET
    out.censored[:] |= unfinished
    reached = plan.step * plan.looks * LOOK + LAST
    out.synchronisation_time[unfinished] = reached[unfinished]
    status[np.isnan(out.on_the_way).any(axis=(1, 2)) & ~lost] = Status.OUT_OF_BUDGET
    return out, status


def _run(
    machines: Machines,
    plan: _Plan,
    synchronous: SynchronousOrbits,
    rows: NDArray[np.intp],
    out: Outcome,
    settings: Settings,
    final: bool,
) -> NDArray[np.intp]:
    """Run machines from standstill; return those to run again, towards another orbit.

    After a final run there are none.
    """
    again = [np.empty(0, np.intp)]
    part, n = machines.take(rows), len(rows)
    live = Live(rows, part, start(part), *np.zeros((3, n)))
    ending = plan.looks[rows] == 0
    note = partial(note_fast, plan.step, settings, out)
    look = 0
    while len(live.rows):
        if ending.any():
            last = live.take(ending)
            time = look * LOOK * plan.step[last.rows]
            note(last, time, time + LAST * (1 + 1e-9))
            elsewhere = run_last_second(last, time, synchronous, out, settings, final)
            again.append(last.rows[elsewhere])
            live = live.take(~ending)
            if not len(live.rows):
                break
        before = live.state[:, 3:5].copy()
        step, target = plan.step[live.rows], synchronous.disphasing[live.rows]
        note(live, look * LOOK * step, (look + 1) * LOOK * step)
        accurate = settings.steps_per_turn > 0
        notes = advance(live.machines, live.state, step, target, LOOK, BAND, accurate)
        came = notes[:, LAST_ENTRY]
        far = np.maximum(live.far, notes[:, EXCURSION])
        near = notes[:, EXCURSION] > COMPARABLE**2 * far
        live = live._replace(
            came=np.where(came >= 0, (look * LOOK + came) * step, live.came),
            far=far,
            neared=np.where(near, (look + 1) * LOOK * step, live.neared),
        )
        look += 1
        speed = (live.state[:, 3:5] - before) / (LOOK * step)[:, None]
        low, high = notes[:, ANGLE_LOW], notes[:, ANGLE_HIGH]
        finite = np.isfinite(live.state).all(axis=1)
        arrived = finite & _is_near(synchronous, live.rows, low, high, speed)
        calm = look * LOOK * step - live.neared >= slowest_period(live.machines.rigid)
        done = arrived & (calm | (plan.looks[live.rows] <= look))
        _note_locked(synchronous, live.take(done), out)
        note(live.take(done), (look * LOOK * step)[done], (BUDGET * LOOK * step)[done])
        going = finite & ~done
        if not final and look & (look - 1) == 0:
            fast = (speed >= CAPTURED_BELOW * live.machines.synchronous_speed).all(axis=1)
            waiting = going & ~arrived & fast & (high - low < _STEADY)
            if waiting.any():
                steady = live.take(waiting)
                is_new = learn(steady.machines, steady.state, steady.rows, synchronous, settings)
                again.append(steady.rows[is_new])
                going[np.flatnonzero(waiting)[is_new]] = False
        ending = (plan.looks[live.rows] <= look)[going]
        live = live.take(going)
    return np.concatenate(again)


def _is_near(
    synchronous: SynchronousOrbits, rows: Any, low: Array, high: Array, speed: Array
) -> Any:
    """Return which machines have stayed so near to a stable orbit that they will not leave it."""
    target = synchronous.disphasing[rows]
    with np.errstate(invalid="ignore"):
        turns = 2 * np.pi * np.round(((low + high) / 2 - target) / (2 * np.pi))
        off = np.maximum(np.abs(low - turns - target), np.abs(high - turns - target))
        ratio = speed * synchronous.orbits.period[rows, None] / (2 * np.pi)
        near = off < NEAR + synchronous.orbits.ripple[rows]
        return synchronous.exists[rows] & near & (np.abs(ratio - 1) < 0.01).all(axis=1)


def _note_locked(synchronous: SynchronousOrbits, live: Live, out: Outcome) -> None:
    rows = live.rows
    describe(live.machines, synchronous.take(rows), out, rows)
    # An angle that leaves the band in one revolution leaves it in every one.
    out.synchronisation_time[rows] = np.where(
        synchronous.orbits.ripple[rows] < BAND, live.came, np.inf
    )
    out.max_excursion[rows] = np.sqrt(live.far)
    out.regime[rows] = locked_regime(synchronous.disphasing[rows])
