"""Sixteen moles at a time, each with its own step and with every event located.

All lanes take a trial step; then each lane is treated on its own. A lane whose guards stay positive
accepts it. One that has met an event tries again with a step that ends there, which takes two or
three trials. Steps end exactly where the relay switches. A lane whose row is done takes the next
row. Lanes are independent, so a row's bits do not depend on its neighbours.
"""

from collections.abc import Callable

from models.mole.lanes import block as at
from models.mole.lanes.block import INTEGRALS, LANES, MEASURED, Block, quantities
from models.mole.lanes.modes import judge
from models.mole.lanes.rates import renew, slopes
from models.mole.lanes.rows import GOING, OUT_OF_BUDGET, STUCK, Task, idle, load, unload
from models.mole.lanes.steps import accept, conclude
from models.mole.lanes.strobe import strobe
from models.numerics import dop8
from models.numerics.blocks import layout
from models.numerics.jit import kernel, lean

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
    size = quantities(columns)
    rates = slopes(columns)
    combine = dop8.combiner(size)
    estimate = dop8.estimator(size, MEASURED)
    first = layout(size, dop8.STAGES).slopes
    whole = size * LANES

    @lean
    def keep(m, y, new):
        """Store the new state of the lanes whose step was accepted."""
        for q in range(size):
            for lane in range(LANES):
                j = q * LANES + lane
                y[j] = new[j] if m[at.LOOK * LANES + lane] == 0.0 else y[j]
        for q in range(INTEGRALS):
            for lane in range(LANES):
                part = m[(at.INTEGRAL + q) * LANES + lane]
                part = part if m[at.LOOK * LANES + lane] == 0.0 else 0.0
                m[(at.SUM + q) * LANES + lane] += part

    @lean
    def propagate(task, block):
        # Unpack tuples before the loop: inside it, every access would be reference-counted.
        w, y, new, end, m, share, error, ring = block
        table, rows = task.table, task.record.shape[0]
        waiting = running = 0
        for lane in range(LANES):
            load(lane, min(waiting, rows - 1), task, m, y, share, columns)
            if waiting < rows:
                running += 1
                waiting += 1
            else:
                idle(lane, m)
        while running > 0:
            for j in range(INTEGRALS * LANES):
                m[at.INTEGRAL * LANES + j] = 0.0
            renew(m, y)
            for stage in range(1, dop8.STAGES + 1):
                k = w[first + (stage - 1) * whole : first + stage * whole]
                rates(m, y if stage == 1 else new, k, dop8.WEIGHTS[stage - 1])
                combine(stage, w)
            estimate(w, share, error)
            rates(m, new, end, 0.0)
            judge(m, new, end)
            accept(m, error)
            keep(m, y, new)
            for lane in range(LANES):
                if m[at.LOOK * LANES + lane] == 0.0 or m[at.ROW * LANES + lane] < 0:
                    continue
                outcome = GOING
                if conclude(lane, table, m, y, new, end, error[lane], size, columns):
                    outcome = strobe(lane, task, m, y, ring, columns)
                if outcome == GOING and m[at.TRIALS * LANES + lane] >= task.budget:
                    outcome = OUT_OF_BUDGET
                if not m[at.STEP * LANES + lane] > _SHORTEST:
                    outcome = STUCK
                if outcome != GOING:
                    unload(lane, task, m, y, columns, outcome)
                    if waiting < rows:
                        load(lane, waiting, task, m, y, share, columns)
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
