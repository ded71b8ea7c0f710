"""The settled response of n moles.

The transient ends when the motion repeats itself over common periods of control and mains. Where
there is no common period, it ends when the tangent flow has forgotten all but a millionth of the
start. Motion that repeats is averaged over whole periods; other motion, and one that repeats by
chance though its tangents grow, over batches of common periods, whose scatter tells the errors of
the means.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.mole.lanes.block import CURRENT, LONGEST_PERIOD, MEASURED, P
from models.mole.lanes.propagation import run
from models.mole.lanes.rows import (
    CONTACTS,
    ELECTRIC,
    GROWTH,
    HALF,
    HIGH,
    IMPACT,
    IMPULSE,
    LOW,
    OUTCOME,
    PERIOD,
    PROGRESS,
    REACHED_END,
    RECORD,
    REPEATING,
    TOUCHING,
    Task,
    begin,
)
from models.mole.response.verdict import SURE, verdicts
from models.mole.theory.system import Mole
from models.numerics.batch_means import mean_and_error
from models.numerics.exponents import log_multiplier

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Counts = NDArray[np.int64]

LONGEST = 120.0  # s of transient
LATEST = 1200.0  # s more where the tangent flow says that the motion is still settling
BUDGET = 2_000_000  # trial steps, for as many control periods as are averaged at first
APERIODIC = 200
"""Control periods averaged at first where the motion does not repeat."""
LOOKS = 1, 4, 16
"""How often as many it may take to tell the exponent from zero."""
_UNSTABLE = 1e-3  # logarithm of a multiplier from which on a motion that repeats is no attractor
BATCHES = 20
_FORGOTTEN = np.log(1e-6)
_LOOK = 1.0  # s between two looks at the tangent flow
_WARM_UP = 10  # control periods in which a tangent finds the direction that grows most


class Machines(NamedTuple):
    """n moles.

    Attributes
    ----------
    table : ndarray, shape (n, 20)
        Of `models.mole.lanes.rows.table_of`.
    control_frequency : ndarray, shape (n,)
        [Hz]
    common : ndarray of int, shape (n,)
        Common period of control and mains [control periods], 0 if there is none.
    record : ndarray, shape (n, RECORD)
        Where they stand.
    budget : int
        Trial steps of each.
    """

    table: Array
    control_frequency: Array
    common: Counts
    record: Array
    budget: int

    @staticmethod
    def started(
        table: Array,
        control_frequency: Array,
        common: Counts,
        displacement: Array,
        velocity: Array,
        periods: int = 0,
    ) -> "Machines":
        """Return moles just switched on, with a budget for so many control periods and more."""
        record = np.empty((len(table), RECORD))
        begin(table, displacement, velocity, record)
        budget = BUDGET * max(1, -(-periods // APERIODIC))
        return Machines(table, control_frequency, common, record, budget)

    def run(
        self, rows: Counts, limit: Counts, tolerance: float, repeat: bool, tangents: Array
    ) -> Counts:
        """Propagate some of them; return which of them got where they should.

        Parameters
        ----------
        rows : ndarray of int, shape (k,)
        limit : ndarray of int, shape (k,)
            Control periods since the start.
        tolerance : float
        repeat : bool
            Whether to end where the motion repeats.
        tangents : ndarray, shape (k, 5 columns)
            Updated in place.

        Returns
        -------
        ndarray of int
            Places in `rows`.
        """
        common = self.common[rows] if repeat else np.zeros(len(rows), np.int64)
        record = self.record[rows]
        run(
            Task(self.table[rows], record, tangents, limit, common, tolerance, self.budget),
            tangents.shape[1] // MEASURED,
        )
        self.record[rows] = record
        return np.flatnonzero(
            (record[:, OUTCOME] == REACHED_END) | (record[:, OUTCOME] == REPEATING)
        )

    def periods(self, rows: Counts) -> Counts:
        """Return how many control periods have passed."""
        return (self.record[rows, HALF] / 2).astype(np.int64)

    def verdicts(self, rows: Counts, known: "Response") -> NDArray[np.int8]:
        """Return what motions that do not repeat are; see `models.mole.response.verdict`."""
        periods = known.time[rows] * self.control_frequency[rows]
        return verdicts(known.growth[rows], periods, self.common[rows] == 0)


class Response(NamedTuple):
    """The settled response of n moles; NaN where a run did not get so far.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Averaged over [s].
    progress, impact, electric : ndarray, shape (n, BATCHES)
        Advance of the mole [m], work of the impacts and of the supply [J] in each batch; what
        repeats is all in the first.
    impulse : ndarray, shape (n,)
        Of the contact force [N s].
    contacts : ndarray, shape (n,)
    low, high : ndarray, shape (n,)
        Smallest and largest displacement u [m].
    touching : ndarray of bool, shape (n,)
        Whether there was contact at the beginning.
    growth : ndarray, shape (n, BATCHES)
        Growth of the logarithm of a tangent in each batch; what repeats: of the largest multiplier,
        in the first.
    period : ndarray of int, shape (n,)
        Common periods in a response that repeats, else 0.
    """

    time: Array
    progress: Array
    impact: Array
    electric: Array
    impulse: Array
    contacts: Array
    low: Array
    high: Array
    touching: Flags
    growth: Array
    period: Counts

    @staticmethod
    def nothing(n: int) -> "Response":
        """Return n responses of which nothing is known."""
        batches = (np.zeros((n, BATCHES)) for _ in range(4))
        progress, impact, electric, growth = batches
        return Response(
            np.full(n, np.nan),
            progress,
            impact,
            electric,
            np.zeros(n),
            np.zeros(n),
            np.full(n, np.inf),
            np.full(n, -np.inf),
            np.zeros(n, bool),
            growth,
            np.zeros(n, np.int64),
        )

    def forget(self, rows: Counts) -> None:
        """Know nothing of some responses again."""
        for mine, new in zip(self, Response.nothing(len(rows)), strict=True):
            mine[rows] = new

    def note(self, rows: Counts, batch: int, record: Array) -> None:
        """Take in what a run of some moles has seen."""
        self.progress[rows, batch] += record[:, PROGRESS]
        self.impact[rows, batch] += record[:, IMPACT]
        self.electric[rows, batch] += record[:, ELECTRIC]
        self.impulse[rows] += record[:, IMPULSE]
        self.contacts[rows] += record[:, CONTACTS]
        self.low[rows] = np.minimum(self.low[rows], record[:, LOW])
        self.high[rows] = np.maximum(self.high[rows], record[:, HIGH])


def settle(machines: Machines, transient: int, tolerance: float) -> tuple[Counts, Counts]:
    """Take n moles from their start to their settled response.

    Parameters
    ----------
    machines : Machines
        Their record is updated.
    transient : int
        Control periods to be left out; 0: until the motion has settled, 120 s at most.
    tolerance : float

    Returns
    -------
    repeating, other : ndarray of int
        Rows whose motion repeats, and rows whose motion does not.
    """
    rows = np.arange(len(machines.table))
    longest = np.maximum(np.ceil(LONGEST * machines.control_frequency), 1).astype(np.int64)
    alone = machines.common == 0
    plain = np.empty((len(rows), 0))
    if transient:
        reached = machines.run(rows, np.full(len(rows), transient), tolerance, False, plain)
        longest = transient + (LONGEST_PERIOD + 1) * machines.common
        other = reached[alone[reached]]
        rows = reached[~alone[reached]]
    else:
        other = _forget(machines, rows[alone], longest[alone], tolerance)
        rows = rows[~alone]
    rows = rows[machines.run(rows, longest[rows], tolerance, True, plain[rows])]
    repeats = machines.record[rows, OUTCOME] == REPEATING
    return rows[repeats], np.concatenate([other, rows[~repeats]])


def _forget(machines: Machines, rows: Counts, longest: Counts, tolerance: float) -> Counts:
    """Run moles until their start is forgotten; return those that got so far."""
    done = [np.empty(0, np.int64)]
    look = np.maximum(np.round(_LOOK * machines.control_frequency[rows]), 1).astype(np.int64)
    tangents, growth = np.ones((len(rows), MEASURED)), np.zeros(len(rows))
    limit = look.copy()
    while len(rows):
        reached = machines.run(rows, np.minimum(limit, longest), tolerance, False, tangents)
        growth += machines.record[rows, GROWTH]
        settled = (growth < _FORGOTTEN) | (limit >= longest)
        done.append(rows[reached[settled[reached]]])
        keep = reached[~settled[reached]]
        rows, longest, look, limit = rows[keep], longest[keep], look[keep], (limit + look)[keep]
        tangents, growth = tangents[keep], growth[keep]
    return np.concatenate(done)


def settle_late(machines: Machines, rows: Counts, tolerance: float, known: Response) -> Counts:
    """Go on with moles whose motion does not repeat yet but draws nearer to one that does.

    Parameters
    ----------
    machines : Machines
        Their record is updated.
    rows : ndarray of int
        Moles whose motion does not repeat.
    tolerance : float
    known : Response
        What is known of them; forgotten where the motion has come to repeat.

    Returns
    -------
    ndarray of int
        Rows whose motion has come to repeat.
    """
    mean, error = mean_and_error(known.growth[rows])
    rows = rows[(machines.common[rows] > 0) & (mean < -SURE * error)]
    limit = machines.periods(rows) + np.ceil(LATEST * machines.control_frequency[rows]).astype(int)
    reached = machines.run(rows, limit, tolerance, True, np.empty((len(rows), 0)))
    rows = rows[reached]
    rows = rows[machines.record[rows, OUTCOME] == REPEATING]
    known.forget(rows)
    return rows


def follow_repeating(
    machines: Machines, rows: Counts, duration: int, tolerance: float, out: Response
) -> Counts:
    """Follow moles whose motion repeats through whole periods of the response.

    Parameters
    ----------
    machines : Machines
    rows : ndarray of int
    duration : int
        Control periods to be averaged at least.
    tolerance : float
    out : Response
        Updated in place; nothing is known of those whose motion repeats but is unstable.

    Returns
    -------
    ndarray of int
        Rows whose motion repeats but is unstable: it came by chance, and is no attractor.
    """
    common = machines.common
    half_cycles = machines.table[:, Mole._fields.index("supply_speed")] / np.pi
    unstable = [np.empty(0, np.int64)]
    periods = machines.record[rows, PERIOD].astype(np.int64)
    whole = periods * common[rows]
    left = periods * np.maximum(-(-duration // whole), 1)  # common periods
    begun = machines.periods(rows)
    out.touching[rows] = machines.record[rows, TOUCHING] == 1
    tangents = np.tile(np.eye(MEASURED).ravel(), (len(rows), 1))
    growth, step = np.zeros(len(rows)), 0
    places = np.arange(len(rows))
    while len(places):
        step += 1
        here, flow = rows[places], tangents[places]
        reached = machines.run(here, begun[places] + step * common[here], tolerance, False, flow)
        places, flow = places[reached], flow[reached]
        out.note(rows[places], 0, machines.record[rows[places]])
        growth[places] += machines.record[rows[places], GROWTH]
        tangents[places] = flow
        ended = left[places] == step
        done, flow = places[ended], flow[ended].reshape(-1, MEASURED, MEASURED)
        here = rows[done]
        time = left[done] * common[here] / machines.control_frequency[here]
        # After an odd number of half mains cycles current and voltage have the other sign.
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


def follow_other(
    machines: Machines, rows: Counts, duration: int, tolerance: float, out: Response
) -> None:
    """Follow moles whose motion does not repeat through batches of control periods.

    Where the exponent is indistinguishable from zero, a longer look replaces the one before.

    Parameters
    ----------
    machines : Machines
    rows : ndarray of int
    duration : int
        Control periods to be averaged at first, in `BATCHES` batches of whole common periods; 0:
        `APERIODIC`.
    tolerance : float
    out : Response
        Updated in place.
    """
    tangents = np.ones((len(rows), MEASURED))
    limit = machines.periods(rows) + _WARM_UP
    reached = machines.run(rows, limit, tolerance, False, tangents)
    rows, tangents = rows[reached], tangents[reached]
    for times in LOOKS:
        common = np.maximum(machines.common[rows], 1)
        each = -(-times * (duration or APERIODIC) // (BATCHES * common)) * common
        places = _follow_batches(machines, rows, each, tangents, tolerance, out)
        rows, tangents = rows[places], tangents[places]
        mean, error = mean_and_error(out.growth[rows])
        near = np.abs(mean) < SURE * error
        rows, tangents = rows[near], tangents[near]


def _follow_batches(
    machines: Machines, rows: Counts, each: Counts, tangents: Array, tolerance: float, out: Response
) -> Counts:
    """Follow moles through batches, forgetting earlier ones; return places of those that got on."""
    some = Response.nothing(len(rows))
    some.touching[:] = machines.record[rows, TOUCHING] == 1
    limit, places = machines.periods(rows), np.arange(len(rows))
    for batch in range(BATCHES):
        limit = limit + each
        flow = tangents[places]
        reached = machines.run(rows[places], limit[places], tolerance, False, flow)
        places, flow = places[reached], flow[reached]
        some.note(places, batch, machines.record[rows[places]])
        some.growth[places, batch] = machines.record[rows[places], GROWTH]
        tangents[places] = flow
    some.time[places] = BATCHES * each[places] / machines.control_frequency[rows[places]]
    # Who did not get so far keeps what a shorter run has told.
    for mine, new in zip(out, some, strict=True):
        mine[rows[places]] = new[places]
    return places
