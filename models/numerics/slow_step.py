"""One step of slow time: worn volumes whose rates depend on gaps, by Heun's method.

The state is V, k quantities with dV/dt = f(X, t). Each has a coordinate, X = X(V, t), known in
closed form: a gap that wear opens, and that creep opens or closes as well. The rate may be
expensive, measured by running a machine to its steady state, so a step has parts between which
rates are evaluated:

    propose     the length of the step, and the state predicted at its end
    correct     the state corrected by the mean of both rates
    judge       the error of the step in units of the one allowed; above 1 it must be taken back

With f at the beginning of the step, f* at the predicted end X* and f_1 at the corrected one, X_1,

    V* = V + h f,    V_1 = V + h (f + f*)/2,
    error of V_1 = h |f_1 - f*|/2 + h^2 |f_1 - f - (f - f_0) h/h_0| / (6 (h + h_0)),

where f_0 is the rate at the beginning of the step before, of length h_0. The first term is the
effect of X_1 - X* on the rate, the second the error of the trapezoidal rule. To leading order their
sum is no less than the error of the step if f depends on V alone, and equal to it if f depends on t
alone.
Without a step before, the second term is h |f_1 - f|/2, the error if the rate jumps in the step.

Where rates are means with noise, f_1 is extrapolated from f and f*, if it differs from f* by less
than the noise.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from models.numerics.fma import fma
from models.numerics.jit import kernel

_SHORTENINGS = 60
_MARGIN = 0.95  # of the motion allowed, in a step that is shortened to it
_SMALLEST = 1e-3  # factor by which a step is shortened at once
_LEVEL = 1e-8  # relative change of a rate below which its derivative is not known
_NOISY = 2.0  # error of a step over its standard error that noise alone may cause
_STRONGEST = 1.0  # logarithm by which an error grows in a step, at most


(
    V, X, RATE,
    V_STAR, X_STAR, RATE_STAR,
    V_END, X_END, RATE_END,
    FIRST, BEFORE, NOISE, LOCAL, ERROR, VARIANCE,
) = range(15)  # fmt: skip
"""Rows of a step, an array of shape (15, k).

V, X, RATE                  quantities, coordinates and rates at its beginning
V_STAR, X_STAR, RATE_STAR   at its end, as predicted
V_END, X_END, RATE_END      at its end, as corrected
FIRST                       coordinates from which their growth counts
BEFORE                      rates at the beginning of the step before
NOISE                       standard error of the rates, 0 where they are exact
LOCAL, ERROR                error of V_END from this step, of V from all steps so far; without noise
VARIANCE                    of V from the noise of all steps so far
"""


class Stepper(NamedTuple):
    """Kernels of one machine.

    Attributes
    ----------
    propose : kernel
        ``propose(step, t, span, state, p, accuracy, floor)`` shortens a step until no coordinate
        moves by more than the accuracy times its scale; sets V_STAR and X_STAR; returns the length.
    correct : kernel
        ``correct(step, t, span, state, p)`` sets V_END and X_END; needs RATE_STAR.
    judge : kernel
        ``judge(step, t, span, span_before, state, p, accuracy, floor)`` sets LOCAL and returns
        the error over the one allowed; needs RATE_END. `span_before` is 0 if there was no step.
    """

    propose: Callable[..., float]
    correct: Callable[..., None]
    judge: Callable[..., float]


@kernel
def _scale(i, step, floor):
    """Return the length relative to which coordinate i moves: itself, or its growth so far."""
    return max(floor[i], min(abs(step[X, i]), abs(step[X, i] - step[FIRST, i])))


@kernel
def accumulate(step, span):
    """Add the errors of an accepted step; needs `Stepper.judge`.

    An error of the step that noise alone may cause counts as noise, not again. Errors of earlier
    steps grow with the derivative of the rate by its own quantity, as f* and f_1 show it.
    """
    for i in range(step.shape[1]):
        turn = step[RATE_STAR, i] - step[RATE, i]
        growth = 0.0
        if abs(turn) > _LEVEL * abs(step[RATE, i]):
            growth = 2 * (step[RATE_END, i] - step[RATE_STAR, i]) / turn
            growth = max(-_STRONGEST, min(_STRONGEST, growth))
        factor = 1 + growth * (1 + growth / 2)
        noise = span * step[NOISE, i]
        local = step[LOCAL, i] if step[LOCAL, i] > _NOISY * noise else 0.0
        step[ERROR, i] = fma(step[ERROR, i], factor, local)
        step[VARIANCE, i] = fma(step[VARIANCE, i], factor * factor, noise * noise)


@kernel
def extrapolate(step):
    """Extrapolate the rates at the corrected state; return whether this is within their noise."""
    part, noise = 0.0, 0.0
    for i in range(step.shape[1]):
        moved = step[X_STAR, i] - step[X, i]
        back = step[X_END, i] - step[X_STAR, i]
        if back != 0:
            part = max(part, abs(back / moved) if moved != 0 else np.inf)
        noise = max(noise, step[NOISE, i])
    if noise == 0:
        return False
    for i in range(step.shape[1]):
        moved = step[X_STAR, i] - step[X, i]
        turn = step[RATE_STAR, i] - step[RATE, i]
        if turn != 0 and not abs(turn) * part <= step[NOISE, i]:
            return False
        back = (step[X_END, i] - step[X_STAR, i]) / moved if moved != 0 else 0.0
        step[RATE_END, i] = fma(turn, back, step[RATE_STAR, i])
    return True


def stepper(coordinates: Callable[..., None]) -> Stepper:
    """Compile the steps of one machine.

    Parameters
    ----------
    coordinates : kernel
        ``coordinates(v, t, state, p, x)`` sets x to the coordinates.
    """

    @kernel
    def propose(step, t, span, state, p, accuracy, floor):
        for _ in range(_SHORTENINGS):
            for i in range(step.shape[1]):
                step[V_STAR, i] = fma(span, step[RATE, i], step[V, i])
            coordinates(step[V_STAR], t + span, state, p, step[X_STAR])
            worst = 0.0
            for i in range(step.shape[1]):
                moved = abs(step[X_STAR, i] - step[X, i]) / (accuracy * _scale(i, step, floor))
                worst = max(worst, moved if math.isfinite(moved) else np.inf)
            if worst <= 1:
                break
            span *= max(_MARGIN / worst, _SMALLEST)
        return span

    @kernel
    def correct(step, t, span, state, p):
        for i in range(step.shape[1]):
            step[V_END, i] = fma(0.5 * span, step[RATE, i] + step[RATE_STAR, i], step[V, i])
        coordinates(step[V_END], t + span, state, p, step[X_END])

    @kernel
    def judge(step, t, span, span_before, state, p, accuracy, floor):
        for i in range(step.shape[1]):
            change = step[RATE_END, i] - step[RATE, i]
            jump = 0.5 * span * abs(change)
            if span_before > 0:
                expected = (step[RATE, i] - step[BEFORE, i]) * (span / span_before)
                jump = span * span * abs(change - expected) / (6 * (span + span_before))
            step[LOCAL, i] = fma(0.5 * span, abs(step[RATE_END, i] - step[RATE_STAR, i]), jump)
            step[V_STAR, i] = step[V_END, i] + step[LOCAL, i]
        coordinates(step[V_STAR], t + span, state, p, step[X_STAR])
        worst = 0.0
        for i in range(step.shape[1]):
            shift = abs(step[X_STAR, i] - step[X_END, i]) / (accuracy**3 * _scale(i, step, floor))
            grown = abs(step[V_END, i] - step[V, i])
            if not step[LOCAL, i] <= span * step[NOISE, i]:
                part = step[LOCAL, i] / (accuracy**2 * grown) if grown > 0 else np.inf
                excess = min(part, shift)
                worst = max(worst, excess if math.isfinite(excess) else np.inf)
        return worst

    return Stepper(propose, correct, judge)
