"""Averages over the settled response.

Motion that repeats is averaged over whole periods; other motion, including motion that repeats by
chance although its tangents grow, over batches of common periods, whose scatter gives the errors of
the means.
"""

import numpy as np

from models.mole.lanes.block import CURRENT, P
from models.mole.lanes.rows import GROWTH, PERIOD, TOUCHING
from models.mole.response.machines import APERIODIC, Machines
from models.mole.response.measured import BATCHES, Array, Counts, Response
from models.mole.response.verdict import SURE
from models.mole.theory.system import Mole
from models.numerics.batch_means import mean_and_error
from models.numerics.exponents import log_multiplier

LOOKS = 1, 4, 16
"""Factors by which averages are extended until the exponent is distinguishable from zero."""
_UNSTABLE = 1e-3  # logarithm of a multiplier above which a motion that repeats is no attractor
_WARM_UP = 10  # control periods in which a tangent turns into the direction of fastest growth


def follow_repeating(machines: Machines, rows: Counts, duration: int, out: Response) -> Counts:
    """Follow moles whose motion repeats through whole periods of the response.

    Parameters
    ----------
    machines : Machines
    rows : ndarray of int
    duration : int
        Control periods to average, at least.
    out : Response
        Updated in place; unknown where the motion repeats but is unstable.

    Returns
    -------
    ndarray of int
        Rows whose motion repeats but is unstable: reached by chance, it is no attractor.
    """
    size = machines.system.measured
    common, frequency = machines.system.common, machines.system.control_frequency
    half_cycles = machines.system.table[:, Mole._fields.index("supply_speed")] / np.pi
    unstable = [np.empty(0, np.int64)]
    periods = machines.record[rows, PERIOD].astype(np.int64)
    whole = periods * common[rows]
    left = periods * np.maximum(-(-duration // whole), 1)  # common periods
    begun = machines.periods(rows)
    out.touching[rows] = machines.record[rows, TOUCHING] == 1
    tangents = np.tile(np.eye(size).ravel(), (len(rows), 1))
    growth, step = np.zeros(len(rows)), 0
    places = np.arange(len(rows))
    while len(places):
        step += 1
        here, flow = rows[places], tangents[places]
        reached = machines.run(here, begun[places] + step * common[here], flow)
        places, flow = places[reached], flow[reached]
        out.note(rows[places], 0, machines.record[rows[places]])
        growth[places] += machines.record[rows[places], GROWTH]
        tangents[places] = flow
        ended = left[places] == step
        done, flow = places[ended], flow[ended].reshape(-1, size, size)
        here = rows[done]
        time = left[done] * common[here] / frequency[here]
        # After an odd number of half mains cycles current and voltage have changed sign.
        odd = np.round(time * half_cycles[here]) % 2 == 1
        flow[odd, :, CURRENT : P + 1] *= -1
        out.growth[here, 0] = growth[done] + log_multiplier(flow)
        out.time[here] = time
        out.period[here] = periods[done]
        chance = here[out.growth[here, 0] > _UNSTABLE]
        out.forget(chance)
        unstable.append(chance)
        places = places[~ended]
    return np.concatenate(unstable)


def follow_other(machines: Machines, rows: Counts, duration: int, out: Response) -> None:
    """Follow moles whose motion does not repeat through batches of control periods.

    Where the exponent is indistinguishable from zero, a longer average replaces the previous one.

    Parameters
    ----------
    machines : Machines
    rows : ndarray of int
    duration : int
        Control periods to average at first, in `BATCHES` batches of whole common periods; 0:
        `APERIODIC`.
    out : Response
        Updated in place.
    """
    tangents = np.ones((len(rows), machines.system.measured))
    limit = machines.periods(rows) + _WARM_UP
    reached = machines.run(rows, limit, tangents)
    rows, tangents = rows[reached], tangents[reached]
    for times in LOOKS:
        common = np.maximum(machines.system.common[rows], 1)
        each = -(-times * (duration or APERIODIC) // (BATCHES * common)) * common
        places = _follow_batches(machines, rows, each, tangents, out)
        rows, tangents = rows[places], tangents[places]
        mean, error = mean_and_error(out.growth[rows])
        near = np.abs(mean) < SURE * error
        rows, tangents = rows[near], tangents[near]


def _follow_batches(
    machines: Machines, rows: Counts, each: Counts, tangents: Array, out: Response
) -> Counts:
    """Follow moles through new batches; return the indices of those that completed them."""
    renewed = Response.nothing(len(rows))
    renewed.touching[:] = machines.record[rows, TOUCHING] == 1
    limit, places = machines.periods(rows), np.arange(len(rows))
    for batch in range(BATCHES):
        limit = limit + each
        flow = tangents[places]
        reached = machines.run(rows[places], limit[places], flow)
        places, flow = places[reached], flow[reached]
        renewed.note(places, batch, machines.record[rows[places]])
        renewed.growth[places, batch] = machines.record[rows[places], GROWTH]
        tangents[places] = flow
    renewed.time[places] = BATCHES * each[places] / machines.system.control_frequency[rows[places]]
    # A row that does not complete them keeps the averages of a shorter run.
    for mine, new in zip(out, renewed, strict=True):
        mine[rows[places]] = new[places]
    return places
