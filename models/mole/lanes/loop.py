"""Many moles at a time, each with its own step and with every event located: the hot loop.

All lanes expand their motion into series, which reach as far as the error allows. Guards that fall
through zero on the way are found along the series, and their zeros refined in all lanes at once:
steps end exactly there, and where the relay switches. No step is rejected. A lane whose row is done
takes the next row. Lanes are independent, so a row's bits do not depend on its neighbours.
"""

import math
from collections.abc import Callable

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES, MEASURED, OF_SOIL, Block
from models.mole.lanes.events import happen, happen_in_soil, turn_relay
from models.mole.lanes.expand import expansions
from models.mole.lanes.locate import locating
from models.mole.lanes.looks import looks
from models.mole.lanes.modes import mole_of
from models.mole.lanes.move import moves, warm
from models.mole.lanes.rows import GOING, OUT_OF_BUDGET, STUCK, Task, idle, loading
from models.mole.lanes.strobe import strobing
from models.numerics.jit import kernel, lean

_DONE = 1 - 1e-12  # of half a control period: the rest is rounding error
_SHORTEST = 1e-15  # s


def propagator(columns: int, has_soil: bool) -> Callable[..., None]:
    """Return the kernel that propagates rows.

    Parameters
    ----------
    columns : int
        Columns of tangents.
    has_soil : bool
        Whether all rows have soil ahead, or none.

    Returns
    -------
    kernel
        ``propagate(task, block)``, with a `Task` and a `Block`, returns when every row is done.
    """
    expand, expand_tangents = expansions(has_soil)
    limit_step, look, next_step = looks(has_soil)
    find, refine = locating(has_soil)
    move, move_tangents = moves(has_soil)
    load, unload = loading(has_soil)
    strobe = strobing(has_soil)
    change = happen_in_soil if has_soil else happen

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
                next_step(task, lane, m, y)
            expand(m, y, w)
            if columns > 0:
                expand_tangents(m, y, w, columns)
            limit_step(m, w)
            look(m, y, w)
            for lane in range(LANES):
                if m[at.LOOK * LANES + lane] > 0.0:
                    find(lane, m, y, w)
            refine(m, w)
            if task.warms:
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
                    change(met, mole_of(table, row), lane, m, y, columns)
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


_plain, _with_one, _with_all = (propagator(n, False) for n in (0, 1, MEASURED))
_soil_plain, _soil_with_one, _soil_with_all = (
    propagator(n, True) for n in (0, 1, MEASURED + OF_SOIL)
)


@kernel
def _run_plain(task, block):
    _plain(task, block)


@kernel
def _run_with_one(task, block):
    _with_one(task, block)


@kernel
def _run_with_all(task, block):
    _with_all(task, block)


@kernel
def _run_plain_in_soil(task, block):
    _soil_plain(task, block)


@kernel
def _run_with_one_in_soil(task, block):
    _soil_with_one(task, block)


@kernel
def _run_with_all_in_soil(task, block):
    _soil_with_all(task, block)


_RUNS = {
    (0, False): _run_plain,
    (1, False): _run_with_one,
    (MEASURED, False): _run_with_all,
    (0, True): _run_plain_in_soil,
    (1, True): _run_with_one_in_soil,
    (MEASURED + OF_SOIL, True): _run_with_all_in_soil,
}


def run(task: Task, columns: int, has_soil: bool) -> None:
    """Propagate rows, all with soil ahead or all without.

    Parameters
    ----------
    task : Task
    columns : int
        Of tangents: 0, 1, or as many as there are quantities in a tangent.
    has_soil : bool
    """
    if len(task.record):
        _RUNS[columns, has_soil](task, Block.made(columns, has_soil))
