"""How far the gaps of each beam have worn: times, errors and looks noted on the way."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.modal import Array
from models.beam.wear.depths_in_time import note_depths, passed
from models.beam.wear.regimes import LONGEST_PERIOD, History
from models.numerics.jit import inlined

STEP_FACTOR, FLOW_FACTOR = 3.0, 11.0  # half-width of the 90 % interval over the errors: measured

STEPPING, HOLDING, FLOWING, OVER = range(4)
ONWARD, KEEP, BACK = range(3)  # verdicts, see `models.beam.wear.rounds.judge`
FIRST_STEP, SMALLEST_STEP = 0.14, 1e-3  # relative growth of a gap
_PART = 0.25  # of a gap that grows until the other stop is met


class Progress(NamedTuple):
    """What is known of n beams at some time during their lives.

    Attributes
    ----------
    initial, share, growths, instants : ndarray
        Gaps, shares of wear, growths to reach and times of depths, as in
        `models.beam.wear.worn_beams.wear_down`.
    free_reach, silent : ndarray, shape (n,)
        Amplitude of the tip without contact [X0]; periods without contact after which it has ended.
    first : ndarray, shape (n,)
        Wear per period at the beginning.
    mode : ndarray of int8, shape (n,)
        `STEPPING`: the gaps grow by a step during this round; `HOLDING`: they do not grow;
        `FLOWING`: they grow all the time; `OVER`.
    clock : ndarray, shape (n,)
        Time in real wear, see `models.beam.wear.worn_beams.Worn.time`.
    grown : ndarray, shape (n, 2)
        Growth of each gap at that time [X0].
    excess : ndarray, shape (n, 2)
        Part of this in which there was no contact any more.
    rate : ndarray, shape (n, 2)
        Wear per period of each site: at that time, or its running mean in a flow.
    grown_before, rate_before : ndarray, shape (n, 2)
        At the beginning of the last step; `rate_before` is 0 if there was none.
    step, distance : ndarray, shape (n,)
        Relative growth of the gap in the next step; sum of those so far.
    change_at : ndarray, shape (n,)
        Growth of the gap at which a change of branch was seen, inf if none lies ahead.
    regime : ndarray of int8, shape (n,)
        The last one seen.
    span : ndarray, shape (n,)
        Time meant to pass in the present step, or in this round of a flow.
    apart : ndarray, shape (n, LONGEST_PERIOD)
        As in `models.beam.wear.regimes.watch`.
    rounds, silence : ndarray of int, shape (n,)
        Rounds held, or rounds of a flow in which the response came closer to an orbit; periods
        since the last contact.
    last, change, total : ndarray, shape (n, 2)
        Wear per period in the last round, change of its sum and difference from the one before,
        and its sum over the later rounds held.
    error : ndarray, shape (n, 2)
        Of the clock in the last step, seen from each site.
    block, block_inverse : ndarray, shape (n, 4), (n, 2)
        Growth of each gap, time and rounds in the present block of a flow; time per growth in the
        one before, 0 if there was none.
    step_error, flow_error : ndarray, shape (n, 2)
        Sums of the squared errors of the clock, seen from each site.
    """

    initial: Array
    share: Array
    growths: Array
    instants: Array
    free_reach: Array
    silent: Array
    first: Array
    mode: NDArray[np.int8]
    clock: Array
    grown: Array
    excess: Array
    rate: Array
    grown_before: Array
    rate_before: Array
    step: Array
    distance: Array
    change_at: Array
    regime: NDArray[np.int8]
    span: Array
    apart: Array
    rounds: NDArray[np.int64]
    silence: NDArray[np.int64]
    last: Array
    change: Array
    total: Array
    error: Array
    block: Array
    block_inverse: Array
    step_error: Array
    flow_error: Array

    @staticmethod
    def beginning(
        initial: Array,
        share: Array,
        growths: Array,
        instants: Array,
        free_reach: Array,
        silent: Array,
        rate: Array,
        regime: NDArray[np.int8],
        mode: NDArray[np.int8],
        step: float,
    ) -> "Progress":
        """Return the progress of n beams that have settled at their initial gaps."""
        n = len(initial)
        fields: tuple[Any, ...] = (
            initial,
            share,
            growths,
            instants,
            free_reach,
            silent,
            rate.max(axis=1),
            mode,
            np.zeros(n),
            *np.zeros((2, n, 2)),
            rate,
            *np.zeros((2, n, 2)),
            np.full(n, step),
            np.zeros(n),
            np.full(n, np.inf),
            regime.copy(),
            np.zeros(n),
            np.full((n, LONGEST_PERIOD), np.inf),
            *np.zeros((2, n), np.int64),
            *np.zeros((4, n, 2)),
            np.zeros((n, 4)),
            *np.zeros((3, n, 2)),
        )
        return Progress(*fields)


class Worn(NamedTuple):
    """The lives of n beams.

    Attributes
    ----------
    time : ndarray, shape (n, 2, D)
        Life of each site to each growth, in forcing periods over the wear per work of the right
        site [X0 per dimensionless work]; inf if never, the time followed if not reached.
    error : ndarray, shape (n, 2, D)
        Half-width of its 90 % interval; NaN if not reached.
    reached : ndarray of bool, shape (n, 2, D)
    ended : ndarray of bool, shape (n,)
        Whether wear has stopped for good: growths not reached never will be.
    ratio : ndarray, shape (n, D)
        Gap of the other site over that of the first to reach the growth, at that time; NaN if
        never.
    depth : ndarray, shape (n, 2, T)
        Growth of each gap at the instants [X0]; at least the last growth once it is reached, NaN
        where unknown.
    history : History
        NaN after the end of a life.
    """

    time: Array
    error: Array
    reached: NDArray[np.bool_]
    ended: NDArray[np.bool_]
    ratio: Array
    depth: Array
    history: History

    @staticmethod
    def nothing(n: int, depths: int, instants: int, looks: int) -> "Worn":
        """Return the lives of n beams before they are followed."""
        return Worn(
            np.zeros((n, 2, depths)),
            np.full((n, 2, depths), np.nan),
            np.zeros((n, 2, depths), bool),
            np.zeros(n, bool),
            np.full((n, depths), np.nan),
            np.full((n, 2, instants), np.nan),
            History.nothing(n, looks),
        )


@inlined
def wear_on(i, life, out, time, growth, rate, spacing):
    """Let a time pass in which the gaps of beam i grow to a given rate of wear."""
    unit = scale(i, life, out)
    for depth in range(life.growths.shape[1]):
        _note_crossings(i, life, out, depth, time, growth, rate)
    note_depths(i, life, out, time, growth, rate)
    extent = np.log1p(max(growth[0], growth[1], 0.0) / unit)
    first = int(life.distance[i] / spacing)
    for look in range(first, out.history.regime.shape[1]):
        part = ((look + 1) * spacing - life.distance[i]) / extent if extent > 0 else np.inf
        if part > 1:
            break
        note_look(i, life, out, look, max(part, 0.0), time, growth, rate)
    life.clock[i] += time
    life.distance[i] += extent
    for site in range(2):
        life.grown[i, site] += growth[site]


@inlined
def scale(i, life, out):
    """Return the growth that counts as a relative growth of one.

    While a stop that is not met waits for the other, which has reached the last growth, it is at
    least a part of the other's gap: it may be far more than its growth so far.
    """
    size = max(life.grown[i, 0], life.grown[i, 1]) + life.growths[i, 0] / 2
    site = control(i, life, out)
    if out.reached[i, site, -1]:
        size = max(size, _PART * (life.initial[i, site] + life.grown[i, site]))
    return size


@inlined
def control(i, life, out):
    """Return the site that wears fastest among those that have not reached the last growth.

    If none of these wears, it is the other one: only as its gap widens can it be seen whether they
    ever will.
    """
    last = life.growths.shape[1] - 1
    right = 0.0 if out.reached[i, 0, last] else life.rate[i, 0]
    left = 0.0 if out.reached[i, 1, last] else life.rate[i, 1]
    if right <= 0.0 and left <= 0.0:
        right, left = life.rate[i, 0], life.rate[i, 1]
    return 0 if right >= left else 1


@inlined
def _note_crossings(i, life, out, depth, time, growth, rate):
    """Record when beam i reaches one growth, with a rate linear in the growth along the way."""
    goal = life.growths[i, depth]
    first_of_all = not (out.reached[i, 0, depth] or out.reached[i, 1, depth])
    earliest = np.inf
    for site in range(2):
        missing = goal - life.grown[i, site]
        if out.reached[i, site, depth] or growth[site] <= 0 or missing > growth[site]:
            continue
        part = max(0.0, missing / growth[site])
        before, after = life.rate[i, site], rate[site]
        needed = passed(part, before, after)
        out.time[i, site, depth] = life.clock[i] + time * needed
        error = STEP_FACTOR**2 * life.step_error[i, site]
        error += FLOW_FACTOR**2 * life.flow_error[i, site]
        out.error[i, site, depth] = min(np.sqrt(error), out.time[i, site, depth])
        out.reached[i, site, depth] = True
        if first_of_all and needed < earliest:
            earliest = needed
            other = 1 - site
            slower = life.initial[i, other] + life.grown[i, other] + part * growth[other]
            out.ratio[i, depth] = slower / (life.initial[i, site] + goal)


@inlined
def note_look(i, life, out, look, part, time, growth, rate):
    """Record gaps, work-rates and regime of beam i, interpolated, in its history."""
    history = out.history
    history.time[i, look] = life.clock[i] + part * time
    for site in range(2):
        gap = life.initial[i, site] + life.grown[i, site] + part * growth[site]
        here = life.rate[i, site] + part * (rate[site] - life.rate[i, site])
        history.gaps[i, look, site] = gap
        history.work[i, look, site] = here / life.share[i, site]
    history.regime[i, look] = life.regime[i]
