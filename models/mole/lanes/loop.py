"""Many moles at a time, each with its own step and with every event located: the hot loop.

All lanes expand their motion into series, which reach as far as the error allows. Guards that fall
through zero on the way are found along the series, and their zeros refined in all lanes at once:
steps end exactly there, and where the relay switches. No step is rejected. A lane whose row is done
takes the next row. Lanes are independent, so a row's bits do not depend on its neighbours.
"""

import math
from collections.abc import Callable

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES, MEASURED, Block
from models.mole.lanes.events import happen, turn_relay
from models.mole.lanes.expand import expand, expand_tangents
from models.mole.lanes.locate import find, refine
from models.mole.lanes.looks import limit_step, look, next_step
from models.mole.lanes.modes import mole_of
from models.mole.lanes.move import move, move_tangents, warm
from models.mole.lanes.rows import GOING, OUT_OF_BUDGET, STUCK, Task, idle, load, unload
from models.mole.lanes.strobe import strobe
from models.numerics.jit import kernel, lean

_DONE = 1 - 1e-12  # of half a control period: the rest is rounding error
_SHORTEST = 1e-15  # s


def propagator(columns: int) -> Callable[..., None]:
    """Return the kernel that propagates rows.

    Parameters
    ----------
    columns : int
        Columns of tangents.

    Returns
    -------
    kernel
        ``propagate(task, block)``, with a `Task` and a `Block`, returns when every row is done.
    """

    @lean
    def propagate(task, block):
        # Unpack tuples before the loop: inside it, every access would be reference-counted.
        y, w, m, ring = block
        table, rows = task.table, task.record.shape[0]
        waiting = running = 0
        for lane in range(LANES):
            load(lane, min(waiting, rows - 1), task, m, y, columns)
            if waiting < rows:
                running += 1
                waiting += 1
            else:
                idle(lane, m)
        while running > 0:
            for lane in range(LANES):
                next_step(lane, m, y)
            expand(m, y, w)
            if columns > 0:
                expand_tangents(m, y, w, columns)
            limit_step(m, w)
            look(m, y, w)
            for lane in range(LANES):
                if m[at.LOOK * LANES + lane] > 0.0:
                    find(lane, m, y, w)
            refine(m, w)
            warm(m, w)
            move(m, y, w)
            if columns > 0:
                move_tangents(m, y, w, columns)
            for lane in range(LANES):
                met, row = int(m[at.MET * LANES + lane]), int(m[at.ROW * LANES + lane])
                ended = m[at.TIME * LANES + lane] >= _DONE * m[at.HALF_PERIOD * LANES + lane]
                over = m[at.TRIALS * LANES + lane] >= task.budget
                stuck = not m[at.STEP * LANES + lane] > _SHORTEST
                if row < 0 or not (met >= 0 or ended or over or stuck):
                    continue
                outcome = GOING
                if met >= 0:
                    happen(met, mole_of(table, row), lane, m, y, columns)
                if ended:
                    turn_relay(mole_of(table, row), lane, m, y)
                    outcome = strobe(lane, task, m, y, ring, columns)
                    stuck |= not abs(y[at.CURRENT * LANES + lane]) < math.inf
                if outcome == GOING and over:
                    outcome = OUT_OF_BUDGET
                if stuck:
                    outcome = STUCK
                if outcome != GOING:
                    unload(lane, task, m, y, columns, outcome)
                    if waiting < rows:
                        load(lane, waiting, task, m, y, columns)
                        waiting += 1
                    else:
                        idle(lane, m)
                        running -= 1

    return propagate


_plain, _with_one, _with_five = propagator(0), propagator(1), propagator(MEASURED)


@kernel
def _run_plain(task, block):
    _plain(task, block)


@kernel
def _run_with_one(task, block):
    _with_one(task, block)


@kernel
def _run_with_five(task, block):
    _with_five(task, block)


_RUNS = {0: _run_plain, 1: _run_with_one, MEASURED: _run_with_five}


def run(task: Task, columns: int) -> None:
    """Propagate rows with 0, 1 or 5 columns of tangents."""
    if len(task.record):
        _RUNS[columns](task, Block.made(columns))
