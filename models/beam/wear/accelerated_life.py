"""An accelerated life: the gaps grow while the beam rattles, only many times faster than in life.

Archard's law with impact work (eqs 5, 9 to 12 of Knudsen & Massih 2002) makes a gap grow by a
constant times the work done on its site. Life lasts some 1e9 forcing periods; with the wear
coefficient multiplied by an acceleration K it takes N periods, and the life is K times as long as
what was simulated. K follows the running work-rate, so that the gap which grows faster grows by
the same amount per period all along: N is known beforehand, whatever the work-rate does.
"""

from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import NO_IMPACT
from models.beam.response.settling import TURNS
from models.beam.structure.modal import Array
from models.beam.wear.lost_stability import push_off_unstable_orbits
from models.beam.wear.regimes import WINDOW, History, regime_of
from models.numerics.jit import kernel, lean

LOOKS = 32  # changes of the acceleration in N periods
OVERTIME = 4  # a run may last this many times N periods
_MEMORY = 0.25  # weight of the newest look in the running work-rate
_SILENCE = 64  # least periods without contact after which a beam that need not touch never will
_EXTINCT = 1e-6  # of the first work-rate: what is left when the gaps approach the free amplitude


class Run(NamedTuple):
    """One accelerated life of n beams.

    Attributes
    ----------
    time : ndarray, shape (n, 2, D)
        Life of each site to each growth, in forcing periods over the wear per work of the right
        site [X0 per dimensionless work]; inf if never, else the time reached.
    reached : ndarray of bool, shape (n, 2, D)
    ended : ndarray of bool, shape (n,)
        Whether wear has stopped for good: what was not reached never will be.
    ratio : ndarray, shape (n, D)
        Gap of the other site over that of the first to reach the growth, then; NaN if never.
    lost : ndarray of bool, shape (n,)
        Whether an orbit was found to have lost its stability.
    history : History
        NaN after the end of a life.
    """

    time: Array
    reached: NDArray[np.bool_]
    ended: NDArray[np.bool_]
    ratio: Array
    lost: NDArray[np.bool_]
    history: History


class _Life(NamedTuple):
    """What `_pace` and `_note` read and keep of each beam, beside the outcome.

    Attributes
    ----------
    gaps, share, growths : ndarray
        As in `run`.
    reach : ndarray, shape (n,)
        Amplitude of the tip without contact [X0].
    first, rate : ndarray, shape (n,), (n, 2)
        Wear per period at the beginning, and the running one of each site.
    grown : ndarray, shape (n, 2)
        Growth of each gap so far [X0].
    clock, silence : ndarray, shape (n,)
        Accelerated time, and periods since the last contact.
    silent : ndarray, shape (n,)
        Periods without contact after which there will be none.
    """

    gaps: Array
    share: Array
    growths: Array
    reach: Array
    first: Array
    rate: Array
    grown: Array
    clock: Array
    silence: NDArray[np.int64]
    silent: Array


def run(
    propagator: ModuleType,
    system: Any,
    state: Array,
    gaps: Array,
    work: Array,
    share: Array,
    growths: Array,
    periods: int,
    looks: int = LOOKS,
) -> Run:
    """Let the gaps of n beams grow in about `periods` forcing periods.

    Parameters
    ----------
    propagator : module
        `models.beam.lanes` or `models.beam.exact`.
    system
        What the propagator prepared.
    state : ndarray, shape (n, k)
        Settled at the initial gaps; not changed.
    gaps : ndarray, shape (n, 2)
        Initial, in X0; not changed.
    work : ndarray, shape (n, 2)
        Mean dimensionless work per period at the initial gaps.
    share : ndarray, shape (n, 2)
        Wear coefficient of each site over that of the right site.
    growths : ndarray, shape (n, D)
        Gap growths to reach, increasing, in X0.
    periods : int
        N: what the faster site takes to the last growth.
    looks : int
        In N periods.

    Returns
    -------
    Run
    """
    n, depths = growths.shape
    out = Run(
        np.zeros((n, 2, depths)),
        np.zeros((n, 2, depths), bool),
        np.zeros(n, bool),
        np.full((n, depths), np.nan),
        np.zeros(n, bool),
        History.nothing(n, looks * OVERTIME),
    )
    rate = work * share
    reach = system.reach
    clock, grown, silence = np.zeros(n), np.zeros((n, 2)), np.zeros(n, np.int64)
    silent = np.maximum(_SILENCE, TURNS * system.turn)
    life = _Life(gaps, share, growths, reach, rate.max(axis=1), rate, grown, clock, silence, silent)
    left, state, here, unstable = np.arange(n), state.copy(), gaps.copy(), np.zeros(n, bool)
    every = 8 if looks < LOOKS else 4  # looks from one check of stability to the next
    for look in range(looks * OVERTIME):
        acceleration, growth = np.empty(len(left)), np.empty((len(left), 2))
        _pace(left, life, out.reached, periods, acceleration, growth)
        record = propagator.advance(system, state, here, growth, periods // looks)
        _note(left, life, out, record.work, acceleration, growth)
        _look(left, life, out, look, record.strobe, record.work)
        alive = ~(out.ended[left] | out.reached[left, :, -1].all(axis=1))
        if not alive.all():
            kept = np.flatnonzero(alive)
            left, state, here, system = left[kept], state[kept], here[kept], system.take(kept)
            unstable = unstable[kept]
        if not len(left):
            break
        if look % every == every - 1:
            regime = out.history.regime[left, look]
            push_off_unstable_orbits(propagator, system, state, here, regime, unstable)
            out.lost[left] |= unstable
    missing = ~out.reached
    never = out.ended[:, None, None]
    out.time[missing] = np.where(never, np.inf, clock[:, None, None] + 0 * out.time)[missing]
    return out


@kernel
def _pace(left, life, reached, periods, acceleration, growth):
    """Choose accelerations so that the gap that grows faster grows like (1 + a)^t, from t = 0."""
    last = life.growths.shape[1] - 1
    for j in range(left.size):
        i = left[j]
        head_start = life.growths[i, 0] / 2
        pace = np.log1p(life.growths[i, last] / head_start) / periods
        control, grown = 0.0, 0.0
        for site in range(2):
            if not reached[i, site, last]:
                control = max(control, life.rate[i, site])
            grown = max(grown, life.grown[i, site])
        acceleration[j] = pace * (grown + head_start) / control if control > 0 else 0.0
        for site in range(2):
            growth[j, site] = acceleration[j] * life.share[i, site]


@kernel
def _note(left, life, out, work, acceleration, growth):
    """Take in the periods just simulated: growths reached, running work-rates, the end of wear."""
    periods = work.shape[1]
    for j in range(left.size):
        i = left[j]
        total = _total(work, j)
        step = (growth[j, 0] * total[0], growth[j, 1] * total[1])
        if _will_cross(i, life, out, step):
            grown = (life.grown[i, 0], life.grown[i, 1])
            for period in range(periods):
                step = (growth[j, 0] * work[j, period, 0], growth[j, 1] * work[j, period, 1])
                when = life.clock[i] + acceleration[j] * period
                _note_crossings(i, life, out, grown, step, when, acceleration[j])
                grown = (grown[0] + step[0], grown[1] + step[1])
            life.grown[i, 0], life.grown[i, 1] = grown
        else:
            life.grown[i, 0] += step[0]
            life.grown[i, 1] += step[1]
        life.clock[i] += acceleration[j] * periods
        for site in range(2):
            rate = total[site] * life.share[i, site] / periods
            life.rate[i, site] += _MEMORY * (rate - life.rate[i, site])
        life.silence[i] = 0 if total[0] + total[1] > 0 else life.silence[i] + periods
        out.ended[i] = _has_ended(i, life)


@lean
def _total(work, j):
    right = left = 0.0
    for period in range(work.shape[1]):
        right += work[j, period, 0]
        left += work[j, period, 1]
    return right, left


@kernel
def _look(left, life, out, look, strobe, work):
    """Enter in the history how things stand."""
    periods = work.shape[1]
    history = out.history
    for j in range(left.size):
        i = left[j]
        history.time[i, look] = life.clock[i]
        total = _total(work, j)
        for site in range(2):
            history.gaps[i, look, site] = life.gaps[i, site] + life.grown[i, site]
            history.work[i, look, site] = total[site] / periods
        if periods >= WINDOW:
            seen = regime_of(strobe[j], work[j])
            history.regime[i, look] = NO_IMPACT if out.ended[i] else seen


@lean
def _will_cross(i, life, out, step):
    """Tell whether beam i reaches any growth in a step: most looks reach none."""
    for site in range(2):
        for depth in range(life.growths.shape[1]):
            missing = not out.reached[i, site, depth]
            if missing and life.grown[i, site] + step[site] >= life.growths[i, depth]:
                return True
    return False


@lean
def _note_crossings(i, life, out, grown, step, when, acceleration):
    """Note which growths beam i reaches in one period, and when; linear within it."""
    for depth in range(life.growths.shape[1]):
        goal = life.growths[i, depth]
        first_of_all = not (out.reached[i, 0, depth] or out.reached[i, 1, depth])
        earliest = np.inf
        for site in range(2):
            before = grown[site]
            if out.reached[i, site, depth] or before + step[site] < goal:
                continue
            part = (goal - before) / step[site]
            out.time[i, site, depth] = when + acceleration * part
            out.reached[i, site, depth] = True
            if first_of_all and part < earliest:
                earliest = part
                other = 1 - site
                slower = life.gaps[i, other] + grown[other] + part * step[other]
                out.ratio[i, depth] = slower / (life.gaps[i, site] + goal)


@lean
def _has_ended(i, life):
    """Tell where no contact is left, or so little that no greater depth is ever reached.

    A gap that grows towards the free amplitude comes near it like 1/t, not in finite time.
    """
    narrow = min(life.gaps[i, 0] + life.grown[i, 0], life.gaps[i, 1] + life.grown[i, 1])
    rate = max(life.rate[i, 0], life.rate[i, 1])
    silent = life.silence[i] >= life.silent[i] and life.reach[i] < narrow
    return silent or (rate <= _EXTINCT * life.first[i] and life.reach[i] < 1.01 * narrow)
