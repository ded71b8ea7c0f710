"""Growth of the gaps in an accelerated life, and its record, beam by beam."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import NO_IMPACT
from models.beam.structure.modal import Array
from models.beam.wear.regimes import WINDOW, regime_of
from models.numerics.jit import kernel, lean

_MEMORY = 0.25  # weight of the newest look in the running work-rate
_EXTINCT = 1e-6  # of the first work-rate: wear ends below it, near the free amplitude


class Life(NamedTuple):
    """Constants and running values of each beam, besides the outcome.

    Attributes
    ----------
    gaps, share, growths : ndarray
        As in `models.beam.wear.accelerated_life.run_life`.
    free_reach : ndarray, shape (n,)
        Amplitude of the tip without contact [X0].
    first, rate : ndarray, shape (n,), (n, 2)
        Wear per period at the beginning, and its running value at each site.
    grown : ndarray, shape (n, 2)
        Growth of each gap so far [X0].
    clock, silence : ndarray, shape (n,)
        Accelerated time, and periods since the last contact.
    silent : ndarray, shape (n,)
        Periods without contact after which contact has ended for good.
    """

    gaps: Array
    share: Array
    growths: Array
    free_reach: Array
    first: Array
    rate: Array
    grown: Array
    clock: Array
    silence: NDArray[np.int64]
    silent: Array


@kernel
def pace(left, life, reached, periods, acceleration, growth):
    """Choose accelerations such that the faster-growing gap grows like (1 + a)^t from t = 0."""
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
def note_growth(left, life, out, work, acceleration, growth):
    """Record the periods just simulated: growths reached, running work-rates, the end of wear."""
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
def note_look(left, life, out, look, strobe, work):
    """Record the present gaps, work-rates and regime in the history."""
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
    """Return whether beam i reaches any growth in a step; in most it does not."""
    for site in range(2):
        for depth in range(life.growths.shape[1]):
            missing = not out.reached[i, site, depth]
            if missing and life.grown[i, site] + step[site] >= life.growths[i, depth]:
                return True
    return False


@lean
def _note_crossings(i, life, out, grown, step, when, acceleration):
    """Record which growths beam i reaches in one period, and when, by linear interpolation."""
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
    """Return whether contact has ended, or is too weak for a greater depth ever to be reached.

    A gap that grows towards the free amplitude approaches it like 1/t, not in finite time.
    """
    narrow = min(life.gaps[i, 0] + life.grown[i, 0], life.gaps[i, 1] + life.grown[i, 1])
    rate = max(life.rate[i, 0], life.rate[i, 1])
    silent = life.silence[i] >= life.silent[i] and life.free_reach[i] < narrow
    return silent or (rate <= _EXTINCT * life.first[i] and life.free_reach[i] < 1.01 * narrow)
