"""Steps: near a stable orbit the gaps grow by a step, and are held until the response has settled.

The time that a step takes is the integral of dx over the rate of wear, known at its ends. A step
over which the rate changes too much is taken back, and another is made from the state kept at its
beginning: where the branch changed, half as far.
"""

import numpy as np

from models.beam.response.response import APERIODIC
from models.beam.wear.endings import was_last
from models.beam.wear.flows import begin_flow
from models.beam.wear.progress import (
    BACK,
    FLOWING,
    HOLDING,
    KEEP,
    ONWARD,
    SMALLEST_STEP,
    STEPPING,
    control,
    scale,
    wear_on,
)
from models.numerics.jit import inlined

_TIGHT = 0.1  # error of a step over the accuracy asked for
_GENEROUS = 0.125  # of it, below which the next step is twice as long
_SMOOTH = 1 / 6  # error of a step without a change of branch, over the one with it
_JUMP = 0.2  # change of a rate, other than expected, that may be one of branch
_FEWEST, _LEFT, _MOST = 2, 8, 16  # rounds held: near an orbit, away from any, at most
_CALM, _QUIET = 1e-4, 1e-8  # change of work from round to round when settled; need not shrink
_SHRINKING = 0.8  # factor of that change from one round to the next


@inlined
def begin_hold(i, life, now):
    """Prepare for the first round in which the gaps of beam i are held."""
    life.mode[i] = HOLDING
    life.rounds[i] = 0
    for s in range(2):
        life.last[i, s] = now[s]
        life.change[i, s] = np.inf
        life.total[i, s] = 0.0


@inlined
def hold(i, life, out, now, grown, period, nearing, regime, accuracy, largest, spacing):
    """Hold the gaps until the response has settled; then accept the step, or take it back."""
    calm = _is_calm(i, life, now)
    life.rounds[i] += 1
    held = life.rounds[i]
    for s in range(2):
        life.last[i, s] = now[s]
        life.total[i, s] = now[s] + (life.total[i, s] if held > _LEFT // 2 else 0.0)
    settled = period == 0 or (nearing and calm)
    if held < (_FEWEST if period > 0 else _LEFT) or (held < _MOST and not settled):
        return ONWARD
    orbital = period > 0
    if not orbital:
        regime = APERIODIC
        for s in range(2):
            now[s] = life.total[i, s] / (held - _LEFT // 2 + 1)
    site = control(i, life, out)
    smooth = orbital and regime == life.regime[i] and _is_even(i, life, out, now, grown)
    error = _step_error(i, life, out, now, grown, _SMOOTH if smooth else 1.0)
    planned = life.rate[i, site] * life.span[i]
    divisible = planned > 1.5 * SMALLEST_STEP * scale(i, life, out) and not was_last(
        i, life, out, now, grown
    )
    if error > _TIGHT * accuracy and divisible:
        life.mode[i] = STEPPING
        if smooth:
            life.step[i] /= 2
        else:
            life.change_at[i] = life.grown[i, site] + planned
        return BACK
    _accept(i, life, out, now, grown, smooth, regime, spacing)
    life.mode[i] = STEPPING if orbital else FLOWING
    if not orbital:
        begin_flow(i, life)
    elif error < _GENEROUS * _TIGHT * accuracy:
        life.step[i] = min(largest, 2 * life.step[i])
    if not smooth or life.grown[i, site] >= life.change_at[i]:
        life.change_at[i] = np.inf
    return KEEP


@inlined
def _is_calm(i, life, now):
    """Return whether the sum of the sites' wear, and their difference, change less and less."""
    whole = now[0] + now[1]
    calm = True
    for s in range(2):
        sign = 1 - 2 * s
        change = abs(now[0] - life.last[i, 0] + sign * (now[1] - life.last[i, 1]))
        change = change / whole if whole > 0 else 0.0
        calm &= change < _CALM and (change <= _SHRINKING * life.change[i, s] or change < _QUIET)
        life.change[i, s] = change
    return calm


@inlined
def _expected(i, life, site, grown):
    """Return the inverse rate of a site after a step, extrapolated from the step before."""
    inverse, before = 1 / life.rate[i, site], life.rate_before[i, site]
    run = life.grown[i, site] - life.grown_before[i, site]
    if before <= 0 or run <= 0:
        return inverse
    return inverse + (inverse - 1 / before) / run * grown


@inlined
def _counts(i, life, out, site):
    """Return whether a life still to be found depends on the rate of a site."""
    return not out.reached[i, site, -1] or site == control(i, life, out)


@inlined
def _is_met(i, life, out, site, now):
    """Return whether a site whose life is still to be found is first touched in a step."""
    return life.rate[i, site] <= 0 and now[site] > 0 and not out.reached[i, site, -1]


@inlined
def _is_even(i, life, out, now, grown):
    """Return whether no rate has changed so much that it may have jumped."""
    even = True
    for s in range(2):
        if grown[s] > 0 and life.rate[i, s] > 0 and _counts(i, life, out, s):
            change = abs(
                life.rate[i, s] * _expected(i, life, s, grown[s]) - life.rate[i, s] / now[s]
            )
            even &= change <= _JUMP
        even &= not _is_met(i, life, out, s, now)
    return even


@inlined
def _goal(i, life, out, site):
    """Return the first growth that a site has not reached, or the first if there is none."""
    for depth in range(life.growths.shape[1]):
        if not out.reached[i, site, depth]:
            return life.growths[i, depth]
    return life.growths[i, 0]


@inlined
def _step_error(i, life, out, now, grown, factor):
    """Return the error of a step relative to the lives still to be found; note it for each site.

    If the rate jumps somewhere on the way, the error of the trapezoidal rule is up to half the
    difference of the inverse rates times the step. Where the rate is smooth, its deviation from the
    extrapolated one takes the place of the difference, and the error is a fraction of this. A site
    that is not touched waits for the other: its clock has the other's error. If it is first touched
    in this step, it may be so anywhere on the way.
    """
    largest = 0.0
    for s in range(2):
        rate = life.rate[i, s]
        life.error[i, s] = 0.0
        if grown[s] <= 0 or rate <= 0 or not _counts(i, life, out, s):
            continue
        expected = _expected(i, life, s, grown[s])
        goal = _goal(i, life, out, s)
        whole = life.clock[i] + max(grown[s], goal - life.grown[i, s]) / rate
        error = whole
        if now[s] > 0:
            error = min(whole, factor * grown[s] * abs(1 / now[s] - expected) / 2)
        life.error[i, s] = error
        if not out.reached[i, s, -1]:
            largest = max(largest, error / whole)
    for s in range(2):
        if life.rate[i, s] <= 0 and not out.reached[i, s, -1]:
            life.error[i, s] = life.error[i, 1 - s]
        if _is_met(i, life, out, s, now):
            missing = _goal(i, life, out, s) - life.grown[i, s]
            whole = life.clock[i] + life.span[i] + missing / now[s]
            life.error[i, s] += life.span[i] / 2
            largest = max(largest, life.error[i, s] / whole)
    return largest


@inlined
def _integral(before, begin, end, run, length):
    """Return the integral over a step, from the values at its ends and a run before, if any."""
    total = length * (begin + end) / 2
    if run > 0:
        curvature = ((end - begin) / length - (begin - before) / run) / (run + length)
        total -= curvature * length**3 / 6
    return total


@inlined
def _accept(i, life, out, now, grown, smooth, regime, spacing):
    """Let the time of a step pass."""
    site = control(i, life, out)
    other = 1 - site
    rate, after, before = life.rate[i, site], now[site], life.rate_before[i, site]
    time = 0.0
    if grown[site] > 0 and rate > 0:
        begin = 1 / rate
        end = 1 / after if after > 0 else begin
        run, earlier = 0.0, begin
        if smooth and before > 0:
            run, earlier = life.grown[i, site] - life.grown_before[i, site], 1 / before
        length = grown[site]
        time = _integral(earlier, begin, end, run, length)
        ratios = life.rate_before[i, other] * earlier, life.rate[i, other] * begin, now[other] * end
        grown[other] = max(0.0, _integral(*ratios, run, length))
    for s in range(2):
        life.step_error[i, s] += life.error[i, s] ** 2
        life.grown_before[i, s] = life.grown[i, s]
        life.rate_before[i, s] = life.rate[i, s] if smooth else 0.0
    life.regime[i] = regime
    wear_on(i, life, out, time, grown, now, spacing)
    for s in range(2):
        life.rate[i, s] = now[s]
