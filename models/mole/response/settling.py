"""From the start to the settled response.

The transient ends when the motion repeats over common periods of control and mains. Without a
common period, it ends when the tangent flow has contracted the start to a millionth. Where bar and
mole stay at rest, the place of the bar is never forgotten; there it ends once they have rested for
as long as motion is averaged, and the flow has contracted current and voltage.
"""

import numpy as np

from models.mole.lanes.block import CURRENT, TO_REPEAT, P
from models.mole.lanes.rows import GROWTH, HIGH, LOW, OUTCOME, PROGRESS, REPEATING
from models.mole.parameters import LONGEST_PERIOD
from models.mole.response.machines import APERIODIC, Machines
from models.mole.response.measured import Counts, Response
from models.mole.response.verdict import SURE
from models.numerics.batch_means import mean_and_error

LONGEST = 120.0  # s of transient
LATEST = 1200.0  # s more if by the tangent flow the motion is still settling
_FORGOTTEN = np.log(1e-6)
_LOOK = 1.0  # s between two checks of the tangent flow


def settle(machines: Machines, transient: int) -> tuple[Counts, Counts]:
    """Take n moles from their present states to their settled response.

    Parameters
    ----------
    machines : Machines
        Their record is updated.
    transient : int
        Control periods to drop; 0: until the motion has settled, at most 120 s.

    Returns
    -------
    repeating, other : ndarray of int
        Rows whose motion repeats, and rows whose motion does not repeat.
    """
    common = machines.system.common
    rows = np.arange(len(common))
    longest = np.maximum(np.ceil(LONGEST * machines.system.control_frequency), 1).astype(np.int64)
    begun, alone = machines.periods(rows), common == 0
    if transient:
        reached = machines.run(rows, begun + transient)
        # This shows periods up to half of these; `settle_late` finds the longer ones.
        longest = transient + (LONGEST_PERIOD + 1) * common
        other = reached[alone[reached]]
        rows = reached[~alone[reached]]
    else:
        other = _forget(machines, rows[alone], longest[alone])
        rows = rows[~alone]
    rows = rows[machines.run(rows, (begun + longest)[rows], repeat=True)]
    repeats = machines.record[rows, OUTCOME] == REPEATING
    return rows[repeats], np.concatenate([other, rows[~repeats]])


def _forget(machines: Machines, rows: Counts, longest: Counts) -> Counts:
    """Run moles until their start is forgotten; return those that completed the run."""
    done = [np.empty(0, np.int64)]
    look = np.maximum(np.round(_LOOK * machines.system.control_frequency[rows]), 1).astype(np.int64)
    size = machines.system.measured
    electric = np.isin(np.arange(size), (CURRENT, P)).astype(float)  # a tangent
    tangents, growth = np.ones((len(rows), size)), np.zeros(len(rows))
    begun, rested = machines.periods(rows), np.zeros(len(rows), np.int64)
    limit, longest = begun + look, begun + longest
    while len(rows):
        reached = machines.run(rows, np.minimum(limit, longest), tangents)
        record = machines.record[rows]
        growth += record[:, GROWTH]
        rests = (record[:, LOW] == record[:, HIGH]) & (record[:, PROGRESS] == 0)
        long_enough = (rested == 0) | (rests & (rested + look >= APERIODIC))
        settled = (growth < _FORGOTTEN) & long_enough | (limit >= longest)
        new = rests != (rested > 0)
        tangents[new], growth[new] = np.where(rests[new, None], electric, 1.0), 0.0
        rested = np.where(rests, rested + look, 0)
        done.append(rows[reached[settled[reached]]])
        keep = reached[~settled[reached]]
        rows, longest, look, limit = rows[keep], longest[keep], look[keep], (limit + look)[keep]
        tangents, growth, rested = tangents[keep], growth[keep], rested[keep]
    return np.concatenate(done)


def settle_late(machines: Machines, rows: Counts, response: Response, latest: float) -> Counts:
    """Look again at moles whose motion did not repeat before its averages were taken.

    Parameters
    ----------
    machines : Machines
        Their record is updated.
    rows : ndarray of int
        Moles whose motion does not repeat.
    response : Response
        Their responses so far; reset to unknown where the motion now repeats.
    latest : float
        How long a motion that converges to one that repeats is continued at most [s].

    Returns
    -------
    ndarray of int
        Rows whose motion now repeats.
    """
    mean, error = mean_and_error(response.growth[rows])
    system = machines.system
    selected = (system.common[rows] > 0) & (mean <= SURE * error) & np.isfinite(response.time[rows])
    rows, converges = rows[selected], (mean < -SURE * error)[selected]
    more = np.ceil(latest * system.control_frequency[rows]).astype(np.int64)
    more = np.maximum(np.where(converges, more, 0), TO_REPEAT * system.common[rows])
    rows = rows[machines.run(rows, machines.periods(rows) + more, repeat=True)]
    rows = rows[machines.record[rows, OUTCOME] == REPEATING]
    response.forget(rows)
    return rows
