"""What each beam does in the next round of periods, and what the round has shown."""

import numpy as np

from models.beam.wear.endings import has_ended, note_end
from models.beam.wear.flows import flow
from models.beam.wear.progress import (
    FIRST_STEP,
    FLOWING,
    HOLDING,
    ONWARD,
    OVER,
    SMALLEST_STEP,
    STEPPING,
    control,
    scale,
)
from models.beam.wear.regimes import ROUND, regime_of, watch
from models.beam.wear.steps import begin_hold, hold
from models.numerics.jit import kernel

_PUSH = 3e-3  # of the first mode in the first step [X0]
_WIDEST = 4.0  # growth of the faster gap over that of the one that matters


@kernel
def plan(left, life, out, here, pace, growth, push):
    """Set the growth of the gaps per work of the beams left, for the next round.

    Parameters
    ----------
    left : ndarray of int, shape (m,)
    life : Progress
    out : Worn
    here : ndarray, shape (m, 2)
        Gaps [X0].
    pace : float
        Relative growth of the gaps in a round of a flow.
    growth : ndarray, shape (m, 2)
        Set.
    push : ndarray, shape (m,)
        Set to the displacement of the first mode with which a step begins [X0], so that an orbit
        that wear has made unstable is left; the shorter the step, the smaller.
    """
    for j in range(left.size):
        i = left[j]
        push[j] = 0.0
        rate = life.rate[i]
        site = control(i, life, out)
        fastest = max(rate[0], rate[1])
        wide = np.expm1(life.step[i]) if life.mode[i] == STEPPING else pace
        wide *= scale(i, life)
        if life.mode[i] == STEPPING:
            # A change of branch ahead is approached by halves.
            wide = min(wide, (life.change_at[i] - life.grown[i, site]) / 2)
            wide = max(wide, SMALLEST_STEP * scale(i, life))
            push[j] = _PUSH * min(1.0, wide / (FIRST_STEP * scale(i, life)))
        time = min(wide / rate[site], _WIDEST * wide / fastest) if rate[site] > 0 else 0.0
        if life.mode[i] != HOLDING:
            life.span[i] = time
        for s in range(2):
            growth[j, s] = 0.0
            if life.mode[i] == FLOWING:
                growth[j, s] = time * life.share[i, s] / ROUND
            elif life.mode[i] == STEPPING and rate[s] > 0:
                goal = life.initial[i, s] + life.grown[i, s] + rate[s] * time
                growth[j, s] = max(0.0, goal - here[j, s]) * life.share[i, s] / (rate[s] * ROUND)


@kernel
def judge(left, life, out, here, work, strobe, accuracy, largest, spacing, verdict):
    """Draw conclusions from the round just simulated.

    Parameters
    ----------
    left, life, out, here
        As in `plan`, after the round.
    work, strobe : ndarray, shape (m, ROUND, 2)
        Recorded in it.
    accuracy : float
    largest : float
        Relative growth of the gaps in a step.
    spacing : float
        Of the looks, in relative growth.
    verdict : ndarray of int8, shape (m,)
        Set to `KEEP` where a step may begin from the present state, to `BACK` where it must be
        repeated from the last one kept, to `ONWARD` elsewhere.
    """
    now, grown, nothing = np.empty(2), np.empty(2), np.zeros(2)
    for j in range(left.size):
        i = left[j]
        verdict[j] = ONWARD
        period, nearing = watch(strobe[j], life.apart[i])
        begin = ROUND % period if period > 0 else 0  # the mean of an orbit is that of whole turns
        for s in range(2):
            total = 0.0
            for t in range(begin, ROUND):
                total += work[j, t, s]
            now[s] = total / (ROUND - begin) * life.share[i, s]
            grown[s] = here[j, s] - life.initial[i, s] - life.grown[i, s]
        if not np.isfinite(now[0] + now[1]):
            life.mode[i] = OVER
            continue
        life.silence[i] = 0 if now[0] + now[1] > 0 else life.silence[i] + ROUND
        regime = regime_of(period, now[0] / life.share[i, 0], now[1] / life.share[i, 1])
        if life.mode[i] == STEPPING:
            begin_hold(i, life, now)
        elif life.mode[i] == HOLDING:
            verdict[j] = hold(
                i, life, out, now, grown, period, nearing, regime, accuracy, largest, spacing
            )
        else:
            verdict[j] = flow(i, life, out, now, grown, nearing, regime, spacing)
        if has_ended(i, life, nothing):
            out.ended[i] = True
            life.mode[i] = OVER
            note_end(i, life, out, spacing)
        if out.reached[i, 0, -1] and out.reached[i, 1, -1]:
            life.mode[i] = OVER
