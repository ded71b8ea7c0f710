"""Plan of each beam for the next round of periods, and evaluation of the round."""

import numpy as np

from models.beam.response.response import ASYMMETRIC, SYMMETRIC
from models.beam.structure.propagation import FIRST_MODE
from models.beam.wear.endings import has_ended, note_end
from models.beam.wear.flows import flow
from models.beam.wear.progress import (
    BACK,
    FIRST_STEP,
    FLOWING,
    HOLDING,
    KEEP,
    ONWARD,
    OVER,
    SMALLEST_STEP,
    STEPPING,
    control,
    scale,
)
from models.beam.wear.regimes import ROUND, regime_of, watch
from models.beam.wear.steps import begin_hold, hold
from models.numerics.blocks import copy
from models.numerics.jit import inlined, kernel

_PUSH = 3e-3  # of the first mode in the first step [X0]
_WIDEST = 4.0  # growth of the faster gap over that of the one that matters


@kernel
def plan(left, life, out, here, state, kept, before, clock, pace, growth):
    """Set the growth of the gaps per work of the beams left for the next round, or begin a step.

    Where the beam's orbit is known at both ends of the last step, the next one begins at its end:
    with the orbit extrapolated, and the gaps that belong to it. Each step begins with a push, so
    that an orbit that wear has made unstable is left; the shorter the step, the smaller.

    Parameters
    ----------
    left : ndarray of int, shape (m,)
    life : Progress
    out : Worn
    here : ndarray, shape (m, 2)
        Gaps [X0]; updated.
    state : ndarray, shape (m, k)
        Updated.
    kept, before : ndarray, shape (m, k)
        At the beginning of this step, and of the one before.
    clock : int
        Column of the state that is not extrapolated.
    pace : float
        Relative growth of the gaps in a round of a flow.
    growth : ndarray, shape (m, 2)
        Set.
    """
    for j in range(left.size):
        i = left[j]
        growth[j] = 0.0
        if life.mode[i] == OVER:
            continue
        rate = life.rate[i]
        site = control(i, life, out)
        fastest = max(rate[0], rate[1])
        wide = np.expm1(life.step[i]) if life.mode[i] == STEPPING else pace
        wide *= scale(i, life, out)
        if life.mode[i] == STEPPING:
            # A change of branch ahead is approached by halves.
            wide = min(wide, (life.change_at[i] - life.grown[i, site]) / 2)
            wide = max(wide, SMALLEST_STEP * scale(i, life, out))
            state[j, FIRST_MODE] += _PUSH * min(1.0, wide / (FIRST_STEP * scale(i, life, out)))
        time = min(wide / rate[site], _WIDEST * wide / fastest) if rate[site] > 0 else 0.0
        if life.mode[i] != HOLDING:
            life.span[i] = time
        if life.mode[i] == FLOWING:
            for s in range(2):
                growth[j, s] = time * life.share[i, s] / ROUND
        elif life.mode[i] == STEPPING:
            run, length = life.grown[i, site] - life.grown_before[i, site], rate[site] * time
            single = life.regime[i] == SYMMETRIC or life.regime[i] == ASYMMETRIC
            if single and life.rate_before[i, site] > 0 and run > 0:
                _extrapolate(state[j], kept[j], before[j], clock, length / run)
                for s in range(2):
                    ratio = rate[s] / rate[site]
                    change = ratio - life.rate_before[i, s] / life.rate_before[i, site]
                    mean = max(0.0, ratio + change * length / run / 2)
                    here[j, s] = life.initial[i, s] + life.grown[i, s] + mean * length
                continue
            for s in range(2):
                goal = life.initial[i, s] + life.grown[i, s] + rate[s] * time
                if rate[s] > 0:
                    work = rate[s] / life.share[i, s] * ROUND
                    growth[j, s] = max(0.0, goal - here[j, s]) / work


@inlined
def _extrapolate(state, kept, before, clock, ahead):
    """Move a state on by a multiple of the change over the last step."""
    for column in range(len(state)):
        if column != clock:
            state[column] += ahead * (kept[column] - before[column])


@kernel
def keep(verdict, state, here, kept, kept_gaps, before):
    """Keep the states from which steps begin, or go back to them."""
    for j in range(verdict.size):
        if verdict[j] == KEEP:
            copy(kept[j], before[j])
            copy(state[j], kept[j])
            copy(here[j], kept_gaps[j])
        elif verdict[j] == BACK:
            copy(kept[j], state[j])
            copy(kept_gaps[j], here[j])


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
        if life.mode[i] == OVER:
            continue
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
